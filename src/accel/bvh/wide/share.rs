//! Small leaves side by side in one block.
//!
//! Where the surface area heuristic says how many triangles a leaf has, a fifth of its block is
//! empty in the mean. So leaves share blocks with others near them, as many as fit. Their boxes and
//! links stay their own, and links of leaves that share lead to the same block: a ray that comes
//! for one is offered the triangles of the others as well. That changes no hit, since all that is
//! offered is held against the exact test, and the smallest `(t, id)` wins. What is spared is
//! memory, and with it the time that rays wait for it.

use crate::math::PrimId;

/// A leaf shares with one of the last so many blocks: near in memory is near in space.
const NEAR: u32 = 64;

/// Leaves in blocks.
pub struct SharedBlocks {
    /// Triangles, block by block.
    pub order: Vec<PrimId>,
    /// First place and number of triangles of each block.
    pub blocks: Vec<(u32, u32)>,
    /// Of each leaf its block.
    pub block_of: Vec<u32>,
}

impl SharedBlocks {
    /// Puts leaves into blocks of up to `W` triangles, each into the fullest near one that has
    /// room. `leaves` are first place and number of their triangles in `order`; one that holds what
    /// `is_alone` shares with none.
    pub fn new<const W: usize>(
        leaves: &[(u32, u32)],
        order: &[PrimId],
        is_alone: impl Fn(PrimId) -> bool,
    ) -> Self {
        let ids = |&(first, count): &(u32, u32)| &order[first as usize..][..count as usize];
        let mut filling = Filling::<W> { counts: Vec::new(), with_room: [const { Vec::new() }; W] };
        let place = |leaf| filling.place(leaf, ids(leaf).iter().any(|&id| is_alone(id)));
        let block_of: Vec<u32> = leaves.iter().map(place).collect();
        let mut end = 0;
        let mut blocks = Vec::with_capacity(filling.counts.len());
        for count in filling.counts {
            blocks.push((end, 0));
            end += count;
        }
        let mut shared = vec![PrimId::NONE; end as usize];
        for (leaf, &block) in leaves.iter().zip(&block_of) {
            let (first, count) = &mut blocks[block as usize];
            shared[(*first + *count) as usize..][..leaf.1 as usize].copy_from_slice(ids(leaf));
            *count += leaf.1;
        }
        Self { order: shared, blocks, block_of }
    }
}

/// Blocks of up to `W` triangles while leaves are put into them.
struct Filling<const W: usize> {
    /// How many triangles each has.
    counts: Vec<u32>,
    /// Those that have room for so many more, the last one last.
    with_room: [Vec<u32>; W],
}

impl<const W: usize> Filling<W> {
    /// The block that a leaf is put into.
    fn place(&mut self, &(_, count): &(u32, u32), is_alone: bool) -> u32 {
        let found = if is_alone { None } else { self.take_fullest(count as usize) };
        let block = found.unwrap_or_else(|| {
            self.counts.push(0);
            self.counts.len() as u32 - 1
        });
        self.counts[block as usize] += count;
        let room = W - self.counts[block as usize] as usize;
        if room > 0 && !is_alone {
            self.with_room[room].push(block);
        }
        block
    }

    /// Takes the fullest near block that has room for so many.
    fn take_fullest(&mut self, count: usize) -> Option<u32> {
        let nearest = (self.counts.len() as u32).saturating_sub(NEAR);
        self.with_room.iter_mut().skip(count).find_map(|blocks| {
            let block = blocks.pop_if(|&mut block| block >= nearest);
            if block.is_none() {
                // Most of them are far.
                blocks.clear();
            }
            block
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leaves_of(counts: &[u32]) -> Vec<(u32, u32)> {
        let mut first = 0;
        let mut leaf = |&count: &u32| {
            first += count;
            (first - count, count)
        };
        counts.iter().map(&mut leaf).collect()
    }

    #[test]
    fn leaves_fill_the_fullest_block_that_has_room_and_some_stay_alone() {
        let order: Vec<PrimId> = (0..24).map(PrimId).collect();
        let leaves = leaves_of(&[3, 5, 4, 8, 2, 1, 1]);
        let shared = SharedBlocks::new::<8>(&leaves, &order, |id| id.0 == 23);
        assert_eq!(shared.block_of, [0, 0, 1, 2, 1, 1, 3]);
        assert_eq!(shared.blocks, [(0, 8), (8, 7), (15, 8), (23, 1)]);
        let ids = |block: usize| {
            let (first, count) = shared.blocks[block];
            shared.order[first as usize..][..count as usize].iter().map(|id| id.0)
        };
        assert!(ids(0).eq(0..8));
        assert!(ids(1).eq([8, 9, 10, 11, 20, 21, 22]));
        assert!(ids(2).eq(12..20) && ids(3).eq([23]));
    }

    #[test]
    fn leaves_share_with_near_blocks_alone() {
        let counts: Vec<u32> = [1].into_iter().chain([8; 70]).chain([2]).collect();
        let order: Vec<PrimId> = (0..counts.iter().sum()).map(PrimId).collect();
        let shared = SharedBlocks::new::<8>(&leaves_of(&counts), &order, |_| false);
        assert_eq!(shared.blocks.len(), 72);
    }
}
