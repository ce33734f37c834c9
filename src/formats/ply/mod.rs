//! PLY, the polygon file format: what scanners and their programs write.
//!
//! The reader is our own. The crate `ply-rs-bw` makes an allocation for the list of every face and
//! reports errors without saying which element they are in; this one reads numbers straight into
//! the mesh, and sets no memory aside that the file's length does not pay for.
//!
//! - G. Turk, "The PLY Polygon File Format", 1994: ASCII and binary of either byte order. Elements
//!   other than `vertex`, `face` and `tristrips` are passed over.
//! - Polygons of any shape become triangles, in the file's order. Shading is flat where the file
//!   gives no normals. v of texture coordinates counts upwards, as MeshLab has it, and is turned
//!   over; faces may have texture coordinates for each corner (`texcoord`).
//! - Colours of vertices that are whole numbers are sRGB, those with fractions are linear. They
//!   colour a white Lambertian surface; without them it is grey. A comment `TextureFile NAME` names
//!   a picture for it, beside the file.

mod faces;
mod header;
mod points;
mod values;
mod vertices;

use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

pub use header::is_ply;
pub use points::Points;

use self::faces::Faces;
use self::header::{Encoding, Header};
use self::values::{Ascii, Binary, Values};
use super::{Broken, LoadError, LoadOptions, MissingTexture, read_file, repair, uri};
use crate::geom::Mesh;
use crate::math::{Affine3A, MaterialId, MeshId, TextureId, Vec4};
use crate::scene::{AlphaMode, Instance, Material, Notice, Scene, TextureRef, Transform};
use crate::texture::{ColorSpace, Filter, ImageId, ImagePart, ImageSource, Texture, Wrap};

/// Loads a file and the picture that it names.
///
/// # Errors
/// As [`parse`], or if it cannot be read.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Scene, LoadError> {
    parse(path, &read_file(path)?, options)
}

/// Reads a file's contents; `path` is for messages and for the folder of the picture beside it.
///
/// # Errors
/// [`LoadError`] with the line, or in binary files the element and its number.
pub fn parse(path: &Path, bytes: &[u8], options: &LoadOptions) -> Result<Scene, LoadError> {
    options.refuse_choices(path)?;
    let header = header::read(bytes, path)?;
    let (body, meter) = (&bytes[header.length..], &*options.meter);
    let mut notices = Notices { file: path.display().to_string(), all: Vec::new() };
    let mesh = match header.encoding {
        Encoding::Ascii => {
            let rows = header.elements.iter().fold(0, |sum: u64, it| sum.saturating_add(it.count));
            self::mesh(
                &header,
                Ascii::new(body, header.lines, rows).metered(meter),
                path,
                &mut notices,
            )
        }
        Encoding::Little => {
            self::mesh(&header, Binary::new(body, false).metered(meter), path, &mut notices)
        }
        Encoding::Big => {
            self::mesh(&header, Binary::new(body, true).metered(meter), path, &mut notices)
        }
    }?;
    let mut scene = Scene::default();
    let material = material(&header, &mesh, path, options, &mut scene, &mut notices)?;
    scene.materials.push(material);
    scene.meshes.push(Arc::new(mesh));
    scene.instances.push(Instance {
        mesh: MeshId::from_index(0),
        material: MaterialId::from_index(0),
        transform: Transform::new(Affine3A::IDENTITY),
    });
    scene.notices = notices.all;
    Ok(scene)
}

struct Notices {
    file: String,
    all: Vec<Notice>,
}

impl Notices {
    fn add(&mut self, message: impl Into<String>) {
        self.all.push(Notice { place: self.file.clone(), message: message.into() });
    }
}

