//! Rows from a table, one a lane.

use super::traits::{Lanes, MAX_LANES, Rows, Uint};

/// The rows of a `table` at `places`, as four columns: a plain load a lane, which costs less than
/// gathering four columns number by number.
///
/// # Panics
/// If a place lies outside the table.
#[inline(always)]
pub fn fetch<L: Lanes>(lanes: L, table: &[[f32; 4]], places: L::Uint) -> [L::Float; 4] {
    let (mut at, mut rows) = ([0; MAX_LANES], Rows::default());
    places.store(&mut at);
    for lane in 0..L::WIDTH {
        rows[lane] = table[at[lane] as usize];
    }
    lanes.columns(&rows)
}
