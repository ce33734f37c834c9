//! The tables, in the paper's form, its figures beside ours.

use super::bench::FlyThroughBenchSettings;
use super::figures::{Column, Scene};
use super::node_worth;
use super::paper::{self, MACHINE};
use super::structures::{LIGHT_STRUCTURES, Method};
use crate::bench::bars::draw_bars;
use crate::bench::table::{Table, cell};

/// Tables 1 to 4, what nodes are worth, entry points by tiles, and rays to lights.
pub fn make_tables(scenes: &[Scene], settings: &FlyThroughBenchSettings) -> Vec<Table> {
    let titles: [fn(&[Scene], &FlyThroughBenchSettings) -> Table; 7] = [
        table_visits,
        table_rates,
        table_memory,
        table_partition,
        node_worth::make_table,
        table_tilings,
        table_lights,
    ];
    titles.map(|table| table(scenes, settings)).into()
}

fn paper_cells<const N: usize>(
    scene: &Scene,
    figures: impl Fn(&paper::Scene) -> [f64; N],
    decimals: [usize; N],
) -> Vec<String> {
    let Some(paper) = paper::Scene::of(scene.triangles) else { return Vec::new() };
    figures(paper).into_iter().zip(decimals).map(|(x, decimals)| cell(Some(x), decimals)).collect()
}

fn cells(figures: impl IntoIterator<Item = (f64, usize)>) -> impl Iterator<Item = String> {
    figures.into_iter().map(|(x, decimals)| cell(Some(x), decimals))
}

fn pictures(settings: &FlyThroughBenchSettings) -> String {
    let (width, height) = settings.resolution;
    format!("{width}x{height} pixels, up to {} pictures of a flight", settings.frames)
}

fn table_visits(scenes: &[Scene], settings: &FlyThroughBenchSettings) -> Table {
    let note = format!(
        "Thousands of nodes a picture, leaves among them: those that packets enter, and (searched) \
         those that are held against the shafts of the screen and of 8x8 tiles. EP: entry points, \
         PC: compressed paths, both with packets that go down early; ratios are over packets from \
         the root, searches included. {}. P: as the paper prints them; {MACHINE}.",
        pictures(settings)
    );
    let heading = [
        "",
        "packets",
        "EP",
        "searched",
        "PC",
        "searched",
        "EP ratio",
        "PC ratio",
        "PC/EP",
        "P packets",
        "P EP",
        "searched",
        "P PC",
        "searched",
        "P EP ratio",
        "P PC ratio",
    ];
    let mut table = Table::new("Table 1: nodes visited", note, &heading);
    for scene in scenes {
        let thousands = |x: f64| (x * 1e-3, 1);
        let [_, packets] = scene.column(Method::Packet).visits();
        let [entry_searched, entry] = scene.column(Method::EntryPoint).visits();
        let [searched, compressed] = scene.column(Method::Compressed).visits();
        let [entry_ratio, ratio] = scene.visit_ratios();
        let counts = [packets, entry, entry_searched, compressed, searched].map(thousands);
        let ratios = [entry_ratio, ratio, ratio / entry_ratio.max(1e-12)].map(|x| (x, 2));
        let mut row = vec![scene.label()];
        row.extend(cells(counts.into_iter().chain(ratios)));
        row.extend(paper_cells(
            scene,
            |p| {
                let [packets, entry, compressed] = p.visits;
                let [one, two] = p.searched;
                [packets, entry, one, compressed, two, p.ratios[0], p.ratios[1]]
            },
            [0, 0, 1, 0, 1, 2, 2],
        ));
        table.rows.push(row);
    }
    table
}

