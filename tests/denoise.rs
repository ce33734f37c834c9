//! Denoising, from the command line. What needs Open Image Denoise is ignored unless it is asked
//! for: `DAPPLE_OIDN=… cargo test --test denoise -- --include-ignored`.

use std::path::Path;
use std::process::{Command, Output};

use dapple::Picture;
use dapple::film::metrics::{Errors, Finite};

/// Runs `dapple` in a folder, with the library where `oidn` says, or else where this process has
/// it.
fn dapple(folder: &Path, oidn: Option<&str>, words: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dapple"));
    command.args(words).current_dir(folder);
    if let Some(oidn) = oidn {
        command.env("DAPPLE_OIDN", oidn);
    }
    command.output().expect("the binary runs")
}

/// The picture that `dapple` writes to `a.exr`.
fn picture(folder: &Path, words: &[&str]) -> Picture {
    let output = dapple(folder, None, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    Picture::read(folder.join("a.exr")).expect("whole")
}

fn cornell() -> String {
    format!("{}/scenes/cornell.gltf", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn a_library_that_is_not_there_is_told_before_the_render() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("empty")).expect("made");
    let noisy = ["render", &cornell(), "-o", "noisy.exr", "--resolution", "8x8", "--spp", "1"];
    dapple(folder.path(), None, &noisy);
    // Nobody waits for so many samples.
    let render = ["render", &cornell(), "-o", "a.exr", "--spp", "1000000000", "--denoise"];
    let denoise = ["denoise", "noisy.exr", "-o", "a.exr"];
    for words in [&render[..], &denoise] {
        for (oidn, said) in [("none", "no such file or folder"), ("empty", "holds no ")] {
            let output = dapple(folder.path(), Some(oidn), words);
            let text = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(3), "{text}");
            assert!(text.starts_with(&format!("error: DAPPLE_OIDN={oidn}: {said}")), "{text}");
        }
    }
    assert!(!folder.path().join("a.exr").exists());
}

#[test]
fn golden_checks_need_no_library() {
    let folder = tempfile::tempdir().expect("a folder");
    let golden = format!("{}/golden", env!("CARGO_MANIFEST_DIR"));
    let words = ["golden", "check", &golden, "--only", "furnace", "--", "--denoise"];
    let output = dapple(folder.path(), Some("none"), &words);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
#[ignore = "needs Open Image Denoise: set DAPPLE_OIDN"]
fn the_denoised_layer_is_closer_to_the_truth_and_the_others_stay() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = cornell();
    let render = |more: &[&str]| {
        let words = ["render", &scene, "-o", "a.exr", "--resolution", "128x128"];
        picture(folder.path(), &[&words, more].concat())
    };
    let truth = render(&["--spp", "1024", "--seed", "1"]);
    let noisy = render(&["--spp", "4"]);
    let clean = render(&["--spp", "4", "--denoise"]);

    // All other layers are the same, but for `cost`.
    for channel in noisy.channels().iter().filter(|channel| channel.name != "cost.Y") {
        let found = clean.channel(&channel.name).expect(&channel.name);
        let bits = |values: &[f32]| values.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(found), bits(&channel.samples), "{}", channel.name);
    }
    assert!(clean.strings["dapple/denoise"].starts_with("Open Image Denoise 2."));
    assert!(clean.strings["dapple/settings"].contains("denoise = true"));

    let colours = |picture: &Picture, layer| picture.aov(layer, "RGB").expect("there");
    let truth = colours(&truth, "");
    let relmse = |image: &[[f32; 3]]| Errors::of(image, &truth, &Finite::of(image, &truth)).relmse;
    let (before, after) = (relmse(&colours(&noisy, "")), relmse(&colours(&clean, "denoised")));
    assert!(after < 0.5 * before, "relMSE {before} became {after}");
}

#[test]
#[ignore = "needs Open Image Denoise: set DAPPLE_OIDN"]
fn a_picture_is_denoised_later_as_in_its_render() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = cornell();
    let words = ["render", &scene, "--resolution", "64x48", "--spp", "2", "-o"];
    let run = |words: &[&str]| picture(folder.path(), words);
    let before = run(&[&words[..], &["a.exr", "--denoise", "--png", "before.png"]].concat());
    let output = dapple(folder.path(), None, &[&words[..], &["noisy.exr"]].concat());
    assert!(output.status.success());
    let after = run(&["denoise", "noisy.exr", "-o", "a.exr", "--png", "after.png"]);
    assert_eq!(before.aov("denoised", "RGB"), after.aov("denoised", "RGB"));
    // The bytes differ by the label of a render's PNG, which says by what settings it was made.
    let png = |name: &str| dapple::film::png::read(&folder.path().join(name)).expect("written");
    assert_eq!(png("before.png").aov("", "RGB"), png("after.png").aov("", "RGB"));

    // Layers that only the denoiser reads are not in the picture.
    let few = run(&[&words[..], &["a.exr", "--denoise", "--aov", "depth"]].concat());
    let names: Vec<&str> = few.channels().iter().map(|channel| channel.name.as_str()).collect();
    let expected = ["A", "B", "G", "R", "denoised.B", "denoised.G", "denoised.R", "depth.Z"];
    assert_eq!(names, expected);
    assert_eq!(few.aov("denoised", "RGB"), before.aov("denoised", "RGB"));
}

#[test]
#[ignore = "needs Open Image Denoise: set DAPPLE_OIDN"]
fn pictures_without_guides_or_with_holes_are_denoised() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = cornell();
    let words = ["--resolution", "64x64", "--spp", "1", "--transparent", "--aov", "variance"];
    let mut noisy =
        picture(folder.path(), &[&["render", &scene, "-o", "a.exr"], &words[..]].concat());
    let mut reds = noisy.channel("R").expect("there").to_vec();
    reds[64 * 32 + 32] = f32::NAN;
    reds[64 * 20 + 20] = f32::INFINITY;
    noisy.set_channel("R", reds);
    noisy.write_exr(folder.path().join("noisy.exr")).expect("written");
    let clean = picture(folder.path(), &["denoise", "noisy.exr", "-o", "a.exr"]);
    let colours = clean.aov("denoised", "RGB").expect("there");
    assert!(colours.as_flattened().iter().all(|value| value.is_finite()));
    assert!(colours.as_flattened().iter().any(|&value| value > 0.1));
}
