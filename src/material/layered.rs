//! Surfaces with something on them: a film, cloth, lacquer, or all of these.

use super::anisotropic::Anisotropic;
use super::clearcoat::Clearcoat;
use super::filmed::Filmed;
use super::form::BsdfForm;
use super::layer_base::{Base, clear_share, is_half_clear};
use super::layer_columns::Curve;
use super::layer_energy::Returned;
use super::layers::Layers;
use super::params::{SurfaceParams, saturate};
use super::sample::{BsdfSample, is_above, mean};
use super::sheen::Sheen;
use super::thin_film::ThinFilm;
use crate::math::{Vec2, Vec3};
use crate::sampling::{ONE_MINUS_EPSILON, warp};

/// Each lobe gets at least this share of the probability, before normalisation: what reflects
/// little in all may reflect nearly everything at grazing half vectors.
const MIN_PROBABILITY: f32 = 0.1;

/// A coat over a sheen over a base with a thin film on it, of which any may be missing; without any
/// of them, what lets light through both straight and scattered. It is packed, and unpacked for
/// each call, so that surfaces without layers stay small and pay nothing for it.
///
/// What a layer reflects, those below it do not get: they are scaled by what it lets through, and
/// for the coat in [`BsdfForm::AppendixB`] by the product of that for both directions (as
/// KHR_materials_clearcoat has it), else by the lesser of both (as KHR_materials_sheen has it),
/// which is reciprocal and never gives more than there is. What of it is less than the base could
/// reflect comes back by a lobe of its own, see `layer_energy`. A coat over glass that is solid
/// lies on the outside only; in [`BsdfForm::Conserving`] what it throws back into the glass is
/// reflected there, see `cover`. Emission is not dimmed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layered {
    base_color: Vec3,
    specular_color: Vec3,
    ior: f32,
    /// X and y of the coat's normal.
    coat_slope: Vec2,
    sheen_color: Vec3,
    anisotropy_direction: Vec2,
    anisotropy: Share,
    metallic: Share,
    roughness: Share,
    specular: Share,
    transmission: Share,
    diffuse_transmission: Share,
    diffuse_transmission_color: Vec3,
    clearcoat: Share,
    clearcoat_roughness: Share,
    sheen_roughness: Share,
    film: Share,
    film_ior: f32,
    /// Nanometres.
    film_thickness: f32,
    thin: bool,
    form: BsdfForm,
}

/// A number from 0 to 1 in 16 bits, some 1e-5 apart.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Share(u16);

impl Share {
    const ONE: f32 = 65535.0;

    /// `x` clamped to the range; NaN becomes 0.
    fn new(x: f32) -> Self {
        Self((saturate(x) * Self::ONE + 0.5) as u16)
    }

    fn get(self) -> f32 {
        f32::from(self.0) / Self::ONE
    }
}

