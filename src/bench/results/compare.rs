//! Committed figures and today's side by side, and the verdict.
//!
//! Times are noisy, so that no single cell decides. The geometric mean of all cells of a file does,
//! and that of each structure's cells with twice the room. Work is no time: it is equal or not.

use super::cells::{Cell, Kind};

/// What of rates is compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// Millions of rays a second: the same processor.
    Rates,
    /// Rates over that of the first structure in the same group.
    Ratios,
}

/// A rate, or a ratio of two.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    /// What was measured.
    pub group: String,
    /// The structure.
    pub structure: String,
    /// What the file says.
    pub committed: f64,
    /// What was measured just now.
    pub today: f64,
}

impl Pair {
    /// By how many per cent today's figure is off.
    pub fn off(&self) -> f64 {
        to_per_cent(self.today / self.committed)
    }
}

fn to_per_cent(ratio: f64) -> f64 {
    (ratio - 1.0) * 100.0
}

/// The geometric mean of some ratios; 1 if there are none.
fn find_mean(ratios: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for ratio in ratios {
        sum += libm::log(ratio);
        count += 1.0;
    }
    if count > 0.0 { libm::exp(sum / count) } else { 1.0 }
}

/// What came of the comparison of a file.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// What of rates was compared.
    pub by: By,
    /// Rates or ratios, in the file's order.
    pub pairs: Vec<Pair>,
    /// By how many per cent all are off, in the geometric mean.
    pub mean: f64,
    /// The same for each structure.
    pub structures: Vec<(String, f64)>,
    /// Figures of work that are equal.
    pub equal: usize,
    /// And those that are not.
    pub unequal: Vec<Pair>,
    /// Figures that only one of both has.
    pub unpaired: Vec<String>,
}

/// Compares what a file says with what was measured just now.
pub fn compare(committed: &[Cell], today: &[Cell], by: By) -> Comparison {
    let (mut pairs, mut unequal, mut unpaired) = (Vec::new(), Vec::new(), Vec::new());
    let mut equal = 0;
    for cell in committed {
        let Some(now) = today.iter().find(|other| is_same(cell, other)) else {
            unpaired.push(format!("{} of {}: only the file has it", cell.group, cell.structure));
            continue;
        };
        let (group, structure) = (cell.group.clone(), cell.structure.clone());
        let pair = Pair { group, structure, committed: cell.value, today: now.value };
        match cell.kind {
            Kind::Rate => pairs.push(pair),
            Kind::Work if cell.value.to_bits() == now.value.to_bits() => equal += 1,
            Kind::Work => unequal.push(pair),
        }
    }
    for cell in today.iter().filter(|cell| !committed.iter().any(|other| is_same(cell, other))) {
        unpaired.push(format!("{} of {}: the file lacks it", cell.group, cell.structure));
    }
    if by == By::Ratios {
        pairs = take_ratios(&pairs);
    }
    let ratios = |structure: Option<&str>| {
        let wanted = |pair: &&Pair| structure.is_none_or(|structure| pair.structure == structure);
        find_mean(pairs.iter().filter(wanted).map(|pair| pair.today / pair.committed))
    };
    let mean = to_per_cent(ratios(None));
    let mut structures: Vec<(String, f64)> = Vec::new();
    for Pair { structure, .. } in &pairs {
        if !structures.iter().any(|(known, _)| known == structure) {
            structures.push((structure.clone(), to_per_cent(ratios(Some(structure)))));
        }
    }
    Comparison { by, pairs, mean, structures, equal, unequal, unpaired }
}

fn is_same(a: &Cell, b: &Cell) -> bool {
    (a.kind, &a.group, &a.structure) == (b.kind, &b.group, &b.structure)
}

/// Rates over that of the first structure of their group.
fn take_ratios(pairs: &[Pair]) -> Vec<Pair> {
    let over_first = |pair: &Pair| {
        let first = pairs.iter().find(|first| first.group == pair.group)?;
        let is_first = first.structure == pair.structure;
        (!is_first).then(|| Pair {
            committed: pair.committed / first.committed,
            today: pair.today / first.today,
            ..pair.clone()
        })
    };
    pairs.iter().filter_map(over_first).collect()
}

impl Comparison {
    /// Why the file no longer describes the program, within so many per cent; empty if it does.
    pub fn explain(&self, within: f64) -> Vec<String> {
        let what = match self.by {
            By::Rates => "rates",
            By::Ratios => "ratios",
        };
        let mut reasons = Vec::new();
        if self.pairs.is_empty() {
            reasons.push(format!("there are no {what} to compare"));
        }
        if is_beyond(self.mean, within) {
            reasons.push(format!("{what} are off by {:+.1} % in the mean", self.mean));
        }
        for (structure, off) in &self.structures {
            if is_beyond(*off, 2.0 * within) {
                reasons.push(format!("{structure} is off by {off:+.1} % in the mean"));
            }
        }
        let work = |pair: &Pair| {
            let Pair { group, structure, committed, today } = pair;
            format!("{group} of {structure}: {committed} in the file, {today} today")
        };
        reasons.extend(self.unequal.iter().map(work));
        reasons.extend(self.unpaired.iter().cloned());
        reasons
    }

