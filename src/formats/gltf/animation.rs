//! Animations (glTF 2.0, 3.11), posed at one time.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};

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
    /// The pointer to the sampler.
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
    /// Whatever a pointer into the document leads to.
    Pointer(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Property {
    Translation,
    Rotation,
    Scale,
    Weights,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Interpolation {
    Step,
    Linear,
    Cubic,
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
                let target = Target::Pointer(pointer);
                channels.push(Channel { place, target, interpolation, times, values });
                continue;
            }
            let Some(node) = target.reference("node", "node", nodes)? else { continue };
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

    /// What its pointers lead to, at a `time`, seconds.
    ///
    /// # Errors
    /// As [`Animation::pose`].
    pub fn pointed(&self, time: f64, storage: &Storage) -> Result<Vec<Pointed<'_>>, Fault> {
        let pointed = self.channels.iter().filter_map(|channel| match &channel.target {
            Target::Pointer(pointer) => Some((channel, pointer)),
            Target::Node(..) => None,
        });
        pointed
            .map(|(channel, pointer)| {
                let (place, numbers) = (channel.place.clone(), channel.at(time, storage)?);
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
            let Target::Node(number, property) = channel.target else { continue };
            let value = channel.at(time, storage)?;
            let node = &mut nodes[number];
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
                (_, weights) => {
                    node.weights = Some(weights.iter().map(|&weight| weight as f32).collect());
                }
            }
        }
        for (node, parts) in moved {
            nodes[node].local = parts.local();
        }
        Ok(())
    }
}

impl Channel {
    /// The property that it is interpolated as: of what is pointed to, weights are as all else.
    fn property(&self) -> Property {
        match &self.target {
            Target::Node(_, property) => *property,
            Target::Pointer(to) if to.starts_with("/nodes/") && to.ends_with("/rotation") => {
                Property::Rotation
            }
            Target::Pointer(_) => Property::Weights,
        }
    }

    /// The numbers of all its keys.
    fn values(&self, storage: &Storage) -> Result<Vec<f32>, Fault> {
        let is_pointed = matches!(self.target, Target::Pointer(_));
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
        let times = storage.vectors::<1>(self.times)?;
        let values = self.values(storage)?;
        let times: Vec<f64> = times.iter().map(|&[time]| f64::from(time)).collect();
        if times.is_empty() || !times.is_sorted_by(|a, b| a < b) {
            return Err(self.fault("its times do not grow from one to the next"));
        }
        let sets = times.len() * if self.interpolation == Interpolation::Cubic { 3 } else { 1 };
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
        Ok(self.between(time, &times, &values, width))
    }

    fn between(&self, time: f64, times: &[f64], values: &[f32], width: usize) -> Vec<f64> {
        let set = |number: usize| -> Vec<f64> {
            values[number * width..][..width].iter().map(|&value| f64::from(value)).collect()
        };
        let cubic = self.interpolation == Interpolation::Cubic;
        let key = |number: usize| set(if cubic { 3 * number + 1 } else { number });
        let after = times.partition_point(|&at| at <= time);
        if after == 0 {
            return key(0);
        }
        let before = after - 1;
        if after == times.len() || self.interpolation == Interpolation::Step {
            return key(before);
        }
        let span = times[after] - times[before];
        let t = (time - times[before]) / span;
        let (a, b) = (key(before), key(after));
        if cubic {
            let (leaving, arriving) = (set(3 * before + 2), set(3 * after));
            let (t2, t3) = (t * t, t * t * t);
            let at = |i: usize| {
                (2.0 * t3 - 3.0 * t2 + 1.0) * a[i]
                    + span * (t3 - 2.0 * t2 + t) * leaving[i]
                    + (3.0 * t2 - 2.0 * t3) * b[i]
                    + span * (t3 - t2) * arriving[i]
            };
            return (0..width).map(at).collect();
        }
        if self.property() == Property::Rotation {
            let quaternion = |q: &[f64]| DQuat::from_xyzw(q[0], q[1], q[2], q[3]).normalize();
            return quaternion(&a).slerp(quaternion(&b), t).to_array().to_vec();
        }
        a.iter().zip(&b).map(|(a, b)| a + (b - a) * t).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(property: Property, interpolation: Interpolation) -> Channel {
        let (place, target) = (String::new(), Target::Node(0, property));
        Channel { place, target, interpolation, times: 0, values: 0 }
    }

    #[test]
    fn values_between_keys_are_stepped_or_in_line() {
        let (times, values) = ([1.0, 3.0], [0.0, 10.0, 20.0, 4.0, 10.0, 30.0]);
        let at = |interpolation, time| {
            channel(Property::Translation, interpolation).between(time, &times, &values, 3)
        };
        assert_eq!(at(Interpolation::Linear, 1.5), [1.0, 10.0, 22.5]);
        assert_eq!(at(Interpolation::Step, 2.9), [0.0, 10.0, 20.0]);
        assert_eq!(at(Interpolation::Step, 3.0), [4.0, 10.0, 30.0]);
        assert_eq!(at(Interpolation::Linear, 0.0), [0.0, 10.0, 20.0]);
        assert_eq!(at(Interpolation::Linear, 9.0), [4.0, 10.0, 30.0]);
    }

    #[test]
    fn splines_leave_and_arrive_by_their_tangents() {
        // In, value, out for each of two keys: from 0 at speed 1 to 2 at speed 1 in two seconds.
        let values = [9.0, 0.0, 1.0, 1.0, 2.0, 9.0];
        let spline = channel(Property::Weights, Interpolation::Cubic);
        for time in [0.0, 0.5, 1.0, 1.75, 2.0] {
            let found = spline.between(time, &[0.0, 2.0], &values, 1)[0];
            assert!((found - time).abs() < 1e-12, "a straight line: {found} at {time}");
        }
    }

    #[test]
    fn rotations_take_the_short_way_at_an_even_speed() {
        let half = (0.5_f32).sqrt();
        let values = [0.0, 0.0, 0.0, 1.0, 0.0, -half, 0.0, -half]; // to 90° about Y, negated
        let turn = channel(Property::Rotation, Interpolation::Linear);
        let third = turn.between(1.0, &[0.0, 3.0], &values, 4);
        let expected = DQuat::from_rotation_y(30_f64.to_radians());
        let found = DQuat::from_xyzw(third[0], third[1], third[2], third[3]);
        assert!(found.dot(expected).abs() > 1.0 - 1e-9, "{found}");
    }
}
