//! Which placements that move are one stiff body, since they keep their places to each other.
//!
//! The blades of a fan overlap in space, and so do the parts of a car: a ray that passes would
//! enter one after the other, each by a way of its own. As one body it enters once.

use std::collections::{BTreeSet, HashMap};

use glam::DAffine3;
use rayon::prelude::*;

use super::body::Body;
use super::levels::Levels;
use super::moving_triangles::FEW_TRIANGLES;
use crate::geom::Placements;
use crate::math::MeshId;
use crate::motion::Frame;

/// In larger crowds no bodies are looked for.
const MOST_MOVING: usize = 1 << 16;
/// The most bodies; each may have ways of 200 KB.
const MOST_BODIES: usize = 256;
/// Copies within bodies are not shared. So all bodies have no more triangles than this, or than
/// twice those of their meshes.
const MOST_TRIANGLES: usize = 1 << 16;

/// Placements with a space in common: the number of each among those that move, and where in that
/// space it is.
struct Group {
    members: Vec<(u32, DAffine3)>,
    /// Of all members.
    triangles: usize,
    meshes: BTreeSet<MeshId>,
}

/// Finds the bodies among what moves, but for those of few triangles.
pub fn find_bodies(levels: &Levels) -> Vec<Body> {
    let Some(motions) = levels.placed.get().motions() else { return Vec::new() };
    let groups = choose(levels.placed.get(), find_groups(levels));
    let body = |group: Group| Body::new(levels, motions, &group.members);
    groups.into_par_iter().filter_map(body).collect()
}

/// All that move with others and keep their shapes.
fn find_groups(levels: &Levels) -> Vec<Group> {
    let placements = levels.placed.get();
    let moving = &levels.placements[levels.still..];
    let Some(motions) = placements.motions().filter(|_| moving.len() <= MOST_MOVING) else {
        return Vec::new();
    };
    let mut found: HashMap<Frame, usize> = HashMap::new();
    let mut groups: Vec<Group> = Vec::new();
    for (number, &placement) in moving.iter().enumerate() {
        let mesh = placements.mesh(placement);
        let Some((frame, inner)) = motions.frame(placement) else { continue };
        if motions.is_deforming(mesh) {
            continue;
        }
        let group = *found.entry(frame).or_insert(groups.len());
        if group == groups.len() {
            groups.push(Group { members: Vec::new(), triangles: 0, meshes: BTreeSet::new() });
        }
        let Group { members, triangles, meshes } = &mut groups[group];
        members.push((number as u32, inner));
        *triangles = triangles.saturating_add(placements.mesh_len(mesh));
        meshes.insert(mesh);
    }
    groups.retain(|group| group.members.len() > 1 && group.triangles > FEW_TRIANGLES);
    groups
}

/// Those for which there is room; such as copy the least come first.
fn choose(placements: &dyn Placements, mut groups: Vec<Group>) -> Vec<Group> {
    let unique = |meshes: &BTreeSet<MeshId>| -> usize {
        meshes.iter().map(|&mesh| placements.mesh_len(mesh)).sum()
    };
    let all = groups.iter().flat_map(|group| &group.meshes).copied().collect();
    let mut room = unique(&all).saturating_mul(2).max(MOST_TRIANGLES);
    groups.sort_by_cached_key(|group| group.triangles.saturating_sub(unique(&group.meshes)));
    groups.retain(|group| {
        let left = room.checked_sub(group.triangles);
        room = left.unwrap_or(room);
        left.is_some()
    });
    groups.sort_by_key(|group| std::cmp::Reverse(group.triangles));
    groups.truncate(MOST_BODIES);
    groups
}
