//! The order of work: which samples in which pass, which tiles first.

use std::ops::Range;

use crate::film::Window;
use crate::sampling::BLOCK;

use super::tile::SIDE;

/// The paths from which on a pass of 16 samples takes so long that one of a single sample comes
/// first: so the whole frame is there after a second or two.
const LONG_PASS: u64 = 1 << 21;

/// By how much the samples of a pixel grow from pass to pass: a power of two, so that their sums
/// are few nodes.
#[derive(Clone, Copy)]
pub(super) enum Growth {
    /// Twofold.
    Usual,
    /// Fourfold at least: where each pass reads the tiles of textures anew.
    Fast,
}

/// The sample at which each pass over a run of samples ends, beyond `done`. `pixels` tells whether
/// the first pass is to be a short one.
pub(super) fn pass_ends(run: Range<u64>, done: u64, pixels: u64, growth: Growth) -> Vec<u64> {
    let first = (pixels * BLOCK >= LONG_PASS).then_some(1);
    // The last pass but one ends where at least half as many samples are left.
    let (factor, last) = match growth {
        Growth::Usual => (2, run.end),
        Growth::Fast => (4, run.start + (run.end - run.start).div_ceil(2)),
    };
    let growing = std::iter::successors(Some(BLOCK), |length| length.checked_mul(factor));
    let ends = first.into_iter().chain(growing).map(|length| run.start.saturating_add(length));
    ends.take_while(|&pass| pass < last).filter(|&pass| pass > done).chain([run.end]).collect()
}

/// The order in which tiles are taken: first one of every 8x8, then one of every 4x4, and so on, so
/// that a part of them shows all of the frame, coarsely.
pub(super) fn spread(windows: impl Iterator<Item = Window>) -> Vec<usize> {
    let rank = |window: Window| {
        let cell = (window.x0 as u32 / SIDE) | (window.y0 as u32 / SIDE);
        3 - cell.trailing_zeros().min(3)
    };
    let ranks: Vec<u32> = windows.map(rank).collect();
    let mut order: Vec<usize> = (0..ranks.len()).collect();
    order.sort_by_key(|&tile| ranks[tile]);
    order
}

#[cfg(test)]
mod tests {
    use super::super::tile::tile_windows;
    use super::*;

    #[test]
    fn passes_grow_and_end_at_the_last_sample() {
        let ends = |run, done, pixels| pass_ends(run, done, pixels, Growth::Usual);
        assert_eq!(ends(0..1, 0, 1), [1]);
        assert_eq!(ends(0..16, 0, 1), [16]);
        assert_eq!(ends(0..100, 0, 1), [16, 32, 64, 100]);
        assert_eq!(ends(0..100, 16, 1), [32, 64, 100]);
        assert_eq!(ends(0..24, 20, 1), [24]);
        assert_eq!(ends(64..200, 70, 1), [80, 96, 128, 192, 200]);
        assert_eq!(ends(0..40, 0, 1 << 20), [1, 16, 32, 40]);
        let ends = |run, done, pixels| pass_ends(run, done, pixels, Growth::Fast);
        assert_eq!(ends(0..16, 0, 1), [16]);
        assert_eq!(ends(0..100, 0, 1), [16, 100]);
        assert_eq!(ends(100..420, 0, 1 << 20), [101, 116, 164, 420]);
        assert_eq!(ends(0..320, 64, 1), [320]);
    }

    #[test]
    fn the_first_tiles_are_spread_over_the_frame() {
        let windows = tile_windows(Window::of_size(512, 256));
        let order = spread(windows.iter().copied());
        let first: Vec<_> = order[..8].iter().map(|&at| (windows[at].x0, windows[at].y0)).collect();
        let expected: Vec<_> = (0..8).map(|at| (at % 4 * 128, at / 4 * 128)).collect();
        assert_eq!(first, expected);
        let mut sorted = order;
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..windows.len()));
    }
}
