//! Runs that are watched, without a render.

use std::path::Path;
use std::sync::atomic::AtomicUsize;

use super::*;
use crate::cli::outputs;
use crate::cli::settings::resolve_words;
use crate::film::{Window, png};

/// Settings by the words of a command line, each `@` of which stands for a folder.
fn args(folder: &Path, words: &[&str]) -> RenderArgs {
    let folder = folder.display().to_string();
    let words: Vec<String> = words.iter().map(|word| word.replace('@', &folder)).collect();
    resolve_words(Path::new("scenes/a.gltf"), &words).expect("good words").args
}

fn grey(value: f32) -> Picture {
    let window = Window::of_size(2, 2);
    let mut picture = Picture::new(window, window);
    picture.set_aov("", "RGB", &[[value; 3]; 4]);
    picture.set_channel("depth.Z", vec![1.0; 4]);
    picture
}

fn progress(done: u64, seconds: u64) -> Progress {
    Progress { before: 0, done, total: 100, elapsed: Duration::from_secs(seconds) }
}

fn read(folder: &Path, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).expect("there")
}

#[test]
fn a_watched_run_leaves_the_last_state_of_all_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let words = ["--quiet", "--preview", "@/a.png", "--metrics", "@/a.prom", "--tonemap", "srgb"];
    let watch = Watch::start(&args(folder, &words)).expect("good files");
    let snapshots = AtomicUsize::new(0);
    let snapshot = || {
        snapshots.fetch_add(1, Ordering::Relaxed);
        grey(0.0)
    };
    watch.expect_pixels(4);
    watch.enter(Phase::Render);
    for (done, seconds, expected) in [(0, 5, 0), (4, 5, 1), (100, 900, 1)] {
        watch.update(progress(done, seconds), &snapshot);
        assert_eq!(snapshots.load(Ordering::Relaxed), expected, "{done}");
    }
    watch.count_checkpoints(1);
    watch.set_rays(77);
    watch.present(&grey(1.0), None).expect("written");
    watch.finish(0).expect("written");
    let shown = png::read(&folder.join("a.png")).expect("whole");
    assert_eq!(shown.rgb(Path::new("a")).expect("colours"), [[1.0; 3]; 4]);
    let metrics = read(folder, "a.prom");
    let label = "{scene=\"scenes/a.gltf\"}";
    for (name, value) in
        [("samples_done", 100), ("rays_total", 77), ("checkpoints_total", 1), ("finished", 1)]
    {
        let line = format!("\ndapple_render_{name}{label} {value}\n");
        assert!(metrics.contains(&line), "{line} {metrics}");
    }
}

#[test]
fn a_run_that_fails_says_so_in_its_metrics_and_keeps_its_preview() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::write(folder.join("a.png"), "before").expect("written");
    let words = ["--quiet", "--preview", "@/a.png", "--metrics", "@/a.prom"];
    let watch = Watch::start(&args(folder, &words)).expect("good files");
    watch.finish(3).expect("written");
    assert_eq!(read(folder, "a.png"), "before");
    let metrics = read(folder, "a.prom");
    assert!(metrics.contains("dapple_render_exit_code{scene=\"scenes/a.gltf\"} 3\n"), "{metrics}");
}

#[test]
fn what_cannot_be_written_is_an_error_at_the_start_or_at_the_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let Err(error) = Watch::start(&args(folder, &["--log", "@/no/a.log"])) else {
        panic!("there is no folder")
    };
    assert!(error.exit_code() == 4 && error.to_string().contains("a.log"), "{error}");

    let words = ["--quiet", "--preview", "@/b/a.png", "--metrics", "@/b/a.prom"];
    let args = args(folder, &words);
    let checked = outputs::check(&outputs(&args), &[]);
    assert_eq!(checked.expect_err("no folder").exit_code(), 4);
    let watch = Watch::start(&args).expect("it begins");
    let preview = watch.present(&grey(1.0), None).expect_err("no folder");
    let metrics = watch.finish(0).expect_err("no folder");
    for (error, file) in [(preview, "a.png"), (metrics, "a.prom")] {
        assert!(error.exit_code() == 4 && error.to_string().contains(file), "{error}");
    }
}

#[test]
fn a_log_is_no_other_output_and_is_not_made_beside() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    // Whether it can be written is found out when it is opened.
    let apart = args(folder, &["--log", "@/no/a.log", "--metrics", "@/a.prom"]);
    assert!(outputs::check(&outputs(&apart), &[]).is_ok());
    let same = args(folder, &["--log", "@/a", "--metrics", "@/a"]);
    let error = outputs::check(&outputs(&same), &[]).expect_err("one file");
    assert_eq!(error.exit_code(), 2);
}
