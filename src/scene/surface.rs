//! From a hit to the surface there: position with its error, normals, texture coordinates.

use super::world::look_up;
use super::{Material, TextureRef, World};
use crate::accel::ClosestHit;
use crate::geom::{Mesh, Triangle};
use crate::math::{DVec3, Frame, InstanceId, MaterialId, Ray, TriangleId, Vec2, Vec3, Vec4};

/// Bounds the relative error of seven roundings in a row: `n u / (1 - n u)` with n = 7 and
/// u = 2^-24 (Higham).
const GAMMA_7: f32 = 7.0 * HALF_ULP / (1.0 - 7.0 * HALF_ULP);
const HALF_ULP: f32 = 0.5 * f32::EPSILON;

/// The least cosine, at the shading normal, of a viewer who sees the surface edge-on.
const GRAZING: f32 = 1e-3;

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// Where it is, world space.
    pub position: Vec3,
    /// Componentwise bound of the position's error: the point of the true plane that is meant
    /// lies within.
    pub position_error: Vec3,
    /// Unit geometric normal; the triangle is counter-clockwise seen from where it points.
    pub normal: Vec3,
    /// The shading frame; its normal is on the side of the geometric one.
    pub frame: Frame,
    /// Both sets of texture coordinates; zero where the mesh has none or no texture asks.
    pub uv: [Vec2; 2],
    /// The placed mesh that it belongs to.
    pub instance: InstanceId,
    /// The triangle's number in the mesh.
    pub triangle: usize,
    /// The triangle's area, square metres.
    pub area: f32,
    /// What it is made of.
    pub material: MaterialId,
    /// Whether the ray arrived at the side that the geometric normal points to.
    pub front: bool,
}

impl Surface {
    /// The ray from here in a unit `direction`, as far as it goes; does not meet this surface.
    #[inline]
    pub fn ray_towards(&self, direction: Vec3) -> Ray {
        let origin = offset_origin(self.position, self.position_error, self.normal, direction);
        Ray::new(origin, direction, 0.0, f32::INFINITY)
    }
}

/// Corners and weights of a point in a mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interpolation {
    corners: [usize; 3],
    weights: [f32; 3],
}

impl Interpolation {
    /// The point of a hit. `u` and `v` belong to the triangle as the world sees it, which has its
    /// last two corners exchanged where the instance is mirrored.
    pub fn new(mesh: &Mesh, triangle: usize, mirrored: bool, u: f32, v: f32) -> Self {
        let [a, b, c] = mesh.indices[triangle].map(|i| i as usize);
        let corners = if mirrored { [a, c, b] } else { [a, b, c] };
        Self { corners, weights: [1.0 - u - v, u, v] }
    }

    fn vec2(&self, values: &[Vec2]) -> Vec2 {
        let [a, b, c] = self.corners.map(|i| values[i]);
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
    }

    fn vec3(&self, values: &[Vec3]) -> Vec3 {
        let [a, b, c] = self.corners.map(|i| values[i]);
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
    }

    fn vec4(&self, values: &[Vec4]) -> Vec4 {
        let [a, b, c] = self.corners.map(|i| values[i]);
        a * self.weights[0] + b * self.weights[1] + c * self.weights[2]
    }

    /// Texture coordinates of both sets, zero where there are none.
    pub fn uv(&self, mesh: &Mesh) -> [Vec2; 2] {
        [0, 1].map(|set: usize| {
            if mesh.uvs[set].is_empty() { Vec2::ZERO } else { self.vec2(&mesh.uvs[set]) }
        })
    }
}

impl World {
    /// The surface that `ray` has hit.
    pub fn surface(&self, ray: &Ray, hit: &ClosestHit) -> Surface {
        let (id, index) = self.triangles.locate(hit.triangle);
        let instance = &self.scene.instances[id.index()];
        let mesh = &*self.scene.meshes[instance.mesh.index()];
        let transform = &instance.transform;
        let point = Interpolation::new(mesh, index, transform.mirrored, hit.u, hit.v);

        let [a, b, c] = point.corners.map(|i| transform.point(mesh.positions[i]));
        let triangle = Triangle { a, b, c };
        let (position, position_error) = triangle_point(&triangle, hit.u, hit.v);
        let (normal, area) = normal_and_area(&triangle);

        let resolved = &self.materials[instance.material.index()];
        let uv = if resolved.textured { point.uv(mesh) } else { [Vec2::ZERO; 2] };
        let smooth = match mesh.normals.is_empty() {
            true => normal,
            false => {
                let smooth = transform.normal(point.vec3(&mesh.normals));
                on_side_of(smooth.normalize_or(normal), normal)
            }
        };
        let material = self.material(instance.material);
        let mut shading = smooth;
        if let Some(texture) = &material.normal_texture {
            let tangents = match mesh.tangents.is_empty() {
                true => tangents_of_uv(&triangle, &point, mesh, texture, smooth),
                false => {
                    let tangent = point.vec4(&mesh.tangents);
                    let sign = if transform.mirrored { -tangent.w } else { tangent.w };
                    let along = transform.to_world.transform_vector3(tangent.truncate());
                    Some((along, sign))
                }
            };
            if let Some((tangent, sign)) = tangents {
                shading = self.mapped_normal(material, texture, &uv, smooth, tangent, sign);
                shading = on_side_of(shading, normal);
            }
        } else if let Some(texture) = &material.bump_texture {
            let slopes = uv_slopes(&triangle, &point, mesh, texture);
            if let Some((along_u, along_v)) = slopes {
                shading = self.bumped_normal(material, texture, &uv, smooth, along_u, along_v);
                shading = on_side_of(shading, normal);
            }
        }

        let towards_viewer = -ray.direction();
        let front = normal.dot(towards_viewer) > 0.0;
        let shading = visible(shading, towards_viewer, front);
        Surface {
            position,
            position_error,
            normal,
            frame: Frame::from_normal(shading),
            uv,
            instance: id,
            triangle: index,
            area,
            material: instance.material,
            front,
        }
    }

