//! Many lights: a tree from which one is sampled by its importance to a point.
//!
//! Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG
//! 2018, without the splitting: a walk from the root takes either child with the probability of its
//! importance, down to one light. The importance is the power of the lights below over the square
//! of the distance, times the cosines of the least angles that they may have to their own normals
//! and to the surface's. Trees are built by their surface area orientation heuristic.

use super::bounds::{LightBounds, LightSampleContext};
use crate::math::Aabb;

/// A tree over lights, which are told apart by their number.
#[derive(Debug)]
pub struct LightTree {
    /// Inner nodes are followed by their first child.
    nodes: Vec<Node>,
    /// By light: the turns on the way from the root, the first turn in the lowest bit.
    trails: Vec<Option<u64>>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    light: LightBounds,
    link: Link,
}

#[derive(Clone, Copy, Debug)]
enum Link {
    /// The number of the second child.
    Inner(u32),
    /// The number of the light.
    Leaf(u32),
}

/// Below this depth nodes are halved, so that no trail outgrows its bits.
const MAX_SPLIT_DEPTH: u32 = 32;
const BINS: usize = 12;

impl LightTree {
    /// A tree over all lights that have any power; `None` where there are none.
    pub fn new(lights: &[LightBounds]) -> Option<Self> {
        let mut order: Vec<u32> =
            (0..lights.len() as u32).filter(|&i| lights[i as usize].power > 0.0).collect();
        if order.is_empty() {
            return None;
        }
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * order.len() - 1),
            trails: vec![None; lights.len()],
        };
        tree.build(lights, &mut order, 0, 0);
        Some(tree)
    }

    /// The bounds of all its lights together.
    pub fn bounds(&self) -> LightBounds {
        self.nodes[0].light
    }

    fn build(&mut self, lights: &[LightBounds], order: &mut [u32], depth: u32, trail: u64) {
        let here = self.nodes.len();
        if let [light] = *order {
            self.nodes.push(Node { light: lights[light as usize], link: Link::Leaf(light) });
            self.trails[light as usize] = Some(trail);
            return;
        }
        let middle = if depth < MAX_SPLIT_DEPTH { split(lights, order) } else { order.len() / 2 };
        self.nodes.push(Node { light: lights[order[0] as usize], link: Link::Leaf(0) });
        let (first, second) = order.split_at_mut(middle);
        self.build(lights, first, depth + 1, trail);
        let link = self.nodes.len();
        self.build(lights, second, depth + 1, trail | 1 << depth);
        let light = self.nodes[here + 1].light.union(&self.nodes[link].light);
        self.nodes[here] = Node { light, link: Link::Inner(link as u32) };
    }

    /// Samples a light for a point by a uniform `u`. Returns its number and the probability of
    /// that; `None` where no light shines.
    pub fn sample(&self, context: &LightSampleContext, mut u: f32) -> Option<(usize, f32)> {
        let (mut at, mut probability) = (0, 1.0);
        loop {
            match self.nodes[at].link {
                Link::Leaf(light) => return Some((light as usize, probability)),
                Link::Inner(second) => {
                    let first = self.first_child_probability(at, second as usize, context)?;
                    if u < first {
                        (at, probability) = (at + 1, probability * first);
                        u /= first;
                    } else {
                        (at, probability) = (second as usize, probability * (1.0 - first));
                        u = (u - first) / (1.0 - first);
                    }
                    u = u.min(crate::sampling::ONE_MINUS_EPSILON);
                }
            }
        }
    }

    /// The probability with which [`LightTree::sample`] returns a light.
    pub fn probability(&self, context: &LightSampleContext, light: usize) -> f32 {
        let Some(mut trail) = self.trails[light] else { return 0.0 };
        let (mut at, mut probability) = (0, 1.0);
        while let Link::Inner(second) = self.nodes[at].link {
            let Some(first) = self.first_child_probability(at, second as usize, context) else {
                return 0.0;
            };
            if trail & 1 == 0 {
                (at, probability) = (at + 1, probability * first);
            } else {
                (at, probability) = (second as usize, probability * (1.0 - first));
            }
            trail >>= 1;
        }
        probability
    }

    /// The probability of an inner node's first child.
    fn first_child_probability(
        &self,
        at: usize,
        second: usize,
        context: &LightSampleContext,
    ) -> Option<f32> {
        let first = self.nodes[at + 1].light.importance(context);
        let sum = first + self.nodes[second].light.importance(context);
        (sum > 0.0).then(|| first / sum)
    }
}

