//! A small scene for the tests of tables.

use std::sync::Arc;

use crate::geom::{Triangle, TriangleList, TriangleSource};
use crate::math::Vec3;

/// A cloud of triangles in a box of some 40 by 35 by 52.
pub fn cloud(count: usize) -> Arc<dyn TriangleSource> {
    let corner = |i: usize| Vec3::new((i * i % 37) as f32, (i * 7 % 31) as f32, (i % 50) as f32);
    let list = (0..count).map(|i| {
        let a = corner(i);
        Triangle { a, b: a + Vec3::X * 3.0, c: a + Vec3::new(1.0, 4.0, 2.0) }
    });
    Arc::new(TriangleList(list.collect()))
}
