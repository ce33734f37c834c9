//! A convex region, and which boxes it misses.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8};

use crate::geom::heading::Heading;
use crate::math::{Aabb, DVec3, Vec3};

/// A convex region that holds rays.
#[derive(Clone, Debug)]
pub struct Shaft {
    /// Of each plane's normal by axis, what is above and what is below zero.
    pub(super) plus: [[f32; PLANES]; 3],
    pub(super) minus: [[f32; PLANES]; 3],
    /// Magnitudes of the normals' parts, times [`SLACK`].
    size: [[f32; PLANES]; 3],
    /// `c` of each plane.
    pub(super) offset: [f32; PLANES],
    /// `c` and the part of the slack that does not depend on the box.
    outer: [f32; PLANES],
    /// `c` without it; infinite where there is no plane.
    pub(super) inner: [f32; PLANES],
    /// Largest coordinates of origins.
    pub(super) reach: Vec3,
    /// The direction that rays go in, if there is one: normal of the plane number [`END`].
    axis: Vec3,
    /// Where it was made from slopes: directions of its corners, which all others lie between, the
    /// box of origins, and the greater difference of slopes.
    pub(super) core: Option<(Aabb, [Vec3; 4], f32)>,
    /// Whether the planes after the first are those of four sides, of which two by two face each
    /// other.
    pub(super) has_sides: bool,
}

/// Planes at most.
pub const PLANES: usize = 8;
/// The plane that ends the region along its axis.
const END: usize = PLANES - 1;
/// 2^-18.
pub const SLACK: f32 = 3.8146973e-6;
/// 2^-80.
const ACROSS: f32 = 8.271806e-25;
/// 2^-120.
const TINY: f32 = 7.523164e-37;
/// 2^100.
const LARGE: f32 = 1.2676506e30;
/// 2^20.
pub const LONGEST: f32 = 1048576.0;

impl Shaft {
    /// A region of up to seven half-spaces `n · x <= c`, for rays whose origins lie in a box.
    pub(super) fn new(planes: &[(Vec3, f32)], origins: Aabb, axis: Vec3) -> Option<Self> {
        let reach = origins.min.abs().max(origins.max.abs());
        if !(reach.max_element() <= LARGE && planes.len() < PLANES) {
            return None;
        }
        let mut shaft = Self {
            plus: [[0.0; PLANES]; 3],
            minus: [[0.0; PLANES]; 3],
            size: [[0.0; PLANES]; 3],
            offset: [0.0; PLANES],
            outer: [TINY; PLANES],
            inner: [f32::INFINITY; PLANES],
            reach: reach + Vec3::splat(reach.max_element() * ACROSS),
            axis,
            core: None,
            has_sides: false,
        };
        for (lane, &(normal, offset)) in planes.iter().enumerate() {
            shaft.put(lane, normal, offset);
        }
        Some(shaft)
    }

    /// Puts a plane; one that is too far away to be told is left out.
    #[inline(always)]
    fn put(&mut self, lane: usize, normal: Vec3, offset: f32) {
        if offset.is_nan() || offset.abs() > LARGE {
            return;
        }
        for axis in 0..3 {
            self.plus[axis][lane] = normal[axis].max(0.0);
            self.minus[axis][lane] = normal[axis].min(0.0);
            self.size[axis][lane] = normal[axis].abs() * SLACK;
        }
        self.offset[lane] = offset;
        let slack = (normal.abs().dot(self.reach) + offset.abs()) * SLACK + TINY;
        self.outer[lane] = offset + slack;
        self.inner[lane] = offset - slack;
    }

    /// The region that a camera sees in a tile: rays from a box of origins in directions between
    /// four corners, given in order around the tile. `None` if these make no pyramid.
    pub fn pyramid(origins: Aabb, corners: [Vec3; 4]) -> Option<Self> {
        let (planes, axis) = make_pyramid_planes(origins, corners)?;
        Self::new(&planes, origins, axis)
    }

    /// As [`Shaft::pyramid`], for rays side by side: boxes that are small beside it are told by
    /// [`Shaft::is_coarser`].
    pub fn tile(origins: Aabb, corners: [Vec3; 4]) -> Option<Self> {
        Some(Self { has_sides: true, ..Self::pyramid(origins, corners)? })
    }