/// Partitions `order` by the heuristic. Returns where the second part begins; both have at least
/// one light.
fn split(lights: &[LightBounds], order: &mut [u32]) -> usize {
    let centre = |light: u32| lights[light as usize].bounds.centre();
    let centres = Aabb::of_points(order.iter().map(|&light| centre(light)));
    let extent = centres.extent();
    let bin = |light: u32, axis: usize| {
        let place = (centre(light)[axis] - centres.min[axis]) / extent[axis];
        ((place * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let mut bins: [Option<LightBounds>; BINS] = [None; BINS];
        for &light in order.iter() {
            let bin = &mut bins[bin(light, axis)];
            *bin = join(*bin, Some(lights[light as usize]));
        }
        let long = extent.max_element() / extent[axis];
        for cut in 1..BINS {
            let all = |bins: &[Option<LightBounds>]| bins.iter().copied().fold(None, join);
            let (Some(low), Some(high)) = (all(&bins[..cut]), all(&bins[cut..])) else { continue };
            let cost = long * (low.cost() + high.cost());
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, cut));
            }
        }
    }
    let Some((_, axis, cut)) = best else { return order.len() / 2 };
    // Stable, so that equals keep their order.
    order.sort_by_key(|&light| bin(light, axis) >= cut);
    order.partition_point(|&light| bin(light, axis) < cut)
}

