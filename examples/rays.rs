//! Triangles of one's own, rays of one's own, any structure.

use std::error::Error;
use std::sync::Arc;

use dapple::geom::{Triangle, TriangleList};
use dapple::math::{Ray, Vec3};
use dapple::{AnyHit, Batch, ClosestHit, Isa};

fn main() -> Result<(), Box<dyn Error>> {
    // A unit square at z = 0, of two triangles.
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0);
    let triangles = Arc::new(TriangleList(vec![
        Triangle { a: corner(0.0, 0.0), b: corner(1.0, 0.0), c: corner(1.0, 1.0) },
        Triangle { a: corner(0.0, 0.0), b: corner(1.0, 1.0), c: corner(0.0, 1.0) },
    ]));
    // From a metre before it, straight on: origin, direction, t_min, t_max.
    let towards = |x: f32, y: f32| Ray::new(Vec3::new(x, y, 1.0), -Vec3::Z, 0.0, f32::INFINITY);
    let rays = [towards(0.75, 0.25), towards(0.25, 0.75), towards(2.0, 0.5)];

    for variant in dapple::VARIANTS {
        let accel = dapple::build(&variant.id.parse()?, triangles.clone(), Isa::default())?;
        let mut tracer = accel.tracer(); // one a thread
        let mut hits = [ClosestHit::MISS; 3];
        tracer.closest_hits(&Batch::new(&rays), &mut hits);
        assert_eq!(hits.map(|hit| hit.t), [1.0, 1.0, f32::INFINITY], "{}", variant.id);
        assert_eq!(hits.map(|hit| hit.triangle.index).first(), Some(&0), "{}", variant.id);

        let mut found = [AnyHit(false); 3];
        tracer.any_hits(&Batch::new(&rays), &mut found);
        assert_eq!(found, [AnyHit(true), AnyHit(true), AnyHit(false)], "{}", variant.id);
    }
    Ok(())
}
