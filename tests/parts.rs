//! Parts of renders: however a picture is cut, it has the bytes of one render.

use std::path::Path;
use std::process::{Command, Output};

use proptest::prelude::*;

fn scene(name: &str) -> String {
    format!("{}/scenes/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn dapple(folder: &Path, words: &str) -> Output {
    let words = words.split_whitespace();
    let command =
        Command::new(env!("CARGO_BIN_EXE_dapple")).args(words).current_dir(folder).output();
    command.expect("the binary runs")
}

/// Runs it; it must succeed.
fn run(folder: &Path, words: &str) -> String {
    let output = dapple(folder, words);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "dapple {words}\n{said}");
    said
}

/// Runs it; it must fail with an exit code. Returns what it says.
fn fails(folder: &Path, words: &str, code: i32) -> String {
    let output = dapple(folder, words);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "dapple {words}\n{said}");
    said
}

fn same(folder: &Path, a: &str, b: &str) -> bool {
    let read = |name: &str| std::fs::read(folder.join(name)).expect("there");
    read(a) == read(b)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Cuts at blocks and in space, on some threads and by some structure, with and without an open
    /// shutter and with samples that are lost.
    #[test]
    fn cut_pictures_have_the_bytes_of_whole_ones(
        spp in 17_u64..90,
        cuts in prop::collection::vec(1_u64..5, 0..3),
        column in 1_u32..33,
        threads in 1_u32..3,
        accel in prop::sample::select(vec!["auto", "bvh2", "kd-ropes"]),
        case in prop::sample::select(vec![
            "furnace.gltf",
            "cornell.gltf --transparent",
            "motion.gltf --time 0 --shutter 1",
            "gems.gltf --env 3e38,3e38,3e38 --env-scale 9",
        ]),
        backwards in any::<bool>(),
    ) {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let size = "--resolution 33x21 --reproducible -q";
        let base = format!("render {} {size} --spp {spp}", scene(case));
        run(folder, &format!("{base} -o whole.exr"));
        let cuts = cuts.iter().map(|cut| (cut * 16).min(spp));
        let mut edges: Vec<u64> = cuts.chain([0, spp]).collect();
        edges.retain(|&edge| edge % 16 == 0 || edge == spp);
        edges.sort_unstable();
        edges.dedup();
        let mut parts = Vec::new();
        for crop in [format!("0,0,{column},21"), format!("{column},0,33,21")] {
            if crop.starts_with("33,") {
                continue;
            }
            for samples in edges.windows(2) {
                let part = format!("{}.part", parts.len());
                let cut = format!("--crop {crop} --samples {}..{}", samples[0], samples[1]);
                let how = format!("--threads {threads} --accel {accel} --partial {part}");
                run(folder, &format!("{base} {cut} {how}"));
                parts.push(part);
            }
        }
        if backwards {
            parts.reverse();
        }
        run(folder, &format!("merge {} -q --threads {threads} -o merged.exr", parts.join(" ")));
        prop_assert!(same(folder, "whole.exr", "merged.exr"), "{} {:?} {}", case, edges, column);
    }
}

const SMALL: &str = "--resolution 20x20 -q --reproducible";

#[test]
fn parts_by_number_add_up_and_more_samples_extend_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let base = format!("render {} {SMALL}", scene("cornell.gltf"));
    run(folder, &format!("{base} --spp 64 -o a.exr"));
    run(folder, &format!("{base} --spp 128 -o b.exr"));
    for part in 0..3 {
        run(folder, &format!("{base} --spp 64 --part {part}/3 --partial {part}.part"));
    }
    run(folder, "merge 1.part 0.part 2.part -o m.exr --png m.png --partial m.part");
    let said = fails(folder, &format!("{base} --spp 64 --part 0/5 -o m.exr"), 2);
    assert!(said.contains("64 samples a pixel make 4 parts at most"), "{said}");
    assert!(same(folder, "a.exr", "m.exr") && folder.join("m.png").exists());
    run(folder, &format!("{base} --samples 64..128 --partial more.part"));
    run(folder, "merge m.part more.part -o n.exr");
    assert!(same(folder, "b.exr", "n.exr"));
    // Or by going on from what a part holds.
    run(folder, &format!("{base} --spp 128 --checkpoint m.part --resume -o r.exr"));
    assert!(same(folder, "b.exr", "r.exr"));
}

