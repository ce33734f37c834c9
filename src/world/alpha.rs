//! Surfaces with holes: which hits count.

use super::World;
use super::lookup::alpha;
use crate::accel::{ClosestHit, HitFilter};
use crate::math::Vec2;
use crate::scene::AlphaMode;

/// Lets rays through where a surface is not there (glTF's alpha modes).
///
/// A blended surface is there with the probability of its alpha, decided by a hash of the ray's
/// key and the triangle: the same for every structure, and drawn anew for each ray.
#[derive(Clone, Copy, Debug)]
pub struct AlphaFilter<'a> {
    world: &'a World,
    keys: &'a [u64],
    times: Option<&'a [f32]>,
}

impl<'a> AlphaFilter<'a> {
    /// A filter for a batch whose ray `i` has the key `keys[i]`, which is to be different for
    /// every pixel, sample and bounce, and the time `times[i]`, where anything moves.
    pub fn new(world: &'a World, keys: &'a [u64], times: Option<&'a [f32]>) -> Self {
        Self { world, keys, times }
    }
}

impl HitFilter for AlphaFilter<'_> {
    fn accepts(&self, ray: usize, hit: &ClosestHit) -> bool {
        let world = self.world;
        let (instance, index) = (hit.triangle.instance, hit.triangle.index as usize);
        let material = world.scene.instances[instance.index()].material;
        if world.materials[material.index()].opaque {
            return true;
        }
        let time = self.times.map_or(0.0, |times| times[ray]);
        let (_, at) = world.texture_point((instance, index), Vec2::new(hit.u, hit.v), time);
        let alpha = alpha(&world.scene, world.material(material), &at);
        match world.material(material).alpha_mode {
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => alpha >= cutoff,
            AlphaMode::Blend => {
                uniform(self.keys[ray], world.triangles.number_of(hit.triangle)) < alpha
            }
        }
    }
}

/// A number in [0, 1) for a ray and a triangle's number (splitmix64's finaliser; Steele et al.
/// 2014).
fn uniform(key: u64, triangle: u64) -> f32 {
    let mut x = key ^ (triangle + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 40) as f32 * (1.0 / (1 << 24) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_uniform_over_keys_and_over_triangles() {
        let mean =
            |draw: &dyn Fn(u64) -> f32| (0..4096).map(|i| f64::from(draw(i))).sum::<f64>() / 4096.0;
        // Standard deviation of the mean: 1 / sqrt(12 * 4096) = 0.0045.
        assert!((mean(&|i| uniform(i, 3)) - 0.5).abs() < 0.018);
        assert!((mean(&|i| uniform(7, i)) - 0.5).abs() < 0.018);
    }
}
