//! What the README says of the structures is what there is.

use dapple::accel::VARIANTS;

#[test]
fn the_table_of_structures_has_each_of_them() {
    let readme = include_str!("../README.md");
    let (_, section) = readme.split_once("\n## Structures\n").expect("it has that section");
    let section = section.split("\n## ").next().unwrap_or_default();
    let cells = section.lines().filter_map(|line| line.strip_prefix("| `")?.split(" | ").next());
    let mut listed: Vec<&str> =
        cells.flat_map(|cell| cell.split_whitespace()).map(|id| id.trim_matches('`')).collect();
    let mut known: Vec<&str> = VARIANTS.iter().map(|variant| variant.id).collect();
    listed.sort_unstable();
    known.sort_unstable();
    assert_eq!(listed, known);
}

#[test]
fn each_row_tells_paper_memory_and_rates() {
    let readme = include_str!("../README.md");
    for variant in VARIANTS {
        let start = format!("| `{}` | ", variant.id);
        let row = readme.lines().find(|line| line.starts_with(&start));
        let row = row.expect("a row of its own");
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        assert_eq!(cells[1..3], [variant.summary, variant.paper], "`bench accels --markdown`");
        let figures = cells[3..].iter().map(|cell| cell.parse::<f64>());
        let figures: Vec<f64> = figures.map(|figure| figure.expect("a figure")).collect();
        let &[bytes, seconds, random, primary] = &figures[..] else { panic!("{row}") };
        // Brute force alone takes no time to build.
        assert!(seconds > 0.0 || row.starts_with("| `brute` |") && seconds == 0.0, "{row}");
        assert!(bytes > 0.0 && random > 0.0 && primary > 0.0, "{row}");
    }
}
