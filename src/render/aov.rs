//! AOVs: from the sums of pixels to the layers of a picture.

use std::ops::Deref;

use super::pixel::{Means, PixelSums};
use super::settings::{Aov, Settings};
use super::tile::Tile;
use crate::film::{Picture, Window};

/// Bytes that a picture of such settings takes while it is rendered, without scene and structure.
pub fn film_bytes(settings: &Settings) -> u64 {
    let channels = channels(settings).len() as u64;
    let pixel = PixelSums::bytes(settings.spp) + channels * size_of::<f32>() as u64;
    pixel.saturating_mul(settings.crop.area() as u64)
}

/// The name of a channel, and the value of a pixel in it.
type Channel = (String, Box<dyn Fn(&Means) -> f32>);

/// All channels that the settings ask for.
fn channels(settings: &Settings) -> Vec<Channel> {
    let mut channels: Vec<Channel> = Vec::new();
    let mut vector = |layer: &str, suffixes: &str, of: fn(&Means) -> [f64; 3]| {
        for (axis, suffix) in suffixes.chars().enumerate() {
            let name = if layer.is_empty() { String::new() } else { format!("{layer}.") };
            let value = move |means: &Means| of(means)[axis] as f32;
            channels.push((format!("{name}{suffix}"), Box::new(value)));
        }
    };
    vector("", "RGB", |means| means.radiance);
    for aov in &settings.aovs {
        match aov {
            Aov::Albedo => vector(aov.name(), "RGB", |means| means.albedo),
            Aov::Normal => vector(aov.name(), "XYZ", |means| means.normal),
            Aov::Position => vector(aov.name(), "XYZ", |means| means.position),
            Aov::Variance => vector(aov.name(), "RGB", |means| means.variance),
            Aov::Depth | Aov::Samples | Aov::Cost => {}
        }
    }
    for aov in &settings.aovs {
        let (suffix, of): (_, fn(&Means) -> f32) = match aov {
            Aov::Depth => ("Z", |means| means.distance as f32),
            Aov::Samples => ("Y", |means| means.count as f32),
            Aov::Cost => ("Y", |means| means.cost as f32),
            _ => continue,
        };
        channels.push((format!("{}.{suffix}", aov.name()), Box::new(of)));
    }
    let transparent = settings.transport.transparent;
    let alpha = move |means: &Means| if transparent { means.alpha as f32 } else { 1.0 };
    channels.push(("A".to_owned(), Box::new(alpha)));
    channels
}

/// Assembles the picture of what has been sampled.
pub(super) fn assemble_picture<T: Deref<Target = Tile>>(
    tiles: impl Iterator<Item = T>,
    settings: &Settings,
) -> Picture {
    let frame = Window::of_size(settings.resolution.0 as usize, settings.resolution.1 as usize);
    let layers = Layers::new(settings);
    let mut planes = layers.blank(settings.crop);
    for tile in tiles {
        layers.draw(&tile, settings.crop, &mut planes);
    }
    let mut picture = Picture::new(frame, settings.crop);
    for (name, plane) in layers.names().zip(planes) {
        picture.set_channel(name, plane);
    }
    picture
}

/// The channels of a picture, and how tiles are drawn into them.
pub(crate) struct Layers(Vec<Channel>);

impl Layers {
    /// All channels that the settings ask for.
    pub fn new(settings: &Settings) -> Self {
        Self(channels(settings))
    }

    /// The names of the channels.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(name, _)| &**name)
    }

    /// A plane for each channel, of the pixels of a window.
    pub fn blank(&self, window: Window) -> Vec<Vec<f32>> {
        vec![vec![0.0; window.area()]; self.0.len()]
    }

    /// Draws those rows of a tile that lie in a window, which is as wide as the tile or wider.
    pub fn draw(&self, tile: &Tile, window: Window, planes: &mut [Vec<f32>]) {
        for (x, y, sums) in tile.iter() {
            let (x, y) = (x as i32 - window.x0, y as i32 - window.y0);
            if y < 0 || y as usize >= window.height() {
                continue;
            }
            let (at, means) = (y as usize * window.width() + x as usize, sums.means());
            for (plane, (_, value)) in planes.iter_mut().zip(&self.0) {
                plane[at] = value(&means);
            }
        }
    }
}
