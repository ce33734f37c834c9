//! What it is worth to spare nodes: why speed-ups differ from the paper's.

use serde_json::{Map, Value, json};

use super::bench::FlyThroughBenchSettings;
use super::figures::{Column, Scene};
use super::paper;
use super::structures::Method;
use crate::accel::Event;
use crate::bench::table::{Table, cell};

/// Rays of a packet, which the table counts by.
const RAYS: f64 = 256.0;

/// Events, and seconds, of packets from the root or over compressed paths.
type Cost = [f64; 2];

/// Rows of the table, and what is compared.
const PAIRS: [(&str, Method, Method); 2] = [
    ("packets", Method::Packet, Method::Compressed),
    ("partitioned, a tree each", Method::Partition, Method::PartitionCompressed),
];

/// Seconds that each event spared has saved, and the share of the time from the root that all of
/// them would take at that price; `None` where less than a tenth of them was spared, which tells
/// nothing.
fn price([events, seconds]: Cost, [fewer, faster]: Cost) -> Option<[f64; 2]> {
    if fewer >= 0.9 * events {
        return None;
    }
    let each = (seconds - faster) / (events - fewer);
    Some([each, each * events / seconds.max(1e-12)])
}

/// Nanoseconds and per cent.
fn worth_cells(worth: Option<[f64; 2]>) -> [String; 2] {
    let [each, share] = worth.map_or([None; 2], |[each, share]| [Some(each), Some(share)]);
    [cell(each.map(|x| x * 1e9), 1), cell(share.map(|x| x * 100.0), 0)]
}

/// The paper's, of a picture: packets from the root, and over compressed paths.
fn theirs(scene: &paper::Scene) -> [Cost; 2] {
    let seconds = |rate: f64| paper::RAYS * 1e-6 / rate;
    let [packets, _, compressed] = scene.visits;
    let nodes = [packets, compressed + scene.searched[1]].map(|thousands| thousands * 1e3);
    [[nodes[0], seconds(scene.rates[0])], [nodes[1], seconds(scene.rates[2])]]
}

/// The work of a packet from the root and over compressed paths, and what a node spared is worth.
pub fn make_table(scenes: &[Scene], _: &FlyThroughBenchSettings) -> Table {
    let note = "For each 256 rays: nodes, searched ones among them; bundles of eight rays held \
                against boxes, and against triangles; exact tests of single rays. Of packets from \
                the root, and over compressed paths (PC). ns a node: what was gained in time, for \
                each node spared; share: what all nodes of packets from the root would take at \
                that price, in per cent of their time. The same by box tests: another reading of \
                the same gain. A share says how much there is to gain by sparing; where it is \
                below the paper's (P, by its tables 1 and 2), so are speed-ups. Tests of \
                triangles, as many either way, and the setting up of packets take the rest. Below \
                zero: the spared cost less than to find them.";
    let heading = [
        "",
        "nodes",
        "PC",
        "box tests",
        "PC",
        "triangle tests",
        "PC",
        "exact tests",
        "PC",
        "ns a node",
        "share",
        "ns a box test",
        "share",
        "P nodes",
        "P PC",
        "P ns a node",
        "P share",
    ];
    let mut table = Table::new("What a node spared is worth", note, &heading);
    for scene in scenes {
        table.rows.push(vec![scene.label()]);
        for (what, from, with) in PAIRS {
            let mut row = vec![format!("  {what}")];
            row.extend(ours(scene, [from, with].map(|name| scene.column(name))));
            let paper = paper::Scene::of(scene.triangles).filter(|_| from == Method::Packet);
            row.extend(paper.map(paper_cells).into_iter().flatten());
            table.rows.push(row);
        }
    }
    table
}

fn ours(scene: &Scene, [from, with]: [&Column; 2]) -> Vec<String> {
    let packets = (scene.rays * from.seconds.len()).max(1) as f64 / RAYS;
    let of = |event: Event| [from, with].map(|one| one.counts[event] as f64);
    let counts = [of(Event::BoxTest), of(Event::TriangleTest), of(Event::ExactTest)];
    let mut cells: Vec<_> = [from, with].map(|one| cell(Some(nodes(one) / packets), 1)).into();
    cells.extend(counts.into_iter().flatten().map(|count| cell(Some(count / packets), 0)));
    cells.extend(prices([from, with]).map(worth_cells).concat());
    cells
}

/// What nodes and box tests are worth, in seconds and as a share; `null` where that is not known.
pub fn to_json(scene: &Scene) -> Value {
    let object = |(what, from, with): (&str, Method, Method)| {
        let columns = [from, with].map(|name| scene.column(name));
        let [nodes, boxes] = prices(columns).map(|worth| match worth {
            Some([each, share]) => json!({ "seconds": each, "share": share }),
            None => Value::Null,
        });
        (what.to_owned(), json!({ "node": nodes, "box_test": boxes }))
    };
    PAIRS.into_iter().map(object).collect::<Map<_, _>>().into()
}

/// What nodes and box tests are worth.
fn prices([from, with]: [&Column; 2]) -> [Option<[f64; 2]>; 2] {
    let of = |[many, few]: [f64; 2]| price([many, from.total()], [few, with.total()]);
    let boxes = [from, with].map(|one| one.counts[Event::BoxTest] as f64);
    [of([from, with].map(nodes)), of(boxes)]
}

/// Nodes looked at, of all pictures.
fn nodes(column: &Column) -> f64 {
    column.all_visits() * column.seconds.len() as f64
}

fn paper_cells(scene: &paper::Scene) -> Vec<String> {
    let [from, with] = theirs(scene);
    let packets = paper::RAYS / RAYS;
    let mut cells: Vec<_> = [from[0], with[0]].map(|nodes| cell(Some(nodes / packets), 1)).into();
    cells.extend(worth_cells(price(from, with)));
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_nodes_for_a_quarter_of_the_time_are_half_of_it() {
        let [each, share] = price([1000.0, 4e-3], [500.0, 3e-3]).expect("many are spared");
        assert!((each - 2e-6).abs() < 1e-12 && (share - 0.5).abs() < 1e-9, "{each} {share}");
        assert_eq!(price([1000.0, 4e-3], [950.0, 3e-3]), None);
    }

    #[test]
    fn nodes_took_a_third_of_the_papers_time_in_its_city() {
        let city = paper::Scene::of(9_200).expect("is in the paper");
        let [each, share] = price(theirs(city)[0], theirs(city)[1]).expect("many are spared");
        // 137.3 thousand nodes and 25.8 ms less, of 199 thousand in 119 ms.
        assert!((each * 1e9 - 188.0).abs() < 1.0 && (share - 0.314).abs() < 1e-3, "{each} {share}");
    }
}
