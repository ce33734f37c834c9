//! The table against clap, and the way of a setting through files.

use std::ffi::OsString;
use std::path::Path;

use clap::Command;

use super::resolve::resolve_by;
use super::setting::{Form, Group, Reader, Role, Setting, assign};
use super::to_toml::ToToml;
use super::{RenderArgs, Table, parse, resolve_words};
use crate::cli::error::CliError;
use crate::film::{Picture, Window, exr};

fn command(table: &Table) -> Command {
    table.add_to(Command::new("render"))
}

/// The settings for a scene file of such text and such words.
fn resolved(table: &Table, scene: &str, words: &[&str]) -> Result<RenderArgs, CliError> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("s.toml");
    std::fs::write(&path, scene).expect("written");
    let words = std::iter::once(path.into_os_string()).chain(words.iter().map(OsString::from));
    let typed = table.read_words(words).map_err(CliError::Usage)?;
    resolve_by(table, &typed).map(|request| request.args)
}

fn args(scene: &str, words: &[&str]) -> Result<RenderArgs, CliError> {
    resolved(&Table::default(), scene, words)
}

#[test]
fn clap_has_the_settings_of_the_table_and_no_others() {
    let table = Table::default();
    let mut command = command(&table);
    command.build();
    let flags = command.get_arguments().filter(|arg| !arg.is_positional());
    let found: Vec<&str> = flags.filter_map(clap::Arg::get_long).collect();
    let expected = table.settings().map(|setting| setting.name).chain(["help"]);
    assert_eq!(found, expected.collect::<Vec<_>>());
    for arg in command.get_arguments() {
        let Some(setting) = arg.get_long().and_then(|long| table.find(long)) else { continue };
        assert_eq!(arg.get_short(), setting.short);
        assert_eq!(arg.get_help_heading(), Some(setting.group.heading()));
        assert_eq!(arg.get_action().takes_values(), setting.takes_value());
        let defaults: Vec<_> = arg.get_default_values().iter().map(|it| it.to_str()).collect();
        let default = setting.default.into_iter().map(Some).collect::<Vec<_>>();
        if setting.takes_value() {
            assert_eq!(defaults, default);
        }
    }
}

/// The flag of each recorded setting with its example, and the flag that it needs.
fn examples(table: &Table) -> Vec<(&'static Setting, Vec<String>)> {
    fn words(table: &Table, setting: &Setting) -> Vec<String> {
        let needed = setting.requires.first().and_then(|name| table.find(name));
        let mut all = needed.map_or(Vec::new(), |needed| words(table, needed));
        all.push(setting.flag());
        if setting.takes_value() {
            all.push(setting.example.to_owned());
        }
        all
    }
    let recorded = table.settings().filter(|setting| setting.role.is_recorded());
    recorded.map(|setting| (setting, words(table, setting))).collect()
}

#[test]
fn each_setting_comes_back_from_a_scene_and_from_a_header_as_it_was_typed() {
    let table = Table::default();
    let folder = tempfile::tempdir().expect("a folder");
    let picture = folder.path().join("a.exr");
    for (setting, words) in examples(&table) {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let typed = table.to_toml(&resolved(&table, "", &words).expect(setting.name));
        assert!(typed.contains(&format!("{} = ", setting.name)), "{typed}");
        let from_scene = resolved(&table, &format!("[render]\n{typed}"), &[]);
        assert_eq!(table.to_toml(&from_scene.expect("its own words")), typed);

        let mut made = Picture::new(Window::of_size(1, 1), Window::of_size(1, 1));
        made.set_aov("", "RGB", &[[0.0; 3]]);
        made.strings.insert("dapple/settings".to_owned(), typed.clone());
        made.strings.insert("dapple/scene".to_owned(), "no.gltf".to_owned());
        exr::write(&picture, &made).expect("written");
        let words = ["--from".into(), picture.clone().into_os_string()];
        let words = table.read_words(words).expect("good words");
        let again = resolve_by(&table, &words).expect("its own settings").args;
        assert_eq!(table.to_toml(&again), typed);
        assert_eq!(again.scene_file, Path::new("no.gltf"));
    }
}

