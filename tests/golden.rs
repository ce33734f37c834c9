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
    for name in ["cornell", "furnace", "metals", "glass", "textured", "sky", "instanced", "alpha"] {
        assert!(table.contains(name), "{name} is not in\n{table}");
    }
}
