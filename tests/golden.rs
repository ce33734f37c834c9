//! The stored pictures still come out.

use std::process::Command;

#[test]
fn every_golden_picture_comes_out_again() {
    let root = env!("CARGO_MANIFEST_DIR");
    let output = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .args(["golden", "check", &format!("{root}/golden")])
        .output()
        .expect("the binary runs");
    let table = String::from_utf8_lossy(&output.stdout);
    let messages = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{table}\n{messages}");
    for name in [
        "cornell",
        "furnace",
        "metals",
        "glass",
        "finishes",
        "textured",
        "sky",
        "instanced",
        "alpha",
    ] {
        assert!(table.contains(name), "{name} is not in\n{table}");
    }
}

/// Exit status and table of a check of the project's pictures with further words.
fn check(words: &[&str]) -> (Option<i32>, String) {
    let root = env!("CARGO_MANIFEST_DIR");
    let output = Command::new(env!("CARGO_BIN_EXE_dapple"))
        .args(["golden", "check", &format!("{root}/golden"), "--only", "furnace", "--"])
        .args(words)
        .output()
        .expect("the binary runs");
    (output.status.code(), String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn words_of_the_command_line_override_those_of_the_manifest() {
    let (code, table) = check(&["--spp", "1"]);
    assert!(code == Some(1) && table.contains("DIFFERS"), "{table}");
    let (code, table) = check(&["--accel", "kd-ropes", "--threads", "1"]);
    assert!(code == Some(0) && table.contains("same"), "{table}");
}

#[test]
fn words_that_cannot_be_keep_their_exit_status() {
    for (words, expected, said) in [
        (&["--spq", "1"][..], 2, "unexpected argument '--spq'"),
        (&["--spp", "0"], 2, "--spp"),
        (&["-o", "x.exr"], 2, "-o has no place here"),
        (&["--png", "x.png"], 2, "--png has no place here"),
        (&["--json"], 2, "--json has no place here"),
        (&["--debug-sample", "0,0,0"], 2, "--debug-sample has no place here"),
        (&["--env", "no-such.hdr"], 3, "no-such.hdr: no such file"),
        (&["--resolution", "16384x16384", "--spp", "4294967295"], 5, "GB of memory"),
    ] {
        let (code, table) = check(words);
        assert_eq!(code, Some(expected), "{words:?}: {table}");
        assert!(table.contains("FAILED") && table.contains(said), "{words:?}: {table}");
    }
}
