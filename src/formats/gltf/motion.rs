//! How nodes move while the shutter is open.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};

use super::animation::{Animation, Keyed, Property};
use super::json::Fault;
use super::nodes::{self, Node, Placed};
use super::read::Storage;
use crate::motion::{Link, Motion, MovingParts, Track};

/// The most nodes, one within the other, that move.
const MOST: usize = 256;

/// The motions of a document's nodes while the shutter is open.
pub struct NodeMotions {
    /// By node; none: it does not move.
    motions: Vec<Option<Arc<Motion>>>,
    /// The nodes whose morph weights change.
    morphs: BTreeSet<usize>,
    /// The times from 0 to 1 at which anything changes its way, in order.
    times: Vec<f64>,
}

impl NodeMotions {
    /// The motions by an animation from a time to another, seconds, of `nodes`, which are `placed`
    /// as they are at the first of them.
    ///
    /// # Errors
    /// What is wrong with the animation, too many nodes that move within each other.
    pub fn read(
        animation: &Animation,
        (nodes, placed): (&[Node], &[Placed]),
        shutter: [f64; 2],
        storage: &Storage,
    ) -> Result<Self, Fault> {
        let keyed = animation.keyed(shutter, storage)?;
        let mut times: Vec<f64> =
            keyed.iter().flat_map(|keyed| keyed.keys.iter().map(|key| key.0)).collect();
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        let mut parts: BTreeMap<usize, MovingParts> = BTreeMap::new();
        let mut morphs = BTreeSet::new();
        for Keyed { node, property, keys } in &keyed {
            if *property == Property::Weights {
                if keys.iter().any(|key| key.1 != keys[0].1) {
                    morphs.insert(*node);
                }
                continue;
            }
            // What is wrong with a pointer has been said.
            let numbers = if *property == Property::Rotation { 4 } else { 3 };
            let Some(still) = nodes.get(*node).map(|node| &node.parts) else { continue };
            if keys.iter().any(|key| key.1.len() != numbers) {
                continue;
            }
            let parts = parts.entry(*node).or_insert_with(|| MovingParts {
                translation: Track::still(still.translation),
                rotation: Track::still(still.rotation),
                scale: Track::still(still.scale),
            });
            let vector = |v: &[f64]| DVec3::new(v[0], v[1], v[2]);
            let vectors = || keys.iter().map(|(time, v)| (*time, vector(v))).collect::<Vec<_>>();
            match property {
                Property::Translation => set(&mut parts.translation, Track::new(&vectors())),
                Property::Scale => set(&mut parts.scale, Track::new(&vectors())),
                _ => {
                    let turn = |(time, q): &(f64, Vec<f64>)| {
                        (*time, DQuat::from_xyzw(q[0], q[1], q[2], q[3]).normalize())
                    };
                    let turns: Vec<_> = keys.iter().map(turn).collect();
                    if turns.iter().any(|(_, turn)| !turn.is_finite()) {
                        let place = format!("/nodes/{node}");
                        return Err(Fault::new(place, "is turned by no rotation: its length is 0"));
                    }
                    set(&mut parts.rotation, Track::new(&turns));
                }
            }
        }
        let motions = chains(nodes, placed, parts)?;
        Ok(Self { motions, morphs, times })
    }

    /// The motion of a node, if it or one around it moves.
    pub fn of(&self, node: usize) -> Option<&Arc<Motion>> {
        self.motions[node].as_ref()
    }

    /// Whether the weights of a node's morph targets change.
    pub fn morphs(&self, node: usize) -> bool {
        self.morphs.contains(&node)
    }

    /// The times from 0 to 1 at which anything changes its way, in order.
    pub fn times(&self) -> &[f64] {
        &self.times
    }
}

fn set<T>(slot: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *slot = value;
    }
}

/// Of each node the chain of what moves it.
fn chains(
    nodes: &[Node],
    placed: &[Placed],
    parts: BTreeMap<usize, MovingParts>,
) -> Result<Vec<Option<Arc<Motion>>>, Fault> {
    let parts: BTreeMap<usize, Arc<MovingParts>> = parts
        .into_iter()
        .filter(|(_, parts)| parts.moves())
        .map(|(node, parts)| (node, Arc::new(parts)))
        .collect();
    let parents = nodes::parents(nodes)?;
    let mut worlds = vec![DAffine3::IDENTITY; nodes.len()];
    let mut motions: Vec<Option<Arc<Motion>>> = vec![None; nodes.len()];
    for at in placed {
        worlds[at.node] = at.to_world;
        let outer = parents[at.node].and_then(|parent| motions[parent].clone());
        let motion = match (outer, parts.get(&at.node)) {
            (None, None) => None,
            (Some(outer), None) => Some(outer.around(nodes[at.node].local)),
            (Some(outer), Some(parts)) => Some(outer.then(Arc::clone(parts))),
            (None, Some(parts)) => {
                let around = parents[at.node].map_or(DAffine3::IDENTITY, |parent| worlds[parent]);
                Motion::new([Link::Still(around), Link::Moving(Arc::clone(parts))])
            }
        };
        if motion.as_ref().is_some_and(|motion| motion.links().len() > MOST) {
            let message = format!("moves within more than {MOST} nodes that move");
            return Err(Fault::new(format!("/nodes/{}", at.node), message));
        }
        motions[at.node] = motion.map(Arc::new);
    }
    Ok(motions)
}
