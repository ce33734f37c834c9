//! Files placed many times, and scenes within scenes.

use std::fs;

use super::*;

const TRIANGLE: &str = "\
mtllib a.mtl
v 0 0 0
v 1 0 0
v 0 1 0
usemtl red
f 1 2 3
";

/// Loads `s.toml` of some files, beside `a.obj` of one triangle; an error is without the folder.
fn loaded(files: &[(&str, &str)]) -> Result<Scene, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        fs::write(path, text).expect("written");
    };
    write("a.obj", TRIANGLE);
    write("a.mtl", "newmtl red\nKd 1 0 0\n");
    for (name, text) in files {
        write(name, text);
    }
    let strict = LoadOptions { strict: true, ..LoadOptions::default() };
    let scene = crate::formats::load(folder.path().join("s.toml"), &strict);
    scene.map_err(|error| error.to_string().replace(&format!("{}/", folder.path().display()), ""))
}

/// Where the corner (1, 0, 0) of each placed mesh is.
fn corners(scene: &Scene) -> Vec<Vec3> {
    scene.instances.iter().map(|instance| instance.transform.point(Vec3::X)).collect()
}

const SKY: &str = "[environment]\ncolor = [1, 1, 1]\n";

#[test]
fn copies_stand_under_the_transform_of_their_place() {
    let text = "[[place]]\nfile = 'a.obj'\nscale = 2\ntranslate = [0, 0, 5]\n\
                copies = [[1, 0, 0], { translate = [0, 1, 0], scale = 3 }, \
                { rotate = [0, 0, 90] }]\n";
    let scene = loaded(&[("s.toml", &format!("{SKY}{text}"))]).expect("a good scene");
    assert_eq!((scene.meshes.len(), scene.materials.len()), (1, 1));
    let expected = [Vec3::new(4.0, 0.0, 5.0), Vec3::new(6.0, 2.0, 5.0), Vec3::new(0.0, 2.0, 5.0)];
    for (corner, expected) in corners(&scene).iter().zip(expected) {
        assert!(corner.distance(expected) < 1e-5, "{corner}");
    }
    let points = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
                  property float z\nend_header\n1 0 0\n0 9 0\n";
    let text = format!("{SKY}[[place]]\nfile = 'a.obj'\nscale = 2\ncopies = 'p/points.ply'\n");
    let scene = loaded(&[("s.toml", &text), ("p/points.ply", points)]).expect("a good scene");
    assert_eq!(corners(&scene), [Vec3::new(4.0, 0.0, 0.0), Vec3::new(2.0, 18.0, 0.0)]);
    let none = format!("{SKY}[[place]]\nfile = 'a.obj'\ncopies = []\n");
    assert_eq!(loaded(&[("s.toml", &none)]).expect("a good scene").instances.len(), 0);
}

