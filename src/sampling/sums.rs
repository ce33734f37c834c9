//! Sums of samples whose bits do not depend on how the samples were split up.
//!
//! Floating-point addition is not associative: a mean of means, or a sum in another order, has
//! other bits. So the order is fixed once: sixteen consecutive samples are one block, summed in
//! their order; block k is leaf k of a binary tree whose inner nodes add their left and right
//! child. A run of blocks is kept as the few largest whole subtrees that fill it, and two adjacent
//! runs are joined by adding siblings only. Whatever the cuts, the same nodes come out.

use thiserror::Error;

/// Samples in a block. A run of samples can be cut at multiples of it.
pub const BLOCK: u64 = 16;

/// Two runs that do not follow one another.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("samples from {found} on do not follow those up to {expected}")]
pub struct NotAdjacent {
    /// The sample at which the earlier run ends.
    pub expected: u64,
    /// The sample at which the later run starts.
    pub found: u64,
}

/// Sum, sum of squares and number of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Moments<const C: usize, const V: usize> {
    sum: [f64; C],
    squares: [f64; V],
    count: u64,
}

impl<const C: usize, const V: usize> Moments<C, V> {
    const ZERO: Self = Self { sum: [0.0; C], squares: [0.0; V], count: 0 };

    fn add(&self, other: &Self) -> Self {
        Self {
            sum: std::array::from_fn(|c| self.sum[c] + other.sum[c]),
            squares: std::array::from_fn(|c| self.squares[c] + other.squares[c]),
            count: self.count + other.count,
        }
    }
}

/// A whole subtree: the blocks `index << level .. (index + 1) << level`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node<const C: usize, const V: usize> {
    level: u32,
    index: u64,
    moments: Moments<C, V>,
}

/// The sums of one pixel over a run of samples, in `C` channels; the first `V` of them, which must
/// not be more, have a variance.
///
/// Memory is two nodes per doubling of the run's length at most.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockSums<const C: usize, const V: usize> {
    first: u64,
    next: u64,
    nodes: Vec<Node<C, V>>,
    /// The block that is being filled.
    open: Moments<C, V>,
}

impl<const C: usize, const V: usize> Default for BlockSums<C, V> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const C: usize, const V: usize> BlockSums<C, V> {
    /// No samples yet; the first to come is sample 0.
    pub const fn new() -> Self {
        Self::starting_at_block(0)
    }

    /// No samples yet; the first to come is sample `block * 16`.
    pub const fn starting_at_block(block: u64) -> Self {
        let first = block * BLOCK;
        Self { first, next: first, nodes: Vec::new(), open: Moments::ZERO }
    }

    /// Takes the next sample, which must be finite.
    #[inline]
    pub fn add(&mut self, sample: [f32; C]) {
        for (channel, value) in sample.into_iter().enumerate() {
            let value = f64::from(value);
            self.open.sum[channel] += value;
            if channel < V {
                self.open.squares[channel] += value * value;
            }
        }
        self.open.count += 1;
        self.advance();
    }

    /// Skips the next sample: it keeps its place but is not part of the mean.
    #[inline]
    pub fn skip(&mut self) {
        self.advance();
    }

    #[inline]
    fn advance(&mut self) {
        self.next += 1;
        if self.next.is_multiple_of(BLOCK) {
            let moments = std::mem::replace(&mut self.open, Moments::ZERO);
            self.push(Node { level: 0, index: self.next / BLOCK - 1, moments });
        }
    }

    /// Appends a node, adding siblings as carries ripple through a binary counter.
    fn push(&mut self, mut node: Node<C, V>) {
        while node.index % 2 == 1
            && let Some(left) = self.nodes.pop_if(|left| left.level == node.level)
        {
            node = Node {
                level: node.level + 1,
                index: node.index / 2,
                moments: left.moments.add(&node.moments),
            };
        }
        self.nodes.push(node);
    }

    /// Joins the run that follows this one.
    ///
    /// # Errors
    /// If `later` does not start where this run ends, or this run ends within a block.
    pub fn append(&mut self, later: &Self) -> Result<(), NotAdjacent> {
        if later.first != self.next || !self.next.is_multiple_of(BLOCK) {
            return Err(NotAdjacent { expected: self.next, found: later.first });
        }
        // In order, so that a right sibling always meets its left one, or none.
        later.nodes.iter().for_each(|&node| self.push(node));
        self.open = later.open;
        self.next = later.next;
        Ok(())
    }

    /// Passes over whole blocks of samples that are not there: the next to come is number `next`.
    /// Both where this run ends and `next` are edges of blocks, else nothing happens.
    pub fn pass_over(&mut self, next: u64) {
        if self.next.is_multiple_of(BLOCK) && next.is_multiple_of(BLOCK) && next > self.next {
            self.next = next;
        }
    }

