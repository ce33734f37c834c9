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

/// A script whose tasks end with codes of their own, by a program in dapple's place.
fn script_of_codes(place: &Place, codes: [u8; 4]) {
    let lines = codes.map(|code| format!("exit {code}"));
    let [a, b, c, d] = lines;
    let program = format!(
        "#!/bin/sh\ncase \"$*\" in\n*0/4*) {a} ;;\n*1/4*) {b} ;;\n*2/4*) {c} ;;\n*3/4*) {d} ;;\n\
         *) echo merged >>merged ;;\nesac\n"
    );
    place.program("false-dapple", &program);
    let words = format!("farm shell {RENDER} -o out.exr --parts 4 --dapple ./false-dapple");
    place.write("farm.sh", &words);
}

#[test]
fn the_whole_ends_with_the_code_of_what_failed_first_or_else_of_what_stopped() {
    // Where two count alike, either may be the first if both run at a time.
    for (codes, expected, or) in [
        ([0; 4], 0, 0),
        ([0, 75, 3, 2], 3, 2),
        ([0, 143, 75, 0], 143, 75),
        ([75; 4], 75, 75),
        ([0, 0, 0, 70], 70, 70),
    ] {
        let place = Place::new();
        script_of_codes(&place, codes);
        for jobs in ["1", "3"] {
            let all = place.command("bash", &["farm.sh"]).env("JOBS", jobs).output();
            let all = all.expect("bash runs");
            let code = all.status.code();
            let is_right = code == Some(expected) || jobs == "3" && code == Some(or);
            assert!(is_right, "{}", said(&all));
        }
        assert_eq!(place.text("merged"), if expected == 0 { "merged\nmerged\n" } else { "" });
    }
    let place = Place::new();
    script_of_codes(&place, [0; 4]);
    for jobs in ["0", "two", ""] {
        let all = place.command("bash", &["farm.sh"]).env("JOBS", jobs).output();
        assert_eq!(all.expect("bash runs").status.code(), Some(i32::from(!jobs.is_empty()) * 2));
    }
}

#[test]
fn signals_reach_all_tasks_and_the_script_waits_for_them() {
    for (signal, code) in [("TERM", 143), ("USR1", 75), ("INT", 130)] {
        if signal == "INT" && is_interrupt_ignored() {
            eprintln!(
                "skipped: INT: these tests run in the background of a script, which ignores it"
            );
            continue;
        }
        let place = Place::new();
        let words = "cornell.gltf --spp 100000000 --resolution 24x16 --threads 1 -q";
        script(&place, &format!("{words} -o out.exr --parts 4"));
        let mut command = place.command("bash", &["farm.sh"]);
        let mut running = command.env("JOBS", "2").spawn().expect("bash runs");
        // The kernel's list of a process's children is empty as long as it has none.
        let children = || {
            let list = format!("/proc/{0}/task/{0}/children", running.id());
            fs::read_to_string(list).unwrap_or_default()
        };
        let children: Vec<String> = loop {
            std::thread::sleep(std::time::Duration::from_millis(300));
            let found: Vec<String> = children().split_whitespace().map(str::to_owned).collect();
            if found.len() == 2 {
                break found;
            }
        };
        let id = running.id().to_string();
        assert!(place.command("kill", &["-s", signal, &id]).status().expect("kill runs").success());
        assert_eq!(running.wait().expect("it ends").code(), Some(code), "{signal}");
        for child in children {
            let name = fs::read_to_string(format!("/proc/{child}/comm")).unwrap_or_default();
            assert!(!name.starts_with("dapple"), "{signal}: {name} still runs");
        }
        assert!(!place.path("out.parts/2.part").exists(), "{signal}: no more were begun");
    }
}

/// Whether this process was started with SIGINT ignored, which bash then cannot catch.
fn is_interrupt_ignored() -> bool {
    const INTERRUPT: u64 = 1 << (2 - 1);
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.unwrap_or(0) & INTERRUPT != 0
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
