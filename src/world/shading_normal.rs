//! Shading normals: interpolated, then bent by normal and height maps.

use super::interpolation::{Attributes, Interpolation};
use super::lookup::look_up;
use crate::geom::{Posed, Triangle};
use crate::math::{Frame, Vec2, Vec3};
use crate::scene::{Material, Scene, TextureRef, Transform};

/// A point and all that its shading normal depends on.
pub(super) struct NormalContext<'a> {
    pub scene: &'a Scene,
    pub material: &'a Material,
    pub posed: &'a Posed<'a>,
    pub transform: &'a Transform,
    /// In world space, corners in the order of `point`.
    pub triangle: &'a Triangle,
    pub point: &'a Interpolation,
    /// The unit geometric normal.
    pub normal: Vec3,
    pub attributes: &'a Attributes,
}

/// The unit shading normal, on the side of the geometric one.
#[inline]
pub(super) fn shading_normal(at: &NormalContext<'_>) -> Vec3 {
    let smooth = smooth_normal(at);
    if let Some(texture) = &at.material.normal_texture {
        mapped_normal(at, texture, at.material.normal_scale, smooth)
    } else if let Some(texture) = &at.material.bump_texture {
        match uv_slopes(at, texture) {
            Some(slopes) => on_side_of(bumped_normal(at, texture, smooth, slopes), at.normal),
            None => smooth,
        }
    } else {
        smooth
    }
}

/// The normal that a tangent-space normal texture makes of `smooth`.
#[inline]
pub(super) fn mapped_normal(
    at: &NormalContext<'_>,
    texture: &TextureRef,
    scale: f32,
    smooth: Vec3,
) -> Vec3 {
    let Some((tangent, sign)) = tangent(at, texture, smooth) else { return smooth };
    let mut mapped = look_up(at.scene, texture, at.attributes).truncate() * 2.0 - 1.0;
    mapped.x *= scale;
    mapped.y *= scale * sign;
    let mapped = Frame::from_normal_tangent(smooth, tangent).to_world(mapped);
    on_side_of(mapped.normalize_or(smooth), at.normal)
}

/// The normal that a height map makes of `normal`: that of the surface displaced along it, for a
/// small displacement (Blinn 1978). Slopes are taken over half a texel; `along_u` and `along_v` are
/// the position's derivatives by the texture coordinates.
fn bumped_normal(
    at: &NormalContext<'_>,
    texture: &TextureRef,
    normal: Vec3,
    (along_u, along_v): (Vec3, Vec3),
) -> Vec3 {
    let map = &at.scene.textures[texture.texture.index()];
    let [width, height] = map.size();
    let step = Vec2::new(0.5 / width as f32, 0.5 / height as f32);
    let here = texture.transform(at.attributes.uv_set(at.scene, texture.uv_set).0);
    let scale = at.material.normal_scale;
    let height_at = |x: f32, y: f32| map.sample(here + Vec2::new(x, y)).x * scale;
    let by_u = (height_at(step.x, 0.0) - height_at(-step.x, 0.0)) / (2.0 * step.x);
    let by_v = (height_at(0.0, step.y) - height_at(0.0, -step.y)) / (2.0 * step.y);
    let displaced = (along_u + normal * by_u).cross(along_v + normal * by_v);
    on_side_of(displaced.normalize_or(normal), normal)
}

/// The interpolated normal, on the side of the geometric one.
#[inline]
pub(super) fn smooth_normal(at: &NormalContext<'_>) -> Vec3 {
    if !at.posed.has_normals() {
        return at.normal;
    }
    let interpolated = at.transform.normal(at.point.vec3(|i| at.posed.normal(i)));
    on_side_of(interpolated.normalize_or(at.normal), at.normal)
}

/// `normal`, or its mirror image by the surface, so that it is on the side of `geometric`.
#[inline]
fn on_side_of(normal: Vec3, geometric: Vec3) -> Vec3 {
    if normal.dot(geometric) < 0.0 { -normal } else { normal }
}

/// The tangent at a point and the sign of its bitangent; `None` where no texture coordinates lead.
/// Without tangents of its own a mesh gets them by triangle. Green points up in a texture whose v
/// counts down: against the derivative by v.
pub(super) fn tangent(
    at: &NormalContext<'_>,
    texture: &TextureRef,
    smooth: Vec3,
) -> Option<(Vec3, f32)> {
    if at.posed.mesh.tangents.is_empty() {
        let (along_u, along_v) = uv_slopes(at, texture)?;
        let sign = if smooth.dot(along_u.cross(along_v)) > 0.0 { -1.0 } else { 1.0 };
        return Some((along_u, sign));
    }
    let tangent = at.point.vec4(|i| at.posed.tangent(i));
    let sign = if at.transform.mirrored() { -tangent.w } else { tangent.w };
    Some((at.transform.to_world().transform_vector3(tangent.truncate()), sign))
}

/// Derivatives of the position by the texture coordinates of `texture`; `None` where they do not
/// exist.
fn uv_slopes(at: &NormalContext<'_>, texture: &TextureRef) -> Option<(Vec3, Vec3)> {
    let uvs = at.posed.mesh.uv_set(texture.uv_set as usize);
    if uvs.is_empty() {
        return None;
    }
    let [a, b, c] = at.point.corners.map(|i| texture.transform(uvs[i]));
    let (ab, ac) = (b - a, c - a);
    let determinant = ab.x * ac.y - ab.y * ac.x;
    let (edge_b, edge_c) = (at.triangle.b - at.triangle.a, at.triangle.c - at.triangle.a);
    let along_u = (edge_b * ac.y - edge_c * ab.y) / determinant;
    let along_v = (edge_c * ab.x - edge_b * ac.x) / determinant;
    (along_u.is_finite() && along_v.is_finite()).then_some((along_u, along_v))
}
