//! Lamps: meshes that emit and are placed many times.
//!
//! Each placement is one light. How its triangles share its power is the same for all of them, so
//! it is known once, in the mesh's space; a point that asks is taken there. That is right where
//! placements turn, mirror and scale alike in all directions. In others, and where anything moves,
//! each triangle is a light.

use std::collections::HashMap;
use std::sync::Arc;

use super::emitters::{Emitter, EvenEmission, area, emitting, sides, triangle_weight};
use super::light_sampler::{LightSamplerKind, triangle_bounds};
use crate::geom::{Placements, Triangle};
use crate::light::{Cone, LightBounds, LightSampleContext, LightTree};
use crate::math::{Aabb, InstanceId, MaterialId, MeshId, TriangleId, Vec3};
use crate::sampling::AliasTable;
use crate::scene::{Scene, Transform, Triangles};

/// A placement of a shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp {
    instance: InstanceId,
    shape: u32,
}

/// The shapes of all lamps.
#[derive(Debug)]
pub(super) struct Lamps {
    triangles: Arc<Triangles>,
    shapes: Vec<Shape>,
    /// By what they are made of.
    numbers: HashMap<(MeshId, MaterialId), u32>,
}

/// A mesh of an emitting material, in its own space.
#[derive(Debug)]
struct Shape {
    table: AliasTable,
    tree: Option<LightTree>,
    /// The sum of all triangles' power.
    weight: f64,
    bounds: LightBounds,
}

impl Lamps {
    /// The shapes that are placed more than once, if more triangles than `most_alone` emit in all;
    /// else none.
    pub fn new(
        scene: &Scene,
        triangles: &Arc<Triangles>,
        kind: LightSamplerKind,
        most_alone: u64,
    ) -> Self {
        let mut lamps =
            Self { triangles: Arc::clone(triangles), shapes: Vec::new(), numbers: HashMap::new() };
        let instances = || (0..scene.instances.len()).map(InstanceId::from_index);
        let emits = |instance: InstanceId| match emitting(scene, instance) {
            (Some(_), mesh) => scene.meshes[mesh].indices.len() as u64,
            (None, _) => 0,
        };
        if instances().map(emits).sum::<u64>() <= most_alone {
            return lamps;
        }
        let mut uses: HashMap<(MeshId, MaterialId), (usize, InstanceId)> = HashMap::new();
        for instance in instances().filter(|&instance| emits(instance) > 0) {
            if let Some(key) = key(scene, instance) {
                uses.entry(key).or_insert((0, instance)).0 += 1;
            }
        }
        let mut shared: Vec<_> = uses.into_iter().filter(|(_, (count, _))| *count > 1).collect();
        shared.sort_by_key(|(_, (_, first))| *first);
        for (key, (_, first)) in shared {
            if let Some(shape) = Shape::new(triangles, first, kind) {
                lamps.numbers.insert(key, lamps.shapes.len() as u32);
                lamps.shapes.push(shape);
            }
        }
        lamps
    }

    /// What an instance is a lamp of, if it is one.
    pub fn find(&self, scene: &Scene, instance: InstanceId) -> Option<Lamp> {
        if self.shapes.is_empty() {
            return None;
        }
        let shape = *self.numbers.get(&key(scene, instance)?)?;
        Some(Lamp { instance, shape })
    }

    /// The power of a lamp.
    pub fn weight(&self, scene: &Scene, lamp: Lamp) -> f64 {
        let scale = scale2(&scene.instances[lamp.instance.index()].transform);
        self.shape(lamp).weight * f64::from(scale)
    }

