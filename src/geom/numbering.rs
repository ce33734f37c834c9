//! One running number over groups of things, one group after the other.

/// The numbers of groups, and whose a number is.
#[derive(Clone, Debug)]
pub struct Numbering {
    /// Of each group its first number, and last how many there are.
    first: Vec<u64>,
    /// The group of every 2^`shift`th number, and last the last group.
    coarse: Vec<u32>,
    shift: u32,
}

/// Entries of the coarse table at most, less one.
const MOST_COARSE: u64 = 2048;

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
        let shift = len.div_ceil(MOST_COARSE).next_power_of_two().trailing_zeros();
        let last = first.len().saturating_sub(2);
        let group = |number| first.partition_point(|&first| first <= number).saturating_sub(1);
        let steps = (0..len).step_by(1 << shift).map(|number| group(number).min(last) as u32);
        let coarse = steps.chain([last as u32]).collect();
        Self { first, coarse, shift }
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
        let (from, to) = (self.coarse[step] as usize, self.coarse[step + 1] as usize);
        let further = self.first[from + 1..=to].partition_point(|&first| first <= number);
        let group = from + further;
        (group, (number - self.first[group]) as u32)
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