impl Layered {
    /// The surface that both describe; `None` where `layers` add nothing.
    pub(super) fn new(params: &SurfaceParams, layers: &Layers, form: BsdfForm) -> Option<Self> {
        let sheen_color = Vec3::from_array(layers.sheen_color.to_array().map(saturate));
        let transmission = clear_share(params);
        let made = Self {
            base_color: params.base_color,
            specular_color: params.specular_color,
            ior: params.ior,
            coat_slope: layers.clearcoat_normal.truncate(),
            sheen_color,
            anisotropy_direction: layers.anisotropy_direction,
            // What bends light has one roughness.
            anisotropy: Share::new(if transmission > 0.0 { 0.0 } else { layers.anisotropy }),
            metallic: Share::new(params.metallic),
            roughness: Share::new(params.roughness),
            specular: Share::new(params.specular),
            transmission: Share::new(params.transmission),
            diffuse_transmission: Share::new(params.diffuse_transmission),
            diffuse_transmission_color: params.diffuse_transmission_color,
            clearcoat: Share::new(layers.clearcoat),
            clearcoat_roughness: Share::new(layers.clearcoat_roughness),
            sheen_roughness: Share::new(layers.sheen_roughness),
            film: Share::new(layers.iridescence),
            film_ior: layers.iridescence_ior,
            film_thickness: layers.iridescence_thickness,
            thin: params.thin,
            form,
        };
        // All fields are named, so that the compiler asks here about a new one.
        let Self {
            base_color: _,
            specular_color: _,
            ior: _,
            coat_slope: _,
            sheen_color,
            anisotropy_direction: _,
            anisotropy,
            metallic: _,
            roughness: _,
            specular: _,
            transmission: _,
            diffuse_transmission: _,
            diffuse_transmission_color: _,
            clearcoat,
            clearcoat_roughness: _,
            sheen_roughness: _,
            film,
            film_ior: _,
            film_thickness: _,
            thin: _,
            form: _,
        } = made;
        let any = [clearcoat, anisotropy, film].iter().any(|share| share.0 > 0);
        let any = any || sheen_color != Vec3::ZERO || is_half_clear(params);
        any.then_some(made)
    }

    fn unpack(&self) -> Stack {
        let params = SurfaceParams {
            base_color: self.base_color,
            metallic: self.metallic.get(),
            roughness: self.roughness.get(),
            ior: self.ior,
            specular: self.specular.get(),
            specular_color: self.specular_color,
            transmission: self.transmission.get(),
            diffuse_transmission: self.diffuse_transmission.get(),
            diffuse_transmission_color: self.diffuse_transmission_color,
            thin: self.thin,
        };
        let (form, anisotropy) = (self.form, self.anisotropy.get());
        let base = if self.film.0 > 0 {
            let film = ThinFilm::new(self.film.get(), self.film_ior, self.film_thickness);
            let stretch = (anisotropy, self.anisotropy_direction);
            Base::Filmed(Filmed::new(&params, stretch, film, form))
        } else if anisotropy > 0.0 {
            let direction = self.anisotropy_direction;
            Base::Brushed(Anisotropic::new(&params, anisotropy, direction, form))
        } else {
            Base::plain(&params, form)
        };
        let coat = (self.clearcoat != Share(0)).then(|| {
            let z = (1.0 - self.coat_slope.length_squared()).max(0.0).sqrt();
            let normal = self.coat_slope.extend(z);
            Clearcoat::new(self.clearcoat.get(), self.clearcoat_roughness.get(), normal, form)
        });
        let sheen = (self.sheen_color != Vec3::ZERO)
            .then(|| Sheen::new(self.sheen_color, self.sheen_roughness.get(), form));
        let both_sides = self.thin || !base.transmits();
        // Of a coat with a normal of its own too little is known.
        let straight = coat.as_ref().filter(|_| self.coat_slope.length_squared() < 1e-3);
        let any = straight.is_some() || sheen.is_some();
        let returned = (form == BsdfForm::Conserving && any)
            .then(|| Returned::new(&params, &base, straight, sheen.as_ref()));
        Stack { base, coat, sheen, returned, both_sides, form }
    }

    /// See [`super::Bsdf::eval`].
    #[inline(never)]
    pub fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        self.unpack().eval(wo, wi)
    }

    /// See [`super::Bsdf::sample`].
    #[inline(never)]
    pub fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        self.unpack().sample(wo, u_lobe, u)
    }

    /// See [`super::Bsdf::transmits`].
    pub fn transmits(&self) -> bool {
        // The same as the base's, without unpacking it.
        let plain = self.film.0 == 0 && self.anisotropy.0 == 0;
        let scattered = if plain { self.diffuse_transmission.get() } else { 0.0 };
        self.transmission.get().max(scattered) * (1.0 - self.metallic.get()) >= 1e-6
    }

    /// See [`super::Bsdf::albedo`].
    pub fn albedo(&self) -> Vec3 {
        let stack = self.unpack();
        let sheen = stack.sheen.map_or(0.0, |sheen| sheen.albedo(Vec3::Z));
        let fibres = self.sheen_color * (sheen / mean(self.sheen_color).max(1e-6));
        let coat = stack.coat.map_or(0.0, |coat| coat.albedo(Vec3::Z));
        let (through_coat, through_sheen) = stack.transmittance(Vec3::Z, Vec3::Z);
        let returned = stack.returned.as_ref();
        let returned = returned.map_or(Vec3::ZERO, |returned| returned.albedo(Vec3::Z));
        let below = fibres + stack.base.albedo() * through_sheen;
        Vec3::splat(coat) + returned + below * through_coat
    }
}

