//! Renders that are killed, told to stop, or run out of disk: nothing is lost but time.
#![cfg(unix)]

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn render(folder: &Path, words: &str) -> Command {
    let scene = format!("{}/scenes/cornell.gltf", env!("CARGO_MANIFEST_DIR"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_dapple"));
    command.args(["render", &scene, "--progress", "none", "--reproducible"]);
    command.args(words.split_whitespace()).current_dir(folder);
    command.stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

fn wait(child: Child) -> (Option<i32>, String) {
    let output = child.wait_with_output().expect("it ends");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn run(folder: &Path, words: &str) -> (Option<i32>, String) {
    wait(render(folder, words).spawn().expect("the binary runs"))
}

fn send(signal: &str, child: &Child) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status();
    assert!(status.expect("kill runs").success());
}

/// Waits until a file is there.
fn await_file(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "{} never came", path.display());
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.expect("an entry").file_name().to_string_lossy().into_owned()
    };
    let mut names: Vec<String> = entries.map(name).collect();
    names.sort();
    names
}

#[test]
fn a_render_that_is_killed_again_and_again_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    for noise in ["--spp 1500", "--noise 0.03 --max-spp 2048"] {
        let size = format!("--resolution 64x48 {noise}");
        assert_eq!(run(folder, &format!("{size} -o ref.exr")).0, Some(0));
        let again = format!("{size} -o out.exr --checkpoint --resume auto --every 100ms");
        // From a seed of its own, so that a failure can be had again.
        let mut random = 12345_u64;
        let mut kills = 0;
        while kills < 8 {
            random = random.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let mut child = render(folder, &again).spawn().expect("the binary runs");
            std::thread::sleep(Duration::from_millis(20 + (random >> 33) % 500));
            let ended = child.try_wait().expect("it can be asked");
            child.kill().ok();
            let (code, said) = wait(child);
            assert!(code.is_none() || code == Some(0), "{code:?} {said}");
            kills += 1;
            if ended.is_some() {
                break;
            }
        }
        let (code, said) = run(folder, &again);
        assert_eq!(code, Some(0), "{said}");
        let read = |name: &str| std::fs::read(folder.join(name)).expect("there");
        assert!(read("ref.exr") == read("out.exr"), "after {kills} kills");
        assert_eq!(names(folder), ["out.exr", "ref.exr"], "nothing is left");
    }
}

/// Much more than a test has time for.
const LONG: &str = "--resolution 64x64 --spp 100000000";

#[test]
fn signals_save_and_end_or_go_on() {
    for (signal, code) in [("-USR1", 75), ("-TERM", 143), ("-INT", 130)] {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let words = format!("{LONG} -o a.exr --checkpoint c --resume auto --every 100ms");
        let child = render(folder, &words).spawn().expect("the binary runs");
        await_file(&folder.join("c"));
        send(signal, &child);
        let (found, said) = wait(child);
        assert_eq!(found, Some(code), "{signal}: {said}");
        assert_eq!(names(folder), ["a.exr", "c"]);
        let child = render(folder, &words).spawn().expect("the binary runs");
        std::thread::sleep(Duration::from_millis(300));
        send("-TERM", &child);
        let (_, said) = wait(child);
        assert!(said.contains("goes on from c: has ") || said.contains("reading"), "{said}");
    }
}

#[test]
fn hang_up_saves_and_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let words = format!("{LONG} -o a.exr --checkpoint c --every 1h --metrics m.prom");
    let mut child = render(folder, &words).spawn().expect("the binary runs");
    // It listens to signals before it writes anything.
    await_file(&folder.join("m.prom"));
    let start = Instant::now();
    while !folder.join("c").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint came");
        send("-HUP", &child);
        std::thread::sleep(Duration::from_millis(100));
    }
    assert!(child.try_wait().expect("it can be asked").is_none(), "it goes on");
    send("-USR1", &child);
    assert_eq!(wait(child).0, Some(75));
}

#[test]
fn limits_of_time_end_a_render_as_they_say() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let (code, said) = run(folder, &format!("{LONG} -o a.exr --checkpoint --stop-after 500ms"));
    assert_eq!(code, Some(75), "{said}");
    assert_eq!(names(folder), ["a.checkpoint", "a.exr"]);
    let (code, said) = run(folder, &format!("{LONG} -o b.exr --time-limit 500ms"));
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("the time is over: saved with"), "{said}");
    let flags = "--time-limit 500ms --fail-incomplete";
    let (code, said) = run(folder, &format!("{LONG} -o b.exr {flags}"));
    assert_eq!(code, Some(5), "{said}");
}

