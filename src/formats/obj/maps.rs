//! The pictures that an MTL file names, as textures.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::paths::confine;
use super::texture_statement::{Channel, Map};
use crate::files::memory::{self, TooMuch};
use crate::formats::read::read_regular;
use crate::formats::{Broken, LoadError, MissingTexture};
use crate::math::{TextureId, Vec2};
use crate::scene::{Notice, TextureRef};
use crate::texture::{ColorSpace, Filter, Image, Texels, Texture, Wrap};

/// What a picture is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Use {
    /// An sRGB colour. Alpha is made one, because in MTL only `map_d` is about opacity.
    Color,
    /// Tangent-space normals.
    Normals,
    /// A scalar, put into all channels: what `-imfchan` names, else luminance.
    Scalar,
    /// The same, but alpha where the picture has any.
    Opacity,
}

/// Loads pictures once each, and keeps account of those that are missing.
pub(super) struct Maps<'a> {
    folder: &'a Path,
    missing: MissingTexture,
    images: HashMap<PathBuf, Arc<Image>>,
    by_use: HashMap<(PathBuf, Use, Option<Channel>, bool), TextureId>,
    textures: Vec<Texture>,
    broken: Vec<Broken>,
    /// What is odd about pictures that can be used.
    odd: Vec<Notice>,
}

impl<'a> Maps<'a> {
    /// For a scene in `folder`.
    pub(super) fn new(folder: &'a Path, missing: MissingTexture) -> Self {
        Self {
            folder,
            missing,
            images: HashMap::new(),
            by_use: HashMap::new(),
            textures: Vec::new(),
            broken: Vec::new(),
            odd: Vec::new(),
        }
    }

    /// The texture of a map that stands in `file`; none if it is missing, but for colours that are
    /// to be magenta then.
    pub(super) fn texture(&mut self, map: &Map, file: &Path, usage: Use) -> Option<TextureRef> {
        let path = confine(self.folder, &map.name).unwrap_or_else(|| PathBuf::from(&map.name));
        let key = (path, usage, map.channel, map.clamp);
        if let Some(&known) = self.by_use.get(&key) {
            return Some(place_map(map, known));
        }
        let texture = match self.image(map, file) {
            Some(image) => {
                let prepared = prepare_image(&image, usage, map.channel);
                let refused = |reason: TooMuch| self.refuse(map, file, reason.to_string());
                let image = prepared.map_err(refused).ok()?;
                let space = if usage == Use::Color { ColorSpace::Srgb } else { ColorSpace::Linear };
                Texture::new(image, space, wrap(map), Filter::Bilinear).named(&map.name)
            }
            None if usage == Use::Color => Texture::magenta(),
            None => return None,
        };
        let id = self.push(texture);
        self.by_use.insert(key, id);
        Some(place_map(map, id))
    }

    /// One texture of two scalars: roughness in green, metalness in blue, as glTF has them. A map
    /// that is absent counts as one everywhere.
    pub(super) fn metallic_roughness(
        &mut self,
        [metallic, roughness]: [Option<&Map>; 2],
        file: &Path,
    ) -> Option<TextureRef> {
        let images = [self.scalars(metallic, file), self.scalars(roughness, file)];
        let map = roughness.or(metallic)?;
        match merge_maps(&images)? {
            Ok(image) => {
                let image = Arc::new(image);
                let texture = Texture::new(image, ColorSpace::Linear, wrap(map), Filter::Bilinear);
                let id = self.push(texture.named(&map.name));
                Some(place_map(map, id))
            }
            Err(reason) => {
                self.refuse(map, file, reason.to_string());
                None
            }
        }
    }

    /// The image of a map of scalars; none if there is no map or it cannot be used.
    fn scalars(&mut self, map: Option<&Map>, file: &Path) -> Option<Arc<Image>> {
        let map = map?;
        let image = self.image(map, file)?;
        let prepared = prepare_image(&image, Use::Scalar, map.channel);
        prepared.map_err(|reason| self.refuse(map, file, reason.to_string())).ok()
    }

