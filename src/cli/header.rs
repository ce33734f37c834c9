//! What a picture's header tells of how it was made.

use toml::{Table, Value};

use super::args::RenderArgs;
use super::prepare::Job;
use super::shell;
use crate::formats::EnvironmentSource;
use crate::math::Vec3;
use crate::render::Rendered;

/// Puts into the header what the picture was made of; `words` are those of the command line after
/// `dapple`.
pub fn describe(rendered: &mut Rendered, args: &RenderArgs, job: &Job, words: &[String]) {
    let strings = [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("command", format!("dapple {}", shell::line(words))),
        ("settings", settings(args, job)),
        ("seed", job.settings.seed.to_string()),
        ("spp", job.settings.spp.to_string()),
        ("accel", args.accel.to_string()),
        ("scene", args.scene_file().display().to_string()),
        ("scene-digest", format!("{:016x}", job.world.scene.digest())),
        ("lost-samples", rendered.lost_count.to_string()),
        ("render-time", format!("{:.3} s", rendered.elapsed.as_secs_f64())),
    ];
    for (name, value) in strings {
        rendered.picture.strings.insert(format!("dapple/{name}"), value);
    }
}

/// All flags that are settings, by their names, as TOML: those that the picture is a function of
/// beside its scene file, how it is shown, and with what it is made. What was neither asked for nor
/// has a default is left out.
pub fn settings(args: &RenderArgs, job: &Job) -> String {
    let (settings, transport) = (&job.settings, &job.settings.transport);
    let whole = |numbers: &[i64]| Value::from(numbers.to_vec());
    let vector = |v: Vec3| Value::from(v.to_array().map(short).to_vec());
    let aovs: Vec<&str> = settings.aovs.iter().map(|aov| aov.name()).collect();
    let all = [
        ("accel", Some(args.accel.to_string().into())),
        ("animation", args.animation.clone().map(Value::from)),
        ("aov", Some(Value::from(aovs))),
        ("aperture", args.aperture.map(short)),
        ("bsdf", Some(args.bsdf.to_string().into())),
        ("lights", Some(args.lights.to_string().into())),
        ("camera-model", args.camera_model.map(|_| "panorama".into())),
        ("camera", args.camera.clone().map(Value::from)),
        ("crop", args.crop.map(|c| whole(&[c.x0, c.y0, c.x1, c.y1].map(i64::from)))),
        ("env", args.env.as_ref().map(environment)),
        ("env-rotate", args.env.as_ref().map(|_| short(args.env_rotate))),
        ("env-scale", (args.env.is_some() || args.sky.is_some()).then(|| short(args.env_scale))),
        ("exposure", Some(short(args.exposure))),
        ("filter", Some(settings.filter.to_string().into())),
        ("focus", args.focus.map(short)),
        ("fov", args.fov.map(short)),
        ("ground-albedo", args.ground_albedo.map(short)),
        ("isa", Some(args.isa.to_string().into())),
        ("look-at", args.look_at.map(vector)),
        ("look-from", args.look_from.map(vector)),
        ("max-depth", Some(i64::from(transport.max_depth).into())),
        ("missing-texture", args.missing_texture.map(|_| "magenta".into())),
        ("moments", args.moments.map(|n| i64::from(n).into())),
        ("resolution", Some(whole(&[settings.resolution.0.into(), settings.resolution.1.into()]))),
        ("rr-depth", Some(transport.roulette_depth.map_or("off".into(), |n| i64::from(n).into()))),
        ("sampler", Some(settings.pattern.to_string().into())),
        ("scene", args.scene.clone().map(Value::from)),
        ("seed", Some(number(settings.seed))),
        ("shutter", args.shutter.map(short)),
        ("sky", args.sky.map(short)),
        ("spp", Some(number(settings.spp))),
        ("strict", Some(args.strict.into())),
        ("sun-azimuth", args.sun_azimuth.map(short)),
        ("sun-diameter", args.sun_diameter.map(short)),
        ("sun-direction", args.sun_direction.map(vector)),
        ("sun-elevation", args.sun_elevation.map(short)),
        ("threads", Some(number(args.threads as u64))),
        ("time", args.time.map(short)),
        ("tonemap", Some(args.tonemap.to_string().into())),
        ("transparent", Some(transport.transparent.into())),
        ("up", args.up.map(vector)),
        ("variant", args.variant.clone().map(Value::from)),
    ];
    let table: Table =
        all.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))).collect();
    table.to_string()
}

