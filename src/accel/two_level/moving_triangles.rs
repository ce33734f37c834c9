//! What moves and is small: its triangles lie in the upper trees themselves.
//!
//! To take a ray into a placement that moves takes long: where it stands is found for the ray's
//! time, and the way back from there. So the triangles of small placements are put by themselves
//! into trees of their own, one for each part of the time. A triangle goes about straight over such
//! a part: its box is that of both ends, grown by how far it may be from there, and blocks of eight
//! are filtered where they are at a ray's time ([`MovingBlock`][block]). Only what passes is asked
//! about by the exact test, with its vertices as they are at the time.
//!
//! [block]: crate::geom::MovingBlock

use rayon::prelude::*;

use super::body::Body;
use super::levels::Levels;
use super::placement::Shape;
use super::sources::FlatTriangles;
use super::timed_boxes::ends_of_part;
use crate::geom::{Motions, MovingTriangle, Posed, Triangle, TriangleSource};
use crate::math::{Aabb, Affine3A, InstanceId, MeshId, PrimId, TriangleId, Vec3};
use crate::motion::Piece;

/// So many triangles in all parts of the time, of some 120 bytes each: beyond what a core's cache
/// holds it is faster to walk the structures of meshes.
const MOST_TRIANGLES: usize = 1 << 16;

/// So many are met without a tree as fast as with one, or with a body: three blocks of eight.
pub const FEW_TRIANGLES: usize = 24;

/// So many boxes of triangles, of which a ray meets eight at once, are met as fast as a placement
/// is entered.
const MOST_BOXES: f64 = 24.0;

/// A placement of more pieces stays whole.
const MOST_PIECES: usize = 4096;

/// So many parts of the time are looked at to count these.
const SAMPLES: usize = 4;

/// The triangles of small placements that move.
pub struct MovingTriangles {
    flat: FlatTriangles,
    chosen: Vec<Chosen>,
    /// The other placements that move, but for those in bodies, by their numbers among all these.
    rest: Vec<u32>,
}

/// A placement whose triangles are by themselves.
struct Chosen {
    placement: InstanceId,
    mesh: MeshId,
    shape: Shape,
    /// Of its way.
    pieces: Vec<Piece>,
}

impl MovingTriangles {
    /// Chooses placements that are in no body: those of the fewest triangles, as long as there is
    /// room, where rays that meet the placement's box meet few of its triangles'. What moves and is
    /// deformed stays whole.
    pub fn choose(levels: &Levels, bodies: &[Body]) -> Self {
        let placements = levels.placed.get();
        let moving = &levels.placements[levels.still..];
        let mut taken = vec![false; moving.len()];
        for member in bodies.iter().flat_map(|body| &body.members) {
            taken[*member as usize] = true;
        }
        let Some(motions) = placements.motions() else {
            return Self::of(levels, &taken, Vec::new());
        };
        let mesh = |number: &u32| placements.mesh(moving[*number as usize]);
        let is_plain = |number: &u32| {
            !motions.is_deforming(mesh(number)) || motions.stays(moving[*number as usize])
        };
        let len = |number: &u32| placements.mesh_len(mesh(number));
        let is_free = |number: &u32| !taken[*number as usize];
        let free = (0..moving.len() as u32).filter(is_free);
        let mut numbers: Vec<u32> = free.filter(is_plain).collect();
        numbers.sort_by_key(len);
        let mut room = MOST_TRIANGLES / levels.timed_boxes.parts();
        let fits = |number: &u32| {
            let left = room.checked_sub(len(number));
            room = left.unwrap_or(room);
            left.is_some()
        };
        let mut numbers: Vec<u32> = numbers.into_iter().take_while(fits).collect();
        numbers.sort_unstable();
        let choose = |number: u32| {
            let (placement, mesh) = (moving[number as usize], mesh(&number));
            let shape = levels.shapes[mesh.index()]?;
            let pieces = shape.pieces(motions, placement);
            let chosen = Chosen { placement, mesh, shape, pieces };
            chosen.pays(levels, motions).then_some((number, chosen))
        };
        Self::of(levels, &taken, numbers.into_par_iter().filter_map(choose).collect())
    }

