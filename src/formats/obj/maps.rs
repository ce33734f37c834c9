//! The pictures that an MTL file names, as textures.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::map_texels::{Use, merge_maps, prepare_image};
use super::paths::confine;
use super::texture_statement::{Channel, Map};
use crate::files::memory::TooMuch;
use crate::formats::read::read_regular;
use crate::formats::{Broken, LoadError, MissingTexture};
use crate::math::{TextureId, Vec2};
use crate::scene::{Notice, TextureRef};
use crate::texture::{
    ColorSpace, Decoded, Filter, Image, ImageId, ImagePart, ImageSource, Texture, TextureStore,
    Wrap,
};

/// A picture of scalars: which, which of its channels, and whether it ends at its edges.
type Scalars = (PathBuf, Option<Channel>, bool);

/// Loads pictures once each, and keeps account of those that are missing.
pub(super) struct Maps<'a> {
    folder: &'a Path,
    missing: MissingTexture,
    store: &'a TextureStore,
    /// Each with what is odd about it, which is told when it is used first.
    images: HashMap<PathBuf, Decoded>,
    by_use: HashMap<(PathBuf, Use, Option<Channel>, bool), TextureId>,
    /// Textures of metalness and roughness.
    merged: HashMap<[Option<Scalars>; 2], TextureId>,
    textures: Vec<Texture>,
    broken: Vec<Broken>,
    /// What is odd about pictures that can be used.
    odd: Vec<Notice>,
}

impl<'a> Maps<'a> {
    /// For a scene in `folder`.
    pub(super) fn new(folder: &'a Path, missing: MissingTexture, store: &'a TextureStore) -> Self {
        Self {
            folder,
            missing,
            store,
            images: HashMap::new(),
            by_use: HashMap::new(),
            merged: HashMap::new(),
            textures: Vec::new(),
            broken: Vec::new(),
            odd: Vec::new(),
        }
    }

    /// Decodes the pictures of `maps` side by side, and so that it is known what all take. Whether
    /// any cannot be used is told when it is used.
    pub(super) fn preload<'m>(&mut self, maps: impl Iterator<Item = &'m Map>) {
        let mut named: Vec<(PathBuf, &str)> =
            maps.filter_map(|map| Some((confine(self.folder, &map.name)?, &*map.name))).collect();
        named.sort_unstable();
        named.dedup_by(|a, b| a.0 == b.0);
        let source = |(path, name): &'_ (PathBuf, &'m str)| {
            let file = path.clone();
            ImageSource {
                id: ImageId::of(path, ImagePart::Whole),
                name,
                read: Box::new(move || {
                    read_regular(&file).map(Cow::Owned).map_err(|error| error.to_string())
                }),
            }
        };
        let sources: Vec<ImageSource> = named.iter().map(source).collect();
        let decoded = self.store.load(&sources);
        self.images.extend(named.into_iter().map(|(path, _)| path).zip(decoded));
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
                let prepared = prepare_image(&image, usage, map.channel, self.store);
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
        let map = roughness.or(metallic)?;
        let key = [metallic, roughness].map(|map| {
            let map = map?;
            Some((confine(self.folder, &map.name)?, map.channel, map.clamp))
        });
        if let Some(&known) = self.merged.get(&key) {
            return Some(place_map(map, known));
        }
        let images = [self.scalars(metallic, file), self.scalars(roughness, file)];
        match merge_maps(&images)? {
            Ok(image) => {
                let image = self.store.keep(image);
                let texture = Texture::new(image, ColorSpace::Linear, wrap(map), Filter::Bilinear);
                let id = self.push(texture.named(&map.name));
                self.merged.insert(key, id);
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
        let prepared = prepare_image(&image, Use::Scalar, map.channel, self.store);
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
        if self.broken.iter().any(|broken| broken.name == map.name) {
            return None;
        }
        let Some(path) = confine(self.folder, &map.name) else {
            self.refuse(map, file, "it leaves the scene's folder: put it there".to_owned());
            return None;
        };
        if !self.images.contains_key(&path) {
            self.preload(std::iter::once(map));
        }
        match self.images.get_mut(&path)? {
            Ok((image, notes)) => {
                let (image, notes) = (Arc::clone(image), std::mem::take(notes));
                let place = || format!("{}:{}", file.display(), map.line);
                let notice =
                    |note| Notice { place: place(), message: format!("{:?} {note}", map.name) };
                self.odd.extend(notes.into_iter().map(notice));
                Some(image)
            }
            Err(reason) => {
                let reason = reason.clone();
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

fn wrap(map: &Map) -> [Wrap; 2] {
    [if map.clamp { Wrap::Clamp } else { Wrap::Repeat }; 2]
}

/// With the map's options. The meshes' v is 1 - v of the file, so `v * s + o` becomes
/// `(1 - v) * s + o` turned over again.
fn place_map(map: &Map, texture: TextureId) -> TextureRef {
    let offset = Vec2::new(map.offset.x, 1.0 - map.scale.y - map.offset.y);
    TextureRef { scale: map.scale, offset, ..TextureRef::new(texture) }
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
        maps.textures[texture.texture.index()].image().rgba().expect("8 bits")
    }

    #[test]
    fn each_use_has_its_channels() {
        let folder = folder();
        let store = TextureStore::default();
        let mut maps = Maps::new(folder.path(), MissingTexture::Error, &store);
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
        let store = TextureStore::default();
        let mut maps = Maps::new(folder.path(), MissingTexture::Error, &store);
        let rough = map("-imfchan m a.png");
        let both = [None, Some(&rough)];
        let texture = maps.metallic_roughness(both, Path::new("a.mtl")).expect("it is there");
        let image = maps.textures[texture.texture.index()].image();
        let texels = image.rgba::<u8>().expect("8 bits, as its file");
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
        let store = TextureStore::default();
        let mut maps = Maps::new(folder.path(), MissingTexture::Error, &store);
        let file = Path::new("a.mtl");
        for name in ["b.png", "b.png", "../a.png"] {
            maps.texture(&map(name), file, Use::Scalar);
        }
        let error = maps.finish(Path::new("a.obj"), &mut Vec::new()).expect_err("two are missing");
        let LoadError::References { broken, .. } = error else { panic!("{error}") };
        let names: Vec<_> = broken.iter().map(|b| (&*b.name, &*b.place)).collect();
        assert_eq!(names, [("b.png", "a.mtl:7"), ("../a.png", "a.mtl:7")]);

        let mut maps = Maps::new(folder.path(), MissingTexture::Magenta, &store);
        assert!(maps.texture(&map("b.png"), file, Use::Color).is_some());
        assert!(maps.texture(&map("b.png"), file, Use::Opacity).is_none());
        let mut notices = Vec::new();
        assert_eq!(maps.finish(Path::new("a.obj"), &mut notices).expect("goes on").len(), 1);
        assert_eq!(notices.len(), 1);
    }
}
