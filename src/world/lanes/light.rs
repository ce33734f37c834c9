//! Sampling direct light in lanes.

use super::super::World;
use super::super::emitters::Emitter;
use super::super::lights::ChosenLight;
use super::super::sample_light::SEGMENT_ERROR;
use super::environment::sample_environment;
use super::light_samples::LightSamples;
use super::surface::{SurfaceLanes, offset_origin, triangle_point};
use crate::light::{Illumination, LightSampleContext};
use crate::math::{Vec2, Vec3};
use crate::sampling::warp;
use crate::simd::lanes::{Float, Lanes, Rows, Vec3f};

/// What the lights that were chosen are computed from; one for many blocks of lanes, since it takes
/// time to clear.
#[derive(Default)]
pub struct LightRows {
    /// Who asks: only if the choice depends on it.
    positions: Rows,
    normals: Rows,
    /// The number that chooses the light and those that choose the place on it; then the latter.
    u: Rows,
    /// The corners of an emitting triangle; in the fourth place, in turn: the probability of the
    /// light, one if it shines from both sides, zero. Or the direction to a light without extent
    /// and the light's place; in the fourth: the probability, one if it has a place.
    corners: [Rows; 3],
    /// The triangle's radiance, which is the same all over it, or the irradiance.
    radiance: Rows,
    /// A bit for each lane whose light is a triangle; one without extent; the environment; none
    /// of these.
    triangles: u32,
    punctual: u32,
    environment: u32,
    others: u32,
}

impl World {
    /// Chooses a light for each lane and a direction to it, as [`World::sample_light`] does; also
    /// the lanes whose light must be sampled by that, since it is of a rarer kind.
    #[inline(always)]
    pub fn sample_light_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        surface: &SurfaceLanes<L>,
        u_light: L::Float,
        u: [L::Float; 2],
        rows: &mut LightRows,
    ) -> (LightSamples<L>, u32) {
        self.choose_in_lanes(lanes, surface, u_light, u, rows);
        let [u, v, ..] = lanes.columns(&rows.u);
        let u = [u, v];
        let mut samples = sample_triangles(lanes, surface, rows, u, self.slack);
        if let (Some(environment), true) = (&self.scene.environment, rows.environment != 0) {
            let mask = lanes.mask(rows.environment);
            let [_, _, _, pmf] = lanes.columns(&rows.corners[0]);
            let far = sample_environment(lanes, environment, pmf, u);
            samples = LightSamples::select(mask, &far, &samples);
        }
        if rows.punctual != 0 {
            let mask = lanes.mask(rows.punctual);
            samples = LightSamples::select(mask, &towards_punctual(lanes, rows), &samples);
        }
        (samples, rows.others)
    }

    #[inline(always)]
    fn choose_in_lanes<L: Lanes>(
        &self,
        lanes: L,
        surface: &SurfaceLanes<L>,
        u_light: L::Float,
        [u, v]: [L::Float; 2],
        rows: &mut LightRows,
    ) {
        (rows.triangles, rows.punctual, rows.environment, rows.others) = (0, 0, 0, 0);
        lanes.rows([u_light, u, v, u], &mut rows.u);
        let normal = surface.light_side();
        if self.lights.need_context() {
            lanes.rows(surface.position.columns(u_light), &mut rows.positions);
            lanes.rows(normal.columns(u_light), &mut rows.normals);
        }
        for lane in 0..L::WIDTH {
            let ([x, y, z, _], [nx, ny, nz, _]) = (rows.positions[lane], rows.normals[lane]);
            let [u_light, u, v, _] = rows.u[lane];
            let context =
                LightSampleContext { position: Vec3::new(x, y, z), normal: Vec3::new(nx, ny, nz) };
            let chosen = self.lights.choose(&context, u_light, Vec2::new(u, v));
            let Some((light, pmf, u)) = chosen else { continue };
            rows.u[lane] = [u.x, u.y, 0.0, 0.0];
            match light {
                ChosenLight::Punctual(light) if !self.scene.light_moves(light) => {
                    let lit = self.scene.lights[light].illuminate(context.position);
                    rows.fetch_punctual(lane, lit, pmf);
                }
                light => rows.fetch(lane, light, pmf),
            }
        }
    }
}

