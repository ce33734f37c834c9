//! A look ahead: how much of the frame shows a surface, and how much of that is lit.
//!
//! Whether a scene brings light is judged by what its light does, not by whether something emits:
//! a lamp in a street lights the street, a glowing button does not. So a tiny picture of the whole
//! frame is rendered first, with settings of its own. It is a picture like any other, thus the same
//! for every structure, instruction set and number of threads; resolution, samples, seed and crop
//! of the picture to come have no say but by its aspect.

use std::sync::atomic::AtomicBool;

use super::film::Film;
use super::settings::{Aov, Settings};
use super::stream::ray_key;
use crate::accel::{Accel, Batch, ClosestHit, HitFilter};
use crate::camera::moving::MovingCamera;
use crate::film::{Picture, PixelFilter, Window};
use crate::integrator::Transport;
use crate::math::{Ray, Vec2};
use crate::world::{AlphaFilter, World};

/// Pixels of the tiny picture, about.
const PIXELS: f32 = 1296.0;
/// Samples of each.
const SPP: u64 = 16;
/// Segments of a path: enough to leave a room by its window, or a bulb of glass.
const MAX_DEPTH: u32 = 8;

/// The radiance of white paper, from which it counts as lit: a sixth of full brightness on a
/// screen.
const LEAST_LIGHT: f32 = 0.03;
/// Nothing is so dark that it must not shine at all.
const LEAST_ALBEDO: f32 = 0.05;
/// What reflects less than this and is not lit is black under any light.
const BLACK: f32 = 0.002;

/// The share of what is seen, and does not shine, that light must reach; else the share of what is
/// seen that must shine.
const ENOUGH: f32 = 0.25;
const MOST: f32 = 0.5;

/// What a look ahead has found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sight {
    /// The share of the frame in which there is a surface.
    pub seen: f32,
    /// The share of those surfaces that is to be seen by some light: it falls on them, or they
    /// shine; apart from such as no light makes visible.
    pub lit: f32,
    /// The share that light falls on of those that do not shine themselves.
    pub reached: f32,
    /// The share of those surfaces that shines.
    pub glows: f32,
    /// The share of those surfaces that would be black under any light.
    pub black: f32,
    /// The share of those surfaces that is seen from behind.
    pub behind: f32,
    /// Half of those surfaces are nearer, metres; zero if there is none.
    pub distance: f32,
    /// The share of the frame in which there are triangles, whether they are cut away or not.
    pub in_view: f32,
}

impl Sight {
    /// Whether light reaches enough of what is seen, or most of that shines.
    pub fn is_lit(&self) -> bool {
        self.reached >= ENOUGH || self.glows >= MOST
    }
}

/// Looks at all of a frame of `aspect`, on the threads of the current rayon pool.
pub fn look_ahead(world: &World, camera: &MovingCamera, accel: &dyn Accel, aspect: f32) -> Sight {
    let settings = settings(aspect);
    let picture = |max_depth: u32| {
        static NEVER: AtomicBool = AtomicBool::new(false);
        let transport = Transport { max_depth, ..settings.transport };
        let film = Film::new(Settings { transport, ..settings.clone() });
        film.accumulate(world, camera, accel, SPP, &NEVER);
        film.finish().picture
    };
    // The same samples, but of what shines alone.
    let (shining, all) = (picture(1), picture(MAX_DEPTH));
    let (emitted, radiance) = (luminance(&shining, ""), luminance(&all, ""));
    let albedo = luminance(&all, "albedo.");
    let there = all.channel("A").unwrap_or_default();
    let mut sums = Sums::default();
    for (pixel, &there) in there.iter().enumerate().filter(|(_, there)| **there > 0.0) {
        let enough = LEAST_LIGHT * albedo[pixel].max(LEAST_ALBEDO * there);
        let there_is = f64::from(there);
        sums.seen += there_is;
        let reflected = radiance[pixel] - emitted[pixel];
        if emitted[pixel] >= enough {
            sums.glows += there_is;
        } else if reflected >= enough {
            sums.reached += there_is;
        } else if albedo[pixel] < BLACK * there {
            sums.black += there_is;
        }
    }
    let Firsts { behind, distance, in_view } = look_at_firsts(world, camera, accel, &settings);
    let share = |part: f64, whole: f64| if whole > 0.0 { (part / whole) as f32 } else { 0.0 };
    let Sums { seen, glows, reached, black } = sums;
    Sight {
        seen: share(seen, settings.crop.area() as f64),
        lit: share(glows + reached, seen - black),
        reached: share(reached, seen - black - glows),
        glows: share(glows, seen),
        black: share(black, seen),
        behind,
        distance,
        in_view,
    }
}

