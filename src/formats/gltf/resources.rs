//! What a document refers to, brought into memory: buffers, and images for textures. All that is
//! missing or broken is found before any of it is reported.
//!
//! Images may be of any format that dapple reads, whatever their `mimeType`; those of floats (hdr,
//! exr, tiff) hold linear colours, also where glTF would have sRGB.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::json::{Fault, Object};
use super::notices::Notices;
use super::read::Storage;
use super::texture::{ImageDeclaration, ImageSource, TextureDeclaration};
use crate::formats::{Broken, LoadOptions, MissingTexture, uri};
use crate::texture::{ColorSpace, Decoded, ImageId, ImagePart, Texture, TextureStore};

/// A buffer as the document declares it.
#[derive(Clone, Debug)]
pub struct BufferDeclaration {
    /// A file or data URI; none: the container's binary chunk.
    pub uri: Option<String>,
    /// Bytes.
    pub length: u64,
}

/// Reads the buffers' declarations.
pub fn buffers(root: &Object) -> Result<Vec<BufferDeclaration>, Fault> {
    let buffer = |object: &Object| {
        let length = object.required_whole("byteLength")?;
        if length == 0 {
            return Err(object.fault_at("byteLength", "must be at least 1"));
        }
        Ok(BufferDeclaration { uri: object.text("uri")?.map(str::to_owned), length })
    };
    root.objects("buffers")?.iter().map(buffer).collect()
}

/// The bytes of those buffers that are `needed`; `binary` is the container's chunk. What is
/// missing goes to `broken`.
pub fn load_buffers<'a>(
    declarations: &[BufferDeclaration],
    needed: &[bool],
    binary: Option<&'a [u8]>,
    folder: &Path,
    broken: &mut Vec<Broken>,
) -> Vec<Option<Cow<'a, [u8]>>> {
    let mut buffers = Vec::with_capacity(declarations.len());
    for (i, (declaration, &needed)) in declarations.iter().zip(needed).enumerate() {
        let bytes = if needed { load_buffer(declaration, i, binary, folder) } else { Ok(None) };
        buffers.push(bytes.unwrap_or_else(|reason| {
            broken.push(Broken {
                name: display_uri(declaration.uri.as_deref().unwrap_or_default()),
                place: format!("/buffers/{i}"),
                reason,
                texture: false,
            });
            None
        }));
    }
    buffers
}

fn load_buffer<'a>(
    declaration: &BufferDeclaration,
    index: usize,
    binary: Option<&'a [u8]>,
    folder: &Path,
) -> Result<Option<Cow<'a, [u8]>>, String> {
    let bytes: Cow<[u8]> = match (&declaration.uri, binary) {
        (Some(uri), _) => uri::read(folder, uri)?.into(),
        (None, Some(chunk)) if index == 0 => chunk.into(),
        (None, _) => return Err("has neither a URI nor the binary chunk of a GLB".to_owned()),
    };
    if (bytes.len() as u64) < declaration.length {
        return Err(format!("holds {} bytes of {}", bytes.len(), declaration.length));
    }
    Ok(Some(bytes))
}

/// A name for messages: the text of data URIs is long and says nothing.
fn display_uri(uri: &str) -> String {
    if uri.get(..5).is_some_and(|head| head.eq_ignore_ascii_case("data:")) {
        String::new()
    } else {
        uri.to_owned()
    }
}

/// What to call an image: the file that it is in, else what the document calls it.
pub fn name_of(image: &ImageDeclaration) -> String {
    let file = match &image.source {
        ImageSource::Uri(uri) => display_uri(uri),
        ImageSource::View(_) => String::new(),
    };
    if file.is_empty() { image.name.clone() } else { file }
}

