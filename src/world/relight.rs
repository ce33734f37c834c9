//! Other lights for a world, whose shapes and materials stay.

use std::sync::Arc;

use super::{LightSamplerKind, Lights, World};
use crate::scene::Scene;

impl World {
    /// Changes what shines: `change` may replace the scene's environment and its lights without
    /// extent, and must leave all else as it is, so that structures of its triangles stay good.
    /// `kind` says how lights are chosen, as in [`World::with_lights`].
    ///
    /// The triangles go on with the scene as it was: the first change copies the list of placed
    /// meshes and the environment, but no mesh and no texture.
    pub fn relight(&mut self, kind: LightSamplerKind, change: impl FnOnce(&mut Scene)) {
        change(Arc::make_mut(&mut self.scene));
        self.lights = Lights::new(&self.scene, &self.triangles, self.radius, kind);
    }
}