    /// Texture coordinates and material of a point of a triangle.
    pub(super) fn texture_point(&self, id: TriangleId, u: f32, v: f32) -> (MaterialId, [Vec2; 2]) {
        let (instance, index) = self.triangles.locate(id);
        let instance = &self.scene.instances[instance.index()];
        if !self.materials[instance.material.index()].textured {
            return (instance.material, [Vec2::ZERO; 2]);
        }
        let mesh = &*self.scene.meshes[instance.mesh.index()];
        let point = Interpolation::new(mesh, index, instance.transform.mirrored, u, v);
        (instance.material, point.uv(mesh))
    }

    /// The normal that a tangent-space normal texture makes of `normal`.
    fn mapped_normal(
        &self,
        material: &Material,
        texture: &TextureRef,
        uv: &[Vec2; 2],
        normal: Vec3,
        tangent: Vec3,
        sign: f32,
    ) -> Vec3 {
        let mut mapped = look_up(&self.scene, texture, uv).truncate() * 2.0 - 1.0;
        mapped.x *= material.normal_scale;
        mapped.y *= material.normal_scale * sign;
        Frame::from_normal_tangent(normal, tangent).to_world(mapped).normalize_or(normal)
    }

    /// The normal that a height map makes of `normal`: that of the surface displaced along it,
    /// for a small displacement (Blinn 1978). Slopes are taken over half a texel.
    fn bumped_normal(
        &self,
        material: &Material,
        texture: &TextureRef,
        uv: &[Vec2; 2],
        normal: Vec3,
        along_u: Vec3,
        along_v: Vec3,
    ) -> Vec3 {
        let [width, height] = self.scene.textures[texture.texture.index()].size();
        let step = Vec2::new(0.5 / width as f32, 0.5 / height as f32);
        let here = texture.transform(uv[usize::from(texture.uv_set.min(1))]);
        let map = &self.scene.textures[texture.texture.index()];
        let at = |x: f32, y: f32| map.sample(here + Vec2::new(x, y)).x * material.normal_scale;
        let by_u = (at(step.x, 0.0) - at(-step.x, 0.0)) / (2.0 * step.x);
        let by_v = (at(0.0, step.y) - at(0.0, -step.y)) / (2.0 * step.y);
        let displaced = (along_u + normal * by_u).cross(along_v + normal * by_v);
        on_side_of(displaced.normalize_or(normal), normal)
    }
}

/// A point of a triangle in world space and the bound of its error (pbrt-v4, section 6.8).
///
/// The corners are taken as exact: structures intersect the very same rounded triangle, so that
/// what an instance's transform has rounded away is no error of the point against it.
#[inline]
pub(super) fn triangle_point(triangle: &Triangle, u: f32, v: f32) -> (Vec3, Vec3) {
    let (a, b, c) = (triangle.a * (1.0 - u - v), triangle.b * u, triangle.c * v);
    (a + b + c, (a.abs() + b.abs() + c.abs()) * GAMMA_7)
}

/// `point` moved off its surface to the side that `towards` points to, just so far that it lies
/// on that side of the true surface whatever the error within `error` is (pbrt-v4, 6.8.5).
#[inline]
pub(super) fn offset_origin(point: Vec3, error: Vec3, normal: Vec3, towards: Vec3) -> Vec3 {
    let distance = normal.abs().dot(error);
    let side = if towards.dot(normal) < 0.0 { -normal } else { normal };
    let moved = point + side * distance;
    // The sum's own rounding goes outwards too.
    let outward = |value: f32, way: f32| {
        if way > 0.0 {
            value.next_up()
        } else if way < 0.0 {
            value.next_down()
        } else {
            value
        }
    };
    Vec3::new(outward(moved.x, side.x), outward(moved.y, side.y), outward(moved.z, side.z))
}

