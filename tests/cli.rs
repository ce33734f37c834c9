//! What the command line prints: the transcripts in `tests/cmd`, each a test of its own.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A test for each transcript, by its name.
macro_rules! transcripts {
    ($($name:ident),* $(,)?) => {
        $(
            #[test]
            fn $name() {
                let file = concat!("tests/cmd/", stringify!($name), ".trycmd");
                trycmd::TestCases::new().case(file);
            }
        )*
        const NAMES: &[&str] = &[$(stringify!($name)),*];
    };
}

transcripts![
    bench_coherent_cameras,
    bench_mbvh,
    bench_mbvh_help,
    bench_refusals,
    bench_render,
    bench_render_help,
    bench_results,
    farm,
    generate,
    info,
    missing_inputs,
    pictures,
    rays,
    scenes,
    slips_in_structures,
];

#[test]
fn every_transcript_is_a_test() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cmd");
    let files = fs::read_dir(folder).expect("is there").map(|entry| entry.expect("is readable"));
    let transcripts = files
        .map(|file| file.path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "trycmd"));
    let stems: BTreeSet<String> = transcripts
        .filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned()))
        .collect();
    assert_eq!(stems, NAMES.iter().map(|name| (*name).to_owned()).collect());
}
