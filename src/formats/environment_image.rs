//! Latitude-longitude images of surroundings, from files of any format that textures may have but
//! KTX2.

use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::Path;

use ::image::{ImageFormat, ImageReader};

use super::LoadError;
use super::environment_repair::{self, NotFinite};
use crate::files::{self, memory};
use crate::film::radiance::{self, RadianceError, is_radiance};
use crate::film::{FilmError, exr};
use crate::scene::Notice;
use crate::texture::{FileLevels, Image, Texels, Value, spread, srgb_to_linear};

/// The most pixels of an image of floats: 16384 by 8192.
const MAX_PIXELS: u64 = 1 << 27;
/// The most pixels of others, which take more memory on their way.
const MAX_LOW_RANGE_PIXELS: u64 = 1 << 25;
/// The longest file of them: more than eight bytes for each of so many pixels.
const MAX_LOW_RANGE_BYTES: u64 = 1 << 30;

/// Colours, twice while they are decoded, and tables to choose pixels by.
const BYTES_A_PIXEL: u64 = 48;

/// What is said of a file of no such format. KTX2, which textures may be, is none of them.
const NOT_READ: &str = "not an image that dapple reads as surroundings (png, jpeg, webp, tga, bmp, \
                        gif, tiff, hdr, exr)";

/// Linear radiance by rows from the top, all finite and not negative.
#[derive(Debug, PartialEq)]
pub struct EnvironmentImage {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue.
    pub pixels: Vec<[f32; 3]>,
}

impl EnvironmentImage {
    /// Reads a file; its first bytes tell the format. Eight and sixteen bit images are taken as
    /// sRGB. Negative values are taken as zero, which is said, as are other oddities.
    ///
    /// # Errors
    /// [`LoadError`] with the file's name, if it cannot be read or decoded, is larger than 16384
    /// by 8192 pixels (8192 by 4096 where it is no image of floats), or holds a value that is not
    /// finite and not to be repaired.
    pub fn read(path: &Path, not_finite: NotFinite) -> Result<(Self, Vec<Notice>), LoadError> {
        let (file, length) = files::open(path).map_err(|source| {
            let missing = "no such file, nor is it a colour as R,G,B";
            let source = match source.kind() {
                io::ErrorKind::NotFound => io::Error::other(missing),
                _ => source,
            };
            LoadError::read(path, source)
        })?;
        Self::decode(BufReader::new(file), length, path, not_finite)
    }

    /// The same of `length` bytes from anywhere; `path` is for messages.
    ///
    /// # Errors
    /// As [`EnvironmentImage::read`].
    pub fn decode(
        mut source: impl BufRead + Seek,
        length: u64,
        path: &Path,
        not_finite: NotFinite,
    ) -> Result<(Self, Vec<Notice>), LoadError> {
        let mut notices = Vec::new();
        let mut notice = |message: String| {
            notices.push(Notice { place: path.display().to_string(), message });
        };
        let format = format(&mut source).map_err(|source| LoadError::read(path, source))?;
        let mut image = match format {
            Format::Exr => exr(source, length, path, &mut notice)?,
            Format::Hdr => hdr(source, length, path, &mut notice)?,
            Format::Other => {
                let image = low_range(source, length, path, &mut notice)?;
                notice("is an image of low dynamic range: it cannot hold the sun".to_owned());
                image
            }
        };
        image.check(path, not_finite, &mut notice)?;
        Ok((image, notices))
    }

