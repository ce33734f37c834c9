//! How wide a path is: a cone that chooses the levels of textures.
//!
//! It begins as a pixel, as the cones of Akenine-Möller et al., "Texture Level of Detail Strategies
//! for Real-Time Ray Tracing" (2019), do. Where they widen by the roughness of a surface, this one
//! widens by the density with which the direction was sampled, which knows the whole BSDF. That
//! curved mirrors spread it more or less is left out.

/// The share of the solid angle over which a density sums to one that a path stands for. Its
/// samples find the rest.
const SHARE: f32 = 1.0 / 20.0;

/// A cone about a path's ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cone {
    /// Its width at the ray's origin, or once it is widened at its end; metres.
    pub width: f32,
    /// By how much it widens on a metre.
    pub spread: f32,
    /// Whether its next ray goes on in the direction of the one before: the density with which that
    /// was sampled has been taken, and now has the chance to come so far in it, too.
    pub goes_straight: bool,
}

impl Cone {
    /// Takes it along a ray of length `t` whose direction was sampled with density `pdf`: infinite,
    /// where it was not left to chance. A ray that meets nothing, `t` infinite, leaves it as wide
    /// as it was.
    pub fn widen(&mut self, pdf: f32, t: f32) {
        // A cap of such a solid angle is so wide at distance one, if it is small.
        if !std::mem::take(&mut self.goes_straight) {
            let of_lobe = (4.0 * SHARE * std::f32::consts::FRAC_1_PI / pdf).sqrt();
            self.spread = self.spread.max(of_lobe);
        }
        if t < f32::INFINITY {
            self.width += self.spread * t;
        }
    }

    /// Takes it back from the end of a ray of length `t` to the point `at` metres on along it.
    pub fn end_at(&mut self, at: f32, t: f32) {
        let beyond = if t < f32::INFINITY { t - at } else { -at };
        self.width = (self.width - self.spread * beyond).max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrors_keep_the_spread_and_rough_surfaces_widen_it() {
        let mut cone = Cone { spread: 0.001, ..Cone::default() };
        cone.widen(f32::INFINITY, 2.0);
        cone.widen(f32::INFINITY, 3.0);
        assert!((cone.width - 0.005).abs() < 1e-8 && cone.spread == 0.001);
        cone.widen(1.0, 1.0);
        assert!((cone.spread - 0.2523).abs() < 1e-4, "{cone:?}");
        let (wide, before) = (cone.spread, cone.width);
        cone.widen(1e9, 1.0);
        assert_eq!((cone.spread, cone.width), (wide, before + wide));
    }

    #[test]
    fn it_is_as_wide_as_where_its_ray_ends() {
        for t in [8.0, f32::INFINITY] {
            let mut cone = Cone { width: 0.5, spread: 0.25, ..Cone::default() };
            cone.widen(f32::INFINITY, t);
            cone.end_at(2.0, t);
            assert_eq!(cone.width, 1.0, "{t}");
        }
    }

    #[test]
    fn a_direction_that_goes_on_is_taken_once() {
        let mut cone = Cone { spread: 0.25, goes_straight: true, ..Cone::default() };
        cone.widen(1e-6, 1.0);
        assert_eq!((cone.spread, cone.width), (0.25, 0.25));
        cone.widen(1e-6, 1.0);
        assert!(cone.spread > 100.0);
    }
}