    /// The region of segments that begin and end in a pyramid, up to a distance from its apex along
    /// its middle: what a spot light reaches. `None` if the corners make no pyramid.
    pub fn spot(apex: Vec3, corners: [Vec3; 4], range: f32) -> Option<Self> {
        let (planes, axis) = make_pyramid_planes(Aabb::of_points([apex]), corners)?;
        // Where an edge of the pyramid meets the plane that ends it.
        let end = |corner: Vec3| apex + corner * (range / corner.dot(axis));
        let all = Aabb::of_points(corners.map(end)).include(apex);
        let mut ended = [(axis, apex.dot(axis) + range); 6];
        ended[..5].copy_from_slice(&planes);
        Self::new(&ended, all, Vec3::ZERO)
    }

    /// The region of segments that begin and end in a box: what a light of limited range reaches.
    /// `None` for an empty or an infinite one.
    pub fn within(bounds: Aabb) -> Option<Self> {
        let mut planes = [(Vec3::ZERO, 0.0); 6];
        for axis in 0..3 {
            let normal = Vec3::AXES[axis];
            planes[2 * axis] = (normal, bounds.max[axis]);
            planes[2 * axis + 1] = (-normal, -bounds.min[axis]);
        }
        if bounds.is_empty() { None } else { Self::new(&planes, bounds, Vec3::ZERO) }
    }

    /// The direction that its rays go in; zero if there is none.
    pub fn axis(&self) -> Vec3 {
        self.axis
    }

    /// Ends the region where points along its axis reach a distance from the world's origin, as
    /// rounded from `o · axis + t (d · axis)`; nothing changes if that is not finite.
    #[inline(always)]
    pub fn end_at(&mut self, distance: f32) {
        self.put(END, self.axis, distance);
    }

    /// The greater difference of slopes across its axis; infinite where that is not known.
    pub fn spread(&self) -> f32 {
        self.core.map_or(f32::INFINITY, |(_, _, spread)| spread)
    }

    /// The point that all of its rays start at and the directions of its corners, of which theirs
    /// are sums with positive weights; `None` if that is not known.
    pub fn cone(&self) -> Option<(Vec3, [Vec3; 4])> {
        let (origins, corners, _) = self.core.as_ref()?;
        (origins.min == origins.max).then_some((origins.min, *corners))
    }

    /// The way in which all rays head of which it was made, where its corners tell: directions that
    /// head the same way, none of them along a face of their octant, are a convex set.
    #[inline(always)]
    pub fn heading(&self) -> Option<Heading> {
        let (_, corners, _) = self.core.as_ref()?;
        let heading = Heading::of(corners[0]);
        for corner in corners {
            if corner.cmpeq(Vec3::ZERO).any() || Heading::of(*corner).number() != heading.number() {
                return None;
            }
        }
        Some(heading)
    }

    /// Whether this region is known to hold every ray of which another was made.
    ///
    /// A half-space that holds the corners of their origins, and goes on for ever along the
    /// directions of their corners, does so along all directions between.
    pub fn contains(&self, other: &Self) -> bool {
        let Some((origins, corners, _)) = &other.core else { return false };
        let within = |lane: usize| {
            let normal = self.normal(lane);
            let pick = |high: bool| if high { origins.max } else { origins.min };
            let corner = [0, 1, 2].map(|axis| f64::from(pick(normal[axis] > 0.0)[axis]));
            DVec3::from(corner).dot(normal) <= f64::from(self.offset[lane])
                && corners.iter().all(|corner| corner.as_dvec3().dot(normal) <= 0.0)
        };
        let reach = origins.min.abs().max(origins.max.abs());
        reach.cmple(self.reach).all() && (0..PLANES).all(within)
    }

    /// A plane's normal; zero if there is none.
    #[inline(always)]
    pub(super) fn normal(&self, lane: usize) -> DVec3 {
        let along = |axis: usize| f64::from(self.plus[axis][lane] + self.minus[axis][lane]);
        DVec3::new(along(0), along(1), along(2))
    }

