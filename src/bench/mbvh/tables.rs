//! The tables, in the paper's form, its figures beside ours.

use super::figures::{Incoherence, Rates, Scene, Structure};
use super::measure::MbvhBenchSettings;
use super::paper::{self, MACHINE};
use super::structures::{AUTO, INCOHERENT, Mode};
use crate::accel::Event;
use crate::bench::measure::{hit_rate, speed_up};
use crate::bench::plot::{Curve, draw_curves};
use crate::bench::table::{Table, cell};

/// Tables 1 to 4 and figure 4 as one.
pub fn make_tables(scenes: &[Scene], settings: &MbvhBenchSettings) -> Vec<Table> {
    let mut tables = vec![table_builds(scenes, settings), table_rates(scenes)];
    tables.extend(scenes.iter().filter(|scene| !scene.caches.is_empty()).map(table_caches));
    tables.extend([table_widths(scenes), table_incoherence(scenes)]);
    tables
}

fn row_name(structure: &Structure, suffix: &str) -> String {
    format!("  {} {}{suffix}", structure.id, structure.mode.name())
}

/// The paper's row for a structure: the binary tree's or the four-wide one's, and only where
/// leaves hold references as there.
fn paper_row(structure: &Structure) -> Option<usize> {
    match (structure.mode, structure.id) {
        (Mode::Cache, "bvh2") => Some(0),
        (Mode::Cache, "mbvh4") => Some(1),
        _ => None,
    }
}

fn thousands(count: usize) -> String {
    format!("{:.1}", count as f64 * 1e-3)
}

fn table_builds(scenes: &[Scene], settings: &MbvhBenchSettings) -> Table {
    let refined = if settings.refine { ", refined" } else { "" };
    let note = format!(
        "All but auto: build={}{refined}. T_B: seconds for the binary tree, T_C: to collapse it, \
         wide nodes written, layout: to write out the rest, one thread. N_L: thousands of leaves, \
         N_E: thousands of places for children left empty (the paper: empty leaves). L: mean leaf, \
         D: mean depth. `cache`: leaves hold references (of bvh2, too, four places a leaf); /bvh2: \
         memory over that of bvh2 in the same mode. \
         C_T is {} for all. P: {MACHINE}.",
        settings.build,
        crate::accel::bvh::sah::TRAVERSAL_COST
    );
    let heading = [
        "", "T_B", "T_C", "layout", "N_L", "N_E", "L", "D", "MB", "/bvh2", "P T_B", "P T_C",
        "P N_L", "P N_E", "P L", "P D", "P MB", "P /BVH",
    ];
    let mut table = Table::new("Table 1: construction", note, &heading);
    for scene in scenes {
        table.rows.push(vec![scene.label()]);
        for structure in &scene.structures {
            table.rows.push(build_row(scene, structure));
        }
    }
    table
}

fn build_row(scene: &Scene, structure: &Structure) -> Vec<String> {
    let wide = structure.width > 2;
    let ratio = structure.bytes as f64 / scene.binary_of(structure).bytes.max(1) as f64;
    let mut row = vec![
        row_name(structure, ""),
        cell(Some(structure.tree_seconds()), 3),
        cell(wide.then(|| structure.collapse_seconds()), 4),
        cell(Some(structure.layout_seconds()), 3),
        thousands(structure.report.leaves),
        if wide && structure.id != AUTO { thousands(structure.empty()) } else { String::new() },
        cell(Some(structure.report.mean_leaf), 2),
        cell(Some(structure.report.mean_depth), 1),
        cell(Some(structure.bytes as f64 * 1e-6), 1),
        cell(wide.then_some(ratio), 2),
    ];
    let papers = paper::Scene::of(scene.triangles).zip(paper_row(structure));
    if let Some((scene, which)) = papers {
        let built = scene.built[which];
        row.extend([
            cell(Some(built.tree_seconds), 1),
            cell(built.collapse_seconds, 2),
            cell(Some(built.leaves), 0),
            cell(built.empty, 0),
            cell(Some(built.mean_leaf), 1),
            cell(Some(built.mean_depth), 1),
            cell(Some(built.megabytes), 1),
            cell((which == 1).then(|| scene.memory_ratio()), 2),
        ]);
    }
    row
}

