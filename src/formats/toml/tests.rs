use std::fs;

use super::*;
use crate::math::Vec4;

const TRIANGLE: &str = "\
mtllib a.mtl
v 0 0 0
v 1 0 0
v 0 1 0
usemtl red
f 1 2 3
";

/// A folder with `a.obj`, whose material is called `red`, and the scene.
fn loaded(text: &str) -> Result<Scene, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).expect("written");
    };
    write("a.obj", TRIANGLE);
    write("a.mtl", "newmtl red\nKd 1 0 0\nPr 0.5\n");
    write("s.toml", text);
    let scene = load(&folder.path().join("s.toml"), &LoadOptions::default());
    scene.map_err(|error| error.to_string().replace(&format!("{}/", folder.path().display()), ""))
}

fn error(text: &str) -> String {
    loaded(text).expect_err(text)
}

#[test]
fn a_file_is_placed_as_often_as_one_likes_and_kept_once() {
    let scene = loaded(
        "[[place]]\nfile = 'a.obj'\n\
         [[place]]\nfile = 'a.obj'\ntranslate = [0, 0, 5]\nrotate = [0, 90, 0]\nscale = 2\n\
         [[place]]\nfile = 'a.obj'\nmatrix = [1,0,0,0, 0,1,0,0, 0,0,-1,0, 7,8,9,1]\n\
         [place.material.red]\nroughness = 0.25\nbase-color = [0, 1, 0]\nalpha = 0.5\n",
    )
    .expect("a good scene");
    assert_eq!((scene.meshes.len(), scene.instances.len(), scene.materials.len()), (1, 3, 2));
    let points: Vec<Vec3> =
        scene.instances.iter().map(|it| it.transform.point(Vec3::new(1.0, 0.0, 0.0))).collect();
    // A quarter turn about Y takes +X to -Z.
    assert!(points[1].distance(Vec3::new(0.0, 0.0, 3.0)) < 1e-6, "{points:?}");
    assert_eq!(points[2], Vec3::new(8.0, 8.0, 9.0));
    assert!(scene.instances[2].transform.mirrored() && !scene.instances[1].transform.mirrored());
    let (plain, changed) = (&scene.materials[0], &scene.materials[1]);
    assert_eq!((plain.roughness, plain.base_color), (0.5, Vec4::new(1.0, 0.0, 0.0, 1.0)));
    assert_eq!((changed.roughness, changed.base_color), (0.25, Vec4::new(0.0, 1.0, 0.0, 0.5)));
    assert_eq!(changed.alpha_mode, crate::scene::AlphaMode::Blend);
}

#[test]
fn what_is_said_of_all_gives_way_to_what_is_said_of_one() {
    let scene = loaded(
        "[material.'*']\nroughness = 0.1\nclearcoat = 1\n[material.red]\nroughness = 0.3\n\
         [[place]]\nfile = 'a.obj'\n[[place]]\nfile = 'a.obj'\n\
         material.'*' = { roughness = 0.7, transmission = 1, solid = true, ior = 1.33 }\n",
    )
    .expect("a good scene");
    let [first, second] = &scene.materials[..] else { panic!("two materials") };
    assert_eq!((first.roughness, second.roughness), (0.3, 0.7));
    assert_eq!(first.layers.as_ref().expect("a coat").clearcoat, 1.0);
    assert!(second.volume.is_some() && second.ior == 1.33);
}

#[test]
fn lumens_are_spread_over_the_light() {
    let light = |keys: &str| format!("[[light]]\nposition = [0, 0, 0]\n{keys}\n");
    let intensity = |keys: &str| loaded(&light(keys)).expect(keys).lights[0].intensity.x;
    let tau = std::f32::consts::TAU;
    assert!((intensity("type = 'point'\nlumen = 800") - 800.0 / (2.0 * tau)).abs() < 1e-3);
    let spot = "type = 'spot'\ndirection = [0, -1, 0]\nouter = 60";
    assert!((intensity(&format!("{spot}\nlumen = 800")) - 800.0 / (0.5 * tau)).abs() < 1e-3);
    assert!(
        error(&light("type = 'point'\nlumen = 1\nintensity = 1")).contains("without intensity")
    );
    let sun = "type = 'directional'\ndirection = [0, -1, 0]\nlumen = 1";
    assert!(error(&light(sun)).contains("point and spot lights"));
    let narrow = "type = 'spot'\ndirection = [0, -1, 0]\nouter = 1e-30\nlumen = 1";
    assert!(error(&light(narrow)).contains("so narrow a cone"));
}

