//! BSDFs in lanes have the same bits at every width. One lane is the form of the BSDFs themselves,
//! so what holds for those by furnaces and chi-squared holds for all lanes.

use crate::material::lanes::{
    BSDF_ROWS, BsdfLanes, BsdfRows, LambertLanes, MetallicRoughnessLanes, SmoothGlassLanes,
};
use crate::material::{BaseBsdf, BsdfForm, Dielectric, SurfaceParams};
use crate::math::{Vec2, Vec3};
use crate::sampling::{Sampler, warp};
use crate::simd::lanes::{
    Float, Lanes, Lanes8, Lanes16, MAX_LANES, Mask, Rows, Scalar, Uint, Vec3f,
};
use crate::simd::{Isa, vectorized};

/// Numbers that come of one BSDF.
const NUMBERS: usize = 16;

/// What lanes are asked, a row or two each.
struct Questions {
    bsdf: [Rows; BSDF_ROWS],
    /// A direction and the number that chooses the lobe.
    wo: Rows,
    /// A direction, and nothing.
    wi: Rows,
    /// The numbers that choose the direction, and nothing.
    u: Rows,
}

/// The answers by lane, as bits.
type Answers = [[u32; NUMBERS]; MAX_LANES];

impl Questions {
    fn new(rows: impl Fn(&mut Sampler) -> BsdfRows, seed: u64) -> Self {
        let row = |v: Vec3, w: f32| [v.x, v.y, v.z, w];
        let none = Rows::default();
        let mut questions = Self { bsdf: [none; BSDF_ROWS], wo: none, wi: none, u: none };
        for lane in 0..MAX_LANES {
            let mut sampler = Sampler::independent(lane as u64, 0, seed);
            let described = rows(&mut sampler);
            for (rows, row) in questions.bsdf.iter_mut().zip(described) {
                rows[lane] = row;
            }
            let (wo, wi) = (warp::sphere(sampler.next_2d()), warp::sphere(sampler.next_2d()));
            questions.wo[lane] = row(wo, sampler.next_1d());
            questions.wi[lane] = row(wi, 0.0);
            let u = sampler.next_2d();
            questions.u[lane] = [u.x, u.y, 0.0, 0.0];
        }
        questions
    }

    /// One lane's questions, in the first place.
    fn of_lane(&self, lane: usize) -> Self {
        let first = |rows: &Rows| [rows[lane]; MAX_LANES];
        let Self { bsdf, wo, wi, u } = self;
        Self { bsdf: bsdf.map(|rows| first(&rows)), wo: first(wo), wi: first(wi), u: first(u) }
    }
}

#[inline(always)]
fn ask<L: Lanes, B: BsdfLanes<L>>(lanes: L, form: BsdfForm, questions: &Questions) -> Answers {
    let [x, y, z, u_lobe] = lanes.columns(&questions.wo);
    let wo = Vec3f::<L>::new(x, y, z);
    let wi = Vec3f::<L>::of_columns(lanes.columns(&questions.wi));
    let [u, v, ..] = lanes.columns(&questions.u);
    let bsdf = B::load(lanes, &questions.bsdf, form, wo);
    let (value, pdf) = bsdf.eval(lanes, wo, wi);
    let sample = bsdf.sample(lanes, wo, u_lobe, [u, v]);
    let albedo = bsdf.albedo(lanes);
    let zero = lanes.float(0.0);
    let of_sample = [
        sample.wi.x,
        sample.wi.y,
        sample.wi.z,
        sample.weight.x,
        sample.weight.y,
        sample.weight.z,
        sample.pdf,
        sample.eta,
    ];
    let mut answers = Answers::default();
    let mut put = |place: usize, number: L::Float| {
        let mut bits = [0; MAX_LANES];
        number.to_bits().store(&mut bits);
        for (answers, bits) in answers.iter_mut().zip(bits) {
            answers[place] = bits;
        }
    };
    for (place, number) in
        [value.x, value.y, value.z, pdf, albedo.x, albedo.y, albedo.z].into_iter().enumerate()
    {
        put(place, number);
    }
    for (place, number) in of_sample.into_iter().enumerate() {
        // What is not valid may be anything.
        put(7 + place, sample.valid.select(number, zero));
    }
    put(15, sample.valid.select(lanes.float(1.0), zero));
    answers
}

