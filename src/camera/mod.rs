//! Cameras: from points of the film to rays.

mod cone;
pub mod flight;
mod framing;
mod lanes;
pub mod moving;

use std::f32::consts::{PI, TAU};
use std::sync::Arc;

use crate::geom::Shaft;
use crate::math::{Aabb, Affine3A, Frame, Mat3, Ray, Vec2, Vec3};
use crate::motion::Motion;
use crate::sampling::warp;

/// How points of the film become directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays through one point.
    Perspective {
        /// Angle between the upper and the lower edge of the film, radians, below π.
        yfov: f32,
    },
    /// All rays in parallel.
    Orthographic {
        /// Half of the film's width, metres. It gives the camera's own aspect only: as in
        /// perspective, a film of another aspect keeps its height.
        xmag: f32,
        /// Half of the film's height, metres.
        ymag: f32,
    },
    /// All around, by longitude across and latitude down (equirectangular): what is ahead in the
    /// middle, what is to the right to its right, as in images of environments. It has no lens.
    Panorama,
}

/// A lens that blurs what is not in its plane of focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinLens {
    /// Radius of the aperture, metres.
    pub aperture_radius: f32,
    /// From the lens to the plane of focus, metres, along the line of sight; above zero.
    pub focus_distance: f32,
}

/// A camera, as glTF 2.0 (3.10) has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// How points of the film become directions.
    pub projection: Projection,
    /// Orthonormal, and a translation. The camera looks along its -Z, +Y up.
    pub to_world: Affine3A,
    /// `None`: a pinhole.
    pub lens: Option<ThinLens>,
}

impl Camera {
    /// A camera at `eye` that looks at `target`; `yfov` in radians. An `up` along the line of sight
    /// or zero means any; a target at the eye means looking along -Z.
    ///
    /// # Examples
    /// ```
    /// use dapple::Camera;
    /// use dapple::math::{Vec2, Vec3};
    ///
    /// let camera = Camera::look_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0);
    /// // The ray through the middle of the film; without a lens its sample has no effect.
    /// let ray = camera.ray(Vec2::splat(0.5), 16.0 / 9.0, Vec2::ZERO);
    /// assert_eq!((ray.origin(), ray.direction()), (Vec3::Z, -Vec3::Z));
    /// ```
    pub fn look_at(eye: Vec3, target: Vec3, up: Vec3, yfov: f32) -> Self {
        let back = normalize_any(eye - target).unwrap_or(Vec3::Z);
        let right = normalize_any(up.cross(back));
        let right = right.unwrap_or_else(|| Frame::from_normal(back).tangent);
        let turn = Mat3::from_cols(right, back.cross(right), back);
        Self {
            projection: Projection::Perspective { yfov },
            to_world: Affine3A::from_mat3_translation(turn, eye),
            lens: None,
        }
    }

    /// The same camera with another angle of view, in radians; an orthographic one becomes
    /// perspective.
    pub fn with_yfov(self, yfov: f32) -> Self {
        Self { projection: Projection::Perspective { yfov }, ..self }
    }

    /// The same camera looking all around.
    pub fn with_panorama(self) -> Self {
        Self { projection: Projection::Panorama, lens: None, ..self }
    }

    /// The same camera with a lens.
    pub fn with_lens(self, lens: ThinLens) -> Self {
        Self { lens: Some(lens), ..self }
    }

    /// The ray through a point of the film: `film` is (0, 0) at the upper left corner and (1, 1) at
    /// the lower right one; `aspect` is the film's width over its height; `lens`, of the unit
    /// square, chooses the point of the lens. From 0 to infinity, of unit direction.
    ///
    /// To make many, see [`Camera::rays`].
    pub fn ray(&self, film: Vec2, aspect: f32, lens: Vec2) -> Ray {
        self.rays(aspect).ray(film, lens)
    }

    /// Prepares the camera for a film of that aspect.
    pub fn rays(&self, aspect: f32) -> CameraRays {
        let half = match self.projection {
            Projection::Perspective { yfov } => libm::tanf(0.5 * yfov),
            Projection::Orthographic { ymag, .. } => ymag,
            Projection::Panorama => 1.0,
        };
        CameraRays { camera: *self, half: Vec2::new(half * aspect, half), motion: None }
    }

    /// The camera's own aspect, where it has one.
    pub fn aspect(&self) -> Option<f32> {
        match self.projection {
            Projection::Perspective { .. } => None,
            Projection::Orthographic { xmag, ymag } => Some(xmag / ymag),
            Projection::Panorama => Some(2.0),
        }
    }
}

/// The unit vector, also where the square of the length overflows; `None` for zero.
fn normalize_any(v: Vec3) -> Option<Vec3> {
    v.try_normalize().or_else(|| (v / v.abs().max_element()).try_normalize())
}

/// A camera prepared for a film.
#[derive(Clone, Debug)]
pub struct CameraRays {
    camera: Camera,
    /// Half of the film at distance one, or in space if orthographic.
    half: Vec2,
    /// How it moves, if it does.
    motion: Option<Arc<Motion>>,
}