    /// Refuses or repairs what is not finite, and says what is odd.
    fn check(
        &mut self,
        path: &Path,
        not_finite: NotFinite,
        notice: &mut impl FnMut(String),
    ) -> Result<(), LoadError> {
        let Self { width, height, pixels } = self;
        let odd = |pixel: &[f32; 3]| !environment_repair::is_finite(pixel);
        if let Some(first) = pixels.iter().position(odd) {
            let count = pixels.iter().filter(|pixel| odd(pixel)).count();
            let place = format!("pixel {}, {}", first % *width, first / *width);
            let refused = |what: &str| {
                let message = format!("is infinite or not a number ({count} such pixels): {what}");
                LoadError::invalid(path, &place, message)
            };
            match not_finite {
                NotFinite::Refuse => return Err(refused("repair the image, or use --env-repair")),
                NotFinite::Repair => environment_repair::repair(*width, pixels)
                    .map_err(|_| refused("they are too close together to be repaired"))?,
            }
            notice(format!(
                "{count} pixels are infinite or not a number: the mean of their neighbours takes \
                 their place"
            ));
        }
        let (mut negative, mut least) = (0, 0.0_f32);
        for pixel in pixels.iter_mut().filter(|pixel| pixel.iter().any(|&value| value < 0.0)) {
            negative += 1;
            least = pixel.iter().fold(least, |least, &value| least.min(value));
            *pixel = pixel.map(|value| value.max(0.0));
        }
        if negative > 0 {
            notice(format!("{negative} pixels are negative, down to {least}: taken as zero"));
        }
        if pixels.iter().all(|pixel| *pixel == [0.0; 3]) {
            notice("is wholly black".to_owned());
        }
        if *width != 2 * *height {
            notice(format!(
                "is {width} by {height}, not twice as wide as high: it is taken as a map of all \
                 directions nevertheless"
            ));
        }
        Ok(())
    }
}

enum Format {
    Exr,
    Hdr,
    Other,
}

/// By the first bytes; the next to be read is the first again.
fn format(source: &mut (impl Read + Seek)) -> io::Result<Format> {
    let mut start = Vec::new();
    source.by_ref().take(10).read_to_end(&mut start)?;
    source.rewind()?;
    Ok(if start.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        Format::Exr
    } else if is_radiance(&start) {
        Format::Hdr
    } else {
        Format::Other
    })
}

/// Refuses what is beyond `most` pixels, or beyond the memory that is left.
fn check_size(path: &Path, width: u64, height: u64, most: u64) -> Result<(), LoadError> {
    let pixels = width.saturating_mul(height);
    if pixels > most {
        let message = format!("{width} by {height} pixels are too many: at most {most}");
        return Err(LoadError::invalid(path, "", message));
    }
    memory::claim(pixels * BYTES_A_PIXEL)
        .map_err(|error| LoadError::invalid(path, "", format!("{error}: make it smaller")))
}

fn exr(
    mut source: impl Read + Seek,
    length: u64,
    path: &Path,
    notice: &mut impl FnMut(String),
) -> Result<EnvironmentImage, LoadError> {
    // A header alone can claim any size; what follows is checked by the reader.
    let meta = ::exr::meta::MetaData::read_from_unbuffered(&mut source, false);
    source.rewind().map_err(|source| LoadError::read(path, source))?;
    for header in meta.iter().flat_map(|meta| &meta.headers) {
        let (width, height) = exr::frame_size(header);
        check_size(path, width, height, MAX_PIXELS)?;
    }
    let exr::Framed { width, height, pixels, notes } = exr::decode_rgb(source, length, path)
        .map_err(|error| match error {
            FilmError::Invalid { path, message } => LoadError::invalid(&path, "", message),
            FilmError::Read { path, source } => LoadError::read(&path, source),
            other => LoadError::invalid(path, "", other.to_string()),
        })?;
    notes.into_iter().for_each(notice);
    Ok(EnvironmentImage { width, height, pixels })
}

fn hdr(
    mut source: impl BufRead,
    length: u64,
    path: &Path,
    notice: &mut impl FnMut(String),
) -> Result<EnvironmentImage, LoadError> {
    let failed = |error| match error {
        RadianceError::Read(source) => LoadError::read(path, source),
        other => LoadError::invalid(path, "", other.to_string()),
    };
    let header = radiance::Header::read(&mut source).map_err(failed)?;
    let (width, height) = (header.width, header.height);
    check_size(path, width as u64, height as u64, MAX_PIXELS)?;
    let pixels = radiance::read_pixels(&mut source, &header, length).map_err(failed)?;
    header.notes().into_iter().for_each(notice);
    Ok(EnvironmentImage { width, height, pixels })
}