/// Makes the textures in `slots`, which are indices into `textures`. Each image is decoded once.
/// What is missing or broken goes to `broken`, or is noted, and colours are magenta; `None` is what
/// holds no colours, to be left out. Where a WebP or KTX2 image cannot be used, the one that the
/// texture has for other programs is, and that is noted.
pub fn load_textures(
    slots: &[(usize, ColorSpace)],
    textures: &[TextureDeclaration],
    images: &[ImageDeclaration],
    storage: &Storage,
    path: &Path,
    options: &LoadOptions,
    broken: &mut Vec<Broken>,
    notices: &mut Notices,
) -> Vec<Option<Texture>> {
    let missing = options.missing_texture;
    let decode_images = |used| decode_images(used, images, storage, path, &options.textures);
    let mut decoded = BTreeMap::new();
    loop {
        // Of each texture the first image that is not known to be of no use.
        let next = |&(texture, _): &(usize, ColorSpace)| {
            let usable = |image: &&usize| decoded.get(*image).is_none_or(Decoded::is_ok);
            textures[texture].images.iter().find(usable)
        };
        let wanted = slots.iter().filter_map(next).filter(|image| !decoded.contains_key(*image));
        let wanted: Vec<usize> = wanted.copied().collect();
        if wanted.is_empty() {
            break;
        }
        decoded.extend(decode_images(wanted));
    }

    // Of each texture the image that it has, if it has any, and the one that it gets.
    let choose = |&(texture, _): &(usize, ColorSpace)| {
        let images = &textures[texture].images;
        let usable = |image: &&usize| decoded.get(*image).is_some_and(Decoded::is_ok);
        images.first().map(|&first| (first, *images.iter().find(usable).unwrap_or(&first)))
    };
    let chosen: Vec<Option<(usize, usize)>> = slots.iter().map(choose).collect();
    // In the order of the images.
    for (image, got) in chosen.iter().flatten().collect::<BTreeSet<_>>() {
        let (place, name) = (&images[*image].place, name_of(&images[*got]));
        match (&decoded[image], &decoded[got]) {
            (Err(reason), Ok(_)) => {
                let message = format!("{:?}: {reason}: {name:?} is used", name_of(&images[*image]));
                notices.add(place, message);
            }
            (_, Err(reason)) => report(name, place, reason, missing, broken, notices),
            (Ok(_), Ok(_)) => {}
        }
        for note in decoded[got].iter().flat_map(|(_, notes)| notes) {
            notices.add(&images[*got].place, format!("{:?} {note}", name_of(&images[*got])));
        }
    }
    let mut texture = |(&(index, color_space), chosen): (&(usize, ColorSpace), &_)| {
        let TextureDeclaration { place, avif, wrap, filter, .. } = &textures[index];
        let magenta = || (color_space == ColorSpace::Srgb).then(Texture::magenta);
        let Some((_, got)) = chosen else {
            let reason = if *avif {
                "is of AVIF alone (EXT_texture_avif), which dapple does not read"
            } else {
                "has no image that dapple can read"
            };
            report(String::new(), place, reason, missing, broken, notices);
            return magenta();
        };
        let Ok((found, _)) = &decoded[got] else { return magenta() };
        let texture = Texture::new(found.clone(), color_space, *wrap, *filter);
        Some(texture.named(name_of(&images[*got])))
    };
    slots.iter().zip(&chosen).map(&mut texture).collect()
}

/// Says that an image is missing: in `broken`, or as a notice.
pub fn report(
    name: String,
    place: &str,
    reason: &str,
    missing: MissingTexture,
    broken: &mut Vec<Broken>,
    notices: &mut Notices,
) {
    match missing {
        MissingTexture::Error => {
            let (place, reason) = (place.to_owned(), reason.to_owned());
            broken.push(Broken { name, place, reason, texture: true });
        }
        MissingTexture::Magenta => {
            let name = if name.is_empty() { name } else { format!("{name:?}: ") };
            notices.add(place, format!("{name}{reason}: colours are magenta, others left out"));
        }
    }
}

/// Decodes those images that are `used`.
pub fn decode_images(
    mut used: Vec<usize>,
    images: &[ImageDeclaration],
    storage: &Storage,
    path: &Path,
    store: &TextureStore,
) -> BTreeMap<usize, Decoded> {
    used.sort_unstable();
    used.dedup();
    let folder = path.parent().unwrap_or(Path::new(""));
    let source = |&image: &usize| match &images[image].source {
        ImageSource::Uri(uri) => crate::texture::ImageSource {
            id: match uri::file(folder, uri) {
                Ok(file) => ImageId::of(&file, ImagePart::Whole),
                Err(_) => ImageId::of(path, ImagePart::Image(image)),
            },
            name: uri,
            read: Box::new(move || uri::read(folder, uri).map(Cow::Owned)),
        },
        ImageSource::View(view) => {
            let found = storage.view(*view);
            let found = found.map_err(|fault| format!("{} {}", fault.place, fault.message));
            crate::texture::ImageSource {
                id: ImageId::of(path, ImagePart::View(*view)),
                name: "",
                read: Box::new(move || found.clone().map(Cow::Borrowed)),
            }
        }
    };
    let sources: Vec<_> = used.iter().map(source).collect();
    let decoded = store.load(&sources);
    used.into_iter().zip(decoded).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffers_come_from_data_or_the_container_and_must_be_long_enough() {
        let declaration =
            |uri: Option<&str>, length| BufferDeclaration { uri: uri.map(str::to_owned), length };
        let declarations = [
            declaration(None, 2),
            declaration(Some("data:;base64,AAEC"), 4),
            declaration(None, 1),
            declaration(Some("missing.bin"), 1),
        ];
        let mut broken = Vec::new();
        let needed = [true, true, true, false];
        let folder = Path::new("nowhere");
        let loaded = load_buffers(&declarations, &needed, Some(b"abc"), folder, &mut broken);
        assert_eq!(loaded[0].as_deref(), Some(&b"abc"[..]));
        assert_eq!(broken.len(), 2);
        assert_eq!(broken[0].reason, "holds 3 bytes of 4");
        assert_eq!((broken[0].name.as_str(), broken[1].place.as_str()), ("", "/buffers/2"));
    }
}