impl CameraRays {
    /// See [`Camera::ray`]; at time 0.
    #[inline(always)]
    pub fn ray(&self, film: Vec2, lens: Vec2) -> Ray {
        self.ray_from(&self.camera.to_world, film, lens)
    }

    #[inline(always)]
    fn ray_from(&self, to_world: &Affine3A, film: Vec2, lens: Vec2) -> Ray {
        let x = (2.0 * film.x - 1.0) * self.half.x;
        let y = (1.0 - 2.0 * film.y) * self.half.y;
        let (mut origin, mut direction) = match self.camera.projection {
            Projection::Perspective { .. } => (Vec3::ZERO, Vec3::new(x, y, -1.0)),
            Projection::Orthographic { .. } => (Vec3::new(x, y, 0.0), Vec3::NEG_Z),
            Projection::Panorama => (Vec3::ZERO, panorama_direction(film)),
        };
        if let Some(thin) = self.camera.lens {
            let focus = origin + direction * thin.focus_distance;
            origin += (warp::disk(lens) * thin.aperture_radius).extend(0.0);
            direction = focus - origin;
        }
        let direction = to_world.transform_vector3(direction).normalize();
        Ray::new(to_world.transform_point3(origin), direction, 0.0, f32::INFINITY)
    }

    /// The region of all rays of the film, as far as rounding allows; `None` unless they spread
    /// from a point or a lens, by less than a half-space, and from the same place at all times.
    pub fn region(&self) -> Option<Shaft> {
        if self.motion.is_some() {
            return None;
        }
        let Projection::Perspective { .. } = self.camera.projection else { return None };
        let lens = self.camera.lens.map_or((0.0, 1.0), |l| (l.aperture_radius, l.focus_distance));
        // From the lens's edge, what is in focus is as much farther aside.
        let (radius, aside) = (lens.0, lens.0 / lens.1);
        let to_world = &self.camera.to_world;
        let corner = |x: f32, y: f32| {
            let to = (self.half + aside) * Vec2::new(x, y);
            to_world.transform_vector3(to.extend(-1.0))
        };
        let eye = Vec3::from(to_world.translation);
        let origins = Aabb { min: eye - radius, max: eye + radius };
        let corners = [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
        Shaft::pyramid(origins, corners)
    }
}

/// The direction of a point of a panorama.
fn panorama_direction(film: Vec2) -> Vec3 {
    let (longitude, latitude) = ((film.x - 0.5) * TAU, (0.5 - film.y) * PI);
    let (across, up) = (libm::cosf(latitude), libm::sinf(latitude));
    Vec3::new(libm::sinf(longitude) * across, up, -libm::cosf(longitude) * across)
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;
    use crate::sampling::Sampler;
    use crate::sampling::chi_squared::assert_fits;

    fn near(a: Vec3, b: Vec3) -> bool {
        a.distance(b) < 1e-5
    }

    #[test]
    fn corners_of_the_film() {
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, FRAC_PI_2);
        let ray = |x, y| camera.ray(Vec2::new(x, y), 2.0, Vec2::ZERO).direction();
        assert!(near(ray(0.5, 0.5), Vec3::NEG_Z));
        assert!(near(ray(0.0, 0.0), Vec3::new(-2.0, 1.0, -1.0).normalize()));
        assert!(near(ray(1.0, 1.0), Vec3::new(2.0, -1.0, -1.0).normalize()));
    }

    #[test]
    fn a_panorama_looks_all_around() {
        let camera = Camera::look_at(Vec3::ONE, Vec3::new(1.0, 1.0, 0.0), Vec3::Y, 1.0);
        let camera = camera.with_panorama();
        assert_eq!(camera.aspect(), Some(2.0));
        for (x, y, way) in [
            (0.5, 0.5, Vec3::NEG_Z),
            (0.75, 0.5, Vec3::X),
            (0.25, 0.5, Vec3::NEG_X),
            (0.0, 0.5, Vec3::Z),
            (1.0, 0.5, Vec3::Z),
            (0.3, 0.0, Vec3::Y),
            (0.9, 1.0, Vec3::NEG_Y),
            (0.5, 0.25, Vec3::new(0.0, 1.0, -1.0).normalize()),
        ] {
            let ray = camera.ray(Vec2::new(x, y), 2.0, Vec2::ZERO);
            assert!(near(ray.direction(), way), "{x}, {y}: {}", ray.direction());
            assert_eq!(ray.origin(), Vec3::ONE);
        }
    }

