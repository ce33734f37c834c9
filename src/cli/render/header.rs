//! A picture's header: how it was made.

use crate::cli::job::Job;
use crate::cli::settings::Table;
use crate::cli::shell;
use crate::render::Rendered;

/// Writes into the header how the picture was made; `words` are those of the command line after
/// `dapple`.
pub fn describe(rendered: &mut Rendered, job: &Job, words: &[String]) {
    let strings = [
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("command", format!("dapple {}", shell::join(words))),
        ("settings", Table::default().to_toml(&job.args)),
        ("seed", job.settings.seed.to_string()),
        ("spp", job.settings.spp.to_string()),
        ("accel", job.args.accel.to_string()),
        ("scene", job.args.scene_file.display().to_string()),
        ("scene-digest", format!("{:016x}", job.first.world.scene.digest())),
        ("lost-samples", rendered.lost_count.to_string()),
        ("render-time", format!("{:.3} s", rendered.elapsed.as_secs_f64())),
    ];
    for (name, value) in strings {
        rendered.picture.strings.insert(format!("dapple/{name}"), value);
    }
}

#[cfg(test)]
mod tests {
    use crate::cli::render::render_picture;

    #[test]
    fn a_golden_picture_tells_the_words_that_made_it() {
        let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/furnace.gltf");
        let words = ["--resolution", "2x2", "--spp", "4", "--spp", "1", "--env", "1,0.5,1"];
        let picture = render_picture(&scene, &words.map(str::to_owned)).expect("good words");
        let command = &picture.strings["dapple/command"];
        assert!(command.starts_with("dapple render "), "{command}");
        assert!(command.ends_with("--spp 4 --spp 1 --env 1,0.5,1"), "{command}");
        assert_eq!(picture.strings["dapple/spp"], "1");
        assert_eq!(picture.strings["dapple/lost-samples"], "0");
    }
}
