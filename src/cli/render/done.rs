//! Whether all that a render is to write is there already.

use std::path::Path;

use super::checkpoint;
use super::header::{self, Header};
use crate::cli::error::CliError;
use crate::cli::job::Job;
use crate::cli::progress::say;
use crate::cli::settings::parse_long::Resume;
use crate::film::{exr, png, png_label};
use crate::part::Part;

/// Whether a job that goes on by itself has nothing left to do: its files are there, whole and of
/// the same scene and settings, and no checkpoint says otherwise. A task that a farm starts again
/// costs no more than reading the scene and the look ahead.
///
/// # Errors
/// If there is no name for its checkpoint.
pub fn is_done(job: &Job) -> Result<bool, CliError> {
    let args = &job.args;
    if args.resume != Some(Resume::Auto) || checkpoint::path(args)?.is_some_and(|it| it.exists()) {
        return Ok(false);
    }
    let files = [&args.output, &args.png, &args.partial].into_iter().flatten();
    if !files.clone().all(|path| path.exists()) {
        return Ok(false);
    }
    let is_same = args.output.as_ref().is_none_or(|path| is_picture_of(path, job))
        && args.png.as_ref().is_none_or(|path| is_png_of(path, job))
        && args.partial.as_ref().is_none_or(|path| is_part_of(path, job));
    if !args.quiet {
        let files: Vec<String> = files.map(|path| path.display().to_string()).collect();
        let files = files.join(", ");
        say(&if is_same {
            format!("{files}: there already, of this scene and these settings")
        } else {
            format!("note: {files}: of another scene or other settings, or not whole; made anew")
        });
    }
    Ok(is_same)
}

/// Whether a file is the picture that a job is to make.
fn is_picture_of(path: &Path, job: &Job) -> bool {
    exr::read(path).is_ok_and(|picture| Header::is_of(&picture.strings, job))
}

/// Whether a file is the PNG that a job is to make.
fn is_png_of(path: &Path, job: &Job) -> bool {
    let label = png_label::read(path).ok().flatten();
    label.is_some() && label == Header::label_of(job) && png::read(path).is_ok()
}

/// Whether a file is the part that a job is to make.
fn is_part_of(path: &Path, job: &Job) -> bool {
    let Ok(part) = Part::open(path) else { return false };
    let wanted = checkpoint::head(job);
    part.verify().is_ok()
        && part.is_complete()
        && part.head.samples() == wanted.samples()
        && header::are_same(&part.head.settings, &wanted.settings)
        && checkpoint::differences(&part.head, &wanted).is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::settings::resolve_words;

    /// A render of such words, of a tiny picture.
    fn job(folder: &Path, words: &str) -> Job {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/furnace.gltf");
        let words = format!("--resolution 2x2 -q --resume auto {words}");
        let words = words.replace('@', &format!("{}/", folder.display()));
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        let args = resolve_words(&scene, &words).expect("good words").args;
        Job::prepare(args).expect("a good scene")
    }

    fn has_nothing_to_do(folder: &Path, words: &str) -> bool {
        is_done(&job(folder, words)).expect("one moment")
    }

    fn write(file: &Path, words: &str, unfinished: bool) {
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/furnace.gltf");
        let words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        let mut picture = crate::cli::render::render_picture(&scene, &words).expect("good words");
        if unfinished {
            picture.strings.insert("dapple/unfinished".to_owned(), "yes".to_owned());
        }
        exr::write(file, &picture).expect("written");
    }

    #[test]
    fn a_picture_is_done_if_it_is_whole_and_of_the_same_settings() {
        let folder = tempfile::tempdir().expect("a folder");
        let (folder, file) = (folder.path(), folder.path().join("a.exr"));
        assert!(!has_nothing_to_do(folder, "-o @a.exr --spp 1"), "there is none");
        write(&file, "--resolution 2x2 --spp 1 --threads 1", false);
        assert!(has_nothing_to_do(folder, "-o @a.exr --spp 1"));
        assert!(has_nothing_to_do(folder, "-o @a.exr --spp 1 --accel bvh2"), "the same picture");
        for other in ["--spp 2", "--spp 1 --seed 4", "--spp 1 --env 1,1,1", "--spp 1 --aov albedo"]
        {
            assert!(!has_nothing_to_do(folder, &format!("-o @a.exr {other}")), "{other}");
        }
        assert!(!has_nothing_to_do(folder, "-o @a.exr --png @a.png --spp 1"), "one is missing");
        write(&file, "--resolution 2x2 --spp 1", true);
        assert!(!has_nothing_to_do(folder, "-o @a.exr --spp 1"), "samples are missing");
        write(&file, "--resolution 2x2 --spp 1", false);
        std::fs::write(folder.join("a.checkpoint"), "").expect("written");
        assert!(!has_nothing_to_do(folder, "-o @a.exr --spp 1"), "there is a checkpoint");
        std::fs::write(folder.join("b.exr"), "no picture").expect("written");
        assert!(!has_nothing_to_do(folder, "-o @b.exr --spp 1"));
    }

    #[test]
    fn a_png_alone_tells_whether_it_is_done() {
        let folder = tempfile::tempdir().expect("a folder");
        let (folder, file) = (folder.path(), folder.path().join("a.png"));
        let label = |words: &str| {
            let header = Header::label_of(&job(folder, words));
            header.expect("a whole picture")
        };
        let window = crate::film::Window::of_size(2, 2);
        let mut picture = crate::film::Picture::new(window, window);
        picture.set_aov("", "RGB", &[[0.5; 3]; 4]);
        let write = |label: Option<&str>| {
            png::write(&file, &picture, crate::film::Tonemap::Agx, 0.0, label).expect("written");
        };
        write(None);
        assert!(!has_nothing_to_do(folder, "--png @a.png --spp 1"), "it does not tell");
        write(Some(&label("--png @a.png --spp 1 --reproducible --accel bvh2 --threads 3")));
        assert!(has_nothing_to_do(folder, "--png @a.png --spp 1 --aov albedo"));
        for other in ["--spp 2", "--spp 1 --exposure 1", "--spp 1 --env 1,1,1"] {
            assert!(!has_nothing_to_do(folder, &format!("--png @a.png {other}")), "{other}");
        }
        let bytes = std::fs::read(&file).expect("there");
        std::fs::write(&file, &bytes[..bytes.len() - 20]).expect("cut");
        assert!(!has_nothing_to_do(folder, "--png @a.png --spp 1"), "it is cut short");
    }
}
