//! What lies on a material at a point of a surface: factors times textures, and the directions
//! that coats and brush strokes have there.

use super::shading_normal::{Shaped, smooth_normal, tangent};
use super::surface::Interpolation;
use super::world::look_up;
use super::{Surface, World};
use crate::accel::ClosestHit;
use crate::geom::Triangle;
use crate::material::{Bsdf, Layers, SurfaceParams};
use crate::math::{Frame, TextureId, Vec2, Vec3};
use crate::scene::{Material, MaterialLayers, TextureRef};

/// A coat's normal less above its base than this is taken for the base's.
const LEAST_COSINE: f32 = 0.05;

/// Whether the layers of `material` are the same at all of its points.
pub(super) fn is_constant(material: &Material, layers: &MaterialLayers) -> bool {
    let bent = material.normal_texture.is_some() || material.bump_texture.is_some();
    let textured = layers.clone().ranged_slots_mut().any(|(slot, _)| slot.is_some());
    !(textured || bent && layers.clearcoat > 0.0 || layers.anisotropy > 0.0)
}

/// The layers but for textures and directions.
pub(super) fn factors(layers: &MaterialLayers) -> Layers {
    Layers {
        clearcoat: layers.clearcoat,
        clearcoat_roughness: layers.clearcoat_roughness,
        sheen_color: layers.sheen_color,
        sheen_roughness: layers.sheen_roughness,
        anisotropy: layers.anisotropy,
        iridescence: layers.iridescence,
        iridescence_ior: layers.iridescence_ior,
        iridescence_thickness: layers.iridescence_thickness[1],
        ..Layers::NONE
    }
}

impl World {
    /// What a surface with layers scatters where `hit` has met it; `ior` is the inside's index over
    /// the outside's.
    #[inline(never)]
    pub(super) fn layered_bsdf(&self, surface: &Surface, hit: &ClosestHit, ior: f32) -> Bsdf {
        let params = self.surface_params(surface.material, &surface.attributes);
        let params = SurfaceParams { ior, ..params };
        let material = self.material(surface.material);
        let Some(described) = material.layers.as_deref() else {
            return Bsdf::new(&params, self.form);
        };
        let instance = &self.scene.instances[surface.instance.index()];
        let (mesh, transform) = (&*self.scene.meshes[instance.mesh.index()], &instance.transform);
        let point = Interpolation::new(mesh, surface.triangle, transform.mirrored, hit.u, hit.v);
        let [a, b, c] = point.corners.map(|i| transform.point(mesh.positions[i]));
        let at = Shaped {
            material,
            mesh,
            transform,
            triangle: &Triangle { a, b, c },
            point: &point,
            normal: surface.normal,
            uv: &surface.attributes.uv,
        };
        let mut layers = self.layers_at(described, &surface.attributes.uv);
        if layers.clearcoat > 0.0 {
            layers.clearcoat_normal = self.coat_normal(described, &at, &surface.frame);
        }
        if layers.anisotropy > 0.0 {
            self.brush(described, &at, &surface.frame, &mut layers);
        }
        Bsdf::layered(&params, &layers, self.form)
    }

    /// Factors times textures, but for directions.
    fn layers_at(&self, described: &MaterialLayers, uv: &[Vec2; 2]) -> Layers {
        let texel = |texture: &Option<TextureRef>| {
            texture.map(|texture| look_up(&self.scene, &texture, uv))
        };
        let mut layers = factors(described);
        if let Some(texel) = texel(&described.clearcoat_texture) {
            layers.clearcoat *= texel.x;
        }
        if let Some(texel) = texel(&described.clearcoat_roughness_texture) {
            layers.clearcoat_roughness *= texel.y;
        }
        if let Some(texel) = texel(&described.sheen_color_texture) {
            layers.sheen_color *= texel.truncate();
        }
        if let Some(texel) = texel(&described.sheen_roughness_texture) {
            layers.sheen_roughness *= texel.w;
        }
        if let Some(texel) = texel(&described.iridescence_texture) {
            layers.iridescence *= texel.x;
        }
        if let Some(texel) = texel(&described.iridescence_thickness_texture) {
            let [least, greatest] = described.iridescence_thickness;
            layers.iridescence_thickness = least + (greatest - least) * texel.y;
        }
        layers
    }

    /// The coat's normal in the base's frame. It does not follow the base's normal map.
    fn coat_normal(&self, described: &MaterialLayers, at: &Shaped<'_>, frame: &Frame) -> Vec3 {
        let mut normal = smooth_normal(at);
        if let Some(texture) = &described.clearcoat_normal_texture {
            normal = self.mapped_normal(at, texture, described.clearcoat_normal_scale, normal);
        }
        let local = frame.to_local(normal);
        if local.z < LEAST_COSINE { Vec3::Z } else { local }
    }

    /// The way in which the reflection is stretched, and how far.
    fn brush(
        &self,
        described: &MaterialLayers,
        at: &Shaped<'_>,
        frame: &Frame,
        layers: &mut Layers,
    ) {
        let mut way = Vec2::X;
        if let Some(texture) = &described.anisotropy_texture {
            let texel = look_up(&self.scene, texture, at.uv);
            layers.anisotropy *= texel.z;
            way = (texel.truncate().truncate() * 2.0 - 1.0).try_normalize().unwrap_or(way);
        }
        let Vec2 { x: cos, y: sin } = described.anisotropy_rotation;
        let way = Vec2::new(cos * way.x - sin * way.y, sin * way.x + cos * way.y);
        // Where no texture says so, the first set of coordinates leads.
        let texture = at.material.tangent_texture().or(described.anisotropy_texture);
        let texture = texture.unwrap_or(TextureRef::new(TextureId::from_index(0)));
        let (tangent, sign) = tangent(at, &texture, frame.normal).unwrap_or((frame.tangent, 1.0));
        let tangents = Frame::from_normal_tangent(frame.normal, tangent);
        let world = tangents.to_world(Vec3::new(way.x, way.y * sign, 0.0));
        let local = frame.to_local(world).truncate();
        layers.anisotropy_direction = local.try_normalize().unwrap_or(Vec2::X);
    }
}
