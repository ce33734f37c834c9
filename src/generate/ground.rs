//! Noise, and hills made of it.

use crate::math::DVec3;

/// A number in -1..1 for each point of a lattice, and smoothly between: value noise.
pub fn noise(seed: u64, x: f64, z: f64) -> f64 {
    let (i, j) = (x.floor(), z.floor());
    let (u, v) = (smooth(x - i), smooth(z - j));
    let at = |di: i64, dj: i64| lattice(seed, i as i64 + di, j as i64 + dj);
    let near = at(0, 0) + (at(1, 0) - at(0, 0)) * u;
    let far = at(0, 1) + (at(1, 1) - at(0, 1)) * u;
    near + (far - near) * v
}

/// Octaves of noise, each half as high and half as wide as the one before; in -2..2.
pub fn octaves(seed: u64, x: f64, z: f64, number: u64) -> f64 {
    let (mut sum, mut size, mut height) = (0.0, 1.0, 1.0);
    for octave in 0..number {
        sum += height * noise(seed.wrapping_add(octave), x * size, z * size);
        (size, height) = (2.0 * size, 0.5 * height);
    }
    sum
}

fn smooth(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn lattice(seed: u64, i: i64, j: i64) -> f64 {
    let mixed = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ seed.wrapping_mul(0x1656_67b1_9e37_79f9);
    let mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((mixed ^ (mixed >> 32)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A valley between hills, metres; the origin is in its middle.
#[derive(Clone, Copy, Debug)]
pub struct Ground {
    /// Another number, other hills.
    pub seed: u64,
    /// Half the side of the land.
    pub half: f64,
}

impl Ground {
    /// The height over the water.
    pub fn height(&self, x: f64, z: f64) -> f64 {
        let out = ((x * x + z * z).sqrt() / self.half).min(1.4);
        let hills = octaves(self.seed, x / 130.0 + 0.37, z / 130.0 + 0.61, 6);
        let ridges = 1.0 - octaves(self.seed ^ 0x63, x / 210.0, z / 210.0, 5).abs();
        -3.0 + 9.0 * out + hills * (2.5 + 26.0 * out * out) + ridges * 55.0 * out * out * out
    }

    /// A point on it.
    pub fn at(&self, x: f64, z: f64) -> DVec3 {
        DVec3::new(x, self.height(x, z), z)
    }

    /// Upwards from it, of unit length.
    pub fn normal(&self, x: f64, z: f64) -> DVec3 {
        const STEP: f64 = 0.5;
        let slope = |dx: f64, dz: f64| self.height(x + dx, z + dz) - self.height(x - dx, z - dz);
        DVec3::new(-slope(STEP, 0.0), 2.0 * STEP, -slope(0.0, STEP)).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_smooth_and_depends_on_its_seed() {
        for i in 0..1000 {
            let (x, z) = (f64::from(i) * 0.37 - 99.0, f64::from(i) * 0.11 - 7.0);
            let here = noise(5, x, z);
            assert!(here.abs() <= 1.0);
            assert!((noise(5, x + 1e-6, z) - here).abs() < 1e-5);
        }
        assert_ne!(noise(1, 0.5, 0.5), noise(2, 0.5, 0.5));
        assert_eq!(noise(3, 4.0, 9.0), lattice(3, 4, 9));
    }

    #[test]
    fn the_land_has_water_and_hills() {
        let ground = Ground { seed: 1, half: 300.0 };
        let heights: Vec<f64> = (0..2500)
            .map(|i| ground.height(f64::from(i % 50 * 12 - 300), f64::from(i / 50 * 12 - 300)))
            .collect();
        assert!(heights.iter().any(|h| *h < -0.5) && heights.iter().any(|h| *h > 40.0));
        assert!((ground.normal(10.0, 20.0).length() - 1.0).abs() < 1e-9);
    }
}
