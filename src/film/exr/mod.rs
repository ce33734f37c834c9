//! OpenEXR files: one part of ZIP-compressed float32 scanlines out; any flat file in.

mod colors;
mod piz;
mod plane;
mod read;
mod subsampled;
mod unpack;
mod write;

pub use colors::read_rgb;
pub(crate) use colors::{Framed, decode_rgb, decode_rgba};
pub use read::{decode, read};
pub(crate) use read::{frame_size, size};
pub use write::{Layout, RowsError, encode, write, write_rows};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmError, Picture, Window};
    use proptest::prelude::*;
    use std::path::Path;

    fn small() -> Picture {
        let crop = Window { x0: 3, y0: -2, x1: 8, y1: 18 };
        let mut picture = Picture::new(Window::of_size(64, 32), crop);
        let values: Vec<_> =
            (0..100).map(|i| [i as f32, 0.5 - i as f32, 1.0 / (i + 1) as f32]).collect();
        picture.set_aov("", "RGB", &values);
        picture.set_aov("normal", "XYZ", &values);
        picture.set_channel("A", vec![1.0; 100]);
        picture.set_channel("depth.Z", vec![f32::INFINITY; 100]);
        picture.strings.insert("dapple/seed".to_owned(), "17".to_owned());
        picture.strings.insert("dapple/settings".to_owned(), "spp = 4\nname = \"ü\"\n".to_owned());
        picture
    }

    #[test]
    fn what_is_written_is_read_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.exr");
        write(&path, &small()).expect("written");
        assert_eq!(read(&path).expect("read"), small());
        let (width, height, colours) = read_rgb(&path).expect("read");
        assert_eq!((width, height, colours[7]), (5, 20, [7.0, -6.5, 0.125]));
    }

    #[test]
    fn equal_pictures_are_equal_bytes_and_channels_are_sorted() {
        let bytes = encode(&small()).expect("encoded");
        for _ in 0..8 {
            assert_eq!(encode(&small()).expect("encoded"), bytes);
        }
        let at = |name: &[u8]| bytes.windows(name.len()).position(|it| it == name).expect("there");
        assert!(
            at(b"A\0") < at(b"B\0") && at(b"G\0") < at(b"R\0") && at(b"R\0") < at(b"depth.Z\0")
        );
        assert!(at(b"dapple/seed\0") < at(b"dapple/settings\0"));
    }

    #[test]
    fn files_cut_anywhere_are_errors() {
        let bytes = encode(&small()).expect("encoded");
        for length in 0..bytes.len() {
            let error = decode(&bytes[..length], Path::new("cut.exr")).expect_err("cut short");
            assert_eq!(error.exit_code(), 3, "{length}: {error}");
            assert!(error.to_string().starts_with("cut.exr: "), "{error}");
        }
    }

    #[test]
    fn any_byte_may_be_wrong() {
        // Whatever comes out, it is a picture or an error, and soon.
        let bytes = encode(&small()).expect("encoded");
        for at in 0..bytes.len() {
            for flip in [1, 0x80, 0xff] {
                let mut bytes = bytes.clone();
                bytes[at] ^= flip;
                let _ = decode(&bytes, Path::new("bad.exr"));
            }
        }
    }

    #[test]
    fn claims_beyond_the_file_are_refused_before_memory_is_asked_for() {
        let mut bytes = encode(&small()).expect("encoded");
        let name = b"dataWindow\0box2i\0";
        let at = bytes.windows(name.len()).position(|it| it == name).expect("there") + name.len();
        bytes[at + 4 + 8..at + 4 + 12].copy_from_slice(&16_000_000_i32.to_le_bytes());
        let error = decode(&bytes, Path::new("wide.exr")).expect_err("too wide");
        assert!(error.to_string().contains("limit"), "{error}");
        bytes[at + 4 + 8..at + 4 + 12].copy_from_slice(&10_000_000_i32.to_le_bytes());
        let error = decode(&bytes, Path::new("wide.exr")).expect_err("too wide");
        assert!(error.to_string().contains("in a file of"), "{error}");
    }

    #[test]
    fn pictures_without_pixels_or_channels_are_refused() {
        let mut empty = Picture::new(Window::of_size(4, 4), Window { x0: 2, y0: 2, x1: 2, y1: 4 });
        empty.set_channel("R", Vec::new());
        assert!(encode(&empty).is_err());
        assert!(encode(&Picture::new(Window::of_size(4, 4), Window::of_size(4, 4))).is_err());
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.exr");
        assert!(matches!(write(&path, &empty), Err(FilmError::Invalid { .. })));
        assert!(!path.exists());
    }

    #[test]
    fn what_is_not_supported_is_named() {
        let value = |bytes: &[u8], name: &[u8]| {
            // The value of an attribute comes after its name, its type and its size.
            4 + name.len() + bytes.windows(name.len()).position(|it| it == name).expect("there")
        };
        // Number 8 is DWAA, in blocks of 32 lines: one of them where ZIP has two.
        let mut bytes = encode(&small()).expect("encoded");
        let (kind, count) =
            (value(&bytes, b"compression\0compression\0"), value(&bytes, b"chunkCount\0int\0"));
        assert_eq!((bytes[kind], bytes[count]), (3, 2), "ZIP, two blocks");
        (bytes[kind], bytes[count]) = (8, 1);
        let error = decode(&bytes, Path::new("a.exr")).expect_err("DWAA").to_string();
        assert!(error.starts_with("a.exr: dwaa compression is not supported"), "{error}");
        // The type of the part: deep scanlines, in a version that says so.
        let mut bytes = encode(&small()).expect("encoded");
        let at = bytes.windows(13).position(|it| it == b"scanlineimage").expect("there");
        bytes.splice(at..at + 13, *b"deepscanline");
        bytes[at - 4] = 12;
        bytes[5] |= 0x08;
        let error = decode(&bytes, Path::new("a.exr")).expect_err("deep").to_string();
        assert!(error.starts_with("a.exr: not supported: deep data"), "{error}");
    }

    #[test]
    fn half_floats_in_tiles_are_read_and_of_several_parts_the_one_with_colours() {
        use ::exr::prelude::*;
        let part = |name: &str, channels: [&str; 3]| {
            let values: Vec<f16> = (0..30 * 20).map(|i| f16::from_f32(i as f32)).collect();
            let channel = |name: &str| AnyChannel::new(name, FlatSamples::F16(values.clone()));
            let encoding = Encoding {
                compression: Compression::PIZ,
                blocks: Blocks::Tiles(Vec2(16, 16)),
                line_order: LineOrder::Increasing,
            };
            let channels = AnyChannels::sort(channels.map(channel).into_iter().collect());
            Layer::new((30, 20), LayerAttributes::named(name), encoding, channels)
        };
        let parts = [part("depth", ["Z", "front", "back"]), part("colour", ["R", "G", "B"])];
        let image = Image::from_layers(
            ImageAttributes::new(IntegerBounds::from_dimensions((30, 20))),
            parts.into_iter().collect::<SmallVec<[_; 2]>>(),
        );
        let mut bytes = std::io::Cursor::new(Vec::new());
        image.write().to_buffered(&mut bytes).expect("written");
        let picture = decode(bytes.get_ref(), Path::new("a.exr")).expect("read");
        assert_eq!(picture.crop, Window::of_size(30, 20));
        let names: Vec<_> = picture.channels().iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["B", "G", "R"]);
        let expected: Vec<f32> = (0..600).map(|i| i as f32).collect();
        assert_eq!(picture.channel("G"), Some(&expected[..]));
    }

    #[test]
    fn a_file_of_another_kind_is_named() {
        let error = decode(b"#?RADIANCE\n", Path::new("sky.exr")).expect_err("not EXR");
        assert!(error.to_string().starts_with("sky.exr: not a sound EXR file"), "{error}");
        let error = read(Path::new("no/such.exr")).expect_err("not there");
        assert_eq!(error.to_string(), "no/such.exr: no such file");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn every_float_at_every_place_survives(
            x0 in -40_i32..40, y0 in -40_i32..40, width in 1_usize..40, height in 1_usize..40,
            bits in proptest::collection::vec(any::<u32>(), 1..50),
        ) {
            let crop = Window { x0, y0, x1: x0 + width as i32, y1: y0 + height as i32 };
            let mut picture = Picture::new(Window::of_size(100, 100), crop);
            let samples = bits.iter().cycle().take(width * height).map(|&it| f32::from_bits(it));
            picture.set_channel("Y", samples.collect());
            let bytes = encode(&picture).expect("encoded");
            let back = decode(&bytes, Path::new("a.exr")).expect("decoded");
            prop_assert_eq!(back.crop, crop);
            let same = |name| {
                let bits = |it: &Picture| -> Vec<u32> {
                    it.channel(name).expect("there").iter().map(|it| it.to_bits()).collect()
                };
                bits(&picture) == bits(&back)
            };
            prop_assert!(same("Y"));
        }
    }
}
