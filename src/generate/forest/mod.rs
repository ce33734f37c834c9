//! A forest: few kinds of trees, bushes, grass, ferns, flowers and stones, placed as many times as
//! one likes around a glade and along a trail.
//!
//! `triangles` are those of all kinds and the ground, each once; `copies` are plants and stones.

mod foliage;
mod glb;
mod herbs;
mod kinds;
mod land;
mod piece;
mod skeleton;
mod spread;
mod stone;
#[cfg(test)]
mod tests;
mod trees;

use std::io::{self, BufWriter, Write};
use std::ops::RangeInclusive;

use self::glb::Plan;
pub use self::glb::WrittenForest;
use self::kinds::{Kind, kinds};
use self::land::{Land, trail};
use self::spread::{EYE, Stand, reach, spread};
use crate::camera::flight::{self, Pose};
use crate::math::DVec3;

/// How many unique triangles a forest may have.
pub const FOREST_TRIANGLES: RangeInclusive<u64> = 4000..=60_000_000;

/// How many copies.
pub const FOREST_COPIES: RangeInclusive<u64> = 1..=100_000_000;

/// Where the sun stands in a picture of it, degrees.
const SUN_ELEVATION: f64 = 29.0;
const SUN_AZIMUTH: f64 = 112.0;

/// Views along the camera's way.
const KEYS: usize = 96;

/// A forest by its parts.
#[derive(Debug)]
pub struct Forest {
    seed: u64,
    land: Land,
    kinds: Vec<Kind>,
    /// Of each kind where its copies stand.
    stands: Vec<Vec<Stand>>,
}

impl Forest {
    /// Plans a forest; the same arguments plan the same one.
    ///
    /// # Panics
    /// If the numbers are not within [`FOREST_TRIANGLES`] and [`FOREST_COPIES`].
    pub fn new(triangles: u64, copies: u64, seed: u64) -> Self {
        assert!(FOREST_TRIANGLES.contains(&triangles), "{triangles} triangles");
        assert!(FOREST_COPIES.contains(&copies), "{copies} copies");
        let (mut kinds, for_ground) = kinds(triangles);
        let land = Land::new(for_ground, reach(copies), seed);
        // What ground and stones leave goes to the first tree: leaves are of any number.
        let count = |kind: &Kind| -> u64 {
            if kind.is_exact() {
                return kind.triangles;
            }
            kind.build(seed).iter().map(|piece| piece.indices.len() as u64).sum()
        };
        let others: u64 = kinds[1..].iter().map(count).sum();
        kinds[0].triangles = triangles - others - land.triangles();
        let stands = spread(&kinds, copies, &land, seed);
        Self { seed, land, kinds, stands }
    }

    /// Writes it as .glb: exactly so many triangles, each mesh once.
    ///
    /// # Errors
    /// Those of `out`, and a file that would exceed the 4 GiB of the format.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<WrittenForest> {
        let mut out = BufWriter::with_capacity(1 << 20, out);
        let plan = Plan {
            seed: self.seed,
            land: &self.land,
            kinds: &self.kinds,
            stands: &self.stands,
            flight: &self.flight(),
        };
        let written = glb::write(&plan, &mut out)?;
        out.flush()?;
        Ok(written)
    }

    /// The camera's way: from the glade along the trail.
    pub fn flight(&self) -> Vec<Pose> {
        let over =
            |x: f64, z: f64, above: f64| DVec3::new(x, self.land.height(x, z) + above, z).as_vec3();
        let first = Pose::new(over(EYE.x, EYE.y, 1.45), over(trail(-14.0), -14.0, 3.4), 46.0);
        let key = |step: u32| {
            let z = 9.0 - 9.0 * f64::from(step);
            let ahead = z - 12.0;
            Pose::new(over(trail(z), z, 1.6), over(trail(ahead), ahead, 2.3), 50.0)
        };
        let keys: Vec<Pose> = std::iter::once(first).chain((0..6).map(key)).collect();
        flight::through(&keys, KEYS)
    }

    /// A TOML scene that places the file `name` under sun and sky.
    pub fn scene(name: &str) -> String {
        let name = toml::Value::from(name);
        format!(
            "# A forest under sun and sky.\n\
             [[place]]\nfile = {name}\n\n\
             [sky]\nturbidity = 3\nsun-elevation = {SUN_ELEVATION}\nsun-azimuth = {SUN_AZIMUTH}\n\
             ground-albedo = 0.15\n\n\
             [render]\nexposure = 0.9\n"
        )
    }
}
