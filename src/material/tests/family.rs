//! BSDFs of every kind, and what tests ask of them.

use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

use crate::material::sample::mean;
use crate::material::{Bsdf, BsdfForm, BsdfSample, Layers, SurfaceParams};
use crate::math::{Vec2, Vec3};
use crate::sampling::{Sampler, warp};

/// A soap film.
pub const FILM: Layers = Layers {
    iridescence: 1.0,
    iridescence_ior: 1.33,
    iridescence_thickness: 380.0,
    ..Layers::NONE
};

/// What lets some light through, scattered.
pub const LEAF: SurfaceParams = SurfaceParams {
    base_color: Vec3::new(0.3, 0.6, 0.1),
    metallic: 0.0,
    roughness: 0.5,
    ior: 1.5,
    specular: 1.0,
    specular_color: Vec3::ONE,
    transmission: 0.0,
    diffuse_transmission: 0.6,
    diffuse_transmission_color: Vec3::new(0.8, 0.9, 0.2),
    thin: true,
};

/// Every kind of BSDF in both forms, over roughness, by name.
pub fn all() -> Vec<(String, Bsdf)> {
    let (white, red) = (SurfaceParams::default(), Vec3::new(1.0, 0.3, 0.0));
    let kinds = [
        ("lambert", SurfaceParams { specular: 0.0, ..white }),
        ("coated", white),
        ("dense", SurfaceParams { ior: 2.4, base_color: Vec3::new(0.8, 0.4, 0.1), ..white }),
        ("metal", SurfaceParams { metallic: 1.0, ..white }),
        ("half metal", SurfaceParams { metallic: 0.5, base_color: Vec3::splat(0.6), ..white }),
        ("glass", SurfaceParams { transmission: 1.0, ..white }),
        (
            "tinted",
            SurfaceParams { transmission: 1.0, base_color: Vec3::new(0.9, 0.5, 0.2), ..white },
        ),
        ("bubble", SurfaceParams { transmission: 1.0, ior: 0.75, ..white }),
        ("sheet", SurfaceParams { transmission: 1.0, thin: true, ..white }),
        ("leaf", LEAF),
        ("thick leaf", SurfaceParams { thin: false, diffuse_transmission: 1.0, ..LEAF }),
        ("wax", SurfaceParams { metallic: 0.25, thin: false, transmission: 0.4, ..LEAF }),
        ("half clear", SurfaceParams { transmission: 0.5, metallic: 0.25, ..white }),
        ("red sheen on glass", SurfaceParams { specular_color: red, transmission: 1.0, ..white }),
        ("dull glass", SurfaceParams { specular: 0.5, transmission: 1.0, ..white }),
        (
            "bright sheet",
            SurfaceParams { specular_color: red * 9.0, transmission: 1.0, thin: true, ..white },
        ),
    ];
    let mut all = Vec::new();
    for form in BsdfForm::ALL {
        for (name, params) in kinds {
            for roughness in [0.0, 0.35, 0.6, 1.0] {
                let bsdf = Bsdf::new(&SurfaceParams { roughness, ..params }, form);
                all.push((format!("{name}, roughness {roughness}, {form}"), bsdf));
            }
        }
        all.extend(under_layers(form));
    }
    all
}

