//! Tables of the light that white bases reflect to where layers let less through than they have let
//! in: below a coat, below cloth, and how much less it is below both than the sum.
//!
//! The share A that a layer keeps is linear between rows of its roughness, and falls with the
//! cosine. What is lost from o, the mean of `max(0, A(i) - A(o))` over what the base scatters, is
//! therefore linear between the same rows. It is an integral that the base's [`Spread`] gives for
//! any layer. Each of the lobes that a base is made of has an entry, so that cells hold for all
//! indices and for all that is metal in part.
//!
//! Cells are computed on first use, in a millisecond, and take 3 KB: a layer and a base without
//! textures of roughness need 4, a coat and cloth 16.

use std::sync::OnceLock;

use super::clearcoat::{COAT_ROWS, kept as kept_by_coat};
use super::energy::{
    Albedo, Albedos, Row, cosine_average, each_reflection, locate_cell, node_alpha,
};
use super::layer_columns::{Averaged, COLUMNS, Curve, Spread, column_cos, column_direction};
use super::sheen::Fibres;

/// Rows by the roughness of bases. Every second one is a row of [`Albedos`].
pub(super) const BASES: usize = 2 * (Albedos::SIDE - 1) + 1;
/// Rows by the roughness of either layer where both are there.
pub(super) const FEW: usize = 17;

/// The two rows of a table of `N` rows between which a place lies, and the weight of each.
pub(super) fn rows<const N: usize>(place: f32) -> [(usize, f32); 2] {
    let (row, t) = locate_cell::<N>(place);
    [(row, 1.0 - t), (row + 1, t)]
}

/// The two rows between which the roughness of a base lies, and the weight of each for what is
/// proportional to alpha where lobes are narrow.
pub(super) fn base_rows(alpha: f32) -> [(usize, f32); 2] {
    let [(row, _), (next, _)] = rows::<BASES>(2.0 * Row::of(alpha).place());
    let [first, last] = [row, next].map(|row| node_alpha(row, BASES));
    let t = ((alpha - first) / (last - first)).clamp(0.0, 1.0);
    [(row, 1.0 - t), (next, t)]
}

/// What is lost of light from a direction.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Losses {
    /// Of what the specular lobe reflects.
    pub lobe: Albedo,
    /// Of what follows the cosine.
    pub diffuse: f32,
    /// The share in that of what the specular lobe reflects on its way out.
    pub dimmed: Albedo,
}

impl Losses {
    /// Adds so much of others, of their specular lobe `lobe_weight`.
    #[inline]
    pub fn add(&mut self, other: &Self, weight: f32, lobe_weight: f32) {
        self.lobe.f0 += other.lobe.f0 * lobe_weight;
        self.lobe.f90 += other.lobe.f90 * lobe_weight;
        self.diffuse += other.diffuse * weight;
        self.dimmed.f0 += other.dimmed.f0 * weight;
        self.dimmed.f90 += other.dimmed.f90 * weight;
    }

    fn to_array(self) -> [f32; 5] {
        [self.lobe.f0, self.lobe.f90, self.diffuse, self.dimmed.f0, self.dimmed.f90]
    }

    fn from_slice(values: &[f32]) -> Self {
        let albedo = |k: usize| Albedo { f0: values[k], f90: values[k + 1] };
        Self { lobe: albedo(0), diffuse: values[2], dimmed: albedo(3) }
    }
}

/// What is lost below one layer or two of given roughness by a base of given roughness.
#[derive(Debug)]
pub(super) struct Cell {
    pub columns: [Losses; COLUMNS],
    /// The averages over the hemisphere of that, and of that times each factor of the specular
    /// lobe's albedo.
    pub averages: [Losses; 3],
}

/// The specular lobe of a white base: what of it is a factor of `f0` and of `f90`.
struct BaseSpread {
    f0: Spread,
    f90: Spread,
    /// The lobe's albedos.
    albedos: [Albedo; COLUMNS],
}