#[test]
fn overrides_reach_alpha_priority_and_light() {
    use crate::scene::AlphaMode;
    let changed = |keys: &str| {
        let text = format!("[[place]]\nfile = 'a.obj'\n[material.red]\n{keys}\n");
        loaded(&text).map(|mut scene| scene.materials.swap_remove(0))
    };
    assert_eq!(changed("alpha-mode = 'mask'").unwrap().alpha_mode, AlphaMode::Mask(0.5));
    let mask = changed("alpha-mode = 'mask'\nalpha-cutoff = 0.25").unwrap();
    assert_eq!(mask.alpha_mode, AlphaMode::Mask(0.25));
    let opaque = changed("alpha-mode = 'opaque'\nalpha = 0.5\npriority = -3").unwrap();
    assert_eq!((opaque.alpha_mode, opaque.priority), (AlphaMode::Opaque, -3));
    let film = "iridescence = 1\niridescence-thickness = 500\niridescence-thickness-minimum = 200";
    let film = changed(&format!("{film}\nclearcoat-normal-scale = 2")).unwrap().layers.unwrap();
    assert_eq!((film.iridescence_thickness, film.clearcoat_normal_scale), ([200.0, 500.0], 2.0));
    let unlit = changed("unlit = true\nclearcoat = 1\nemissive = [1, 1, 1]").unwrap();
    assert!(unlit.unlit && unlit.layers.is_none() && !unlit.is_emissive());
    assert_eq!(unlit.base_color, Vec4::new(1.0, 0.0, 0.0, 1.0));
    for (keys, message) in [
        ("alpha-mode = 'cut'", "none of opaque, mask and blend"),
        ("alpha-mode = 'blend'\nalpha-cutoff = 0.5", "needs alpha-mode"),
        ("priority = 0.5", "must be a whole number"),
        ("ior = 0.5", "must be at least 1, or 0"),
    ] {
        let error = changed(keys).expect_err(keys);
        assert!(error.contains(message), "{error}");
    }
}

#[test]
fn cameras_lights_and_surroundings_are_those_of_the_file() {
    let scene = loaded(
        "[camera]\nlook-from = [0, 0, 4]\nfov = 30\naperture = 0.1\n\
         [environment]\ncolor = [1, 2, 3]\nscale = 2\n\
         [sun]\nsun-elevation = 90\nirradiance = 5\n\
         [[light]]\ntype = 'spot'\nposition = [1, 2, 3]\ndirection = [0, -2, 0]\nintensity = 7\n\
         outer = 60\n[[place]]\nfile = 'a.obj'\n[render]\nspp = 4\n",
    )
    .expect("a good scene");
    let camera = scene.cameras[0].camera;
    // Looks at the middle of what is placed, which is in focus.
    let ahead = camera.to_world.transform_vector3(Vec3::NEG_Z);
    let middle = Vec3::new(0.5, 0.5, 0.0) - Vec3::new(0.0, 0.0, 4.0);
    assert!(ahead.distance(middle.normalize()) < 1e-6);
    assert!((camera.lens.expect("a lens").focus_distance - middle.length()).abs() < 1e-5);
    assert_eq!(scene.lights[0].intensity, Vec3::splat(7.0));
    assert_eq!(scene.lights[0].direction, Vec3::NEG_Y);
    let environment = scene.environment.expect("surroundings");
    assert_eq!(environment.radiance(Vec3::X), Vec3::new(2.0, 4.0, 6.0));
    assert!(environment.sun().expect("a sun").direction().distance(Vec3::Y) < 1e-6);
    let sky = loaded("[sky]\nturbidity = 2.5\n").expect("a good scene").environment;
    assert!(sky.expect("a sky").sun().is_some());
}

