//! Functions of a cosine that tables about layers hold, and how scattered light spreads over them.
//!
//! Columns lie evenly by the root of the cosine. Every fourth one is a column of
//! [`super::energy::Albedos`], so that what is linear between the columns there is so here.

use super::energy::{Albedos, cosine_average, locate_cell};
use crate::math::Vec3;

pub(super) const COLUMNS: usize = 4 * (Albedos::SIDE - 1) + 1;

/// A function of the cosine, linear between columns by the root of the cosine.
pub(super) type Curve = [f32; COLUMNS];

pub(super) fn column_cos(column: usize) -> f32 {
    let root = column as f32 / (COLUMNS - 1) as f32;
    root * root
}

/// A direction at a column. At the horizon itself limits are taken from close by.
pub(super) fn column_direction(column: usize) -> Vec3 {
    let cos = column_cos(column).max(1e-4);
    Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// The column at or below a cosine, and the position between it and the next.
#[inline]
pub(super) fn locate_column(cos: f32) -> (usize, f32) {
    locate_cell::<COLUMNS>(cos.max(0.0).sqrt() * (COLUMNS - 1) as f32)
}

/// The value at a cosine between two curves.
#[inline]
pub(super) fn look_up([below, above]: [&Curve; 2], t: f32, cos: f32) -> f32 {
    let (j, column_t) = locate_column(cos);
    let at = |curve: &Curve| curve[j] + (curve[j + 1] - curve[j]) * column_t;
    let (below, above) = (at(below), at(above));
    below + (above - below) * t
}

/// A curve and its average over the hemisphere.
#[derive(Debug)]
pub(super) struct Averaged {
    pub curve: Curve,
    pub average: f32,
}

impl Averaged {
    /// Of the value at each column.
    pub fn from_fn(value: impl Fn(usize) -> f32) -> Self {
        let curve = std::array::from_fn(value);
        let [average] = cosine_average::<COLUMNS, 1>(|column| [curve[column]]);
        Self { curve, average }
    }
}

/// How much of the light from the direction of each column is scattered to those of each column:
/// weights that integrate any [`Curve`] over what is scattered.
#[derive(Debug)]
pub(super) struct Spread(Vec<Curve>);

impl Spread {
    /// Without any light.
    pub fn new() -> Self {
        Self(vec![[0.0; COLUMNS]; COLUMNS])
    }

    /// Adds light from a column's direction that is scattered to a cosine.
    pub fn add(&mut self, from: usize, cos: f32, share: f32) {
        let (j, t) = locate_column(cos);
        self.0[from][j] += share * (1.0 - t);
        self.0[from][j + 1] += share * t;
    }

    /// The integral over what is scattered from a column's direction of a function of the column.
    pub fn integrate(&self, from: usize, value: impl Fn(usize) -> f32) -> f32 {
        let terms = self.0[from].iter().enumerate().map(|(column, weight)| weight * value(column));
        terms.sum()
    }
}
