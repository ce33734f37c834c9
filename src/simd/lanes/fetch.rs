//! Rows from a table, one a lane.

use super::traits::Lanes;

/// The rows of a `table` at `places`, as four columns: a plain load a lane, which costs less than
/// gathering four columns number by number.
///
/// # Panics
/// If a place lies outside the table.
#[inline(always)]
pub fn fetch<L: Lanes>(lanes: L, table: &[[f32; 4]], places: L::Uint) -> [L::Float; 4] {
    lanes.gather(places, |place| table[place])
}