    fn of(levels: &Levels, taken: &[bool], chosen: Vec<(u32, Chosen)>) -> Self {
        let (numbers, chosen): (Vec<u32>, Vec<Chosen>) = chosen.into_iter().unzip();
        let is_rest =
            |number: &u32| !taken[*number as usize] && numbers.binary_search(number).is_err();
        let rest = (0..taken.len() as u32).filter(is_rest).collect();
        let placements = chosen.iter().map(|chosen| chosen.placement).collect();
        Self { flat: FlatTriangles::new(levels.placed.clone(), placements), chosen, rest }
    }

    /// How many triangles they have.
    pub fn len(&self) -> usize {
        self.flat.len()
    }

    /// Whose a triangle is.
    #[inline(always)]
    pub fn locate(&self, prim: PrimId) -> TriangleId {
        self.flat.locate(prim)
    }

    /// The other placements that move, but for those in bodies, by their numbers among all these.
    pub fn rest(&self) -> &[u32] {
        &self.rest
    }

    /// Of each mesh, whether a placement that is kept apart is neither among these nor in a body.
    pub fn find_meshes_of_others(&self, levels: &Levels) -> Vec<bool> {
        let placements = levels.placed.get();
        let (still, moving) = levels.placements.split_at(levels.still);
        let mut others = vec![false; placements.meshes()];
        let rest = self.rest.iter().map(|&number| &moving[number as usize]);
        for placement in still.iter().chain(rest) {
            others[placements.mesh(*placement).index()] = true;
        }
        others
    }

    /// All triangles over a part of the time.
    pub fn over(&self, levels: &Levels, part: usize) -> Vec<MovingTriangle> {
        let Some(motions) = levels.placed.get().motions() else { return Vec::new() };
        let over = |chosen: &Chosen| chosen.over(levels, motions, part);
        self.chosen.iter().flat_map(over).collect()
    }

    /// Bytes of the lists.
    pub fn bytes(&self) -> usize {
        let pieces = self.chosen.iter().map(|chosen| size_of_val(&*chosen.pieces));
        size_of_val(&*self.rest) + size_of_val(&*self.chosen) + pieces.sum::<usize>()
    }
}

/// A mesh where it is at a time.
struct End<'a> {
    to_world: Affine3A,
    posed: Posed<'a>,
}

impl End<'_> {
    fn triangle(&self, index: u32) -> Triangle {
        let [a, b, c] = self.posed.triangle(index).corners().map(|corner| self.place(corner));
        Triangle { a, b, c }
    }

    fn place(&self, corner: Vec3) -> Vec3 {
        self.to_world.transform_point3(corner)
    }
}

impl Chosen {
    /// Its triangles over a part of the time.
    fn over(&self, levels: &Levels, motions: &dyn Motions, part: usize) -> Vec<MovingTriangle> {
        let Self { placement, mesh, ref shape, .. } = *self;
        let placements = levels.placed.get();
        let parts = levels.timed_boxes.parts();
        let span = [part, part + 1].map(|end| end as f64 / parts as f64);
        let times = ends_of_part(part, parts);
        let ends = times.map(|time| End {
            to_world: motions.to_world_at(placement, time),
            posed: motions.mesh_at(mesh, time),
        });
        let bend = motions.bend(placement, shape.reach().length(), span);
        // Where its way bends within the part.
        let bends: Vec<Bend> = match bend {
            Some(_) => Vec::new(),
            None => self.bends(motions, span).collect(),
        };
        let transforms = ends.iter().map(|end| &end.to_world);
        let transforms = transforms.chain(bends.iter().map(|bend| &bend.to_world));
        let rounding = transforms.map(|to_world| shape.rounding(to_world)).fold(0.0, f64::max);
        let scale = ends.iter().map(|end| infinity_norm(&end.to_world)).fold(0.0, f64::max);
        let triangle = |index: u32| {
            let [from, to] = ends.each_ref().map(|end| end.triangle(index));
            let off = bend.unwrap_or_else(|| {
                leave(&ends[0].posed.triangle(index), [&from, &to], (span, &bends))
            });
            let bent = f64::from(motions.bend_of_mesh(mesh, index, times)) * scale;
            // The end is up to 2^-24 of all of the time late.
            let late = longest(&from, &to) * parts as f64 * f64::from(f32::EPSILON);
            let slack = (off + bent + rounding + late) * (1.0 + 1e-6);
            MovingTriangle { from, to, slack: slack as f32 }
        };
        (0..placements.mesh_len(mesh) as u32).map(triangle).collect()
    }