impl LightRows {
    /// Fetches what a light without extent sends to a lane, if anything.
    fn fetch_punctual(&mut self, lane: usize, lit: Option<Illumination>, pmf: f32) {
        let Some(Illumination { direction, origin, irradiance }) = lit else { return };
        let end = origin.unwrap_or(Vec3::ZERO);
        self.corners[0][lane] = [direction.x, direction.y, direction.z, pmf];
        self.corners[1][lane] = [end.x, end.y, end.z, f32::from(origin.is_some())];
        self.radiance[lane] = [irradiance.x, irradiance.y, irradiance.z, 0.0];
        self.punctual |= 1 << lane;
    }

    /// Fetches the light that was chosen for a lane.
    #[inline(always)]
    fn fetch(&mut self, lane: usize, light: ChosenLight, pmf: f32) {
        let bit = 1 << lane;
        match light {
            ChosenLight::Emitter(Emitter { even: Some(even), .. }) => {
                let last = [pmf, f32::from(even.both_sides), 0.0];
                for (rows, (p, w)) in self.corners.iter_mut().zip(even.corners.iter().zip(last)) {
                    rows[lane] = [p.x, p.y, p.z, w];
                }
                let radiance = even.radiance;
                self.radiance[lane] = [radiance.x, radiance.y, radiance.z, 0.0];
                self.triangles |= bit;
            }
            ChosenLight::Environment => {
                self.corners[0][lane][3] = pmf;
                self.environment |= bit;
            }
            _ => self.others |= bit,
        }
    }
}

/// Points of triangles that emit evenly; where no triangle was fetched, nothing arrives.
#[inline(always)]
fn sample_triangles<L: Lanes>(
    lanes: L,
    surface: &SurfaceLanes<L>,
    rows: &LightRows,
    u: [L::Float; 2],
    slack: f32,
) -> LightSamples<L> {
    let (zero, one) = (lanes.float(0.0), lanes.float(1.0));
    let infinity = lanes.float(f32::INFINITY);
    let [ax, ay, az, pmf] = lanes.columns(&rows.corners[0]);
    let [bx, by, bz, both_sides] = lanes.columns(&rows.corners[1]);
    let c = Vec3f::<L>::of_columns(lanes.columns(&rows.corners[2]));
    let (a, b) = (Vec3f::<L>::new(ax, ay, az), Vec3f::<L>::new(bx, by, bz));
    let radiance = Vec3f::<L>::of_columns(lanes.columns(&rows.radiance));

    let double_area = (b - a).cross(c - a);
    let length = double_area.dot(double_area).sqrt();
    let has_area = length.gt(zero);
    let flat = Vec3f::splat(zero);
    let normal = Vec3f::select(has_area, double_area.divide(length), flat);
    let area = length * 0.5;
    let uv = warp::triangle_in_lanes::<L>(u);
    let (point, error) = triangle_point(lanes, [a, b, c], uv, slack);
    let towards = point - surface.position;
    let distance2 = towards.dot(towards);
    let inverse = one / distance2.sqrt();
    let direction = towards.scale(inverse);
    let cosine = -normal.dot(direction);
    let pdf = pmf * (distance2 / (area * cosine.abs()));
    let error = error + towards.abs().scale(lanes.float(SEGMENT_ERROR));
    let end = offset_origin(lanes, point, error, normal, -direction);
    LightSamples {
        direction,
        radiance,
        pdf,
        delta: lanes.mask(0),
        end,
        far: lanes.mask(0),
        valid: (inverse.gt(zero) & inverse.lt(infinity))
            & (pdf.gt(zero) & pdf.lt(infinity))
            & (both_sides.gt(zero) | !cosine.lt(zero))
            & !radiance.is_zero()
            & lanes.mask(rows.triangles),
    }
}

/// Lights without extent.
#[inline(always)]
fn towards_punctual<L: Lanes>(lanes: L, rows: &LightRows) -> LightSamples<L> {
    let [x, y, z, pmf] = lanes.columns(&rows.corners[0]);
    let direction = Vec3f::new(x, y, z);
    let [x, y, z, has_place] = lanes.columns(&rows.corners[1]);
    let place = Vec3f::<L>::new(x, y, z);
    let is_near = has_place.gt(lanes.float(0.0));
    let all = lanes.first(L::WIDTH);
    LightSamples {
        direction,
        radiance: Vec3f::of_columns(lanes.columns(&rows.radiance)),
        pdf: pmf,
        delta: all,
        end: Vec3f::select(is_near, place, direction),
        far: !is_near,
        valid: all,
    }
}