fn table_rates(scenes: &[Scene], settings: &FlyThroughBenchSettings) -> Table {
    let note = format!(
        "Millions of rays a second on one thread, searches included, rays made before. S: speed-up \
         over packets from the root, and the highest of a picture. each: one more tree for each \
         packet, and no shaft asked while tracing. mbvh8 by the same slices; /mbvh8: packets over \
         it. hit: per cent of rays that meet something. P: {MACHINE}."
    );
    let heading = [
        "",
        "hit",
        "packets",
        "EP",
        "PC",
        "PC each",
        "mbvh8",
        "/mbvh8",
        "EP S",
        "max",
        "PC S",
        "max",
        "P packets",
        "P EP",
        "P PC",
        "P EP S",
        "max",
        "P PC S",
        "max",
    ];
    let mut table = Table::new("Table 2: packets", note, &heading);
    let _ = settings;
    for scene in scenes {
        let names = [
            Method::Packet,
            Method::EntryPoint,
            Method::Compressed,
            Method::CompressedEach,
            Method::Wide,
        ];
        let rates = names.map(|name| scene.rate(scene.column(name)));
        let packets = scene.column(Method::Packet);
        let speed_up = |name| scene.column(name).speed_up(packets);
        let speed_ups = [speed_up(Method::EntryPoint), speed_up(Method::Compressed)].concat();
        let mut row = vec![scene.label(), cell(Some(scene.covered * 100.0), 0)];
        row.extend(cells(rates.map(|rate| (rate, 2))));
        row.extend(cells([(rates[0] / rates[4].max(1e-12), 2)]));
        row.extend(cells(speed_ups.into_iter().map(|x| (x, 2))));
        row.extend(paper_cells(
            scene,
            |p| {
                let [packets, entry, compressed] = p.rates;
                let [[a, b], [c, d]] = p.speed_ups;
                [packets, entry, compressed, a, b, c, d]
            },
            [2; 7],
        ));
        table.rows.push(row);
    }
    table
}

fn table_memory(scenes: &[Scene], settings: &FlyThroughBenchSettings) -> Table {
    let note = format!(
        "Compressed paths in per cent of the hierarchy's nodes (its triangles not counted): in use \
         at once, in the mean picture and at most, and the thread's pool as it has grown. \
         Milliseconds a picture to compress paths for the screen and its 8x8 tiles, both ways; S: \
         recursion over iteration. {}. P: {MACHINE}; there, too, iteration is some 20% faster.",
        pictures(settings)
    );
    let heading = [
        "",
        "triangles",
        "nodes MB",
        "with triangles",
        "mean %",
        "max %",
        "pool %",
        "iterative ms",
        "recursive ms",
        "S",
        "P MB",
        "P mean %",
        "P max %",
        "P pool %",
        "P S",
    ];
    let mut table = Table::new("Table 3: memory and construction", note, &heading);
    for scene in scenes {
        let [nodes, all] = scene.bytes;
        let [mean, most, pool] = scene.pool_shares();
        let [iterative, recursive] = scene.compressing;
        let mut row = vec![scene.label(), scene.triangles.to_string()];
        row.extend(cells([
            (nodes as f64 * 1e-6, 2),
            (all as f64 * 1e-6, 2),
            (mean, 2),
            (most, 2),
            (pool, 2),
            (iterative * 1e3, 3),
            (recursive * 1e3, 3),
            (recursive / iterative.max(1e-12), 2),
        ]));
        let figures = |p: &paper::Scene| {
            let [mean, most, pool] = p.pool;
            [p.megabytes, mean, most, pool, paper::ITERATIVE]
        };
        row.extend(paper_cells(scene, figures, [2, 2, 2, 2, 1]));
        table.rows.push(row);
    }
    table
}

fn table_partition(scenes: &[Scene], _: &FlyThroughBenchSettings) -> Table {
    let note = format!(
        "Millions of rays a second. Partitioned packets from the root, and over compressed paths \
         with one more tree for each packet; bvh2 ray by ray from the root, and over the \
         compressed paths of tiles. P: {MACHINE}."
    );
    let heading = [
        "",
        "partition",
        "PC each",
        "S",
        "max",
        "bvh2",
        "bvh2 PC",
        "S",
        "max",
        "P partition",
        "P PC",
        "P S",
    ];
    let mut table = Table::new("Table 4: partitioned packets, and single rays", note, &heading);
    for scene in scenes {
        let mut row = vec![scene.label()];
        for (from, with) in [
            (Method::Partition, Method::PartitionCompressed),
            (Method::Single, Method::SingleCompressed),
        ] {
            let [from, with] = [from, with].map(|name| scene.column(name));
            let [mean, most] = with.speed_up(from);
            row.extend(cells([scene.rate(from), scene.rate(with), mean, most].map(|x| (x, 2))));
        }
        let figures = |p: &paper::Scene| [p.partition[0], p.partition[1], p.partition_speed_up];
        row.extend(paper_cells(scene, figures, [2, 2, 2]));
        table.rows.push(row);
    }
    table
}

