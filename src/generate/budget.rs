//! How many triangles each part gets, so that the sum is exact.

use super::model::{Model, Part};

/// Levels beyond this are not tried.
const MOST_LEVELS: u32 = 4096;

/// Parts of a model and how finely to make each; their triangles sum up to what was asked for.
#[derive(Debug)]
pub struct Plan {
    /// Parts with their levels of detail.
    pub parts: Vec<(Part, u32)>,
}

/// Chooses among a model's parts, and their levels, so that there are `triangles` in all. Takes the
/// parts out of the model.
///
/// Parts are chosen, those first that show most for their least triangles, while these take at
/// most two thirds of all. What
/// is left is dealt out by need; what a part cannot use goes to the next one, at the end to the
/// model's rest.
///
/// # Panics
/// If the model lacks the part that takes the rest.
pub fn share(model: &mut Model, triangles: u64) -> Plan {
    let mut parts = std::mem::take(&mut model.parts);
    let price = |part: &Part| part.shape.count(0) as f64 / part.shape.extent();
    parts.sort_by(|a, b| price(a).total_cmp(&price(b)));
    let mut coarse = 0;
    parts.retain(|part| {
        let fits = coarse + part.shape.count(0) <= triangles / 3 * 2;
        coarse += if fits { part.shape.count(0) } else { 0 };
        fits
    });
    // Small ones last: the last one's steps are the rest's size.
    parts.sort_by(|a, b| b.shape.extent().total_cmp(&a.shape.extent()));
    let needs: Vec<u64> = parts.iter().map(need).collect();
    let all_needs: u128 = needs.iter().map(|&need| u128::from(need)).sum();

    let spare = triangles - coarse;
    let mut left = triangles;
    let (mut met, mut dealt) = (0, 0);
    let mut planned = Vec::with_capacity(parts.len() + 1);
    for (part, need) in parts.into_iter().zip(needs) {
        met += u128::from(need);
        let due = (u128::from(spare) * met / all_needs.max(1)) as u64;
        let least = part.shape.count(0);
        let level = finest(&part, least + due - dealt);
        let used = part.shape.count(level);
        dealt += used - least;
        left -= used;
        planned.push((part, level));
    }
    if left > 0 {
        let rest = model.rest.take().expect("a model has a part for the rest");
        planned.push((rest, (left - 1) as u32));
    }
    Plan { parts: planned }
}

/// What a part would have at a middling level, more the larger it is.
fn need(part: &Part) -> u64 {
    (part.shape.count(10) as f64 * part.shape.extent().sqrt() * 1024.0) as u64
}

/// The highest level of at most `most` triangles.
fn finest(part: &Part, most: u64) -> u32 {
    let (mut fits, mut exceeds) = (0, MOST_LEVELS);
    while exceeds - fits > 1 {
        let middle = u32::midpoint(fits, exceeds);
        if part.shape.count(middle) <= most {
            fits = middle;
        } else {
            exceeds = middle;
        }
    }
    fits
}
