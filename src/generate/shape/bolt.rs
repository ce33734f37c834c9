//! Screws with hexagonal heads.

use super::{Plate, Profile, Revolve, Shape, Thread};
use crate::generate::tessellation::Tessellation;
use crate::math::{DVec2, DVec3};

/// A screw: its head above height 0, its thread below. Washer, dome and thread come with detail.
#[derive(Clone, Debug)]
pub struct Bolt {
    /// Of the thread.
    pub radius: f64,
    /// Of the thread.
    pub length: f64,
}

impl Bolt {
    /// What it consists of at a level, each piece with its height.
    fn pieces(&self, level: u32) -> Vec<(Box<dyn Shape>, f64)> {
        let r = self.radius;
        let head = Plate::solid(Profile::polygon(6, 1.85 * r, 0.0), 1.3 * r);
        let mut pieces: Vec<(Box<dyn Shape>, f64)> = vec![(Box::new(head), 0.25 * r)];
        if level >= 2 {
            pieces.push((Box::new(Revolve(Profile::ring(0.9 * r, 2.3 * r, 0.3 * r, 0.0))), 0.0));
        }
        if level >= 3 {
            let dome = [
                (DVec2::new(1.5 * r, 0.0), 0.0),
                (DVec2::new(1.35 * r, 0.22 * r), 0.1 * r),
                (DVec2::new(0.0, 0.26 * r), 0.0),
            ];
            pieces.push((Box::new(Revolve(Profile::open(&dome))), 1.55 * r));
        }
        if level >= 4 {
            let pitch = 0.45 * r;
            let most = (self.length / pitch) as usize;
            let turns = most.min(level as usize - 1).max(1);
            let pitch = self.length / (turns as f64 + 1.0);
            pieces.push((Box::new(Thread { radius: r, depth: 0.25 * r, pitch, turns }), 0.0));
        }
        pieces
    }

    /// Round pieces are small and do with few columns.
    fn level_of_pieces(level: u32) -> u32 {
        level / 2
    }
}

impl Shape for Bolt {
    fn count(&self, level: u32) -> u64 {
        let count = |(piece, _): (Box<dyn Shape>, f64)| piece.count(Self::level_of_pieces(level));
        self.pieces(level).into_iter().map(count).sum()
    }

    fn build(&self, level: u32) -> Tessellation {
        let mut made = Tessellation::default();
        for (piece, height) in self.pieces(level) {
            let piece = piece.build(Self::level_of_pieces(level));
            let first = made.vertices.len() as u32;
            for vertex in &piece.vertices {
                let position = DVec3::from(vertex.position.map(f64::from)) + DVec3::Y * height;
                let normal = DVec3::from(vertex.normal.map(f64::from));
                made.vertex(position, normal);
            }
            let moved = piece.indices.iter().map(|corners| corners.map(|i| first + i));
            made.indices.extend(moved);
        }
        made
    }

    fn extent(&self) -> f64 {
        self.length + 3.0 * self.radius
    }
}
