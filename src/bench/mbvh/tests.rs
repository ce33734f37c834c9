//! Tables over a small scene.

use super::structures::Mode;
use super::structures::{INCOHERENCE, INCOHERENT, STRUCTURES};
use super::*;
use crate::bench::test_scene::cloud;
use crate::simd::Isa;

const SETTINGS: MbvhBenchSettings = MbvhBenchSettings {
    rays: 600,
    rounds: 1,
    build: "binned",
    refine: false,
    memory: u64::MAX,
    isa: Isa::Portable,
};

fn scene() -> Scene {
    measure("cloud", &cloud(2000), true, &SETTINGS, &|_| {}).expect("all agree")
}

#[test]
fn every_table_has_its_rows_and_the_papers_columns() {
    let scenes = [scene()];
    let tables = make_tables(&scenes, &SETTINGS);
    let rows: Vec<_> = tables.iter().map(|table| table.rows.len()).collect();
    let figure = 1 + INCOHERENCE.len();
    assert_eq!(rows, [1 + STRUCTURES.len(), 1 + 2 * STRUCTURES.len(), 5, 1, figure]);
    let theirs = |table: &crate::bench::table::Table| {
        table.heading.iter().filter(|name| name.starts_with("P ")).count()
    };
    assert_eq!(tables.iter().map(theirs).collect::<Vec<_>>(), [8, 5, 2, 7, 0]);
    for table in &tables {
        assert!(table.rows.iter().all(|row| row.len() <= table.heading.len()), "{}", table.title);
        assert!(table.note.is_empty() || table.markdown().contains(&table.note));
    }
}

#[test]
fn the_papers_figures_stand_beside_a_scene_of_its_size() {
    let mut scene = scene();
    scene.triangles = 334_080;
    scene.caches.clear();
    let text: String =
        make_tables(&[scene], &SETTINGS).iter().map(crate::bench::table::Table::markdown).collect();
    assert!(!text.contains("Table 3"));
    for theirs in ["(P: Mirror)", " 8.4 ", " 6.6 ", " 0.79 ", " 99.8 ", " 423 ", " 2.06 ", " 2.52 "]
    {
        assert!(text.contains(theirs), "{theirs} in {text}");
    }
    assert!(text.contains("| 205 | 3.00 | 4.56 | 6.88 | 0.75 | 0.57 | 0.43 |"), "{text}");
}

#[test]
fn figures_are_consistent() {
    let scene = scene();
    for one in &scene.structures {
        let what = format!("{} {}", one.id, one.mode.name());
        // All places of nodes lead to nodes, to leaves or nowhere.
        let links = one.report.nodes - 1 + one.report.leaves;
        assert_eq!(one.empty() + links, one.report.nodes * one.width, "{what}");
        assert!(one.width > 2 || one.empty() == 0, "{what}");
        let rate = crate::bench::measure::hit_rate(&one.closest.single.counts);
        assert_eq!(rate.is_some(), one.mode == Mode::Cache, "{what}");
    }
    let (bvh2, mbvh4) = (&scene.structures[0], &scene.structures[1]);
    assert!(mbvh4.bytes < bvh2.bytes, "{} and {}", mbvh4.bytes, bvh2.bytes);
    // A larger cache of the same kind never hits less often where all leaves fit into it.
    let rates: Vec<_> = (scene.caches.iter())
        .map(|cache| crate::bench::measure::hit_rate(&cache.closest.single.counts))
        .collect();
    assert!(rates.iter().all(|rate| *rate == rates[0]), "{rates:?}");
}

#[test]
fn json_and_plots_hold_every_structure() {
    let scenes = [scene()];
    let text = to_json(&scenes, &SETTINGS).to_string();
    let read: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let of_scene = &read["scenes"][0];
    assert_eq!(of_scene["structures"].as_array().map(Vec::len), Some(STRUCTURES.len()));
    assert_eq!(
        of_scene["incoherence"][9]["mrays_s"].as_object().map(serde_json::Map::len),
        Some(INCOHERENT.len())
    );
    assert_eq!(of_scene["caches"].as_array().map(Vec::len), Some(5));
    assert!(of_scene["structures"][1]["closest"]["hit_rate"].as_f64().is_some_and(|h| h > 0.5));
    assert_eq!(read["paper"]["scenes"].as_array().map(Vec::len), Some(4));
    assert!((INCOHERENT.iter()).all(|id| draw_incoherence(&scenes[0]).contains(id)));
    assert!(["bvh2", "mbvh16"].iter().all(|id| draw_scaling(&scenes).contains(id)));
}

#[test]
fn a_scene_without_triangles_is_measured_too() {
    let scene = measure("empty", &cloud(0), false, &SETTINGS, &|_| {}).expect("all agree");
    assert!(make_tables(&[scene], &SETTINGS).len() == 4);
}

#[test]
fn what_would_not_fit_is_refused() {
    let settings = MbvhBenchSettings { memory: 1000, ..SETTINGS };
    let error = measure("cloud", &cloud(100), false, &settings, &|_| {}).expect_err("too large");
    assert!(error.to_string().contains("more than the 1000"), "{error}");
}