/// Of surfaces of some kind, the number of pixels that they fill.
#[derive(Default)]
struct Sums {
    seen: f64,
    glows: f64,
    reached: f64,
    black: f64,
}

/// The luminance of a layer of a picture, pixel by pixel.
fn luminance(picture: &Picture, layer: &str) -> Vec<f32> {
    let plane = |axis: &str| picture.channel(&format!("{layer}{axis}")).unwrap_or_default();
    let sum = |((r, g), b): ((&f32, &f32), &f32)| 0.2126 * r + 0.7152 * g + 0.0722 * b;
    plane("R").iter().zip(plane("G")).zip(plane("B")).map(sum).collect()
}

/// The settings of the tiny picture. The environment is hidden from the camera: alpha then tells
/// where there are surfaces, and colours are theirs alone.
fn settings(aspect: f32) -> Settings {
    let aspect = aspect.clamp(1.0 / PIXELS, PIXELS);
    let side = |side: f32| side.round().clamp(1.0, PIXELS) as u32;
    let resolution = (side((PIXELS * aspect).sqrt()), side((PIXELS / aspect).sqrt()));
    Settings {
        crop: Window::of_size(resolution.0 as usize, resolution.1 as usize),
        spp: SPP,
        filter: PixelFilter::Box,
        transport: Transport { transparent: true, ..Transport::default() },
        aovs: vec![Aov::Albedo],
        ..Settings::new(resolution.0, resolution.1)
    }
}

/// What is in the middle of each pixel.
struct Firsts {
    /// Of the surfaces: the share that is seen from behind.
    behind: f32,
    /// The median of their distances.
    distance: f32,
    /// The share of pixels in which there is a triangle, whatever its alpha.
    in_view: f32,
}

