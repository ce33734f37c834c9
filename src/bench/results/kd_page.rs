//! What Hapala and Havran's review says of kd-tree walks, beside the figures of `bench kd`.

use super::member::{Malformed, Member};
use crate::bench::table::Table;

/// What is set in relation.
#[derive(Clone, Copy)]
enum Figure {
    /// Nodes and leaves a ray.
    Nodes,
    /// Rays a second.
    Rate,
}

/// A statement of the review: what it is about, the walks compared, and its own figure or words.
struct Statement {
    what: &'static str,
    walk: &'static str,
    over: &'static str,
    figure: Figure,
    review: &'static str,
}

const fn statement(
    what: &'static str,
    [walk, over]: [&'static str; 2],
    figure: Figure,
    review: &'static str,
) -> Statement {
    Statement { what, walk, over, figure, review }
}

const STACK: &str = "kd-stack-direction";

/// In the review's order.
const STATEMENTS: [Statement; 12] = [
    statement("3.1 sequential: nodes", ["kd-sequential", STACK], Figure::Nodes, "more"),
    statement(
        "3.1 sequential: rate",
        ["kd-sequential", STACK],
        Figure::Rate,
        "\"not very efficient\"",
    ),
    statement("3.3 links: nodes", ["kd-ropes", STACK], Figure::Nodes, "less, on average"),
    statement("3.3 links: rate", ["kd-ropes", STACK], Figure::Rate, ""),
    statement("3.3 link trees: nodes", ["kd-rope-trees", "kd-ropes"], Figure::Nodes, "less"),
    statement("5.1 backtrack: nodes", ["kd-backtrack", "kd-restart"], Figure::Nodes, "less"),
    statement("5.2 push-down: nodes", ["kd-push-down", "kd-restart"], Figure::Nodes, "less"),
    statement("5.4 short stack: nodes", ["kd-short-stack", STACK], Figure::Nodes, "below 1.03"),
    statement("5.4 large stack: rate", [STACK, "kd-short-stack"], Figure::Rate, "above 1"),
    statement("5.4 spilling: rate", ["kd-spill", "kd-short-stack"], Figure::Rate, "1.23"),
    statement("5.5 branchless: rate", ["kd-branchless", "kd-stack-origin"], Figure::Rate, ""),
    statement("6.4 prefetching: rate", ["kd-prefetch", STACK], Figure::Rate, "1.05 to 1.12"),
];

/// The sets, in the order of columns.
const SETS: [&str; 3] = ["random", "primary", "bounce"];

/// The table by name, as Markdown.
///
/// # Errors
/// A member that is missing or of another kind.
pub fn make_tables(root: &Member<'_>) -> Result<Vec<(&'static str, String)>, Malformed> {
    let heading = ["", "of", "over", "random", "primary", "bounce", "the review"];
    let mut table = Table::new("", "", &heading);
    let walks = root.get("walks")?;
    for Statement { what, walk, over, figure, review } in STATEMENTS {
        let mut row = vec![what.to_owned(), format!("`{walk}`"), format!("`{over}`")];
        for set in SETS {
            let ratio = read(&walks, walk, set, figure)? / read(&walks, over, set, figure)?;
            row.push(format!("{ratio:.3}"));
        }
        row.push(review.to_owned());
        table.rows.push(row);
    }
    Ok(vec![("kd", table.markdown_rows())])
}

/// A figure of a walk for a set.
fn read(walks: &Member<'_>, id: &str, set: &str, figure: Figure) -> Result<f64, Malformed> {
    for walk in walks.items()? {
        if walk.get("accel")?.text()? != id {
            continue;
        }
        let set = walk.get("sets")?.get(set)?;
        let nodes = set.get("inner_nodes")?;
        return match figure {
            Figure::Rate => set.get("mrays_s")?.positive(),
            Figure::Nodes => {
                let sum = nodes.number()? + set.get("leaves")?.number()?;
                if sum > 0.0 { Ok(sum) } else { Err(nodes.wrong("and the leaves are zero")) }
            }
        };
    }
    Err(walks.wrong(format!("lacks {id}")))
}