fn table_rates(scenes: &[Scene]) -> Table {
    let note = format!(
        "Random rays, one thread. tests: tests of a block of triangles, triangles: those in them, \
         boxes: tests of a node's boxes, each per ray; H: per cent of look-ups in a cache of 100 \
         MB that hit, empty at first; krays/s and S, the speed-up over bvh2 in the same mode, ray \
         by ray as in the paper and by slices. P: {MACHINE}; it counts triangles and boxes of its \
         BVH one by one, and ours by up to four and by two."
    );
    let heading = [
        "",
        "tests",
        "triangles",
        "boxes",
        "H",
        "krays/s",
        "S",
        "slices",
        "S slices",
        "P tests",
        "P boxes",
        "P H",
        "P krays/s",
        "P S",
    ];
    let mut table = Table::new("Table 2: random rays", note, &heading);
    for scene in scenes {
        table.rows.push(vec![scene.label()]);
        for mode in [Mode::Cache, Mode::Inline] {
            for shadow in [true, false] {
                let structures = scene.structures_of(mode);
                table.rows.extend(structures.map(|one| rates_row(scene, one, shadow)));
            }
        }
    }
    table
}

fn rates_row(scene: &Scene, structure: &Structure, shadow: bool) -> Vec<String> {
    let of = |one: &Structure| if shadow { one.shadow } else { one.closest };
    let (ours, binary) = (of(structure), of(scene.binary_of(structure)));
    let work = &ours.single;
    let wide = structure.width > 2;
    let mut row = vec![
        row_name(structure, if shadow { " shadow" } else { "" }),
        cell(Some(work.per_ray(Event::TriangleTest)), 2),
        cell(Some(work.per_ray(Event::TriangleLane)), 1),
        cell(Some(work.per_ray(Event::BoxTest)), 1),
        cell(hit_rate(&work.counts).map(|rate| rate * 100.0), 1),
        cell(Some(work.rate() * 1e3), 0),
        cell(wide.then(|| speed_up(work, &binary.single)), 2),
        cell(Some(ours.slices.rate() * 1e3), 0),
        cell(wide.then(|| speed_up(&ours.slices, &binary.slices)), 2),
    ];
    if let Some((scene, which)) = paper::Scene::of(scene.triangles).zip(paper_row(structure)) {
        let pair = if shadow { scene.shadow } else { scene.closest };
        let theirs = pair[which];
        row.extend([
            cell(Some(theirs.triangle_tests), 1),
            cell(Some(theirs.box_tests), 1),
            cell(theirs.hit_rate, 1),
            cell(Some(theirs.krays), 0),
            cell((which == 1).then(|| paper::speed_up(&pair)), 2),
        ]);
    }
    row
}

fn table_caches(scene: &Scene) -> Table {
    let note = format!(
        "mbvh4:triangles=cache, nearest hits, a cache that is empty at first: few rays do not \
         fill it. H in per cent, counted ray by ray. P: the car of 4,304,391 triangles; {MACHINE}."
    );
    let heading = ["MB", "H", "krays/s", "slices", "P H", "P krays/s"];
    let title = format!("Table 3: size of the cache, {}", scene.label());
    let mut table = Table::new(title, note, &heading);
    for (cache, (_, theirs, krays)) in scene.caches.iter().zip(paper::CACHES) {
        let Rates { single, slices } = &cache.closest;
        table.rows.push(vec![
            cache.megabytes.to_string(),
            cell(hit_rate(&single.counts).map(|rate| rate * 100.0), 1),
            cell(Some(single.rate() * 1e3), 0),
            cell(Some(slices.rate() * 1e3), 0),
            cell(Some(theirs), 1),
            cell(Some(krays), 0),
        ]);
    }
    table
}

