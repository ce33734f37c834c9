//! Animations (glTF 2.0, 3.11), posed at one time.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

use super::animatable::{self, Kind};
use super::curve::{Curve, Interpolation};
use super::json::{Fault, Object};
use super::nodes::{Node, Parts};
use super::notices::Notices;
use super::read::Storage;

/// An animation.
#[derive(Clone, Debug)]
pub struct Animation {
    /// What the file calls it.
    pub name: String,
    channels: Vec<Channel>,
}

/// What a pointer leads to, at a time.
pub struct Pointed<'a> {
    /// The pointer to what tells it, in its channel.
    pub place: String,
    /// What is animated (KHR_animation_pointer).
    pub pointer: &'a str,
    /// Its numbers.
    pub numbers: Vec<f64>,
}

/// A property over time.
#[derive(Clone, Debug)]
struct Channel {
    /// The pointer to its sampler.
    place: String,
    target: Target,
    interpolation: Interpolation,
    /// The accessor of its times, seconds.
    times: usize,
    /// The accessor of its values.
    values: usize,
}

#[derive(Clone, Debug)]
enum Target {
    /// A property of a node.
    Node(usize, Property),
    /// Whatever a pointer into the document leads to; and the pointer to that pointer.
    Pointer(String, String),
}

/// What a channel changes of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// Where it stands.
    Translation,
    /// How it is turned.
    Rotation,
    /// How large it is.
    Scale,
    /// The weights of its morph targets.
    Weights,
}

/// What becomes of a property while the shutter is open: values at times from 0 to 1, in order,
/// between which they go straight, and rotations turn evenly. Where two times are the same, it
/// jumps.
pub struct Keyed {
    /// Whose it is.
    pub node: usize,
    /// Which.
    pub property: Property,
    /// The values.
    pub keys: Vec<(f64, Vec<f64>)>,
}

/// Reads all animations; `nodes` and `accessors` are how many there are.
pub fn read(
    root: &Object,
    nodes: usize,
    accessors: usize,
    notices: &mut Notices,
) -> Result<Vec<Animation>, Fault> {
    let mut animation = |object: &Object| {
        let samplers: Vec<_> = object
            .objects("samplers")?
            .iter()
            .map(|object| sampler(object, accessors))
            .collect::<Result<_, _>>()?;
        let mut channels = Vec::new();
        for channel in object.objects("channels")? {
            let sampler = channel.required_reference("sampler", "sampler", samplers.len())?;
            let target = channel.object("target")?.ok_or_else(|| channel.absent("target"))?;
            if let Some(extension) = target.extension("KHR_animation_pointer")? {
                let pointer = extension.text("pointer")?;
                let pointer = pointer.ok_or_else(|| extension.absent("pointer"))?.to_owned();
                let (place, interpolation, times, values) = samplers[sampler].clone();
                let target = Target::Pointer(pointer, extension.at("pointer"));
                channels.push(Channel { place, target, interpolation, times, values });
                continue;
            }
            let Some(node) = target.reference("node", "node", nodes)? else {
                if target.text("path")? == Some("pointer") {
                    notices.add(target.place(), "goes by a pointer and has none");
                }
                continue;
            };
            let property = match target.text("path")?.ok_or_else(|| target.absent("path"))? {
                "translation" => Property::Translation,
                "rotation" => Property::Rotation,
                "scale" => Property::Scale,
                "weights" => Property::Weights,
                other => {
                    notices.add(target.at("path"), format!("{other:?} is not animated"));
                    continue;
                }
            };
            let (place, interpolation, times, values) = samplers[sampler].clone();
            let target = Target::Node(node, property);
            channels.push(Channel { place, target, interpolation, times, values });
        }
        Ok(Animation { name: object.name()?, channels })
    };
    root.objects("animations")?.iter().map(&mut animation).collect()
}

