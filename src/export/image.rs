//! Textures, samplers and images.

use std::collections::HashMap;
use std::io;
use std::sync::Arc;

use image::ExtendedColorType;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::binary::{Binary, Chunk};
use super::object::named;
use crate::film::png::encode_pixels;
use crate::film::tonemap::srgb_from_linear;
use crate::math::TextureId;
use crate::scene::Scene;
use crate::texture::{ColorSpace, Filter, Image, Texels, Texture, Wrap};

/// The textures of a file under construction, by their numbers there.
pub struct Images<'a> {
    scene: &'a Scene,
    textures: Vec<(Texture, ColorSpace)>,
    /// By the scene's texture and the space that it is looked up in.
    numbers: HashMap<(TextureId, bool), usize>,
}

impl<'a> Images<'a> {
    /// None yet of a scene's.
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, textures: Vec::new(), numbers: HashMap::new() }
    }

    /// A texture of the scene.
    pub fn of(&self, texture: TextureId) -> &Texture {
        match texture.index().checked_sub(self.scene.textures.len()) {
            None => &self.scene.textures[texture.index()],
            Some(made) => &self.textures[made].0,
        }
    }

    /// Adds a texture that was made; it has the number of a scene's texture beyond all of these.
    pub fn add(&mut self, texture: Texture, space: ColorSpace) -> TextureId {
        self.textures.push((texture, space));
        let number = self.textures.len() - 1;
        let id = TextureId::from_index(self.scene.textures.len() + number);
        self.numbers.insert((id, space == ColorSpace::Srgb), number);
        id
    }

    /// The number in the file of a texture that is looked up there in a colour space.
    pub fn texture(&mut self, texture: TextureId, space: ColorSpace) -> usize {
        let key = (texture, space == ColorSpace::Srgb);
        if let Some(&number) = self.numbers.get(&key) {
            return number;
        }
        self.textures.push((self.of(texture).clone(), space));
        *self.numbers.entry(key).or_insert(self.textures.len() - 1)
    }

    /// Writes all; returns the number of images.
    ///
    /// # Errors
    /// An image that PNG has no room for.
    pub fn write(self, binary: &mut Binary<'_>, left_out: &mut Vec<String>) -> io::Result<u64> {
        let mut images: Vec<(&Texture, ColorSpace)> = Vec::new();
        let mut numbers = HashMap::new();
        for (texture, space) in &self.textures {
            // Texels depend on the space that they are in, and on that of the place.
            let spaces = [texture.color_space(), *space].map(|space| space == ColorSpace::Srgb);
            let key = (Arc::as_ptr(texture.image()), spaces);
            let image = *numbers.entry(key).or_insert_with(|| {
                images.push((texture, *space));
                images.len() - 1
            });
            let sampler = sampler(texture);
            let samplers = binary.document.list("samplers");
            let at = samplers.iter().position(|known| *known == sampler);
            let at = at.unwrap_or_else(|| {
                samplers.push(sampler);
                samplers.len() - 1
            });
            binary.document.push("textures", json!({ "source": image, "sampler": at }));
        }
        let files: Vec<io::Result<(Vec<u8>, bool)>> =
            images.par_iter().map(|(texture, space)| encode(texture, *space)).collect();
        for ((texture, _), file) in images.iter().zip(files) {
            let (file, is_exact) = file?;
            let name = texture.name();
            if !is_exact {
                left_out
                    .push(format!("image {name:?}: its values are rounded to 16 bits from 0 to 1"));
            }
            let view = binary.view(Chunk::File(file));
            let image = json!({ "bufferView": view, "mimeType": "image/png" });
            binary.document.push("images", named(name, image));
        }
        Ok(images.len() as u64)
    }
}

fn sampler(texture: &Texture) -> Value {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => 10497,
        Wrap::Clamp => 33071,
        Wrap::Mirror => 33648,
    };
    let filter = match texture.filter() {
        Filter::Nearest => 9728,
        Filter::Bilinear => 9729,
    };
    let [s, t] = texture.wrap().map(wrap);
    json!({ "wrapS": s, "wrapT": t, "magFilter": filter, "minFilter": filter })
}

/// A PNG of a texture that is looked up in `space`, and whether it holds all that the texture does.
fn encode(texture: &Texture, space: ColorSpace) -> io::Result<(Vec<u8>, bool)> {
    let image = texture.image();
    let texels = image.texels();
    let as_is = texture.color_space() == space;
    match &*texels {
        Texels::U8(values) if as_is => Ok((png(image, values, EIGHT)?, true)),
        Texels::U16(values) if as_is => {
            Ok((png(image, bytemuck::cast_slice(values), SIXTEEN)?, true))
        }
        _ => {
            let values = linear(image, texture.color_space());
            let stored = sixteen(image, &values, space);
            let file = png(image, bytemuck::cast_slice(&stored), SIXTEEN)?;
            let [width, height] = texture.size();
            let read = Image::new(width, height, image.channels(), Texels::U16(stored));
            let is_exact = linear(&Arc::new(read), space) == values;
            Ok((file, is_exact))
        }
    }
}

/// Kinds of pixels by their channels.
type Kinds = [ExtendedColorType; 4];
const EIGHT: Kinds = [
    ExtendedColorType::L8,
    ExtendedColorType::La8,
    ExtendedColorType::Rgb8,
    ExtendedColorType::Rgba8,
];
const SIXTEEN: Kinds = [
    ExtendedColorType::L16,
    ExtendedColorType::La16,
    ExtendedColorType::Rgb16,
    ExtendedColorType::Rgba16,
];

