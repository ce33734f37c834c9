//! KTX 2.0 files beside the same texels as the reference transcoder gives them, to the bit.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use dapple::texture::{FileLevels, Image};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus/ktx2")
}

fn read(name: &str) -> Vec<u8> {
    fs::read(folder().join(name)).expect("is part of the project")
}

const KINDS: [&str; 6] =
    ["ok-etc1s", "ok-etc1s-alpha", "ok-uastc", "ok-uastc-alpha", "ok-zstd", "ok-zstd-alpha"];

#[test]
fn texels_are_those_of_the_reference_transcoder() {
    for kind in KINDS {
        let (bytes, name) = (read(&format!("{kind}.ktx2")), format!("{kind}.ktx2"));
        let image = Image::decode(&bytes, &name).expect(kind);
        let expected = Image::decode(&read(&format!("{kind}-texels.png")), "").expect(kind);
        assert!(image == expected, "{kind}");
        assert_eq!(image.is_opaque(), !kind.ends_with("alpha"), "{kind}");
        let take = |levels| Image::decoded_bytes(&bytes, &name, levels).expect(kind);
        assert_eq!(take(FileLevels::First), 13 * 10 * 4);
        assert_eq!(take(FileLevels::All), (13 * 10 + 6 * 5 + 3 * 2 + 1) * 4);
    }
}

fn with_levels(bytes: &[u8]) -> (Image, Vec<String>) {
    Image::decode_noting(bytes, "a.ktx2", FileLevels::All).expect("its first level is whole")
}

/// Each level is decoded from a file that is made of it alone: it is as from the whole file.
#[test]
fn smaller_levels_are_those_of_the_transcoder_too() {
    for kind in KINDS {
        let bytes = read(&format!("{kind}.ktx2"));
        let (image, notes) = with_levels(&bytes);
        assert!(notes.is_empty(), "{kind}: {notes:?}");
        assert!(Image::decode(&bytes, "a.ktx2").expect(kind).file_levels().is_empty());
        let sizes = image.file_levels().iter().map(|level| [level.width(), level.height()]);
        assert_eq!(sizes.collect::<Vec<_>>(), [[6, 5], [3, 2], [1, 1]], "{kind}");
        if kind.starts_with("ok-zstd") {
            continue; // The transcoder is built without Zstandard.
        }
        let transcoder = Transcoder::new(&bytes).expect(kind);
        for (level, number) in image.file_levels().iter().zip(1..) {
            let texels = transcoder.transcode(number, TargetFormat::Rgba32, DecodeFlags::NONE);
            let texels = texels.expect(kind).as_chunks::<4>().0.to_vec();
            assert!(**level == Image::of(level.width(), level.height(), texels), "{kind} {number}");
        }
    }
    // Zstandard packs the same levels that the other file has as they are.
    let [plain, packed] = ["ok-uastc", "ok-zstd"].map(|kind| read(&format!("{kind}.ktx2")));
    assert!(with_levels(&plain).0 == with_levels(&packed).0);
}

/// A level that cannot be used ends them, is said, and takes nothing from those above.
#[test]
fn a_level_that_is_wrong_ends_the_levels() {
    for kind in KINDS {
        let whole = read(&format!("{kind}.ktx2"));
        let entry = |number: usize| 80 + 24 * number;
        for number in 1..4 {
            let far = u64::MAX - 5;
            let odd: [(Range<usize>, u64, &str); 3] = [
                (0..8, far, "past the end of the file"),
                (0..8, whole.len() as u64, "past the end of the file"),
                (8..16, far, "past the end of the file"),
            ];
            for (field, value, reason) in odd {
                let mut bytes = whole.clone();
                let at = entry(number);
                bytes[at + field.start..at + field.end].copy_from_slice(&value.to_le_bytes());
                assert!(Image::decode(&bytes, "a.ktx2").is_ok(), "is not looked at");
                let (image, notes) = with_levels(&bytes);
                assert_eq!(image.file_levels().len(), number - 1, "{kind}");
                let start = format!("has a level {number} that cannot be used (its level is ");
                assert!(notes[0].starts_with(&start) && notes.len() == 1, "{notes:?}");
                assert!(notes[0].contains(reason), "{notes:?}");
            }
        }
    }
    // Bytes of another size than the level has.
    let mut bytes = read("ok-uastc.ktx2");
    bytes.copy_within(80..104, 104);
    let (image, notes) = with_levels(&bytes);
    assert!(image.file_levels().is_empty());
    let said = "has a level 1 that cannot be used (its level holds 192 bytes and needs 64): it and \
                those below are made from the one before";
    assert_eq!(notes, [said]);
}