/// The unit normal of a triangle's front, and its area.
#[inline]
fn normal_and_area(triangle: &Triangle) -> (Vec3, f32) {
    let double_area = triangle.double_area();
    let length2 = double_area.length_squared();
    if length2 > 1e-30 && length2 < 1e30 {
        let length = length2.sqrt();
        return (double_area / length, 0.5 * length);
    }
    // Tiny or huge: the squares need a wider range.
    let (a, b, c) = (triangle.a.as_dvec3(), triangle.b.as_dvec3(), triangle.c.as_dvec3());
    let double_area = (b - a).cross(c - a);
    let normal = double_area.normalize_or(DVec3::Z).as_vec3();
    (normal, (0.5 * double_area.length()) as f32)
}

/// `normal`, or its mirror image by the surface, so that it is on the side of `geometric`.
#[inline]
fn on_side_of(normal: Vec3, geometric: Vec3) -> Vec3 {
    if normal.dot(geometric) < 0.0 { -normal } else { normal }
}

/// A shading normal under which the viewer is on the side of the surface that he is on by the
/// geometric normal: one that turns away from him is bent just into his sight.
#[inline]
fn visible(shading: Vec3, towards_viewer: Vec3, front: bool) -> Vec3 {
    let seen = if front { towards_viewer } else { -towards_viewer };
    let cosine = shading.dot(seen);
    if cosine >= GRAZING {
        return shading;
    }
    let across = (shading - seen * (cosine / seen.length_squared())).normalize_or(shading);
    (across + seen * GRAZING).normalize()
}

/// Derivatives of the position by the texture coordinates of `texture`; `None` where they do not
/// exist.
fn uv_slopes(
    triangle: &Triangle,
    point: &Interpolation,
    mesh: &Mesh,
    texture: &TextureRef,
) -> Option<(Vec3, Vec3)> {
    let uvs = &mesh.uvs[usize::from(texture.uv_set.min(1))];
    if uvs.is_empty() {
        return None;
    }
    let [a, b, c] = point.corners.map(|i| texture.transform(uvs[i]));
    let (ab, ac) = (b - a, c - a);
    let determinant = ab.x * ac.y - ab.y * ac.x;
    let (edge_b, edge_c) = (triangle.b - triangle.a, triangle.c - triangle.a);
    let along_u = (edge_b * ac.y - edge_c * ab.y) / determinant;
    let along_v = (edge_c * ab.x - edge_b * ac.x) / determinant;
    (along_u.is_finite() && along_v.is_finite()).then_some((along_u, along_v))
}

/// The tangent of a triangle without tangents, and the sign of its bitangent. Green points up in
/// a texture whose v counts down: against the derivative by v.
fn tangents_of_uv(
    triangle: &Triangle,
    point: &Interpolation,
    mesh: &Mesh,
    texture: &TextureRef,
    normal: Vec3,
) -> Option<(Vec3, f32)> {
    let (along_u, along_v) = uv_slopes(triangle, point, mesh, texture)?;
    let sign = if normal.dot(along_u.cross(along_v)) > 0.0 { -1.0 } else { 1.0 };
    Some((along_u, sign))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offset_origins_lie_beyond_the_error() {
        let point = Vec3::new(1000.0, -3.0, 1e-3);
        let error = point.abs() * GAMMA_7;
        for normal in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, 2.0, -2.0) / 3.0] {
            for way in [normal, -normal] {
                let moved = offset_origin(point, error, normal, way);
                let beyond = (moved - point).as_dvec3().dot(way.as_dvec3());
                assert!(beyond >= f64::from(normal.abs().dot(error)), "{normal} {beyond}");
            }
        }
    }

    #[test]
    fn normals_of_triangles_of_any_size() {
        for scale in [1e-18, 1e-4, 1.0, 1e4, 1e15] {
            let corners = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p * scale);
            let [a, b, c] = corners;
            let (normal, area) = normal_and_area(&Triangle { a, b, c });
            assert_eq!(normal, Vec3::Z);
            assert!((area / (0.5 * scale * scale) - 1.0).abs() < 1e-5 || scale == 1e-18, "{area}");
        }
    }

    #[test]
    fn a_shading_normal_is_bent_into_sight() {
        let viewer = Vec3::new(0.8, 0.0, 0.6);
        let away = Vec3::new(-0.8, 0.0, 0.6);
        for front in [true, false] {
            let side = if front { 1.0 } else { -1.0 };
            let bent = visible(away, viewer * side, front);
            assert!((bent.length() - 1.0).abs() < 1e-5);
            let cosine = bent.dot(viewer);
            assert!(cosine > 0.0 && cosine < 2.0 * GRAZING, "{cosine}");
        }
        assert_eq!(visible(Vec3::Z, viewer, true), Vec3::Z);
    }
}
