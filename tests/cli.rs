//! What the command line prints: the transcripts in `tests/cmd`.

#[test]
fn transcripts_hold() {
    trycmd::TestCases::new().case("tests/cmd/*.trycmd");
}
