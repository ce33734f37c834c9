//! `dapple farm slurm`, on a Slurm of two nodes.

use std::fs;
use std::process::Command;

use crate::place::{DAPPLE, Place, said};
use crate::slurm_up::Slurm;

/// Takes seconds a task, and saves every now and then.
const LONG: &str = "cornell.gltf --spp 2048 --resolution 96x96 --reproducible --every 16spp";

/// A picture by one command, and the jobs of the same in two parts under way.
struct Long {
    slurm: Slurm,
    place: Place,
    render: String,
}

impl Long {
    fn begin() -> Self {
        let (slurm, place) = (Slurm::up(), Place::new());
        place.good(&format!("render {LONG} -o one.exr -q").replace("--every 16spp", ""));
        place
            .write("farm.sh", &format!("farm slurm {LONG} -o out.exr --parts 2 --dapple {DAPPLE}"));
        let (render, _) = slurm.submit(&place);
        let long = Self { slurm, place, render };
        let is_saved = || long.place.path("out.parts/0.checkpoint").exists();
        long.slurm.wait(&long.place, "a checkpoint", &is_saved);
        long
    }

    /// Waits for the end: the picture is that of one render, and task 0 has gone on.
    fn end(&self) {
        self.slurm.wait_for_end(&self.place);
        let (log, report) = (self.place.text("out.parts/0.log"), self.slurm.report(&self.place));
        assert!(self.place.path("out.exr").exists(), "{report}");
        assert!(self.place.read("out.exr") == self.place.read("one.exr"), "{report}");
        assert!(log.contains("goes on from"), "{log}");
    }

    /// The process that renders task 0, and the node on which it does.
    fn task(&self) -> (String, String) {
        let running = fs::read_dir("/proc").expect("Linux").flatten().find(|process| {
            let line = fs::read(process.path().join("cmdline")).unwrap_or_default();
            let line = String::from_utf8_lossy(&line).into_owned();
            let place = fs::read_link(process.path().join("cwd")).unwrap_or_default();
            line.starts_with(DAPPLE)
                && line.contains("out.parts/0.part")
                && place == self.place.path("").canonicalize().expect("there")
        });
        let running = running.expect("task 0 is running");
        let environment = fs::read(running.path().join("environ")).expect("is readable");
        let environment = String::from_utf8_lossy(&environment).into_owned();
        let node = environment.split('\0').find_map(|it| it.strip_prefix("SLURMD_NODENAME="));
        let node = node.expect("a job of Slurm's").to_owned();
        (running.file_name().to_string_lossy().into_owned(), node)
    }
}

#[test]
#[ignore = "brings up Slurm: DAPPLE_TEST_SLURM=1 and --ignored, as root"]
fn slurm_renders_the_bytes_of_one_render_and_nothing_twice() {
    let (slurm, place) = (Slurm::up(), Place::new());
    let render = "cornell.gltf --spp 128 --resolution 64x48 --reproducible";
    place.good(&format!("render {render} -o one.exr --png one.png -q"));
    let farm = format!("farm slurm {render} -o out.exr --png out.png --parts 8 --dapple {DAPPLE}");
    place.write("farm.sh", &farm);
    let (job, merge) = slurm.submit(&place);
    assert!(!job.is_empty() && !merge.is_empty());
    slurm.wait_for_end(&place);
    assert!(place.path("out.exr").exists(), "{}", slurm.report(&place));
    assert!(place.read("out.exr") == place.read("one.exr"));
    assert!(place.read("out.png") == place.read("one.png"));
    let nodes = slurm.ask(&place, &format!("squeue -h -r -t all -j {job} -o %N"));
    let nodes = nodes.expect("the controller answers");
    assert!(nodes.contains("n1") && nodes.contains("n2"), "{nodes}");
    // The same again, by the command itself.
    let words: Vec<&str> = farm.split_whitespace().chain(["--submit"]).collect();
    let again = slurm.run(&place, DAPPLE, &words);
    assert!(again.status.success(), "{}", said(&again));
    slurm.wait_for_end(&place);
    for task in 0..8 {
        let log = place.text(&format!("out.parts/{task}.log"));
        assert!(log.contains("there already"), "{log}");
    }
}

#[test]
#[ignore = "brings up Slurm: DAPPLE_TEST_SLURM=1 and --ignored, as root"]
fn slurm_renders_frames() {
    let (slurm, place) = (Slurm::up(), Place::new());
    let render = "motion.gltf --spp 32 --resolution 32x24 --reproducible --frames 5..7";
    place.good(&format!("render {render} -o one.##.exr -q"));
    for parts in [1, 2] {
        let farm = format!("farm slurm {render} -o out.##.exr --parts {parts} --dapple {DAPPLE}");
        place.write("farm.sh", &farm);
        slurm.submit(&place);
        slurm.wait_for_end(&place);
        for frame in ["05", "06", "07"] {
            let log = place.text("out.parts/0.log");
            let out = place.path(&format!("out.{frame}.exr"));
            assert!(out.exists(), "frame {frame}: {log}");
            let same =
                place.read(&format!("out.{frame}.exr")) == place.read(&format!("one.{frame}.exr"));
            assert!(same, "frame {frame}: {log}");
            fs::remove_file(out).expect("removed");
        }
    }
}

#[test]
#[ignore = "brings up Slurm: DAPPLE_TEST_SLURM=1 and --ignored, as root"]
fn slurm_starts_a_killed_task_again() {
    let long = Long::begin();
    let (process, _) = long.task();
    let killed = Command::new("kill").args(["-9", &process]).status().expect("kill runs");
    assert!(killed.success());
    long.end();
}

#[test]
#[ignore = "brings up Slurm: DAPPLE_TEST_SLURM=1 and --ignored, as root"]
fn slurm_starts_the_task_of_a_lost_node_on_another() {
    let long = Long::begin();
    let (_, node) = long.task();
    long.slurm.lose(&node);
    long.end();
    let log = long.place.text("out.parts/0.log");
    assert!(!log.contains("interrupted"), "it had no time to say so: {log}");
}

#[test]
#[ignore = "brings up Slurm: DAPPLE_TEST_SLURM=1 and --ignored, as root"]
fn slurm_gives_notice_and_the_task_gets_another_turn() {
    let long = Long::begin();
    let task = format!("{}_0", long.render);
    long.slurm.ask(&long.place, &format!("scancel --signal=USR1 --batch {task}"));
    long.end();
    let log = long.place.text("out.parts/0.log");
    assert!(log.contains("interrupted: saved"), "{log}");
}

#[test]
#[ignore = "brings up Slurm: DAPPLE_TEST_SLURM=1 and --ignored, as root"]
fn slurm_does_not_merge_what_failed() {
    let (slurm, place) = (Slurm::up(), Place::new());
    let render = "cornell.gltf --spp 32 --resolution 32x24 --reproducible";
    place.write("farm.sh", &format!("farm slurm {render} -o out.exr --parts 2 --dapple {DAPPLE}"));
    fs::rename(place.path("cornell.gltf"), place.path("away.gltf")).expect("renamed");
    slurm.submit(&place);
    slurm.wait_for_end(&place);
    assert!(!place.path("out.exr").exists() && !place.path("out.parts/merge.log").exists());
    assert!(place.text("out.parts/1.log").contains("cornell.gltf"), "the log says why");
    fs::rename(place.path("away.gltf"), place.path("cornell.gltf")).expect("renamed");
    slurm.submit(&place);
    slurm.wait_for_end(&place);
    assert!(place.path("out.exr").exists());
}
