use image::{DynamicImage, ImageBuffer};

use super::*;
use crate::film::{Picture, Window};

fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), format).expect("encodes");
    bytes
}

fn png(image: impl Into<DynamicImage>) -> Vec<u8> {
    encoded(&image.into(), ImageFormat::Png)
}

/// Writes nothing, as decoders do where a damaged file lacks something.
struct Lacking;

impl ImageDecoder for Lacking {
    fn dimensions(&self) -> (u32, u32) {
        (3, 2)
    }

    fn color_type(&self) -> ColorType {
        ColorType::L8
    }

    fn read_image(self, _: &mut [u8]) -> Result<(), image::ImageError> {
        Ok(())
    }

    fn read_image_boxed(self: Box<Self>, _: &mut [u8]) -> Result<(), image::ImageError> {
        Ok(())
    }
}

#[test]
fn what_an_image_lacks_is_not_taken_from_the_one_before() {
    for room in [vec![7; 100], vec![7; 2], Vec::new()] {
        assert_eq!(read_into(room, Lacking).expect("is read"), [0; 6]);
    }
}

#[test]
fn channels_and_bits_are_those_of_the_file() {
    let buffer = |channels: usize| (0..2 * channels as u16).map(|v| v * 1000 + 7).collect();
    let deep: [DynamicImage; 4] = [
        DynamicImage::ImageLuma16(ImageBuffer::from_raw(2, 1, buffer(1)).expect("two")),
        DynamicImage::ImageLumaA16(ImageBuffer::from_raw(2, 1, buffer(2)).expect("two")),
        DynamicImage::ImageRgb16(ImageBuffer::from_raw(2, 1, buffer(3)).expect("two")),
        DynamicImage::ImageRgba16(ImageBuffer::from_raw(2, 1, buffer(4)).expect("two")),
    ];
    for image in deep {
        let channels = image.color().channel_count();
        let bytes = png(image.clone());
        let decoded = Image::decode(&bytes, "").expect("decodes");
        let expected = Texels::U16(image.as_bytes().chunks_exact(2).map(native).collect());
        assert!(decoded == Image::new(2, 1, channels, expected), "{:?}", image.color());
        assert_eq!(
            Image::decoded_bytes(&bytes, "", FileLevels::First).expect("tells"),
            4 * u64::from(channels)
        );
        let rgba: Vec<[u16; 4]> = image.to_rgba16().pixels().map(|pixel| pixel.0).collect();
        assert_eq!(decoded.rgba::<u16>(), Some(rgba));

        let shallow = DynamicImage::from(image.to_luma8());
        for image in [shallow, image.to_luma_alpha8().into(), image.to_rgb8().into()] {
            let channels = image.color().channel_count();
            let expected = Texels::U8(image.as_bytes().to_vec());
            let rgba: Vec<[u8; 4]> = image.to_rgba8().pixels().map(|pixel| pixel.0).collect();
            let decoded = Image::decode(&png(image), "").expect("decodes");
            assert!(decoded == Image::new(2, 1, channels, expected));
            assert_eq!(decoded.rgba::<u8>(), Some(rgba));
        }
    }
}

fn native(bytes: &[u8]) -> u16 {
    u16::from_ne_bytes([bytes[0], bytes[1]])
}

#[test]
fn a_png_that_claims_to_be_huge_is_refused_before_it_is_allocated() {
    let grey = image::GrayImage::from_raw(1, 1, vec![7]).expect("one texel");
    let mut bytes = png(grey);
    bytes[16..20].copy_from_slice(&60000_u32.to_be_bytes()); // the width in IHDR
    assert!(Image::decode(&bytes, "a.png").is_err());
}

#[test]
fn bytes_of_no_format_are_named_so() {
    let error = Image::decode(b"hello", "a.txt").expect_err("is no image");
    assert!(matches!(error, ImageError::UnknownFormat), "{error}");
}

#[test]
fn what_has_no_signature_is_told_by_its_ending() {
    let mut tga = vec![0; 18];
    (tga[2], tga[12], tga[14], tga[16]) = (2, 1, 1, 24); // colours, 1 by 1 of 24 bits
    tga.extend([1, 2, 3]);
    let decoded = Image::decode(&tga, "a.tga").expect("decodes");
    assert!(decoded == Image::of(1, 1, vec![[3_u8, 2, 1]]));
    assert!(matches!(Image::decode(&tga, "a"), Err(ImageError::UnknownFormat)));
}

