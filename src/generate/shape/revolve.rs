//! Round parts, as from a lathe.

use super::Shape;
use super::detail::{arc, circle, columns};
use super::profile::Profile;
use crate::generate::tessellation::Tessellation;
use crate::math::DVec3;

/// A profile of radii and heights, turned about +Y. Its ends may be on the axis.
#[derive(Clone, Debug)]
pub struct Revolve(pub Profile);

impl Shape for Revolve {
    fn count(&self, level: u32) -> u64 {
        let (columns, straight) = columns(level);
        let rows = self.0.runs(arc(columns), straight).into_iter().flat_map(|run| {
            let rows = run.windows(2).map(|row| 2 - row.iter().filter(|p| p.0.x == 0.0).count());
            rows.collect::<Vec<_>>()
        });
        rows.map(|triangles| (triangles * columns) as u64).sum()
    }

    fn build(&self, level: u32) -> Tessellation {
        let (columns, straight) = columns(level);
        let around = circle(columns);
        let mut made = Tessellation::default();
        for run in self.0.runs(arc(columns), straight) {
            let rows: Vec<Vec<u32>> = run
                .iter()
                .map(|&(point, normal)| {
                    let turn =
                        |&(sin, cos): &(f64, f64), r: f64, y: f64| DVec3::new(r * sin, y, r * cos);
                    if point.x == 0.0 {
                        let up = DVec3::Y * if normal.y < 0.0 { -1.0 } else { 1.0 };
                        return vec![made.vertex(DVec3::Y * point.y, up)];
                    }
                    let corner =
                        |at| made.vertex(turn(at, point.x, point.y), turn(at, normal.x, normal.y));
                    around.iter().map(corner).collect()
                })
                .collect();
            for pair in rows.windows(2) {
                match (&*pair[0], &*pair[1]) {
                    ([point], row) => made.fan(*point, row, false),
                    (row, [point]) => made.fan(*point, row, true),
                    (lower, upper) => made.band(lower, upper, true),
                }
            }
        }
        made
    }

    fn extent(&self) -> f64 {
        1.4 * self.0.reach()
    }
}