/// One more setting, which keeps its value where `--variant` does.
static WALLPAPER: Setting = Setting {
    name: "wallpaper",
    form: Form::Word,
    value: "PATTERN",
    example: "stripes",
    help: "What is on the walls",
    requires: &["time"],
    conflicts: &["sky"],
    read: Reader::Text(|word| assign(parse::from_str::<String>(word), |args| &mut args.variant)),
    write: |args| args.variant.to_toml(),
    ..Setting::new(Group::Light, Role::Scene)
};

#[test]
fn a_setting_that_is_added_to_the_table_appears_everywhere() {
    let table = Table::default().with(&WALLPAPER);
    let help = command(&table).render_long_help().to_string();
    assert!(help.contains("--wallpaper <PATTERN>\n          What is on the walls"), "{help}");
    let mut script = Vec::new();
    let mut dapple = Command::new("dapple").subcommand(command(&table));
    clap_complete::generate(clap_complete::Shell::Bash, &mut dapple, "dapple", &mut script);
    assert!(String::from_utf8_lossy(&script).contains("--wallpaper"));
    let mut page = Vec::new();
    clap_mangen::Man::new(command(&table)).render(&mut page).expect("written to memory");
    assert!(String::from_utf8_lossy(&page).contains("What is on the walls"));
    assert!(table.to_markdown().contains("| `--wallpaper <PATTERN>` | What is on the walls."));

    // In a scene and, as TOML, in a header and by `--print-config`.
    let scene = "[render]\ntime = 1\nwallpaper = 'dots'\n";
    let found = resolved(&table, scene, &[]).expect("a key");
    assert_eq!(found.variant.as_deref(), Some("dots"));
    assert!(table.to_toml(&found).contains("wallpaper = \"dots\""));
    let typed = resolved(&table, scene, &["--wallpaper", "stripes"]).expect("a flag");
    assert_eq!(typed.variant.as_deref(), Some("stripes"));
    // Its rules, and the advice where a key is unknown.
    let replaced = resolved(&table, scene, &["--sky", "3"]).expect("the sky replaces it");
    assert_eq!((replaced.variant, replaced.sky), (None, Some(3.0)));
    for (scene, words, message) in [
        ("", &["--wallpaper", "dots"][..], "--wallpaper is of no use without --time"),
        ("[render]\nwallpaper = 'dots'\n", &[], "s.toml:2: --wallpaper is of no use without"),
        ("[render]\nwallpapre = 'dots'\n", &[], "did you mean wallpaper"),
        ("", &["--time", "1", "--wallpaper", "a", "--sky", "3"], "cannot be used with"),
    ] {
        let error = resolved(&table, scene, words).expect_err(message).to_string();
        assert!(error.contains(message), "{error}");
    }
    assert!(args(scene, &[]).is_err(), "only the copy has it");
}

#[test]
fn what_is_typed_takes_precedence_over_what_the_scene_says() {
    let scene = "[render]\nspp = 4\nseed = 9\ntransparent = true\nlook-from = [1, 2, 3]\n\
                 sky = 3\nsun-elevation = 10\n";
    let plain = args(scene, &[]).expect("good");
    assert_eq!((plain.spp, plain.seed, plain.transparent), (4, 9, true));
    assert_eq!(plain.look_from, Some(crate::math::Vec3::new(1.0, 2.0, 3.0)));
    let typed = args(scene, &["--spp", "64", "--camera", "0", "--env", "1,1,1"]).expect("good");
    assert_eq!((typed.spp, typed.seed), (64, 9));
    assert_eq!((typed.look_from, typed.sky, typed.sun_elevation), (None, None, None));
    // Of what the scene leaves open, the rest may be typed.
    let closer = args(scene, &["--look-at", "0,0,0", "--env-scale", "2"]).expect("good");
    assert!(closer.look_at.is_some());
    let error = args("", &["--look-at", "0,0,1"]).expect_err("no eye");
    assert_eq!(
        (error.exit_code(), &*error.to_string()),
        (2, "--look-at is of no use without --look-from")
    );
}

