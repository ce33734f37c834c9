//! A scene made ready to be rendered.

use std::sync::Arc;

use super::interpolation::Interpolation;
use super::layers::layers_at;
use super::lookup::{alpha, emission, surface_params};
use super::media::Media;
use super::prepared_material::{BsdfClass, PreparedMaterial, materials_with_clear_vertices};
use super::robust::bent_to_viewer;
use super::shading_normal::{NormalContext, shading_normal};
use super::surface::{normal_and_area, triangle_point};
use super::{Attributes, LightSamplerKind, Lights, Surface};
use crate::accel::ClosestHit;
use crate::geom::Triangle;
use crate::material::lanes::transmittance;
use crate::material::{Bsdf, BsdfForm, SurfaceParams, Wavelength};
use crate::math::{Frame, InstanceId, MaterialId, Ray, Vec2, Vec3, Vec4};
use crate::scene::defaults::bounds;
use crate::scene::{AlphaMode, Instance, Material, Scene, TooManyPlacements, Triangles};
use crate::simd::lanes::Scalar;
use crate::texture::Texture;

/// A scene with its triangles numbered, its lights tabled and its materials resolved as far as
/// they are the same everywhere.
#[derive(Debug)]
pub struct World {
    /// What it was made from.
    pub scene: Arc<Scene>,
    /// Its triangles, for an acceleration structure.
    pub triangles: Arc<Triangles>,
    /// What shines in it.
    pub lights: Lights,
    pub(super) materials: Vec<PreparedMaterial>,
    /// Bounds how far off an exact test in f64 may put a plane of the scene, metres: some 2000
    /// units in the last place of the scene's size.
    pub(super) slack: f32,
    /// Half of the scene's diagonal, metres: as far as lights without extent must reach.
    pub(super) radius: f32,
    pub(super) form: BsdfForm,
    /// Whether shading normals lose no light.
    pub(super) robust: bool,
    /// Whether they stand for facets.
    pub(super) faceted: bool,
    pub(super) media: Media,
    see_through: bool,
    has_levels: bool,
}

/// Paths count as no wider on a surface than where they meet it at such a cosine.
const LEAST_COSINE: f32 = 0.05;

/// 2^-42.
const SLACK: f32 = 1.0 / (1_u64 << 42) as f32;

impl World {
    /// Prepares `scene`, whose surfaces will scatter by `form`.
    ///
    /// # Examples
    /// ```
    /// use dapple::{BsdfForm, LoadOptions, World};
    ///
    /// let scene = dapple::load("scenes/cornell.gltf", &LoadOptions::default())?;
    /// let world = World::new(scene, BsdfForm::Conserving)?;
    /// // Each emitting triangle counts as a light.
    /// assert_eq!(world.lights.len(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`TooManyPlacements`] if there are 2^32 - 1 placed meshes or more.
    pub fn new(scene: impl Into<Arc<Scene>>, form: BsdfForm) -> Result<Self, TooManyPlacements> {
        Self::with_lights(scene, form, LightSamplerKind::default())
    }

