//! Which light to ask: by its power alone, or by what it may send to the point that asks.

use crate::geom::Triangle;
use crate::light::{LightBounds, LightSampleContext, LightTree, PunctualKind, Sides};
use crate::math::{Vec2, Vec3};
use crate::names::choices;
use crate::sampling::{AliasTable, ONE_MINUS_EPSILON};
use crate::scene::Scene;

/// How a light is chosen among many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightSamplerKind {
    /// By power, wherever the light goes: an alias table.
    #[default]
    Power,
    /// By where a light is and where it shines: a [`LightTree`].
    Tree,
}

choices!(LightSamplerKind, "choice of lights", [Power => "power", Tree => "tree"]);

/// As many lights share one number: it has bits enough for the point on each.
const FEW: usize = 64;

/// Chooses lights by their running number.
#[derive(Debug)]
pub(super) struct LightSampler {
    /// Those that are not in the tree, by power.
    table: Option<AliasTable>,
    tree: Option<LightTree>,
    /// The probability with which the tree is asked.
    tree_share: f32,
}

impl LightSampler {
    /// A sampler of lights of these weights. By [`LightSamplerKind::Tree`], those that have a place
    /// are chosen by the tree, which is asked as often as their weights together say.
    pub fn new(
        mut weights: Vec<f64>,
        kind: LightSamplerKind,
        bounds: impl FnOnce() -> Vec<LightBounds>,
    ) -> Self {
        let mut tree = None;
        let mut tree_share = 0.0;
        if kind == LightSamplerKind::Tree {
            let bounds = bounds();
            tree = LightTree::new(&bounds);
            let all: f64 = weights.iter().sum();
            let mut near = 0.0;
            for (weight, bounds) in weights.iter_mut().zip(&bounds) {
                if bounds.power > 0.0 {
                    near += std::mem::take(weight);
                }
            }
            weights.truncate(weights.iter().rposition(|&w| w > 0.0).map_or(0, |last| last + 1));
            tree_share = if near < all { (near / all) as f32 } else { 1.0 };
        }
        Self { table: AliasTable::new(&weights).ok(), tree, tree_share }
    }

    /// Whether there is nothing to choose.
    pub fn is_empty(&self) -> bool {
        self.table.is_none() && self.tree.is_none()
    }

    /// Whether the choice depends on the point that asks.
    #[inline(always)]
    pub fn needs_context(&self) -> bool {
        self.tree.is_some()
    }

    /// A light and the probability with which it is chosen; `None`: none that shines there.
    #[inline]
    pub fn sample(&self, context: &LightSampleContext, u: f32) -> Option<(usize, f32)> {
        let Some(tree) = &self.tree else { return Some(self.table.as_ref()?.sample(u)) };
        if u < self.tree_share {
            let u = (u / self.tree_share).min(ONE_MINUS_EPSILON);
            let (light, probability) = tree.sample(context, u)?;
            return Some((light, probability * self.tree_share));
        }
        let rest = 1.0 - self.tree_share;
        let u = ((u - self.tree_share) / rest).min(ONE_MINUS_EPSILON);
        let (light, probability) = self.table.as_ref()?.sample(u);
        Some((light, probability * rest))
    }

    /// The same by the first of two numbers, if there are few lights: then that number's place in
    /// its share serves again. So light and point on it are stratified together.
    #[inline(always)]
    pub fn sample_and_reuse(
        &self,
        context: &LightSampleContext,
        u_light: f32,
        u: Vec2,
    ) -> Option<(usize, f32, Vec2)> {
        match (&self.tree, &self.table) {
            (None, Some(table)) if table.len() <= FEW => {
                let (light, pmf, rest) = table.sample_and_reuse(u.x);
                Some((light, pmf, Vec2::new(rest, u.y)))
            }
            _ => self.sample(context, u_light).map(|(light, pmf)| (light, pmf, u)),
        }
    }

    /// The probability with which a light that is nowhere in particular is chosen.
    #[inline]
    pub fn far_probability(&self, light: usize) -> f32 {
        self.table.as_ref().map_or(0.0, |table| table.pmf(light)) * (1.0 - self.tree_share)
    }

    /// The probability with which a light that is somewhere is chosen for a point. One that moves
    /// is nowhere in particular: the tree does not know it.
    #[inline]
    pub fn near_probability(&self, context: &LightSampleContext, light: usize) -> f32 {
        match (&self.tree, &self.table) {
            (Some(tree), _) => {
                let near = tree.probability(context, light) * self.tree_share;
                near + self.far_probability(light)
            }
            (None, Some(table)) => table.pmf(light),
            (None, None) => 0.0,
        }
    }
}

/// The most power of a light that the tree is told of: sums of many are within the range of f32.
const MOST: f32 = 1e33;