    /// What a tree of lights has to know of a lamp.
    pub fn bounds(&self, scene: &Scene, lamp: Lamp) -> LightBounds {
        let transform = &scene.instances[lamp.instance.index()].transform;
        let LightBounds { bounds, normals, cos_emission, power } = self.shape(lamp).bounds;
        let corner = |i: usize| {
            let side = |axis: usize| if i >> axis & 1 == 0 { bounds.min } else { bounds.max }[axis];
            transform.point(Vec3::new(side(0), side(1), side(2)))
        };
        let axis = transform.to_world().transform_vector3(normals.axis).try_normalize();
        let normals = match axis {
            Some(axis) if normals.cos > -1.0 => Cone { axis, cos: (normals.cos - 1e-4).max(-1.0) },
            _ => Cone::ALL,
        };
        let bounds = Aabb::of_points((0..8).map(corner));
        LightBounds { bounds, normals, cos_emission, power: power * scale2(transform) }
    }

    /// A triangle of a lamp for a point that asks, and the probability with which it is chosen;
    /// `None` if none shines there.
    pub fn sample(
        &self,
        lamp: Lamp,
        context: &LightSampleContext,
        u: f32,
    ) -> Option<(Emitter, f32)> {
        let shape = self.shape(lamp);
        let (index, pmf) = match &shape.tree {
            Some(tree) => tree.sample(&self.inside(lamp, context), u)?,
            None => shape.table.sample(u),
        };
        let (instance, index) = (lamp.instance, index as u32);
        let corners = self.triangles.of(TriangleId { instance, index }).corners();
        let material = emitting(self.triangles.scene(), instance).0?;
        Some((Emitter { instance, index, even: EvenEmission::new(material, corners) }, pmf))
    }

    /// The probability with which [`Lamps::sample`] chooses a triangle.
    pub fn pmf(&self, lamp: Lamp, context: &LightSampleContext, index: usize) -> f32 {
        let shape = self.shape(lamp);
        match &shape.tree {
            Some(tree) => tree.probability(&self.inside(lamp, context), index),
            None => shape.table.pmf(index),
        }
    }

    fn shape(&self, lamp: Lamp) -> &Shape {
        &self.shapes[lamp.shape as usize]
    }

    /// A point that asks, in the space of a lamp's mesh.
    fn inside(&self, lamp: Lamp, context: &LightSampleContext) -> LightSampleContext {
        let scene = self.triangles.scene();
        let to_world = scene.instances[lamp.instance.index()].transform.to_world();
        // Of what turns, mirrors and scales the inverse is the transpose over the squared scale.
        let back = to_world.matrix3.transpose();
        let scale2 = to_world.matrix3.x_axis.length_squared();
        let position = back * (context.position - Vec3::from(to_world.translation)) / scale2;
        let normal = (back * context.normal).try_normalize().unwrap_or(Vec3::ZERO);
        LightSampleContext { position, normal }
    }
}

impl Shape {
    /// That of a placement; `None` if it has no power.
    fn new(triangles: &Triangles, instance: InstanceId, kind: LightSamplerKind) -> Option<Self> {
        let scene = triangles.scene();
        let (material, mesh) = emitting(scene, instance);
        let (material, mesh) = (material?, MeshId::from_index(mesh));
        let triangle = |index: u32| -> Triangle { triangles.mesh_triangle(mesh, index) };
        let indices = || 0..triangles.mesh_len(mesh) as u32;
        let weight = |index: u32| {
            let id = TriangleId { instance, index };
            triangle_weight(scene, material, id, area(&triangle(index)))
        };
        let weights: Vec<f64> = indices().map(weight).collect();
        let table = AliasTable::new(&weights).ok()?;
        let of_triangle = |(index, &weight): (u32, &f64)| {
            triangle_bounds(&triangle(index), sides(Some(material)), weight)
        };
        let tree = match kind {
            LightSamplerKind::Power => None,
            LightSamplerKind::Tree => {
                let bounds: Vec<LightBounds> = indices().zip(&weights).map(of_triangle).collect();
                Some(LightTree::new(&bounds)?)
            }
        };
        let bounds = tree.as_ref().map_or(LightBounds::NOWHERE, LightTree::bounds);
        Some(Self { table, tree, weight: weights.iter().sum(), bounds })
    }
}

