//! How finely round parts are cut at a level of detail.

/// Sine and cosine of `columns` equal steps around a circle.
pub(super) fn circle(columns: usize) -> Vec<(f64, f64)> {
    let step = std::f64::consts::TAU / columns as f64;
    (0..columns).map(|i| libm::sincos(i as f64 * step)).collect()
}

/// Columns around a round part, and into how many pieces straight lengths are cut. Like a CAD
/// program's, they stay whole for long, and triangles along cylinders become thin.
pub(super) fn columns(level: u32) -> (usize, usize) {
    const MOST_COLUMNS: u32 = 384;
    ((6 + level).min(MOST_COLUMNS) as usize, 1 + level as usize / 40)
}

/// Segments of a right angle that go with `columns` around; 0: it is left sharp.
pub(super) fn arc(columns: usize) -> usize {
    (columns / 9).min(24)
}