fn png(image: &Image, bytes: &[u8], kinds: Kinds) -> io::Result<Vec<u8>> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let mut file = Vec::new();
    encode_pixels(&mut file, width, height, kinds[usize::from(image.channels()) - 1], bytes)?;
    Ok(file)
}

/// Linear values of all channels of an image in a colour space, texel by texel.
fn linear(image: &Arc<Image>, space: ColorSpace) -> Vec<f32> {
    let (width, height) = (image.width(), image.height());
    let texture = Texture::new(Arc::clone(image), space, [Wrap::Clamp; 2], Filter::Nearest);
    let mut values = Vec::new();
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let color = texture.texel(x, y).to_array();
        match image.channels() {
            1 => values.push(color[0]),
            2 => values.extend([color[0], color[3]]),
            3 => values.extend(&color[..3]),
            _ => values.extend(color),
        }
    }
    values
}

/// Linear values as integers of 16 bits for a look-up in `space`.
fn sixteen(image: &Image, values: &[f32], space: ColorSpace) -> Vec<u16> {
    let channels = usize::from(image.channels());
    let is_alpha = |i: usize| channels.is_multiple_of(2) && i % channels == channels - 1;
    let integer = |(i, &value): (usize, &f32)| {
        let value = value.clamp(0.0, 1.0);
        let is_light = space == ColorSpace::Srgb && !is_alpha(i);
        let stored = if is_light { srgb_from_linear(value) } else { value };
        (stored * 65535.0 + 0.5) as u16
    };
    values.iter().enumerate().map(integer).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_is_written_once_for_all_who_look_it_up_alike() {
        let image = Arc::new(Image::of(2, 1, vec![[10_u8, 20, 30], [40, 50, 60]]));
        let texture =
            |wrap| Texture::new(Arc::clone(&image), ColorSpace::Srgb, [wrap; 2], Filter::Bilinear);
        let textures = vec![texture(Wrap::Repeat), texture(Wrap::Clamp)];
        let scene = Scene { textures, ..Scene::default() };
        let mut images = Images::new(&scene);
        let id = TextureId::from_index;
        assert_eq!(images.texture(id(1), ColorSpace::Srgb), 0);
        assert_eq!(images.texture(id(0), ColorSpace::Srgb), 1);
        assert_eq!(images.texture(id(1), ColorSpace::Srgb), 0);
        let (mut binary, mut left_out) = (Binary::default(), Vec::new());
        assert_eq!(images.write(&mut binary, &mut left_out).expect("fits"), 1);
        assert_eq!(binary.document.list("samplers").len(), 2);
        assert!(left_out.is_empty());
    }

    /// As `map_Kd` and `map_Ps` of an OBJ file make them of a picture of one channel.
    #[test]
    fn an_image_in_two_spaces_is_written_twice() {
        let image = Arc::new(Image::of(2, 1, vec![[0_u8], [128]]));
        let texture =
            |space| Texture::new(Arc::clone(&image), space, [Wrap::Repeat; 2], Filter::Bilinear);
        let textures = vec![texture(ColorSpace::Srgb), texture(ColorSpace::Linear)];
        let scene = Scene { textures, ..Scene::default() };
        let mut images = Images::new(&scene);
        for number in 0..2 {
            images.texture(TextureId::from_index(number), ColorSpace::Srgb);
        }
        let (mut binary, mut left_out) = (Binary::default(), Vec::new());
        assert_eq!(images.write(&mut binary, &mut left_out).expect("fits"), 2);
        let sources: Vec<_> =
            binary.document.list("textures").iter().map(|it| it["source"].clone()).collect();
        assert_eq!(sources, [json!(0), json!(1)]);
    }

    #[test]
    fn values_are_exact_if_they_are_read_as_they_were() {
        let is_exact = |image: Image, spaces: [ColorSpace; 2]| {
            let [from, to] = spaces;
            let texture = Texture::new(Arc::new(image), from, [Wrap::Clamp; 2], Filter::Nearest);
            encode(&texture, to).expect("fits").1
        };
        const LINEAR: [ColorSpace; 2] = [ColorSpace::Linear; 2];
        const TO_LINEAR: [ColorSpace; 2] = [ColorSpace::Srgb, ColorSpace::Linear];
        let stored = 16384.0 / 65535.0;
        assert!(is_exact(Image::of(3, 1, vec![[stored], [0.0_f32], [1.0]]), LINEAR));
        assert!(!is_exact(Image::of(1, 1, vec![[0.25_f32]]), LINEAR));
        assert!(!is_exact(Image::of(1, 1, vec![[f32::from_bits(1)]]), LINEAR));
        assert!(is_exact(Image::of(2, 1, vec![[0_u8], [255]]), TO_LINEAR));
        assert!(!is_exact(Image::of(2, 1, vec![[0_u8], [128]]), TO_LINEAR));
    }

    #[test]
    fn floats_keep_sixteen_bits() {
        let image = Image::of(2, 1, vec![[0.25_f32], [2.0]]);
        let texture =
            Texture::new(Arc::new(image), ColorSpace::Linear, [Wrap::Clamp; 2], Filter::Nearest);
        let (file, is_exact) = encode(&texture, ColorSpace::Linear).expect("fits");
        let read = image::load_from_memory(&file).expect("a PNG").into_luma16();
        assert_eq!((read.as_raw().as_slice(), is_exact), ([16384, 65535].as_slice(), false));
    }
}
