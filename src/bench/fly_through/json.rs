//! The figures as JSON.

use serde_json::{Map, Value, json};

use super::bench::FlyThroughBenchSettings;
use super::figures::{Column, Light, Scene};
use super::structures::{LIGHT_STRUCTURES, STRUCTURES};
use super::{node_worth, paper};
use crate::accel::Event;

/// All figures, the paper's among them.
pub fn to_json(scenes: &[Scene], settings: &FlyThroughBenchSettings) -> Value {
    json!({
        "resolution": [settings.resolution.0, settings.resolution.1],
        "frames": settings.frames,
        "rounds": settings.rounds,
        "build": settings.build,
        "threads": 1,
        "scenes": scenes.iter().map(scene_json).collect::<Vec<_>>(),
        "paper": {
            "machine": paper::MACHINE,
            "scenes": paper::SCENES.iter().map(paper_json).collect::<Vec<_>>(),
        },
    })
}

fn scene_json(scene: &Scene) -> Value {
    let columns = STRUCTURES.iter().zip(&scene.columns).map(|(&(name, id, options), column)| {
        let mut object = column_json(column, scene.rate(column));
        object.insert("name".to_owned(), format!("{name:?}").into());
        object.insert("accel".to_owned(), id.into());
        object.insert("options".to_owned(), options.into());
        Value::from(object)
    });
    let tilings = scene.tilings.iter().map(|(tiling, column)| {
        let mut object = column_json(column, scene.rate(column));
        object.insert("tiles".to_owned(), tiling.name().into());
        Value::from(object)
    });
    let [nodes, bytes] = scene.bytes;
    let [entry, compressed] = scene.visit_ratios();
    let [mean, most, pool] = scene.pool_shares();
    json!({
        "name": scene.name,
        "triangles": scene.triangles,
        "paper_scene": paper::Scene::of(scene.triangles).map(|paper| paper.name),
        "rays": scene.rays,
        "covered": scene.covered,
        "node_bytes": nodes,
        "bytes": bytes,
        "visit_ratios": { "entry_point": entry, "compressed": compressed },
        "pool_percent": { "mean": mean, "max": most, "pool": pool },
        "worth": node_worth::to_json(scene),
        "iterative_s": scene.compressing[0],
        "recursive_s": scene.compressing[1],
        "columns": columns.collect::<Vec<_>>(),
        "tilings": tilings.collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(light_json).collect::<Vec<_>>(),
    })
}

fn column_json(column: &Column, rate: f64) -> Map<String, Value> {
    let mut object: Map<String, Value> = Event::ALL
        .iter()
        .map(|&event| (event.name().to_owned(), column.counts[event].into()))
        .collect();
    object.insert("seconds".to_owned(), column.seconds.clone().into());
    object.insert("pool_peaks".to_owned(), column.peaks.clone().into());
    object.insert("pool".to_owned(), column.pool.into());
    object.insert("mrays_s".to_owned(), rate.into());
    object
}

fn light_json(light: &Light) -> Value {
    let columns = LIGHT_STRUCTURES.iter().zip(&light.columns);
    let columns = columns.map(|(&(name, ..), column)| {
        let object = column_json(column, light.rate(column));
        (name.to_owned(), Value::from(object))
    });
    json!({
        "light": light.kind.name(),
        "rays": light.rays,
        "columns": columns.collect::<Map<_, _>>(),
    })
}

fn paper_json(scene: &paper::Scene) -> Value {
    json!({
        "name": scene.name,
        "triangles": scene.triangles,
        "kilo_visits": scene.visits,
        "kilo_searched": scene.searched,
        "visit_ratios": scene.ratios,
        "mrays_s": scene.rates,
        "speed_ups": scene.speed_ups,
        "bytes": scene.megabytes * 1e6,
        "pool_percent": scene.pool,
        "partition_mrays_s": scene.partition,
        "partition_speed_up": scene.partition_speed_up,
    })
}
