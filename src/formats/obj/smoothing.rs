//! Normals for smoothing groups: a surface that is smooth by the file's word alone.
//!
//! At each vertex of a group the normals of the group's faces around it are averaged, each by the
//! angle that the face has there, so that it does not matter how faces are cut into triangles
//! (Thürmer and Wüthrich, "Computing vertex normals from polygonal facets", 1998).

use std::collections::HashMap;

use super::geometry::{Corner, Geometry, NONE};
use crate::math::{DVec3, Vec3};

/// A polygon of a smoothing group, some of whose corners have no normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoothed {
    /// The group's number, not 0.
    pub group: u32,
    /// In [`Geometry::parts`].
    pub part: usize,
    /// Its first corner there.
    pub start: usize,
    /// How many it has.
    pub count: usize,
}

/// The number of a smoothing group as the statement `s` names it; 0: none.
pub(super) fn group(name: &[u8]) -> u32 {
    match name {
        b"" | b"off" | b"0" => 0,
        name => str::from_utf8(name).ok().and_then(|name| name.parse().ok()).unwrap_or(NONE),
    }
}

/// Gives the corners of those polygons that have none the normals of their groups; corners around
/// which all faces are without area, or cancel each other, stay as they are.
pub(super) fn add_normals(geometry: &mut Geometry, polygons: &[Smoothed]) {
    let mut sums: HashMap<(u32, u32), DVec3> = HashMap::new();
    for polygon in polygons {
        let corners = corners_of(geometry, polygon);
        let at =
            |i: usize| geometry.positions[corners[i % corners.len()].position as usize].as_dvec3();
        let Some(normal) = normal((0..corners.len()).map(at)) else { continue };
        for (i, corner) in corners.iter().enumerate() {
            let (before, after) = (at(i + corners.len() - 1) - at(i), at(i + 1) - at(i));
            let angle = libm::atan2(before.cross(after).length(), before.dot(after));
            *sums.entry((polygon.group, corner.position)).or_default() += normal * angle;
        }
    }
    let mut found: HashMap<(u32, u32), u32> = HashMap::new();
    for polygon in polygons {
        let Smoothed { group, part, start, count } = *polygon;
        let Geometry { parts, normals, .. } = geometry;
        for corner in &mut parts[part].corners[start..start + count] {
            if corner.normal != NONE {
                continue;
            }
            let key = (group, corner.position);
            let sum = sums.get(&key).map_or(Vec3::ZERO, |sum| sum.normalize_or_zero().as_vec3());
            if sum != Vec3::ZERO && normals.len() < NONE as usize {
                corner.normal = *found.entry(key).or_insert_with(|| {
                    normals.push(sum);
                    normals.len() as u32 - 1
                });
            }
        }
    }
}

fn corners_of<'g>(geometry: &'g Geometry, polygon: &Smoothed) -> &'g [Corner] {
    &geometry.parts[polygon.part].corners[polygon.start..polygon.start + polygon.count]
}

/// The unit normal of a polygon, which need not be flat (Newell's method).
fn normal(points: impl ExactSizeIterator<Item = DVec3> + Clone) -> Option<DVec3> {
    let first = points.clone().next()?;
    let next = points.clone().cycle().skip(1);
    let pairs = points.zip(next);
    pairs.map(|(a, b)| (a - first).cross(b - first)).sum::<DVec3>().try_normalize()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::parse::parse;
    use super::super::remarks::Remarks;
    use super::*;
    use crate::files::Meter;

    /// All corners' normals, zero where there are none.
    fn normals(text: &str) -> Vec<Vec3> {
        let file = Path::new("a.obj");
        let geometry = parse(text.as_bytes(), file, &mut Remarks::new(file), &Meter::default())
            .expect("valid");
        let corners = geometry.parts.iter().flat_map(|part| &part.corners);
        corners
            .map(|corner| geometry.normals.get(corner.normal as usize).copied())
            .map(Option::unwrap_or_default)
            .collect()
    }

    /// Two squares that meet at a right angle along the edge from 1 to 2, one of them in two parts.
    const FOLD: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n";

    #[test]
    fn a_group_is_smooth_however_its_faces_are_cut() {
        let found = normals(&format!("{FOLD}s 1\nf 1 2 3 4\nf 1 5 6\nf 1 6 2\n"));
        let edge = Vec3::new(0.0, 1.0, 1.0).normalize();
        for (corner, expected) in
            [(0, edge), (1, edge), (2, Vec3::Z), (3, Vec3::Z), (5, Vec3::Y), (9, edge)]
        {
            assert!(found[corner].distance(expected) < 1e-6, "{corner}: {}", found[corner]);
        }
    }

    #[test]
    fn groups_meet_in_edges_and_what_has_none_is_flat() {
        let found = normals(&format!("{FOLD}s 1\nf 1 2 3 4\ns 2\nf 1 5 6 2\ns off\nf 1 2 3\n"));
        assert!(found[..4].iter().all(|normal| normal.distance(Vec3::Z) < 1e-6), "{found:?}");
        assert!(found[4..8].iter().all(|normal| normal.distance(Vec3::Y) < 1e-6), "{found:?}");
        assert_eq!(found[8..], [Vec3::ZERO; 3]);
    }

    #[test]
    fn normals_of_the_file_stay_and_faces_without_area_add_none() {
        let found = normals(&format!("{FOLD}vn 1 0 0\ns 1\nf 1//1 2 3\nf 3 3 3\nf 4 4 4\n"));
        assert_eq!(found[0], Vec3::X);
        assert!(found[1].distance(Vec3::Z) < 1e-6 && found[3].distance(Vec3::Z) < 1e-6);
        assert_eq!(found[6], Vec3::ZERO);
        assert!(
            normals("v 3e38 -3e38 3e38\nv -3e38 3e38 3e38\nv 0 1 0\ns 1\nf 1 2 3\n")
                .iter()
                .all(|normal| normal.is_finite())
        );
    }
}
