//! The scenes that are measured: files, or scenes made on the spot.

use std::fs;
use std::path::{Path, PathBuf};

use crate::bench::mbvh::paper;
use crate::cli::error::CliError;
use crate::files::{self, Flush};
use crate::generate::Generator;

/// Triangles of the kitchen that is made where there is no file.
pub const KITCHEN: u64 = 103_000;

/// A scene.
#[derive(Clone, Debug)]
pub enum BenchScene {
    /// A file.
    File(PathBuf),
    /// One that `dapple generate` makes from seed 0, with its number of triangles.
    Made(Generator, u64),
}

/// The files, or else the machines.
pub fn choose_scenes(files: &[PathBuf]) -> Vec<BenchScene> {
    if files.is_empty() {
        let sizes = paper::SCENES.map(|scene| scene.triangles as u64);
        return sizes.map(|triangles| BenchScene::Made(Generator::Assembly, triangles)).into();
    }
    files.iter().cloned().map(BenchScene::File).collect()
}

impl BenchScene {
    /// What tables and files call it.
    pub fn name(&self) -> String {
        match self {
            Self::File(path) => {
                path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
            }
            Self::Made(generator, triangles) => format!("{}-{triangles}", generator.name()),
        }
    }

    /// Hands out the scene's file; one that is made goes with it.
    ///
    /// # Errors
    /// Those of `load`, or of the temporary folder.
    pub fn with_file<R>(
        &self,
        load: impl FnOnce(&Path) -> Result<R, CliError>,
    ) -> Result<R, CliError> {
        match self {
            Self::File(path) => load(path),
            Self::Made(generator, triangles) => {
                let name = format!("dapple-{}-{}.glb", std::process::id(), self.name());
                let file = Temporary(std::env::temp_dir().join(name));
                files::write(&file.0, Flush::WhenIdle, |out| {
                    generator.write(*triangles, 0, out).map(|_| ())
                })
                .map_err(|error| CliError::not_written(&file.0, &error))?;
                load(&file.0)
            }
        }
    }
}

/// A file that goes with its owner.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        // It lies in the folder for temporary files: others clear that, if this fails.
        let _ = fs::remove_file(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::flags::Quiet;

    #[test]
    fn a_machine_is_there_while_it_is_loaded() {
        let scene = BenchScene::Made(Generator::Assembly, 50);
        let mut seen = PathBuf::new();
        let count = scene.with_file(|path| {
            seen = path.to_owned();
            Ok(crate::cli::input::load_triangles(path, Quiet::default())?.len())
        });
        assert_eq!(count.expect("loads"), 50);
        assert!(!seen.exists() && scene.name() == "assembly-50");
    }

    #[test]
    fn without_files_the_papers_sizes_are_made() {
        assert_eq!(choose_scenes(&[]).len(), 4);
        let names: Vec<_> =
            choose_scenes(&["a/b.glb".into()]).iter().map(BenchScene::name).collect();
        assert_eq!(names, ["b"]);
    }
}
