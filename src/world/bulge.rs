//! How far the surface that vertex normals tell lies before a triangle; see [`super::robust`].

use super::World;
use super::interpolation::Interpolation;
use super::prepared_material::BsdfClass;
use super::robust::ShadingNormals;
use super::surface::{Surface, normal_and_area, triangle_point};
use crate::geom::Triangle;
use crate::material::Facets;
use crate::math::{InstanceId, Vec2, Vec3};

impl World {
    /// The same with shading normals of another kind.
    #[must_use]
    pub fn with_shading_normals(mut self, kind: ShadingNormals) -> Self {
        self.robust = kind == ShadingNormals::Robust;
        self.faceted = kind == ShadingNormals::Microfacet;
        if self.faceted {
            // Scatterings on facets are followed one by one, from now on.
            self.materials.iter_mut().for_each(|prepared| prepared.class = BsdfClass::Other);
        }
        self
    }

    /// Whether shading normals are [`ShadingNormals::Robust`].
    #[inline]
    pub fn has_robust_normals(&self) -> bool {
        self.robust
    }

    /// The facets that a surface stands for, if shading normals are [`ShadingNormals::Microfacet`];
    /// `None` where it is flat.
    #[inline]
    pub fn facets(&self, surface: &Surface) -> Option<Facets> {
        self.faceted.then(|| Facets::new(surface.normal, &surface.frame)).flatten()
    }

    /// How far in front of a triangle, metres, the surface lies that the normals of its vertices
    /// tell; zero where it lies behind or where they tell nothing. `front` tells which side is
    /// meant: it is that of the triangle's geometric normal.
    #[inline(never)]
    pub fn bulge(
        &self,
        (id, index): (InstanceId, usize),
        barycentrics: Vec2,
        time: f32,
        front: bool,
    ) -> f32 {
        let instance = &self.scene.instances[id.index()];
        let posed = self.scene.mesh_at(instance.mesh, time);
        if !posed.has_normals() {
            return 0.0;
        }
        let transform = &self.scene.transform_at(id, time);
        let Vec2 { x: u, y: v } = barycentrics;
        let point = Interpolation::new(posed.mesh, index, transform.mirrored(), u, v);
        let [a, b, c] = point.corners.map(|i| transform.point(posed.position(i)));
        let triangle = Triangle { a, b, c };
        let (position, _) = triangle_point(&triangle, u, v, self.slack);
        let (geometric, _) = normal_and_area(&triangle);
        let side = if front { 1.0 } else { -1.0 };
        // The mean of the point's projections to the planes of the vertices that it is behind.
        let above = |(corner, i): (Vec3, usize)| {
            let normal = transform.normal(posed.normal(i)).normalize_or(geometric);
            let upright = normal.dot(geometric);
            let facing = if upright < 0.0 { -side } else { side };
            let behind = (corner - position).dot(normal) * facing;
            behind.max(0.0) * upright.abs()
        };
        let [i, j, k] = point.corners;
        let bulge = above((a, i)) * (1.0 - u - v) + above((b, j)) * u + above((c, k)) * v;
        if bulge.is_finite() { bulge.max(0.0) } else { 0.0 }
    }
}
