//! Rays to lights, the paper's open questions: what compressed paths do for the shadow rays of a
//! light of limited reach, whose region is entered once, and for the many rays to a light with an
//! area, which are packets of one pixel's each.

use std::time::Instant;

use super::bench::{Bench, Named};
use super::figures::{Column, Light};
use super::frame::{Frame, in_region};
use super::structures::{ACROSS, LIGHT_STRUCTURES, LightKind, Region, STRUCTURES};
use crate::accel::{Accel, AnyHit, Batch, ClosestHit, Tracer};
use crate::bench::measure::{Answers, BenchError, time_interleaved};
use crate::bench::ray_sets::Random;
use crate::geom::Shaft;
use crate::math::{Aabb, Ray, Vec3};

/// A light in place.
struct Lamp {
    kind: LightKind,
    at: Vec3,
    size: f32,
    region: Option<Shaft>,
}

/// Rays along a side of a packet to a light with an area.
const PACKET: u32 = 16;
/// One pixel of so many aims such a packet.
const SHARE: usize = 576;

/// Slices: rays, and their rasters.
struct Shadows {
    rays: Vec<Ray>,
    slices: Vec<(std::ops::Range<usize>, u32)>,
}

/// Measures rays to lights of each kind over all pictures.
pub fn measure(bench: &Bench<'_>, built: &[Named]) -> Result<Vec<Light>, BenchError> {
    let accels = LIGHT_STRUCTURES.map(|(_, id, options, region)| {
        let known = STRUCTURES.iter().position(|known| (known.1, known.2) == (id, options));
        let (spec, accel) = &built[known.expect("is among the structures")];
        (spec.as_str(), &**accel, region)
    });
    LightKind::ALL.iter().map(|&kind| measure_light(bench, kind, &accels)).collect()
}

fn measure_light(
    bench: &Bench<'_>,
    kind: LightKind,
    accels: &[(&str, &dyn Accel, Region)],
) -> Result<Light, BenchError> {
    (bench.tell)(&format!("{}: {}", bench.name, kind.name()));
    let mut columns = vec![Column::default(); accels.len()];
    let mut rays = 0;
    let mut lamp = None;
    for pose in &bench.flight {
        let frame = Frame::new(pose, bench.settings.resolution, ACROSS);
        let hits = frame.trace_hits(accels[0].1);
        // The first picture says where it hangs.
        let lamp = lamp.get_or_insert_with(|| Lamp::new(kind, &frame, &hits));
        let shadows = lamp.shadows(&frame, &hits);
        rays += shadows.rays.iter().filter(|ray| **ray != Ray::MISS).count();
        let answers = |(_, accel, region): &(&str, &dyn Accel, Region)| {
            let mut answers = shadows.allocate_answers();
            shadows.shoot(&mut *accel.tracer(), lamp.region(*region), &mut answers);
            Answers::Any(answers)
        };
        let expected = answers(&accels[0]);
        for named in &accels[1..] {
            answers(named).check(&expected, named.0, accels[0].0, kind.name())?;
        }
        for (column, (_, accel, region)) in columns.iter_mut().zip(accels) {
            let mut tracer = accel.counting_tracer();
            shadows.shoot(&mut *tracer, lamp.region(*region), &mut shadows.allocate_answers());
            column.counts = column.counts + tracer.counts();
        }
        let seconds = time_interleaved(accels.len(), bench.settings.rounds, |i| {
            let (_, accel, region) = &accels[i];
            let (mut tracer, mut answers) = (accel.tracer(), shadows.allocate_answers());
            let start = Instant::now();
            shadows.shoot(&mut *tracer, lamp.region(*region), &mut answers);
            Ok::<_, BenchError>(start.elapsed().as_secs_f64())
        })?;
        for (column, seconds) in columns.iter_mut().zip(seconds) {
            column.seconds.push(seconds);
        }
    }
    Ok(Light { kind, rays, columns })
}