    /// How many nodes the sums of a run of samples are, the block that is not full included.
    pub fn node_count(range: std::ops::Range<u64>) -> usize {
        let whole = subtrees(range.start / BLOCK, range.end / BLOCK).count();
        whole + usize::from(!range.end.is_multiple_of(BLOCK))
    }

    /// The bits of a node's numbers, one after the other: sums, squares and count.
    pub const NODE_WORDS: usize = C + V + 1;

    /// All nodes as words, [`Self::NODE_WORDS`] each, in the order of their samples; last the block
    /// that is not full, if there is one.
    pub fn to_words(&self) -> impl Iterator<Item = u64> + '_ {
        let open = (!self.next.is_multiple_of(BLOCK)).then_some(&self.open);
        let nodes = self.nodes.iter().map(|node| &node.moments).chain(open);
        nodes.flat_map(|moments| {
            let numbers = moments.sum.iter().chain(&moments.squares);
            numbers.map(|x| x.to_bits()).chain([moments.count])
        })
    }

    /// The sums of a run of samples from the words that [`Self::to_words`] gave; `range` starts at
    /// a block. None if there are too few words, a number is not finite, or more samples are in a
    /// node than it can hold.
    pub fn from_words(
        range: std::ops::Range<u64>,
        words: &mut impl Iterator<Item = u64>,
    ) -> Option<Self> {
        let mut sums = Self::starting_at_block(range.start / BLOCK);
        sums.next = range.end;
        // No more than that: there are millions of them.
        sums.nodes = Vec::with_capacity(subtrees(range.start / BLOCK, range.end / BLOCK).count());
        let mut read = |most: u64| {
            let mut number = || {
                let number = f64::from_bits(words.next()?);
                number.is_finite().then_some(number)
            };
            let mut moments = Moments::ZERO;
            for place in moments.sum.iter_mut().chain(&mut moments.squares) {
                *place = number()?;
            }
            moments.count = words.next()?;
            (moments.count <= most).then_some(moments)
        };
        for (level, index) in subtrees(range.start / BLOCK, range.end / BLOCK) {
            let moments = read(BLOCK << level)?;
            sums.nodes.push(Node { level, index, moments });
        }
        let rest = range.end % BLOCK;
        if rest > 0 {
            sums.open = read(rest)?;
        }
        Some(sums)
    }

    /// Frees the memory that is only needed until two nodes are added.
    pub fn shrink(&mut self) {
        self.nodes.shrink_to_fit();
    }

    /// Forgets all samples and starts again at sample 0; keeps its memory.
    pub fn clear(&mut self) {
        (self.first, self.next, self.open) = (0, 0, Moments::ZERO);
        self.nodes.clear();
    }

    /// The samples taken or passed over: the first, and the one that comes next.
    pub fn range(&self) -> std::ops::Range<u64> {
        self.first..self.next
    }

    /// How many samples were taken.
    pub fn count(&self) -> u64 {
        self.total().count
    }

    /// The sum of the samples taken.
    pub fn sum(&self) -> [f64; C] {
        self.total().sum
    }

    /// Bytes that the sums of samples `0..samples` take, the heap included.
    pub const fn bytes(samples: u64) -> u64 {
        let nodes = (samples / BLOCK).count_ones() as u64;
        size_of::<Self>() as u64 + nodes * size_of::<Node<C, V>>() as u64
    }

    /// The mean of the samples taken; zero if there are none.
    pub fn mean(&self) -> [f64; C] {
        let total = self.total();
        let count = total.count.max(1) as f64;
        total.sum.map(|sum| sum / count)
    }

    /// The estimated variance of the mean, as if samples were independent: stratified ones have
    /// less. Zero for fewer than two samples.
    pub fn variance_of_mean(&self) -> [f64; V] {
        let total = self.total();
        if total.count < 2 {
            return [0.0; V];
        }
        let n = total.count as f64;
        std::array::from_fn(|c| {
            let spread = total.squares[c] - total.sum[c] * total.sum[c] / n;
            spread.max(0.0) / (n * (n - 1.0))
        })
    }

    /// All nodes, added from the right: small ones first.
    fn total(&self) -> Moments<C, V> {
        self.nodes.iter().rfold(self.open, |sum, node| node.moments.add(&sum))
    }
}

