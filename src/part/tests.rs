//! Parts of synthetic samples: however they are cut and put together, the same bits come out; and
//! no damage goes unnoticed.

use std::ops::Range;
use std::path::{Path, PathBuf};

use proptest::prelude::*;

use super::file::{EncodedTile, Part, PartWriter};
use super::{Head, Merge, PartError};
use crate::film::Window;
use crate::integrator::FirstHit;
use crate::math::Vec3;
use crate::render::{Tile, tile_windows};

const FRAME: (u32, u32) = (40, 24);
const SPP: u64 = 80;

/// Samples of the pixels of a window, some of them lost.
fn expose(window: Window, samples: Range<u64>) -> Tile {
    let mut tile = Tile::new(window, samples.start);
    tile.add_for_test(samples, |x, y, sample| {
        let mut sampler =
            crate::sampling::Sampler::new(sample, u64::from(y) << 32 | u64::from(x), 7);
        let (a, b) = (sampler.next_2d(), sampler.next_2d());
        let radiance = Vec3::new(a.x * 10.0, a.y / (b.x + 1e-3), b.y);
        let hit = FirstHit {
            albedo: radiance,
            normal: Vec3::X,
            position: radiance,
            distance: b.x,
            goes_on: false,
        };
        let first = (b.y > 0.3).then_some(hit);
        (b.x > 0.05).then_some((radiance, first))
    });
    tile
}

/// Writes a part of some samples of some pixels.
fn write(path: &Path, crop: Window, samples: Range<u64>) {
    write_stopped(path, crop, samples.clone(), samples.end);
}

/// Writes a part that was stopped when every other tile had its samples up to `at`, and none else
/// any.
fn write_stopped(path: &Path, crop: Window, samples: Range<u64>, at: u64) {
    let mut bytes = Vec::new();
    let mut head = Head::new(FRAME, crop, &samples, SPP);
    head.identity.insert("seed".to_owned(), "7".to_owned());
    let mut part = PartWriter::new(&mut bytes, &head).expect("memory");
    for (number, window) in tile_windows(crop).into_iter().enumerate() {
        let is_blank = at < samples.end && number % 2 == 1;
        let taken = samples.start..if is_blank { samples.start } else { at };
        part.add(&EncodedTile::new(&expose(window, taken))).expect("memory");
    }
    part.finish().expect("memory");
    std::fs::write(path, bytes).expect("written");
}

/// The tiles of one render, with all samples.
fn whole(crop: Window) -> Vec<Tile> {
    tile_windows(crop).into_iter().map(|window| expose(window, 0..SPP)).collect()
}

fn assert_same(found: &[Tile], expected: &[Tile]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!((found.window, &found.range), (expected.window, &expected.range));
        assert_eq!(found.find_difference(expected), None);
        assert_eq!((&found.lost, found.lost_count), (&expected.lost, expected.lost_count));
        assert!(found.lost_count > 0);
    }
}

fn rows() -> Range<i32> {
    0..FRAME.1 as i32
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Any cuts along the samples, any cuts along the pixels, any order, in one step or two.
    #[test]
    fn parts_add_up_to_the_bits_of_one_render(
        cuts in prop::collection::vec(1_u64..5, 0..4),
        column in 1_i32..40,
        row in 1_i32..24,
        seed in any::<u64>(),
        first_few in 1_usize..4,
    ) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut edges: Vec<u64> = cuts.iter().map(|cut| cut * 16).chain([0, SPP]).collect();
        edges.sort_unstable();
        edges.dedup();
        let corners = [(0, 0, column, row), (column, 0, 40, row), (0, row, 40, 24)];
        let mut paths: Vec<PathBuf> = Vec::new();
        for (x0, y0, x1, y1) in corners {
            for samples in edges.windows(2) {
                let path = folder.path().join(format!("{}.part", paths.len()));
                write(&path, Window { x0, y0, x1, y1 }, samples[0]..samples[1]);
                paths.push(path);
            }
        }
        // Shuffled by the seed.
        paths.sort_by_key(|path| {
            use std::hash::{BuildHasher, BuildHasherDefault, DefaultHasher};
            BuildHasherDefault::<DefaultHasher>::new().hash_one((seed, path.file_name()))
        });
        let merge = Merge::new(&paths, true).expect("they fit");
        prop_assert_eq!(merge.gaps(), &[]);
        let expected = whole(Window::of_size(40, 24));
        assert_same(&merge.tiles_of_rows(rows()).expect("whole"), &expected);

        // Those of the first rectangle, or whichever fit, may be added up before.
        let strip: Vec<PathBuf> = (0..edges.len() - 1)
            .map(|at| folder.path().join(format!("{at}.part")))
            .take(first_few)
            .collect();
        let larger = folder.path().join("larger.part");
        let sum = Merge::new(&strip, false).expect("they fit");
        prop_assert_eq!(sum.gaps(), &[]);
        let mut bytes = Vec::new();
        sum.write_part(&mut bytes).expect("whole").expect("memory");
        std::fs::write(&larger, bytes).expect("written");
        let rest = paths.iter().filter(|path| !strip.contains(path)).cloned();
        let all: Vec<PathBuf> = rest.chain([larger]).collect();
        let merge = Merge::new(&all, true).expect("they fit");
        prop_assert_eq!(merge.gaps(), &[]);
        assert_same(&merge.tiles_of_rows(rows()).expect("whole"), &expected);
    }
}

