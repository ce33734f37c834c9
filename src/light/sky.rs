//! Sun and sky as an environment.

use std::f32::consts::{FRAC_1_PI, PI};

use super::{Environment, Preetham, Sun};
use crate::math::Vec3;

/// A unit of radiance is so many kcd/m², so that a day's picture needs no `--exposure`.
const UNIT: f32 = 10.0;

/// A clear day's sky with its sun, over even ground, by [`Preetham`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Within [`Preetham::TURBIDITY`].
    pub turbidity: f32,
    /// Unit direction to the sun, not below the horizon.
    pub sun: Vec3,
    /// The share of light that the ground reflects; ground is all that is seen below the horizon.
    pub ground_albedo: f32,
    /// Angular diameter of the sun's disc, degrees; `None`: no disc and none of its light.
    pub sun_diameter: Option<f32>,
}

impl Default for Sky {
    /// A clear afternoon: turbidity 3, the sun 45° high over the right shoulder of a viewer who
    /// looks along -Z, ground like dry earth.
    fn default() -> Self {
        Self {
            turbidity: 3.0,
            sun: sun_direction(45.0, 135.0),
            ground_albedo: 0.2,
            sun_diameter: Some(Sun::DIAMETER),
        }
    }
}

/// The unit direction at an elevation above the horizon and an azimuth, degrees: 0 is -Z, 90 is +X,
/// as on a compass whose north is -Z.
pub fn sun_direction(elevation: f32, azimuth: f32) -> Vec3 {
    let (up, across) = libm::sincosf(elevation.to_radians());
    let (east, north) = libm::sincosf(azimuth.to_radians());
    Vec3::new(across * east, up, -across * north)
}

impl Sky {
    /// The environment, times `scale`. A radiance of one is 10 kcd/m².
    pub fn environment(&self, scale: f32) -> Environment {
        const HEIGHT: usize = 512;
        const WIDTH: usize = 2 * HEIGHT;
        let model = Preetham::new(self.turbidity, self.sun);
        let scale = scale / UNIT;
        let (mut pixels, mut falling) = (vec![[0.0; 3]; WIDTH * HEIGHT], Vec3::ZERO);
        // Rows straddle the horizon, which lies half a row below the last one of the sky.
        let step = PI / (HEIGHT - 1) as f32;
        for y in 0..HEIGHT / 2 {
            let (sine, cosine) = libm::sincosf(y as f32 * step);
            for x in 0..WIDTH {
                let turn = ((x as f32 + 0.5) / WIDTH as f32 - 0.5) * (2.0 * PI);
                let (s, c) = libm::sincosf(turn);
                let radiance = model.radiance(Vec3::new(sine * s, cosine, -sine * c)) * scale;
                pixels[y * WIDTH + x] = radiance.to_array();
                falling += radiance * (sine * cosine);
            }
        }
        falling *= step * 2.0 * PI / WIDTH as f32;
        let irradiance = model.sun_irradiance() * scale;
        if self.sun_diameter.is_some() {
            falling += irradiance * self.sun.y.max(0.0);
        }
        let ground = falling * self.ground_albedo * FRAC_1_PI;
        pixels[WIDTH * HEIGHT / 2..].fill(ground.to_array());
        let sky = Environment::image(WIDTH, HEIGHT, pixels, 1.0, 0.0);
        match self.sun_diameter {
            Some(diameter) => sky.with_sun(Sun::new(self.sun, diameter, irradiance)),
            None => sky,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use crate::sampling::warp;

    #[test]
    fn directions_are_those_of_a_compass() {
        let near = |a: Vec3, b: Vec3| a.distance(b) < 1e-6;
        assert!(near(sun_direction(0.0, 0.0), Vec3::NEG_Z));
        assert!(near(sun_direction(0.0, 90.0), Vec3::X));
        assert!(near(sun_direction(90.0, 17.0), Vec3::Y));
    }

    #[test]
    fn the_ground_sends_back_its_share_of_sun_and_sky() {
        let sky = Sky { ground_albedo: 0.5, ..Sky::default() };
        let environment = sky.environment(1.0);
        let dark = Sky { sun_diameter: None, ..sky }.environment(2.0);
        // What falls on the ground: the sky by numbers, the sun as it is told.
        let sun = environment.sun().expect("a sun");
        let (mut sum, side) = (Vec3::ZERO, 256);
        for (i, j) in (0..side).flat_map(|i| (0..side).map(move |j| (i, j))) {
            let u = (Vec2::new(i as f32, j as f32) + 0.5) / side as f32;
            let direction = warp::cosine_hemisphere(u);
            sum += dark.radiance(Vec3::new(direction.x, direction.z, direction.y)) * 0.5;
        }
        let from_sun = sun.radiance() * (sun.solid_angle() * sun.direction().y);
        let falling = sum * (PI / (side * side) as f32) + from_sun;
        let ground = environment.radiance(Vec3::new(0.1, -0.9, 0.1).normalize());
        assert!((ground / (falling * 0.5 * FRAC_1_PI) - 1.0).abs().max_element() < 0.02);
        // A day outdoors: the paper at 45° and turbidity 3 gives some 80 klx in all.
        assert!((5.0..11.0).contains(&falling.y), "{falling}");
        assert!(dark.radiance(Vec3::NEG_Y).y < ground.y);
        assert_eq!(dark.radiance(Vec3::Y), environment.radiance(Vec3::Y) * 2.0);
    }
}
