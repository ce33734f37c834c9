//! `dapple farm shell`, by bash.

use std::fs;

use crate::place::{DAPPLE, Place, said};

const RENDER: &str = "cornell.gltf --spp 64 --resolution 24x16 --reproducible -q";

fn script(place: &Place, words: &str) {
    place.write("farm.sh", &format!("farm shell {words} --dapple {DAPPLE}"));
}

#[test]
fn parts_by_a_shell_have_the_bytes_of_one_render() {
    let place = Place::new();
    place.good(&format!("render {RENDER} -o one.exr --png one.png"));
    script(&place, &format!("{RENDER} -o out.exr --png out.png --parts 4"));
    let all = place.command("bash", &["farm.sh"]).env("JOBS", "2").output().expect("bash runs");
    assert!(all.status.success(), "{}", said(&all));
    assert!(place.read("out.exr") == place.read("one.exr"));
    assert!(place.read("out.png") == place.read("one.png"));
}

#[test]
fn a_task_by_its_index_and_the_merge_are_commands_of_their_own() {
    let place = Place::new();
    script(&place, &format!("{RENDER} -o out.exr --parts 2").replace("-q", ""));
    let run = |word: &str| place.command("bash", &["farm.sh", word]).output().expect("bash runs");
    let first = run("0");
    assert!(first.status.success(), "{}", said(&first));
    for word in ["2", "08", "-1", "foo"] {
        let refused = run(word);
        assert!(refused.status.code() == Some(2) && said(&refused).contains("0 to 1"), "{word}");
    }
    let missing = run("merge");
    assert!(missing.status.code() == Some(3) && said(&missing).contains("1.part"));
    assert!(run("1").status.success());
    let before = fs::metadata(place.path("out.parts/1.part")).expect("there").modified();
    assert!(said(&run("1")).contains("there already"));
    let after = fs::metadata(place.path("out.parts/1.part")).expect("there").modified();
    assert_eq!(before.expect("known"), after.expect("known"), "it was left alone");
    let merged = run("merge");
    assert!(merged.status.success(), "{}", said(&merged));
    place.good(&format!("render {RENDER} -o one.exr"));
    assert!(place.read("out.exr") == place.read("one.exr"));
}

#[test]
fn frames_by_a_shell_are_those_of_one_command() {
    let place = Place::new();
    let frames = format!("{RENDER} --frames 7..9").replace("cornell", "motion");
    place.good(&format!("render {frames} -o one.##.exr"));
    for parts in [1, 2] {
        script(&place, &format!("{frames} -o out{parts}.###.exr --parts {parts}"));
        let all = place.command("bash", &["farm.sh"]).output().expect("bash runs");
        assert!(all.status.success(), "{}", said(&all));
        for frame in 7..=9 {
            let (out, one) = (format!("out{parts}.00{frame}.exr"), format!("one.0{frame}.exr"));
            assert!(place.read(&out) == place.read(&one), "{out}");
        }
    }
    assert!(place.read("one.07.exr") != place.read("one.09.exr"), "it moves");
}

#[test]
fn the_scripts_are_good_bash() {
    let place = Place::new();
    for words in ["--parts 3", "--frames 1..9", "--frames 1..9 --parts 2", ""] {
        for system in ["shell", "slurm"] {
            let words = format!("farm {system} cornell.gltf -o a.####.exr {words}");
            place.write("farm.sh", &words);
            let checked = place.command("bash", &["-n", "farm.sh"]).output().expect("bash runs");
            assert!(checked.status.success(), "{words}: {}", said(&checked));
            // Where the linter is installed, it has nothing to say either.
            if let Ok(checked) = place.command("shellcheck", &["farm.sh"]).output() {
                assert!(checked.status.success(), "{words}: {}", said(&checked));
            }
        }
    }
}