    /// The same, with lights chosen as told.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn with_lights(
        scene: impl Into<Arc<Scene>>,
        form: BsdfForm,
        kind: LightSamplerKind,
    ) -> Result<Self, TooManyPlacements> {
        let scene = scene.into();
        let triangles = Arc::new(Triangles::new(Arc::clone(&scene))?);
        let mut materials: Vec<PreparedMaterial> =
            scene.materials.iter().map(|material| PreparedMaterial::new(material, form)).collect();
        for material in materials_with_clear_vertices(&scene) {
            materials[material.index()].opaque = false;
        }
        let extent = bounds(&scene).extent().max(Vec3::ZERO);
        let radius = 0.5 * extent.length();
        let lights = Lights::new(&scene, &triangles, radius, kind);
        let used = |instance: &Instance| !materials[instance.material.index()].opaque;
        let see_through = scene.instances.iter().any(used);
        let has_levels = scene.textures.iter().any(Texture::has_levels);
        if has_levels {
            // How wide a path is, only the stages one by one know.
            let textured = materials.iter_mut().filter(|material| material.textured);
            textured.for_each(|material| material.class = BsdfClass::Other);
        }
        let slack = extent.max_element() * SLACK;
        let media = Media::new(&scene);
        Ok(Self {
            scene,
            triangles,
            lights,
            materials,
            slack,
            radius,
            form,
            robust: true,
            faceted: false,
            media,
            see_through,
            has_levels,
        })
    }

    /// Whether hits must be judged by their alpha; see [`super::AlphaFilter`].
    pub fn is_see_through(&self) -> bool {
        self.see_through
    }

    /// Whether anything moves while the shutter is open, so that rays need times.
    #[inline]
    pub fn moves(&self) -> bool {
        self.scene.motion.is_some()
    }

    /// A material by its id.
    #[inline]
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.scene.materials[id.index()]
    }

    /// Whether textures have levels, so that it counts how wide paths are.
    pub fn has_levels(&self) -> bool {
        self.has_levels
    }

    /// The surface that `ray` has hit at a `time` of the shutter, from 0 to 1, of a path that is
    /// `width` metres wide there; 0: a point.
    #[inline(always)]
    pub fn surface(&self, ray: &Ray, hit: &ClosestHit, (time, width): (f32, f32)) -> Surface {
        let (id, index) = (hit.triangle.instance, hit.triangle.index as usize);
        let instance = &self.scene.instances[id.index()];
        let posed = self.scene.mesh_at(instance.mesh, time);
        let (mesh, transform) = (posed.mesh, &self.scene.transform_at(id, time));
        let point = Interpolation::new(mesh, index, transform.mirrored(), hit.u, hit.v);

        let [a, b, c] = point.corners.map(|i| transform.point(posed.position(i)));
        let triangle = Triangle { a, b, c };
        let (position, position_error) = triangle_point(&triangle, hit.u, hit.v, self.slack);
        let (normal, area) = normal_and_area(&triangle);

        let prepared = &self.materials[instance.material.index()];
        let mut attributes = point.attributes((instance.mesh, mesh), prepared.textured);
        if width > 0.0 && prepared.textured {
            let cosine = normal.dot(ray.direction()).abs().max(LEAST_COSINE);
            point.widen(&mut attributes, mesh, area, width / cosine);
        }
        let shading = shading_normal(&NormalContext {
            scene: &self.scene,
            material: self.material(instance.material),
            posed: &posed,
            transform,
            triangle: &triangle,
            point: &point,
            normal,
            attributes: &attributes,
        });
        let towards_viewer = -ray.direction();
        let front = normal.dot(towards_viewer) > 0.0;
        let shading = if self.robust {
            bent_to_viewer(shading, normal, towards_viewer, front)
        } else {
            shading
        };
        Surface {
            position,
            position_error,
            normal,
            frame: Frame::from_normal(shading),
            attributes,
            instance: id,
            triangle: index,
            barycentrics: Vec2::new(hit.u, hit.v),
            area,
            material: instance.material,
            front,
            time,
        }
    }

    /// Material and attributes of a point of triangle number `index` of an instance, given
    /// by its barycentrics at a `time` of the shutter.
    #[inline]
    pub(super) fn texture_point(
        &self,
        (id, index): (InstanceId, usize),
        at: Vec2,
        time: f32,
    ) -> (MaterialId, Attributes) {
        let instance = &self.scene.instances[id.index()];
        let textured = self.materials[instance.material.index()].textured;
        let mesh = &*self.scene.meshes[instance.mesh.index()];
        let mirrored = self.scene.transform_at(id, time).mirrored();
        let point = Interpolation::new(mesh, index, mirrored, at.x, at.y);
        (instance.material, point.attributes((instance.mesh, mesh), textured))
    }

    /// What a surface scatters where `hit` has met it.
    #[inline]
    pub fn bsdf(&self, surface: &Surface, hit: &ClosestHit) -> Bsdf {
        let resolved = &self.materials[surface.material.index()];
        match resolved.bsdf {
            Some(bsdf) if surface.attributes.color == Vec4::ONE => bsdf,
            _ => self.bsdf_of_index(surface, hit, self.material(surface.material).ior),
        }
    }

    /// The same of another index of refraction, inside over outside.
    #[inline]
    pub fn bsdf_of_index(&self, surface: &Surface, hit: &ClosestHit, ior: f32) -> Bsdf {
        let resolved = &self.materials[surface.material.index()];
        if resolved.layered {
            return self.layered_bsdf(surface, hit, ior);
        }
        let params = self.surface_params(surface.material, &surface.attributes);
        Bsdf::new(&SurfaceParams { ior, ..params }, self.form)
    }

    /// What a surface with layers scatters where `hit` has met it; `ior` is the inside's index over
    /// the outside's.
    #[inline(never)]
    fn layered_bsdf(&self, surface: &Surface, hit: &ClosestHit, ior: f32) -> Bsdf {
        let params = self.surface_params(surface.material, &surface.attributes);
        let params = SurfaceParams { ior, ..params };
        let material = self.material(surface.material);
        let Some(described) = material.layers.as_deref() else {
            return Bsdf::new(&params, self.form);
        };
        let instance = &self.scene.instances[surface.instance.index()];
        let posed = self.scene.mesh_at(instance.mesh, surface.time);
        let (mesh, transform) =
            (posed.mesh, &self.scene.transform_at(surface.instance, surface.time));
        let point = Interpolation::new(mesh, surface.triangle, transform.mirrored(), hit.u, hit.v);
        let [a, b, c] = point.corners.map(|i| transform.point(posed.position(i)));
        let at = NormalContext {
            scene: &self.scene,
            material,
            posed: &posed,
            transform,
            triangle: &Triangle { a, b, c },
            point: &point,
            normal: surface.normal,
            attributes: &surface.attributes,
        };
        Bsdf::layered(&params, &layers_at(described, &at, &surface.frame), self.form)
    }

    /// The probability that a ray does not go through a surface.
    pub(super) fn coverage(&self, id: MaterialId, at: &Attributes) -> f32 {
        if self.materials[id.index()].opaque {
            return 1.0;
        }
        let material = self.material(id);
        match material.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f32::from(alpha(&self.scene, material, at) >= cutoff),
            AlphaMode::Blend => alpha(&self.scene, material, at).clamp(0.0, 1.0),
        }
    }

    /// What a material scatters at a point, but for what lies on it.
    #[inline]
    pub fn bare_bsdf(&self, id: MaterialId, at: &Attributes) -> Bsdf {
        Bsdf::new(&self.surface_params(id, at), self.form)
    }

    /// The parameters of what a material scatters at a point, but for what lies on it.
    #[inline]
    pub(super) fn surface_params(&self, id: MaterialId, at: &Attributes) -> SurfaceParams {
        surface_params(&self.scene, self.material(id), at)
    }

    /// What a material emits at a point, on the side that shines.
    #[inline]
    pub fn emission(&self, id: MaterialId, at: &Attributes) -> Vec3 {
        emission(&self.scene, self.material(id), at)
    }

    /// Whether a material bounds solids that light goes through.
    #[inline]
    pub fn is_solid(&self, id: MaterialId) -> bool {
        self.materials[id.index()].solid
    }

    /// Whether a solid bends some colours more than others; air, [`MaterialId::NONE`], does not.
    #[inline]
    pub fn disperses(&self, id: MaterialId) -> bool {
        let of = |material: &PreparedMaterial| material.solid;
        self.materials.get(id.index()).is_some_and(of) && self.material(id).dispersion > 0.0
    }

    /// The index of refraction inside of a solid for a wavelength, or for all; 1 for
    /// [`MaterialId::NONE`].
    pub fn ior(&self, id: MaterialId, wavelength: Option<Wavelength>) -> f32 {
        let Some(material) = self.scene.materials.get(id.index()) else { return 1.0 };
        match wavelength {
            Some(wavelength) if material.dispersion > 0.0 => {
                wavelength.index(material.ior, material.dispersion)
            }
            _ => material.ior,
        }
    }

    /// See [`Material::priority`].
    #[inline]
    pub fn priority(&self, id: MaterialId) -> i32 {
        self.material(id).priority
    }

    /// What is left of white light after `distance` metres inside of a material; one where it
    /// absorbs nothing, and for [`MaterialId::NONE`].
    pub fn transmittance(&self, id: MaterialId, distance: f32) -> Vec3 {
        let absorption = self.materials.get(id.index()).and_then(|material| material.absorption);
        let Some(volume) = absorption else { return Vec3::ONE };
        let thickness = distance / volume.attenuation_distance;
        transmittance(Scalar, volume.attenuation_color.into(), thickness).into()
    }
}
