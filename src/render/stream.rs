//! Many paths at once.
//!
//! The paths of a tile advance together, bounce by bounce. All of their rays of one kind are one
//! slice for the tracer, in path order, so that it can keep many of them in flight while memory
//! answers; paths that have ended are taken out after each bounce. The order of additions to a
//! path's radiance is that of its vertices, whatever the slice: cutting slices otherwise changes no
//! bit.
//!
//! Paths are started and plain surfaces shaded many at once, in lanes; which ones together changes
//! no bit: rounding is the same at every width.

use std::time::Instant;

use fearless_simd::Level;

use super::breakdown::{Breakdown, Stage};
use super::start::{Started, Starts};
use super::trace::{Slice, find_blocked, find_hits, start_inside};
use crate::accel::{Accel, AnyHit, ClosestHit, Tracer};
use crate::geom::Shaft;
use crate::integrator::{
    Path, PathSample, PathTracer, ShadowRays, Transits, Vertices, add_environment_in_lanes,
    shade_in_lanes,
};
use crate::material::lanes::{BsdfLanes, LambertLanes, MetallicRoughnessLanes, SmoothGlassLanes};
use crate::math::{InstanceId, Ray};
use crate::simd::lanes::Lanes;
use crate::simd::{in_lanes, vectorized};
use crate::world::BsdfClass;

/// How many rays were shot, and what became of paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Segments of paths.
    pub closest: u64,
    /// Segments to lights.
    pub shadow: u64,
    /// Paths that ended only for their length.
    pub cut: u64,
}

impl RayCounts {
    /// Rays of both kinds.
    pub fn total(&self) -> u64 {
        self.closest + self.shadow
    }
}

impl std::ops::AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.closest += other.closest;
        self.shadow += other.shadow;
        self.cut += other.cut;
    }
}

/// One worker's paths, and all the memory that they need.
pub(super) struct Stream<'w> {
    integrator: PathTracer<'w>,
    /// The instruction set that shading is compiled for; that of the structure's walks.
    level: Level,
    tracer: Box<dyn Tracer + 'w>,
    /// Of path `i`: its current ray, what that hit, and its state.
    rays: Vec<Ray>,
    hits: Vec<ClosestHit>,
    paths: Vec<Path>,
    /// The triangles that were hit, and whether each path goes on.
    triangles: Vec<(InstanceId, usize)>,
    alive: Vec<bool>,
    /// The paths to be shaded together, by class, in order; [`BsdfClass::Other`] first.
    classes: [Vec<u32>; 4],
    /// Paths in air that leave the scene, in order.
    leaving: Vec<u32>,
    shadow_rays: ShadowRays,
    blocked: Vec<AnyHit>,
    transits: Transits,
    /// For the alpha filter, of the slice that is being traced; empty if nothing is see-through.
    keys: Vec<u64>,
    /// The times of the slice that is being traced; empty if nothing moves.
    times: Vec<f32>,
    /// Results by slot.
    samples: Vec<PathSample>,
    /// Whether a camera ray has met what mirrors or is clear.
    follows: bool,
    /// How many segments each slot's path had.
    segments: Vec<u32>,
    /// The cost of a path in nanoseconds, by its number of segments.
    shares: Vec<f32>,
    /// How wide a pixel is, see [`crate::camera::Camera::pixel_cone`].
    pixel_cone: [f32; 2],
    /// The raster of pixels whose rays these are, until they have been traced.
    grid: Option<(u32, u32)>,
    counts: RayCounts,
    breakdown: Breakdown,
}

impl<'w> Stream<'w> {
    /// A worker's stream; structures that gain by it are narrowed to the region that the camera
    /// sees.
    pub fn new(integrator: PathTracer<'w>, accel: &'w dyn Accel, region: Option<&Shaft>) -> Self {
        let mut tracer = accel.tracer();
        if let (Some(mut regions), Some(region)) = (tracer.regions(), region) {
            regions.enter(region);
        }
        Self {
            integrator,
            level: accel.level(),
            tracer,
            rays: Vec::new(),
            hits: Vec::new(),
            paths: Vec::new(),
            triangles: Vec::new(),
            alive: Vec::new(),
            classes: Default::default(),
            leaving: Vec::new(),
            shadow_rays: ShadowRays::default(),
            blocked: Vec::new(),
            transits: Transits::default(),
            keys: Vec::new(),
            times: Vec::new(),
            samples: Vec::new(),
            follows: false,
            segments: Vec::new(),
            shares: Vec::new(),
            pixel_cone: [0.0; 2],
            grid: None,
            counts: RayCounts::default(),
            breakdown: Breakdown::default(),
        }
    }