fn low_range(
    mut source: impl Read,
    length: u64,
    path: &Path,
    notice: &mut impl FnMut(String),
) -> Result<EnvironmentImage, LoadError> {
    let failed = |message: String| LoadError::invalid(path, "", message);
    if length > MAX_LOW_RANGE_BYTES {
        return Err(failed("is larger than 1 GiB".to_owned()));
    }
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes).map_err(|source| LoadError::read(path, source))?;
    let known = ::image::guess_format(&bytes).or_else(|_| ImageFormat::from_path(path));
    let known = known.map_err(|_| failed(NOT_READ.to_owned()))?;
    let size = ImageReader::with_format(io::Cursor::new(&bytes), known).into_dimensions();
    let (width, height) = size.map_err(|error| failed(error.to_string()))?;
    check_size(path, width.into(), height.into(), MAX_LOW_RANGE_PIXELS)?;
    let image = Image::decode_noting(&bytes, &path.display().to_string(), FileLevels::First);
    let (image, notes) = image.map_err(|error| failed(error.to_string()))?;
    notes.into_iter().for_each(&mut *notice);
    if !image.is_opaque() {
        notice("its alpha is not honoured".to_owned());
    }
    let channels = usize::from(image.channels());
    let pixels = match &*image.texels() {
        Texels::U8(all) => {
            let decode: Vec<f32> =
                (0..=255_u8).map(|v| srgb_to_linear(f32::from(v) / 255.0)).collect();
            colors(all, channels, |v| decode[usize::from(v)])
        }
        Texels::U16(all) => colors(all, channels, |v| srgb_to_linear(f32::from(v) / 65535.0)),
        Texels::F32(all) => colors(all, channels, |v| v),
    };
    Ok(EnvironmentImage { width: width as usize, height: height as usize, pixels })
}

/// The linear colours of texels of so many channels.
fn colors<T: Value>(values: &[T], channels: usize, linear: impl Fn(T) -> f32) -> Vec<[f32; 3]> {
    let color = |texel: &[T]| {
        let [r, g, b, _] = spread(texel);
        [r, g, b].map(&linear)
    };
    values.chunks_exact(channels).map(color).collect()
}

#[cfg(test)]
mod tests {
    use ::image::codecs::hdr::HdrEncoder;
    use ::image::{Rgb, RgbImage};
    use std::fs::File;

    use super::*;
    use crate::film::{Picture, Window};

    fn folder() -> tempfile::TempDir {
        tempfile::tempdir().expect("the system's temporary folder is writable")
    }

    /// Writes a 2 by 1 image of floats.
    fn write_hdr(path: &Path, pixels: [[f32; 3]; 2]) {
        let file = File::create(path).expect("the folder is writable");
        HdrEncoder::new(file).encode(&pixels.map(Rgb), 2, 1).expect("it can be written");
    }

    #[test]
    fn radiance_files_keep_their_range() {
        let folder = folder();
        let path = folder.path().join("a.hdr");
        write_hdr(&path, [[1000.0, 0.5, 0.0], [0.25, 0.25, 0.25]]);
        let (image, notices) =
            EnvironmentImage::read(&path, NotFinite::Refuse).expect("it is well-formed");
        assert_eq!((image.width, image.height), (2, 1));
        // Eight bits of mantissa under one exponent.
        assert!((image.pixels[0][0] - 1000.0).abs() < 4.0);
        assert_eq!(image.pixels[1], [0.25; 3]);
        assert!(notices.is_empty(), "{notices:?}");
    }

    #[test]
    fn other_images_are_decoded_and_said_to_be_low() {
        let folder = folder();
        let path = folder.path().join("a.png");
        let texels = vec![255, 188, 0, 255, 255, 255];
        let image = RgbImage::from_raw(2, 1, texels).expect("two texels");
        image.save(&path).expect("it can be written");
        let (image, notices) =
            EnvironmentImage::read(&path, NotFinite::Refuse).expect("it is well-formed");
        assert_eq!(image.pixels[0][0], 1.0);
        assert!((image.pixels[0][1] - 0.502_886_5).abs() < 1e-6);
        assert_eq!(notices.len(), 1);
    }

    #[test]
    fn what_is_not_finite_is_refused_and_what_is_negative_is_said() {
        let path = Path::new("a.exr");
        let checked = |pixels: Vec<[f32; 3]>| {
            let (mut said, not_finite) = (Vec::new(), NotFinite::Refuse);
            let mut image = EnvironmentImage { width: 2, height: 1, pixels };
            let checked = image.check(path, not_finite, &mut |message| said.push(message));
            checked.map(|()| (image.pixels, said))
        };
        let error = checked(vec![[0.0; 3], [1.0, f32::NAN, 0.0]]).expect_err("it is NaN");
        assert_eq!(
            error.to_string(),
            "a.exr: pixel 1, 0: is infinite or not a number (1 such pixels): repair the image, or \
             use --env-repair"
        );
        let (pixels, said) = checked(vec![[-0.5, 1.0, 0.0], [0.0; 3]]).expect("it is finite");
        assert_eq!(pixels[0], [0.0, 1.0, 0.0]);
        assert_eq!(said, ["1 pixels are negative, down to -0.5: taken as zero"]);
        let (_, said) = checked(vec![[0.0; 3]; 2]).expect("it is finite");
        assert_eq!(said, ["is wholly black"]);
    }