#[test]
fn parts_that_do_not_fit_are_refused_with_what_to_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let base = format!("render {} {SMALL} --spp 64", scene("cornell.gltf"));
    for (name, flags) in [
        ("a", "--samples 0..32"),
        ("b", "--samples 48..64"),
        ("deep", "--samples 32..64 --max-depth 3"),
        ("c", "--samples 16..48"),
    ] {
        run(folder, &format!("{base} {flags} --partial {name}.part"));
    }
    let gap = fails(folder, "merge a.part b.part -o x.exr", 3);
    assert!(!folder.join("x.exr").exists());
    let command = gap.lines().find(|line| line.contains("--samples 32..48")).expect("a command");
    run(folder, command.trim().strip_prefix("dapple ").expect("ours"));
    run(folder, "merge a.part gap0.part b.part -o x.exr");
    run(folder, &format!("{base} -o whole.exr"));
    assert!(same(folder, "whole.exr", "x.exr"));

    let said = run(folder, "merge a.part b.part --incomplete -o y.exr");
    assert!(said.contains("these are missing: 32..48"), "{said}");
    let text = fails(folder, "merge a.part b.part --incomplete --partial y.part -o y.exr", 2);
    assert!(text.contains("a part has no gaps"), "{text}");
    let text = fails(folder, "merge a.part deep.part -o z.exr", 3);
    assert!(text.contains("--max-depth: 20 and 3"), "{text}");
    let text = fails(folder, "merge a.part c.part -o z.exr", 2);
    assert!(text.contains("both have samples 16..32"), "{text}");
    assert!(text.contains("leave one of them out"), "{text}");
    let text = fails(folder, "merge a.part nothing.part -o z.exr", 3);
    assert!(text.contains("nothing.part: no such file"), "{text}");
    let text = fails(folder, "merge a.part whole.exr -o z.exr", 3);
    assert!(text.contains("whole.exr: is neither a part of a picture"), "{text}");
    let said = run(folder, "merge a.part gap0.part b.part a.part -o x.exr");
    assert!(said.contains("note: a.part: the same samples as a.part"), "{said}");
    assert!(!folder.join("z.exr").exists());
}

#[test]
fn a_part_tells_what_it_holds() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let base = format!("render {} {SMALL} --spp 64 --crop 1,2,9,19", scene("cornell.gltf"));
    run(folder, &format!("{base} --part 1/4 --seed 5 --partial a.part"));
    let output = dapple(folder, "info a.part");
    let text = String::from_utf8(output.stdout).expect("text");
    for line in ["pixels    1,2,9,19 of 20x20", "samples   16..32 of 64, all there", "  seed = 5"] {
        assert!(text.contains(line), "{text}");
    }
    let output = dapple(folder, "info a.part --json");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["samples"], serde_json::json!([16, 32]));
    assert_eq!(json["identity"]["seed"], "5");
    let mut bytes = std::fs::read(folder.join("a.part")).expect("there");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(folder.join("a.part"), bytes).expect("written");
    let said = fails(folder, "info a.part", 3);
    assert!(said.contains("a.part: is damaged: the tile"), "{said}");
    assert!(said.contains("remove it and run the command that made it again"), "{said}");
}

#[test]
fn a_part_that_was_stopped_is_made_whole_by_one_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let base = format!("render {} --resolution 400x300 --threads 1 -q", scene("cornell.gltf"));
    let stopped = dapple(
        folder,
        &format!("{base} --spp 1000000 --samples 0..900000 --stop-after 300ms --partial a.part"),
    );
    assert_eq!(stopped.status.code(), Some(75));
    let text = String::from_utf8(dapple(folder, "info a.part").stdout).expect("text");
    assert!(text.contains("a pixel; --checkpoint a.part --resume goes on"), "{text}");
    // Some tiles have samples that others have not, and all lack those of another part.
    let gap = fails(folder, "merge a.part -o x.exr", 3);
    let commands: Vec<&str> = gap.lines().filter(|line| line.contains(" render ")).collect();
    assert_eq!(commands.len(), 2, "{gap}");
    assert!(commands[0].contains("--resume --checkpoint a.part --partial a.part.whole"), "{gap}");
    assert!(commands[1].contains("--samples 900000..1000000 --partial gap0.part"), "{gap}");
    assert!(gap.contains("\nthen merge a.part.whole in place of a.part\n"), "{gap}");
}