fn table_widths(scenes: &[Scene]) -> Table {
    let note = format!(
        "Nearest hits, triangles in the leaves: krays/s of bvh2, and the rates of the others over \
         it, native vectors. P: krays/s of a BVH, and what the paper simulated without vectors, \
         times the lanes; {MACHINE}."
    );
    let heading = [
        "",
        "bvh2",
        "mbvh4",
        "mbvh8",
        "mbvh16",
        "slices bvh2",
        "slices mbvh4",
        "slices mbvh8",
        "slices mbvh16",
        "P BVH",
        "P 4",
        "P 8",
        "P 16",
        "P 4 simulated",
        "P 8 simulated",
        "P 16 simulated",
    ];
    let mut table = Table::new("Table 4: width", note, &heading);
    for scene in scenes {
        let mut row = vec![scene.label()];
        for part in [|rates: &Rates| rates.single, |rates: &Rates| rates.slices] {
            let rate = |one: &Structure| part(&one.closest).rate();
            let fixed = scene.structures_of(Mode::Inline).filter(|one| one.id != AUTO);
            let mut rates = fixed.map(rate);
            let binary = rates.next();
            row.push(cell(binary.map(|rate| rate * 1e3), 0));
            row.extend(rates.map(|rate| cell(binary.map(|binary| rate / binary), 2)));
        }
        if let Some(paper) = paper::Scene::of(scene.triangles) {
            row.push(cell(Some(paper.closest[0].krays), 0));
            for ratios in [paper.potential, paper.simulated] {
                row.extend((0..3).map(|i| cell(ratios.map(|ratios| ratios[i]), 2)));
            }
        }
        table.rows.push(row);
    }
    table
}

fn table_incoherence(scenes: &[Scene]) -> Table {
    let note = "krays/s of packets of 16 by 16 rays between two points, either end jittered in \
                the scene's box times I; triangles in the leaves.";
    let mut table = Table::new("Figure 4: incoherence", note, &["I"]);
    table.heading.extend(INCOHERENT.map(str::to_owned));
    for scene in scenes {
        table.rows.push(vec![scene.label()]);
        for row in &scene.incoherence {
            let rates = row.rates.iter().map(|&rate| cell(Some(rate * 1e3), 0));
            let factor = std::iter::once(format!("  {}", row.factor));
            table.rows.push(factor.chain(rates).collect());
        }
    }
    table
}

/// Figure 4 of a scene.
pub fn draw_incoherence(scene: &Scene) -> String {
    let curve = |(column, id): (usize, &&str)| {
        let point = |row: &Incoherence| (f64::from(row.factor), row.rates[column]);
        Curve { name: (*id).to_owned(), points: scene.incoherence.iter().map(point).collect() }
    };
    let curves: Vec<_> = INCOHERENT.iter().enumerate().map(curve).collect();
    draw_curves(&format!("Packets, {}", scene.label()), "incoherence I", "Mrays/s", &curves)
}

/// How rates fall with the number of triangles: nearest hits by slices, triangles in the leaves.
pub fn draw_scaling(scenes: &[Scene]) -> String {
    let mut scenes: Vec<_> = scenes.iter().collect();
    scenes.sort_by_key(|scene| scene.triangles);
    let ids = scenes.first().into_iter().flat_map(|scene| scene.structures_of(Mode::Inline));
    let curve = |id: &str| {
        let point = |scene: &&Scene| {
            let one = scene.structures_of(Mode::Inline).find(|one| one.id == id)?;
            Some((scene.triangles as f64, one.closest.slices.rate()))
        };
        Curve { name: id.to_owned(), points: scenes.iter().filter_map(point).collect() }
    };
    let curves: Vec<_> = ids.map(|one| curve(one.id)).collect();
    draw_curves("Random rays, nearest hits, by slices", "triangles", "Mrays/s", &curves)
}
