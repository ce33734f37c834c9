//! A picture's header: how it was made.

use std::collections::BTreeMap;
use std::path::Path;

use toml::{Table as TomlTable, Value};

use crate::cli::job::Job;
use crate::cli::settings::Table;
use crate::cli::shell;
use crate::film::Picture;
use crate::math::Digest;
use crate::part::Head;
use crate::render::{NoiseReached, Rendered};

/// What a header tells.
pub struct Header {
    /// All settings as TOML.
    settings: TomlTable,
    scene: String,
    scene_digest: String,
    lost_samples: u64,
    render_s: f64,
    /// Under a target for the noise: what was reached.
    reached: Option<NoiseReached>,
    /// Whether samples are missing that were asked for.
    unfinished: bool,
    /// The words of the command line after `dapple`.
    words: Vec<String>,
}

impl Header {
    /// The header of a picture that a job rendered.
    pub fn of_render(rendered: &Rendered, job: &Job, words: &[String]) -> Self {
        Self {
            lost_samples: rendered.lost_count,
            render_s: (rendered.before + rendered.elapsed).as_secs_f64(),
            reached: rendered.reached,
            unfinished: rendered.cancelled,
            words: words.to_vec(),
            ..Self::of_job(job)
        }
    }

    /// What is known before the first sample.
    fn of_job(job: &Job) -> Self {
        Self {
            settings: parse(&Table::default().to_toml(&job.args)),
            scene: job.args.scene_file.display().to_string(),
            scene_digest: job.staged.world.scene.digest_text(),
            lost_samples: 0,
            render_s: 0.0,
            reached: None,
            unfinished: false,
            words: Vec::new(),
        }
    }

    /// Whether a picture with such a header is what a job is to make, and whole.
    pub fn is_of(strings: &BTreeMap<String, String>, job: &Job) -> bool {
        let wanted = Self::of_job(job);
        let found = |name: &str| strings.get(&format!("dapple/{name}"));
        found("unfinished").is_none()
            && found("version").is_some_and(|version| version == env!("CARGO_PKG_VERSION"))
            && found("scene-digest") == Some(&wanted.scene_digest)
            && found("settings").is_some_and(|it| are_same(it, &wanted.settings.to_string()))
    }

    /// The label of a PNG that a job is to make.
    pub fn label_of(job: &Job) -> Option<String> {
        Self::of_job(job).label()
    }

    /// What a PNG is told: it differs where the pixels may, and nowhere else. One of a picture
    /// that is not whole is told nothing.
    pub fn label(&self) -> Option<String> {
        let mut digest = Digest::default();
        let mut settings = of_picture(self.settings.clone());
        settings.retain(|name, _| name != "aov" && name != "reproducible");
        digest.bytes(settings.to_string().as_bytes());
        let (version, scene) = (env!("CARGO_PKG_VERSION"), &self.scene_digest);
        let label = format!("{version} scene {scene} settings {:016x}", digest.value());
        (!self.unfinished).then_some(label)
    }

    /// The header of a picture that parts add up to: what one render of all samples would tell.
    pub fn of_parts(head: &Head, lost_samples: u64, words: &[String]) -> Self {
        let mut settings = parse(&head.settings);
        settings.insert("spp".to_owned(), Value::Integer(head.spp as i64));
        let (crop, (width, height)) = (head.crop(), head.resolution);
        if crop.area() < width as usize * height as usize {
            let corners = [crop.x0, crop.y0, crop.x1, crop.y1].map(i64::from).to_vec();
            settings.insert("crop".to_owned(), corners.into());
        } else {
            settings.remove("crop");
        }
        Self {
            settings,
            scene: head.scene.clone(),
            scene_digest: head.scene_digest.clone(),
            lost_samples,
            render_s: head.render_s,
            reached: None,
            unfinished: false,
            words: words.to_vec(),
        }
    }

    /// Makes the picture one that is the same whenever it is made.
    pub fn make_reproducible(&mut self) {
        self.settings.insert("reproducible".to_owned(), true.into());
    }

    /// Says whether samples are missing that were asked for.
    pub fn set_unfinished(&mut self, unfinished: bool) {
        self.unfinished = unfinished;
    }

    /// Whether it leaves out what differs between runs.
    pub fn is_reproducible(&self) -> bool {
        self.settings.get("reproducible").and_then(Value::as_bool) == Some(true)
    }

    /// A setting, as it was typed.
    fn setting(&self, name: &str) -> String {
        match self.settings.get(name) {
            Some(Value::String(text)) => text.clone(),
            Some(value) => value.to_string(),
            None => String::new(),
        }
    }

    /// The strings of the header, by name.
    pub fn strings(&self) -> Vec<(String, String)> {
        let is_reproducible = self.is_reproducible();
        let mut settings = self.settings.clone();
        let mut scene = self.scene.clone();
        let mut strings = Vec::new();
        if is_reproducible {
            settings = of_picture(settings);
            let name =
                Path::new(&scene).file_name().map(|name| name.to_string_lossy().into_owned());
            scene = name.unwrap_or(scene);
        } else {
            strings.push(("command", format!("dapple {}", shell::join(&self.words))));
            strings.push(("accel", self.setting("accel")));
            strings.push(("render-time", format!("{:.3} s", self.render_s)));
        }
        strings.extend([
            ("version", env!("CARGO_PKG_VERSION").to_owned()),
            ("settings", settings.to_string()),
            ("seed", self.setting("seed")),
            ("spp", self.setting("spp")),
            ("scene", scene),
            ("scene-digest", self.scene_digest.clone()),
            ("lost-samples", self.lost_samples.to_string()),
        ]);
        if let Some(NoiseReached { largest, share }) = self.reached {
            let reached = format!("{largest:.5} at most; share of the tiles below: {share:.4}");
            strings.push(("noise-reached", reached));
        }
        if self.unfinished {
            strings.push(("unfinished", "samples are missing".to_owned()));
        }
        strings.into_iter().map(|(name, value)| (format!("dapple/{name}"), value)).collect()
    }

    /// Writes it into a picture; one that is to be the same whenever it is made loses its layer
    /// `cost`.
    pub fn apply(&self, picture: &mut Picture) {
        picture.strings.extend(self.strings());
        if self.is_reproducible() {
            picture.retain_channels(|name| !name.starts_with("cost."));
        }
    }
}

/// Whether two texts of settings differ at most in what is about the machine.
pub fn are_same(a: &str, b: &str) -> bool {
    of_picture(parse(a)) == of_picture(parse(b))
}

/// Settings without those that are about the machine.
fn of_picture(mut settings: TomlTable) -> TomlTable {
    let table = Table::default();
    settings.retain(|name, _| table.is_reproducible(name));
    settings
}

/// Settings that this program wrote.
fn parse(settings: &str) -> TomlTable {
    settings.parse().unwrap_or_default()
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

    #[test]
    fn a_reproducible_picture_tells_nothing_of_time_place_and_machine() {
        let scene = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/furnace.gltf");
        let words = ["--resolution", "2x2", "--spp", "1", "--reproducible", "--threads", "1"];
        let picture = render_picture(&scene, &words.map(str::to_owned)).expect("good words");
        let names: Vec<&str> = picture.strings.keys().map(|name| &name[7..]).collect();
        let expected =
            ["lost-samples", "scene", "scene-digest", "seed", "settings", "spp", "version"];
        assert_eq!(names, expected);
        assert_eq!(picture.strings["dapple/scene"], "furnace.gltf");
        assert!(!picture.strings["dapple/settings"].contains("threads"));
        assert!(picture.channel("cost.Y").is_none() && picture.channel("depth.Z").is_some());
    }
}
