//! Textures: an image, how to read colours out of it, and what lies beyond its edges.

use std::fmt;
use std::sync::Arc;

use super::image::{Image, Store};
use super::transfer::{ColorSpace, Tables};
use crate::math::{Vec2, Vec4};

/// What lies beyond an image's edge.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// The outermost texels.
    Clamp,
    /// The image mirrored, then the image again.
    Mirror,
}

/// How to look between texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// The texel that the point lies in.
    Nearest,
    /// The four texels around, weighted; decoded before they are mixed.
    #[default]
    Bilinear,
}

/// An image as a material looks it up.
#[derive(Clone)]
pub struct Texture {
    /// What its file calls it; for messages.
    name: String,
    image: Arc<Image>,
    color_space: ColorSpace,
    wrap: [Wrap; 2],
    filter: Filter,
    tables: Tables,
    /// Images half as wide and high, and so on; empty where there are none.
    levels: Option<Arc<[Arc<Image>]>>,
}

impl fmt::Debug for Texture {
    /// Without the tables, which follow from the rest.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { image, color_space, wrap, filter, .. } = self;
        write!(f, "Texture({image:?}, {color_space:?}, {wrap:?}, {filter:?})")
    }
}

impl Texture {
    /// A texture that shares `image`; `wrap` is along u and v.
    ///
    /// Images of floats hold linear colours always; `color_space` does not touch them.
    pub fn new(
        image: Arc<Image>,
        color_space: ColorSpace,
        wrap: [Wrap; 2],
        filter: Filter,
    ) -> Self {
        let tables = Tables::new(image.depth(), color_space);
        let name = String::new();
        Self { name, image, color_space, wrap, filter, tables, levels: None }
    }

    /// The same called `name`.
    pub fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// The same of another image of the same kind of texels.
    pub(super) fn with_image(&self, image: Arc<Image>) -> Self {
        Self { image, levels: None, ..self.clone() }
    }

    /// Gives it images half as wide and high, and so on down to one texel.
    pub(super) fn set_levels(&mut self, levels: Arc<[Arc<Image>]>) {
        self.levels = Some(levels);
    }

    /// Whether it has smaller images for what is seen from afar.
    pub fn has_levels(&self) -> bool {
        self.levels.is_some()
    }

    /// What its file calls it; empty if nothing.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// One colour everywhere that nobody takes for intended.
    pub fn magenta() -> Self {
        let image = Image::of(1, 1, vec![[255_u8, 0, 255]]);
        Self::new(Arc::new(image), ColorSpace::Srgb, [Wrap::Repeat; 2], Filter::Nearest)
    }

    /// The image.
    pub fn image(&self) -> &Arc<Image> {
        &self.image
    }

    /// What lies beyond the image's edges, along u and v.
    pub fn wrap(&self) -> [Wrap; 2] {
        self.wrap
    }

    /// How it is looked up between texels.
    pub fn filter(&self) -> Filter {
        self.filter
    }

    /// What the image's numbers mean.
    pub fn color_space(&self) -> ColorSpace {
        self.color_space
    }

    /// Width and height in texels.
    pub fn size(&self) -> [u32; 2] {
        [self.image.width(), self.image.height()]
    }

    /// Linear red, green, blue and alpha (not premultiplied) at `uv`: (0, 0) is the corner of the
    /// image's first texel, (1, 1) that of its last. NaN counts as 0.
    pub fn sample(&self, uv: Vec2) -> Vec4 {
        self.sample_image(&self.image, uv)
    }

    /// The same over a square of such a side about `uv`, by the two levels whose texels are nearest
    /// to it (Williams 1983); without levels, at `uv` alone.
    pub fn sample_over(&self, uv: Vec2, side: f32) -> Vec4 {
        let Some(levels) = self.levels.as_deref() else { return self.sample(uv) };
        let texels = self.image.width() as f32 * self.image.height() as f32;
        let level = libm::log2f(side * texels.sqrt());
        if level.is_nan() || level <= 0.0 {
            return self.sample(uv);
        }
        let level = level.min(levels.len() as f32);
        let (finer, part) = (level as usize, level.fract());
        let at = |level: usize| match level.checked_sub(1) {
            Some(below) => self.sample_image(&levels[below], uv),
            None => self.sample(uv),
        };
        if part == 0.0 { at(finer) } else { mix(at(finer), at(finer + 1), part) }
    }

    #[inline]
    fn sample_image(&self, image: &Image, uv: Vec2) -> Vec4 {
        let (width, height) = (image.width(), image.height());
        match self.filter {
            Filter::Nearest => {
                let x = nearest(self.wrap[0].into_unit(uv.x), width);
                let y = nearest(self.wrap[1].into_unit(uv.y), height);
                let [texel] = self.gather(image, [(x, y)]);
                texel
            }
            Filter::Bilinear => {
                let (x, fx) = around(self.wrap[0], uv.x, width);
                let (y, fy) = around(self.wrap[1], uv.y, height);
                let at = [(x[0], y[0]), (x[1], y[0]), (x[0], y[1]), (x[1], y[1])];
                let [a, b, c, d] = self.gather(image, at);
                let (above, below) = (mix(a, b, fx), mix(c, d, fx));
                mix(above, below, fy)
            }
        }
    }

    /// The linear value of one texel; `x` and `y` lie within the image.
    #[inline]
    pub fn texel(&self, x: u32, y: u32) -> Vec4 {
        let [texel] = self.gather(&self.image, [(x, y)]);
        texel
    }

    /// The linear values of texels of an image at columns and rows within it.
    #[inline]
    fn gather<const K: usize>(&self, image: &Image, at: [(u32, u32); K]) -> [Vec4; K] {
        match image.store() {
            Store::Whole(texels) => {
                let width = image.width() as usize;
                let at = at.map(|(x, y)| y as usize * width + x as usize);
                self.tables.gather(texels, image.channels(), at)
            }
            Store::Tiles(tiles) => tiles.gather(self.tables, at),
        }
    }
}