/// What placements of one shape have in common; `None` for those that are no lamps.
fn key(scene: &Scene, instance: InstanceId) -> Option<(MeshId, MaterialId)> {
    let placed = &scene.instances[instance.index()];
    let is_lamp = !scene.moves(instance) && keeps_angles(&placed.transform);
    is_lamp.then_some((placed.mesh, placed.material))
}

/// Whether a placement turns, mirrors and scales alike in all directions, and does no more.
fn keeps_angles(transform: &Transform) -> bool {
    const TOLERANCE: f32 = 1e-4;
    let matrix = transform.to_world().matrix3;
    let gram = matrix.transpose() * matrix;
    let scale2 = gram.x_axis.x;
    let is_near = |value: f32, wanted: f32| (value - wanted).abs() <= TOLERANCE * scale2;
    let columns = [gram.x_axis, gram.y_axis, gram.z_axis];
    let off = |i: usize, j: usize| is_near(columns[i][j], if i == j { scale2 } else { 0.0 });
    let all = (0..3).all(|i| (0..3).all(|j| off(i, j)));
    all && scale2.is_normal() && (1e-30..1e30).contains(&scale2)
}

/// By how much a placement scales areas.
fn scale2(transform: &Transform) -> f32 {
    transform.to_world().matrix3.x_axis.length_squared()
}

#[cfg(test)]
mod tests {
    use super::super::lights::{ChosenLight, Lights};
    use super::*;
    use crate::geom::Mesh;
    use crate::math::{Affine3A, Vec2};
    use crate::sampling::Sampler;
    use crate::sampling::chi_squared::assert_fits;
    use crate::scene::{Instance, Material};

    const TRIANGLES: usize = 24;

    /// Triangles of many sizes around the origin, most of them looking outwards.
    fn mesh() -> Mesh {
        let mut mesh = Mesh::default();
        for i in 0..TRIANGLES as u64 {
            let mut sampler = Sampler::independent(i, 0, 8);
            let out = crate::sampling::warp::sphere(sampler.next_2d());
            let across = out.any_orthonormal_vector() * (0.05 + 0.3 * sampler.next_1d());
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([out, out + across, out + out.cross(across)]);
            mesh.indices.push([first, first + 1, first + 2]);
        }
        mesh
    }

    fn scene() -> Arc<Scene> {
        let turn = Affine3A::from_rotation_y(0.7);
        let at = |x: f32| Affine3A::from_translation(Vec3::new(x, 0.0, 0.0));
        let placements = [
            at(0.0),
            at(4.0) * turn,
            at(9.0) * turn * Affine3A::from_scale(Vec3::splat(0.5)),
            at(15.0) * Affine3A::from_scale(Vec3::new(-2.0, 2.0, 2.0)) * turn,
            at(21.0) * Affine3A::from_scale(Vec3::new(1.0, 3.0, 1.0)),
        ];
        let place = |&to_world: &Affine3A| Instance {
            mesh: MeshId::from_index(0),
            material: MaterialId::from_index(0),
            transform: Transform::new(to_world),
        };
        Arc::new(Scene {
            meshes: vec![Arc::new(mesh())],
            materials: vec![Material { emissive: Vec3::splat(3.0), ..Material::default() }],
            instances: placements.iter().map(place).collect(),
            ..Scene::default()
        })
    }

    fn lights(kind: LightSamplerKind, most_alone: u64) -> (Lights, usize) {
        let scene = scene();
        let triangles = Arc::new(Triangles::new(Arc::clone(&scene)).expect("few"));
        let lights = Lights::with_lamps(&scene, &triangles, (30.0, kind), most_alone);
        (lights, scene.instances.len())
    }

    fn contexts() -> [LightSampleContext; 3] {
        let context = |position, normal| LightSampleContext { position, normal };
        [
            context(Vec3::new(2.0, -3.0, 1.0), Vec3::ZERO),
            context(Vec3::new(9.0, -1.0, 0.0), Vec3::Y),
            context(Vec3::new(14.0, 5.0, 9.0), Vec3::new(0.0, -0.6, -0.8)),
        ]
    }

