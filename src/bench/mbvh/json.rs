//! The figures as JSON.

use serde_json::{Value, json};

use super::figures::{Rates, Scene, Structure};
use super::measure::MbvhBenchSettings;
use super::paper;
use super::structures::INCOHERENT;
use crate::accel::Event;
use crate::bench::measure::hit_rate;

/// All figures, the paper's among them.
pub fn to_json(scenes: &[Scene], settings: &MbvhBenchSettings) -> Value {
    let caches = paper::CACHES.map(|(megabytes, hits, krays)| {
        let (hit_rate, rate) = (hits / 100.0, krays * 1e-3);
        json!({ "mb": megabytes, "hit_rate": hit_rate, "mrays_s": rate })
    });
    json!({
        "rays": settings.rays,
        "rounds": settings.rounds,
        "build": settings.build,
        "refine": settings.refine,
        "threads": 1,
        "scenes": scenes.iter().map(scene_json).collect::<Vec<_>>(),
        "paper": {
            "machine": paper::MACHINE,
            "scenes": paper::SCENES.iter().map(paper_json).collect::<Vec<_>>(),
            "caches": caches,
        },
    })
}

fn scene_json(scene: &Scene) -> Value {
    let caches = scene
        .caches
        .iter()
        .map(|cache| json!({ "mb": cache.megabytes, "closest": rates_json(&cache.closest) }));
    let structures = scene.structures.iter().map(|one| structure_json(scene, one));
    let incoherence = scene.incoherence.iter().map(|row| {
        let rates = INCOHERENT.iter().zip(&row.rates);
        let rates = rates.map(|(id, &rate)| ((*id).to_owned(), rate.into()));
        json!({ "i": row.factor, "mrays_s": rates.collect::<serde_json::Map<_, _>>() })
    });
    json!({
        "name": scene.name,
        "triangles": scene.triangles,
        "paper_scene": paper::Scene::of(scene.triangles).map(|paper| paper.name),
        "structures": structures.collect::<Vec<_>>(),
        "caches": caches.collect::<Vec<_>>(),
        "incoherence": incoherence.collect::<Vec<_>>(),
    })
}

fn structure_json(scene: &Scene, structure: &Structure) -> Value {
    let report = &structure.report;
    json!({
        "accel": structure.id,
        "triangles": structure.mode.name(),
        "tree_s": structure.tree_seconds(),
        "collapse_s": structure.collapse_seconds(),
        "layout_s": structure.layout_seconds(),
        "nodes": report.nodes,
        "leaves": report.leaves,
        "empty": structure.empty(),
        "mean_leaf": report.mean_leaf,
        "mean_depth": report.mean_depth,
        "max_depth": report.max_depth,
        "sah_cost": report.sah_cost,
        "bytes": structure.bytes,
        "bytes_over_bvh2": structure.bytes as f64 / scene.binary_of(structure).bytes.max(1) as f64,
        "closest": rates_json(&structure.closest),
        "shadow": rates_json(&structure.shadow),
    })
}

fn rates_json(rates: &Rates) -> Value {
    let mut object: serde_json::Map<String, Value> = Event::ALL
        .iter()
        .map(|&event| (event.name().to_owned(), rates.single.per_ray(event).into()))
        .collect();
    object.insert("hit_rate".to_owned(), hit_rate(&rates.single.counts).into());
    object.insert("single_mrays_s".to_owned(), rates.single.rate().into());
    object.insert("slices_mrays_s".to_owned(), rates.slices.rate().into());
    object.into()
}

fn paper_json(scene: &paper::Scene) -> Value {
    let built = |built: &paper::Built| {
        json!({
            "tree_s": built.tree_seconds,
            "collapse_s": built.collapse_seconds,
            "leaves": built.leaves * 1e3,
            "empty": built.empty.map(|thousands| thousands * 1e3),
            "mean_leaf": built.mean_leaf,
            "mean_depth": built.mean_depth,
            "bytes": built.megabytes * 1e6,
        })
    };
    let shot = |shot: &paper::Shot| {
        json!({
            "triangle_tests": shot.triangle_tests,
            "box_tests": shot.box_tests,
            "hit_rate": shot.hit_rate.map(|per_cent| per_cent / 100.0),
            "mrays_s": shot.krays * 1e-3,
        })
    };
    let of = |which: usize| {
        json!({
            "build": built(&scene.built[which]),
            "closest": shot(&scene.closest[which]),
            "shadow": shot(&scene.shadow[which]),
        })
    };
    json!({
        "name": scene.name,
        "triangles": scene.triangles,
        "bvh": of(0),
        "mbvh": of(1),
        "bytes_over_bvh": scene.memory_ratio(),
        "closest_speed_up": paper::speed_up(&scene.closest),
        "shadow_speed_up": paper::speed_up(&scene.shadow),
        "simulated_4_8_16": scene.simulated,
        "potential_4_8_16": scene.potential,
        "render_speed_up": scene.render_speed_up,
    })
}