#[test]
fn checkpoints_are_neither_overwritten_nor_mistaken() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let (code, _) = run(folder, &format!("{LONG} -o a.exr --checkpoint --stop-after 300ms"));
    assert_eq!(code, Some(75));
    let saved = std::fs::read(folder.join("a.checkpoint")).expect("there");
    for (words, code, message) in [
        ("-o a.exr --checkpoint", 2, "a.checkpoint: is there: --resume goes on from it"),
        ("-o b.exr --resume", 3, "b.checkpoint: there is no such checkpoint"),
        ("-o a.exr --resume --seed 4", 3, "--seed: 0 and 4"),
        ("-o a.exr --resume --crop 0,0,9,9", 3, "--crop: 0,0,64,64 and 0,0,9,9"),
    ] {
        let (found, said) = run(folder, &format!("{LONG} {words}"));
        assert_eq!(found, Some(code), "{words}: {said}");
        assert!(said.contains(message), "{words}: {said}");
    }
    let (code, said) = run(folder, "--resolution 64x64 --spp 16 -o a.exr --resume");
    assert_eq!(code, Some(3), "{said}");
    assert!(said.contains("the last sample: 100000000 and 16"), "{said}");
    // Something else of someone's is not to be removed, nor is that advised.
    std::fs::write(folder.join("dear.checkpoint"), "dear to someone").expect("written");
    for words in ["--checkpoint dear.checkpoint", "--checkpoint dear.checkpoint --resume"] {
        let (code, said) = run(folder, &format!("{LONG} -o a.exr {words}"));
        assert_eq!(code, Some(3), "{said}");
        assert!(
            said.contains("dear.checkpoint: is no checkpoint") && !said.contains("remove"),
            "{said}"
        );
    }
    let mut damaged = saved.clone();
    let middle = damaged.len() / 2;
    damaged[middle] ^= 4;
    std::fs::write(folder.join("a.checkpoint"), &damaged).expect("written");
    let (code, said) = run(folder, &format!("{LONG} -o a.exr --resume auto"));
    assert_eq!(code, Some(3), "{said}");
    assert!(said.contains("a.checkpoint: is damaged"), "{said}");
    assert_eq!(std::fs::read(folder.join("a.checkpoint")).expect("there"), damaged);
}

/// A small disk, where the system lets us have one: what is on it stays whole.
#[test]
fn a_full_disk_costs_a_warning_and_at_the_end_leaves_what_there_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let disk = folder.path().join("disk");
    std::fs::create_dir(&disk).expect("made");
    let scene = format!("{}/scenes/cornell.gltf", env!("CARGO_MANIFEST_DIR"));
    let dapple = env!("CARGO_BIN_EXE_dapple");
    let flags = "--progress none --every 100ms --checkpoint disk/c --resolution 64x64";
    let script = format!(
        "mount -t tmpfs -o size=2m none disk || exit 99
         dd if=/dev/zero of=disk/full bs=1k count=2000 2>/dev/null
         {dapple} render {scene} {flags} --spp 4000 -o disk/a.exr; echo code $?; ls -A disk
         rm disk/full
         {dapple} render {scene} {flags} --spp 64 -o disk/a.exr; echo code $?
         dd if=/dev/zero of=disk/full bs=1k count=2000 2>/dev/null
         {dapple} render {scene} {flags} --spp 64 -o disk/a.exr; echo code $?; ls -A disk"
    );
    let output = Command::new("unshare")
        .args(["--user", "--map-root-user", "--mount", "sh", "-c", &script])
        .current_dir(folder.path())
        .output();
    let Ok(output) = output else { return eprintln!("skipped: there is no `unshare`") };
    let text = String::from_utf8_lossy(&output.stdout);
    let said = String::from_utf8_lossy(&output.stderr);
    if !text.contains("code") {
        return eprintln!("skipped: the system lets no one mount: {said}");
    }
    assert!(said.contains("warning: disk/c: cannot be written"), "{said}");
    let expected = "code 4\nfull\ncode 0\ncode 4\na.exr\nfull\n";
    assert_eq!(text, expected, "{said}");
}