    /// Chi-squared over rings and sectors of equal area, of rays that all meet in focus.
    #[test]
    fn rays_leave_a_lens_evenly_and_meet_in_focus() {
        const RINGS: usize = 8;
        const SECTORS: usize = 12;
        let lens = ThinLens { aperture_radius: 0.3, focus_distance: 4.0 };
        let camera = Camera::look_at(Vec3::ONE, Vec3::ZERO, Vec3::Y, 0.8).with_lens(lens);
        let film = Vec2::new(0.2, 0.7);
        let pinhole = Camera { lens: None, ..camera }.ray(film, 1.0, Vec2::ZERO);
        let ahead = -camera.to_world.matrix3.z_axis;
        let focus = pinhole.at(4.0 / pinhole.direction().dot(ahead.into()));
        let mut counts = [0; RINGS * SECTORS];
        for i in 0..40_000 {
            let ray = camera.ray(film, 1.0, Sampler::independent(i, 0, 3).next_2d());
            let along = (focus - ray.origin()).dot(ray.direction());
            assert!(ray.at(along).distance(focus) < 1e-5);
            let at = camera.to_world.inverse().transform_point3(ray.origin());
            assert!(at.z.abs() < 1e-5);
            let ring = (at.truncate().length_squared() / 0.09 * RINGS as f32) as usize;
            let turn = libm::atan2f(at.y, at.x) / TAU + 0.5;
            let sector = ((turn * SECTORS as f32) as usize).min(SECTORS - 1);
            counts[ring.min(RINGS - 1) * SECTORS + sector] += 1;
        }
        let expected = [40_000.0 / (RINGS * SECTORS) as f64; RINGS * SECTORS];
        assert_fits(&counts, &expected, 1, "lens");
    }

    #[test]
    fn it_looks_where_it_is_told() {
        let eye = Vec3::new(1.0, 2.0, 3.0);
        for (target, up) in [
            (Vec3::new(4.0, -2.0, 0.5), Vec3::Y),
            (eye - Vec3::Y, Vec3::Y),
            (eye, Vec3::Y),
            (Vec3::ZERO, Vec3::ZERO),
        ] {
            let camera = Camera::look_at(eye, target, up, 0.7);
            let matrix = camera.to_world.matrix3;
            assert!((matrix.determinant() - 1.0).abs() < 1e-5);
            let ray = camera.ray(Vec2::splat(0.5), 1.0, Vec2::ZERO);
            assert_eq!(ray.origin(), eye);
            assert_eq!((ray.t_min(), ray.t_max()), (0.0, f32::INFINITY));
            let expected = (target - eye).try_normalize().unwrap_or(Vec3::NEG_Z);
            assert!(near(ray.direction(), expected));
            let top = camera.ray(Vec2::new(0.5, 0.0), 1.0, Vec2::ZERO).direction();
            assert!(top.dot(up) >= ray.direction().dot(up) - 1e-5);
        }
    }

    #[test]
    fn parallel_rays_keep_the_height_of_the_film() {
        let mut camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0);
        camera.projection = Projection::Orthographic { xmag: 3.0, ymag: 2.0 };
        assert_eq!(camera.aspect(), Some(1.5));
        let ray = camera.ray(Vec2::new(1.0, 0.0), 1.5, Vec2::ZERO);
        assert!(near(ray.origin(), Vec3::new(3.0, 2.0, 0.0)) && near(ray.direction(), Vec3::NEG_Z));
        let wide = camera.ray(Vec2::new(1.0, 0.0), 2.0, Vec2::ZERO);
        assert!(near(wide.origin(), Vec3::new(4.0, 2.0, 0.0)));
    }

    #[test]
    fn rays_of_a_lens_meet_in_focus() {
        let lens = ThinLens { aperture_radius: 0.3, focus_distance: 5.0 };
        let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 1.0).with_lens(lens);
        let meet = |x: f32, y: f32| {
            let ray = camera.ray(Vec2::new(0.2, 0.7), 1.5, Vec2::new(x, y));
            assert!(ray.origin().length() <= 0.3 + 1e-6);
            assert!((ray.direction().length() - 1.0).abs() < 1e-6);
            ray.at((-5.0 - ray.origin().z) / ray.direction().z)
        };
        assert!(near(meet(0.1, 0.9), meet(0.8, 0.3)));
        assert!(meet(0.1, 0.9).z + 5.0 < 1e-5);
    }

    #[test]
    fn the_region_of_a_film_holds_its_rays() {
        let pinhole = Camera::look_at(Vec3::new(3.0, -1.0, 2.0), Vec3::ZERO, Vec3::Y, 0.8);
        let lens = ThinLens { aperture_radius: 0.2, focus_distance: 3.0 };
        for camera in [pinhole, pinhole.with_lens(lens)] {
            let rays = camera.rays(1.5);
            let region = rays.region().expect("a pyramid");
            let at = |i: u32, n: u32| (i as f32 + 0.5) / n as f32;
            for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x, y))) {
                let of_lens = Vec2::new(at(x * 7 % 20, 20), at(y * 3 % 20, 20));
                assert!(region.holds(&rays.ray(Vec2::new(at(x, 20), at(y, 20)), of_lens)));
            }
            // And no more than it must.
            for (x, y) in [(-0.2, 0.5), (1.2, 0.5), (0.5, -0.2), (0.5, 1.2)] {
                assert!(!region.holds(&rays.ray(Vec2::new(x, y), Vec2::splat(0.5))));
            }
        }
        assert!(pinhole.with_panorama().rays(2.0).region().is_none());
        let parallel = Projection::Orthographic { xmag: 1.0, ymag: 1.0 };
        let parallel = Camera { projection: parallel, ..pinhole };
        assert!(parallel.rays(1.0).region().is_none());
    }
}
