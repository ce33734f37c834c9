//! Entry points of parts of a slice, as fine as pays.
//!
//! A. Reshetov, A. Soupikov and J. Hurley, "Multi-level ray tracing algorithm", 2005, section 3.3:
//! a tile is cut, and the parts are searched for from where the tile entered. We cut into quarters,
//! down to packets, as long as one of the four enters deeper than their tile did.

use std::ops::Range;

use fearless_simd::Simd;

use super::compress::Step;
use super::cut::Cut;
use super::entry::entry_point;
use super::place::Places;
use crate::accel::Counters;

/// Columns and rows of blocks.
type Part = [Range<usize>; 2];

/// Finds where each packet of a slice starts, all of which may start from one step.
#[inline(always)]
pub fn entry_points<S: Simd, C: Counters>(
    simd: S,
    places: Places<'_>,
    from: Step,
    cut: &Cut<'_>,
    starts: &mut [Option<Step>],
    counters: &mut C,
) {
    let mut waiting = vec![(cut.blocks().map(|count| 0..count), from)];
    while let Some((part, from)) = waiting.pop() {
        if part.iter().all(|side| side.len() <= 1) || places.link(from.place).is_leaf() {
            continue;
        }
        let mut deeper = false;
        let found = quarters(&part).map(|[columns, rows]| {
            if columns.is_empty() || rows.is_empty() {
                return None;
            }
            // What does not run side by side enters where its tile did.
            let Some(shaft) = cut.shaft(simd, columns.clone(), rows.clone()) else {
                return Some(([columns, rows], Some(from)));
            };
            let entry = entry_point(places, from.place, &shaft, counters).map(Step::to);
            deeper |= entry != Some(from);
            Some(([columns, rows], entry))
        });
        for (part, entry) in found.into_iter().flatten().filter(|_| deeper) {
            for row in part[1].clone() {
                for column in part[0].clone() {
                    starts[cut.packets_of(column, row)].fill(entry);
                }
            }
            waiting.extend(entry.map(|entry| (part, entry)));
        }
    }
}

fn quarters([columns, rows]: &Part) -> [Part; 4] {
    let halves = |side: &Range<usize>| {
        let middle = side.start + side.len().div_ceil(2);
        [side.start..middle, middle..side.end]
    };
    let ([left, right], [top, bottom]) = (halves(columns), halves(rows));
    [[left.clone(), top.clone()], [right.clone(), top], [left, bottom.clone()], [right, bottom]]
}