#[test]
fn radiance_files_are_floats() {
    let texels = vec![4.0, 0.5, 0.0, 0.25, 0.25, 0.25];
    let image = image::Rgb32FImage::from_raw(2, 1, texels).expect("two texels");
    let bytes = encoded(&image.into(), ImageFormat::Hdr);
    let decoded = Image::decode(&bytes, "a.hdr").expect("decodes");
    let expected = vec![[4.0_f32, 0.5, 0.0], [0.25, 0.25, 0.25]];
    assert!(decoded == Image::of(2, 1, expected));
    assert_eq!(Image::decoded_bytes(&bytes, "a.hdr", FileLevels::First).expect("tells"), 24);

    // Of another program, under an exposure.
    let mut other = b"#?RGBE\nEXPOSURE=4\n\n-Y 2 +X 1\n".to_vec();
    other.extend([128, 128, 128, 129, 128, 128, 128, 129]);
    let decoded = Image::decode(&other, "a").expect("the first bytes tell");
    assert!(decoded == Image::of(1, 2, vec![[0.25_f32; 3]; 2]));
    let error = Image::decode(&other[..other.len() - 1], "a").expect_err("is cut");
    assert_eq!(error.to_string(), "the file ends in row 2 of 2");
    let huge = b"#?RGBE\n\n-Y 16384 +X 16384\n";
    assert!(
        Image::decode(huge, "a").is_err()
            && Image::decoded_bytes(huge, "a", FileLevels::First).is_err()
    );
}

/// As a picture of a part of its frame: what is beyond is clear, and that is said.
#[test]
fn a_part_of_a_frame_is_at_its_place() {
    let mut picture = Picture::new(Window::of_size(2, 2), Window { x0: 1, y0: 1, x1: 2, y1: 2 });
    picture.set_channel("Y", vec![1.0]);
    let bytes = exr::encode(&picture).expect("encodes");
    let (image, notes) = Image::decode_noting(&bytes, "a.exr", FileLevels::First).expect("decodes");
    let expected = vec![[0.0_f32; 2], [0.0; 2], [0.0; 2], [1.0; 2]];
    assert!(image == Image::of(2, 2, expected), "grey with alpha");
    assert_eq!(notes.len(), 1);
    assert_eq!(Image::decoded_bytes(&bytes, "a.exr", FileLevels::First).expect("tells"), 64);
}

fn exr_of(channels: &[(&str, [f32; 2])]) -> Vec<u8> {
    let window = Window::of_size(2, 1);
    let mut picture = Picture::new(window, window);
    for (name, values) in channels {
        picture.set_channel(*name, values.to_vec());
    }
    exr::encode(&picture).expect("encodes")
}

#[test]
fn open_exr_files_are_floats_and_their_alpha_is_taken_out() {
    let coloured = exr_of(&[
        ("R", [8.0, 0.5]),
        ("G", [1.0, 0.25]),
        ("B", [0.0, 0.125]),
        ("A", [1.0, 0.5]),
        ("depth.Z", [f32::INFINITY; 2]),
    ]);
    let decoded = Image::decode(&coloured, "a.exr").expect("decodes");
    let expected = vec![[8.0_f32, 1.0, 0.0, 1.0], [1.0, 0.5, 0.25, 0.5]];
    assert!(decoded == Image::of(2, 1, expected));
    assert_eq!(Image::decoded_bytes(&coloured, "a.exr", FileLevels::First).expect("tells"), 32);

    let grey = exr_of(&[("Y", [3.0, 0.5])]);
    let decoded = Image::decode(&grey, "a.png").expect("the first bytes tell");
    assert!(decoded == Image::of(2, 1, vec![[3.0_f32], [0.5]]));

    let broken = exr_of(&[("Y", [3.0, f32::NAN])]);
    let error = Image::decode(&broken, "a.exr").expect_err("is NaN");
    assert!(matches!(error, ImageError::NotFinite { x: 1, y: 0 }), "{error}");
    let error = Image::decode(&exr_of(&[("Z", [1.0; 2])]), "a.exr").expect_err("no colours");
    assert_eq!(error.to_string(), "no channels R, G, B and no Y; it has Z");
    let is_refused = |length: usize| Image::decode(&coloured[..length], "a.exr").is_err();
    assert!((0..coloured.len()).all(is_refused));
}