impl Lamp {
    /// A light above what a picture shows, a quarter of that in size or reach.
    fn new(kind: LightKind, frame: &Frame, hits: &[ClosestHit]) -> Self {
        let points = frame.rays.iter().zip(hits).filter(|(_, hit)| hit.is_hit());
        let points: Vec<Vec3> = points.map(|(ray, hit)| ray.at(hit.t)).collect();
        let bounds = Aabb::of_points(points.iter().copied());
        let bounds =
            if bounds.is_empty() { Aabb { min: Vec3::ZERO, max: Vec3::ONE } } else { bounds };
        // The point in the middle of the picture's, a little up.
        let middle = points.get(points.len() / 2).copied().unwrap_or(bounds.centre());
        let size = bounds.extent().max_element() * 0.25;
        let at = middle + Vec3::Y * (0.4 * size);
        let region = match kind {
            LightKind::Ranged => {
                Shaft::within(Aabb { min: at - Vec3::splat(size), max: at + Vec3::splat(size) })
            }
            LightKind::Spot => {
                let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
                let corners = corners.map(|(x, z)| Vec3::new(x, -1.2, z));
                Shaft::spot(at, corners, 8.0 * size)
            }
            LightKind::Area => Shaft::within(
                bounds.union(Aabb { min: at - Vec3::splat(size), max: at + Vec3::splat(size) }),
            ),
        };
        Self { kind, at, size, region }
    }

    fn region(&self, region: Region) -> Option<&Shaft> {
        self.region.as_ref().filter(|_| region == Region::Light)
    }

    /// The rays from what a picture shows to the light; none from what it does not reach.
    fn shadows(&self, frame: &Frame, hits: &[ClosestHit]) -> Shadows {
        let from = |(ray, hit): (&Ray, &ClosestHit)| {
            // A little off the surface, as a share of the distance.
            hit.is_hit().then(|| ray.at(hit.t * (1.0 - 1e-4)))
        };
        let ray = |from: Vec3, to: Vec3| Ray::new(from, to - from, 0.0, 1.0 - 1e-4);
        if self.kind == LightKind::Area {
            return self.packets(frame.rays.iter().zip(hits).step_by(SHARE).filter_map(from));
        }
        let reached = |point: &Vec3| {
            let ray = ray(*point, self.at);
            self.region.as_ref().is_none_or(|region| region.holds(&ray))
        };
        let rays = frame.rays.iter().zip(hits);
        let rays = rays.map(|pair| from(pair).filter(reached));
        let rays = rays.map(|from| from.map_or(Ray::MISS, |from| ray(from, self.at))).collect();
        Shadows { rays, slices: frame.tiles().collect() }
    }

    /// From each point a packet, to places of the light in rows.
    fn packets(&self, points: impl Iterator<Item = Vec3>) -> Shadows {
        let (mut rays, mut slices) = (Vec::new(), Vec::new());
        for (number, point) in points.enumerate() {
            let first = rays.len();
            let random = &mut Random::new(1, number as u64);
            for cell in 0..PACKET * PACKET {
                let place = |cell: u32, jitter: f32| {
                    ((cell as f32 + jitter) / PACKET as f32 - 0.5) * self.size
                };
                let jitter = random.cube();
                let (x, z) = (place(cell % PACKET, jitter.x), place(cell / PACKET, jitter.z));
                let to = self.at + Vec3::new(x, 0.0, z);
                rays.push(Ray::new(point, to - point, 0.0, 1.0 - 1e-4));
            }
            slices.push((first..rays.len(), PACKET));
        }
        Shadows { rays, slices }
    }
}

impl Shadows {
    fn allocate_answers(&self) -> Vec<AnyHit> {
        vec![AnyHit(false); self.rays.len()]
    }

    fn shoot(&self, tracer: &mut dyn Tracer, region: Option<&Shaft>, answers: &mut [AnyHit]) {
        in_region(tracer, region, |tracer| {
            for (at, width) in &self.slices {
                let batch =
                    Batch::new(&self.rays[at.clone()]).with_grid(*width, at.len() as u32 / width);
                tracer.any_hits(&batch, &mut answers[at.clone()]);
            }
        });
    }
}
