//! The solids around paths, for many paths at once: each path is in air, or inside of the solid
//! whose border it has met and of no other.

use super::super::interior::Interior;
use super::super::state::Path;
use crate::material::lanes::transmittance;
use crate::math::{InstanceId, MaterialId};
use crate::simd::lanes::{Lanes, Mask, Rows, Vec3f};
use crate::world::World;
use crate::world::lanes::SurfaceLanes;

/// What the solids whose borders paths have met do to them.
#[derive(Default)]
pub(super) struct SolidRows {
    /// A bit for each lane whose surface bounds a solid; whose path is inside of it; whose solid
    /// absorbs light.
    solids: u32,
    inside: u32,
    absorbing: u32,
    /// How the latter absorb it, see [`World::absorption`].
    media: Rows,
}

impl SolidRows {
    /// Without solids.
    #[inline(always)]
    pub fn clear(&mut self) {
        (self.solids, self.inside, self.absorbing) = (0, 0, 0);
    }

    /// Fetches what a path has to do with the solid whose border it has met, if it is one.
    #[inline(always)]
    pub fn fetch(&mut self, lane: usize, world: &World, instance: InstanceId, path: &Path) {
        let material = world.scene.instances[instance.index()].material;
        self.solids |= u32::from(world.is_solid(material)) << lane;
        self.inside |= u32::from(!path.is_in_air()) << lane;
        if let Some(row) = world.absorption(material) {
            self.media[lane] = row;
            self.absorbing |= 1 << lane;
        }
    }

    /// The lanes whose surface bounds a solid.
    #[inline(always)]
    pub fn solids<L: Lanes>(&self, lanes: L) -> L::Mask {
        lanes.mask(self.solids)
    }

    /// Takes away what is absorbed along the segments; also tells whose segment lay inside. See
    /// `nested_dielectrics::absorb`.
    #[inline(always)]
    pub fn absorb<L: Lanes>(
        &self,
        lanes: L,
        surface: &SurfaceLanes<L>,
        throughput: Vec3f<L>,
    ) -> (Vec3f<L>, L::Mask) {
        // Who meets the back of a border without having entered has started inside.
        let inside = (lanes.mask(self.inside) | !surface.front) & self.solids(lanes);
        let absorbing = inside & lanes.mask(self.absorbing);
        if absorbing.to_bits() == 0 {
            return (throughput, inside);
        }
        let [r, g, b, scale] = lanes.columns(&self.media);
        let passes = transmittance(lanes, Vec3f::new(r, g, b), surface.t / scale);
        (Vec3f::select(absorbing, throughput * passes, throughput), inside)
    }
}

/// Puts a path inside of a solid that it is not in any other than, or out in the open.
#[inline(always)]
pub(super) fn place(path: &mut Path, inside: bool, material: impl FnOnce() -> MaterialId) {
    if inside == path.is_in_air() {
        path.interior = if inside { Interior::of(material()) } else { Interior::AIR };
    }
}
