//! The light that is lost between a layer and what lies below it, and that comes back.
//!
//! Of light that goes from o to i by way of the base, a coat or cloth lets through the lesser of
//! what it lets through in either direction. So a base that reflects to where the layer lets less
//! through seems to lose light: what the layer really does is throw it back down, until it leaves
//! some other way. That share r of light from o comes back from all directions as
//! `r(o) r(i) / (π r_avg)`, as Kulla and Conty (2017) have it for light between microfacets.
//!
//! Tables hold r for white bases of three kinds, by the roughness of the layer, that of the base
//! and the root of the cosine. It is proportional to the layer's strength.

use std::f32::consts::{FRAC_1_PI, TAU};
use std::sync::LazyLock;

use super::base::BaseBsdf;
use super::clearcoat::Clearcoat;
use super::energy::{cosine_average, locate_cell};
use super::form::BsdfForm;
use super::params::{SurfaceParams, saturate};
use super::sheen::{MIN_ROUGHNESS, Sheen};
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;

/// Entries by the layer's roughness, by the base's and by the root of the cosine.
const LAYERS: usize = 17;
const BASES: usize = 9;
const COLUMNS: usize = 32;

/// A function of the cosine, and its average over the hemisphere.
#[derive(Clone, Copy, Debug, Default)]
struct Curve {
    cells: [f32; COLUMNS],
    average: f32,
}

impl Curve {
    fn new(cells: [f32; COLUMNS]) -> Self {
        let [average] = cosine_average::<COLUMNS, 1>(|column| [cells[column]]);
        Self { cells, average }
    }

    /// The sum of curves, weighted.
    fn add(&mut self, other: &Self, weight: f32) {
        for (sum, cell) in self.cells.iter_mut().zip(other.cells) {
            *sum += cell * weight;
        }
        self.average += other.average * weight;
    }

    fn at(&self, cos: f32) -> f32 {
        let (j, t) = locate_cell::<COLUMNS>(cos.max(0.0).sqrt() * (COLUMNS - 1) as f32);
        self.cells[j] + (self.cells[j + 1] - self.cells[j]) * t
    }
}

/// What a coat keeps back of light that comes straight, and of which cosine that of cloth is
/// taken.
const COAT_KEEPS: f32 = 0.04;
const TYPICAL_COSINE: f32 = 0.6;

/// White bases: diffuse, coated and metal.
const KINDS: [(f32, f32); 3] = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0)];

/// By kind, by the base's roughness, by the layer's roughness.
type Table = [[[Curve; LAYERS]; BASES]; KINDS.len()];

static UNDER_COAT: LazyLock<Box<Table>> = LazyLock::new(|| {
    let coat = |place: f32| Clearcoat::new(1.0, place, Vec3::Z, BsdfForm::Conserving);
    under(|place, cos| coat(place).albedo(towards(cos)))
});

static UNDER_CLOTH: LazyLock<Box<Table>> =
    LazyLock::new(|| under(|place, cos| white_cloth(place).albedo(towards(cos))));

/// What cloth itself scatters less than it keeps from what lies below.
static IN_CLOTH: LazyLock<[Curve; LAYERS]> = LazyLock::new(|| {
    std::array::from_fn(|layer| {
        let cloth = white_cloth(node(layer));
        Curve::new(std::array::from_fn(|column| {
            let wo = towards(column_cos(column));
            (cloth.albedo(wo) - scattered(&cloth, wo)).max(0.0)
        }))
    })
});

fn white_cloth(place: f32) -> Sheen {
    let roughness = MIN_ROUGHNESS + (1.0 - MIN_ROUGHNESS) * place * place;
    Sheen::new(Vec3::ONE, roughness, BsdfForm::Conserving)
}

/// The place of a roughness of cloth among the tables' rows, of which most are for smooth cloth.
fn cloth_place(roughness: f32) -> f32 {
    saturate((roughness - MIN_ROUGHNESS) / (1.0 - MIN_ROUGHNESS)).sqrt()
}

fn node(layer: usize) -> f32 {
    layer as f32 / (LAYERS - 1) as f32
}

