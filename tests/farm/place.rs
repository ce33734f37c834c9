//! A folder in which a farm renders.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// How to call dapple.
pub const DAPPLE: &str = env!("CARGO_BIN_EXE_dapple");

/// A folder with a scene, and with a name that scripts have to quote.
pub struct Place(tempfile::TempDir);

impl Place {
    pub fn new() -> Self {
        let place = Self(tempfile::Builder::new().prefix("it's a ").tempdir().expect("made"));
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
        for name in ["cornell.gltf", "cornell.bin", "motion.gltf", "motion.bin"] {
            fs::copy(scenes.join(name), place.path(name)).expect("copied");
        }
        place
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The bytes of a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The text of a file; empty if there is none.
    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_default()
    }

    /// A command that is run here.
    pub fn command(&self, program: &str, words: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(words).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    /// Runs dapple, by words with spaces in between.
    pub fn dapple(&self, words: &str) -> Output {
        let words: Vec<&str> = words.split_whitespace().collect();
        self.command(DAPPLE, &words).output().expect("the binary runs")
    }

    /// Runs dapple, which must succeed, and returns what it prints.
    pub fn good(&self, words: &str) -> String {
        let output = self.dapple(words);
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "dapple {words}: {}\n{told}", output.status);
        String::from_utf8(output.stdout).expect("UTF-8")
    }

    /// Writes a program that can be run.
    pub fn program(&self, name: &str, text: &str) {
        use std::os::unix::fs::PermissionsExt;
        fs::write(self.path(name), text).expect("written");
        let all = fs::Permissions::from_mode(0o755);
        fs::set_permissions(self.path(name), all).expect("it is ours");
    }

    /// Writes what dapple prints.
    pub fn write(&self, name: &str, words: &str) {
        fs::write(self.path(name), self.good(words)).expect("written");
    }
}

/// What a command said, for the message of a test that fails.
pub fn said(output: &Output) -> String {
    let texts = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    format!("{}\n{}\n{}", output.status, texts[0], texts[1])
}
