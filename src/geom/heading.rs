//! Which way rays go.

use crate::math::{Vec3, larger};

/// Which way all rays of a bundle, or of many, go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heading {
    /// The sides of boxes that they enter by: 1 for each axis that they go down along.
    pub negative: [usize; 3],
    /// The axes, permuted: they run fastest along the last.
    pub axes: [usize; 3],
}

impl Heading {
    /// Finds that of a direction.
    #[inline(always)]
    pub fn of(direction: Vec3) -> Self {
        let Vec3 { x, y, z } = direction;
        let negative = [
            usize::from(x.is_sign_negative()),
            usize::from(y.is_sign_negative()),
            usize::from(z.is_sign_negative()),
        ];
        Self { negative, axes: permute_axes(direction) }
    }

    /// The same as a number below [`Heading::COUNT`].
    #[inline(always)]
    pub fn number(self) -> usize {
        let [x, y, z] = self.negative;
        (x | y << 1 | z << 2) * 3 + self.axes[2]
    }

    /// How many there are.
    pub const COUNT: usize = 24;
}

/// Permutes the axes so that the last is that of a direction's largest component.
#[inline(always)]
pub fn permute_axes(direction: Vec3) -> [usize; 3] {
    let a = direction.abs();
    // The first of the largest. Without branches: which it is can't be guessed.
    let (y_wins, z_wins) = (usize::from(a.y > a.x), usize::from(a.z > larger(a.x, a.y)));
    let z = y_wins + z_wins * (2 - y_wins);
    // The winding does not matter: either sign of the determinant is a hit.
    const AXES: [[usize; 3]; 4] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [0, 1, 2]];
    AXES[z & 3]
}