#[test]
fn settings_that_make_no_sense_are_told_with_their_line() {
    for (scene, message) in [
        (
            "[render]\nspp = 4\nsped = 1\n",
            "s.toml:3: [render]: unknown key \"sped\"; did you mean seed",
        ),
        ("[render]\noutput = 'x.exr'\n", "s.toml:2: --output is no setting"),
        ("[render]\nspp = 'many'\n", "s.toml:2: invalid value 'many' for '--spp <N>'"),
        ("[render]\nspp = true\n", "s.toml:2: invalid value 'true' for '--spp <N>': is no switch"),
        ("[render]\nstrict = 1\n", "s.toml:2: invalid value '1' for '--strict': is either true"),
        ("[render]\nlook-at = [0, 1, 0]\n", "s.toml:2: --look-at is of no use without --look-from"),
        ("[render]\nfov = nan\n", "s.toml:2: invalid value 'nan' for '--fov <DEGREES>'"),
        ("[render]\ncamera-model = 'x'\n", "for '--camera-model <KIND>': expected one of panorama"),
        ("[render]\ncamera = '0'\nlook-from = [0, 0, 0]\n", "s.toml:2: the argument '--camera"),
    ] {
        let error = args(scene, &[]).expect_err(scene);
        let text = error.to_string();
        assert!(text.contains(message), "{text}\n{message}");
        assert_eq!(error.exit_code(), 3);
    }
}

#[test]
fn later_words_override_earlier_ones() {
    let words = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect::<Vec<_>>();
    let resolve = |list: &[&str]| resolve_words(Path::new("a"), &words(list));
    let args = resolve(&["--spp", "4", "--aov", "cost", "--spp", "8"]).expect("good words").args;
    assert_eq!((args.spp, args.aov.len()), (8, 1));
    let error = resolve(&["--spq", "4"]).expect_err("no such flag");
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().starts_with("unexpected argument '--spq'"), "{error}");
}

#[test]
fn the_settings_of_a_picture_are_as_toml_has_them() {
    let words = "--seed 18446744073709551615 --env 0.1,0.2,0.3 --fov 33.3 --look-from 0.1,1,3 \
                 --rr-depth off --crop 1,2,3,4 --aov depth,cost";
    let words: Vec<&str> = words.split_whitespace().collect();
    let text = Table::default().to_toml(&args("", &words).expect("good words"));
    let found: toml::Table = text.parse().expect("good TOML");
    assert_eq!(found["seed"].as_str(), Some("18446744073709551615"));
    assert_eq!(found["env"].as_str(), Some("0.1,0.2,0.3"));
    assert_eq!(found["fov"].as_float(), Some(33.3));
    assert_eq!(found["look-from"].to_string(), "[0.1, 1.0, 3.0]");
    assert_eq!(found["rr-depth"].as_str(), Some("off"));
    assert_eq!(found["crop"].to_string(), "[1, 2, 3, 4]");
    assert_eq!(found["aov"].to_string(), "[\"depth\", \"cost\"]");
    let plain: toml::Table =
        Table::default().to_toml(&args("", &[]).expect("good")).parse().expect("good TOML");
    for absent in ["env", "env-scale", "env-rotate", "camera", "fov", "crop", "time"] {
        assert!(!plain.contains_key(absent), "{absent}");
    }
    assert_eq!((plain["strict"].as_bool(), plain["threads"].as_integer()), (Some(false), Some(0)));
}

#[test]
fn what_is_of_no_use_is_refused_even_if_no_file_records_it() {
    let refused = |words: &str| {
        let words: Vec<&str> = words.split_whitespace().collect();
        args("", &words).err().map(|error| error.to_string())
    };
    let said = refused("--every 5m").expect("nothing is written now and then");
    assert!(said.starts_with("--every is of no use without --checkpoint or"), "{said}");
    assert!(refused("--fail-incomplete").is_some_and(|it| it.contains("--noise or --time-limit")));
    for flag in ["--checkpoint c", "--resume auto", "--preview p.png", "--show"] {
        assert_eq!(refused(&format!("--every 5m {flag}")), None, "{flag}");
    }
    assert_eq!(refused("--fail-incomplete --time-limit 5m"), None);
}

#[test]
fn there_is_no_part_without_samples() {
    let words = |spp: &str, part: &str| args("", &["--spp", spp, "--part", part]).map(|_| ());
    assert!(words("32", "1/2").is_ok() && words("17", "1/2").is_ok());
    for (spp, part) in [("16", "0/2"), ("16", "1/2"), ("64", "0/5")] {
        let error = words(spp, part).expect_err("too many parts");
        assert_eq!(error.exit_code(), 2);
        let most = spp.parse::<u64>().expect("a number") / 16;
        let most = format!("{spp} samples a pixel make {most} part");
        assert!(error.to_string().contains(&most), "{error}");
    }
}