impl BaseSpread {
    fn of(row: usize) -> &'static Self {
        static SPREADS: [OnceLock<BaseSpread>; BASES] = [const { OnceLock::new() }; BASES];
        SPREADS[row].get_or_init(|| Self::new(node_alpha(row, BASES)))
    }

    fn new(alpha: f32) -> Self {
        let (mut f0, mut f90) = (Spread::new(), Spread::new());
        for column in 0..COLUMNS {
            each_reflection(alpha, column_direction(column), |cos, weight, albedo| {
                f0.add(column, cos, weight as f32 * albedo.f0);
                f90.add(column, cos, weight as f32 * albedo.f90);
            });
        }
        let row = Row::of(alpha);
        let albedos = std::array::from_fn(|column| Albedos::get().at(row, column_cos(column)));
        Self { f0, f90, albedos }
    }

    /// What is lost if so much is where light from one column's direction is scattered to another.
    fn losses(&self, lost: impl Fn(usize, usize) -> f32) -> [Losses; COLUMNS] {
        std::array::from_fn(|from| {
            let lost = |to| lost(from, to);
            let lobe =
                Albedo { f0: self.f0.integrate(from, lost), f90: self.f90.integrate(from, lost) };
            let [diffuse, f0, f90] = cosine_average::<COLUMNS, 3>(|to| {
                let (lost, albedo) = (lost(to), self.albedos[to]);
                [lost, lost * albedo.f0, lost * albedo.f90]
            });
            Losses { lobe, diffuse, dimmed: Albedo { f0, f90 } }
        })
    }

    fn cell(&self, lost: impl Fn(usize, usize) -> f32) -> Box<Cell> {
        let columns = self.losses(lost);
        let means = cosine_average::<COLUMNS, 15>(|column| {
            let (losses, albedo) = (columns[column].to_array(), self.albedos[column]);
            std::array::from_fn(|k| losses[k % 5] * [1.0, albedo.f0, albedo.f90][k / 5])
        });
        let averages = std::array::from_fn(|k| Losses::from_slice(&means[5 * k..]));
        Box::new(Cell { columns, averages })
    }
}

/// How much more a layer keeps of light from each column's direction than of that from another.
fn excess(kept: &Curve) -> impl Fn(usize, usize) -> f32 + use<'_> {
    |from, to| (kept[to] - kept[from]).max(0.0)
}

/// Below a coat: by the row of the coat and that of the base.
pub(super) fn under_coat(layer: usize, base: usize) -> &'static Cell {
    static CELLS: [[OnceLock<Box<Cell>>; BASES]; COAT_ROWS] =
        [const { [const { OnceLock::new() }; BASES] }; COAT_ROWS];
    CELLS[layer][base].get_or_init(|| BaseSpread::of(base).cell(excess(kept_by_coat(layer))))
}

/// Below cloth: by the row of the fibres and that of the base.
pub(super) fn under_cloth(layer: usize, base: usize) -> &'static Cell {
    static CELLS: [[OnceLock<Box<Cell>>; BASES]; Fibres::ROWS] =
        [const { [const { OnceLock::new() }; BASES] }; Fibres::ROWS];
    CELLS[layer][base].get_or_init(|| BaseSpread::of(base).cell(excess(&Fibres::of(layer).kept)))
}

/// What a coat at one of [`FEW`] places keeps.
fn few_coats(node: usize) -> &'static Curve {
    kept_by_coat(node * (COAT_ROWS - 1) / (FEW - 1))
}

/// The cloth at one of [`FEW`] places.
fn few_cloths(node: usize) -> &'static Fibres {
    Fibres::of(node * (Fibres::ROWS - 1) / (FEW - 1))
}

/// How much less is lost below a coat and cloth than below each of them: by [`FEW`] places of the
/// coat, of cloth, and by the row of the base.
pub(super) fn under_both(coat: usize, cloth: usize, base: usize) -> &'static Cell {
    static CELLS: [[[OnceLock<Box<Cell>>; BASES]; FEW]; FEW] =
        [const { [const { [const { OnceLock::new() }; BASES] }; FEW] }; FEW];
    CELLS[coat][cloth][base].get_or_init(|| {
        let (coat, cloth) = (few_coats(coat), &few_cloths(cloth).kept);
        let (by_coat, by_cloth) = (excess(coat), excess(cloth));
        BaseSpread::of(base).cell(|from, to| {
            let (more, other) = (by_coat(from, to), by_cloth(from, to));
            more * cloth[from] + other * coat[from] + more * other
        })
    })
}

/// How much more is lost of what cloth scatters if a coat is above it: by [`FEW`] places of both.
pub(super) fn cloth_under_coat(coat: usize, cloth: usize) -> &'static Averaged {
    static CELLS: [[OnceLock<Box<Averaged>>; FEW]; FEW] =
        [const { [const { OnceLock::new() }; FEW] }; FEW];
    CELLS[coat][cloth].get_or_init(|| {
        let (kept, cloth) = (few_coats(coat), few_cloths(cloth));
        let lost = excess(kept);
        Box::new(Averaged::from_fn(|from| {
            let of_scattered = cloth.spread.integrate(from, |to| lost(from, to));
            of_scattered - kept[from] * cloth.lost.curve[from]
        }))
    })
}