/// At the horizon itself limits are taken from close by.
fn column_cos(column: usize) -> f32 {
    let root = column as f32 / (COLUMNS - 1) as f32;
    (root * root).max(1e-4)
}

fn towards(cos: f32) -> Vec3 {
    Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// The share of light that cloth scatters, by the midpoint rule over azimuth and the cosine's root.
fn scattered(cloth: &Sheen, wo: Vec3) -> f32 {
    const CAPS: usize = 96;
    const TURNS: usize = 32;
    let mut sum = 0.0_f64;
    for cap in 0..CAPS {
        let root = (cap as f32 + 0.5) / CAPS as f32;
        let (z, width) = (root * root, 2.0 * root / CAPS as f32);
        let ring = (1.0 - z * z).max(0.0).sqrt();
        for turn in 0..TURNS {
            // Half a turn will do, by symmetry.
            let way = warp::unit_circle((turn as f32 + 0.5) / (2 * TURNS) as f32) * ring;
            let value = cloth.eval(wo, Vec3::new(way.x, way.y, z)).x;
            sum += f64::from(value * width * TAU / TURNS as f32);
        }
    }
    sum as f32
}

/// Entries of a layer's albedo by the root of the cosine.
const FINE: usize = 65;

/// What white bases lose under a layer of strength one whose albedo is told by its place and the
/// cosine.
fn under(layer_albedo: impl Fn(f32, f32) -> f32) -> Box<Table> {
    let albedos: Vec<[f32; FINE]> = (0..LAYERS)
        .map(|layer| {
            std::array::from_fn(|fine| {
                let root = fine as f32 / (FINE - 1) as f32;
                layer_albedo(node(layer), root * root)
            })
        })
        .collect();
    let curves = |(metallic, specular): (f32, f32), base: usize| {
        let roughness = base as f32 / (BASES - 1) as f32;
        let white = SurfaceParams { metallic, roughness, specular, ..SurfaceParams::default() };
        let bsdf = BaseBsdf::new(&white, BsdfForm::Conserving);
        let columns: [[f32; LAYERS]; COLUMNS] =
            std::array::from_fn(|column| lost(&bsdf, towards(column_cos(column)), &albedos));
        std::array::from_fn(|layer| Curve::new(columns.map(|column| column[layer])))
    };
    Box::new(KINDS.map(|kind| std::array::from_fn(|base| curves(kind, base))))
}

/// The mean, over the light that a base scatters, of what each layer keeps back of it more than it
/// has kept of the viewer's.
fn lost(bsdf: &BaseBsdf, wo: Vec3, albedos: &[[f32; FINE]]) -> [f32; LAYERS] {
    const SIDE: usize = 24;
    const GOLDEN: f32 = 0.618_034;
    // Dense where directions meet the horizon, which is at the ends of both numbers.
    let ends = |k: usize| {
        let t = (k as f32 + 0.5) / SIDE as f32;
        (t * t * (3.0 - 2.0 * t), t * (1.0 - t))
    };
    let at = |albedos: &[f32; FINE], cos: f32| {
        let (j, t) = locate_cell::<FINE>(cos.max(0.0).sqrt() * (FINE - 1) as f32);
        albedos[j] + (albedos[j + 1] - albedos[j]) * t
    };
    let kept: [f32; LAYERS] = std::array::from_fn(|layer| at(&albedos[layer], wo.z));
    let (mut sums, mut whole) = ([0.0_f64; LAYERS], 0.0_f64);
    for point in 0..SIDE * SIDE {
        let ((x, wide), (y, high)) = (ends(point % SIDE), ends(point / SIDE));
        let u_lobe = (point as f32 * GOLDEN).fract();
        let Some(sample) = bsdf.sample(wo, u_lobe, Vec2::new(x, y)) else { continue };
        let weight = f64::from(sample.weight.x * wide * high);
        whole += weight;
        for (sum, (albedos, kept)) in sums.iter_mut().zip(albedos.iter().zip(kept)) {
            *sum += weight * f64::from((at(albedos, sample.wi.z) - kept).max(0.0));
        }
    }
    // The base is white, so that the whole is one but for the rule's error.
    sums.map(|sum| (sum / whole.max(1e-9)) as f32)
}

/// What comes back of the light that layers lose, on the outside of an opaque surface.
#[derive(Clone, Copy, Debug)]
pub struct Returned {
    /// Lost between layers and base, whose colour it takes.
    between: Curve,
    base_color: Vec3,
    /// Lost within cloth, likewise.
    in_cloth: Curve,
    cloth_color: Vec3,
}

impl Returned {
    /// That of a base of a colour, as `params` describe it, under a coat of some strength and
    /// roughness, and under cloth of some colour and roughness.
    pub fn new(
        params: &SurfaceParams,
        base_color: Vec3,
        coat: Option<(f32, f32)>,
        cloth: Option<(Vec3, f32)>,
    ) -> Self {
        let mut between = Curve::default();
        let mut in_cloth = Curve::default();
        let metallic = saturate(params.metallic);
        let specular = saturate(params.specular) * (1.0 - metallic);
        let kinds = [1.0 - metallic - specular, specular, metallic];
        let (base, base_t) = locate_cell::<BASES>(saturate(params.roughness) * (BASES - 1) as f32);
        let mut take = |table: &Table, place: f32, weight: f32| {
            let (layer, layer_t) = locate_cell::<LAYERS>(place * (LAYERS - 1) as f32);
            for (rows, kind) in table.iter().zip(kinds).filter(|(_, kind)| *kind > 0.0) {
                for (row, row_weight) in [(base, 1.0 - base_t), (base + 1, base_t)] {
                    let weight = weight * kind * row_weight;
                    between.add(&rows[row][layer], weight * (1.0 - layer_t));
                    between.add(&rows[row][layer + 1], weight * layer_t);
                }
            }
        };
        let mut cloth_color = Vec3::ZERO;
        // Under both, either has less to lose: about what the other lets through.
        let white_albedo = cloth.map_or(0.0, |(_, roughness)| {
            let white = Sheen::new(Vec3::ONE, roughness, BsdfForm::Conserving);
            white.albedo(towards(TYPICAL_COSINE))
        });
        let [coat_kept, cloth_kept] = [
            coat.map_or(0.0, |(strength, _)| strength * COAT_KEEPS),
            cloth.map_or(0.0, |(color, _)| color.max_element() * white_albedo),
        ];
        if let Some((strength, roughness)) = coat {
            take(&UNDER_COAT, saturate(roughness), strength * (1.0 - cloth_kept));
        }
        if let Some((color, roughness)) = cloth {
            let place = cloth_place(roughness);
            take(&UNDER_CLOTH, place, color.max_element() * (1.0 - coat_kept));
            let (layer, t) = locate_cell::<LAYERS>(place * (LAYERS - 1) as f32);
            in_cloth.add(&IN_CLOTH[layer], 1.0 - t);
            in_cloth.add(&IN_CLOTH[layer + 1], t);
            cloth_color = color;
        }
        // What cloth scatters meets the coat as what a diffuse base does.
        if let Some((strength, roughness)) = coat {
            let (layer, t) = locate_cell::<LAYERS>(saturate(roughness) * (LAYERS - 1) as f32);
            for (row, weight) in [(layer, 1.0 - t), (layer + 1, t)] {
                let below = &UNDER_COAT[0][BASES - 1][row];
                in_cloth.add(below, strength * white_albedo * weight);
            }
        }
        Self { between, base_color, in_cloth, cloth_color }
    }

    /// The share of light from a direction that comes back so, by colour.
    pub fn albedo(&self, cos: f32) -> Vec3 {
        self.base_color * self.between.at(cos) + self.cloth_color * self.in_cloth.at(cos)
    }

    /// What comes back, times the cosine, and its density: that of the cosine.
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let average =
            self.base_color * self.between.average + self.cloth_color * self.in_cloth.average;
        let shares = self.albedo(wo.z) * self.albedo(wi.z) / average.max(Vec3::splat(1e-9));
        let density = wi.z * FRAC_1_PI;
        (shares * density, density)
    }
}
