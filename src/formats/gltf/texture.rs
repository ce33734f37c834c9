//! Textures, samplers and images as the document declares them (glTF 2.0, 3.8).

use super::json::{Fault, Object};
use crate::math::TextureId;
use crate::scene::Material;
use crate::texture::{ColorSpace, Filter, Wrap};

/// Which textures materials use, each with the colour space that it is read in.
#[derive(Debug)]
pub struct Slots {
    /// How many textures the document has.
    textures: usize,
    used: Vec<(usize, ColorSpace)>,
    /// Of each texture its slots in the two colour spaces.
    by_texture: Vec<[Option<TextureId>; 2]>,
}

impl Slots {
    /// None used yet of `textures`.
    pub fn new(textures: usize) -> Self {
        Self { textures, used: Vec::new(), by_texture: vec![[None; 2]; textures] }
    }

    /// Checks what a texture info refers to.
    pub fn check(&self, info: &Object) -> Result<usize, Fault> {
        info.required_reference("index", "texture", self.textures)
    }

    /// The slot of what a texture info refers to.
    pub fn slot(&mut self, info: &Object, color_space: ColorSpace) -> Result<TextureId, Fault> {
        let texture = self.check(info)?;
        let known = &mut self.by_texture[texture][usize::from(color_space == ColorSpace::Linear)];
        if let Some(slot) = *known {
            return Ok(slot);
        }
        let slot = TextureId::from_index(self.used.len());
        self.used.push((texture, color_space));
        *known = Some(slot);
        Ok(slot)
    }

    /// Renumbers the textures of `materials` so that only those of them are left.
    pub fn retain(&self, materials: &mut [Material]) -> Vec<(usize, ColorSpace)> {
        let mut kept = Vec::new();
        let mut renumbered = vec![None; self.used.len()];
        for reference in materials.iter_mut().flat_map(Material::textures_mut) {
            let old = reference.texture.index();
            reference.texture = *renumbered[old].get_or_insert_with(|| {
                kept.push(self.used[old]);
                TextureId::from_index(kept.len() - 1)
            });
        }
        kept
    }
}

/// An image file, or where in the buffers one is.
#[derive(Clone, Debug)]
pub struct ImageDeclaration {
    /// What the file calls it.
    pub name: String,
    /// The pointer to it.
    pub place: String,
    /// Where it is.
    pub source: ImageSource,
}

/// Where an image is.
#[derive(Clone, Debug)]
pub enum ImageSource {
    /// A file, or a data URI.
    Uri(String),
    /// In a buffer view.
    View(usize),
}

/// A texture: an image and how to look it up.
#[derive(Clone, Debug)]
pub struct TextureDeclaration {
    /// The pointer to it.
    pub place: String,
    /// Its images: those of extensions first, that for programs without them last. The first that
    /// can be used is. None where only an extension names one that is not supported.
    pub images: Vec<usize>,
    /// Whether it has one of EXT_texture_avif, which is not read.
    pub avif: bool,
    /// Beyond the edges, along u and v.
    pub wrap: [Wrap; 2],
    /// Between texels.
    pub filter: Filter,
}

/// Reads the images; `views` is how many buffer views there are.
pub fn images(root: &Object, views: usize) -> Result<Vec<ImageDeclaration>, Fault> {
    let image = |object: &Object| {
        let uri = object.text("uri")?;
        let source = match (uri, object.reference("bufferView", "buffer view", views)?) {
            (Some(uri), None) => ImageSource::Uri(uri.to_owned()),
            (None, Some(view)) => ImageSource::View(view),
            (Some(_), Some(_)) => return Err(object.fault("has both a URI and a buffer view")),
            (None, None) => return Err(object.fault("has neither a URI nor a buffer view")),
        };
        Ok(ImageDeclaration { name: object.name()?, place: object.place().to_owned(), source })
    };
    root.objects("images")?.iter().map(image).collect()
}

/// Reads the textures with their samplers; `images` is how many images there are.
pub fn textures(root: &Object, images: usize) -> Result<Vec<TextureDeclaration>, Fault> {
    let samplers: Vec<_> =
        root.objects("samplers")?.iter().map(sampler).collect::<Result<_, Fault>>()?;
    let texture = |object: &Object| {
        let sampler = object.reference("sampler", "sampler", samplers.len())?;
        let (wrap, filter) = sampler.map(|sampler| samplers[sampler]).unwrap_or_default();
        let plain = object.reference("source", "image", images)?;
        let other = |name| match object.extension(name)? {
            Some(other) => other.reference("source", "image", images),
            None => Ok(None),
        };
        let all = [other("KHR_texture_basisu")?, other("EXT_texture_webp")?, plain];
        let images = all.into_iter().flatten().collect();
        let avif = other("EXT_texture_avif")?.is_some();
        let place = object.place().to_owned();
        Ok(TextureDeclaration { place, images, avif, wrap, filter })
    };
    root.objects("textures")?.iter().map(texture).collect()
}

fn sampler(object: &Object) -> Result<([Wrap; 2], Filter), Fault> {
    let wrap = |key| match object.whole(key)?.unwrap_or(10497) {
        10497 => Ok(Wrap::Repeat),
        33071 => Ok(Wrap::Clamp),
        33648 => Ok(Wrap::Mirror),
        other => Err(object.fault_at(key, format!("{other} is none of 10497, 33071 and 33648"))),
    };
    let filter = match object.whole("magFilter")? {
        None | Some(9729) => Filter::Bilinear,
        Some(9728) => Filter::Nearest,
        Some(other) => {
            let message = format!("{other} is neither 9728 nor 9729");
            return Err(object.fault_at("magFilter", message));
        }
    };
    // Minification is what averaging over a pixel's samples does; only the value is checked.
    match object.whole("minFilter")? {
        None | Some(9728..=9729 | 9984..=9987) => Ok(([wrap("wrapS")?, wrap("wrapT")?], filter)),
        Some(other) => {
            Err(object
                .fault_at("minFilter", format!("{other} is none of 9728 to 9729, 9984 to 9987")))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn textures_of(text: &str) -> Result<Vec<TextureDeclaration>, Fault> {
        let value = json::parse(text.as_bytes()).expect("valid JSON");
        let root = Object::new(&value, String::new()).expect("an object");
        textures(&root, 1)
    }

    #[test]
    fn samplers_default_to_repeated_and_smooth() {
        let made = textures_of(
            r#"{"samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}],
                "textures": [{"source": 0}, {"source": 0, "sampler": 0}]}"#,
        )
        .expect("valid");
        assert_eq!((made[0].wrap, made[0].filter), ([Wrap::Repeat; 2], Filter::Bilinear));
        assert_eq!((made[1].wrap, made[1].filter), ([Wrap::Clamp, Wrap::Mirror], Filter::Nearest));
    }

    #[test]
    fn unknown_modes_are_refused() {
        for sampler in [r#""wrapS": 1"#, r#""magFilter": 9984"#, r#""minFilter": 0"#] {
            assert!(textures_of(&format!("{{\"samplers\": [{{{sampler}}}]}}")).is_err());
        }
    }
}
