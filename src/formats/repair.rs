//! Vertices that files get wrong, put right as far as that can be.

use crate::geom::Mesh;
use crate::math::{Vec2, Vec3, Vec4};

/// Makes normals unit vectors. One that has no direction becomes the sum of its triangles' normals
/// by area, up where that is none either; whether there was such a one.
pub(super) fn normals(mesh: &mut Mesh) -> bool {
    let mut broken = Vec::new();
    for (i, normal) in mesh.normals.iter_mut().enumerate() {
        match unit(*normal) {
            Some(unit) => *normal = unit,
            None => broken.push(i),
        }
    }
    replace_normals(mesh, &broken);
    !broken.is_empty()
}

/// Replaces texture coordinates that are not finite by 0; whether there was such a one.
pub(super) fn uvs(uvs: &mut [Vec2]) -> bool {
    let mut any = false;
    for uv in uvs.iter_mut().filter(|uv| !uv.is_finite()) {
        *uv = Vec2::ZERO;
        any = true;
    }
    any
}

/// Takes colours to 0 to 1, those that are no numbers to 0; whether there was such a one.
pub(super) fn colors(colors: &mut [Vec4]) -> bool {
    let mut any = false;
    for color in colors {
        let unit = |x: f32| if x > 0.0 { x.min(1.0) } else { 0.0 };
        let clamped = Vec4::from_array(color.to_array().map(unit));
        any |= clamped != *color;
        *color = clamped;
    }
    any
}

/// The unit vector along `v`, unless `v` is zero or not finite. Scaled first, so that neither a
/// tiny nor a huge vector is lost when squared.
pub(super) fn unit(v: Vec3) -> Option<Vec3> {
    let longest = v.abs().max_element();
    if longest > 0.0 && v.is_finite() { (v / longest).try_normalize() } else { None }
}

/// Gives the vertices in `broken`, which are in order, the normals of their triangles.
fn replace_normals(mesh: &mut Mesh, broken: &[usize]) {
    if broken.is_empty() {
        return;
    }
    let mut sums = vec![Vec3::ZERO; broken.len()];
    for &triangle in &mesh.indices {
        let slots = triangle.map(|vertex| broken.binary_search(&(vertex as usize)).ok());
        if slots == [None; 3] {
            continue;
        }
        let [a, b, c] = triangle.map(|vertex| mesh.positions[vertex as usize]);
        let double_area = (b - a).cross(c - a);
        for slot in slots.into_iter().flatten() {
            sums[slot] += double_area;
        }
    }
    for (&vertex, &sum) in broken.iter().zip(&sums) {
        mesh.normals[vertex] = unit(sum).unwrap_or(Vec3::Y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_without_a_direction_take_that_of_their_faces() {
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            normals: vec![Vec3::ZERO, Vec3::new(f32::NAN, 0.0, 1.0), Vec3::X * 1e-30, Vec3::ZERO],
            indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        assert!(normals(&mut mesh));
        assert_eq!(mesh.normals, [Vec3::Z, Vec3::Z, Vec3::X, Vec3::Y]);
        assert!(!normals(&mut mesh));
    }

    #[test]
    fn numbers_that_are_none_become_zero() {
        let mut all = [Vec2::NAN, Vec2::ONE];
        assert!(uvs(&mut all) && all == [Vec2::ZERO, Vec2::ONE]);
        let mut all = [Vec4::new(2.0, -1.0, f32::NAN, 0.5), Vec4::ONE];
        assert!(colors(&mut all) && all == [Vec4::new(1.0, 0.0, 0.0, 0.5), Vec4::ONE]);
        assert!(!colors(&mut all));
    }
}