#[test]
fn scenes_within_scenes_share_their_meshes() {
    let own = "[[place]]\nfile = 'a.obj'\n";
    let pair = "[render]\nspp = 3\n[sky]\n[[light]]\ntype = 'point'\nposition = [0, 1, 0]\n\
                intensity = 4\n[[camera]]\nlook-from = [0, 0, 4]\n\
                [[place]]\nfile = 'row.toml'\n\
                [[place]]\nfile = 'row.toml'\ntranslate = [0, 0, 7]\n";
    let row = "[[place]]\nfile = '../a.obj'\ncopies = [[0, 0, 0], [2, 0, 0]]\n";
    // Files stay within the folder of the scene that places them.
    let row = row.replace("../a.obj", "b.obj");
    let outer = format!(
        "{SKY}{own}[[place]]\nfile = 'in/pair.toml'\ncopies = [[0, 0, 0], [0, 100, 0]]\n\
         [[place]]\nfile = 'in/b.obj'\n"
    );
    let files = [
        ("s.toml", outer.as_str()),
        ("in/pair.toml", pair),
        ("in/row.toml", &row),
        ("in/b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
    ];
    let scene = loaded(&files).expect("a good scene");
    // The square of `a.obj` once, that of `b.obj` once though three scenes lead to it.
    assert_eq!((scene.meshes.len(), scene.instances.len()), (2, 1 + 2 * 4 + 1));
    let corners = corners(&scene);
    assert_eq!(corners[4], Vec3::new(3.0, 0.0, 7.0));
    assert_eq!(corners[8], Vec3::new(3.0, 100.0, 7.0));
    assert_eq!(scene.lights.len(), 2);
    assert_eq!(scene.lights[1].position, Vec3::new(0.0, 101.0, 0.0));
    assert!(scene.cameras.is_empty(), "copies have no cameras");
    assert!(scene.environment.expect("the outer one").is_constant());
}

#[test]
fn a_chain_of_scenes_multiplies_copies_of_one_mesh() {
    let level = |file: &str| {
        format!("[[place]]\nfile = '{file}'\ncopies = [[0,0,0], [1,0,0], [0,1,0], [0,0,1]]\n")
    };
    let files = [
        ("s.toml", format!("{SKY}{}", level("c.toml"))),
        ("c.toml", level("d.toml")),
        ("d.toml", level("e.toml")),
        ("e.toml", level("a.obj")),
    ];
    let files = files.each_ref().map(|(name, text)| (*name, text.as_str()));
    let scene = loaded(&files).expect("a good scene");
    assert_eq!((scene.meshes.len(), scene.instances.len()), (1, 256));
    assert_eq!(scene.materials.len(), 1);
}

#[test]
fn surroundings_of_a_placed_scene_are_left_out_and_told_where_there_are_no_others() {
    let inner = format!("{SKY}[[place]]\nfile = 'a.obj'\n");
    let outer = "[[place]]\nfile = 'in.toml'\n[[light]]\ntype = 'point'\nposition = [0, 0, 3]\n";
    let error = loaded(&[("s.toml", outer), ("in.toml", &inner)]).expect_err("strict");
    assert!(error.contains("s.toml: the surroundings of in.toml are left out"), "{error}");
}

#[test]
fn the_medium_of_a_placed_scene_is_left_out_and_told_where_there_is_no_other() {
    let mist = "[medium]\nscattering = 0.1\n";
    let inner = format!("{mist}[[place]]\nfile = 'a.obj'\n");
    let outer = "[[place]]\nfile = 'in.toml'\n";
    let error = loaded(&[("s.toml", outer), ("in.toml", &inner)]).expect_err("strict");
    assert!(error.contains("s.toml: the medium of in.toml is left out"), "{error}");
    let outer = format!("{mist}{outer}");
    let scene = loaded(&[("s.toml", &outer), ("in.toml", &inner)]).expect("has its own");
    assert!(scene.medium.is_some());
}

#[test]
fn point_lights_shine_whatever_the_scale_they_are_placed_with() {
    let lamp = |kind: &str| {
        format!("[[light]]\ntype = '{kind}'\nposition = [1, 2, 3]\ndirection = [0, 0, 1]\n")
    };
    let outer = "[[place]]\nfile = 'in.toml'\nscale = 0\ntranslate = [0, 0, 5]\n";
    let scene = loaded(&[("s.toml", outer), ("in.toml", &lamp("point"))]).expect("it shines");
    assert_eq!(scene.lights[0].position, Vec3::new(0.0, 0.0, 5.0));
    let error = loaded(&[("s.toml", outer), ("in.toml", &lamp("spot"))]).expect_err("nowhere");
    assert!(error.contains("leaves no directions to its lights"), "{error}");
}

#[test]
fn circles_depth_and_hostile_numbers_are_errors() {
    let place = |file: &str| format!("\n[[place]]\nfile = '{file}'\n");
    let error = |files: &[(&str, String)]| {
        let files: Vec<(&str, &str)> = files.iter().map(|(n, text)| (*n, text.as_str())).collect();
        loaded(&files).expect_err("refused")
    };
    assert_eq!(
        error(&[("s.toml", place("b.toml")), ("b.toml", place("s.toml"))]),
        "b.toml:3: file: a scene places itself: s.toml > b.toml > s.toml"
    );
    let names: Vec<String> = (0..20).map(|i| format!("{i}.toml")).collect();
    let mut chain: Vec<(&str, String)> = vec![("s.toml", place("0.toml"))];
    chain.extend((0..19).map(|i| (names[i].as_str(), place(&names[i + 1]))));
    chain.push(("19.toml", String::new()));
    assert_eq!(error(&chain), "14.toml:3: file: more than 16 scenes are placed within one another");
    let listed = |copies: &str| error(&[("s.toml", place("a.obj") + "copies = " + copies)]);
    assert_eq!(
        listed("[[0, 0, 0],\n[0, 0]]"),
        "s.toml:5: copies 1: must be […] of 3 finite numbers, or a table"
    );
    assert_eq!(listed("3"), "s.toml:4: copies: must be a file's name, or […]");
    assert!(listed("[{ at = [0, 0, 0] }]").starts_with("s.toml:4: copies 0: unknown key \"at\""));
    assert_eq!(
        listed("[[0, 0, 0], { scale = 3e38 }]"),
        "s.toml:2: [[place]]: copy 1 places its meshes beyond the range of 32-bit floats"
    );
    assert_eq!(listed("'no.ply'"), "s.toml:2: \"no.ply\": no such file");
    // Levels multiply: 300 times 300 are fine, 50,000 times as many are beyond all ids.
    let times = |file: &str, count: usize| {
        format!("[[place]]\nfile = '{file}'\ncopies = [{}]\n", "[0,0,0],".repeat(count))
    };
    let crowd = [
        ("s.toml", times("b.toml", 50_000)),
        ("b.toml", times("c.toml", 300)),
        ("c.toml", times("a.obj", 300)),
    ];
    assert_eq!(
        error(&crowd),
        "s.toml:1: [[place]]: 4500000000 placed meshes are too many; 4294967294 at most"
    );
}

#[test]
fn missing_files_of_scenes_within_are_all_told() {
    let files = [
        ("s.toml", "[[place]]\nfile = 'in/b.toml'\n[[place]]\nfile = 'x.obj'\n"),
        ("in/b.toml", "[[place]]\nfile = 'y.obj'\n[[place]]\nfile = 'z.obj'\ncopies = 'p.ply'\n"),
    ];
    let error = loaded(&files).expect_err("missing");
    for name in ["x.obj", "y.obj", "z.obj", "p.ply"] {
        assert_eq!(error.matches(name).count(), 1, "{error}");
    }
    assert!(error.contains("in/b.toml: in/b.toml:3"), "{error}");
}