#[test]
fn unknown_keys_are_errors_with_their_line_and_the_near_ones() {
    for (text, message) in [
        (
            "[[place]]\nfile = 'a.obj'\ntransalte = [0, 0, 0]",
            "s.toml:3: [[place]]: unknown key \"transalte\"; did you mean translate",
        ),
        ("\n[camra]\n", "s.toml:2: unknown key \"camra\"; did you mean camera"),
        ("[sky]\n\nturbid = 3", "s.toml:3: [sky]: unknown key \"turbid\"; did you mean turbidity"),
        (
            "[material.red]\nrufness = 1",
            "s.toml:2: [material.\"red\"]: unknown key \"rufness\"; did you mean roughness",
        ),
        ("zzz = 1", "s.toml:1: unknown key \"zzz\"; it may have camera, environment, light,"),
    ] {
        let found = error(text);
        assert!(found.starts_with(message), "{found}\n{message}");
    }
}

fn assert_told(faults: &[(&str, &str)]) {
    for (text, message) in faults {
        let found = error(text);
        assert!(found.starts_with(message), "{text}\n{found}\n{message}");
    }
}

#[test]
fn what_is_wrong_with_media_is_told_with_its_line() {
    assert_told(&[
        ("[medium]\nscattering = -1", "s.toml:2: scattering: must be from 0 to 5e11 per metre"),
        (
            "[medium]\nabsorption = [1, 2, nan]",
            "s.toml:2: absorption: must be a finite number, or […] of 3",
        ),
        ("[medium]\nscattering = 1\nanisotropy = 2", "s.toml:3: anisotropy: must be from -1 to 1"),
        ("\n[medium]\nanisotropy = 0", "s.toml:2: [medium]: neither absorbs nor scatters"),
        ("[medium]\nscater = 1", "s.toml:2: [medium]: unknown key \"scater\"; did you mean"),
        (
            "[material.red]\nmultiscatter-color = [1, 1, 1]\nscatter-albedo = [1, 1, 1]",
            "s.toml:3: scatter-albedo: goes without multiscatter-color",
        ),
        ("[material.red]\nscatter-anisotropy = 2", "s.toml:2: scatter-anisotropy: must be from -1"),
    ]);
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    assert_told(&[
        ("[[place]]\n", "s.toml:1: [[place]]: has no file"),
        ("[[place]]\nfile = 3", "s.toml:2: file: must be text in quotes"),
        (
            "[[place]]\nfile = 'a.obj'\nscale = nan",
            "s.toml:3: scale: must be a finite number, or […] of 3",
        ),
        (
            "[[place]]\nfile = 'a.obj'\nscale = 1e39",
            "s.toml:3: scale: must be a finite number, or […] of 3",
        ),
        (
            "[[place]]\nfile = 'a.obj'\ntranslate = [0, inf, 0]",
            "s.toml:3: translate: must be […] of 3 finite numbers",
        ),
        (
            "[[place]]\nfile = 'a.obj'\ntranslate = [3e38, 0, 0]",
            "s.toml:1: [[place]]: places its meshes beyond the range of 32-bit floats",
        ),
        (
            "[[place]]\nfile = 'a.obj'\nscale = 2\nmatrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]",
            "s.toml:1: [[place]]: has both a matrix and translate, rotate or scale",
        ),
        ("[[place]]\nfile = 's.toml'", "s.toml:2: file: a scene places itself: s.toml > s.toml"),
        (
            "[[place]]\nfile = 'a.obj'\n[place.material.rad]\nroughness = 1",
            "s.toml:3: no material \"rad\"; did you mean 0 (\"red\")? (a.obj)",
        ),
        (
            "[material.rad]\nroughness = 1\n[[place]]\nfile = 'a.obj'",
            "s.toml:1: no material \"rad\"; did you mean 0 (\"red\")?",
        ),
        ("[material.red]\nroughness = 1.5", "s.toml:2: roughness: must be from 0 to 1"),
        (
            "[camera]\nlook-from = [0, 0, 0]\nlook-at = [0, 0, 0]",
            "s.toml:3: look-at: is where the camera stands: there is no direction to look in",
        ),
        ("[camera]\nfov = 3", "s.toml:1: [camera]: has no look-from"),
        (
            "[[light]]\ntype = 'lamp'",
            "s.toml:2: type: \"lamp\" is none of point, spot and directional",
        ),
        ("[sky]\nturbidity = 1", "s.toml:2: turbidity: must be from 2 to 10"),
        (
            "[sky]\n[environment]\ncolor = [1, 1, 1]",
            "s.toml:1: [sky]: there is an [environment] already",
        ),
        ("[sky]\n[sun]", "s.toml:2: [sun]: the [sky] has a sun: give it sun-diameter = 0"),
        ("render = 3", "s.toml:1: render: must be a table"),
        ("[camera\n", "s.toml:1: "),
        ("a = 1\na = 2", "s.toml:2: duplicate key"),
    ]);
}

