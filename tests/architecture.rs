//! Modules use only floors below their own: read off their `use crate::` lines.

use std::fs;
use std::path::{Path, PathBuf};

/// Top-level modules by floor, from the bottom; see the crate's documentation.
const FLOORS: [&[&str]; 8] = [
    &["files", "math", "simd"],
    &["geom", "sampling", "film"],
    &["accel", "material", "light", "camera", "texture"],
    &["scene", "generate"],
    &["world", "formats"],
    &["integrator"],
    &["render", "bench"],
    &["cli"],
];

fn floor(module: &str) -> usize {
    let found = FLOORS.iter().position(|floor| floor.contains(&module));
    found.unwrap_or_else(|| panic!("module `{module}` has no floor: add it to FLOORS"))
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("the folder of sources").map(|e| e.expect("readable"))
    {
        let path = entry.path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
    files
}

/// Modules named after `crate::` outside comments, `use crate::{a::…, b}` included.
fn used(text: &str) -> Vec<String> {
    let code: String = text.lines().map(|l| l.split("//").next().unwrap_or("")).collect();
    let mut modules = Vec::new();
    for part in code.split("crate::").skip(1) {
        if let Some(group) = part.strip_prefix('{') {
            let (mut depth, mut word) = (0, String::new());
            for c in group.chars() {
                match c {
                    '{' => depth += 1,
                    '}' if depth == 0 => break,
                    '}' => depth -= 1,
                    ',' if depth == 0 => modules.push(std::mem::take(&mut word)),
                    c if depth == 0 => word.push(c),
                    _ => {}
                }
            }
            modules.push(word);
        } else {
            modules.push(part.to_owned());
        }
    }
    let first = |m: String| {
        let m = m.trim().to_owned();
        m.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or("").to_owned()
    };
    modules.into_iter().map(first).filter(|m| !m.is_empty()).collect()
}

#[test]
fn every_module_uses_only_floors_below_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut checked = 0;
    for file in sources(&root) {
        let relative = file.strip_prefix(&root).expect("below the root");
        let own = relative.iter().next().expect("a name").to_string_lossy().replace(".rs", "");
        if own == "lib" || own == "main" {
            continue;
        }
        let text = fs::read_to_string(&file).expect("readable");
        for module in used(&text) {
            checked += 1;
            let allowed = module == own || floor(&module) < floor(&own);
            assert!(allowed, "{} uses {module}, which is not below it", relative.display());
        }
    }
    assert!(checked > 50, "found {checked} uses only: does this test still read them?");
}

#[test]
fn only_the_simd_module_names_instruction_sets() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for file in sources(&root) {
        let relative = file.strip_prefix(&root).expect("below the root");
        if relative.starts_with("simd") {
            continue;
        }
        let text = fs::read_to_string(&file).expect("readable");
        for (number, line) in text.lines().enumerate() {
            let code = line.split("//").next().unwrap_or("");
            for name in
                ["Avx2", "Avx512", "Sse2", "Sse4_2", "core::arch", "std::arch", "target_feature"]
            {
                assert!(!code.contains(name), "{}:{}: {name}", relative.display(), number + 1);
            }
        }
    }
}