/// Whatever is cut off is missed, but for the levels that are not used: those come first.
#[test]
fn files_that_are_cut_are_refused() {
    for kind in KINDS {
        let bytes = read(&format!("{kind}.ktx2"));
        for end in 0..bytes.len() {
            assert!(Image::decode(&bytes[..end], "a.ktx2").is_err(), "{kind} cut at {end}");
        }
    }
}

/// A file with one number of its header changed.
fn changed(at: usize, value: u32) -> String {
    let mut bytes = read("ok-uastc.ktx2");
    bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
    Image::decode(&bytes, "a.ktx2").expect_err("is refused").to_string()
}

#[test]
fn what_is_wrong_is_said() {
    assert!(changed(12, 37).contains("not those of Basis Universal"));
    assert!(changed(28, 2).contains("not one flat image"));
    assert!(changed(36, 6).contains("not one flat image"));
    assert!(changed(44, 3).contains("unknown way (3)"));
    assert!(changed(44, 1).contains("packed in a way that they cannot be"));
    assert!(changed(40, 5).contains("5 levels, more than its size allows"));
    assert!(changed(20, 64).contains("bytes and needs"));
    assert!(changed(20, 1 << 20).contains("are too many"));
    assert!(changed(80, u32::MAX).contains("past the end of the file"));
}

/// Of a picture that is too wide, a level that is not is used.
#[test]
fn a_smaller_level_stands_in_for_one_that_is_too_large() {
    let mut bytes = read("ok-uastc.ktx2");
    // As if it were 20000 texels wide: its second level, of 10000 by 5, has other bytes then.
    bytes[20..24].copy_from_slice(&20000_u32.to_le_bytes());
    let blocks = 10000_u32.div_ceil(4) * 2;
    let (end, length) = (bytes.len() as u64, u64::from(blocks * 16));
    let entry = 80 + 24;
    for (at, value) in [(0, end), (8, length), (16, length)] {
        bytes[entry + at..entry + at + 8].copy_from_slice(&value.to_le_bytes());
    }
    let block = read("ok-uastc.ktx2");
    let block = &block[block.len() - 16..];
    bytes.extend(block.repeat(blocks as usize));
    let (image, notes) =
        Image::decode_noting(&bytes, "a.ktx2", FileLevels::First).expect("decodes");
    assert_eq!((image.width(), image.height()), (10000, 5));
    assert_eq!(notes, ["has more than 16384 texels a side: its level 1, of 10000 by 5, is used"]);
}

/// A file whose one key and value, of 36 bytes, are these.
fn with_key(key: &str, value: &str) -> Vec<u8> {
    let mut bytes = read("ok-uastc.ktx2");
    let word =
        |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    let (start, length) = (word(56) as usize, word(60) as usize);
    let pair = format!("{key}\0{value}\0");
    let mut data = (pair.len() as u32).to_le_bytes().to_vec();
    data.extend(pair.as_bytes());
    data.resize(data.len().next_multiple_of(4), 0);
    assert!(data.len() <= length, "it has room");
    bytes[60..64].copy_from_slice(&(data.len() as u32).to_le_bytes());
    bytes[start..start + data.len()].copy_from_slice(&data);
    bytes
}

/// Texels stay as they are; that they should be seen otherwise is said.
#[test]
fn orientations_and_swizzles_are_named() {
    let plain = Image::decode(&read("ok-uastc.ktx2"), "a.ktx2").expect("decodes");
    for (key, value, said) in [
        ("KTXorientation", "rd", None),
        ("KTXswizzle", "rgba", None),
        ("KTXorientation", "ru", Some("its KTXorientation \"ru\" is not honoured")),
        ("KTXorientation", "ld", Some("its KTXorientation \"ld\" is not honoured")),
        ("KTXswizzle", "rrr1", Some("its KTXswizzle \"rrr1\" is not honoured")),
    ] {
        let bytes = with_key(key, value);
        let (image, notes) =
            Image::decode_noting(&bytes, "a.ktx2", FileLevels::First).expect("decodes");
        assert!(image == plain, "{key} {value}");
        assert_eq!(notes.len(), usize::from(said.is_some()), "{notes:?}");
        assert!(notes.iter().all(|note| note.starts_with(said.unwrap_or("-"))), "{notes:?}");
    }
}
