//! Outlines pushed along +Y: gears, nuts, beams, fins.

use super::Shape;
use super::detail::columns;
use super::profile::Profile;
use crate::generate::tessellation::Tessellation;
use crate::math::{DVec2, DVec3};

/// What is cut out of a plate.
#[derive(Clone, Copy, Debug)]
pub enum Bore {
    /// Nothing.
    None,
    /// A round hole of this radius.
    Round(f64),
    /// The outline again, smaller by this factor.
    Same(f64),
}

/// An outline about the Y axis, pushed from height 0 to `height`. All of the outline must be seen
/// from the axis.
#[derive(Clone, Debug)]
pub struct Plate {
    /// Closed and counter-clockwise.
    pub outline: Profile,
    /// What is cut out.
    pub bore: Bore,
    /// Its thickness.
    pub height: f64,
    /// Radians by which the upper side is turned.
    pub twist: f64,
}

impl Plate {
    /// A plate without a hole.
    pub fn solid(outline: Profile, height: f64) -> Self {
        Self { outline, bore: Bore::None, height, twist: 0.0 }
    }

    /// A gear of `number` teeth up to `radius`; `twist` makes it a helical one.
    pub fn gear(number: usize, radius: f64, bore: f64, height: f64, twist: f64) -> Self {
        let root = radius * (1.0 - 4.4 / (number as f64 + 2.0));
        let outline = Profile::teeth(number, root, radius);
        Self { outline, bore: Bore::Round(bore), height, twist }
    }

    /// A hollow beam of a rounded rectangle.
    pub fn beam(half: DVec2, fillet: f64, length: f64) -> Self {
        let outline = Profile::rectangle(half, fillet);
        Self { outline, bore: Bore::Same(0.86), height: length, twist: 0.0 }
    }

    /// Smooth stretches of the outline, and rows along the height.
    fn parts(&self, level: u32) -> (Vec<super::profile::Run>, usize) {
        let (columns, straight) = columns(level);
        let rows = if self.twist == 0.0 { straight } else { 1 + level as usize / 6 };
        // Coarse outlines have sharp corners: gears have many of them.
        (self.outline.runs(columns / 18, 1 + level as usize / 60), rows)
    }

    fn turned(&self, point: DVec2, share: f64) -> DVec3 {
        let (sin, cos) = libm::sincos(self.twist * share);
        let point = DVec2::new(cos, sin).rotate(point);
        DVec3::new(point.y, self.height * share, point.x)
    }

    /// A wall above a row of points and normals.
    fn wall(&self, made: &mut Tessellation, run: &[(DVec2, DVec2)], rows: usize, inwards: bool) {
        let made_rows: Vec<Vec<u32>> = (0..=rows)
            .map(|row| {
                let share = row as f64 / rows as f64;
                let level = DVec3::Y * (self.height * share);
                let corner = |&(point, normal): &(DVec2, DVec2)| {
                    made.vertex(self.turned(point, share), self.turned(normal, share) - level)
                };
                run.iter().map(corner).collect()
            })
            .collect();
        for pair in made_rows.windows(2) {
            if inwards {
                made.band(&pair[1], &pair[0], false);
            } else {
                made.band(&pair[0], &pair[1], false);
            }
        }
    }

    /// The hole's point below or beside a point of the outline.
    fn inner(&self, point: DVec2) -> Option<DVec2> {
        match self.bore {
            Bore::None => None,
            Bore::Round(radius) => Some(point.normalize_or_zero() * radius),
            Bore::Same(scale) => Some(point * scale),
        }
    }

    fn face(&self, made: &mut Tessellation, outline: &[DVec2], top: bool) {
        let (share, normal) = if top { (1.0, DVec3::Y) } else { (0.0, DVec3::NEG_Y) };
        let place = |made: &mut Tessellation, point| made.vertex(self.turned(point, share), normal);
        let outer: Vec<u32> = outline.iter().map(|&point| place(made, point)).collect();
        let inner: Option<Vec<DVec2>> = outline.iter().map(|&point| self.inner(point)).collect();
        let Some(inner) = inner else {
            let middle = place(made, DVec2::ZERO);
            made.fan(middle, &outer, top);
            return;
        };
        let inner: Vec<u32> = inner.into_iter().map(|point| place(made, point)).collect();
        if top {
            made.band(&outer, &inner, true);
        } else {
            made.band(&inner, &outer, true);
        }
    }
}

impl Shape for Plate {
    fn count(&self, level: u32) -> u64 {
        let (runs, rows) = self.parts(level);
        let points: usize = runs.iter().map(|run| run.len() - 1).sum();
        let around = if matches!(self.bore, Bore::None) { 2 + 2 * rows } else { 4 + 4 * rows };
        (points * around) as u64
    }

    fn build(&self, level: u32) -> Tessellation {
        let (runs, rows) = self.parts(level);
        let mut made = Tessellation::default();
        for run in &runs {
            self.wall(&mut made, run, rows, false);
            let hole: Option<Vec<_>> = run
                .iter()
                .map(|&(point, normal)| {
                    let inner = self.inner(point)?;
                    let round = matches!(self.bore, Bore::Round(_));
                    Some((inner, if round { -inner } else { -normal }))
                })
                .collect();
            if let Some(hole) = hole {
                self.wall(&mut made, &hole, rows, true);
            }
        }
        // Each run ends where the next one begins.
        let outline: Vec<DVec2> = runs
            .iter()
            .flat_map(|run| run[..run.len() - 1].iter().map(|&(point, _)| point))
            .collect();
        self.face(&mut made, &outline, false);
        self.face(&mut made, &outline, true);
        made
    }

    fn extent(&self) -> f64 {
        let across = 2.0 * self.outline.reach();
        (across * across + self.height * self.height).sqrt()
    }
}
