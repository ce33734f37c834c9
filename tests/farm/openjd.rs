//! `dapple farm openjd`, by the command `openjd` of the PyPI's package openjd-cli.

use std::fs;
use std::process::Output;

use crate::place::{DAPPLE, Place, said};

const RENDER: &str = "cornell.gltf --spp 64 --resolution 24x16 --reproducible";

/// Runs a template of such words.
fn run(place: &Place, words: &str) -> Output {
    place.write("job.json", &format!("farm openjd {words} --dapple {DAPPLE}"));
    openjd(place)
}

fn openjd(place: &Place) -> Output {
    let asked = std::env::var_os("DAPPLE_TEST_OPENJD").is_some();
    assert!(asked, "this runs the command openjd: set DAPPLE_TEST_OPENJD=1 if it is there");
    place.command("openjd", &["run", "job.json"]).output().expect("openjd is on the PATH")
}

#[test]
#[ignore = "needs openjd: DAPPLE_TEST_OPENJD=1 and --ignored"]
fn openjd_renders_the_bytes_of_one_render() {
    let place = Place::new();
    place.good(&format!("render {RENDER} -o one.exr -q"));
    let all = run(&place, &format!("{RENDER} -o out.exr --parts 4"));
    assert!(all.status.success(), "{}", said(&all));
    assert!(place.read("out.exr") == place.read("one.exr"));
}

#[test]
#[ignore = "needs openjd: DAPPLE_TEST_OPENJD=1 and --ignored"]
fn openjd_renders_frames_and_names_with_braces() {
    let place = Place::new();
    fs::rename(place.path("motion.gltf"), place.path("{{{a}}.gltf")).expect("renamed");
    let frames = format!("{RENDER} --frames 3..4").replace("cornell", "{{{a}}");
    place.good(&format!("render {frames} -o one.##.exr -q"));
    let all = run(&place, &format!("{frames} -o {{{{out.##.exr --parts 2"));
    assert!(all.status.success(), "{}", said(&all));
    for frame in ["03", "04"] {
        let (out, one) = (format!("{{{{out.{frame}.exr"), format!("one.{frame}.exr"));
        assert!(place.read(&out) == place.read(&one), "{out}");
    }
}

#[test]
#[ignore = "needs openjd: DAPPLE_TEST_OPENJD=1 and --ignored"]
fn openjd_does_not_merge_what_failed_and_goes_on_where_it_failed() {
    let place = Place::new();
    place
        .write("job.json", &format!("farm openjd {RENDER} -o out.exr --parts 2 --dapple {DAPPLE}"));
    fs::rename(place.path("cornell.gltf"), place.path("away.gltf")).expect("renamed");
    let failed = openjd(&place);
    assert!(
        !failed.status.success() && said(&failed).contains("cornell.gltf"),
        "{}",
        said(&failed)
    );
    assert!(!place.path("out.exr").exists());
    fs::rename(place.path("away.gltf"), place.path("cornell.gltf")).expect("renamed");
    let again = openjd(&place);
    assert!(again.status.success(), "{}", said(&again));
    assert!(place.path("out.exr").exists());
}