fn look_at_firsts(
    world: &World,
    camera: &MovingCamera,
    accel: &dyn Accel,
    settings: &Settings,
) -> Firsts {
    let (width, height) = settings.resolution;
    let camera = camera.rays(settings.aspect());
    let size = Vec2::new(width as f32, height as f32);
    let rays: Vec<Ray> = (0..width * height)
        .map(|pixel| Vec2::new((pixel % width) as f32, (pixel / width) as f32))
        .map(|at| camera.ray_at((at + 0.5) / size, Vec2::splat(0.5), 0.0))
        .collect();
    let keys: Vec<u64> = (0..u64::from(width * height)).map(|pixel| ray_key(pixel, 2)).collect();
    let filter = AlphaFilter::new(world, &keys, None);
    let filter = world.is_see_through().then_some(&filter as &dyn HitFilter);
    let mut hits = vec![ClosestHit::MISS; rays.len()];
    accel.tracer().closest_hits(&Batch::new(&rays).with_filter(filter), &mut hits);
    let met = || rays.iter().zip(&hits).filter(|(_, hit)| hit.is_hit());
    let behind = met().filter(|(ray, hit)| !world.surface(ray, hit, (0.0, 0.0)).front).count();
    let mut distances: Vec<f32> = met().map(|(_, hit)| hit.t).collect();
    distances.sort_by(f32::total_cmp);
    let behind = behind as f32 / distances.len().max(1) as f32;
    let mut count = distances.len();
    if filter.is_some() {
        accel.tracer().closest_hits(&Batch::new(&rays), &mut hits);
        count = hits.iter().filter(|hit| hit.is_hit()).count();
    }
    let in_view = count as f32 / rays.len().max(1) as f32;
    let distance = distances.get(distances.len() / 2).copied().unwrap_or(0.0);
    Firsts { behind, distance, in_view }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::accel::{self, AccelSpec};
    use crate::camera::Camera;
    use crate::geom::Mesh;
    use crate::light::{Environment, Punctual, PunctualKind};
    use crate::material::BsdfForm;
    use crate::math::{Affine3A, MaterialId, MeshId, Vec3, Vec4};
    use crate::scene::{AlphaMode, Instance, Material, Scene, Transform};
    use crate::simd::Isa;

    /// Two squares side by side, one metre each, facing +Z; the right one of `color`.
    fn squares(color: Vec4) -> Scene {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y];
        let indices = vec![[0, 1, 2], [0, 2, 3]];
        let mesh = Mesh { positions: corners.to_vec(), indices, ..Mesh::default() };
        let place = |x: f32, material: usize| Instance {
            mesh: MeshId::from_index(0),
            material: MaterialId::from_index(material),
            transform: Transform::new(Affine3A::from_translation(Vec3::new(x, -0.5, 0.0))),
        };
        let black = Material { base_color: color, specular: 0.0, ..Material::grey() };
        Scene {
            meshes: vec![Arc::new(mesh)],
            instances: vec![place(-1.0, 0), place(0.0, 1)],
            materials: vec![Material::grey(), black],
            ..Scene::default()
        }
    }

    fn look(scene: Scene, from: Vec3, accel: &str) -> Sight {
        let world = World::new(scene, BsdfForm::default()).expect("few triangles");
        let spec: AccelSpec = accel.parse().expect("a structure");
        let accel = accel::build(&spec, world.triangles.clone(), Isa::Auto).expect("no limits");
        // From two metres away the frame is as high as both squares are wide.
        let camera = Camera::look_at(from, Vec3::ZERO, Vec3::Y, 2.0 * libm::atanf(0.5)).into();
        look_ahead(&world, &camera, &*accel, 1.0)
    }

    #[test]
    fn what_is_seen_is_a_share_of_the_frame_and_what_is_lit_a_share_of_that() {
        let front = 2.0 * Vec3::Z;
        let dark = look(squares(Vec4::ONE), front, "brute");
        assert!((dark.seen - 0.5).abs() < 0.02, "{dark:?}");
        assert_eq!((dark.lit, dark.black, dark.behind), (0.0, 0.0, 0.0));
        assert!((2.0..2.2).contains(&dark.distance), "{dark:?}");

        let mut scene = squares(Vec4::ONE);
        scene.environment = Some(Environment::constant(Vec3::ONE));
        assert_eq!(look(scene, front, "brute").lit, 1.0);
        // A lamp of short range before the left one.
        let mut scene = squares(Vec4::ONE);
        scene.lights.push(Punctual {
            kind: PunctualKind::Point,
            position: Vec3::new(-0.75, 0.0, 0.2),
            direction: Vec3::NEG_Z,
            intensity: Vec3::ONE,
            range: Some(0.6),
        });
        let half = look(scene, front, "brute");
        assert!((0.15..0.5).contains(&half.lit), "{half:?}");
    }

    #[test]
    fn what_is_black_under_any_light_has_no_say() {
        let mut scene = squares(Vec4::W);
        scene.environment = Some(Environment::constant(Vec3::ONE));
        let sight = look(scene, 2.0 * Vec3::Z, "brute");
        assert!((sight.black - 0.5).abs() < 0.02 && sight.lit == 1.0, "{sight:?}");
    }

    /// The right square is cut away: it is in view all the same.
    #[test]
    fn what_is_cut_away_is_in_view_and_not_seen() {
        let mut scene = squares(Vec4::ONE);
        scene.materials[1].base_color.w = 0.0;
        scene.materials[1].alpha_mode = AlphaMode::Mask(0.5);
        let sight = look(scene, 2.0 * Vec3::Z, "brute");
        assert!((sight.in_view - 0.5).abs() < 0.03, "{sight:?}");
        assert!((sight.seen - 0.25).abs() < 0.02, "{sight:?}");
    }

    #[test]
    fn backs_are_told_and_nothing_is_where_nothing_is() {
        assert_eq!(look(squares(Vec4::ONE), 2.0 * Vec3::NEG_Z, "brute").behind, 1.0);
        assert_eq!(look(Scene::default(), Vec3::Z, "brute"), Sight::default());
    }

    #[test]
    fn it_is_the_same_for_every_structure() {
        let of = |accel: &str| {
            let mut scene = squares(Vec4::new(0.3, 0.2, 0.7, 1.0));
            scene.environment = Some(Environment::constant(Vec3::splat(0.1)));
            look(scene, Vec3::new(0.5, 0.7, 1.5), accel)
        };
        let brute = of("brute");
        assert!(brute.seen > 0.0 && brute.lit > 0.0);
        for other in ["bvh2", "mbvh8", "kd-ropes"] {
            assert_eq!(of(other), brute, "{other}");
        }
    }
}
