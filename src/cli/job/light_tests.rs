//! What lights scenes that are hard to see.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use super::Job;
use crate::cli::error::CliError;
use crate::cli::settings::parse::LightArg;
use crate::cli::settings::resolve_words;
use crate::cli::watch::Watch;
use crate::math::Vec3;

/// A file of that text, in a folder that ends with it.
fn write_scene(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let materials = "newmtl white\nKd 0.8 0.8 0.8\nnewmtl lamp\nKd 0 0 0\nKe 9 9 9\n\
                     newmtl black\nKd 0 0 0\nnewmtl old\nKd 0.8 0.8 0.8\nTr 1.0\n\
                     newmtl glass\nKd 1 1 1\nKs 1 1 1\nillum 7\nNi 1.5\nTf 1 1 1\n\
                     newmtl drone\nKd 0.8 0.8 0.8\nmap_Ke dark.png\n";
    let dark = image::RgbImage::from_pixel(4, 4, image::Rgb([1; 3]));
    dark.save(folder.path().join("dark.png")).expect("written");
    fs::write(folder.path().join("a.mtl"), materials).expect("written");
    let path = folder.path().join(name);
    fs::write(&path, text).expect("written");
    (folder, path)
}

/// The faces of a closed box from `-size` to `size`, of a material.
fn closed_box(size: f32, material: &str) -> String {
    let mut text = format!("mtllib a.mtl\nusemtl {material}\n");
    for corner in 0..8 {
        let at = |axis: u32| if corner >> axis & 1 == 0 { -size } else { size };
        writeln!(text, "v {} {} {}", at(0), at(1), at(2)).expect("a string takes all");
    }
    text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

/// A floor of 20 by 20 metres, and above it a lamp that is `size` metres wide and looks down.
fn floor_with_lamp(size: f32) -> String {
    format!(
        "mtllib a.mtl\nusemtl white\nv -10 0 -10\nv 10 0 -10\nv 10 0 10\nv -10 0 10\nf 4 3 2 1\n\
         usemtl lamp\nv 0 3 0\nv {size} 3 0\nv 0 3 {size}\nf 5 6 7\n"
    )
}

fn try_look(path: &Path, words: &str) -> Result<Job, CliError> {
    let words: Vec<String> =
        format!("--resolution 64x48 {words}").split_whitespace().map(str::to_owned).collect();
    Job::prepare_looking(resolve_words(path, &words)?.args, &Watch::silent())
}

/// Looks ahead; returns the job, what lights the scene, and all that is said.
fn look(path: &Path, words: &str) -> (Job, LightArg, String) {
    let job = try_look(path, words).expect("a good scene");
    let said: Vec<&str> = job.staged.notices.iter().map(|notice| &*notice.message).collect();
    let (light, said) = (job.args.light, said.join("\n"));
    (job, light, said)
}

#[test]
fn a_lamp_that_lights_what_is_seen_is_enough_and_a_button_that_glows_is_not() {
    let (_folder, path) = write_scene("a.obj", &floor_with_lamp(4.0));
    let (job, light, said) = look(&path, "");
    assert!(light == LightArg::File && !said.contains("light"), "{light:?} {said}");
    assert!(job.staged.world.scene.environment.is_none());

    let (_folder, path) = write_scene("b.obj", &floor_with_lamp(0.02));
    let (job, light, said) = look(&path, "");
    assert_eq!(light, LightArg::Sky, "{said}");
    assert!(said.contains("--light sky") && said.contains("--light file"), "{said}");
    assert!(job.sight.expect("it was looked at").lit > 0.9);
    let without = look(&path, "--light file");
    assert!(without.1 == LightArg::File && without.2.contains("black, or nearly so"));
    // Who asks gets what they ask for.
    assert_eq!(look(&path, "--env 0,0,0").1, LightArg::File);
    assert_eq!(look(&path, "--strict").1, LightArg::File);
}

#[test]
fn small_lamps_of_large_things_leave_them_under_the_sky() {
    let at = |z: f32| format!("v -0.1 0 {z}\nv 0.1 0 {z}\nv 0 0.1 {z}\nf -3 -2 -1\n");
    // Head lights, which shine away from the car.
    let car = closed_box(1.0, "white") + "usemtl lamp\n" + &at(1.01);
    // The box is first: its faces count from there.
    let greenhouse = closed_box(3.0, "glass")
        + "usemtl white\nv -9 -3.1 -9\nv 9 -3.1 -9\nv 9 -3.1 9\nv -9 -3.1 9\nf -1 -2 -3 -4\n"
        + "usemtl lamp\n"
        + &at(0.0);
    for text in [car, greenhouse, closed_box(1.0, "drone")] {
        let (_folder, path) = write_scene("a.obj", &text);
        let (job, light, said) = look(&path, "");
        assert_eq!(light, LightArg::Sky, "{said}\n{text}");
        assert!(said.contains("its light reaches"), "{said}\n{text}");
        assert!(job.sight.expect("it was looked at").lit > 0.5, "{:?}\n{text}", job.sight);
        assert!(job.staged.world.scene.environment.is_some());
    }
}

#[test]
fn under_a_closed_dome_there_is_a_lamp_at_the_camera() {
    let city = "usemtl white\nv -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nf -1 -2 -3 -4\n";
    let (_folder, path) = write_scene("a.obj", &(closed_box(50.0, "white") + city));
    let (job, light, said) = look(&path, "--look-from 0,4,8 --look-at 0,0,0");
    assert_eq!(light, LightArg::Camera, "{said}");
    assert!(job.staged.world.scene.environment.is_none() && !job.staged.world.lights.is_empty());
    assert!(job.sight.expect("it was looked at").lit > 0.5, "{:?}", job.sight);
}

#[test]
fn what_is_decided_is_the_same_for_all_parts_and_machines() {
    for text in [floor_with_lamp(0.02), closed_box(1.0, "white")] {
        let (_folder, path) = write_scene("a.obj", &text);
        let view = "--look-from 0,0.5,0 --look-at 0,0,-1";
        let all = look(&path, view);
        let digest = all.0.staged.world.scene.digest();
        for other in
            ["--accel kd-ropes", "--threads 1", "--isa portable", "--crop 0,0,5,7", "--seed 9"]
        {
            let (job, light, said) = look(&path, &format!("{view} {other}"));
            assert_eq!((light, said, job.sight), (all.1, all.2.clone(), all.0.sight), "{other}");
            assert_eq!(job.staged.world.scene.digest(), digest, "{other}");
        }
        // The light that was decided, asked for.
        let asked = look(&path, &format!("{view} --light {}", all.1.name()));
        assert_eq!((asked.0.staged.world.scene.digest(), asked.0.sight), (digest, all.0.sight));
    }
}

#[test]
fn in_closed_rooms_there_is_a_lamp_at_the_camera_at_any_scale() {
    for scale in [1e-6, 1.0, 1e6] {
        let (_folder, path) = write_scene("a.obj", &closed_box(scale, "white"));
        let view = format!("--look-from 0,0,{} --look-at 0,0,0", 0.5 * scale);
        let (job, light, said) = look(&path, &view);
        assert_eq!(light, LightArg::Camera, "{scale} {said}");
        assert!(said.contains("--light camera"), "{said}");
        let sight = job.sight.expect("it was looked at");
        assert!(sight.seen == 1.0 && sight.lit > 0.9, "{scale} {sight:?}");
        let (_, _, said) = look(&path, &format!("{view} --light sky"));
        assert!(said.contains("inside of something closed") && said.contains("--light camera"));
        // From outside it is a box under the sky.
        let (job, light, _) = look(&path, "");
        assert!(light == LightArg::Sky && job.sight.expect("looked at").lit > 0.9, "{scale}");
    }
}

#[test]
fn a_picture_that_will_be_black_or_empty_has_its_reason_in_words() {
    let (_folder, path) = write_scene("a.obj", &closed_box(1.0, "white"));
    let (job, _, said) = look(&path, "--look-from 0,0,5 --look-at 0,0,9");
    assert!(said.contains("no surface is in sight: the camera looks past"), "{said}");
    assert_eq!(job.sight.expect("it was looked at").seen, 0.0);
    // The place that is advised is that of the automatic camera of the same upright.
    let away = "--look-from 0,0,5 --look-at 0,0,9.5";
    let (_, _, advice) = look(&path, &format!("{away} --up 0,1,0.5"));
    let (_, _, automatic) = look(&path, "--up 0,1,0.5");
    let eye = |said: &str| -> Option<String> {
        let (_, after) = said.split_once("--look-from ")?;
        Some(after.split([' ', ')', '\n', ';']).next()?.to_owned())
    };
    assert!(advice.contains(" --up 0,0.8944272,0.4472136"), "{advice}");
    assert!(eye(&advice).is_some() && eye(&advice) == eye(&automatic), "{advice} {automatic}");
    let (_, _, said) = look(&path, "--look-from 0,0,100 --look-at 0,0,0");
    assert!(said.contains("of the frame shows a surface"), "{said}");
    // Shadows of an absorber.
    let (_folder, path) = write_scene("b.obj", &closed_box(1.0, "black"));
    let (_, _, said) = look(&path, "");
    assert!(said.contains("reflects no light at all"), "{said}");
    // Points and lines alone.
    let (_folder, path) = write_scene("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1\nl 1 2 3\n");
    let (_, _, said) = look(&path, "");
    assert!(said.contains("no triangles"), "{said}");
    // All of it see-through by an old exporter's Tr.
    let (_folder, path) = write_scene("d.obj", &closed_box(1.0, "old"));
    let (job, _, said) = look(&path, "");
    assert!(said.contains("taken as opaque") && job.sight.expect("looked at").lit > 0.9);
    let (_, _, said) = look(&path, "--mtl-transparency file");
    assert!(said.contains("no surface is in sight: what lies in view is invisible"), "{said}");
    // So it is before a camera of one's own, which looks at it.
    let view = "--look-from 0,0,5 --look-at 0,0,0 --mtl-transparency file";
    let (job, _, said) = look(&path, view);
    assert!(said.contains("invisible, as its alpha cuts it away"), "{said}");
    assert!(!said.contains("looks past") && job.sight.expect("looked at").in_view > 0.01);
}

#[test]
fn two_skies_are_one_and_no_direction_is_up() {
    let (_folder, path) = write_scene("a.obj", &closed_box(1.0, "white"));
    let Err(error) = try_look(&path, "--up 0,0,0") else { panic!("it has no direction") };
    assert!(error.exit_code() == 2 && error.to_string().starts_with("--up is zero"), "{error}");
    // A picture's header may say the one, and who repeats the run the other.
    for flag in ["--env 1,1,1", "--sky 3"] {
        let (_, light, said) = look(&path, &format!("--light sky {flag}"));
        assert!(light == LightArg::File && said.contains("has no effect beside"), "{said}");
    }
}

#[test]
fn with_z_up_the_automatic_camera_and_the_sky_turn() {
    let (_folder, path) = write_scene("a.obj", &closed_box(1.0, "white"));
    let (job, light, _) = look(&path, "--up z");
    let camera = job.staged.camera.camera.to_world;
    assert!(light == LightArg::Sky && camera.translation.y < -1.0 && camera.translation.z > 0.5);
    assert!(camera.matrix3.x_axis.z.abs() < 1e-6, "{camera:?}");
    let sky = job.staged.world.scene.environment.as_ref().expect("a sky");
    let radiance = |up| sky.radiance(up).x;
    assert!(radiance(Vec3::Z) > radiance(Vec3::Y) && radiance(Vec3::Y) > radiance(Vec3::NEG_Z));
}

#[test]
fn in_motion_the_scene_at_zero_decides_for_all_frames() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let path = scenes.join("motion.gltf");
    let of = |words: &str| look(&path, words);
    let (first, later) = (of("--time 0 --light camera"), of("--time 0.55 --light camera"));
    let lamp = |job: &Job| job.staged.world.scene.lights.last().copied();
    assert!(lamp(&first.0).is_some());
    assert_eq!(lamp(&first.0).map(|it| it.intensity), lamp(&later.0).map(|it| it.intensity));
    assert_eq!(of("--time 0.55").1, of("--time 0").1);
}