/// With as many digits as the `f32` has, not those of the nearest `f64`.
fn short(value: f32) -> Value {
    value.to_string().parse::<f64>().unwrap_or(value.into()).into()
}

/// TOML's numbers end at 2^63 - 1; what is above is a string.
fn number(value: u64) -> Value {
    i64::try_from(value).map_or_else(|_| value.to_string().into(), Value::from)
}

fn environment(source: &EnvironmentSource) -> Value {
    match source {
        EnvironmentSource::Constant(c) => format!("{},{},{}", c.x, c.y, c.z).into(),
        EnvironmentSource::File(path) => path.display().to_string().into(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{prepare, render};
    use super::*;

    fn settings_of(words: &[&str]) -> Table {
        let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/furnace.gltf");
        let words: Vec<String> = words.iter().map(|&word| word.to_owned()).collect();
        let args = render::parse(&scene, &words).expect("good words");
        let job = prepare::prepare(&args).expect("a good scene");
        settings(&args, &job).parse().expect("good TOML")
    }

    #[test]
    fn a_golden_picture_tells_the_words_that_made_it() {
        let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/furnace.gltf");
        let words = ["--resolution", "2x2", "--spp", "4", "--spp", "1", "--env", "1,0.5,1"];
        let picture = render::picture(&scene, &words.map(str::to_owned)).expect("good words");
        let command = &picture.strings["dapple/command"];
        assert!(command.starts_with("dapple render "), "{command}");
        assert!(command.ends_with("--spp 4 --spp 1 --env 1,0.5,1"), "{command}");
        assert_eq!(picture.strings["dapple/spp"], "1");
        assert_eq!(picture.strings["dapple/lost-samples"], "0");
    }

    #[test]
    fn every_flag_that_makes_the_picture_is_in_the_settings() {
        let words = "--spp 3 --seed 18446744073709551615 --resolution 20x10 --crop 1,2,3,4 \
                     --env 0.1,0.2,0.3 --env-scale 2.5 --env-rotate -30 --look-from 0.1,1,3 \
                     --look-at 0,0,0 --up 0,0,1 --fov 33.3 --aperture 0.1 --focus 4 --rr-depth off \
                     --bsdf appendix-b --filter box --sampler independent --max-depth 7 \
                     --transparent --strict --missing-texture magenta --scene 0 --aov depth,cost";
        let words: Vec<&str> = words.split_whitespace().collect();
        let found = settings_of(&words);
        for word in words.iter().filter_map(|word| word.strip_prefix("--")) {
            assert!(found.contains_key(word), "{word} is not in\n{found}");
        }
        assert_eq!(found["seed"].as_str(), Some("18446744073709551615"));
        assert_eq!(found["env"].as_str(), Some("0.1,0.2,0.3"));
        assert_eq!(found["fov"].as_float(), Some(33.3));
        assert_eq!(found["look-from"].to_string(), "[0.1, 1.0, 3.0]");
        assert_eq!(found["rr-depth"].as_str(), Some("off"));
        let camera = settings_of(&["--camera", "0"]);
        assert_eq!(camera["camera"].as_str(), Some("0"));
        let motion = settings_of(&["--time", "1", "--shutter", "0.5", "--moments", "2"]);
        assert_eq!(
            (motion["shutter"].as_float(), motion["moments"].as_integer()),
            (Some(0.5), Some(2))
        );
        let around = settings_of(&["--camera-model", "panorama", "--lights", "power"]);
        assert_eq!(around["camera-model"].as_str(), Some("panorama"));
        assert_eq!(around["lights"].as_str(), Some("power"));
        assert_eq!(around["resolution"].to_string(), "[1280, 640]");
        assert!(!camera.contains_key("env") && !camera.contains_key("fov"));
    }
}