fn join(a: Option<LightBounds>, b: Option<LightBounds>) -> Option<LightBounds> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(&b)),
        (a, b) => a.or(b),
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use super::super::Sides;
    use super::*;
    use crate::math::Vec3;
    use crate::sampling::Sampler;
    use crate::sampling::chi_squared::assert_fits;
    use crate::sampling::warp;

    /// Small emitters all over, of all kinds.
    fn lights(count: u64) -> Vec<LightBounds> {
        (0..count)
            .map(|i| {
                let mut sampler = Sampler::independent(i, 0, 8);
                let place = sampler.next_2d().extend(sampler.next_1d()) * 10.0 - 5.0;
                let normal = warp::sphere(sampler.next_2d());
                let power = if i % 7 == 3 { 0.0 } else { 0.1 + sampler.next_1d() * 3.0 };
                match i % 4 {
                    0 => LightBounds::point(place, normal, PI, power),
                    1 => LightBounds::point(place, normal, 0.6, power),
                    side => {
                        let across = normal.any_orthonormal_vector() * 0.1;
                        let corners = [place, place + across, place + across.cross(normal)];
                        let sides = if side == 2 { Sides::Front } else { Sides::Both };
                        LightBounds::flat(corners, normal, sides, power)
                    }
                }
            })
            .collect()
    }

    fn contexts() -> Vec<LightSampleContext> {
        let normals = [Vec3::ZERO, Vec3::Y, Vec3::new(0.6, -0.8, 0.0)];
        let places = [Vec3::ZERO, Vec3::new(3.0, -4.9, 1.0), Vec3::splat(40.0)];
        let all = places.into_iter().flat_map(|position| {
            normals.into_iter().map(move |normal| LightSampleContext { position, normal })
        });
        all.collect()
    }

    #[test]
    fn probabilities_sum_to_one_and_are_those_of_the_samples() {
        let lights = lights(300);
        let tree = LightTree::new(&lights).expect("some shine");
        let mut some = 0;
        for (number, context) in contexts().iter().enumerate() {
            let of = |light| f64::from(tree.probability(context, light));
            let probabilities: Vec<f64> = (0..lights.len()).map(of).collect();
            let sum: f64 = probabilities.iter().sum();
            // A walk that comes to where nothing shines ends with nothing, which is rare but where
            // all lights are below the surface.
            assert!(sum <= 1.0 + 1e-4, "{number}: {sum}");
            assert!(sum > 0.9 || context.normal != Vec3::ZERO, "{number}: {sum}");
            some += u32::from(sum > 0.9);
            let (mut counts, draws) = (vec![0; lights.len() + 1], 30_000);
            for i in 0..draws {
                let u = Sampler::independent(i, number as u64, 5).next_1d();
                match tree.sample(context, u) {
                    Some((light, probability)) => {
                        assert!((f64::from(probability) / probabilities[light] - 1.0).abs() < 1e-5);
                        counts[light] += 1;
                    }
                    None => counts[lights.len()] += 1,
                }
            }
            let mut expected: Vec<f64> = probabilities.iter().map(|p| p * draws as f64).collect();
            expected.push((1.0 - sum).max(0.0) * draws as f64 + 1e-6);
            if sum > 0.01 {
                assert_fits(&counts, &expected, contexts().len(), &format!("context {number}"));
            } else {
                let chosen = draws - counts[lights.len()];
                assert!(chosen as f64 <= 0.02 * draws as f64, "{number}: {chosen} of {draws}");
            }
        }
        assert!(some >= 5, "{some} of 9 see lights");
    }

    /// Wherever light arrives from a light, it is chosen sometimes.
    #[test]
    fn what_shines_is_never_missed() {
        let lights = lights(300);
        let tree = LightTree::new(&lights).expect("some shine");
        let (mut seen, mut missed) = (0, Vec::new());
        for context in contexts() {
            for (number, light) in lights.iter().enumerate() {
                let towards = light.bounds.centre() - context.position;
                let way = towards.normalize();
                let above = context.normal == Vec3::ZERO || context.normal.dot(way) > 1e-3;
                let cos = light.normals.axis.dot(-way);
                let shines = light.normals.cos <= -1.0 || cos > light.cos_emission + 1e-3;
                if light.power > 0.0 && above && shines {
                    seen += 1;
                    if tree.probability(&context, number) <= 0.0 {
                        missed.push(number);
                    }
                }
            }
        }
        assert!(seen > 500 && missed.is_empty(), "{seen} {missed:?}");
    }

    #[test]
    fn near_lights_that_face_the_point_are_preferred() {
        let lamp = |x: f32, normal: Vec3| {
            let corners = [Vec3::X * x, Vec3::X * x + Vec3::Z * 0.1, Vec3::X * (x + 0.1)];
            LightBounds::flat(corners, normal, Sides::Front, 1.0)
        };
        let lights = [
            lamp(0.0, Vec3::NEG_Y),
            lamp(8.0, Vec3::NEG_Y),
            lamp(0.5, Vec3::Y),
            lamp(9.0, Vec3::Y),
        ];
        let tree = LightTree::new(&lights).expect("all shine");
        let context = LightSampleContext { position: Vec3::NEG_Y, normal: Vec3::Y };
        let all: Vec<f32> = (0..4).map(|light| tree.probability(&context, light)).collect();
        assert!(all[0] > 0.95 && all[2] < 0.01 && all[3] < 0.01, "{all:?}");
        assert!(LightTree::new(&[]).is_none());
        assert!(LightTree::new(&[LightBounds { power: 0.0, ..lights[0] }]).is_none());
    }

    /// Lights in one place cannot be told apart by any cut, and do not make the tree deep.
    #[test]
    fn equal_lights_are_halved() {
        let lamp = LightBounds::point(Vec3::ONE, Vec3::Y, PI, 1.0);
        let tree = LightTree::new(&vec![lamp; 1000]).expect("all shine");
        let context = LightSampleContext { position: Vec3::ZERO, normal: Vec3::ZERO };
        for light in [0, 1, 500, 999] {
            let probability = tree.probability(&context, light);
            assert!((1.0 / 1024.0..=1.0 / 512.0).contains(&probability), "{probability}");
        }
    }
}
