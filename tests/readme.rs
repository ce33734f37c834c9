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
