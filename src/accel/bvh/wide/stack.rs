//! What waits for a ray: keys (see [`crate::simd::order`]) and links, farthest at the bottom.

use fearless_simd::Simd;

use super::arena::Link;
use crate::simd::order::store_sorted;

/// Keys and links of the same places. At the bottom lies a key of zero.
pub struct Stack {
    keys: Box<[u32]>,
    links: Box<[u32]>,
}

impl Stack {
    /// Of so many places, the bottom's included.
    pub fn new(size: usize) -> Self {
        Self { keys: vec![0; size].into(), links: vec![0; size].into() }
    }

    /// Puts a node's children on top that the ray enters, the nearest uppermost.
    #[inline(always)]
    pub fn push<S: Simd, const W: usize>(
        &mut self,
        simd: S,
        keys: [u32; W],
        hits: u32,
        links: &[u32; W],
        top: &mut usize,
    ) {
        let to_keys = (&mut self.keys[*top..*top + W]).try_into().expect("W keys");
        let to_links = (&mut self.links[*top..*top + W]).try_into().expect("W links");
        store_sorted(simd, keys, hits, links, to_keys, to_links);
        *top += hits.count_ones() as usize;
    }

    /// As [`Stack::push`], but hands out the nearest; `None` if the ray enters none. A ray by
    /// itself gains by branches for one child and two, which are most often all.
    #[inline(always)]
    pub fn descend<S: Simd, const W: usize>(
        &mut self,
        simd: S,
        keys: &[u32; W],
        hits: u32,
        links: &[u32; W],
        top: &mut usize,
    ) -> Option<Link> {
        if hits == 0 {
            return None;
        }
        let first = hits.trailing_zeros() as usize % W;
        let others = hits & (hits - 1);
        if others == 0 {
            return Some(Link(links[first]));
        }
        if others & (others - 1) == 0 {
            let second = others.trailing_zeros() as usize % W;
            let swapped = keys[second] < keys[first];
            let (near, far) = if swapped { (second, first) } else { (first, second) };
            (self.keys[*top], self.links[*top]) = (keys[far], links[far]);
            *top += 1;
            return Some(Link(links[near]));
        }
        self.push(simd, *keys, hits, links, top);
        Some(self.pop(top).1)
    }

    /// Takes what is on top.
    #[inline(always)]
    pub fn pop(&self, top: &mut usize) -> (u32, Link) {
        *top -= 1;
        (self.keys[*top], Link(self.links[*top]))
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