impl Wrap {
    /// Brings a coordinate into 0..=1.
    #[inline]
    fn into_unit(self, u: f32) -> f32 {
        match self {
            Self::Repeat => fraction(u),
            Self::Clamp if u >= 0.0 => u.min(1.0),
            Self::Clamp => 0.0,
            Self::Mirror => {
                let t = 2.0 * fraction(0.5 * u);
                if t > 1.0 { 2.0 - t } else { t }
            }
        }
    }
}

/// `u - floor(u)` in 0..=1, and 0 for NaN, infinity and wherever f32 has no fractions any more.
#[inline]
fn fraction(u: f32) -> f32 {
    if u.abs() < 8388608.0 {
        let whole = u as i32 as f32; // towards zero
        let rest = u - whole;
        if rest < 0.0 { rest + 1.0 } else { rest }
    } else {
        0.0
    }
}

/// The texel that holds `unit` of 0..=1.
#[inline]
fn nearest(unit: f32, size: u32) -> u32 {
    ((unit * size as f32) as u32).min(size - 1)
}

/// The two texels whose centres are about `u`, and how far it is from the first to the second.
#[inline]
fn around(wrap: Wrap, u: f32, size: u32) -> ([u32; 2], f32) {
    // Shifted by one texel, so that it is positive and truncation rounds down.
    let x = wrap.into_unit(u) * size as f32 + 0.5;
    let whole = (x as u32).min(size);
    let part = (x - whole as f32).clamp(0.0, 1.0);
    let last = size - 1;
    // `whole` counts from 1: 0 is left of the first texel's centre, `size` right of the last's.
    let (beyond_left, beyond_right) = match wrap {
        Wrap::Repeat => (last, 0),
        Wrap::Clamp | Wrap::Mirror => (0, last),
    };
    let left = if whole == 0 { beyond_left } else { whole - 1 };
    let right = if whole == size { beyond_right } else { whole };
    ([left, right], part)
}

#[inline]
fn mix(a: Vec4, b: Vec4, t: f32) -> Vec4 {
    a + (b - a) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A texture of one row, red rising by `step`.
    fn ramp(width: u8, step: u8, wrap: Wrap, filter: Filter) -> Texture {
        let texels = (0..width).map(|i| [i * step, 0, 0]).collect();
        let image = Image::of(width.into(), 1, texels);
        Texture::new(Arc::new(image), ColorSpace::Linear, [wrap; 2], filter)
    }

    fn red(texture: &Texture, u: f32) -> f32 {
        (texture.sample(Vec2::new(u, 0.5)).x * 255.0 * 16.0).round() / 16.0
    }

    #[test]
    fn bilinear_meets_the_texels_at_their_centres() {
        let texture = ramp(4, 10, Wrap::Clamp, Filter::Bilinear);
        for (u, expected) in [(0.125, 0.0), (0.375, 10.0), (0.5, 15.0), (0.875, 30.0)] {
            assert_eq!(red(&texture, u), expected, "at {u}");
        }
    }

    #[test]
    fn wrap_modes_differ_at_the_edge_only() {
        let at_edge = |wrap| red(&ramp(4, 10, wrap, Filter::Bilinear), 0.0);
        assert_eq!(at_edge(Wrap::Repeat), 15.0); // half way from 30 to 0
        assert_eq!(at_edge(Wrap::Clamp), 0.0);
        assert_eq!(at_edge(Wrap::Mirror), 0.0);

        let beyond = |wrap| red(&ramp(4, 10, wrap, Filter::Nearest), 1.3);
        assert_eq!(beyond(Wrap::Repeat), 10.0);
        assert_eq!(beyond(Wrap::Clamp), 30.0);
        assert_eq!(beyond(Wrap::Mirror), 20.0);
        let before = |wrap| red(&ramp(4, 10, wrap, Filter::Nearest), -0.3);
        assert_eq!(before(Wrap::Repeat), 20.0);
        assert_eq!(before(Wrap::Clamp), 0.0);
        assert_eq!(before(Wrap::Mirror), 10.0);
    }

    #[test]
    fn no_coordinate_leads_out_of_the_image() {
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e30, -1e30, -1e-30, 0.99999994];
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for filter in [Filter::Nearest, Filter::Bilinear] {
                for u in odd {
                    let value = ramp(3, 100, wrap, filter).sample(Vec2::new(u, -u));
                    assert!(value.is_finite(), "{wrap:?} {filter:?} {u}");
                }
            }
        }
    }

    #[test]
    fn srgb_is_decoded_and_alpha_is_not() {
        let image = Arc::new(Image::of(1, 1, vec![[188_u8, 0, 255, 128]]));
        let texture = Texture::new(image, ColorSpace::Srgb, [Wrap::Repeat; 2], Filter::Bilinear);
        let value = texture.sample(Vec2::ZERO);
        assert!((value.x - 0.502_886_5).abs() < 1e-6); // ((188/255 + 0.055) / 1.055)^2.4
        assert_eq!(value.z, 1.0);
        assert_eq!(value.w, 128.0 / 255.0);
    }

    #[test]
    fn sixteen_bits_keep_what_eight_would_lose() {
        let image = Arc::new(Image::of(1, 1, vec![[1_u16, 257, 0, 65535]]));
        let texture = Texture::new(image, ColorSpace::Linear, [Wrap::Repeat; 2], Filter::Nearest);
        let expected = Vec4::new(1.0 / 65535.0, 257.0 / 65535.0, 0.0, 1.0);
        assert_eq!(texture.sample(Vec2::ZERO), expected);
    }
}