/// Checks one kind of BSDF at every width and instruction set.
macro_rules! check {
    ($kind:ident, $form:expr, $rows:expr) => {
        for seed in 0..100 {
            let questions = Questions::new($rows, seed);
            let expected: Answers = std::array::from_fn(|lane| {
                ask::<_, $kind<_>>(Scalar, $form, &questions.of_lane(lane))[0]
            });
            for isa in Isa::available() {
                vectorized!(isa.level().expect("available"), simd => {
                    let eight = ask::<_, $kind<_>>(Lanes8(simd), $form, &questions);
                    assert_eq!(eight[..8], expected[..8], "{isa}");
                    let sixteen = ask::<_, $kind<_>>(Lanes16(simd), $form, &questions);
                    assert_eq!(sixteen, expected, "{isa}");
                });
            }
        }
    };
}

#[test]
fn bsdfs_have_the_same_bits_at_every_width() {
    for form in BsdfForm::ALL {
        check!(LambertLanes, form, |sampler| {
            let base_color = Vec3::new(sampler.next_1d(), sampler.next_1d(), 0.5);
            let params = SurfaceParams { specular: 0.0, base_color, ..SurfaceParams::default() };
            match BaseBsdf::new(&params, form) {
                BaseBsdf::Lambert(lambert) => lambert.rows(),
                _ => unreachable!("no coat"),
            }
        });
        check!(MetallicRoughnessLanes, form, |sampler| {
            let base_color = Vec3::new(sampler.next_1d(), 1.0, sampler.next_1d());
            let metallic = [0.0, 1.0, sampler.next_1d()][(sampler.next_1d() * 3.0) as usize];
            let roughness = [0.0, 1.0, sampler.next_1d()][(sampler.next_1d() * 3.0) as usize];
            let params =
                SurfaceParams { base_color, metallic, roughness, ..SurfaceParams::default() };
            match BaseBsdf::new(&params, form) {
                BaseBsdf::MetallicRoughness(surface) => surface.rows(),
                _ => unreachable!("a coat"),
            }
        });
        check!(SmoothGlassLanes, form, |sampler| {
            smooth_glass(sampler, form).rows().expect("smooth")
        });
    }
}

/// Some glass, solid or thin.
fn smooth_glass(sampler: &mut Sampler, form: BsdfForm) -> Dielectric {
    let params = SurfaceParams {
        base_color: Vec3::new(sampler.next_1d(), 1.0, sampler.next_1d()),
        ior: 0.5 + 2.0 * sampler.next_1d(),
        roughness: 0.0,
        thin: sampler.next_1d() < 0.5,
        ..SurfaceParams::default()
    };
    Dielectric::new(&params, form)
}

/// The boundaries of all kinds of smooth glass take their reflectances from elsewhere.
#[test]
fn plain_glass_in_lanes_is_glass() {
    for seed in 0..1000 {
        let mut sampler = Sampler::independent(seed, 0, 1);
        let glass = smooth_glass(&mut sampler, BsdfForm::Conserving);
        let (wo, u_lobe) = (warp::sphere(sampler.next_2d()), sampler.next_1d());
        let rows = glass.rows().expect("smooth");
        let lanes = SmoothGlassLanes::new(Scalar, rows, BsdfForm::Conserving, wo.into());
        let found = lanes.sample(Scalar, wo.into(), u_lobe, [0.0; 2]).first(true);
        assert_eq!(found, glass.sample(wo, u_lobe, Vec2::ZERO));
    }
    let dull = SurfaceParams { specular: 0.5, roughness: 0.0, ..SurfaceParams::default() };
    assert!(Dielectric::new(&dull, BsdfForm::Conserving).rows().is_none());
    let rough = SurfaceParams { roughness: 0.5, ..SurfaceParams::default() };
    assert!(Dielectric::new(&rough, BsdfForm::Conserving).rows().is_none());
}