/// The largest whole subtrees that fill the blocks from `first` to `end`, in their order: level and
/// index of each.
fn subtrees(first: u64, end: u64) -> impl Iterator<Item = (u32, u64)> {
    let mut at = first;
    std::iter::from_fn(move || {
        let left = end.checked_sub(at).filter(|&left| left > 0)?;
        let level = at.trailing_zeros().min(left.ilog2());
        let index = at >> level;
        at += 1 << level;
        Some((level, index))
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sample(index: u64) -> [f32; 2] {
        let x = crate::sampling::Sampler::new(index, 0, 0).next_2d();
        [x.x * 1e3, x.y / (x.x + 1e-3)]
    }

    fn run(range: std::ops::Range<u64>) -> BlockSums<2, 2> {
        let mut sums = BlockSums::starting_at_block(range.start / BLOCK);
        for index in range {
            if index % 37 == 5 { sums.skip() } else { sums.add(sample(index)) }
        }
        sums
    }

    #[test]
    fn mean_and_variance_by_hand() {
        let mut sums = BlockSums::<1, 1>::new();
        for x in [1.0, 2.0, 3.0, 6.0] {
            sums.add([x]);
        }
        sums.skip();
        assert_eq!((sums.count(), sums.range()), (4, 0..5));
        assert_eq!(sums.mean(), [3.0]);
        // Squared deviations 4, 1, 0, 9 over 3, and over 4 for the mean.
        assert!((sums.variance_of_mean()[0] - 14.0 / 12.0).abs() < 1e-12);
        assert_eq!(BlockSums::<1, 1>::new().mean(), [0.0]);
        assert_eq!(BlockSums::<1, 1>::new().variance_of_mean(), [0.0]);
    }

    #[test]
    fn channels_without_a_variance_have_the_same_means() {
        let (mut some, mut all) = (BlockSums::<2, 1>::new(), BlockSums::<2, 2>::new());
        for index in 0..100 {
            some.add(sample(index));
            all.add(sample(index));
        }
        assert_eq!((some.mean(), some.sum()), (all.mean(), all.sum()));
        assert_eq!(some.variance_of_mean()[0], all.variance_of_mean()[0]);
    }

    #[test]
    fn memory_is_logarithmic() {
        assert_eq!(run(0..16 * 64).nodes.len(), 1);
        assert_eq!(run(0..16 * 63).nodes.len(), 6);
        assert!(run(16 * 3..16 * 61).nodes.len() <= 12);
        let one = size_of::<BlockSums<2, 2>>() as u64;
        assert_eq!(BlockSums::<2, 2>::bytes(15), one);
        let node = size_of::<Node<2, 2>>() as u64;
        assert_eq!(BlockSums::<2, 2>::bytes(16 * 63), one + 6 * node);
    }

    #[test]
    fn gaps_and_open_blocks_do_not_join() {
        assert!(run(0..32).append(&run(48..64)).is_err());
        assert!(run(0..30).append(&run(32..64)).is_err());
        assert_eq!(
            run(0..32).append(&run(16..64)).unwrap_err().to_string(),
            "samples from 16 on do not follow those up to 32"
        );
    }

    #[test]
    fn words_that_no_sums_have_are_refused() {
        let words: Vec<u64> = run(0..20).to_words().collect();
        let read = |words: &[u64]| BlockSums::<2, 2>::from_words(0..20, &mut words.iter().copied());
        assert_eq!(read(&words), Some(run(0..20)));
        assert_eq!(read(&words[1..]), None);
        let with = |at: usize, word: u64| {
            let mut words = words.clone();
            words[at] = word;
            read(&words)
        };
        assert_eq!(with(0, f64::NAN.to_bits()), None);
        assert!(with(4, 16).is_some() && with(4, 17).is_none(), "a block has 16 samples");
        assert!(with(9, 4).is_some() && with(9, 5).is_none(), "the open one has four");
    }

    proptest! {
        #[test]
        fn sums_are_the_same_after_words(first in 0_u64..9, length in 0_u64..700) {
            let range = first * BLOCK..first * BLOCK + length;
            let sums = run(range.clone());
            let words: Vec<u64> = sums.to_words().collect();
            let nodes = BlockSums::<2, 2>::node_count(range.clone());
            prop_assert_eq!(words.len(), nodes * BlockSums::<2, 2>::NODE_WORDS);
            let again = BlockSums::from_words(range, &mut words.into_iter());
            prop_assert_eq!(again, Some(sums));
        }

        /// However a run is cut at blocks, and in whichever order its parts are joined, the same
        /// bits come out.
        #[test]
        fn cuts_do_not_show(
            mut cuts in prop::collection::vec(0_u64..40, 0..6),
            start in 0_u64..9,
            rest in 0_u64..20,
            picks in prop::collection::vec(0_usize..8, 8),
        ) {
            let end = (start + 40) * BLOCK + rest;
            cuts.sort_unstable();
            let mut edges = vec![start * BLOCK];
            edges.extend(cuts.into_iter().map(|cut| (start + cut) * BLOCK));
            edges.push(end);
            let mut parts: Vec<_> = edges.windows(2).map(|edge| run(edge[0]..edge[1])).collect();
            for pick in picks.into_iter().cycle() {
                if parts.len() == 1 {
                    break;
                }
                let at = pick % (parts.len() - 1);
                let later = parts.remove(at + 1);
                prop_assert!(parts[at].append(&later).is_ok());
            }
            let whole = run(start * BLOCK..end);
            prop_assert_eq!(&parts[0], &whole);
            prop_assert_eq!(parts[0].mean(), whole.mean());
            prop_assert_eq!(parts[0].variance_of_mean(), whole.variance_of_mean());
        }
    }
}
