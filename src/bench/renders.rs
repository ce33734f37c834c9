//! Whole renders per structure: figure 1 of M. Ernst and G. Greiner, "Multi bounding volume
//! hierarchies", 2008.
//!
//! What renders is the caller's: here pictures are compared and times taken by turns.

use serde_json::{Value, json};

use super::mbvh::paper;
use super::measure::{BenchError, time_interleaved};
use super::table::{Table, cell};
use crate::film::Picture;

/// A render, as the caller made it.
pub struct Rendered {
    /// All layers but those that differ from run to run.
    pub picture: Picture,
    /// Rays that were shot.
    pub rays: u64,
    /// Without loading and building.
    pub seconds: f64,
}

/// A structure's row.
#[derive(Clone, Debug)]
pub struct Row {
    /// Id and options.
    pub spec: String,
    /// To build it.
    pub build_seconds: f64,
    /// To render: the median of the rounds.
    pub seconds: f64,
}

/// A scene rendered by all structures.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What tables call it.
    pub name: String,
    /// Its triangles.
    pub triangles: usize,
    /// Rays of a render.
    pub rays: u64,
    /// By structure; speed-ups are over the first.
    pub rows: Vec<Row>,
}

/// How often a pixel differs.
fn count_differences(a: &Picture, b: &Picture) -> usize {
    let mut differs = vec![a.channels().len() != b.channels().len(); a.crop.area()];
    for (a, b) in a.channels().iter().zip(b.channels()) {
        for ((x, y), differs) in a.samples.iter().zip(&b.samples).zip(&mut differs) {
            *differs |= a.name != b.name || x.to_bits() != y.to_bits();
        }
    }
    differs.into_iter().filter(|&differs| differs).count()
}

/// Renders by every structure, given by spec and seconds to build, in turns.
///
/// # Errors
/// If a picture differs from the first in a bit.
pub fn measure(
    (name, triangles): (String, usize),
    structures: &[(String, f64)],
    rounds: usize,
    mut render: impl FnMut(usize) -> Rendered,
) -> Result<Scene, BenchError> {
    let (mut first, mut rays) = (None, 0);
    let seconds = time_interleaved(structures.len(), rounds, |which| {
        let rendered = render(which);
        let expected = first.get_or_insert_with(|| {
            rays = rendered.rays;
            rendered.picture.clone()
        });
        match count_differences(&rendered.picture, expected) {
            0 => Ok(rendered.seconds),
            pixels => Err(BenchError::Differs {
                spec: structures[which].0.clone(),
                first: structures[0].0.clone(),
                pixels,
                scene: name.clone(),
            }),
        }
    })?;
    let rows = structures.iter().zip(seconds).map(|((spec, build_seconds), seconds)| Row {
        spec: spec.clone(),
        build_seconds: *build_seconds,
        seconds,
    });
    Ok(Scene { rows: rows.collect(), name, triangles, rays })
}

/// The figure as a table.
pub fn make_table(scenes: &[Scene], how: &str) -> Table {
    let note = format!(
        "Seconds a render ({how}), the median of the rounds; S: speed-up over the first \
         structure. All pictures are equal to the bit. P: speed-up of the paper's MBVH over its \
         BVH in a scene of as many triangles; {}.",
        paper::MACHINE
    );
    let heading = ["", "build s", "render s", "Mrays/s", "S", "P S"];
    let mut table = Table::new("Figure 1: whole renders", note, &heading);
    for scene in scenes {
        let millions = scene.rays as f64 * 1e-6;
        let triangles = scene.triangles;
        let name = format!("{}, {triangles} triangles, {millions:.1} M rays", scene.name);
        table.rows.push(vec![name]);
        for row in &scene.rows {
            let theirs = paper::Scene::of(triangles).filter(|_| row.spec.starts_with("mbvh4"));
            table.rows.push(vec![
                format!("  {}", row.spec),
                cell(Some(row.build_seconds), 3),
                cell(Some(row.seconds), 3),
                cell(Some(millions / row.seconds.max(1e-9)), 3),
                cell(Some(scene.speed_up(row)), 2),
                cell(theirs.map(|paper| paper.render_speed_up), 2),
            ]);
        }
    }
    table
}

impl Scene {
    /// Over the first structure.
    pub fn speed_up(&self, row: &Row) -> f64 {
        self.rows[0].seconds / row.seconds.max(1e-9)
    }

    /// As an object.
    pub fn json(&self) -> Value {
        let rows = self.rows.iter().map(|row| {
            json!({
                "accel": row.spec,
                "build_s": row.build_seconds,
                "render_s": row.seconds,
                "mrays_s": self.rays as f64 * 1e-6 / row.seconds.max(1e-9),
                "speed_up": self.speed_up(row),
            })
        });
        json!({
            "name": self.name,
            "triangles": self.triangles,
            "rays": self.rays,
            "paper_speed_up": paper::Scene::of(self.triangles).map(|paper| paper.render_speed_up),
            "structures": rows.collect::<Vec<_>>(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;

    fn rendered(value: f32, seconds: f64) -> Rendered {
        let window = Window::of_size(2, 1);
        let mut picture = Picture::new(window, window);
        picture.set_channel("R", vec![1.0, value]);
        Rendered { picture, rays: 3_000_000, seconds }
    }

    fn structures() -> [(String, f64); 2] {
        ["bvh2", "mbvh4"].map(|id| (id.to_owned(), 0.5))
    }

    #[test]
    fn speed_ups_are_over_the_first_and_beside_the_papers() {
        let name = ("car".to_owned(), 4_304_391);
        let of = |which| rendered(2.0, [3.0, 1.0][which]);
        let scene = measure(name, &structures(), 3, of).expect("equal pictures");
        let text = make_table(std::slice::from_ref(&scene), "16 samples a pixel").markdown();
        assert!(text.contains("|   mbvh4 | 0.500 | 1.000 | 3.000 | 3.00 | 2.28 |"), "{text}");
        assert!(text.contains("|   bvh2 | 0.500 | 3.000 | 1.000 | 1.00 |  |"), "{text}");
        assert_eq!(scene.json()["structures"][1]["speed_up"], 3.0);
    }

    #[test]
    fn pictures_are_compared_to_the_bit() {
        let of = |which| rendered([0.0, -0.0][which], 1.0);
        let name = ("car".to_owned(), 1);
        let error = measure(name, &structures(), 1, of).expect_err("zeros of different sign");
        let expected = "car: mbvh4 and bvh2 render 1 pixels differently";
        assert_eq!(error.to_string(), expected);
    }
}