    /// Follows paths to their ends.
    pub fn run(&mut self, starts: Starts<'_>) {
        let start = Instant::now();
        let world = self.integrator.world();
        let timed = world.moves();
        let starts = Starts { keyed: world.is_see_through(), timed, ..starts };
        let started = &mut Started {
            rays: &mut self.rays,
            paths: &mut self.paths,
            samples: &mut self.samples,
        };
        in_lanes!(self.level, lanes => starts.start(lanes, started));
        start_inside(world, &mut *self.tracer, starts.camera, &mut self.paths);
        self.breakdown.add_since(Stage::Start, start);
        self.pixel_cone = starts.pixel_cone();
        self.follows = false;
        self.segments.clear();
        self.segments.resize(self.samples.len(), 0);
        self.shares.clear();
        self.shares.push(0.0);

        // Where the camera does not see everywhere, the rays are not a raster's.
        self.grid = (self.paths.len() == self.samples.len()).then_some(starts.size);
        let mut depth = 1;
        while !self.paths.is_empty() {
            let (start, alive) = (Instant::now(), self.paths.len());
            self.bounce(depth);
            let share = start.elapsed().as_nanos() as f32 / alive as f32;
            self.shares.push(self.shares[depth as usize - 1] + share);
            depth += 1;
        }
    }

    /// The results of the last [`Stream::run`] by slot.
    pub fn samples(&self) -> &[PathSample] {
        &self.samples
    }

    /// The nanoseconds that a slot took: a bounce's time is shared evenly among its paths.
    pub fn nanoseconds(&self, slot: usize) -> f32 {
        self.shares[self.segments[slot] as usize]
    }

    /// All rays so far.
    pub fn counts(&self) -> RayCounts {
        self.counts
    }

    /// Where the time went so far.
    pub fn breakdown(&mut self) -> &mut Breakdown {
        &mut self.breakdown
    }

    /// Advances all paths by one segment.
    fn bounce(&mut self, depth: u32) {
        let start = Instant::now();
        self.trace_paths(depth);
        self.widen_paths(depth);
        let start = self.breakdown.add_since(Stage::ClosestHits, start);
        let start = self.shade(depth, start);
        self.trace_shadow_rays(depth);
        self.trace_transits();
        self.breakdown.add_since(Stage::ShadowRays, start);
    }

    /// Finds what all current rays hit.
    fn trace_paths(&mut self, depth: u32) {
        let world = self.integrator.world();
        self.keys.clear();
        if world.is_see_through() {
            self.keys.extend(self.paths.iter().map(|path| ray_key(path.key, 2 * depth)));
        }
        self.times.clear();
        if world.moves() {
            self.times.extend(self.paths.iter().map(|path| path.time));
        }
        let slice = Slice { rays: &self.rays, keys: &self.keys, times: &self.times };
        find_hits(world, &mut *self.tracer, &slice, self.grid.take(), &mut self.hits);
        self.counts.closest += self.rays.len() as u64;
    }

    /// Lets paths be as wide as they are where they hit something.
    fn widen_paths(&mut self, depth: u32) {
        if !self.integrator.world().has_levels() {
            return;
        }
        for (path, hit) in self.paths.iter_mut().zip(&self.hits) {
            if depth == 1 {
                path.set_cone(self.pixel_cone);
            }
            path.widen(hit.t);
        }
    }

    /// Lets every path scatter; those that go on move up to the front, in order. Returns the time.
    fn shade(&mut self, depth: u32, start: Instant) -> Instant {
        self.shadow_rays.clear();
        self.alive.clear();
        self.alive.resize(self.paths.len(), false);
        self.sort_by_class(depth);
        let start = self.breakdown.add_since(Stage::Sort, start);
        if self.integrator.shows_environment(depth) {
            in_lanes!(self.level, lanes => self.add_environment(lanes));
        }
        let start = self.breakdown.add_since(Stage::Environment, start);
        in_lanes!(self.level, lanes => {
            self.shade_class::<_, LambertLanes<_>>(lanes, BsdfClass::Lambert, depth);
        });
        let start = self.breakdown.add_since(Stage::Lambert, start);
        in_lanes!(self.level, lanes => {
            let class = BsdfClass::MetallicRoughness;
            self.shade_class::<_, MetallicRoughnessLanes<_>>(lanes, class, depth);
        });
        let start = self.breakdown.add_since(Stage::MetallicRoughness, start);
        in_lanes!(self.level, lanes => {
            self.shade_class::<_, SmoothGlassLanes<_>>(lanes, BsdfClass::SmoothGlass, depth);
        });
        let start = self.breakdown.add_since(Stage::SmoothGlass, start);
        vectorized!(self.level, _simd => self.shade_others(depth));
        let start = self.breakdown.add_since(Stage::Others, start);
        self.close_ranks(depth);
        self.breakdown.add_since(Stage::Sort, start)
    }

