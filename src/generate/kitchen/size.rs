//! How large a kitchen is.

use crate::math::DVec3;

/// The room's size, metres; it stands on height 0, its middle over the origin.
pub const ROOM: DVec3 = DVec3::new(5.2, 2.7, 4.2);

/// Depth and height of the worktop.
pub(super) const WORKTOP: [f64; 2] = [0.62, 0.9];