/// What the tree has to know of punctual lights; of those infinitely far away, and of those that
/// move, it knows nothing.
pub(super) fn punctual_bounds(scene: &Scene, weights: &[f64]) -> Vec<LightBounds> {
    let lights = scene.lights.iter().zip(weights).enumerate();
    let bounds = lights.map(|(number, (light, &weight))| {
        if scene.light_moves(number) {
            return LightBounds::NOWHERE;
        }
        let of = |angle, power| LightBounds::point(light.position, light.direction, angle, power);
        match light.kind {
            PunctualKind::Point => of(std::f32::consts::PI, (weight as f32).min(MOST)),
            // By its intensity, as the others: within its cone it is as bright as they are.
            PunctualKind::Spot { inner, outer } => {
                let cosines = libm::cosf(inner) + libm::cosf(outer);
                of(outer, (weight as f32 * 2.0 / (1.0 - 0.5 * cosines).max(1e-4)).min(MOST))
            }
            PunctualKind::Directional => of(std::f32::consts::PI, 0.0),
        }
    });
    bounds.collect()
}

/// What the tree has to know of an emitting triangle.
pub(super) fn triangle_bounds(triangle: &Triangle, sides: Sides, weight: f64) -> LightBounds {
    let normal = triangle.double_area().try_normalize().unwrap_or(Vec3::ZERO);
    // A flat light sends π times less straight ahead than a point of the same power does around, by
    // 4π: 4 times more; from both sides, half of that each.
    let gain = if sides == Sides::Both { 2.0 } else { 4.0 };
    LightBounds::flat(triangle.corners(), normal, sides, weight as f32 * gain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Sampler;
    use crate::sampling::chi_squared::assert_fits;

    #[test]
    fn names_are_read_back() {
        for choice in LightSamplerKind::ALL {
            assert_eq!(choice.to_string().parse(), Ok(choice));
        }
        let error = "chance".parse::<LightSamplerKind>().unwrap_err();
        assert_eq!(error.to_string(), "no choice of lights `chance`; there are power and tree");
    }

    /// Two lights somewhere and one nowhere: whichever way, probabilities are those of the samples.
    #[test]
    fn near_and_far_share() {
        let lamp =
            |x: f32, power| LightBounds::point(Vec3::X * x, Vec3::Y, std::f32::consts::PI, power);
        let bounds = || vec![lamp(1.0, 1.0), lamp(0.0, 0.0), lamp(3.0, 1.0)];
        let context = LightSampleContext { position: Vec3::ZERO, normal: Vec3::ZERO };
        for (choice, expected) in [
            (LightSamplerKind::Power, [0.25, 0.5, 0.25]),
            (LightSamplerKind::Tree, [0.45, 0.5, 0.05]),
        ] {
            let sampler = LightSampler::new(vec![1.0, 2.0, 1.0], choice, bounds);
            let mut counts = [0.0_f64; 3];
            for i in 0..1000 {
                let u = (i as f32 + 0.5) / 1000.0;
                let (light, probability) = sampler.sample(&context, u).expect("all shine");
                let told = match light {
                    1 => sampler.far_probability(1),
                    near => sampler.near_probability(&context, near),
                };
                assert!((probability - told).abs() < 1e-6);
                counts[light] += 1e-3;
            }
            for light in 0..3 {
                assert!((counts[light] - expected[light]).abs() < 0.003, "{choice} {counts:?}");
            }
        }
    }

    /// Many lights, two of them nowhere: chi-squared of how often each is chosen.
    #[test]
    fn lights_are_chosen_as_often_as_they_say() {
        const LIGHTS: usize = 40;
        const COUNT: u64 = 50_000;
        let power = |light: usize| ((light * 7) % 13 + 1) as f32;
        let far = |light: usize| light % 17 == 5;
        let bounds = || {
            let lamp = |light: usize| {
                let power = if far(light) { 0.0 } else { power(light) };
                let at = Vec3::new(light as f32, (light % 5) as f32, -2.0);
                LightBounds::point(at, Vec3::Y, std::f32::consts::PI, power)
            };
            (0..LIGHTS).map(lamp).collect()
        };
        let context =
            LightSampleContext { position: Vec3::new(9.0, 0.0, 1.0), normal: Vec3::NEG_Z };
        for choice in LightSamplerKind::ALL {
            let weights = (0..LIGHTS).map(|light| f64::from(power(light))).collect();
            let sampler = LightSampler::new(weights, choice, bounds);
            let mut counts = [0; LIGHTS];
            for i in 0..COUNT {
                let u = Sampler::independent(i, 0, 5).next_1d();
                counts[sampler.sample(&context, u).expect("all shine").0] += 1;
            }
            let chance = |light: usize| {
                if far(light) {
                    sampler.far_probability(light)
                } else {
                    sampler.near_probability(&context, light)
                }
            };
            let expected: Vec<f64> =
                (0..LIGHTS).map(|light| f64::from(chance(light)) * COUNT as f64).collect();
            assert_fits(&counts, &expected, LightSamplerKind::ALL.len(), choice.name());
        }
    }
}
