//! Tables over a small scene.

use super::figures::Scene;
use super::frame::Frame;
use super::measure::spread;
use super::structures::{ACROSS, FINER, LightKind, Method, STRUCTURES};
use super::*;
use crate::accel::{AccelSpec, build};
use crate::bench::table::Table;
use crate::bench::test_scene::cloud;
use crate::camera::flight::Pose;
use crate::math::Vec3;
use crate::simd::Isa;

const SETTINGS: FlyThroughBenchSettings = FlyThroughBenchSettings {
    resolution: (40, 24),
    frames: 2,
    rounds: 1,
    build: "binned",
    memory: u64::MAX,
    isa: Isa::Portable,
};

fn flight() -> Vec<Pose> {
    let pose = |i: u16| {
        let eye = Vec3::new(20.0 + 3.0 * f32::from(i), 18.0, -40.0);
        Pose::new(eye, Vec3::new(18.0, 15.0, 25.0), 50.0)
    };
    (0..5).map(pose).collect()
}

fn scene() -> Scene {
    measure("cloud", &cloud(2000), &flight(), &SETTINGS, &|_| {}).expect("all agree")
}

#[test]
fn every_table_has_its_rows_and_no_row_is_too_long() {
    let mut scene = scene();
    scene.triangles = 644_000;
    let tables = make_tables(&[scene], &SETTINGS);
    let rows: Vec<_> = tables.iter().map(|table| table.rows.len()).collect();
    assert_eq!(rows, [1, 1, 1, 1, 3, 1 + FINER.len() + 2, 1 + LightKind::ALL.len()]);
    for table in &tables {
        let width = table.heading.len();
        assert!(table.rows.iter().all(|row| row.len() <= width), "{}", table.title);
        // The paper's columns are all there where a scene is of its size.
        // Of what nodes are worth, the paper tells for the first row only.
        let fullest = table.rows.iter().rev().nth(usize::from(table.title.starts_with("What")));
        assert!(fullest.is_some_and(|row| row.len() == width), "{}", table.title);
        assert!(!table.note.contains("  "), "{}", table.note);
    }
    let text: String = tables.iter().map(Table::markdown).collect();
    for theirs in ["(P: Outbound)", "| 394 | 374 | 5.3 | 147 | 29.2 | 0.96 | 0.44 |", "| 2.40 |"] {
        assert!(text.contains(theirs), "{theirs} in {text}");
    }
}

#[test]
fn work_is_counted_and_pools_are_found_empty_again() {
    let scene = scene();
    let of = |name| scene.column(name);
    assert!(scene.covered > 0.2 && scene.covered < 1.0, "{}", scene.covered);
    assert_eq!(of(Method::Packet).visits()[0], 0.0, "packets from the root search nothing");
    for name in [Method::EntryPoint, Method::Compressed, Method::SingleCompressed] {
        assert!(of(name).visits()[0] > 0.0, "{name:?}");
        assert!(of(name).visits()[1] < of(Method::Single).visits()[1], "{name:?}");
    }
    assert!(of(Method::Compressed).visits()[1] < of(Method::Packet).visits()[1]);
    assert!(of(Method::SingleCompressed).visits()[1] < of(Method::Single).visits()[1]);
    assert!(of(Method::Compressed).peaks.iter().all(|&bytes| bytes > 0));
    assert!(
        of(Method::Compressed).pool >= *of(Method::Compressed).peaks.iter().max().unwrap_or(&0)
    );
    assert_eq!((of(Method::EntryPoint).pool, of(Method::Packet).pool), (0, 0));
    let frame = Frame::new(&flight()[0], SETTINGS.resolution, ACROSS);
    let spec: AccelSpec = "bvh-path-compression".parse().expect("known");
    let accel = build(&spec, cloud(2000), Isa::Portable).expect("builds");
    let mut tracer = accel.tracer();
    for _ in 0..3 {
        frame.time(&mut *tracer);
        assert!(frame::take_pool_use(&mut *tracer).peak > 0);
        assert_eq!(frame::take_pool_use(&mut *tracer).peak, 0, "all regions were left");
    }
}

#[test]
fn json_and_plots_hold_every_structure() {
    let scenes = [scene()];
    let text = to_json(&scenes, &SETTINGS).to_string();
    let read: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let of_scene = &read["scenes"][0];
    assert_eq!(of_scene["columns"].as_array().map(Vec::len), Some(STRUCTURES.len()));
    assert_eq!(of_scene["lights"].as_array().map(Vec::len), Some(LightKind::ALL.len()));
    assert!(of_scene["lights"][0]["rays"].as_u64().is_some_and(|rays| rays > 0));
    let worth = &of_scene["worth"]["packets"]["node"];
    assert!(worth.is_null() || worth["share"].is_number(), "{worth}");
    assert_eq!(of_scene["columns"][0]["seconds"].as_array().map(Vec::len), Some(2));
    assert!(draw_plots(&scenes).iter().all(|(_, svg)| svg.contains("cloud: PC")));
}

#[test]
fn a_flight_is_thinned_out_evenly() {
    let flight = flight();
    let spread = |most| spread(&flight, most).iter().map(|pose| pose.eye.x).collect::<Vec<_>>();
    assert_eq!(spread(9).len(), 5);
    assert_eq!(spread(1), [26.0]);
    assert_eq!(spread(2), [23.0, 29.0]);
}

#[test]
fn an_empty_scene_is_measured_too_and_a_large_one_refused() {
    let scene = measure("empty", &cloud(0), &flight(), &SETTINGS, &|_| {}).expect("all agree");
    let tables = make_tables(&[scene], &SETTINGS);
    assert_eq!(tables.len(), 7);
    let text: String = tables.iter().map(Table::markdown).collect();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    let settings = FlyThroughBenchSettings { memory: 1000, ..SETTINGS };
    let error = measure("cloud", &cloud(100), &flight(), &settings, &|_| {}).expect_err("large");
    assert!(error.to_string().contains("more than the 1000"), "{error}");
}
