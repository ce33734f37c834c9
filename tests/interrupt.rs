//! A long render that is stopped keeps what it has.
#![cfg(unix)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use dapple::film::exr;

/// Starts a render that would take weeks and waits until it is under way.
fn started(folder: &Path) -> (Child, impl Iterator<Item = String> + use<>) {
    let scene = format!("{}/scenes/furnace.gltf", env!("CARGO_MANIFEST_DIR"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .args(["render", &scene, "-o", "a.exr", "--png", "a.png", "--spp", "1000000000"])
        .args(["--resolution", "8x8", "--progress", "json"])
        .current_dir(folder)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    let said = BufReader::new(child.stderr.take().expect("piped"));
    let mut lines = said.lines().map(|line| line.expect("text"));
    let under_way = |line: &String| {
        let done = line.split_once("\"done\":").map(|(_, rest)| rest);
        done.is_some_and(|rest| !rest.starts_with('0'))
    };
    assert!(lines.any(|line| under_way(&line)), "it ended by itself");
    (child, lines)
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(status.expect("kill runs").success());
}

#[test]
fn an_interrupted_render_saves_its_samples_and_says_so() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143)] {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut child, lines) = started(folder.path());
        send(signal, &child);
        let said: Vec<String> = lines.collect();
        assert_eq!(child.wait().expect("it ends").code(), Some(code), "{signal}: {said:?}");
        assert!(said.iter().any(|line| line.contains("interrupted: saved with")), "{said:?}");
        let picture = exr::read(&folder.path().join("a.exr")).expect("whole");
        let samples = picture.channel("samples.Y").expect("there");
        assert!(samples.iter().all(|&n| (1.0..1e9).contains(&n)), "{signal}: {samples:?}");
        assert!(folder.path().join("a.png").exists());
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 2);
    }
}
