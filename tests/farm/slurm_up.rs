//! A Slurm of a test's own.

use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::place::{Place, said};

/// Its nodes render with all cores, one test at a time.
static ONE: Mutex<()> = Mutex::new(());

/// A Slurm of two nodes.
pub struct Slurm {
    folder: tempfile::TempDir,
    _alone: MutexGuard<'static, ()>,
}

impl Slurm {
    pub fn up() -> Self {
        let asked = std::env::var_os("DAPPLE_TEST_SLURM").is_some();
        assert!(asked, "this brings up Slurm, as root: set DAPPLE_TEST_SLURM=1 if that may be");
        let alone = ONE.lock().unwrap_or_else(PoisonError::into_inner);
        let mut slurm = Self { folder: tempfile::tempdir().expect("made"), _alone: alone };
        // The daemons of the test before may still hold their ports.
        for _ in 0..2 {
            if slurm.try_script(&["up"], &["2"]).status.success() {
                return slurm;
            }
            slurm.try_script(&["down"], &[]);
            slurm.folder = tempfile::tempdir().expect("made");
        }
        slurm.script(&["up"], &["2"]);
        slurm
    }

    fn try_script(&self, what: &[&str], more: &[&str]) -> Output {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/farm/slurm.sh");
        let mut command = Command::new("bash");
        command.arg(script).args(what).arg(self.folder.path()).args(more);
        command.output().expect("bash runs")
    }

    fn script(&self, what: &[&str], more: &[&str]) {
        let output = self.try_script(what, more);
        assert!(output.status.success(), "{what:?}: {}", said(&output));
    }

    /// Kills a node with all that runs there.
    pub fn lose(&self, node: &str) {
        self.script(&["lose"], &[node]);
    }

    fn conf(&self) -> PathBuf {
        self.folder.path().join("slurm.conf")
    }

    /// Runs one of Slurm's commands, or one that calls them.
    pub fn run(&self, place: &Place, program: &str, words: &[&str]) -> Output {
        place.command(program, words).env("SLURM_CONF", self.conf()).output().expect("it runs")
    }

    /// What one of Slurm's commands prints; none if it fails, as when the controller is busy.
    pub fn ask(&self, place: &Place, words: &str) -> Option<String> {
        let words: Vec<&str> = words.split_whitespace().collect();
        let output = self.run(place, words[0], &words[1..]);
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    }

    /// Submits what `farm.sh` holds, and returns the numbers of its jobs: render, and merge.
    pub fn submit(&self, place: &Place) -> (String, String) {
        let output = self.run(place, "bash", &["farm.sh"]);
        assert!(output.status.success(), "{}", said(&output));
        let told = String::from_utf8_lossy(&output.stdout).into_owned();
        let number = |before: &str| {
            let rest = told.split_once(before).map_or("", |(_, rest)| rest);
            rest.chars().take_while(char::is_ascii_digit).collect::<String>()
        };
        (number("render: job "), number("merge: job "))
    }

    /// Waits until something is so. That Slurm never gets there fails the test, with its state.
    pub fn wait(&self, place: &Place, what: &str, is_so: &dyn Fn() -> bool) {
        for _ in 0..1500 {
            if is_so() {
                return;
            }
            std::thread::sleep(Duration::from_millis(200));
        }
        panic!("{what}: waited in vain\n{}", self.report(place));
    }

    /// The state of all jobs, and what they said.
    pub fn report(&self, place: &Place) -> String {
        let mut text = self.ask(place, "squeue -a -r -t all").unwrap_or_default();
        for entry in std::fs::read_dir(place.path("out.parts")).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if entry.path().extension().is_some_and(|ending| ending == "log") {
                let said = place.text(&format!("out.parts/{name}"));
                text.extend(["-- ", &name, "\n", &said]);
            }
        }
        text
    }

    /// Waits for the end of all jobs.
    pub fn wait_for_end(&self, place: &Place) {
        let are_over = || self.ask(place, "squeue -h").is_some_and(|jobs| jobs.is_empty());
        self.wait(place, "the end of all jobs", &are_over);
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        self.script(&["down"], &[]);
    }
}
