//! Small scenes made in code, and their renders.

// Each test file uses a part of it.
#![allow(dead_code)]

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use dapple::Isa;
use dapple::SamplePattern;
use dapple::Transport;
use dapple::accel::{self, AccelSpec};
use dapple::camera::{Camera, Projection};
use dapple::film::{Picture, PixelFilter, Window};
use dapple::geom::Mesh;
use dapple::material::BsdfForm;
use dapple::math::{Affine3A, MaterialId, MeshId, Vec3, Vec4};
use dapple::render::{Aov, Control, Rendered, Settings, render};
use dapple::scene::{Instance, Material, Scene, Transform};
use dapple::world::{ShadingNormals, World};

/// A diffuse material.
pub fn lambert(reflectance: f32) -> Material {
    Material {
        base_color: Vec4::new(reflectance, reflectance, reflectance, 1.0),
        metallic: 0.0,
        specular: 0.0,
        ..Material::default()
    }
}

/// A scene of meshes, each with its material.
pub fn scene(parts: impl IntoIterator<Item = (Mesh, Material)>) -> Scene {
    let mut scene = Scene::default();
    for (i, (mesh, material)) in parts.into_iter().enumerate() {
        scene.meshes.push(Arc::new(mesh));
        scene.materials.push(material);
        scene.instances.push(Instance {
            mesh: MeshId::from_index(i),
            material: MaterialId::from_index(i),
            transform: Transform::new(Affine3A::IDENTITY),
        });
    }
    scene
}

/// A rectangle about `centre`, spanned by two half edges; its front is along their cross product.
pub fn rectangle(centre: Vec3, right: Vec3, up: Vec3) -> Mesh {
    let positions =
        vec![centre - right - up, centre + right - up, centre + right + up, centre - right + up];
    Mesh { positions, indices: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() }
}

/// An octahedron, its faces split in four `levels` times, vertices moved to the unit sphere.
pub fn sphere(levels: u32) -> Mesh {
    let mut faces: Vec<[Vec3; 3]> = Vec::new();
    for x in [Vec3::X, Vec3::NEG_X] {
        for y in [Vec3::Y, Vec3::NEG_Y] {
            for z in [Vec3::Z, Vec3::NEG_Z] {
                let outwards = x.x * y.y * z.z > 0.0;
                faces.push(if outwards { [x, y, z] } else { [x, z, y] });
            }
        }
    }
    for _ in 0..levels {
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [(a + b), (b + c), (c + a)].map(Vec3::normalize);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions: Vec<Vec3> = faces.iter().flatten().copied().collect();
    let indices = (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { positions, indices, ..Mesh::default() }
}

/// A camera that sees a square of side `2 * half` about `target`, flat, from `eye`.
pub fn flat_camera(eye: Vec3, target: Vec3, half: f32) -> Camera {
    let projection = Projection::Orthographic { xmag: half, ymag: half };
    Camera { projection, ..Camera::look_at(eye, target, Vec3::Z, 1.0) }
}

/// A square picture; no roulette.
pub fn settings(side: u32, spp: u64, max_depth: u32) -> Settings {
    Settings {
        noise: None,
        resolution: (side, side),
        crop: Window::of_size(side as usize, side as usize),
        spp,
        seed: 0,
        pattern: SamplePattern::default(),
        filter: PixelFilter::Box,
        transport: Transport { max_depth, roulette_depth: None, transparent: false },
        aovs: vec![Aov::Variance, Aov::Albedo, Aov::Depth, Aov::Normal, Aov::Position],
    }
}

/// Renders; a sample that is not finite fails the test.
pub fn run(scene: Scene, camera: &Camera, settings: &Settings) -> Rendered {
    run_with(scene, camera, settings, ShadingNormals::default())
}

/// The same with shading normals of a kind.
pub fn run_with(
    scene: Scene,
    camera: &Camera,
    settings: &Settings,
    kind: ShadingNormals,
) -> Rendered {
    let world = World::new(Arc::new(scene), BsdfForm::Conserving).expect("few triangles");
    let world = world.with_shading_normals(kind);
    let spec: AccelSpec = "bvh2".parse().expect("a row of the table");
    let accel = accel::build(&spec, world.triangles.clone(), Isa::Auto).expect("within limits");
    let cancel = AtomicBool::new(false);
    let control = Control { cancel: &cancel, progress: &|_| {} };
    let rendered = render(&world, camera, &*accel, settings, &control);
    assert_eq!(rendered.lost_count, 0, "{:?}", rendered.lost);
    rendered
}

/// Mean of a channel, and its standard error by the picture's own estimate.
pub fn mean(picture: &Picture) -> (f32, f32) {
    let green = picture.channel("G").expect("a colour");
    let variance = picture.channel("variance.G").expect("asked for");
    let count = green.len() as f64;
    let mean = green.iter().map(|&v| f64::from(v)).sum::<f64>() / count;
    let error = variance.iter().map(|&v| f64::from(v)).sum::<f64>().sqrt() / count;
    (mean as f32, error as f32)
}

/// The mean is `expected`, within three standard errors and 0.2%.
pub fn assert_mean(rendered: &Rendered, expected: f32) {
    let (mean, error) = mean(&rendered.picture);
    let off = (mean - expected).abs();
    // What is known without noise is only rounded.
    assert!(off <= 3.0 * error + 1e-5 * expected, "{mean} +- {error}, not {expected}");
    assert!(off <= 0.002 * expected, "{mean}, not {expected}");
}
