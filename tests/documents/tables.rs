//! Tables of the documents against what the program and its bench say.

use std::process::Command;

use serde_json::Value;

use super::read;

/// The structures as `dapple accels --json` lists them.
fn structures() -> Vec<Value> {
    let output = Command::new(env!("CARGO_BIN_EXE_dapple")).args(["accels", "--json"]).output();
    let json: Value = serde_json::from_slice(&output.expect("it runs").stdout).expect("is JSON");
    json.as_array().expect("is a list").clone()
}

/// A result of the bench that is part of the project.
fn results(name: &str) -> Value {
    let path = super::root().join("docs/results").join(name);
    serde_json::from_slice(&std::fs::read(path).expect("is there")).expect("is JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("is a number")
}

#[test]
fn the_table_of_structures_is_that_of_the_bench() {
    let results = results("structures.json");
    let measured = results["structures"].as_array().expect("is a list");
    let expected: Vec<String> = structures()
        .iter()
        .zip(measured)
        .map(|(known, row)| {
            assert_eq!(known["id"], row["accel"], "dapple bench accels --json");
            let [id, summary, paper] =
                ["id", "summary", "paper"].map(|key| known[key].as_str().expect("is text"));
            let [bytes, seconds, random, primary] =
                ["bytes", "build_s", "random_mrays_s", "primary_mrays_s"]
                    .map(|key| number(&row[key]));
            // Brute force alone takes no time to build.
            assert!(bytes > 0.0 && random > 0.0 && primary > 0.0, "{id}");
            assert!(seconds > 0.0 || id == "brute", "{id}");
            let megabytes = bytes * 1e-6;
            let figures = format!("{megabytes:.1} | {seconds:.2} | {random:.3} | {primary:.3}");
            format!("| `{id}` | {summary} | {paper} | {figures} |")
        })
        .collect();
    assert_eq!(measured.len(), structures().len());
    let document = read("docs/structures.md");
    let found = document.table("| id | what | paper | MB | build s | random | primary |");
    assert!(found == expected, "the table should be\n{}", expected.join("\n"));
}

#[test]
fn the_table_of_work_is_that_of_the_bench() {
    let results = results("kd.json");
    let cell = |set: &Value, key: &str| format!("{:.1}", number(&set[key]));
    let expected: Vec<String> = results["walks"]
        .as_array()
        .expect("is a list")
        .iter()
        .map(|walk| {
            let id = walk["accel"].as_str().expect("is text");
            let sets = ["random", "primary"].map(|set| &walk["sets"][set]);
            let cells = sets.map(|set| {
                ["inner_nodes", "leaves", "triangles"].map(|key| cell(set, key)).join(" | ")
            });
            format!("| `{id}` | {} |", cells.join(" | "))
        })
        .collect();
    let document = read("docs/structures.md");
    let found = document.table("| id | nodes | leaves | triangles | nodes | leaves | triangles |");
    assert!(found == expected, "the table should be\n{}", expected.join("\n"));
}

/// The page is filled by the program from the files of results, as its last command does it.
#[test]
fn the_tables_of_papers_are_those_of_the_bench() {
    let (root, folder) =
        (super::root(), tempfile::tempdir().expect("temporary folders can be made"));
    let committed = std::fs::read_to_string(root.join("docs/results.md")).expect("is there");
    let page = folder.path().join("results.md");
    std::fs::write(&page, &committed).expect("is writable");
    let mut command = Command::new(env!("CARGO_BIN_EXE_dapple"));
    command.args(["bench", "results"]).arg(root.join("docs/results")).arg("--page").arg(&page);
    let output = command.output().expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let filled = std::fs::read_to_string(&page).expect("is there");
    assert!(filled == committed, "renew it: dapple bench results --page docs/results.md");
    // All tables are there, with a row for each scene at least.
    let names = ["measured", "mbvh-1", "mbvh-2", "mbvh-3", "mbvh-4", "mbvh-figure-4", "render"];
    let names = names.into_iter().chain(["coherent-1", "coherent-2", "coherent-3", "coherent-4"]);
    for name in names.chain(["kd"]) {
        let mark = format!("<!-- results: {name} -->\n");
        let (_, table) = filled.split_once(&mark).unwrap_or_else(|| panic!("no table {name}"));
        let rows = table.lines().take_while(|line| line.starts_with('|')).count();
        assert!(rows >= 2 + 4, "{name}: {rows} lines");
    }
    // Some figures, found by another way.
    let mbvh = results("mbvh.json");
    let scene = &mbvh["scenes"][0]["structures"];
    let [binary, wide] = [0, 1].map(|i| number(&scene[i]["closest"]["single_mrays_s"]));
    let row = format!("| {:.0} / 295 | {:.0} / 769 |", binary * 1e3, wide * 1e3);
    assert!(filled.contains(&row), "{row}");
}

#[test]
fn every_structure_has_a_paragraph_of_its_own() {
    let document = read("docs/structures.md");
    for structure in structures() {
        let id = structure["id"].as_str().expect("is text");
        let start = format!("**`{id}`**");
        let paragraph = document.prose().find(|(_, line)| line.starts_with(&start));
        assert!(paragraph.is_some(), "{id}");
    }
}

#[test]
fn every_extension_that_is_honoured_is_listed() {
    let formats = read("docs/formats.md");
    let rows: Vec<&str> = formats.row_names().collect();
    let source = include_str!("../../src/formats/gltf/extensions.rs");
    let (_, list) = source.split_once("const HONOURED").expect("is there");
    let (list, _) = list.split_once("];").expect("ends");
    let names: Vec<&str> = list.split('"').skip(1).step_by(2).collect();
    assert!(names.len() >= 19);
    for name in names {
        assert!(rows.contains(&name), "{name}");
    }
}
