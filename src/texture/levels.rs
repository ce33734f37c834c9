//! Smaller versions of a texture's image, for what is seen from afar: each half as wide and high.
//!
//! Those that the image's file has are used. The rest is made from the last of them. There, a
//! texel is the mean of those that lie in it (a box filter), of linear values. Colours (sRGB) are
//! weighed by their alpha, so that what is clear lends no colour to what is not. Other data has its
//! plain mean: a normal is made a unit vector where it is used.

use std::collections::HashMap;
use std::sync::Arc;

use rayon::prelude::*;

use super::image::Image;
use super::store::TextureStore;
use super::texels::{Depth, Texels, Value};
use super::texture::Texture;
use super::transfer::{ColorSpace, Tables};
use crate::math::Vec4;

/// Gives textures their levels. Those that share an image and its meaning share them.
pub fn add_levels(textures: &mut [Texture], store: &TextureStore) {
    let key = |texture: &Texture| {
        (Arc::as_ptr(texture.image()) as usize, texture.color_space() == ColorSpace::Srgb)
    };
    let different: HashMap<_, &Texture> = textures.iter().map(|it| (key(it), it)).collect();
    let make = |(key, texture): (_, &Texture)| {
        (key, make_levels(texture.image(), texture.color_space(), store))
    };
    let levels: HashMap<_, Arc<[Arc<Image>]>> = different.into_par_iter().map(make).collect();
    for texture in textures {
        if let Some(levels) = levels.get(&key(texture)) {
            texture.set_levels(Arc::clone(levels));
        }
    }
}

/// The levels below an image, down to one texel.
fn make_levels(image: &Image, space: ColorSpace, store: &TextureStore) -> Arc<[Arc<Image>]> {
    let mut levels: Vec<Arc<Image>> = image.file_levels().to_vec();
    while let Some(half) = halve(levels.last().map_or(image, |level| level), space) {
        levels.push(store.keep(half));
    }
    levels.into()
}

/// An image half as wide and high; none of one texel.
fn halve(image: &Image, space: ColorSpace) -> Option<Image> {
    let size = [image.width(), image.height()];
    if size == [1, 1] {
        return None;
    }
    let tables = Tables::new(image.depth(), space);
    let texels = image.texels();
    let half = Halving { texels: &texels, size, channels: image.channels(), tables, space };
    let texels = match image.depth() {
        Depth::U8 => half.texels::<u8>(|value, table| nearest(table, value) as u8),
        Depth::U16 => half.texels::<u16>(|value, table| nearest(table, value) as u16),
        Depth::F32 => half.texels::<f32>(|value, _| value),
    };
    let [width, height] = half.halves();
    Some(Image::new(width, height, image.channels(), texels))
}

/// The number of the entry of a rising table that is nearest to a value.
fn nearest(table: &[f32], value: f32) -> usize {
    let above = table.partition_point(|&entry| entry < value).min(table.len() - 1);
    let below = above.saturating_sub(1);
    if value - table[below] < table[above] - value { below } else { above }
}

struct Halving<'a> {
    texels: &'a Texels,
    size: [u32; 2],
    channels: u8,
    tables: Tables,
    space: ColorSpace,
}