fn sampler(
    object: &Object,
    accessors: usize,
) -> Result<(String, Interpolation, usize, usize), Fault> {
    let interpolation = match object.text("interpolation")?.unwrap_or("LINEAR") {
        "STEP" => Interpolation::Step,
        "LINEAR" => Interpolation::Linear,
        "CUBICSPLINE" => Interpolation::Cubic,
        other => {
            let message = format!("{other:?} is none of STEP, LINEAR and CUBICSPLINE");
            return Err(object.fault_at("interpolation", message));
        }
    };
    let times = object.required_reference("input", "accessor", accessors)?;
    let values = object.required_reference("output", "accessor", accessors)?;
    Ok((object.place().to_owned(), interpolation, times, values))
}

impl Animation {
    /// The accessors that it reads.
    pub fn accessors(&self) -> impl Iterator<Item = usize> {
        self.channels.iter().flat_map(|channel| [channel.times, channel.values])
    }

    /// What it changes of nodes while the shutter is open, from a time to another, in seconds.
    ///
    /// # Errors
    /// As [`Animation::pose`].
    pub fn keyed(&self, shutter: [f64; 2], storage: &Storage) -> Result<Vec<Keyed>, Fault> {
        let of_nodes =
            self.channels.iter().filter_map(|channel| Some((channel, channel.target.of_node()?)));
        let keyed = |(channel, (node, property)): (&Channel, _)| {
            let keys = channel.curve(storage)?.straight_pieces(shutter);
            Ok(Keyed { node, property, keys })
        };
        of_nodes.map(keyed).collect()
    }

    /// Notes what pointers lead to that is no property of a node: it stands still while the
    /// shutter is open, though it changes.
    ///
    /// # Errors
    /// As [`Animation::pose`].
    pub fn note_frozen(
        &self,
        shutter: [f64; 2],
        storage: &Storage,
        notices: &mut Notices,
    ) -> Result<(), Fault> {
        for channel in &self.channels {
            let Target::Pointer(pointer, _) = &channel.target else { continue };
            if channel.target.of_node().is_some() || animatable::kind(pointer).is_none() {
                continue;
            }
            let keys = channel.curve(storage)?.straight_pieces(shutter);
            if keys.iter().any(|key| key.1 != keys[0].1) {
                let message = format!("{pointer:?} stands still while the shutter is open");
                notices.add(channel.place.clone(), message);
            }
        }
        Ok(())
    }

    /// What its pointers lead to, at a `time`, seconds.
    ///
    /// # Errors
    /// As [`Animation::pose`].
    pub fn pointed(&self, time: f64, storage: &Storage) -> Result<Vec<Pointed<'_>>, Fault> {
        let pointed = self.channels.iter().filter_map(|channel| match &channel.target {
            Target::Pointer(pointer, place) => Some((channel, pointer, place)),
            Target::Node(..) => None,
        });
        pointed
            .map(|(channel, pointer, place)| {
                let (place, numbers) = (place.clone(), channel.at(time, storage)?);
                Ok(Pointed { place, pointer, numbers })
            })
            .collect()
    }

    /// Moves the nodes to where they are at a `time`, seconds; before the first and after the last
    /// of a channel's times it holds still.
    ///
    /// # Errors
    /// Times that do not grow, values that are not as many as they need to be.
    pub fn pose(&self, nodes: &mut [Node], time: f64, storage: &Storage) -> Result<(), Fault> {
        let mut moved: BTreeMap<usize, Parts> = BTreeMap::new();
        for channel in &self.channels {
            let Some((number, property)) = channel.target.of_node() else { continue };
            // What is wrong with a pointer has been said.
            let Some(node) = nodes.get_mut(number) else { continue };
            let value = channel.at(time, storage)?;
            let parts = moved.entry(number).or_insert(node.parts);
            match (property, &value[..]) {
                (Property::Translation, &[x, y, z]) => parts.translation = DVec3::new(x, y, z),
                (Property::Scale, &[x, y, z]) => parts.scale = DVec3::new(x, y, z),
                (Property::Rotation, &[x, y, z, w]) => {
                    let rotation = DQuat::from_xyzw(x, y, z, w);
                    if rotation.length() < 1e-6 {
                        return Err(channel.fault("turns by no rotation: its length is 0"));
                    }
                    parts.rotation = rotation.normalize();
                }
                (Property::Weights, weights) => {
                    node.weights = Some(weights.iter().map(|&weight| weight as f32).collect());
                }
                _ => {}
            }
        }
        for (node, parts) in moved {
            nodes[node].local = parts.local();
        }
        Ok(())
    }
}