    #[test]
    fn damaged_files_are_errors_with_their_name() {
        let folder = folder();
        let path = folder.path().join("a.hdr");
        write_hdr(&path, [[1.0; 3]; 2]);
        let whole = std::fs::read(&path).expect("it was written");
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).expect("the folder is writable");
            let error = EnvironmentImage::read(&path, NotFinite::Refuse)
                .expect_err("it is cut")
                .to_string();
            assert!(error.contains("a.hdr: "), "{error}");
        }
        let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8000 +X 16000\n";
        std::fs::write(&path, huge).expect("the folder is writable");
        let error = EnvironmentImage::read(&path, NotFinite::Refuse)
            .expect_err("nothing follows")
            .to_string();
        assert!(error.ends_with("a.hdr: the file ends in row 1 of 8000"), "{error}");
        assert!(EnvironmentImage::read(folder.path(), NotFinite::Refuse).is_err());
    }

    #[test]
    fn what_is_not_finite_is_repaired_where_that_is_asked_for() {
        let folder = folder();
        let path = folder.path().join("a.exr");
        let window = Window::of_size(4, 2);
        let mut picture = Picture::new(window, window);
        let mut pixels = [[2.0_f32; 3]; 8];
        (pixels[1], pixels[3][2]) = ([f32::INFINITY; 3], f32::NAN);
        picture.set_aov("", "RGB", &pixels);
        exr::write(&path, &picture).expect("the folder is writable");
        assert!(EnvironmentImage::read(&path, NotFinite::Refuse).is_err());
        let (image, notices) =
            EnvironmentImage::read(&path, NotFinite::Repair).expect("it can be repaired");
        assert_eq!(image.pixels, [[2.0; 3]; 8]);
        assert_eq!(notices.len(), 1);
        assert!(notices[0].message.starts_with("2 pixels are infinite"), "{notices:?}");
        picture.set_aov("", "RGB", &[[f32::NAN; 3]; 8]);
        exr::write(&path, &picture).expect("the folder is writable");
        let error = EnvironmentImage::read(&path, NotFinite::Repair).expect_err("nothing is left");
        assert!(error.to_string().ends_with("too close together to be repaired"), "{error}");
    }

    #[test]
    fn formats_and_pixels_that_are_not_honoured_are_named() {
        let decode = |bytes: &[u8], name: &str| {
            let (source, length) = (io::Cursor::new(bytes), bytes.len() as u64);
            EnvironmentImage::decode(source, length, Path::new(name), NotFinite::Refuse)
        };
        let wide = b"#?RADIANCE\nPIXASPECT=2\n\n-Y 1 +X 2\n\x80\x80\x80\x81\x80\x80\x80\x81";
        let (_, notices) = decode(wide, "a.hdr").expect("it is sound");
        assert!(notices[0].message.starts_with("PIXASPECT is 2"), "{notices:?}");
        let error = decode(b"\xabKTX 20\xbb\r\n\x1a\n", "a.ktx2").expect_err("is no panorama");
        let said = error.to_string();
        assert!(said.contains("reads as surroundings (png") && !said.contains("ktx2,"), "{said}");
    }

    /// What is seen in the frame is where the file says, and around it is nothing.
    #[test]
    fn a_part_of_a_frame_covers_that_part_alone() {
        let folder = folder();
        let path = folder.path().join("a.exr");
        let crop = Window { x0: 1, y0: 0, x1: 3, y1: 1 };
        let mut picture = Picture::new(Window::of_size(4, 2), crop);
        picture.set_aov("", "RGB", &[[1.0; 3], [2.0; 3]]);
        exr::write(&path, &picture).expect("the folder is writable");
        let (image, notices) =
            EnvironmentImage::read(&path, NotFinite::Refuse).expect("it is well-formed");
        let red: Vec<f32> = image.pixels.iter().map(|pixel| pixel[0]).collect();
        assert_eq!(red, [0.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(notices.len(), 1, "{notices:?}");
    }
}
