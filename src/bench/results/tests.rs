//! What the benches write is what is read, and what others write breaks nothing.

use serde_json::{Value, json};

use super::cells::{Kind, Part, read_cells};
use super::compare::{By, compare};
use super::files::{Bench, read_about};
use super::member::Member;
use super::short_run::plan;
use super::tables::make_tables;
use crate::bench::fly_through::{self, FlyThroughBenchSettings};
use crate::bench::kd::{self, KdBenchSettings};
use crate::bench::mbvh::{self, MbvhBenchSettings};
use crate::bench::renders;
use crate::bench::structures::{self, AccelsBenchSettings};
use crate::bench::test_scene::cloud;
use crate::camera::flight::Pose;
use crate::math::Vec3;
use crate::simd::Isa;

const ALL: Part = Part { place: 0, stride: 1, same_rays: true };
const MEMORY: u64 = u64::MAX;
const ISA: Isa = Isa::Portable;

/// What each bench writes of a small scene, called as one that can be made.
fn written(bench: Bench) -> Value {
    let (source, build) = (cloud(300), "binned");
    let mut file = match bench {
        Bench::Mbvh => {
            let (rays, rounds, refine) = (300, 1, false);
            let settings =
                MbvhBenchSettings { rays, rounds, build, refine, memory: MEMORY, isa: ISA };
            let scene = mbvh::measure("city", &source, true, &settings, &|_| {});
            mbvh::to_json(&[scene.expect("all agree")], &settings)
        }
        Bench::Coherent => {
            let (resolution, frames, rounds) = ((32, 32), 3, 1);
            let (memory, isa) = (MEMORY, ISA);
            let settings =
                FlyThroughBenchSettings { resolution, frames, rounds, build, memory, isa };
            let eye = Vec3::new(20.0, 18.0, -40.0);
            let flight = [Pose::new(eye, Vec3::new(18.0, 15.0, 25.0), 50.0); 3];
            let scene = fly_through::measure("city", &source, &flight, &settings, &|_| {});
            fly_through::to_json(&[scene.expect("all agree")], &settings)
        }
        Bench::Kd => {
            let settings = KdBenchSettings { rays: 100, memory: MEMORY, isa: ISA };
            let walks = kd::measure_walks(&source, &settings).expect("all agree");
            let walks: Vec<_> = walks.iter().map(kd::Row::json).collect();
            json!({ "scene": "city", "triangles": 300, "rays": 100, "walks": walks })
        }
        Bench::Render => {
            let row = |spec: &str, seconds| {
                let spec = spec.to_owned();
                renders::Row { spec, build_seconds: 0.1, seconds }
            };
            let rows = vec![row("bvh2", 2.0), row("mbvh4", 1.0)];
            let (name, triangles, rays) = ("city".to_owned(), 300, 5000);
            let scene = renders::Scene { name, triangles, rays, rows };
            json!({ "resolution": "40x30", "spp": 2, "threads": 1, "scenes": [scene.json()] })
        }
        Bench::Accels => {
            let (rays, rounds, wanted) = (100, 1, super::cells::is_quick as fn(&str) -> bool);
            let settings = AccelsBenchSettings { rays, rounds, wanted, memory: MEMORY, isa: ISA };
            let rows = structures::measure(&source, None, &settings, &|_| {}).expect("all agree");
            structures::to_json(&rows, "city", 300)
        }
    };
    file["measured"] = json!({ "processor": "CPU 9", "commit": null });
    file
}

#[test]
fn what_benches_write_is_read_and_agrees_with_itself() {
    for bench in Bench::ALL {
        let file = written(bench);
        let root = Member::root(&file);
        let about = read_about(bench, &root).expect("is well formed");
        assert_eq!(about.scenes, [("city".to_owned(), 300)], "{bench}");
        let run = plan(bench, &root).expect("is well formed").expect("can be made");
        assert_eq!((run.place, run.same_rays), (0, true), "{bench}");
        let cells = read_cells(bench, &root, Part::of_file(&run)).expect("is well formed");
        let rates = cells.iter().filter(|cell| cell.kind == Kind::Rate).count();
        let found = compare(&cells, &cells, By::Rates);
        assert!(found.explain(1.0).is_empty(), "{bench}");
        assert_eq!((found.pairs.len(), found.equal), (rates, cells.len() - rates), "{bench}");
        assert!(rates >= 2 && found.equal >= 1, "{bench}");
        for (name, table) in make_tables(bench, &root).expect("is well formed") {
            let columns: Vec<_> = table.lines().map(|line| line.matches('|').count()).collect();
            assert!(columns.len() >= 3, "{name}: {table}");
            assert!(columns.iter().all(|count| *count == columns[0]), "{name}: {table}");
        }
    }
}

#[test]
fn the_papers_figures_stand_beside_scenes_of_their_size() {
    let of = |bench, triangles: u64| {
        let mut file = written(bench);
        file["scenes"][0]["triangles"] = triangles.into();
        let tables = make_tables(bench, &Member::root(&file)).expect("is well formed");
        tables.into_iter().map(|(_, table)| table).collect::<String>()
    };
    let text = of(Bench::Mbvh, 334_080);
    for theirs in [" / 18.4 |", " / 286 |", " / 2.52 |", " / 3.00 |", " / 98.3 |", "P: Mirror"] {
        assert!(text.contains(theirs), "{theirs} in {text}");
    }
    let text = of(Bench::Coherent, 644_000);
    for theirs in [" / 394 |", " / 29.2 |", " / 8.30 |", " / 1.88 |", " / 2.35 |", " / 2.40 |"] {
        assert!(text.contains(theirs), "{theirs} in {text}");
    }
    assert!(of(Bench::Render, 4_304_391).contains("| 2.0 | 2.00 / 2.28 |"));
}

/// Puts a value in place of each member in turn, at any depth.
fn spoil(file: &Value, with: &Value, judge: &mut dyn FnMut(&Value)) {
    fn ways(value: &Value, way: &str, all: &mut Vec<String>) {
        let children: Vec<(String, &Value)> = match value {
            Value::Object(members) => members.iter().map(|(k, v)| (k.clone(), v)).collect(),
            Value::Array(items) => {
                items.iter().enumerate().map(|(i, v)| (i.to_string(), v)).take(2).collect()
            }
            _ => Vec::new(),
        };
        for (key, child) in children {
            let way = format!("{way}/{key}");
            ways(child, &way, all);
            all.push(way);
        }
    }
    let mut all = Vec::new();
    ways(file, "", &mut all);
    for way in all {
        let mut spoilt = file.clone();
        if let Some(place) = spoilt.pointer_mut(&way) {
            *place = with.clone();
            judge(&spoilt);
        }
    }
}

#[test]
fn a_spoilt_file_is_refused_or_read_but_breaks_nothing() {
    for bench in Bench::ALL {
        let file = written(bench);
        for with in [json!(null), json!(-1), json!([]), json!("x"), json!({}), json!(u64::MAX)] {
            let mut refused = 0;
            spoil(&file, &with, &mut |file| {
                let root = Member::root(file);
                let about = read_about(bench, &root).err();
                let planned = plan(bench, &root).err();
                let cells = read_cells(bench, &root, ALL).err();
                let tables = make_tables(bench, &root).err();
                let error = about.or(planned).or(cells).or(tables);
                refused += usize::from(error.is_some_and(|error| !error.to_string().is_empty()));
            });
            // Files hold more than is read, so that not every member is missed.
            assert!(refused > 0, "{bench}: {with}");
        }
    }
}