    /// Lists the paths that can be shaded together.
    fn sort_by_class(&mut self, depth: u32) {
        self.classes.iter_mut().for_each(Vec::clear);
        self.leaving.clear();
        self.triangles.clear();
        let world = self.integrator.world();
        let goes_on = self.integrator.goes_beyond(depth);
        if !world.shades_in_lanes() {
            self.classes[BsdfClass::Other as usize].extend(0..self.paths.len() as u32);
            return;
        }
        for (i, (hit, path)) in self.hits.iter().zip(&self.paths).enumerate() {
            let (mut class, mut triangle) = (BsdfClass::Other, (InstanceId::from_index(0), 0));
            if !hit.is_hit() && path.is_in_air() {
                self.leaving.push(i as u32);
                self.triangles.push(triangle);
                continue;
            }
            if hit.is_hit() && (goes_on || depth > 1) && !path.has_passed() {
                let (instance, index, found) = world.classify(hit);
                triangle = (instance, index);
                if !goes_on && found != BsdfClass::Other {
                    // All that counts at the end of a path is emission, and no class emits.
                    self.triangles.push(triangle);
                    continue;
                }
                let material = || world.scene.instances[instance.index()].material;
                let is_glass = found == BsdfClass::SmoothGlass;
                if path.is_in_air() || (is_glass && path.is_only_in(material())) {
                    class = found;
                }
            }
            self.triangles.push(triangle);
            self.classes[class as usize].push(i as u32);
        }
    }

    /// Shades the paths of a class, many at once.
    #[inline(always)]
    fn shade_class<L: Lanes, B: BsdfLanes<L>>(&mut self, lanes: L, class: BsdfClass, depth: u32) {
        let Self { integrator, rays, hits, triangles, paths, alive, samples, follows, .. } = self;
        let shadow_rays = &mut self.shadow_rays;
        let (others, classes) = self.classes.split_first_mut().expect("four classes");
        let vertices =
            &mut Vertices { rays, hits, triangles, paths, alive, samples, follows, shadow_rays };
        let order = &classes[class as usize - 1];
        shade_in_lanes::<L, B>(integrator, lanes, depth, order, vertices, others);
    }

    /// Adds the environment to the paths that leave the scene.
    #[inline(always)]
    fn add_environment<L: Lanes>(&mut self, lanes: L) {
        let Self { integrator, rays, hits, triangles, paths, alive, samples, follows, .. } = self;
        let shadow_rays = &mut self.shadow_rays;
        let vertices =
            &mut Vertices { rays, hits, triangles, paths, alive, samples, follows, shadow_rays };
        add_environment_in_lanes(integrator, lanes, &self.leaving, vertices);
    }

    /// Shades all other paths, one by one.
    #[inline(always)]
    fn shade_others(&mut self, depth: u32) {
        for &i in &self.classes[BsdfClass::Other as usize] {
            let i = i as usize;
            let (path, ray) = (&mut self.paths[i], self.rays[i]);
            let sample = &mut self.samples[path.slot as usize];
            let step = self.integrator.advance(depth, path, &ray, &self.hits[i], sample);
            self.follows |= depth == 1 && sample.first.is_some_and(|first| first.goes_on);
            if let Some(shadow) = step.shadow {
                self.shadow_rays.push(path, shadow);
            }
            if let Some(transit) = step.transit {
                self.transits.push(path, ray_key(path.key, 2 * depth + 1), transit);
            }
            if let Some(next) = step.next {
                self.rays[i] = next;
                self.alive[i] = true;
            }
        }
    }

    /// Moves the paths that go on up to the front, in order.
    fn close_ranks(&mut self, depth: u32) {
        let mut kept = 0;
        for i in 0..self.paths.len() {
            if self.alive[i] {
                self.paths[kept] = self.paths[i];
                self.rays[kept] = self.rays[i];
                kept += 1;
            } else {
                let path = &self.paths[i];
                self.segments[path.slot as usize] = depth;
                self.counts.cut += u64::from(self.integrator.cuts(depth, path, &self.hits[i]));
            }
        }
        self.paths.truncate(kept);
        self.rays.truncate(kept);
    }

    /// Traces the shadow rays and adds the light of those that nothing blocks.
    fn trace_shadow_rays(&mut self, depth: u32) {
        let world = self.integrator.world();
        let ShadowRays { rays, ends, keys, times } = &mut self.shadow_rays;
        for key in keys.iter_mut() {
            *key = ray_key(*key, 2 * depth + 1);
        }
        let slice = Slice { rays, keys, times };
        find_blocked(world, &mut *self.tracer, &slice, &mut self.blocked);
        self.counts.shadow += rays.len() as u64;
        for (end, blocked) in ends.iter().zip(&self.blocked) {
            if !blocked.0 {
                self.samples[end.slot as usize].radiance += end.radiance;
            }
        }
    }
}

impl Stream<'_> {
    /// Takes lights through borders, and adds those that arrive.
    fn trace_transits(&mut self) {
        let world = self.integrator.world();
        while !self.transits.rays.is_empty() {
            let Transits { rays, keys, times, .. } = &self.transits;
            let slice = Slice { rays, keys, times };
            find_hits(world, &mut *self.tracer, &slice, None, &mut self.hits);
            self.counts.shadow += rays.len() as u64;
            let samples = &mut self.samples;
            self.transits.cross(world, &self.hits, |slot, radiance| {
                samples[slot as usize].radiance += radiance;
            });
        }
    }
}

/// The alpha filter's key of a path's ray number `ray`, so that each ray draws anew.
pub(super) fn ray_key(path: u64, ray: u32) -> u64 {
    path.wrapping_add(u64::from(ray).wrapping_mul(0xd1b5_4a32_d192_ed03))
}