fn table_tilings(scenes: &[Scene], _: &FlyThroughBenchSettings) -> Table {
    let note = "bvh-entry-point with so many tiles a picture, and kd-entry-point, which cuts the \
                8x8 tiles where the scene is complex. Thousands of nodes a picture, \
                searched and in all; S: speed-up over packets from the root by 8x8 tiles.";
    let heading = ["", "searched", "in all", "ratio", "Mrays/s", "S"];
    let mut table = Table::new("Entry points by tiles", note, &heading);
    for scene in scenes {
        table.rows.push(vec![scene.label()]);
        let packets = scene.column(Method::Packet);
        for (tiling, column) in &scene.tilings {
            let [searched, _] = column.visits();
            let ratio = column.all_visits() / packets.all_visits().max(1.0);
            let mut row = vec![format!("  {}", tiling.name())];
            row.extend(cells([
                (searched * 1e-3, 1),
                (column.all_visits() * 1e-3, 1),
                (ratio, 2),
                (scene.rate(column), 2),
                (column.speed_up(packets)[0], 2),
            ]));
            table.rows.push(row);
        }
    }
    table
}

fn table_lights(scenes: &[Scene], _: &FlyThroughBenchSettings) -> Table {
    let note = "The paper's open questions (5.2). Shadow rays from what the pictures show to a \
                light of limited range, and to one that shines into a pyramid: millions of rays a \
                second, and nodes a ray, searched ones included. PC a light: compressed once for \
                the light's region, then for each tile; bvh2 PC: ray by ray below that. Area \
                light: 256 rays from a pixel are a packet, and paths are compressed for each.";
    let columns = LIGHT_STRUCTURES.map(|(name, ..)| name);
    let nodes = columns.map(|name| format!("{name} nodes"));
    let mut table = Table::new("Rays to lights", note, &[""]);
    table.heading.extend(columns.iter().map(|&name| name.to_owned()).chain(nodes));
    for scene in scenes {
        table.rows.push(vec![scene.label()]);
        for light in &scene.lights {
            let mut row = vec![format!("  {}", light.kind.name())];
            row.extend(cells(light.columns.iter().map(|one| (light.rate(one), 2))));
            let nodes = |one: &Column| {
                one.all_visits() * one.seconds.len() as f64 / light.rays.max(1) as f64
            };
            row.extend(cells(light.columns.iter().map(|one| (nodes(one), 3))));
            table.rows.push(row);
        }
    }
    table
}

/// Speed-ups and visits as bars, the paper's beside ours: stems of files, and pictures.
pub fn draw_plots(scenes: &[Scene]) -> Vec<(String, String)> {
    let series = ["ours", "P"];
    let mut speed_ups = Vec::new();
    let mut visits = Vec::new();
    for scene in scenes {
        let paper = paper::Scene::of(scene.triangles);
        let add = |rows: &mut Vec<_>, what: &str, ours: f64, theirs: Option<f64>| {
            rows.push((format!("{}: {what}", scene.name), vec![ours, theirs.unwrap_or(f64::NAN)]));
        };
        let over = |with, from| scene.column(with).speed_up(scene.column(from))[0];
        let rows = &mut speed_ups;
        add(rows, "EP", over(Method::EntryPoint, Method::Packet), paper.map(|p| p.speed_ups[0][0]));
        add(rows, "PC", over(Method::Compressed, Method::Packet), paper.map(|p| p.speed_ups[1][0]));
        let with = over(Method::PartitionCompressed, Method::Partition);
        add(rows, "PC, partition", with, paper.map(|p| p.partition_speed_up));
        let [entry, compressed] = scene.visit_ratios();
        add(&mut visits, "EP", entry, paper.map(|p| p.ratios[0]));
        add(&mut visits, "PC", compressed, paper.map(|p| p.ratios[1]));
    }
    vec![
        ("speed-ups".to_owned(), draw_bars("Speed-ups", "times", &series, &speed_ups)),
        ("visits".to_owned(), draw_bars("Nodes visited", "over packets", &series, &visits)),
    ]
}
