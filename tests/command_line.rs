//! The command as a user meets it: what it refuses, with which exit status, and what it leaves.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use dapple::film::exr;
use dapple::formats::npy;

const DAPPLE: &str = env!("CARGO_BIN_EXE_dapple");

fn scene(name: &str) -> String {
    format!("{}/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Exit status, standard output and standard error of a command line in `folder`, where `SCENE`
/// stands for the furnace.
fn run(folder: &Path, words: &str) -> (i32, String, String) {
    let words = words.split_whitespace();
    let words = words.map(|word| if word == "SCENE" { scene("furnace.gltf") } else { word.into() });
    let output = Command::new(DAPPLE).args(words).current_dir(folder).output();
    let output = output.expect("the binary runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let code = output.status.code().expect("no signal ended it");
    (code, text(&output.stdout), text(&output.stderr))
}

/// A folder with a triangle, a thousand rays, and an OBJ without a face.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    npy::write_f32(&place("tt.npy"), 9, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0])
        .expect("written");
    let ray = [0.1, 0.1, 1.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY];
    npy::write_f32(&place("rays.npy"), 8, &ray.repeat(1000)).expect("written");
    fs::write(place("empty.obj"), "mtllib gone.mtl\nv 0 0 0\n").expect("written");
    folder
}

const SMALL: &str = "--spp 1 --resolution 8x8 --env 1,1,1";

fn names(folder: &Path) -> Vec<PathBuf> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .collect();
    names.sort();
    names
}

#[test]
fn a_reader_that_has_gone_away_is_no_error() {
    let folder = folder();
    for words in ["accels", "accels --json", "trace tt.npy --rays rays.npy"] {
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let status = Command::new(DAPPLE)
            .args(words.split_whitespace())
            .current_dir(folder.path())
            .stdout(writer)
            .status();
        assert_eq!(status.expect("it runs").code(), Some(0), "{words}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_is_full_is_told_by_the_exit_status() {
    let folder = folder();
    for words in ["accels", "trace tt.npy --rays rays.npy", "validate tt.npy --rays 100"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("it is there");
        let output = Command::new(DAPPLE)
            .args(words.split_whitespace())
            .current_dir(folder.path())
            .stdout(full)
            .stderr(Stdio::piped())
            .output()
            .expect("it runs");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{words}: {said}");
        assert!(said.contains("standard output cannot be written"), "{words}: {said}");
    }
}

#[test]
fn slips_are_usage_errors_and_leave_nothing() {
    let folder = folder();
    let before = names(folder.path());
    for (words, said) in [
        ("trace tt.npy --rays rays.npy --repeat 9999999999999999999", "--repeat"),
        ("trace tt.npy --rays rays.npy --repeat 0", "--repeat"),
        ("trace tt.npy --rays rays.npy --threads 99999", "4096 threads"),
        ("trace tt.npy --rays rays.npy --hits tt.npy", "is an input"),
        ("trace tt.npy --rays rays.npy --hits ./rays.npy", "is an input"),
        ("validate tt.npy --rays 9999999999999999999", "--rays"),
        ("validate tt.npy --rays 999999999999", "--rays"),
        ("validate tt.npy --rays 0", "--rays"),
        ("validate tt.npy --threads 99999", "4096 threads"),
        ("bench kd tt.npy --rays 9999999999999999999", "--rays"),
        ("bench mbvh tt.npy --rays 0", "--rays"),
        ("bench mbvh tt.npy --rounds 0", "--rounds"),
        ("bench render SCENE --threads 99999", "4096 threads"),
        ("bench render SCENE --resolution 1", "--resolution"),
        ("render SCENE -o same --png same", "same file"),
        ("render SCENE -o x.png", "--png writes a PNG"),
        ("render SCENE --png x.jpg", "name it x.png"),
        ("render SCENE -o x.exr --env-scale=-1 --env 1,1,1", "below zero"),
        ("render SCENE -o x.exr --look-from 1,1,1 --look-at 1,1,1", "no direction"),
        ("render SCENE -o x.exr --look-from 1,1,1 --look-at 1,0,1 --up 0,2,0", "--up"),
        ("render SCENE -o x.exr --env 1,1", "three finite numbers"),
        ("render SCENE -o x.exr --env-scale 2", "of no use without --env or --sky"),
        ("render SCENE -o x.exr --look-at 1,1,1", "of no use without --look-from"),
        ("render SCENE -o x.exr --env 1,1,1 --sky 3", "cannot be used with"),
        ("render SCENE -o x.exr --sky 1", "must be from 2 to 10"),
        ("render SCENE -o x.exr --sky 3 --sun-direction 0,-1,0", "above the horizon"),
        ("diff a.exr a.exr --heatmap a.exr", "name it a.png"),
        ("diff a.png b.png --heatmap b.png", "is an input"),
        ("golden update golden -- --spp 1", "unexpected argument"),
    ] {
        let (code, out, err) = run(folder.path(), words);
        assert_eq!((code, out.as_str()), (2, ""), "{words}: {err}");
        assert!(err.contains(said), "{words}: {err}");
    }
    assert_eq!(names(folder.path()), before);
}

#[test]
fn outputs_that_cannot_be_written_are_told_before_the_work() {
    let folder = folder();
    let before = names(folder.path());
    for words in [
        "trace tt.npy --rays rays.npy --hits no/such/h.npy",
        "validate tt.npy --rays 10 --save no/such/d.npy",
        "diff tt.npy tt.npy --heatmap no/such/map.png",
        // It would take weeks.
        "render SCENE --spp 1000000000 -o no/such/a.exr --png b.png",
    ] {
        let (code, _, err) = run(folder.path(), words);
        assert_eq!(code, 4, "{words}: {err}");
        assert!(err.contains("no/such") && err.contains("cannot be written"), "{words}: {err}");
    }
    assert_eq!(names(folder.path()), before);
}

#[cfg(target_os = "linux")]
#[test]
fn what_needs_more_memory_than_there_is_is_refused_with_the_figure() {
    let folder = folder();
    for words in [
        format!("render {} -o a.exr --resolution 4096x4096", scene("furnace.gltf")),
        "validate tt.npy --rays 1000000000".to_owned(),
        "bench kd tt.npy --rays 1000000000".to_owned(),
        "bench mbvh tt.npy --rays 1000000000".to_owned(),
        format!("bench render {} -q --resolution 8000x8000", scene("furnace.gltf")),
    ] {
        let output = Command::new("sh")
            .args(["-c", &format!("ulimit -v 3000000; exec {DAPPLE} {words}")])
            .current_dir(folder.path())
            .output()
            .expect("a shell");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(5), "{words}: {said}");
        assert!(said.contains("GB of memory, there are 3."), "{words}: {said}");
    }
}

/// The start of a PNG of so many pixels of four channels, which nothing follows.
#[cfg(target_os = "linux")]
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let image = image::GrayImage::new(1, 1);
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("encodes");
    let mut bytes = bytes.into_inner();
    bytes[16..20].copy_from_slice(&width.to_be_bytes());
    bytes[20..24].copy_from_slice(&height.to_be_bytes());
    bytes[25] = 6; // red, green, blue and alpha
    let crc = (12..29).fold(!0_u32, |crc, at| {
        (0..8).fold(crc ^ u32::from(bytes[at]), |crc, _| {
            if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
        })
    });
    bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
    bytes
}

/// A few bytes can claim a gigabyte; an allocation that fails would end the process.
#[cfg(target_os = "linux")]
#[test]
fn pictures_that_claim_more_memory_than_is_left_are_refused() {
    let folder = folder();
    let place = |name: &str| folder.path().join(name);
    fs::write(place("large.png"), png_header(16384, 16384)).expect("written");
    let radiance = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8000 +X 16000\n";
    fs::write(place("large.hdr"), radiance).expect("written");
    fs::write(place("a.mtl"), "newmtl m\nmap_Kd large.png\n").expect("written");
    let text = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
    fs::write(place("a.obj"), text).expect("written");
    for words in [
        format!("render a.obj -o a.exr {SMALL}"),
        format!("render {} -o a.exr --spp 1 --env large.hdr", scene("furnace.gltf")),
        "diff large.png large.png".to_owned(),
    ] {
        let output = Command::new("sh")
            .args(["-c", &format!("ulimit -v 1000000; exec {DAPPLE} {words}")])
            .current_dir(folder.path())
            .output()
            .expect("a shell");
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{words}: {said}");
        assert!(said.contains("GB of memory, 0.") && said.contains("are left"), "{words}: {said}");
    }
}

#[test]
fn trees_beyond_the_memory_that_was_allowed_are_refused_with_the_estimate() {
    let words = format!("bench kd {} --memory 1 --rays 10", scene("gems.gltf"));
    let (code, _, err) = run(folder().path(), &words);
    assert_eq!(code, 5, "{err}");
    assert!(err.contains("more than the 1000000"), "{err}");
}

#[cfg(unix)]
#[test]
fn pipes_are_refused_where_files_are_read() {
    let folder = folder();
    let made = Command::new("mkfifo").arg(folder.path().join("pipe.npy")).status();
    assert!(made.expect("mkfifo runs").success());
    fs::rename(folder.path().join("pipe.npy"), folder.path().join("pipe")).expect("renamed");
    fs::create_dir(folder.path().join("g")).expect("made");
    std::os::unix::fs::symlink("../pipe", folder.path().join("g/golden.toml")).expect("linked");
    std::os::unix::fs::symlink("pipe", folder.path().join("p.png")).expect("linked");
    std::os::unix::fs::symlink("pipe", folder.path().join("t.npy")).expect("linked");
    for words in [
        "trace tt.npy --rays pipe",
        "trace t.npy --rays rays.npy",
        "diff pipe pipe",
        "diff p.png p.png",
        "golden check g",
        "render pipe -o a.exr",
        "render SCENE --env pipe -o a.exr",
    ] {
        let (code, _, err) = run(folder.path(), words);
        assert_eq!(code, 3, "{words}: {err}");
        assert!(err.contains("is not a regular file"), "{words}: {err}");
    }
}

#[test]
fn what_a_scene_lacks_is_said_by_every_command() {
    let folder = folder();
    for words in [
        "trace empty.obj --rays rays.npy",
        "validate empty.obj --rays 10 --accel kd-ropes",
        &format!("render empty.obj -o a.exr {SMALL}"),
    ] {
        let (code, _, err) = run(folder.path(), words);
        assert_eq!(code, 0, "{words}: {err}");
        assert!(err.contains("no triangles") && err.contains("gone.mtl"), "{words}: {err}");
    }
}

#[test]
fn lost_samples_are_said_even_when_quiet() {
    let folder = folder();
    let words =
        "render -q SCENE -o a.exr --spp 2 --resolution 4x4 --env 3e38,3e38,3e38 --env-scale 9";
    let (code, _, err) = run(folder.path(), words);
    assert_eq!(code, 0, "{err}");
    assert!(err.starts_with("warning: 32 samples were not finite"), "{err}");
    let strings = exr::read(&folder.path().join("a.exr")).expect("written").strings;
    assert_eq!(strings["dapple/lost-samples"], "32");
    assert!(strings["dapple/settings"].contains("env-scale = 9.0"), "{strings:?}");
    // What it says to type follows that sample.
    let command = err.lines().nth(1).expect("a command").trim();
    let command = command.strip_prefix("dapple ").expect("of ours");
    let (code, out, err) = run(folder.path(), command);
    assert!(code == 0 && out.starts_with("pixel 0,0 sample 0"), "{out}{err}");
}

#[test]
fn a_picture_needs_its_outputs_only() {
    let folder = folder();
    let (code, out, err) = run(folder.path(), &format!("render SCENE {SMALL} --png b --json"));
    assert_eq!(code, 0, "{err}");
    assert!(out.starts_with('{') && out.ends_with("}\n"), "{out}");
    assert!(fs::read(folder.path().join("b")).expect("written").starts_with(b"\x89PNG"));
}

#[test]
fn a_script_can_read_what_structures_there_are() {
    let (code, out, _) = run(Path::new("."), "accels --json");
    let rows: Vec<serde_json::Value> = serde_json::from_str(&out).expect("an array");
    assert!(code == 0 && rows.len() == dapple::accel::VARIANTS.len());
    let row = rows.iter().find(|row| row["id"] == "mbvh8").expect("there");
    let option = |name: &str| {
        let options = row["options"].as_array().expect("options");
        options.iter().find(|option| option["name"] == name).expect("there").clone()
    };
    assert_eq!(option("cache")["default"], 100_000_000);
    assert_eq!(option("cache")["min"], 1);
    assert_eq!(option("triangles")["choices"][0], "inline");
}

#[test]
fn a_raster_of_rays_gives_the_same_hits() {
    let folder = folder();
    for flags in ["", "--single", "--width 40", "--width 7", "--width 65536"] {
        for accel in ["auto", "bvh-packet"] {
            let words = format!("trace tt.npy --rays rays.npy {flags} --accel {accel} --json");
            let (code, out, err) = run(folder.path(), &words);
            assert_eq!(code, 0, "{words}: {err}");
            assert!(out.contains("\"hits\":1000"), "{words}: {out}");
        }
    }
}

#[test]
fn a_run_is_repeated_from_another_folder() {
    let folder = folder();
    let inner = folder.path().join("inner");
    fs::create_dir(&inner).expect("a folder");
    fs::write(inner.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
    let (code, _, error) = run(&inner, &format!("render a.obj -o a.exr -q {SMALL}"));
    assert_eq!((code, &*error), (0, ""));
    let (code, _, error) = run(folder.path(), "render --from inner/a.exr -o b.exr -q");
    assert_eq!((code, &*error), (0, ""));
    let (code, _, error) = run(folder.path(), "diff inner/a.exr b.exr --fail max=0 -q");
    assert_eq!((code, &*error), (0, ""));
    let (code, _, error) = run(&inner, "render --from a.exr -o c.exr -q");
    assert_eq!((code, &*error), (0, ""));
    // Out of the folder of a picture, one goes up.
    let deeper = inner.join("out");
    fs::create_dir(&deeper).expect("a folder");
    fs::copy(inner.join("a.exr"), deeper.join("a.exr")).expect("copied");
    let (code, _, error) = run(&deeper, "render --from a.exr -o b.exr -q");
    assert_eq!((code, &*error), (0, ""));
}
