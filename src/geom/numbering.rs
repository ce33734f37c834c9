//! One running number over groups of things, one group after the other.

use crate::math::{InstanceId, PrimId, TriangleId};

/// The numbers of groups, and whose a number is.
#[derive(Clone, Debug)]
pub struct Numbering {
    /// Of each group its first number, and last how many there are.
    first: Vec<u64>,
    /// Every 2^`shift` numbers are a step.
    shift: u32,
    /// The group of each step whose numbers are all of one; of others [`MIXED`].
    whole: Vec<u32>,
    /// The group of each step's first number, and last the last group.
    from: Vec<u32>,
}

/// Steps at most: so many that most lie within one group, and so few that what is known of them
/// stays in a core's cache.
const MOST_STEPS: u64 = 1 << 14;

/// A step of several groups.
const MIXED: u32 = u32::MAX;

impl Numbering {
    /// Numbers groups of so many things each.
    pub fn new(counts: impl ExactSizeIterator<Item = usize>) -> Self {
        let mut first = Vec::with_capacity(counts.len() + 1);
        let mut len = 0;
        first.push(0);
        for count in counts {
            len += count as u64;
            first.push(len);
        }
        let shift = len.div_ceil(MOST_STEPS).next_power_of_two().trailing_zeros();
        let steps = || (0..len).step_by(1 << shift);
        let group = |number| first.partition_point(|&first| first <= number) - 1;
        let whole = |begin: u64| {
            let (group, end) = (group(begin), len.min(begin + (1 << shift)));
            if end <= first[group + 1] { group as u32 } else { MIXED }
        };
        let last = first.len().saturating_sub(2) as u32;
        let from = steps().map(|begin| group(begin) as u32).chain([last]).collect();
        let whole = steps().map(whole).collect();
        Self { first, shift, whole, from }
    }

    /// How many numbers there are.
    #[inline]
    pub fn count(&self) -> usize {
        *self.first.last().expect("ends with how many there are") as usize
    }

    /// The first number of a group.
    #[inline]
    pub fn first(&self, group: usize) -> u64 {
        self.first[group]
    }

    /// The group of a number, and its place there.
    #[inline]
    pub fn find(&self, number: u64) -> (usize, u32) {
        let step = (number >> self.shift) as usize;
        let mut group = self.whole[step] as usize;
        if group == MIXED as usize {
            group = self.search(number, step);
        }
        (group, (number - self.first[group]) as u32)
    }

    /// The group of a number in a step of several.
    fn search(&self, number: u64, step: usize) -> usize {
        let (from, to) = (self.from[step] as usize, self.from[step + 1] as usize);
        from + self.first[from + 1..=to].partition_point(|&first| first <= number)
    }

    /// Whose a triangle is, where the groups are the triangles of placements.
    #[inline]
    pub fn locate(&self, prim: PrimId) -> TriangleId {
        let (instance, index) = self.find(u64::from(prim.0));
        TriangleId { instance: InstanceId::from_index(instance), index }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_number_is_found_in_its_group() {
        for counts in [vec![3, 0, 0, 5, 1, 0], vec![0, 0, 7], vec![100_000, 1, 0, 70_000], vec![1]]
        {
            let numbering = Numbering::new(counts.iter().copied());
            assert_eq!(numbering.count(), counts.iter().sum::<usize>());
            let mut number = 0;
            for (group, &count) in counts.iter().enumerate() {
                assert_eq!(numbering.first(group), number);
                for place in 0..count {
                    assert_eq!(numbering.find(number), (group, place as u32));
                    number += 1;
                }
            }
        }
        assert_eq!(Numbering::new([].into_iter()).count(), 0);
    }
}
