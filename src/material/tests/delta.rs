//! What must hold where light goes on in a few directions alone: smooth glass and sheets, what
//! lies on them, and mixtures with what scatters.

use super::family::{FILM, direction};
use crate::material::{Bsdf, BsdfForm, BsdfSample, Layers, SurfaceParams};
use crate::math::Vec3;
use crate::sampling::Sampler;
use crate::sampling::chi_squared::assert_fits;

/// By name, and whether all that comes is to go on.
fn smooth() -> Vec<(String, Bsdf, bool)> {
    let glass = SurfaceParams { transmission: 1.0, roughness: 0.0, ..SurfaceParams::default() };
    let sheet = SurfaceParams { thin: true, ..glass };
    let half = Layers { iridescence: 0.5, iridescence_ior: 1.8, ..FILM };
    let coat = Layers { clearcoat: 0.7, clearcoat_roughness: 0.4, ..Layers::NONE };
    let cloth = Layers { sheen_color: Vec3::splat(0.7), sheen_roughness: 0.4, ..Layers::NONE };
    let red = Vec3::new(1.0, 0.3, 0.0);
    let kinds = [
        ("glass", glass, Layers::NONE, true),
        ("diamond", SurfaceParams { ior: 2.4, ..glass }, Layers::NONE, true),
        ("bubble", SurfaceParams { ior: 0.75, ..glass }, Layers::NONE, true),
        ("sheet", sheet, Layers::NONE, true),
        ("dull glass", SurfaceParams { specular: 0.5, ..glass }, Layers::NONE, true),
        ("bare glass", SurfaceParams { specular: 0.0, ..glass }, Layers::NONE, true),
        ("red sheen on glass", SurfaceParams { specular_color: red, ..glass }, Layers::NONE, true),
        (
            "red sheen on a sheet",
            SurfaceParams { specular_color: red, ..sheet },
            Layers::NONE,
            true,
        ),
        ("film on a bare sheet", SurfaceParams { specular: 0.0, ..sheet }, FILM, true),
        ("tinted sheet", SurfaceParams { base_color: Vec3::X, ..sheet }, Layers::NONE, false),
        ("half clear", SurfaceParams { transmission: 0.5, ..glass }, Layers::NONE, false),
        ("half clear sheet", SurfaceParams { transmission: 0.5, ..sheet }, Layers::NONE, false),
        ("film on glass", glass, FILM, true),
        ("film on a sheet", sheet, FILM, true),
        ("half a film on a sheet", sheet, half, true),
        ("half a film on glass", glass, half, true),
        ("film on a half clear sheet", SurfaceParams { transmission: 0.5, ..sheet }, FILM, false),
        ("lacquered sheet", sheet, coat, false),
        ("lacquered glass", glass, coat, false),
        ("cloth on half clear", SurfaceParams { transmission: 0.5, ..glass }, cloth, false),
        ("lacquered film on a sheet", sheet, Layers { clearcoat: 0.7, ..FILM }, false),
        ("cloth on a sheet", sheet, cloth, false),
    ];
    let of = |form| {
        kinds.map(|(name, params, layers, whole)| {
            let layers = Layers { clearcoat_roughness: 0.4, ..layers };
            (format!("{name}, {form}"), Bsdf::layered(&params, &layers, form), whole)
        })
    };
    BsdfForm::ALL.into_iter().flat_map(of).collect()
}

/// One of the few directions.
struct Way {
    sample: BsdfSample,
    count: u64,
}

const COUNT: u64 = 20_000;

/// The ways that light takes from `wo`, and how often it takes none of them.
fn ways(name: &str, bsdf: &Bsdf, wo: Vec3) -> (Vec<Way>, u64) {
    let (mut ways, mut others): (Vec<Way>, u64) = (Vec::new(), 0);
    for i in 0..COUNT {
        let mut sampler = Sampler::new(i, 0, 23);
        let u = sampler.next_2d();
        let Some(sample) = bsdf.sample(wo, sampler.next_1d(), u).filter(|s| s.delta) else {
            others += 1;
            continue;
        };
        match ways.iter_mut().find(|way| way.sample.wi.distance(sample.wi) < 1e-4) {
            Some(way) => {
                assert!((way.sample.pdf - sample.pdf).abs() < 1e-5, "{name}: {sample:?}");
                way.count += 1;
            }
            None => ways.push(Way { sample, count: 1 }),
        }
    }
    assert!(ways.len() <= 2, "{name}: {} directions", ways.len());
    (ways, others)
}

/// Each way is taken as often as it says, and all ways together carry what comes.
#[test]
fn ways_are_taken_as_often_as_they_say() {
    let all = smooth();
    let cosines = [0.9, 0.4, 0.15, -0.6];
    for (name, bsdf, whole) in &all {
        for cos in cosines {
            let (ways, others) = ways(name, bsdf, direction(cos));
            let mut counts: Vec<u64> = ways.iter().map(|way| way.count).collect();
            let chances: Vec<f64> = ways.iter().map(|way| f64::from(way.sample.pdf)).collect();
            let rest = 1.0 - chances.iter().sum::<f64>();
            assert!(rest > -1e-5, "{name}, {cos}: {chances:?}");
            let mut expected: Vec<f64> = chances.iter().map(|p| p * COUNT as f64).collect();
            counts.push(others);
            expected.push(rest.max(0.0) * COUNT as f64 + 1e-2);
            if expected.iter().filter(|&&count| count >= 5.0).count() > 1 {
                let family = all.len() * cosines.len();
                assert_fits(&counts, &expected, family, &format!("{name}, {cos}"));
            } else {
                // Total reflection.
                assert_eq!(counts[0], COUNT, "{name}, {cos}");
            }
            let carried =
                |Way { sample, .. }: &Way| sample.weight * (sample.pdf * sample.eta * sample.eta);
            let sum: Vec3 = ways.iter().map(carried).sum();
            if *whole {
                assert!((sum - Vec3::ONE).abs().max_element() < 1e-4, "{name}, {cos}: {sum}");
            } else {
                assert!(sum.max_element() < 1.0001, "{name}, {cos}: {sum}");
            }
        }
    }
}

/// A film colours what a sheet reflects, and what it lets through the other way.
#[test]
fn a_film_colours_a_sheet_both_ways() {
    let all = smooth();
    let found = all.iter().find(|(name, ..)| name.starts_with("film on a sheet"));
    let (name, bsdf, _) = found.expect("is among them");
    let (ways, _) = ways(name, bsdf, direction(0.9));
    let [up, down] = [1.0, -1.0].map(|side| {
        let way = ways.iter().find(|way| way.sample.wi.z * side > 0.0).expect("both sides");
        way.sample.weight * way.sample.pdf
    });
    assert!(up.max_element() > 1.5 * up.min_element(), "{up}");
    assert!((up.x < up.z) == (down.x > down.z), "{up} {down}");
}
