//! A scene made ready to be rendered.

use std::sync::Arc;

use super::{Attributes, LightChoice, Lights, Surface, layered_point};
use crate::accel::ClosestHit;
use crate::geom::Mesh;
use crate::material::{Bsdf, BsdfForm, SurfaceParams, Wavelength};
use crate::math::{MaterialId, Vec2, Vec3, Vec4};
use crate::scene::defaults::bounds;
use crate::scene::{AlphaMode, Material, Scene, TextureRef, Triangles, Volume};

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
    pub(super) materials: Vec<Resolved>,
    /// Bounds how far off a verdict in f64 may put a plane of the scene, metres: some 2000 units
    /// in the last place of the scene's size.
    pub(super) slack: f32,
    pub(super) form: BsdfForm,
    see_through: bool,
}

/// What is known of a material before any point of it is seen.
#[derive(Clone, Debug)]
pub(super) struct Resolved {
    /// The scattering, if no texture changes it from point to point.
    bsdf: Option<Bsdf>,
    /// Whether something lies on it.
    layered: bool,
    /// Whether any texture is looked up at all.
    pub textured: bool,
    /// See [`Material::is_opaque`]; the colours of vertices have a say in it too.
    pub opaque: bool,
    /// Whether it bounds solids that light goes through.
    solid: bool,
    /// The inside, if it takes away light.
    absorption: Option<Volume>,
}

/// 2^-42.
const SLACK: f32 = 1.0 / (1_u64 << 42) as f32;

impl World {
    /// Prepares `scene`, whose surfaces will scatter by `form`.
    ///
    /// # Errors
    /// The number of triangles, if it is 2^32 - 1 or more.
    pub fn new(scene: Arc<Scene>, form: BsdfForm) -> Result<Self, u64> {
        Self::with_lights(scene, form, LightChoice::default())
    }

    /// The same, with lights chosen as told.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn with_lights(
        scene: Arc<Scene>,
        form: BsdfForm,
        choice: LightChoice,
    ) -> Result<Self, u64> {
        let triangles = Arc::new(Triangles::new(&scene)?);
        let mut materials: Vec<Resolved> =
            scene.materials.iter().map(|material| Resolved::new(material, form)).collect();
        for material in seen_through_vertices(&scene) {
            materials[material.index()].opaque = false;
        }
        let lights = Lights::new(&scene, &triangles, choice);
        let used = |instance: &crate::scene::Instance| !materials[instance.material.index()].opaque;
        let see_through = scene.instances.iter().any(used);
        let slack = bounds(&scene).extent().max_element().max(0.0) * SLACK;
        Ok(Self { scene, triangles, lights, materials, slack, form, see_through })
    }

    /// Whether hits must be judged by their alpha; see [`super::AlphaFilter`].
    pub fn is_see_through(&self) -> bool {
        self.see_through
    }

    /// A material by its id.
    #[inline]
    pub fn material(&self, id: MaterialId) -> &Material {
        &self.scene.materials[id.index()]
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
        let of = |material: &Resolved| material.solid;
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
        let [r, g, b] = volume.attenuation_color.to_array();
        Vec3::new(libm::powf(r, thickness), libm::powf(g, thickness), libm::powf(b, thickness))
    }
}

impl Resolved {
    fn new(material: &Material, form: BsdfForm) -> Self {
        let looked_up = [
            material.base_color_texture,
            material.metallic_roughness_texture,
            material.glossiness_texture,
            material.specular_texture,
            material.specular_color_texture,
            material.transmission_texture,
        ];
        // Where layers have directions of their own, each point has.
        let layers = material.layers.as_deref();
        let constant = looked_up.iter().all(Option::is_none)
            && layers.is_none_or(|layers| layered_point::is_constant(material, layers));
        let plain = || {
            let params = surface_params(&Scene::default(), material, &Attributes::NONE);
            match layers {
                Some(layers) => Bsdf::layered(&params, &layered_point::factors(layers), form),
                None => Bsdf::new(&params, form),
            }
        };
        Self {
            bsdf: constant.then(plain),
            layered: layers.is_some(),
            textured: material.clone().textures_mut().next().is_some(),
            opaque: material.is_opaque(),
            solid: material.volume.is_some() && material.transmission > 0.0,
            absorption: material.volume.filter(|volume| {
                volume.attenuation_distance.is_finite()
                    && volume.attenuation_distance > 0.0
                    && volume.attenuation_color != Vec3::ONE
            }),
        }
    }
}

/// Looks a texture up where a material asks for it.
pub(super) fn look_up(scene: &Scene, texture: &TextureRef, uv: &[Vec2; 2]) -> Vec4 {
    let uv = texture.transform(uv[usize::from(texture.uv_set.min(1))]);
    scene.textures[texture.texture.index()].sample(uv)
}

/// What a material emits at a point.
pub(super) fn emission(scene: &Scene, material: &Material, at: &Attributes) -> Vec3 {
    if material.unlit {
        return base_color(scene, material, at).truncate();
    }
    match &material.emissive_texture {
        Some(texture) => material.emissive * look_up(scene, texture, &at.uv).truncate(),
        None => material.emissive,
    }
}

/// Colour and alpha at a point: factor times texture times the vertices' colour.
pub(super) fn base_color(scene: &Scene, material: &Material, at: &Attributes) -> Vec4 {
    let color = material.base_color * at.color;
    match &material.base_color_texture {
        Some(texture) => color * look_up(scene, texture, &at.uv),
        None => color,
    }
}

/// Materials that do not ignore alpha, on meshes with vertices that are not opaque.
fn seen_through_vertices(scene: &Scene) -> impl Iterator<Item = MaterialId> {
    let clear = |mesh: &Arc<Mesh>| mesh.colors.iter().any(|color| color.w < 1.0);
    let clear: Vec<bool> = scene.meshes.iter().map(clear).collect();
    let used = scene.instances.iter().filter(move |instance| clear[instance.mesh.index()]);
    used.map(|instance| instance.material)
        .filter(|id| scene.materials[id.index()].alpha_mode != AlphaMode::Opaque)
}

/// Factors times textures.
fn surface_params(scene: &Scene, material: &Material, at: &Attributes) -> SurfaceParams {
    if material.unlit {
        // Black and without a coat: all that comes from it is its emission.
        return SurfaceParams { base_color: Vec3::ZERO, specular: 0.0, ..SurfaceParams::default() };
    }
    let texel = |texture: &Option<TextureRef>| match texture {
        Some(texture) => look_up(scene, texture, &at.uv),
        None => Vec4::ONE,
    };
    let metallic_roughness = texel(&material.metallic_roughness_texture);
    SurfaceParams {
        base_color: base_color(scene, material, at).truncate(),
        metallic: material.metallic * metallic_roughness.z,
        roughness: match material.glossiness_texture {
            None => material.roughness * metallic_roughness.y,
            Some(_) => 1.0 - (1.0 - material.roughness) * texel(&material.glossiness_texture).w,
        },
        ior: material.ior,
        specular: material.specular * texel(&material.specular_texture).w,
        specular_color: material.specular_color
            * texel(&material.specular_color_texture).truncate(),
        transmission: material.transmission * texel(&material.transmission_texture).x,
        thin: material.volume.is_none(),
    }
}