    /// The structure that is off by most.
    pub fn worst(&self) -> Option<&(String, f64)> {
        self.structures.iter().max_by(|a, b| size(a.1).total_cmp(&size(b.1)))
    }
}

/// How far a figure is off, whatever the direction: as a factor.
fn size(off: f64) -> f64 {
    libm::log(1.0 + off / 100.0).abs()
}

/// Whether a figure is off by more than so many per cent of the smaller one: half the rate is as
/// far off as twice the rate.
pub fn is_beyond(off: f64, within: f64) -> bool {
    let size = size(off);
    size.is_nan() || size > libm::log(1.0 + within / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRUCTURES: [&str; 4] = ["bvh2", "mbvh4", "mbvh8", "mbvh16"];

    fn cell(group: &str, structure: &str, kind: Kind, value: f64) -> Cell {
        Cell { group: group.to_owned(), structure: structure.to_owned(), kind, value }
    }

    /// Rates of four structures in three groups, scaled by a function.
    fn rates(scale: impl Fn(&str, usize) -> f64) -> Vec<Cell> {
        let mut cells = Vec::new();
        for (number, group) in ["random", "primary", "bounce"].into_iter().enumerate() {
            for (i, structure) in STRUCTURES.into_iter().enumerate() {
                let rate = (1 + i + number) as f64 * scale(structure, number);
                cells.push(cell(group, structure, Kind::Rate, rate));
            }
        }
        cells
    }

    fn explain(today: &[Cell], by: By) -> Vec<String> {
        compare(&rates(|_, _| 1.0), today, by).explain(15.0)
    }

    #[test]
    fn equal_figures_agree() {
        let same = rates(|_, _| 1.0);
        for by in [By::Rates, By::Ratios] {
            let found = compare(&same, &same, by);
            assert!(found.mean.abs() < 1e-9 && found.explain(0.01).is_empty());
        }
        assert_eq!(compare(&same, &same, By::Ratios).pairs.len(), 9);
    }

    #[test]
    fn one_noisy_cell_decides_nothing() {
        let noisy = |s: &str, group| if (s, group) == ("mbvh8", 1) { 0.5 } else { 1.0 };
        let found = compare(&rates(|_, _| 1.0), &rates(noisy), By::Rates);
        assert!(found.pairs.iter().any(|pair| is_beyond(pair.off(), 15.0)));
        assert_eq!(found.explain(15.0), Vec::<String>::new());
        assert_eq!(found.worst().map(|worst| worst.0.as_str()), Some("mbvh8"));
    }

    #[test]
    fn a_structure_that_has_changed_is_found() {
        let slower = |s: &str, _| if s == "mbvh16" { 0.6 } else { 1.0 };
        let expected = ["mbvh16 is off by -40.0 % in the mean"];
        assert_eq!(explain(&rates(slower), By::Rates), expected);
        assert_eq!(
            explain(&rates(slower), By::Ratios),
            ["ratios are off by -15.7 % in the mean", expected[0]]
        );
        // Of the others, they were all faster if the first became slower.
        let first = |s: &str, _| if s == "bvh2" { 0.6 } else { 1.0 };
        assert!(explain(&rates(first), By::Ratios)[0].contains("+66.7 %"));
    }

    #[test]
    fn another_machine_changes_no_ratios() {
        let machine = rates(|_, group| [0.4, 0.5, 0.3][group]);
        assert!(explain(&machine, By::Ratios).is_empty());
        assert!(explain(&machine, By::Rates)[0].starts_with("rates are off by -6"));
        let faster = rates(|_, _| 1.17);
        assert_eq!(explain(&faster, By::Rates), ["rates are off by +17.0 % in the mean"]);
    }

    #[test]
    fn work_is_equal_or_not() {
        let work = |value| [rates(|_, _| 1.0), vec![cell("leaves", "bvh2", Kind::Work, value)]];
        let found = compare(&work(5.6).concat(), &work(5.6).concat(), By::Ratios);
        assert_eq!((found.equal, found.explain(15.0).len()), (1, 0));
        let found = compare(&work(5.6).concat(), &work(5.6000001).concat(), By::Ratios);
        assert_eq!(found.explain(15.0), ["leaves of bvh2: 5.6 in the file, 5.6000001 today"]);
    }

    #[test]
    fn figures_of_one_side_are_told() {
        let fewer: Vec<Cell> =
            rates(|_, _| 1.0).into_iter().filter(|cell| cell.structure != "mbvh4").collect();
        assert_eq!(explain(&fewer, By::Rates)[0], "random of mbvh4: only the file has it");
        let found = compare(&fewer, &rates(|_, _| 1.0), By::Rates);
        assert_eq!(found.explain(15.0)[2], "bounce of mbvh4: the file lacks it");
        assert_eq!(compare(&[], &[], By::Rates).explain(15.0), ["there are no rates to compare"]);
    }

    #[test]
    fn half_the_rate_is_as_far_off_as_twice_the_rate() {
        assert!(is_beyond(-50.0, 99.0) && is_beyond(100.0, 99.0));
        assert!(!is_beyond(-50.0, 101.0) && !is_beyond(100.0, 101.0));
        assert!(is_beyond(f64::NAN, 15.0));
    }
}
