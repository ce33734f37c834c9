//! Lights that are images of the surroundings (EXT_lights_image_based): cubes of six images.
//!
//! Of their blurred levels and their irradiance nothing is used: a path tracer finds both itself.

use std::path::Path;
use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::json::{self, Fault, Object};
use super::notices::Notices;
use super::read::Storage;
use super::resources;
use super::texture::ImageDeclaration;
use crate::files::memory;
use crate::formats::{Broken, LoadOptions};
use crate::light::Environment;
use crate::math::Vec3;
use crate::texture::{ColorSpace, Filter, Image, Texture, Wrap};

const NAME: &str = "EXT_lights_image_based";

/// The fewest and the most columns of the map of latitude and longitude that is made of a cube.
const FEWEST_COLUMNS: usize = 256;
const MOST_COLUMNS: usize = 8192;

/// A light of the document.
#[derive(Clone, Debug)]
pub struct ImageLight {
    /// The pointer to it.
    place: String,
    /// The images of its faces: those towards +X, -X, +Y, -Y, +Z and -Z.
    pub faces: [usize; 6],
    /// Times the images.
    intensity: f32,
    /// From its space to that of the scene.
    rotation: DQuat,
}

/// Reads all such lights; `images` is how many images there are.
pub fn read(root: &Object, images: usize) -> Result<Vec<ImageLight>, Fault> {
    let Some(extension) = root.extension(NAME)? else { return Ok(Vec::new()) };
    extension.objects("lights")?.iter().map(|object| light(object, images)).collect()
}

/// The light of a scene of the document, of `lights` that there are.
pub fn of_scene(scene: &Object, lights: usize) -> Result<Option<usize>, Fault> {
    match scene.extension(NAME)? {
        Some(extension) => extension.reference("light", "light", lights),
        None => Ok(None),
    }
}

fn light(object: &Object, images: usize) -> Result<ImageLight, Fault> {
    let levels = object.array("specularImages")?;
    let first = levels.first().ok_or_else(|| object.absent("specularImages"))?;
    let place = format!("{}/0", object.at("specularImages"));
    let faces = json::indices(first, &place, "image", images)?;
    let faces = faces.try_into().map_err(|_| Fault::new(place, "must be six images"))?;
    let intensity = object.number("intensity")?.unwrap_or(1.0);
    if intensity < 0.0 {
        return Err(object.fault_at("intensity", "is below 0"));
    }
    let rotation = object.numbers::<4>("rotation")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let rotation = DQuat::from_array(rotation);
    if rotation.length() < 1e-6 {
        return Err(object.fault_at("rotation", "is no rotation: its length is 0"));
    }
    let rotation = rotation.normalize();
    Ok(ImageLight { place: object.place().to_owned(), faces, intensity, rotation })
}

impl ImageLight {
    /// What shines from all around. If an image is missing, that goes to `broken`, or is noted and
    /// there is no light.
    pub fn load(
        &self,
        images: &[ImageDeclaration],
        storage: &Storage,
        path: &Path,
        options: &LoadOptions,
        broken: &mut Vec<Broken>,
        notices: &mut Notices,
    ) -> Option<Environment> {
        let missing = options.missing_texture;
        let faces = self.faces.to_vec();
        let decoded = resources::decode_images(faces, images, storage, path, &options.textures);
        let mut faces: Vec<Arc<Image>> = Vec::new();
        for image in self.faces {
            match &decoded[&image] {
                Ok((found, _)) => faces.push(found.clone()),
                Err(reason) => {
                    let (name, place) = (resources::name_of(&images[image]), &images[image].place);
                    resources::report(name, place, reason, missing, broken, notices);
                    return None;
                }
            }
        }
        let made = Cube::new(&faces).and_then(|cube| self.surround(&cube));
        let said = |reason: &String| {
            resources::report(String::new(), &self.place, reason, missing, broken, notices);
        };
        made.inspect_err(said).ok()
    }

