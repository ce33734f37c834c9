//! What the sources must hold to: floors, no circles, instruction sets in one place, sizes.

mod circles;
mod paths;
mod sources;

use sources::{Source, sources};

/// Rooms by floor, from the bottom; see the crate's documentation.
const FLOORS: [&[&str]; 10] = [
    &["names"],
    &["files", "math", "motion", "simd"],
    &["geom", "sampling", "film"],
    &["accel", "material", "medium", "light", "camera", "texture", "denoise"],
    &["scene", "generate"],
    &["world", "formats", "export"],
    &["integrator"],
    &["render", "bench"],
    &["part"],
    &["cli"],
];

/// The most lines of a file: what a person reads in one sitting.
const MOST_LINES: usize = 400;

fn floor(room: &str) -> usize {
    let found = FLOORS.iter().position(|floor| floor.contains(&room));
    found.unwrap_or_else(|| panic!("room `{room}` has no floor: add it to FLOORS"))
}

#[test]
fn every_room_uses_only_floors_below_it() {
    let sources = sources();
    let mut checked = 0;
    for source in sources.iter().filter(|source| !source.module.is_empty()) {
        let own = &source.module[0];
        for path in paths::paths(source) {
            let Some(room) = path.names.first().filter(|_| path.names != source.module) else {
                continue;
            };
            checked += 1;
            let allowed = room == own || floor(room) < floor(own);
            assert!(allowed, "{} uses {room}, which is not below it", source.file.display());
        }
    }
    assert!(checked > 500, "found {checked} uses only: does this test still read them?");
}

/// Nothing is excepted.
#[test]
fn no_files_use_each_other_in_a_circle() {
    let found = circles::circles(&circles::uses(&sources()));
    assert!(found.is_empty(), "files that use each other in a circle:\n{}", found.join("\n"));
}

#[test]
fn no_file_is_longer_than_one_sitting() {
    let long: Vec<String> = sources::all_files(&["src", "tests", "examples", "fuzz/fuzz_targets"])
        .into_iter()
        .map(|(file, text)| (file, text.lines().count()))
        .filter(|&(_, lines)| lines > MOST_LINES)
        .map(|(file, lines)| format!("{}: {lines} lines", file.display()))
        .collect();
    assert!(long.is_empty(), "longer than {MOST_LINES} lines:\n{}", long.join("\n"));
}

#[test]
fn no_line_is_longer_than_100_columns() {
    let files = sources::all_files(&["src", "tests", "examples", "fuzz/fuzz_targets"]);
    let long: Vec<String> = files
        .iter()
        .flat_map(|(file, text)| text.lines().enumerate().map(move |line| (file, line)))
        .filter(|(_, (_, line))| line.chars().count() > 100)
        .map(|(file, (number, _))| format!("{}:{}", file.display(), number + 1))
        .collect();
    assert!(long.is_empty(), "longer than 100 columns:\n{}", long.join("\n"));
}

#[test]
fn only_the_simd_module_names_instruction_sets() {
    const NAMES: [&str; 7] =
        ["Avx2", "Avx512", "Sse2", "Sse4_2", "core::arch", "std::arch", "target_feature"];
    for source in
        sources().iter().filter(|source| source.module.first().is_some_and(|m| m != "simd"))
    {
        for (number, line) in source.code.lines().enumerate() {
            for name in NAMES {
                assert!(!line.contains(name), "{}:{}: {name}", source.file.display(), number + 1);
            }
        }
    }
}

/// The names that a source of the crate's root gives to what it uses.
fn read(module: &str, text: &str) -> Source {
    Source::read(module.into(), module.split("::").map(str::to_owned).collect(), text)
}

#[test]
fn uses_are_read_as_the_compiler_reads_them() {
    let text = "use super::{b::C, d};\nuse crate::e::{self, f::*};\npub use g::H;\nmod g;\n\
                fn x() { super::i::j(); g::k(); } // crate::not::this\n\
                #[cfg(test)]\nmod tests {\n    use crate::neither::this;\n}\n";
    let found: Vec<String> =
        paths::paths(&read("a::z", text)).iter().map(|path| path.names.join("::")).collect();
    assert_eq!(found, ["a::b::C", "a::d", "e", "e::f::*", "a::z::g::H", "a::i::j", "a::z::g::k"]);
}

#[test]
fn circles_are_found_behind_names_that_are_passed_on() {
    let sources = [
        read("a", "mod b;\nmod c;\npub use b::B;\npub use c::C;\n"),
        read("a::b", "use super::C;\n"),
        read("a::c", "use super::B;\n"),
        read("d", "use crate::a::B;\n"),
    ];
    assert_eq!(circles::circles(&circles::uses(&sources)), ["a::b, a::c"]);
    // What the parent itself defines makes a circle with the child that it passes on.
    let sources =
        [read("a", "mod b;\npub use b::B;\ntype A = u8;\n"), read("a::b", "use super::A;\n")];
    assert_eq!(circles::circles(&circles::uses(&sources)), ["a, a::b"]);
}
