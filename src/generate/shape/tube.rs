//! Pipes, hoses, cables and springs.

use super::Shape;
use super::detail::{arc, circle, columns};
use super::path::{Path, Station};
use crate::generate::tessellation::Tessellation;

/// A round section along a curve, with flat ends.
#[derive(Clone, Debug)]
pub struct Tube {
    /// Its middle.
    pub path: Path,
    /// Of the section.
    pub radius: f64,
    /// Corrugations from end to end, of a spline; 0: smooth.
    pub ripples: usize,
}

/// Depth of a corrugation, as a share of the radius.
const RIPPLE: f64 = 0.18;

impl Tube {
    /// Columns, ripples that are modelled, and stations.
    fn stations(&self, level: u32) -> (usize, usize, Vec<Station>) {
        let (columns, straight) = columns(level / 2);
        let ripples = self.ripples.min(2 * level as usize);
        let stations = if ripples > 0 {
            self.path.even_stations(ripples * (4 + level as usize / 16))
        } else {
            let arc = (arc(columns) * 2).max(2) + level as usize / 12;
            self.path.stations(arc, straight)
        };
        (columns, ripples, stations)
    }
}

impl Shape for Tube {
    fn count(&self, level: u32) -> u64 {
        let (columns, _, stations) = self.stations(level);
        (2 * columns * (stations.len() - 1) + 2 * (columns - 2)) as u64
    }

    fn build(&self, level: u32) -> Tessellation {
        let (columns, ripples, stations) = self.stations(level);
        let around = circle(columns);
        let mut made = Tessellation::default();
        let last = stations.len() - 1;
        let mut ring = |station: &Station, radius: f64, flat: f64| -> Vec<u32> {
            let side = station.along.cross(station.across);
            let corner = |&(sin, cos): &(f64, f64)| {
                let out = station.across * cos + side * sin;
                let normal = if flat == 0.0 { out } else { station.along * flat };
                made.vertex(station.at + out * radius, normal)
            };
            around.iter().map(corner).collect()
        };
        let radius = |i: usize| {
            let wave = libm::cos(std::f64::consts::TAU * (i * ripples) as f64 / last as f64);
            if ripples == 0 {
                self.radius
            } else {
                self.radius * (1.0 - RIPPLE * (0.5 + 0.5 * wave))
            }
        };
        let rings: Vec<_> =
            stations.iter().enumerate().map(|(i, station)| ring(station, radius(i), 0.0)).collect();
        let ends = [ring(&stations[0], radius(0), -1.0), ring(&stations[last], radius(last), 1.0)];
        for pair in rings.windows(2) {
            made.band(&pair[0], &pair[1], true);
        }
        for i in 1..columns - 1 {
            made.triangle([ends[0][0], ends[0][i + 1], ends[0][i]]);
            made.triangle([ends[1][0], ends[1][i], ends[1][i + 1]]);
        }
        made
    }

    fn extent(&self) -> f64 {
        self.path.extent() + 2.0 * self.radius
    }
}