/// The layers at a point, unpacked.
#[derive(Clone, Copy, Debug)]
struct Stack {
    base: Base,
    coat: Option<Clearcoat>,
    sheen: Option<Sheen>,
    /// What comes back of light lost under both.
    returned: Option<Returned>,
    /// Whether the layers lie on the back too; else the back is the inside of a solid.
    both_sides: bool,
    form: BsdfForm,
}

/// Probabilities of the lobes; that of the base is the rest.
struct LobeProbabilities {
    coat: f32,
    sheen: f32,
    returned: f32,
    /// What comes back of light from the viewer's direction.
    view: Vec3,
}

impl LobeProbabilities {
    fn base(&self) -> f32 {
        1.0 - self.coat - self.sheen - self.returned
    }
}

impl Stack {
    /// The same direction seen from the front if both sides are alike, and the sign that did it.
    fn flip_to_front(&self, wo: Vec3) -> (Vec3, f32) {
        let side = if self.both_sides && wo.z < 0.0 { -1.0 } else { 1.0 };
        (wo * side, side)
    }

    /// The shares of light between two directions that the coat and the sheen let through.
    fn transmittance(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let outside = |w: Vec3| self.both_sides || w.z > 0.0;
        let of = |through: &dyn Fn(Vec3) -> f32| {
            let share = |w: Vec3| if outside(w) { through(w) } else { 1.0 };
            (share(wo), share(wi))
        };
        let coat = self.coat.as_ref().map_or(1.0, |coat| {
            let (o, i) = of(&|w| coat.transmittance(w));
            if self.form == BsdfForm::AppendixB { o * i } else { o.min(i) }
        });
        let sheen = self.sheen.as_ref().map_or(1.0, |sheen| {
            let (o, i) = of(&|w| sheen.transmittance(w));
            o.min(i)
        });
        (coat, sheen)
    }

    /// What layers on a solid keep of light from inside.
    fn kept(&self) -> Option<&Curve> {
        self.returned.as_ref().and_then(Returned::kept)
    }

    /// Proportional to what each lobe reflects of light from the viewer's direction.
    fn lobe_probabilities(&self, wo: Vec3) -> LobeProbabilities {
        let (through_coat, through_sheen) = self.transmittance(wo, wo);
        let (coat, sheen) = (self.coat_above(wo), self.sheen_above(wo));
        let [has_coat, has_sheen] = [coat.is_some(), sheen.is_some()];
        let coat = coat.map_or(0.0, |coat| coat.albedo(wo));
        let sheen = sheen.map_or(0.0, |sheen| sheen.albedo(wo) * through_coat);
        let base = mean(self.base.albedo()).clamp(0.0, 1.0) * through_coat * through_sheen;
        let least = MIN_PROBABILITY * (coat + sheen + base) + 1e-6;
        let coat = if has_coat { coat.max(least) } else { 0.0 };
        let sheen = if has_sheen { sheen.max(least) } else { 0.0 };
        let returned = self.returned.as_ref();
        let view = returned.map_or(Vec3::ZERO, |returned| returned.albedo(wo));
        let total = coat + sheen + mean(view) + base.max(least);
        let [coat, sheen, returned] = [coat, sheen, mean(view)].map(|share| share / total);
        LobeProbabilities { coat, sheen, returned, view }
    }

