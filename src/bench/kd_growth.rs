//! How a kd-tree's build grows with the scene: seconds over N log2 N.

use std::sync::Arc;

use serde_json::{Value, json};

use super::kd::{KdBenchSettings, build_tree, choices, estimate, options_with_build};
use super::measure::BenchError;
use super::plot::{Curve, draw_curves};
use super::table::{Table, cell};
use crate::accel::kd::build::OPTIONS;
use crate::geom::TriangleSource;

/// Triangles of the scenes.
pub const SIZES: [u64; 5] = [10_000, 31_623, 100_000, 316_228, 1_000_000];

/// Builds of one scene.
#[derive(Clone, Debug)]
pub struct Growth {
    /// Its triangles.
    pub triangles: usize,
    /// Names of builds and their seconds.
    pub seconds: Vec<(&'static str, f64)>,
}

impl Growth {
    /// Nanoseconds of a build over N log2 N.
    fn nanoseconds(&self, build: usize) -> f64 {
        let count = self.triangles.max(2) as f64;
        self.seconds[build].1 * 1e9 / (count * libm::log2(count))
    }
}

/// Those sizes whose trees fit the memory.
pub fn sizes(settings: &KdBenchSettings) -> impl Iterator<Item = u64> {
    let memory = settings.memory;
    SIZES.into_iter().filter(move |&size| estimate(size as usize) <= memory)
}

/// Builds a scene's trees, one after the other.
///
/// # Errors
/// If a tree would not fit.
pub fn measure(
    source: &Arc<dyn TriangleSource>,
    settings: &KdBenchSettings,
) -> Result<Growth, BenchError> {
    let seconds = choices(OPTIONS[0].values).iter().map(|&build| {
        let tree = build_tree(source, settings, &options_with_build(build))?;
        Ok((build, tree.report.seconds()))
    });
    Ok(Growth { triangles: source.len(), seconds: seconds.collect::<Result<_, BenchError>>()? })
}

/// As a table.
pub fn make_table(growth: &[Growth]) -> Table {
    let note = "Machines as `dapple generate assembly` makes them. The second figure of each build \
                is nanoseconds over N log2 N: constant where the build grows like that. \
                sah is both trees that it chooses from.";
    let mut table = Table::new("Builds as scenes grow", note, &["triangles"]);
    for build in choices(OPTIONS[0].values) {
        table.heading.extend([format!("{build} s"), format!("{build} ns")]);
    }
    table.rows = growth
        .iter()
        .map(|scene| {
            let figures = (0..scene.seconds.len()).flat_map(|build| {
                let (seconds, each) = (scene.seconds[build].1, scene.nanoseconds(build));
                [cell(Some(seconds), 3), cell(Some(each), 1)]
            });
            std::iter::once(scene.triangles.to_string()).chain(figures).collect()
        })
        .collect();
    table
}

/// As a plot: a level line is growth as N log N.
pub fn draw_plot(growth: &[Growth]) -> String {
    let curve = |(build, &name): (usize, &&str)| Curve {
        name: name.to_owned(),
        points: growth
            .iter()
            .map(|scene| (scene.triangles as f64, scene.nanoseconds(build)))
            .collect(),
    };
    let curves: Vec<_> = choices(OPTIONS[0].values).iter().enumerate().map(curve).collect();
    draw_curves("Time to build over N log2 N", "triangles, N", "ns", &curves)
}

/// As objects.
pub fn to_json(growth: &[Growth]) -> Value {
    let scene = |scene: &Growth| {
        let seconds: serde_json::Map<_, _> =
            scene.seconds.iter().map(|&(build, s)| (build.to_owned(), s.into())).collect();
        json!({ "triangles": scene.triangles, "seconds": seconds })
    };
    growth.iter().map(scene).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::TriangleList;
    use crate::simd::Isa;

    #[test]
    fn growth_as_n_log_n_is_a_level_line() {
        let scene = |triangles: usize| Growth {
            triangles,
            seconds: vec![("sah", triangles as f64 * libm::log2(triangles as f64) * 5e-9)],
        };
        for triangles in [1000, 1_000_000] {
            assert!((scene(triangles).nanoseconds(0) - 5.0).abs() < 1e-9);
        }
        assert_eq!(to_json(&[scene(1024)])[0]["triangles"], 1024);
    }

    #[test]
    fn every_build_has_its_columns_and_its_curve() {
        let settings = KdBenchSettings { rays: 1, memory: estimate(100_000), isa: Isa::Portable };
        let source: Arc<dyn TriangleSource> = Arc::new(TriangleList(Vec::new()));
        let growth = [measure(&source, &settings).expect("nothing fits anywhere")];
        assert_eq!(make_table(&growth).rows[0].len(), 7);
        let svg = draw_plot(&growth);
        assert!(["sah", "minmax", "binned"].iter().all(|build| svg.contains(build)), "{svg}");
        assert_eq!(sizes(&settings).collect::<Vec<_>>(), SIZES[..3]);
    }
}
