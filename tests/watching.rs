//! A render that is watched, through the binary.

use std::io::Read;
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, Output};

use dapple::film::exr;
use serde_json::Value;

/// Renders a small picture in a folder.
fn render(folder: &Path, words: &[&str]) -> Output {
    let scene = format!("{}/scenes/furnace.gltf", env!("CARGO_MANIFEST_DIR"));
    Command::new(env!("CARGO_BIN_EXE_dapple"))
        .args(["render", &scene, "--resolution", "20x10", "--spp", "16"])
        .args(words)
        .current_dir(folder)
        .output()
        .expect("the binary runs")
}

fn said(output: &Output) -> String {
    assert!(output.status.success() && output.stdout.is_empty(), "{output:?}");
    String::from_utf8(output.stderr.clone()).expect("text")
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).expect(name)
}

fn text(folder: &Path, name: &str) -> String {
    String::from_utf8(read(folder, name)).expect("text")
}

#[test]
fn whoever_watches_sees_the_end_and_changes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let tev = listener.local_addr().expect("it has one").to_string();
    let viewer = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        let (mut stream, _) = listener.accept().expect("a client");
        stream.read_to_end(&mut bytes).expect("all of it");
        bytes
    });
    let watched = ["-o", "a.exr", "--png", "a.png", "--preview", "p.png", "--every", "1ms"];
    let files = ["--log", "a.log", "--metrics", "a.prom", "--tev", &tev, "--quiet"];
    assert_eq!(said(&render(folder, &[&watched[..], &files].concat())), "");
    said(&render(folder, &["-o", "b.exr", "--quiet"]));

    let pictures = ["a.exr", "b.exr"].map(|name| exr::read(&folder.join(name)).expect("whole"));
    for name in ["R", "G", "B", "A", "depth.Z"] {
        assert_eq!(pictures[0].channel(name), pictures[1].channel(name), "{name}");
    }
    assert_eq!(read(folder, "a.png"), read(folder, "p.png"));
    let metrics = text(folder, "a.prom");
    for (name, value) in [("samples_done", 3200), ("finished", 1), ("exit_code", 0)] {
        let found = metrics.lines().find(|line| line.starts_with(&format!("dapple_render_{name}")));
        assert!(found.is_some_and(|line| line.ends_with(&format!("\"}} {value}"))), "{metrics}");
    }
    let log = text(folder, "a.log");
    let lines: Vec<&str> = log.lines().collect();
    assert!(lines[0].contains(" begins, ") && lines[0].contains("--log a.log"), "{log}");
    assert!(log.contains("16 spp") && lines[lines.len() - 1].ends_with("exit code 0"), "{log}");
    let bytes = viewer.join().expect("someone came");
    assert_eq!(bytes[4..].first_chunk(), Some(b"\x04\0dapple: a.exr\0\x14\0\0\0\x0a\0\0\0"));
}

#[test]
fn programs_read_each_phase_and_at_last_that_all_is_done() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = said(&render(folder.path(), &["-o", "a.exr", "--progress", "json"]));
    let lines = said.lines().filter(|line| line.starts_with('{'));
    let lines: Vec<Value> = lines.map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let mut phases: Vec<&str> =
        lines.iter().map(|it| it["phase"].as_str().expect("text")).collect();
    phases.dedup();
    assert_eq!(phases, ["read", "build", "render", "write", "end"]);
    let last = &lines[lines.len() - 1];
    assert_eq!((&last["done"], &last["total"]), (&3200.into(), &3200.into()));
    assert_eq!((&last["share"], &last["spp"]), (&1.0.into(), &16.0.into()));
}

#[test]
fn a_farm_reads_percentages_and_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = said(&render(folder.path(), &["-o", "a.exr", "--progress", "openjd"]));
    assert!(said.starts_with("openjd_progress: 0.0\nopenjd_status: reading the scene\n"), "{said}");
    assert!(said.ends_with("\nopenjd_progress: 100.0\nopenjd_status: ended\n"), "{said}");
}

#[test]
fn a_picture_is_shown_where_it_is_asked_for_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let shown = said(&render(folder.path(), &["-o", "a.exr", "--show", "blocks"]));
    assert_eq!(shown.matches('▀').count(), 20 * 5, "{shown}");
    let shown = said(&render(folder.path(), &["-o", "a.exr", "--show"]));
    assert!(shown.contains("note: --show: ") && !shown.contains('▀'), "{shown}");
}

#[test]
fn a_run_that_fails_says_so_to_all() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let words = ["render", "no.gltf", "-o", "a.exr", "--log", "a.log", "--metrics", "a.prom"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_dapple"));
    let status = command.args(words).current_dir(folder).output().expect("it runs").status;
    assert_eq!(status.code(), Some(3));
    assert!(text(folder, "a.log").contains(" error: no.gltf: "), "{}", text(folder, "a.log"));
    assert!(text(folder, "a.prom").contains("dapple_render_exit_code{scene=\"no.gltf\"} 3\n"));
}