impl Halving<'_> {
    fn halves(&self) -> [u32; 2] {
        self.size.map(|side| (side / 2).max(1))
    }

    /// The texels of the half, whose linear values `store` makes stored ones.
    fn texels<T: Value>(&self, store: impl Fn(f32, &[f32]) -> T) -> Texels {
        let [width, height] = self.halves();
        let Tables { color, alpha } = self.tables;
        let mut values = Vec::with_capacity(width as usize * height as usize * 4);
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let mean = self.mean(x, y);
            let colors = if self.channels < 3 { 1 } else { 3 };
            values.extend(mean.to_array()[..colors].iter().map(|&value| store(value, color)));
            if self.channels.is_multiple_of(2) {
                values.push(store(mean.w, alpha));
            }
        }
        T::wrap(values)
    }

    /// The mean of the texels in one of the half.
    fn mean(&self, x: u32, y: u32) -> Vec4 {
        let [width, height] = self.halves();
        // Of sides that are odd, a texel in the middle may lie in two.
        let span = |at: u32, half: u32, of: u32| {
            let (at, half, of) = (u64::from(at), u64::from(half), u64::from(of));
            (at * of / half) as usize..((at + 1) * of).div_ceil(half) as usize
        };
        let (columns, rows) = (span(x, width, self.size[0]), span(y, height, self.size[1]));
        let (mut sum, mut weighed, mut count) = (Vec4::ZERO, Vec4::ZERO, 0.0);
        for row in rows {
            for column in columns.clone() {
                let at = row * self.size[0] as usize + column;
                let [texel] = self.tables.gather(self.texels, self.channels, [at]);
                (sum, weighed, count) = (sum + texel, weighed + texel * texel.w, count + 1.0);
            }
        }
        let mean = sum / count;
        if self.space == ColorSpace::Srgb && sum.w > 0.0 {
            return (weighed / sum.w).truncate().extend(mean.w);
        }
        mean
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec2;
    use crate::texture::{Filter, Wrap};

    fn halved<const N: usize>(size: [u32; 2], texels: &[[u8; N]], space: ColorSpace) -> Vec<u8> {
        let image = Image::of(size[0], size[1], texels.to_vec());
        let half = halve(&image, space).expect("more than one texel");
        half.texels().as_bytes().to_vec()
    }

    #[test]
    fn texels_are_means_of_linear_values() {
        let linear = halved([2, 2], &[[0], [100], [50], [51]], ColorSpace::Linear);
        assert_eq!(linear, [50]);
        // Black and white are half the light, which sRGB writes as 188.
        assert_eq!(halved([2, 1], &[[0], [255]], ColorSpace::Srgb), [188]);
        // The texel in the middle counts for both.
        let odd = halved([5, 1], &[[0], [0], [90], [90], [90]], ColorSpace::Linear);
        assert_eq!(odd, [30, 90]);
        let both = [[200, 0, 0, 254], [0, 200, 0, 0]];
        assert_eq!(halved([1, 2], &both, ColorSpace::Srgb), [200, 0, 0, 127]);
        assert_eq!(halved([2, 1], &both, ColorSpace::Linear), [100, 100, 0, 127]);
        assert!(halve(&Image::of(1, 1, vec![[1.0_f32]]), ColorSpace::Linear).is_none());
    }

    /// Whole and in tiles alike.
    #[test]
    fn levels_of_the_file_come_first_and_the_last_of_them_makes_the_rest() {
        let of =
            |side: u32, value: u8| Image::of(side, side, vec![[value]; (side * side) as usize]);
        let make = || of(128, 7).with_file_levels(vec![Arc::new(of(64, 50)), Arc::new(of(32, 90))]);
        for limit in [u64::MAX, 0] {
            let store = TextureStore::new(limit);
            let image = store.keep(make());
            assert_eq!(image.is_tiled(), limit == 0);
            assert!(*image == make() && image.digest() == make().digest());
            assert_ne!(image.digest(), of(128, 7).digest());
            let wrap = [Wrap::Repeat; 2];
            let texture = Texture::new(image, ColorSpace::Linear, wrap, Filter::Nearest);
            let mut textures = [texture];
            add_levels(&mut textures, &store);
            for (over, expected) in [(1, 7), (2, 50), (4, 90), (8, 90), (500, 90)] {
                let value = textures[0].sample_over(Vec2::new(0.3, 0.6), over as f32 / 128.0);
                assert_eq!(value.x, f32::from(expected as u8) / 255.0, "{over}");
            }
            // The image, its two levels and six more.
            let figures = store.figures();
            assert_eq!((figures.images, figures.tiled), (8, if limit == 0 { 2 } else { 0 }));
        }
    }

    #[test]
    fn every_stored_value_is_its_own_nearest() {
        for (depth, last) in [(Depth::U8, 255), (Depth::U16, 65535)] {
            for space in [ColorSpace::Srgb, ColorSpace::Linear] {
                let table = Tables::new(depth, space).color;
                assert!((0..=last).all(|number| nearest(table, table[number]) == number));
                assert_eq!((nearest(table, -1.0), nearest(table, 2.0)), (0, last));
            }
        }
    }

    #[test]
    fn wider_footprints_see_smaller_levels() {
        let texels = (0..64).map(|i| [if i % 2 == 0 { 255_u8 } else { 1 }]).collect();
        let image = Arc::new(Image::of(8, 8, texels));
        let (repeat, filter) = ([Wrap::Repeat; 2], Filter::Bilinear);
        let plain = Texture::new(image, ColorSpace::Linear, repeat, filter);
        let mut textures = [plain.clone(), plain.clone()];
        add_levels(&mut textures, &TextureStore::default());
        let [texture, other] = &textures;
        assert!(texture.has_levels() && other.has_levels() && !plain.has_levels());
        let at = Vec2::new(1.0 / 16.0, 1.0 / 16.0);
        let of = |footprint: f32| texture.sample_over(at, footprint).x;
        // Up to a texel, the image itself, bit by bit.
        assert_eq!(of(0.125), texture.sample(at).x);
        assert_eq!(plain.sample_over(at, 0.9), plain.sample(at));
        let grey = 128.0 / 255.0;
        for footprint in [0.25, 0.3, 1.0, 50.0] {
            assert!((of(footprint) - grey).abs() < 1e-6, "{footprint}");
        }
        let between = of(0.125 * std::f32::consts::SQRT_2);
        assert!((between - 0.5 * (1.0 + grey)).abs() < 1e-5, "{between}");
        assert!(of(f32::NAN).is_finite() && of(f32::INFINITY).is_finite());
    }
}
