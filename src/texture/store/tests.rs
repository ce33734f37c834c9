use std::sync::atomic::AtomicUsize;

use ::image::{DynamicImage, GrayImage, ImageFormat, RgbImage};
use proptest::prelude::*;

use super::*;
use crate::math::Vec2;
use crate::texture::{ColorSpace, Filter, Texels, Texture, Wrap};

/// A PNG of so many texels a side, grey or coloured.
fn png(side: u32, number: u32, grey: bool) -> Vec<u8> {
    let value = |x: u32, y: u32| (x * 7 + y * 31 + number * 13 + x * y) as u8;
    let image: DynamicImage = if grey {
        GrayImage::from_fn(side, side, |x, y| [value(x, y)].into()).into()
    } else {
        RgbImage::from_fn(side, side, |x, y| [value(x, y), number as u8, x as u8].into()).into()
    };
    let mut bytes = Vec::new();
    image.write_to(&mut std::io::Cursor::new(&mut bytes), ImageFormat::Png).expect("encodes");
    bytes
}

fn source<'a>(id: Option<ImageId>, bytes: &'a [u8], count: &'a AtomicUsize) -> ImageSource<'a> {
    let read = move || {
        count.fetch_add(1, Relaxed);
        Ok(Cow::Borrowed(bytes))
    };
    ImageSource { id, name: "", read: Box::new(read) }
}

#[test]
fn a_file_is_decoded_once_however_often_it_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.png");
    let bytes = png(8, 0, false);
    fs::write(&path, &bytes).expect("written");
    let id = || ImageId::of(&path, ImagePart::Whole);
    let indirect = folder.path().join(".").join("a.png");
    assert_eq!(id(), ImageId::of(&indirect, ImagePart::Whole));
    assert_ne!(id(), ImageId::of(&path, ImagePart::View(0)));
    assert_eq!(ImageId::of(&folder.path().join("b.png"), ImagePart::Whole), None);

    let (store, count) = (TextureStore::default(), AtomicUsize::new(0));
    let named = || source(id(), &bytes, &count);
    let of = |sources: &[ImageSource]| -> Vec<Arc<Image>> {
        store.load(sources).into_iter().map(|it| it.expect("decodes").0).collect()
    };
    let first = of(&[named(), source(None, &bytes, &count), named()]);
    assert!(Arc::ptr_eq(&first[0], &first[2]) && !Arc::ptr_eq(&first[0], &first[1]));
    assert!(Arc::ptr_eq(&first[0], &of(&[named()])[0]));
    assert_eq!((store.figures().images, count.load(Relaxed)), (2, 2));
    // One that is written anew is another.
    fs::write(&path, png(9, 0, false)).expect("written");
    assert!(!Arc::ptr_eq(&first[0], &of(&[named()])[0]));
    let broken = store.load(&[source(None, b"hello", &count), named()]);
    assert!(broken[0].is_err() && broken[1].is_ok());
}

/// As a scene of many textures, of which few fit: all bits are those of images in memory.
#[test]
fn what_does_not_fit_is_kept_in_tiles_within_the_limit() {
    let files: Vec<Vec<u8>> = (0..24).map(|number| png(512, number, number % 4 == 0)).collect();
    let count = AtomicUsize::new(0);
    let sources: Vec<ImageSource> = files.iter().map(|bytes| source(None, bytes, &count)).collect();
    let load = |limit| {
        let store = TextureStore::new(limit);
        let images = store.load(&sources).into_iter().map(|it| it.expect("decodes").0);
        let images: Vec<Arc<Image>> = images.collect();
        (store, images)
    };
    let (unlimited, whole) = load(u64::MAX);
    let (limited, tiled) = load(2 << 20);
    let total = 512 * 512 * (6 + 18 * 3);
    assert_eq!((unlimited.figures().resident, unlimited.figures().tiled), (total, 0));
    assert_eq!((limited.figures().resident, limited.figures().tiled), (0, 24));
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (whole, tiled) = (&whole, &tiled);
            scope.spawn(move || compare_at_random(whole, tiled, thread));
        }
    });
    assert!(whole.iter().zip(&tiled).all(|(a, b)| a == b && a.digest() == b.digest()));
    let figures = limited.figures().cache;
    assert!(figures.evicted > 0 && figures.read > 24 * 64, "{figures:?}");
    assert!(figures.peak <= 2 << 20 && figures.peak > 1 << 20, "{figures:?}");
    assert_eq!(limited.failure(), None);
}