    /// Four placements keep angles and are lamps; the triangles of the fifth are lights.
    #[test]
    fn triangles_of_lamps_are_chosen_as_often_as_they_say() {
        const COUNT: u64 = 60_000;
        for kind in LightSamplerKind::ALL {
            let (lights, instances) = lights(kind, 0);
            assert_eq!(lights.len(), 4 + TRIANGLES);
            for (number, context) in contexts().iter().enumerate() {
                let mut counts = vec![0; instances * TRIANGLES + 1];
                let mut pmf = vec![0.0; counts.len() - 1];
                for (i, pmf) in pmf.iter_mut().enumerate() {
                    let instance = InstanceId::from_index(i / TRIANGLES);
                    *pmf = lights.triangle_pmf(context, instance, i % TRIANGLES);
                }
                for i in 0..COUNT {
                    let mut sampler = Sampler::independent(i, number as u64, 5);
                    let (u_light, u) = (sampler.next_1d(), sampler.next_2d());
                    match lights.choose(context, u_light, u) {
                        Some((ChosenLight::Emitter(emitter), told, _)) => {
                            let at = emitter.instance.index() * TRIANGLES + emitter.index as usize;
                            assert!((told / pmf[at] - 1.0).abs() < 1e-4, "{told} {}", pmf[at]);
                            counts[at] += 1;
                        }
                        Some(other) => panic!("{other:?}"),
                        None => *counts.last_mut().expect("one more") += 1,
                    }
                }
                let sum: f32 = pmf.iter().sum();
                assert!(sum < 1.0001 && (sum > 0.999 || kind == LightSamplerKind::Tree));
                let mut expected: Vec<f64> =
                    pmf.iter().map(|&pmf| f64::from(pmf) * COUNT as f64).collect();
                expected.push(f64::from((1.0 - sum).max(0.0)) * COUNT as f64 + 1e-6);
                assert_fits(&counts, &expected, 6, &format!("{kind}, context {number}"));
            }
        }
    }

    /// By power it makes no difference whether triangles are lights or parts of lamps.
    #[test]
    fn lamps_have_the_power_of_their_triangles() {
        let (lamps, instances) = lights(LightSamplerKind::Power, 0);
        let (alone, _) = lights(LightSamplerKind::Power, 1 << 16);
        assert_eq!(alone.len(), instances * TRIANGLES);
        let context = &contexts()[0];
        for i in 0..instances * TRIANGLES {
            let instance = InstanceId::from_index(i / TRIANGLES);
            let of = |lights: &Lights| lights.triangle_pmf(context, instance, i % TRIANGLES);
            let (a, b) = (of(&lamps), of(&alone));
            assert!((a - b).abs() < 1e-4 * b, "{i}: {a} {b}");
        }
    }

    /// Wherever a light of its own would be chosen, so is the part of a lamp.
    #[test]
    fn no_triangle_that_shines_is_missed() {
        let (lamps, instances) = lights(LightSamplerKind::Tree, 0);
        let (alone, _) = lights(LightSamplerKind::Tree, 1 << 16);
        let (mut seen, mut missed) = (0, Vec::new());
        for context in &contexts() {
            for i in 0..instances * TRIANGLES {
                let instance = InstanceId::from_index(i / TRIANGLES);
                let of = |lights: &Lights| lights.triangle_pmf(context, instance, i % TRIANGLES);
                // What rounding alone leaves may be missed.
                if of(&alone) > 1e-5 {
                    seen += 1;
                    if of(&lamps) <= 0.0 {
                        missed.push(i);
                    }
                }
            }
        }
        assert!(seen > 100 && missed.is_empty(), "{seen} {missed:?}");
        let u = Vec2::splat(0.5);
        assert!(lamps.choose(&contexts()[0], 0.5, u).is_some());
    }
}
