//! Images cut into tiles, which a cache keeps.

use std::cell::RefCell;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use super::cache::{MOST_AT_HAND, Place, TileCache, mix};
use super::pack::Packed;
use super::texels::{Depth, Texels};
use super::transfer::Tables;
use crate::math::Vec4;

/// Texels across and down a tile. Those beyond an image's edge are zero and are never looked at.
///
/// Paths that have bounced ask for tiles at random, so that a small one is the better one.
pub(super) const SIDE: u32 = 32;

/// Bits of a key that number a tile within its image.
const TILE_BITS: u32 = 20;

/// The number of the next image.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// Tiles, each with its key.
type AtHand = [Option<(u64, Arc<Texels>)>; MOST_AT_HAND];

thread_local! {
    /// What this thread has looked at lately, each where its key leads.
    static AT_HAND: RefCell<AtHand> = const { RefCell::new([const { None }; MOST_AT_HAND]) };
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
    places: Vec<Place>,
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
        let (columns, rows) = (width.div_ceil(SIDE), height.div_ceil(SIDE));
        let depth = texels.depth();
        let texel = usize::from(channels) * depth.bits() as usize / 8;
        let bytes = texels.as_bytes();
        let mut tile = vec![0; (SIDE * SIDE) as usize * texel];
        let mut places = Vec::with_capacity((columns * rows) as usize);
        let mut packed = Packed::default();
        for row in 0..rows {
            for column in 0..columns {
                let (x, y) = (column * SIDE, row * SIDE);
                let (across, down) = (SIDE.min(width - x), SIDE.min(height - y));
                if across < SIDE || down < SIDE {
                    tile.fill(0);
                }
                let across = across as usize * texel;
                for line in 0..down {
                    let from = ((y + line) as usize * width as usize + x as usize) * texel;
                    let to = (line * SIDE) as usize * texel;
                    tile[to..to + across].copy_from_slice(&bytes[from..from + across]);
                }
                packed.push(&tile);
            }
            places.extend(cache.keep(&mut packed));
        }
        let first_key = NEXT.fetch_add(1, Relaxed) << TILE_BITS;
        Self { cache, first_key, width, height, columns, channels, depth, places }
    }

    /// Of what kind the values are.
    pub fn depth(&self) -> Depth {
        self.depth
    }

    /// The linear values of texels at columns and rows within the image.
    #[inline(never)]
    pub(super) fn gather<const K: usize>(&self, tables: Tables, at: [(u32, u32); K]) -> [Vec4; K] {
        let tile = |(x, y): (u32, u32)| y / SIDE * self.columns + x / SIDE;
        let within = |(x, y): (u32, u32)| (y % SIDE * SIDE + x % SIDE) as usize;
        let first = tile(at[0]);
        if at.iter().all(|&at| tile(at) == first) {
            return self.look(first, |texels| tables.gather(texels, self.channels, at.map(within)));
        }
        at.map(|at| {
            let [texel] =
                self.look(tile(at), |texels| tables.gather(texels, self.channels, [within(at)]));
            texel
        })
    }

    /// All texels, row by row from the top.
    pub fn to_texels(&self) -> Texels {
        let count = self.width as usize * self.height as usize * usize::from(self.channels);
        let mut all = self.depth.zeros(count);
        let texel = usize::from(self.channels) * self.depth.bits() as usize / 8;
        let bytes = all.as_bytes_mut();
        for number in 0..self.places.len() as u32 {
            let tile = self.tile(number);
            let (x, y) = (number % self.columns * SIDE, number / self.columns * SIDE);
            let across = SIDE.min(self.width - x) as usize * texel;
            for down in 0..SIDE.min(self.height - y) {
                let to = ((y + down) as usize * self.width as usize + x as usize) * texel;
                let from = (down * SIDE) as usize * texel;
                bytes[to..to + across].copy_from_slice(&tile.as_bytes()[from..from + across]);
            }
        }
        all
    }

    /// Looks into a tile. Those that the thread has at hand need no lock.
    #[inline]
    fn look<R>(&self, number: u32, look: impl FnOnce(&Texels) -> R) -> R {
        let key = self.first_key | u64::from(number);
        let slot = mix(key) as usize & (self.cache.at_hand() - 1);
        AT_HAND.with_borrow_mut(|at_hand| match &mut at_hand[slot] {
            Some((known, tile)) if *known == key => look(tile),
            slot => {
                let tile = self.tile(number);
                let found = look(&tile);
                *slot = Some((key, tile));
                found
            }
        })
    }

    fn tile(&self, number: u32) -> Arc<Texels> {
        let key = self.first_key | u64::from(number);
        let count = (SIDE * SIDE) as usize * usize::from(self.channels);
        self.cache.tile(key, &self.places[number as usize], self.depth, count)
    }
}