    /// Whether a picture has alpha other than one; false if it is missing.
    pub(super) fn has_alpha(&mut self, map: &Map, file: &Path) -> bool {
        self.image(map, file).is_some_and(|image| !image.is_opaque())
    }

    fn push(&mut self, texture: Texture) -> TextureId {
        self.textures.push(texture);
        TextureId::from_index(self.textures.len() - 1)
    }

    fn image(&mut self, map: &Map, file: &Path) -> Option<Arc<Image>> {
        let path = confine(self.folder, &map.name);
        if let Some(known) = path.as_ref().and_then(|path| self.images.get(path)) {
            return Some(Arc::clone(known));
        }
        if self.broken.iter().any(|broken| broken.name == map.name) {
            return None;
        }
        match decode(path.as_deref(), &map.name) {
            Ok((image, notes)) => {
                let place = || format!("{}:{}", file.display(), map.line);
                let notice =
                    |note| Notice { place: place(), message: format!("{:?} {note}", map.name) };
                self.odd.extend(notes.into_iter().map(notice));
                let image = Arc::new(image);
                self.images.insert(path?, Arc::clone(&image));
                Some(image)
            }
            Err(reason) => {
                self.refuse(map, file, reason);
                None
            }
        }
    }

    fn refuse(&mut self, map: &Map, file: &Path, reason: String) {
        let place = format!("{}:{}", file.display(), map.line);
        self.broken.push(Broken { name: map.name.clone(), place, reason, texture: true });
    }

    /// All textures.
    ///
    /// # Errors
    /// [`LoadError::References`] with every picture that cannot be used, unless these are to be
    /// gone without, which then is among `notices`.
    pub(super) fn finish(
        self,
        scene: &Path,
        notices: &mut Vec<Notice>,
    ) -> Result<Vec<Texture>, LoadError> {
        if !self.broken.is_empty() && self.missing == MissingTexture::Error {
            let file = scene.display().to_string();
            return Err(LoadError::References { file, broken: self.broken });
        }
        for Broken { name, place, reason, .. } in self.broken {
            let message = format!("{name:?}: {reason}: colours are magenta, others left out");
            notices.push(Notice { place, message });
        }
        notices.extend(self.odd);
        Ok(self.textures)
    }
}

fn decode(path: Option<&Path>, name: &str) -> Result<(Image, Vec<String>), String> {
    let path = path.ok_or("it leaves the scene's folder: put it there")?;
    let bytes = read_regular(path).map_err(|error| error.to_string())?;
    Image::decode_noting(&bytes, name).map_err(|error| error.to_string())
}

fn wrap(map: &Map) -> [Wrap; 2] {
    [if map.clamp { Wrap::Clamp } else { Wrap::Repeat }; 2]
}

/// With the map's options. The meshes' v is 1 - v of the file, so `v * s + o` becomes
/// `(1 - v) * s + o` turned over again.
fn place_map(map: &Map, texture: TextureId) -> TextureRef {
    let offset = Vec2::new(map.offset.x, 1.0 - map.scale.y - map.offset.y);
    TextureRef { scale: map.scale, offset, ..TextureRef::new(texture) }
}