/// Looks up textures in an order that jumps, but stays for a while where it is.
fn compare_at_random(whole: &[Arc<Image>], tiled: &[Arc<Image>], seed: u32) {
    let mut state = seed;
    for _ in 0..20_000 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let (number, u, v) = (state >> 27, state >> 12 & 0xff, state & 0xfff);
        let at = Vec2::new(u as f32 / 251.0, v as f32 / 4091.0);
        let of = |images: &[Arc<Image>]| {
            let image = Arc::clone(&images[number as usize % images.len()]);
            Texture::new(image, ColorSpace::Srgb, [Wrap::Repeat; 2], Filter::Bilinear).sample(at)
        };
        assert_eq!(of(whole).to_array().map(f32::to_bits), of(tiled).to_array().map(f32::to_bits));
    }
}

#[test]
fn an_image_that_was_made_has_its_place_too() {
    let store = TextureStore::new(1 << 20);
    let make = || Image::of(512, 512, vec![[7_u8, 8, 9]; 512 * 512]);
    let [first, second] = [store.keep(make()), store.keep(make())];
    assert!(!first.is_tiled() && second.is_tiled() && first == second);
    let small = store.keep(Image::of(32, 32, vec![[1.0_f32; 4]; 32 * 32]));
    assert!(!small.is_tiled());
    // What came too late for memory does not take it from the cache.
    assert!(store.keep(Image::of(33, 32, vec![[0_u8]; 33 * 32])).is_tiled());
    // What is in memory leaves the cache the rest.
    assert!(store.figures().cache.limit <= (1 << 20) - 512 * 512 * 3);
}

/// Values that tell channels and texels apart, of every kind.
fn texels(kind: u8, count: usize, seed: u32) -> Texels {
    let number = |i: usize| (i as u32).wrapping_mul(2_654_435_761).wrapping_add(seed);
    match kind {
        0 => Texels::U8((0..count).map(|i| (number(i) >> 24) as u8).collect()),
        1 => Texels::U16((0..count).map(|i| (number(i) >> 16) as u16).collect()),
        _ => Texels::F32((0..count).map(|i| number(i) as f32 * 1e-6 - 1000.0).collect()),
    }
}

proptest! {
    #[test]
    fn lookups_in_tiles_have_the_bits_of_those_in_memory(
        size in (1_u32..200, 1_u32..200),
        channels in 1_u8..=4,
        kind in 0_u8..3,
        wraps in (0_usize..3, 0_usize..3),
        nearest in any::<bool>(),
        srgb in any::<bool>(),
        seed in any::<u32>(),
        points in prop::collection::vec((-3.0_f32..3.0, -3.0_f32..3.0), 64),
    ) {
        let count = size.0 as usize * size.1 as usize * usize::from(channels);
        let make = || Image::new(size.0, size.1, channels, texels(kind, count, seed));
        let all = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror];
        let wrap = [all[wraps.0], all[wraps.1]];
        let filter = if nearest { Filter::Nearest } else { Filter::Bilinear };
        let space = if srgb { ColorSpace::Srgb } else { ColorSpace::Linear };
        let cache = Arc::new(TileCache::new(100_000));
        let of = |image: Image| Texture::new(Arc::new(image), space, wrap, filter);
        let (whole, tiled) = (of(make()), of(make().into_tiles(&cache)));
        prop_assert_eq!(tiled.image().is_tiled(), size.0 * size.1 > 32 * 32);
        for (u, v) in points {
            let at = Vec2::new(u, v);
            let bits = |texture: &Texture| texture.sample(at).to_array().map(f32::to_bits);
            prop_assert_eq!(bits(&whole), bits(&tiled));
        }
        prop_assert!(whole.image() == tiled.image());
        prop_assert_eq!(whole.image().digest(), tiled.image().digest());
    }
}