    /// A map of latitude and longitude of what a cube shows, turned.
    fn surround(&self, cube: &Cube) -> Result<Environment, String> {
        let columns = (4 * cube.size).clamp(FEWEST_COLUMNS, MOST_COLUMNS);
        let rows = columns / 2 + 1;
        let bytes = (columns * rows * 3 * size_of::<[f32; 4]>()) as u64;
        memory::claim(bytes).map_err(|error| error.to_string())?;
        let to_cube = self.rotation.inverse();
        let mut pixels = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            let polar = std::f64::consts::PI * row as f64 / (rows - 1) as f64;
            let (sine, cosine) = (libm::sin(polar), libm::cos(polar));
            for column in 0..columns {
                let turn = (column as f64 + 0.5) / columns as f64 - 0.5;
                let turn = turn * std::f64::consts::TAU;
                let (x, z) = (libm::sin(turn), -libm::cos(turn));
                let direction = to_cube * DVec3::new(sine * x, cosine, sine * z);
                pixels.push(cube.radiance(direction.as_vec3()).to_array());
            }
        }
        Ok(Environment::image(columns, rows, pixels, self.intensity, 0.0))
    }
}

/// Six square images of radiance, seen from within: each upright, with +Y above, those above and
/// below with -Z and +Z there.
struct Cube {
    /// Texels a side.
    size: usize,
    faces: Vec<Vec<Vec3>>,
}

impl Cube {
    fn new(images: &[Arc<Image>]) -> Result<Self, String> {
        let size = images[0].width();
        if images.iter().any(|image| image.width() != size || image.height() != size) {
            return Err("its six images are not squares of one size".to_owned());
        }
        let texels = u64::from(size) * u64::from(size);
        memory::claim(6 * texels * size_of::<Vec3>() as u64).map_err(|error| error.to_string())?;
        let face = |image: &Arc<Image>| {
            let image = Arc::clone(image);
            let texture = Texture::new(image, ColorSpace::Srgb, [Wrap::Clamp; 2], Filter::Nearest);
            let radiance = |i: u32| {
                let texel = texture.texel(i % size, i / size);
                // Images with alpha have it to divide by: RGBD.
                (texel.truncate() / texel.w.max(1.0 / 255.0)).max(Vec3::ZERO)
            };
            (0..size * size).map(radiance).collect()
        };
        Ok(Self { size: size as usize, faces: images.iter().map(face).collect() })
    }

    /// What arrives from a direction, between the four texels around.
    fn radiance(&self, direction: Vec3) -> Vec3 {
        let (face, across, down) = project(direction);
        let last = (self.size - 1) as f32;
        let at = |u: f32| ((u + 1.0) * 0.5 * self.size as f32 - 0.5).clamp(0.0, last);
        let (x, y) = (at(across), at(down));
        let texel = |x: usize, y: usize| {
            let (x, y) = (x.min(self.size - 1), y.min(self.size - 1));
            self.faces[face][y * self.size + x]
        };
        let (left, top) = (x as usize, y as usize);
        let (part_x, part_y) = (x - left as f32, y - top as f32);
        let above = texel(left, top).lerp(texel(left + 1, top), part_x);
        let below = texel(left, top + 1).lerp(texel(left + 1, top + 1), part_x);
        above.lerp(below, part_y)
    }
}

/// Which face a direction meets, and where: from -1 to 1, to the right and down.
fn project(d: Vec3) -> (usize, f32, f32) {
    let a = d.abs();
    if a.x >= a.y && a.x >= a.z {
        let side = d.x.signum();
        return (usize::from(d.x < 0.0), side * d.z / a.x, -d.y / a.x);
    }
    if a.y >= a.z {
        return (2 + usize::from(d.y < 0.0), -d.x / a.y, d.y.signum() * d.z / a.y);
    }
    (4 + usize::from(d.z < 0.0), -d.z.signum() * d.x / a.z, -d.y / a.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_meet_at_their_edges() {
        // Ahead, then to the right of it, then on: +X, +Z, -X, -Z.
        for (direction, face) in [(Vec3::X, 0), (Vec3::Z, 4), (-Vec3::X, 1), (-Vec3::Z, 5)] {
            assert_eq!(project(direction), (face, 0.0, 0.0));
            let right = direction.cross(Vec3::Y);
            let (found, across, _) = project(direction + 0.5 * right);
            assert_eq!((found, across), (face, 0.5));
            let (found, _, down) = project(direction + 0.5 * Vec3::Y);
            assert_eq!((found, down), (face, -0.5));
        }
        // Above, with -Z at the top; below, with +Z at the top.
        assert_eq!(project(Vec3::new(0.0, 1.0, -0.5)), (2, 0.0, -0.5));
        assert_eq!(project(Vec3::new(0.0, -1.0, 0.5)), (3, 0.0, -0.5));
        assert_eq!(project(Vec3::new(-0.5, 1.0, 0.0)), (2, 0.5, 0.0));
        assert_eq!(project(Vec3::new(-0.5, -1.0, 0.0)), (3, 0.5, 0.0));
    }
}