/// Metalness and roughness, of the larger one's size: roughness in green, metalness in blue, one
/// where an image is absent. None without any image.
fn merge_maps([metallic, roughness]: &[Option<Arc<Image>>; 2]) -> Option<Result<Image, TooMuch>> {
    let both = || [metallic, roughness].into_iter().flatten();
    let (width, height) = both().map(|image| (image.width(), image.height())).max()?;
    let count = u64::from(width) * u64::from(height);
    let value = |image: &Option<Arc<Image>>, x: u32, y: u32| {
        let Some(image) = image else { return 1.0 };
        let scaled = |at: u32, to: u32, of: u32| u64::from(at) * u64::from(to) / u64::from(of);
        let (x, y) = (scaled(x, image.width(), width), scaled(y, image.height(), height));
        component(image, (y * u64::from(image.width()) + x) as usize, 0)
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let texels = texels.map(|(x, y)| [1.0, value(roughness, x, y), value(metallic, x, y), 1.0]);
    let texels = if both().all(|image| matches!(image.texels(), Texels::Rgba8(_))) {
        let of = |value: f32| (value * 255.0 + 0.5) as u8;
        memory::claim(count * 4).map(|()| Texels::Rgba8(texels.map(|t| t.map(of)).collect()))
    } else {
        let of = |value: f32| (value * 65535.0 + 0.5) as u16;
        memory::claim(count * 8).map(|()| Texels::Rgba16(texels.map(|t| t.map(of)).collect()))
    };
    Some(texels.map(|texels| Image::new(width, height, texels)))
}

/// The image as its use needs it; the same one if it is so already.
fn prepare_image(
    image: &Arc<Image>,
    usage: Use,
    channel: Option<Channel>,
) -> Result<Arc<Image>, TooMuch> {
    let channel = match (usage, channel) {
        (Use::Normals, _) => return Ok(Arc::clone(image)),
        (Use::Color, _) if image.is_opaque() => return Ok(Arc::clone(image)),
        (Use::Color, _) => None,
        (_, Some(channel)) => Some(channel),
        (Use::Opacity, None) if !image.is_opaque() => Some(Channel::Component(3)),
        (Use::Opacity | Use::Scalar, None) => Some(Channel::Luminance),
    };
    memory::claim(image.heap_bytes() as u64)?;
    let texels = match image.texels() {
        Texels::Rgba8(all) => Texels::Rgba8(
            all.iter().map(|t| pick(*t, u8::MAX, channel, |l| (l + 0.5) as u8)).collect(),
        ),
        Texels::Rgba16(all) => Texels::Rgba16(
            all.iter().map(|t| pick(*t, u16::MAX, channel, |l| (l + 0.5) as u16)).collect(),
        ),
        Texels::Rgba32F(all) => {
            Texels::Rgba32F(all.iter().map(|t| pick(*t, 1.0, channel, |l| l)).collect())
        }
    };
    Ok(Arc::new(Image::new(image.width(), image.height(), texels)))
}

/// A texel with alpha one: its colour, or one channel in all three.
fn pick<T: Copy + PartialEq + Into<f32>>(
    [r, g, b, a]: [T; 4],
    one: T,
    channel: Option<Channel>,
    round: fn(f32) -> T,
) -> [T; 4] {
    let scalar = match channel {
        None => return [r, g, b, one],
        Some(Channel::Component(k)) => [r, g, b, a][k],
        Some(Channel::Luminance) if r == g && g == b => r,
        // Rec. 709, of the stored values: what these pictures hold is no light.
        Some(Channel::Luminance) => {
            round(0.2126 * r.into() + 0.7152 * g.into() + 0.0722 * b.into())
        }
    };
    [scalar, scalar, scalar, one]
}

/// A channel of a texel, 0 to 1.
fn component(image: &Image, texel: usize, channel: usize) -> f32 {
    match image.texels() {
        Texels::Rgba8(all) => f32::from(all[texel][channel]) / 255.0,
        Texels::Rgba16(all) => f32::from(all[texel][channel]) / 65535.0,
        Texels::Rgba32F(all) => all[texel][channel].clamp(0.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::super::texture_statement;
    use super::*;

    fn map(text: &str) -> Map {
        let map = texture_statement::parse(text.as_bytes(), 7, |_| ());
        map.expect("it is well-formed").expect("it has a name")
    }

    /// A folder with `a.png`: one row of a half transparent red and an opaque grey texel.
    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("the system's temporary folder is writable");
        let texels = vec![255, 0, 0, 128, 64, 64, 64, 255];
        let image = image::RgbaImage::from_raw(2, 1, texels).expect("two texels");
        image.save(folder.path().join("a.png")).expect("it can be written");
        folder
    }

    fn texels(maps: &Maps, texture: TextureRef) -> Vec<[u8; 4]> {
        match maps.textures[texture.texture.index()].image().texels() {
            Texels::Rgba8(all) => all.clone(),
            other => panic!("not 8 bit: {}", matches!(other, Texels::Rgba16(_))),
        }
    }

    #[test]
    fn each_use_has_its_channels() {
        let folder = folder();
        let mut maps = Maps::new(folder.path(), MissingTexture::Error);
        let file = Path::new("a.mtl");
        let mut of = |text, usage| {
            let texture = maps.texture(&map(text), file, usage).expect("it is there");
            texels(&maps, texture)
        };
        assert_eq!(of("a.png", Use::Color), [[255, 0, 0, 255], [64, 64, 64, 255]]);
        assert_eq!(of("a.png", Use::Normals), [[255, 0, 0, 128], [64, 64, 64, 255]]);
        assert_eq!(of("a.png", Use::Scalar), [[54, 54, 54, 255], [64, 64, 64, 255]]);
        assert_eq!(of("a.png", Use::Opacity), [[128, 128, 128, 255], [255; 4]]);
        assert_eq!(of("-imfchan g a.png", Use::Opacity), [[0, 0, 0, 255], [64, 64, 64, 255]]);
        assert_eq!(maps.images.len(), 1);
    }

    #[test]
    fn roughness_and_metalness_share_a_texture() {
        let folder = folder();
        let mut maps = Maps::new(folder.path(), MissingTexture::Error);
        let rough = map("-imfchan m a.png");
        let both = [None, Some(&rough)];
        let texture = maps.metallic_roughness(both, Path::new("a.mtl")).expect("it is there");
        let image = maps.textures[texture.texture.index()].image();
        let Texels::Rgba8(texels) = image.texels() else { panic!("8 bits, as its file") };
        assert_eq!(texels[0], [255, 128, 255, 255]);
        assert_eq!(maps.metallic_roughness([None, None], Path::new("a.mtl")), None);
    }

    #[test]
    fn options_act_in_the_files_coordinates() {
        let texture = place_map(&map("-s 2 3 -o 0.5 0.25 a.png"), TextureId::from_index(0));
        // (u, v) of the file is (u, 1 - v) of the mesh; the image's row is 1 - v again.
        let (u, v) = (0.3, 0.2);
        let expected = Vec2::new(u * 2.0 + 0.5, 1.0 - (v * 3.0 + 0.25));
        assert!(texture.transform(Vec2::new(u, 1.0 - v)).abs_diff_eq(expected, 1e-6));
    }

    #[test]
    fn all_missing_pictures_are_listed_once() {
        let folder = folder();
        let mut maps = Maps::new(folder.path(), MissingTexture::Error);
        let file = Path::new("a.mtl");
        for name in ["b.png", "b.png", "../a.png"] {
            maps.texture(&map(name), file, Use::Scalar);
        }
        let error = maps.finish(Path::new("a.obj"), &mut Vec::new()).expect_err("two are missing");
        let LoadError::References { broken, .. } = error else { panic!("{error}") };
        let names: Vec<_> = broken.iter().map(|b| (&*b.name, &*b.place)).collect();
        assert_eq!(names, [("b.png", "a.mtl:7"), ("../a.png", "a.mtl:7")]);

        let mut maps = Maps::new(folder.path(), MissingTexture::Magenta);
        assert!(maps.texture(&map("b.png"), file, Use::Color).is_some());
        assert!(maps.texture(&map("b.png"), file, Use::Opacity).is_none());
        let mut notices = Vec::new();
        assert_eq!(maps.finish(Path::new("a.obj"), &mut notices).expect("goes on").len(), 1);
        assert_eq!(notices.len(), 1);
    }
}