#[test]
fn all_that_is_missing_is_told_at_once_and_paths_stay_in_the_folder() {
    let found = error(
        "[[place]]\nfile = 'b.obj'\n[[place]]\nfile = '../a.obj'\n[[place]]\nfile = '/etc/passwd'\n\
         [environment]\nfile = 'e.hdr'\n",
    );
    let expected = "s.toml: 4 references cannot be used:\n  s.toml:7: \"e.hdr\": no such file\n  \
                    s.toml:1: \"b.obj\": no such file\n  s.toml:3: \"../a.obj\": leads out of the \
                    scene's folder, which is not followed\n  s.toml:5: \"/etc/passwd\": is an \
                    absolute path, which is not followed";
    assert_eq!(found, expected);
}

#[test]
fn settings_become_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.toml");
    fs::write(folder.path().join("e.hdr"), "").expect("written");
    fs::write(
        &path,
        "[render]\nresolution = [64, 48]\nlook-from = [0.1, -2, 3e-3]\ntransparent = true\n\
         strict = false\nseed = 18446744073709551615\nspp = '9'\nenv = 'e.hdr'\n",
    )
    .expect("written");
    let env = |key: &str, _: &str| key == "env";
    let all = settings(&path, &env).expect("good");
    let word = |key: &str| match &all.iter().find(|it| it.key == key).expect(key).value {
        SettingValue::Word(word) => word.clone(),
        SettingValue::Switch(on) => on.to_string(),
    };
    assert_eq!((all[0].key.as_str(), all[0].line), ("resolution", 2));
    assert_eq!(word("resolution"), "64,48");
    assert_eq!(word("look-from"), "0.1,-2,3e-3");
    assert_eq!((word("transparent"), word("strict")), ("true".into(), "false".into()));
    assert_eq!(word("seed"), u64::MAX.to_string());
    assert_eq!(word("env"), folder.path().join("e.hdr").to_string_lossy());
    fs::write(&path, "[render]\nenv = '../e.hdr'\n").expect("written");
    let message = settings(&path, &env).expect_err("outside").to_string();
    assert!(message.contains("s.toml:2: env: \"../e.hdr\": leads out"), "{message}");
}

#[test]
fn media_are_told_by_the_metre() {
    let scene = loaded("[medium]\nabsorption = 1\nscattering = [3, 1, 0]\nanisotropy = 0.5\n");
    let medium = scene.expect("a good scene").medium.expect("a medium");
    assert_eq!(medium.extinction(), Vec3::new(4.0, 2.0, 1.0));
    assert_eq!(medium.albedo(), Vec3::new(0.75, 0.5, 0.0));
    assert_eq!(medium.phase(), crate::medium::HenyeyGreenstein::new(0.5));
}

#[test]
fn overrides_make_wax() {
    use crate::scene::ScatterColor;
    let scene = loaded(
        "[[place]]\nfile = 'a.obj'\n[material.red]\nsolid = true\nattenuation-distance = 0.01\n\
         attenuation-color = [0.5, 0.5, 0.5]\ndiffuse-transmission = 1\n\
         diffuse-transmission-color = [1, 0.9, 0.8]\nmultiscatter-color = [0.9, 0.5, 0.2]\n\
         scatter-anisotropy = 0.25\n",
    );
    let wax = &scene.expect("a good scene").materials[0];
    assert!(wax.is_solid() && wax.diffuse_transmission == 1.0);
    assert_eq!(wax.diffuse_transmission_color, Vec3::new(1.0, 0.9, 0.8));
    let scattering = wax.scattering.expect("it scatters");
    assert_eq!(scattering.color, ScatterColor::All(Vec3::new(0.9, 0.5, 0.2)));
    assert_eq!(scattering.anisotropy, 0.25);
}