    /// Whether no ray that it holds enters a box, as the slab test sees it.
    #[inline(always)]
    pub fn misses<S: Simd>(&self, simd: S, bounds: &Aabb) -> bool {
        let Some(coordinates) = find_reach(bounds) else { return false };
        let mut least = f32x8::splat(simd, 0.0);
        for axis in 0..3 {
            least = least
                + f32x8::load_array_ref(simd, &self.plus[axis]) * bounds.min[axis]
                + f32x8::load_array_ref(simd, &self.minus[axis]) * bounds.max[axis]
                - f32x8::load_array_ref(simd, &self.size[axis]) * coordinates[axis];
        }
        least.simd_gt(f32x8::load_array_ref(simd, &self.outer)).to_bitmask() != 0
    }

    /// Whether a box is so small that `grain` of it would fit across the region where it lies, both
    /// ways; about, and never where the region has no four sides.
    #[inline(always)]
    pub fn is_coarser(&self, bounds: &Aabb, grain: f32) -> bool {
        if !self.has_sides {
            return false;
        }
        let (middle, half) = (bounds.centre(), bounds.extent() * 0.5);
        let normal = |lane: usize| {
            let along = |axis: usize| self.plus[axis][lane] + self.minus[axis][lane];
            Vec3::new(along(0), along(1), along(2))
        };
        // Between two planes that face each other: what is left on either side of the middle.
        let fits = |upper: usize, lower: usize| {
            let (up, down) = (normal(upper), normal(lower));
            let across =
                self.offset[upper] - up.dot(middle) + self.offset[lower] - down.dot(middle);
            2.0 * up.abs().dot(half) * grain <= across
        };
        fits(1, 2) && fits(3, 4)
    }

    /// Whether all of a box lies in the region.
    #[inline(always)]
    pub fn encloses<S: Simd>(&self, simd: S, bounds: &Aabb) -> bool {
        let Some(coordinates) = find_reach(bounds) else { return false };
        let mut most = f32x8::splat(simd, 0.0);
        for axis in 0..3 {
            most = most
                + f32x8::load_array_ref(simd, &self.plus[axis]) * bounds.max[axis]
                + f32x8::load_array_ref(simd, &self.minus[axis]) * bounds.min[axis]
                + f32x8::load_array_ref(simd, &self.size[axis]) * coordinates[axis];
        }
        most.simd_gt(f32x8::load_array_ref(simd, &self.inner)).to_bitmask() == 0
    }
}

/// The planes around rays from a box of origins in directions between four corners, and the middle
/// direction.
fn make_pyramid_planes(origins: Aabb, corners: [Vec3; 4]) -> Option<([(Vec3, f32); 5], Vec3)> {
    let corners = corners.map(Vec3::normalize_or_zero);
    let axis = corners.iter().sum::<Vec3>().normalize_or_zero();
    let mut planes = [(-axis, find_farthest(&origins, -axis)); 5];
    for side in 0..4 {
        let normal = corners[side].cross(corners[(side + 1) % 4]).try_normalize()?;
        let out = normal * -normal.dot(axis).signum() - axis * SLACK;
        if !corners.iter().all(|corner| out.dot(*corner) <= 0.0 && corner.dot(axis) > 0.0) {
            return None;
        }
        // Those that face each other one after the other.
        planes[[1, 3, 2, 4][side]] = (out, find_farthest(&origins, out));
    }
    Some((planes, axis))
}

/// The largest coordinates of a box; `None` if they are too large to be computed with.
#[inline(always)]
fn find_reach(bounds: &Aabb) -> Option<Vec3> {
    let coordinates = bounds.min.abs().max(bounds.max.abs());
    let largest = coordinates.max_element();
    (largest <= LARGE).then(|| coordinates + Vec3::splat(largest * ACROSS))
}

/// The largest `normal · x` of a box, rounded up by so much that points of it are below also as
/// [`Shaft::holds_bundle`] computes them.
#[inline(always)]
pub fn find_farthest(bounds: &Aabb, normal: Vec3) -> f32 {
    let corner = Vec3::select(normal.cmpgt(Vec3::ZERO), bounds.max, bounds.min);
    let size = normal.abs().dot(corner.abs());
    corner.dot(normal) + size * (8.0 * f32::EPSILON)
}

/// Whether a direction is neither too long nor too short.
#[inline(always)]
pub fn is_tame(direction: Vec3) -> bool {
    (1.0 / LONGEST..=LONGEST).contains(&direction.abs().max_element())
}