    /// The pieces of its way that lie in a span of the time.
    fn bends<'a>(
        &'a self,
        motions: &'a dyn Motions,
        [from, to]: [f64; 2],
    ) -> impl Iterator<Item = Bend> + 'a {
        let within = self
            .pieces
            .iter()
            .filter(move |Piece { span: [begin, end], .. }| *begin <= to && *end >= from);
        within.map(|piece| Bend {
            piece: *piece,
            to_world: motions.to_world_at(self.placement, piece.middle),
        })
    }

    /// Whether it stays among numbers that are told apart, and rays that meet the box of the
    /// placement meet few of its triangles', by their areas.
    fn pays(&self, levels: &Levels, motions: &dyn Motions) -> bool {
        let parts = levels.timed_boxes.parts();
        let is_finite = |piece: &Piece| {
            let at = motions.to_world_at(self.placement, piece.middle);
            at.is_finite() && piece.margin.is_finite()
        };
        if self.pieces.len() > MOST_PIECES || !self.pieces.iter().all(is_finite) {
            return false;
        }
        let (mut of_triangles, mut of_placement) = (0.0, 0.0);
        for part in (0..parts).step_by(parts.div_ceil(SAMPLES)) {
            let boxes = self.over(levels, motions, part);
            let boxes = boxes.iter().map(MovingTriangle::bounds);
            of_triangles += boxes.clone().map(Aabb::half_area).sum::<f64>();
            of_placement += boxes.fold(Aabb::EMPTY, Aabb::union).half_area();
        }
        of_placement.is_finite() && of_triangles <= MOST_BOXES * of_placement
    }
}

/// Between two keys that lie in a part of the time.
struct Bend {
    piece: Piece,
    /// In its middle.
    to_world: Affine3A,
}

/// Bounds by how much a triangle whose `corners` keep their places in a placement leaves the way
/// `from` its first end `to` the last, over a part of the time.
fn leave(
    corners: &Triangle,
    [from, to]: [&Triangle; 2],
    ([start, end], bends): ([f64; 2], &[Bend]),
) -> f64 {
    let mut most = 0.0_f64;
    for Bend { piece, to_world } in bends {
        for time in piece.span.map(|time| time.clamp(start, end)) {
            let place = (time - start) / (end - start);
            let ways = from.corners().into_iter().zip(to.corners());
            for (corner, (from, to)) in corners.corners().into_iter().zip(ways) {
                let straight = from.as_dvec3().lerp(to.as_dvec3(), place);
                let at = to_world.transform_point3(corner).as_dvec3();
                most = most.max(at.distance(straight) + piece.margin);
            }
        }
    }
    most
}

/// How far any vertex goes, along any axis.
fn longest(from: &Triangle, to: &Triangle) -> f64 {
    let ways = from.corners().into_iter().zip(to.corners());
    ways.map(|(from, to)| f64::from((to - from).abs().max_element())).fold(0.0, f64::max)
}

/// By how much more something is off along an axis of the world, at most, than in the mesh's space.
fn infinity_norm(to_world: &Affine3A) -> f64 {
    let columns = [0, 1, 2].map(|axis| to_world.matrix3.col(axis).as_dvec3().abs());
    (columns[0] + columns[1] + columns[2]).max_element()
}
