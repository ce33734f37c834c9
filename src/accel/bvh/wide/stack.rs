//! What waits for a ray: keys (see `simd::order`) and links, farthest at the bottom.

use fearless_simd::Simd;

use crate::accel::bvh::link::Link;
use crate::accel::bvh::sah;
use crate::simd::order::{store_keys, store_listed};

/// Stripes of a stack. A level puts `W` aside and takes one of them, and the last store is a whole
/// vector: with one stripe for the bottom, that is enough for any tree that builders make.
const STRIPES: usize = 128;
const _: () = assert!(sah::MAX_DEPTH < DEEPEST);

/// The deepest that a walk may go, over all trees that it goes through.
pub const DEEPEST: usize = STRIPES - 2;

/// In which order a node's children go on the stack.
#[derive(Clone, Copy)]
pub enum Sorting {
    /// As they come: any hit will do.
    None,
    /// The nearest uppermost.
    ByDistance,
    /// The last of a list of lanes uppermost, see `octants`.
    Listed(u64),
}

/// Keys and links of the same places. At the bottom lies a key of zero.
///
/// Of a fixed size, and places are taken modulo that: so they need not be checked.
pub struct Stack<const W: usize> {
    keys: [[u32; W]; STRIPES + 1],
    links: [[u32; W]; STRIPES + 1],
}

impl<const W: usize> Default for Stack<W> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const W: usize> Stack<W> {
    /// Places, a power of two.
    const SIZE: usize = STRIPES * W;

    /// With nothing but the bottom.
    pub const fn new() -> Self {
        Self { keys: [[0; W]; STRIPES + 1], links: [[0; W]; STRIPES + 1] }
    }

    /// Puts a node's children on top that the ray enters.
    #[inline(always)]
    pub fn push<S: Simd>(
        &mut self,
        simd: S,
        sorting: Sorting,
        keys: [u32; W],
        hits: u32,
        links: &[u32; W],
        top: &mut usize,
    ) {
        let place = *top % Self::SIZE;
        let to_keys = &mut self.keys.as_flattened_mut()[place..place + W];
        let to_links = &mut self.links.as_flattened_mut()[place..place + W];
        let to_keys = to_keys.try_into().expect("W keys");
        let to_links = to_links.try_into().expect("W links");
        match sorting {
            Sorting::None => store_keys::<false, S, W>(simd, keys, hits, links, to_keys, to_links),
            Sorting::ByDistance => {
                store_keys::<true, S, W>(simd, keys, hits, links, to_keys, to_links);
            }
            Sorting::Listed(list) => store_listed(simd, keys, list, links, to_keys, to_links),
        }
        *top += hits.count_ones() as usize;
    }

    /// As [`Stack::push`], but hands out the uppermost; `None` if the ray enters none. A ray by
    /// itself gains by branches for one child and two, which are most often all.
    #[inline(always)]
    pub fn descend<S: Simd>(
        &mut self,
        simd: S,
        sorting: Sorting,
        keys: &[u32; W],
        hits: u32,
        links: &[u32; W],
        top: &mut usize,
    ) -> Option<Link> {
        if hits == 0 {
            return None;
        }
        if let Sorting::Listed(_) = sorting {
            self.push(simd, sorting, *keys, hits, links, top);
            return Some(self.pop(top).1);
        }
        let first = hits.trailing_zeros() as usize % W;
        let others = hits & (hits - 1);
        if others == 0 {
            return Some(Link(links[first]));
        }
        if others.is_power_of_two() {
            let second = others.trailing_zeros() as usize % W;
            let swapped = keys[second] < keys[first];
            let (near, far) = if swapped { (second, first) } else { (first, second) };
            self.keys.as_flattened_mut()[*top % Self::SIZE] = keys[far];
            self.links.as_flattened_mut()[*top % Self::SIZE] = links[far];
            *top += 1;
            return Some(Link(links[near]));
        }
        self.push(simd, sorting, *keys, hits, links, top);
        Some(self.pop(top).1)
    }

    /// Puts one link on top.
    #[inline(always)]
    pub fn put(&mut self, key: u32, link: Link, top: &mut usize) {
        let place = *top % Self::SIZE;
        (self.keys.as_flattened_mut()[place], self.links.as_flattened_mut()[place]) = (key, link.0);
        *top += 1;
    }

    /// Takes what is on top.
    #[inline(always)]
    pub fn pop(&self, top: &mut usize) -> (u32, Link) {
        *top -= 1;
        let place = *top % Self::SIZE;
        (self.keys.as_flattened()[place], Link(self.links.as_flattened()[place]))
    }

    /// What is on top, whatever it is.
    #[inline(always)]
    pub fn peek(&self, top: usize) -> Link {
        Link(self.links.as_flattened()[(top - 1) % Self::SIZE])
    }

    /// Takes the uppermost whose key is not above a limit; `None` at the bottom.
    #[inline(always)]
    pub fn next(&self, top: &mut usize, limit: u32) -> Option<Link> {
        loop {
            // The key at the bottom is below any limit.
            let (key, link) = self.pop(top);
            if key <= limit {
                return (key != 0).then_some(link);
            }
        }
    }
}
