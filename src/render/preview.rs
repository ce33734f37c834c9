//! A look at a picture that is not there yet.

use std::ops::Deref;

use super::settings::Settings;
use super::tile::{SIDE, Tile};
use crate::film::{Picture, Window};

/// The channels of a preview.
const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// The colours of some tiles, row by row; a tile without samples shows the mean of the nearest one
/// that has some.
pub(super) fn assemble_preview<T: Deref<Target = Tile>>(
    tiles: impl Iterator<Item = T>,
    settings: &Settings,
) -> Picture {
    let crop = settings.crop;
    let mut planes = vec![vec![0.0_f32; crop.area()]; CHANNELS.len()];
    let (mut windows, mut means) = (Vec::new(), Vec::new());
    for tile in tiles {
        windows.push(tile.window);
        means.push((!tile.range.is_empty()).then(|| draw(&tile, settings, &mut planes)));
    }
    let side = SIDE as i32;
    let columns = ((crop.x1 - 1) / side - crop.x0 / side + 1) as usize;
    for (at, colour) in fill(&means, columns) {
        for (x, y) in pixels(windows[at]) {
            for (plane, value) in planes.iter_mut().zip(colour) {
                plane[place(crop, x, y)] = value;
            }
        }
    }
    let frame = Window::of_size(settings.resolution.0 as usize, settings.resolution.1 as usize);
    let mut picture = Picture::new(frame, crop);
    for (name, plane) in CHANNELS.into_iter().zip(planes) {
        picture.set_channel(name, plane);
    }
    picture
}

/// Draws a tile and returns the mean of its colours.
fn draw(tile: &Tile, settings: &Settings, planes: &mut [Vec<f32>]) -> [f32; 4] {
    let mut sum = [0.0_f64; 4];
    for (x, y, sums) in tile.iter() {
        let means = sums.means();
        let [red, green, blue] = means.radiance;
        let alpha = if settings.transport.transparent { means.alpha } else { 1.0 };
        let at = place(settings.crop, x as i32, y as i32);
        for (c, value) in [red, green, blue, alpha].into_iter().enumerate() {
            planes[c][at] = value as f32;
            sum[c] += value;
        }
    }
    sum.map(|sum| (sum / tile.window.area() as f64) as f32)
}

/// The colours of those tiles that have none, from the nearest ones that have; none if no tile has.
fn fill(means: &[Option<[f32; 4]>], columns: usize) -> Vec<(usize, [f32; 4])> {
    let mut colours = means.to_vec();
    let mut reached: Vec<usize> = (0..means.len()).filter(|&at| means[at].is_some()).collect();
    let mut filled = Vec::new();
    while !reached.is_empty() {
        let mut next = Vec::new();
        for from in reached {
            let Some(colour) = colours[from] else { continue };
            for at in neighbours(from, columns, means.len()) {
                if colours[at].is_none() {
                    colours[at] = Some(colour);
                    filled.push((at, colour));
                    next.push(at);
                }
            }
        }
        reached = next;
    }
    filled
}

/// The tiles on the four sides of a tile.
fn neighbours(at: usize, columns: usize, count: usize) -> impl Iterator<Item = usize> {
    let column = at % columns;
    [
        (column > 0).then(|| at - 1),
        (column + 1 < columns).then(|| at + 1),
        at.checked_sub(columns),
        Some(at + columns).filter(|&below| below < count),
    ]
    .into_iter()
    .flatten()
}

fn pixels(window: Window) -> impl Iterator<Item = (i32, i32)> {
    (window.y0..window.y1).flat_map(move |y| (window.x0..window.x1).map(move |x| (x, y)))
}

fn place(crop: Window, x: i32, y: i32) -> usize {
    (y - crop.y0) as usize * crop.width() + (x - crop.x0) as usize
}

#[cfg(test)]
mod tests {
    use super::super::tile::tile_windows;
    use super::*;
    use crate::math::Vec3;

    #[test]
    fn what_is_not_there_yet_is_filled_from_what_is_nearest() {
        let settings = Settings::new(64, 40);
        let mut tiles: Vec<Tile> =
            tile_windows(settings.crop).into_iter().map(|window| Tile::new(window, 0)).collect();
        for (at, level) in [(0, 1.0), (3, 2.0)] {
            tiles[at].pixels.iter_mut().for_each(|sums| sums.add(Vec3::splat(level), None));
            tiles[at].range.end = 1;
        }
        let picture = assemble_preview(tiles.iter(), &settings);
        let red = picture.channel("R").expect("there");
        let at = |x: usize, y: usize| red[y * 64 + x];
        assert_eq!([at(0, 0), at(31, 0), at(33, 39), at(63, 39)], [1.0, 1.0, 2.0, 2.0]);
        assert_eq!(at(0, 39), 1.0);
        let empty = assemble_preview(std::iter::empty::<&Tile>(), &settings);
        assert!(empty.channel("G").expect("there").iter().all(|&value| value == 0.0));
    }
}