#[test]
fn what_is_missing_repeated_or_twice_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    let all = Window::of_size(40, 24);
    for (name, samples) in [("a", 0..32), ("b", 32..64), ("c", 64..80), ("d", 16..48)] {
        write(&place(name), all, samples);
    }
    let merge = |names: &[&str]| {
        let paths: Vec<PathBuf> = names.iter().map(|name| place(name)).collect();
        Merge::new(&paths, true)
    };
    let gap = merge(&["a", "c"]).expect("they fit");
    assert_eq!((gap.gaps()[0].samples.clone(), gap.gaps()[0].window), (32..64, all));
    assert!(gap.gaps().len() == 1 && gap.is_even());
    let twice = merge(&["b", "a", "c", "b"]).expect("they fit");
    assert_eq!((twice.repeated().count(), twice.gaps().len()), (1, 0));
    assert_same(&twice.tiles_of_rows(rows()).expect("the same"), &whole(all));
    let overlap = merge(&["a", "d"]).expect_err("samples 16..32 twice");
    assert_eq!(overlap.exit_code(), 2);
    assert!(overlap.to_string().contains("samples 16..32 of the pixels 0,0,16,16"), "{overlap}");

    // A part that was stopped goes on, unless it would meet another then.
    write_stopped(&place("s"), all, 32..64, 48);
    let gaps = |names: &[&str]| -> Vec<_> {
        let merge = merge(names).expect("they fit");
        merge.gaps().iter().map(|gap| (gap.samples.clone(), gap.unfinished)).collect()
    };
    assert_eq!(gaps(&["a", "s", "c"]), [(32..64, Some(1))], "some tiles have 16, others none");
    assert_eq!(gaps(&["a", "s"]), [(32..64, Some(1)), (64..80, None)]);
    assert_eq!(gaps(&["s", "c"]), [(0..32, None), (32..64, Some(0))]);
    write(&place("g"), all, 48..80);
    assert_eq!(gaps(&["a", "s", "g"]), [(32..48, None)]);

    // A corner that is not there, and one that is there twice.
    let corner = Window { x0: 0, y0: 0, x1: 40, y1: 20 };
    write(&place("e"), corner, 0..80);
    write(&place("f"), Window { x0: 10, y0: 20, ..all }, 0..80);
    let uneven = merge(&["e", "f"]).expect("they fit");
    assert!(!uneven.is_even());
    assert_eq!(uneven.gaps()[0].window, Window { x0: 0, y0: 16, x1: 16, y1: 24 });
    assert_eq!(merge(&["a", "e"]).expect_err("twice").exit_code(), 2);
}

#[test]
fn other_values_of_the_same_samples_are_told_with_their_pixel() {
    let folder = tempfile::tempdir().expect("a folder");
    let (a, b) = (folder.path().join("a"), folder.path().join("b"));
    let all = Window::of_size(40, 24);
    write(&a, all, 0..80);
    let mut bytes = Vec::new();
    let mut head = Head::new(FRAME, all, &(0..80), SPP);
    head.identity.insert("seed".to_owned(), "7".to_owned());
    let mut part = PartWriter::new(&mut bytes, &head).expect("memory");
    for window in tile_windows(all) {
        let mut tile = expose(window, 0..80);
        if window.x0 == 16 && window.y0 == 0 {
            let other = expose(Window { x0: 17, ..window }, 0..80);
            tile.set_pixel_for_test(5, &other);
        }
        part.add(&EncodedTile::new(&tile)).expect("memory");
    }
    part.finish().expect("memory");
    std::fs::write(&b, bytes).expect("written");
    let merge = Merge::new(&[a, b], true).expect("they fit");
    let error = merge.tiles_of_rows(rows()).expect_err("they differ");
    assert!(matches!(error, PartError::Differ { x: 21, y: 0, .. }), "{error}");
    assert_eq!(error.exit_code(), 1);
}

/// Every truncation at a step of 64 bytes, and ten thousand flipped bytes: refused, every one.
#[test]
fn no_damage_goes_unnoticed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.part");
    write(&path, Window { x0: 3, y0: 2, x1: 25, y1: 19 }, 16..48);
    let bytes = std::fs::read(&path).expect("there");
    let read = |bytes: &[u8]| {
        std::fs::write(&path, bytes).expect("written");
        Part::open(&path).and_then(|part| part.verify())
    };
    assert!(read(&bytes).is_ok());
    for length in (0..bytes.len()).step_by(64) {
        let error = read(&bytes[..length]).expect_err("cut short");
        assert_eq!(error.exit_code(), 3);
    }
    let mut random = 1_u64;
    for _ in 0..10_000 {
        random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        let (at, mask) = ((random >> 33) as usize % bytes.len(), (random >> 20) as u8 | 1);
        let mut damaged = bytes.clone();
        damaged[at] ^= mask;
        let error = read(&damaged).expect_err("a byte is another");
        assert!(error.to_string().contains("a.part: is "), "{at}: {error}");
    }
    let longer = [&bytes[..], b"more"].concat();
    assert!(read(&longer).is_err());
}