/// The mesh of a file's elements.
fn mesh(
    header: &Header,
    mut values: impl Values,
    file: &Path,
    notices: &mut Notices,
) -> Result<Mesh, LoadError> {
    let vertices = header.elements.iter().find(|element| element.name == "vertex");
    let count = vertices.map_or(0, |element| element.count);
    let (mut mesh, mut faces, mut left_out) = (Mesh::default(), Faces::default(), Vec::new());
    for element in &header.elements {
        let names = &mut left_out;
        match element.name.as_str() {
            "vertex" => mesh = vertices::read(element, &mut values, file, names)?,
            "face" => faces.read(element, count, &mut values, file, names)?,
            "tristrips" => faces.read_strips(element, count, &mut values, file, names)?,
            name => {
                if element.count > 0 {
                    notices.add(format!("elements {name} are not honoured"));
                }
                values::skip_rows(&mut values, element, file)?;
            }
        }
    }
    if let Some((rows, first)) = values.excess() {
        notices.add(format!(
            "{rows} rows have more numbers than their properties, the first in line {first}: those \
             at the end are skipped"
        ));
    }
    if values.has_more() {
        notices.add("goes on after the last element that its header declares");
    }
    if !left_out.is_empty() {
        notices.add(format!("properties not honoured: {}", left_out.join(", ")));
    }
    if faces.small > 0 {
        notices.add(format!("{} faces of fewer than three corners are skipped", faces.small));
    }
    if faces.lack_coordinates(&mesh) {
        notices.add("some corners have no texture coordinates; 0 takes their place");
    }
    faces
        .finish(&mut mesh)
        .map_err(|intricate| LoadError::invalid(file, "", intricate.to_string()))?;
    if mesh.indices.is_empty() && !mesh.positions.is_empty() {
        notices.add("has points alone, which have no area");
    }
    if repair::normals(&mut mesh) {
        notices.add("some normals have no direction; those of the faces take their place");
    }
    if repair::uvs(&mut mesh.uvs[0]) {
        notices.add("some texture coordinates are no numbers; 0 takes their place");
    }
    Ok(mesh)
}

/// The material of all of it.
///
/// # Errors
/// [`LoadError::References`] if its picture cannot be used.
fn material(
    header: &Header,
    mesh: &Mesh,
    path: &Path,
    options: &LoadOptions,
    scene: &mut Scene,
    notices: &mut Notices,
) -> Result<Material, LoadError> {
    let mut material = Material::grey();
    if !mesh.colors.is_empty() {
        material.base_color = Vec4::ONE;
    }
    if mesh.colors.iter().any(|color| color.w < 1.0) {
        material.alpha_mode = AlphaMode::Blend;
    }
    let Some((name, line)) = header.textures.first() else { return Ok(material) };
    if header.textures.len() > 1 {
        notices.add(format!("only the first of {} pictures is used", header.textures.len()));
    }
    if mesh.uvs[0].is_empty() {
        notices.add(format!("{name:?} is not used: there are no texture coordinates"));
        return Ok(material);
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    let file = uri::file(folder, name).ok();
    let source = ImageSource {
        id: file.and_then(|file| ImageId::of(&file, ImagePart::Whole)),
        name,
        read: Box::new(|| uri::read(folder, name).map(Cow::Owned)),
    };
    let image = options.textures.load_one(source);
    let texture = match (image, options.missing_texture) {
        (Ok((image, notes)), _) => {
            for note in notes {
                notices.add(format!("{name:?} {note}"));
            }
            Texture::new(image, ColorSpace::Srgb, [Wrap::Repeat; 2], Filter::Bilinear).named(name)
        }
        (Err(reason), MissingTexture::Magenta) => {
            notices.add(format!("{name:?}: {reason}; magenta takes its place"));
            Texture::magenta()
        }
        (Err(reason), MissingTexture::Error) => {
            let file = path.display().to_string();
            let (name, place) = (name.clone(), format!("{file}:{line}"));
            let broken = vec![Broken { name, place, reason, texture: true }];
            return Err(LoadError::References { file, broken });
        }
    };
    scene.textures.push(texture);
    material.base_color = Vec4::ONE;
    material.base_color_texture = Some(TextureRef::new(TextureId::from_index(0)));
    Ok(material)
}

#[cfg(test)]
mod tests;