/// Layers over bases of roughness 0.5; "bent" where the coat has a normal of its own.
fn under_layers(form: BsdfForm) -> impl Iterator<Item = (String, Bsdf)> {
    let base = SurfaceParams { roughness: 0.5, ..SurfaceParams::default() };
    let red = SurfaceParams { base_color: Vec3::new(0.7, 0.1, 0.05), ..base };
    let metal = SurfaceParams { metallic: 1.0, base_color: Vec3::new(1.0, 0.7, 0.3), ..base };
    let glass = SurfaceParams { transmission: 1.0, ..base };
    let coat = Layers { clearcoat: 1.0, clearcoat_roughness: 0.35, ..Layers::NONE };
    let cloth =
        Layers { sheen_color: Vec3::new(0.9, 0.4, 0.2), sheen_roughness: 0.4, ..Layers::NONE };
    let brushed =
        Layers { anisotropy: 0.6, anisotropy_direction: Vec2::new(0.6, -0.8), ..Layers::NONE };
    let both = Layers { clearcoat: 0.5, ..cloth };
    let bent = Layers { clearcoat_normal: Vec3::new(0.36, -0.48, 0.8), ..coat };
    let all = [
        ("varnish", red, coat),
        ("half varnish", metal, Layers { clearcoat: 0.5, clearcoat_roughness: 0.7, ..coat }),
        ("velvet", red, cloth),
        ("fine velvet", base, Layers { sheen_roughness: 0.15, ..cloth }),
        ("brushed", metal, brushed),
        ("brushed coat", red, Layers { anisotropy: 1.0, ..brushed }),
        ("all layers", metal, Layers { anisotropy: 0.5, clearcoat: 0.8, ..cloth }),
        ("bent coat", red, bent),
        ("cloth on glass", glass, cloth),
        ("waxed leaf", LEAF, coat),
        ("cloth on wax", SurfaceParams { thin: false, transmission: 0.5, ..LEAF }, cloth),
        ("lacquered glass", glass, coat),
        (
            "lacquer on dull red glass",
            SurfaceParams { specular: 0.5, transmission: 1.0, ..red },
            coat,
        ),
        ("lacquer and cloth on half clear", SurfaceParams { transmission: 0.5, ..base }, both),
        ("waxed thick leaf", SurfaceParams { thin: false, ..LEAF }, coat),
        ("film on plastic", red, FILM),
        ("film on metal", metal, Layers { iridescence: 0.7, ..FILM }),
        ("film on brushed metal", metal, Layers { iridescence_ior: 1.8, anisotropy: 0.5, ..FILM }),
        ("lacquered film", metal, Layers { clearcoat: 0.6, ..FILM }),
        ("film on glass", glass, FILM),
        (
            "lacquered film on a sheet",
            SurfaceParams { thin: true, ..glass },
            Layers { clearcoat: 0.6, ..FILM },
        ),
        ("film on half clear", SurfaceParams { transmission: 0.5, metallic: 0.25, ..glass }, FILM),
        ("cloth on a sheet", SurfaceParams { thin: true, ..glass }, cloth),
    ];
    all.into_iter().map(move |(name, params, layers)| {
        let layers = Layers { clearcoat_roughness: layers.clearcoat_roughness.max(0.3), ..layers };
        (format!("{name}, {form}"), Bsdf::layered(&params, &layers, form))
    })
}

/// A direction at that cosine, away from the axes.
pub fn direction(cos: f32) -> Vec3 {
    let ring = warp::unit_circle(0.07) * (1.0 - cos * cos).sqrt();
    Vec3::new(ring.x, ring.y, cos)
}

/// Draws from a BSDF at independent points, or at stratified ones.
pub fn draw(bsdf: &Bsdf, wo: Vec3, point: u64, sample: u64) -> Option<BsdfSample> {
    let mut sampler = Sampler::new(point, sample, 17);
    let u = sampler.next_2d();
    bsdf.sample(wo, sampler.next_1d(), u)
}

/// The share of light from `wo` that is scattered, and the standard deviation of one sample.
///
/// The scaling of radiance by eta² is taken out.
pub fn scattered(bsdf: &Bsdf, wo: Vec3, samples: u64) -> (Vec3, f32) {
    let (mut sum, mut squares) = (Vec3::ZERO, 0.0);
    for i in 0..samples {
        if let Some(sample) = draw(bsdf, wo, 3, i) {
            let weight = sample.weight * (sample.eta * sample.eta);
            sum += weight;
            squares += mean(weight) * mean(weight);
        }
    }
    let n = samples as f32;
    (sum / n, (squares / n - mean(sum / n) * mean(sum / n)).max(0.0).sqrt())
}

/// Coordinates at which formulas break.
pub fn awkward() -> impl Strategy<Value = f32> {
    let special = prop::sample::select(vec![
        0.0, -0.0, 1.0, -1.0, 1e-8, -1e-8, 1e-20, 1e-38, 1e-45, 0.5, 1e-4,
    ]);
    prop_oneof![special, -1.0..1.0_f32]
}

/// Whether values, densities and samples are finite and not negative.
pub fn is_sane(bsdf: &Bsdf, wo: Vec3, wi: Vec3, u_lobe: f32, u: Vec2) -> Result<(), TestCaseError> {
    let (value, pdf) = bsdf.eval(wo, wi);
    prop_assert!(value.is_finite() && value.min_element() >= 0.0, "{} {:?}", value, bsdf);
    prop_assert!(pdf.is_finite() && pdf >= 0.0);
    if let Some(sample) = bsdf.sample(wo, u_lobe, u) {
        prop_assert!((sample.wi.length() - 1.0).abs() < 1e-3, "{:?}", sample);
        prop_assert!(sample.weight.is_finite() && sample.weight.min_element() >= 0.0);
        prop_assert!(sample.pdf.is_finite() && sample.pdf > 0.0 && sample.eta > 0.0);
    }
    prop_assert!(bsdf.albedo().is_finite());
    Ok(())
}