    /// The coat, seen from its side.
    fn coat_above(&self, wo: Vec3) -> Option<&Clearcoat> {
        self.coat.as_ref().filter(|_| wo.z > 0.0)
    }

    /// The sheen, seen from its side.
    fn sheen_above(&self, wo: Vec3) -> Option<&Sheen> {
        self.sheen.as_ref().filter(|_| wo.z > 0.0)
    }

    fn eval(&self, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (wo, side) = self.flip_to_front(wo);
        if !is_above(wo.z.abs()) {
            return (Vec3::ZERO, 0.0);
        }
        self.evaluate(&self.lobe_probabilities(wo), wo, wi * side)
    }

    fn evaluate(&self, lobes: &LobeProbabilities, wo: Vec3, wi: Vec3) -> (Vec3, f32) {
        let (through_coat, through_sheen) = self.transmittance(wo, wi);
        let (below, below_pdf) = self.base.eval(self.kept(), wo, wi);
        let (mut value, mut pdf) = (below * through_sheen, below_pdf * lobes.base());
        let above = is_above(wo.z) && is_above(wi.z);
        let either = is_above(wo.z.abs()) && is_above(wi.z.abs());
        if let Some(sheen) = self.sheen.as_ref().filter(|_| above) {
            value += sheen.eval(wo, wi);
            pdf += Sheen::PDF * lobes.sheen;
        }
        value *= through_coat;
        if let Some(returned) = self.returned.as_ref().filter(|_| either && lobes.returned > 0.0) {
            let (again, density) = returned.eval(lobes.view, wo, wi);
            value += again;
            pdf += density * lobes.returned;
        }
        if let Some(coat) = self.coat.as_ref().filter(|_| above) {
            let (reflected, density) = coat.eval(wo, wi);
            value += reflected;
            pdf += density * lobes.coat;
        }
        (value, pdf)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2) -> Option<BsdfSample> {
        let (wo, side) = self.flip_to_front(wo);
        if !is_above(wo.z.abs()) {
            return None;
        }
        let lobes = self.lobe_probabilities(wo);
        let mut eta = 1.0;
        let wi = if let Some(coat) = self.coat.as_ref().filter(|_| u_lobe < lobes.coat) {
            coat.sample(wo, u).filter(|wi| is_above(wi.z))?
        } else if u_lobe < lobes.coat + lobes.sheen {
            Some(Sheen::sample(u)).filter(|wi| is_above(wi.z))?
        } else if u_lobe < lobes.coat + lobes.sheen + lobes.returned {
            let rest = (u_lobe - lobes.coat - lobes.sheen) / lobes.returned;
            let inside = self.returned.as_ref().map_or(0.0, Returned::inside_probability);
            let wi = Some(warp::cosine_hemisphere(u)).filter(|wi| is_above(wi.z))?;
            let wi = if rest < inside { -wi } else { wi };
            eta = if wi.z * wo.z < 0.0 { self.base.eta(wo) } else { 1.0 };
            wi
        } else {
            let rest = (u_lobe - lobes.coat - lobes.sheen - lobes.returned) / lobes.base();
            let rest = rest.clamp(0.0, ONE_MINUS_EPSILON);
            let mut sample = self.base.sample(self.kept(), wo, rest, u)?;
            if sample.delta {
                let (through_coat, through_sheen) = self.transmittance(wo, sample.wi);
                sample.weight *= through_coat * through_sheen / lobes.base();
                sample.pdf *= lobes.base();
                sample.wi *= side;
                return Some(sample);
            }
            eta = sample.eta;
            sample.wi
        };
        let (value, pdf) = self.evaluate(&lobes, wo, wi);
        BsdfSample::from_value(wi * side, value, pdf, eta)
    }
}
