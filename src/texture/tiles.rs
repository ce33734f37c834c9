//! Images cut into tiles, which a cache keeps.

use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::cache::{MOST_AT_HAND, Row, TileCache};
use super::pack::{self, Packed, SIDE};
use super::ring::mix;
use super::texels::{Depth, Texels};
use super::transfer::Tables;
use crate::math::Vec4;

/// Bits of a key that number a tile within its image.
const TILE_BITS: u32 = 20;

/// The number of the next image.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// A tile that a thread has for itself; no bytes: none.
struct AtHand {
    key: u64,
    tile: Vec<u8>,
}

thread_local! {
    /// What this thread has looked at lately, each where its key leads.
    static AT_HAND: RefCell<[AtHand; MOST_AT_HAND]> =
        const { RefCell::new([const { AtHand { key: 0, tile: Vec::new() } }; MOST_AT_HAND]) };
}

/// The texels of an image, in tiles.
pub struct Tiles {
    cache: Arc<TileCache>,
    /// Tells its tiles from those of other images.
    first_key: u64,
    width: u32,
    height: u32,
    /// Tiles across.
    columns: u32,
    channels: u8,
    depth: Depth,
    /// Its rows of tiles.
    rows: Vec<Row>,
}

impl fmt::Debug for Tiles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Tiles({} x {}, {} x {:?})", self.width, self.height, self.channels, self.depth)
    }
}

impl Tiles {
    /// Cuts `texels`, of so many columns, rows and channels.
    pub fn cut(
        texels: &Texels,
        [width, height]: [u32; 2],
        channels: u8,
        cache: Arc<TileCache>,
    ) -> Self {
        let columns = width.div_ceil(SIDE);
        let depth = texels.depth();
        let texel = usize::from(channels) * depth.bits() as usize / 8;
        let (bytes, stride) = (texels.as_bytes(), width as usize * texel);
        let mut packed = Packed::new();
        let cut_row = |row: u32| {
            for column in 0..columns {
                let (x, y) = (column * SIDE, row * SIDE);
                let first = &bytes[y as usize * stride + x as usize * texel..];
                let size = [SIDE.min(width - x), SIDE.min(height - y)].map(|side| side as usize);
                if size == [SIDE as usize; 2] {
                    packed.push(first, stride, texel);
                } else {
                    packed.push(&filled(first, stride, texel, size), SIDE as usize * texel, texel);
                }
            }
            cache.keep(&mut packed)
        };
        let rows = (0..height.div_ceil(SIDE)).map(cut_row).collect();
        let first_key = NEXT.fetch_add(1, Relaxed) << TILE_BITS;
        Self { cache, first_key, width, height, columns, channels, depth, rows }
    }

    /// Of what kind the values are.
    pub fn depth(&self) -> Depth {
        self.depth
    }

    /// The linear values of texels at columns and rows within the image.
    #[inline(never)]
    pub(super) fn gather<const K: usize>(&self, tables: Tables, at: [(u32, u32); K]) -> [Vec4; K] {
        let tile = |(x, y): (u32, u32)| y / SIDE * self.columns + x / SIDE;
        let within = |(x, y): (u32, u32)| [x % SIDE, y % SIDE];
        let (depth, channels) = (self.depth, self.channels);
        let first = tile(at[0]);
        if at.iter().all(|&at| tile(at) == first) {
            let at = at.map(within);
            return self.look(first, |tile| tables.gather_packed(tile, depth, channels, at));
        }
        at.map(|at| {
            let within = [within(at)];
            let [texel] =
                self.look(tile(at), |tile| tables.gather_packed(tile, depth, channels, within));
            texel
        })
    }

    /// All texels, row by row from the top.
    pub fn to_texels(&self) -> Texels {
        let (width, height) = (self.width as usize, self.height as usize);
        let mut all = self.depth.zeros(width * height * usize::from(self.channels));
        let texel = self.texel_bytes();
        let (bytes, mut tile) = (all.as_bytes_mut(), Vec::new());
        for number in 0..self.rows.len() as u32 * self.columns {
            self.get(number, &mut tile);
            let (left, top) = (number % self.columns * SIDE, number / self.columns * SIDE);
            let across = SIDE.min(self.width - left) as usize * texel;
            for y in 0..SIDE.min(self.height - top) {
                let to = ((top + y) as usize * width + left as usize) * texel;
                for (x, bytes) in bytes[to..to + across].chunks_exact_mut(texel).enumerate() {
                    pack::texel(&tile, [x as u32, y], bytes);
                }
            }
        }
        all
    }

    /// Bytes of a texel.
    fn texel_bytes(&self) -> usize {
        usize::from(self.channels) * self.depth.bits() as usize / 8
    }

    /// Looks into a tile. Those that the thread has at hand need no lock.
    #[inline]
    fn look<R>(&self, number: u32, look: impl FnOnce(&[u8]) -> R) -> R {
        let key = self.first_key | u64::from(number);
        let slot = mix(key) as usize & (self.cache.at_hand() - 1);
        AT_HAND.with_borrow_mut(|at_hand| {
            let at_hand = &mut at_hand[slot];
            if at_hand.key != key || at_hand.tile.is_empty() {
                at_hand.key = key;
                self.get(number, &mut at_hand.tile);
            }
            look(&at_hand.tile)
        })
    }

    /// Makes `tile` the one of such a number.
    fn get(&self, number: u32, tile: &mut Vec<u8>) {
        let key = self.first_key | u64::from(number);
        let (row, column) = (number / self.columns, number % self.columns);
        self.cache.get(key, &self.rows[row as usize], column as usize, self.texel_bytes(), tile);
    }
}

/// A tile of which an image has `size` texels across and down: the last ones are there again.
/// `first` begins with its first texel, and its rows are `stride` bytes apart.
fn filled(first: &[u8], stride: usize, texel: usize, [across, down]: [usize; 2]) -> Vec<u8> {
    let side = SIDE as usize;
    let mut tile = Vec::with_capacity(side * side * texel);
    for y in 0..side {
        let row = &first[y.min(down - 1) * stride..][..across * texel];
        tile.extend_from_slice(row);
        for _ in across..side {
            tile.extend_from_slice(&row[(across - 1) * texel..]);
        }
    }
    tile
}