impl Target {
    /// The node and its property, if it is one's.
    fn of_node(&self) -> Option<(usize, Property)> {
        match self {
            Self::Node(node, property) => Some((*node, *property)),
            Self::Pointer(pointer, _) => Property::of_pointer(pointer),
        }
    }
}

impl Channel {
    /// The property that it is interpolated as: of what is pointed to, weights are as all else.
    fn property(&self) -> Property {
        match &self.target {
            Target::Node(_, property) => *property,
            Target::Pointer(to, _) if animatable::kind(to) == Some(Kind::Turn) => {
                Property::Rotation
            }
            Target::Pointer(..) => Property::Weights,
        }
    }

    /// The numbers of all its keys.
    fn values(&self, storage: &Storage) -> Result<Vec<f32>, Fault> {
        let is_pointed = matches!(self.target, Target::Pointer(..));
        let width = match self.property() {
            Property::Translation | Property::Scale => 3,
            Property::Rotation => 4,
            Property::Weights if is_pointed => storage.accessor(self.values).numbers(),
            Property::Weights => 1,
        };
        Ok(match width {
            2 => storage.vectors::<2>(self.values)?.into_flattened(),
            3 => storage.vectors::<3>(self.values)?.into_flattened(),
            4 => storage.vectors::<4>(self.values)?.into_flattened(),
            _ => storage.vectors::<1>(self.values)?.into_flattened(),
        })
    }

    fn fault(&self, message: impl Into<String>) -> Fault {
        Fault::new(self.place.clone(), message)
    }

    /// The property's numbers at a time.
    fn at(&self, time: f64, storage: &Storage) -> Result<Vec<f64>, Fault> {
        Ok(self.curve(storage)?.at(time))
    }

    /// Its keys.
    fn curve(&self, storage: &Storage) -> Result<Curve, Fault> {
        let times = storage.vectors::<1>(self.times)?;
        let values = self.values(storage)?;
        let times: Vec<f64> = times.iter().map(|&[time]| f64::from(time)).collect();
        if times.is_empty() || !times.is_sorted_by(|a, b| a < b) {
            return Err(self.fault("its times do not grow from one to the next"));
        }
        let interpolation = self.interpolation;
        let sets = times.len() * if interpolation == Interpolation::Cubic { 3 } else { 1 };
        let width = match self.property() {
            Property::Translation | Property::Scale => 3,
            Property::Rotation => 4,
            Property::Weights => (values.len() / sets).max(1),
        };
        if values.len() != sets * width || values.iter().any(|value| !value.is_finite()) {
            let message =
                format!("{} times do not go with its {} numbers", times.len(), values.len());
            return Err(self.fault(message));
        }
        let turns = self.property() == Property::Rotation;
        Ok(Curve { interpolation, turns, times, values, width })
    }
}

impl Property {
    /// The property of a node that a pointer leads to, if it leads to one.
    pub fn of_pointer(pointer: &str) -> Option<(usize, Self)> {
        let (node, name) = pointer.strip_prefix("/nodes/")?.split_once('/')?;
        let property = match name {
            "translation" => Self::Translation,
            "rotation" => Self::Rotation,
            "scale" => Self::Scale,
            "weights" => Self::Weights,
            _ => return None,
        };
        Some((node.parse().ok()?, property))
    }
}
