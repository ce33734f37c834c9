//! Files that a TOML scene places, and those that scenes within it place: each is loaded once.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::placement::Part;
use crate::math::Aabb;
use crate::scene::Scene;

/// The most scenes within one another.
const MAX_DEPTH: usize = 16;

/// What has been loaded, and which scenes are being read.
#[derive(Default)]
pub struct Library {
    /// Empty where something of it is missing: that is told once.
    pub parts: HashMap<Part, Rc<Loaded>>,
    /// Placed scenes whose surroundings are left out.
    pub without_surroundings: Vec<PathBuf>,
    /// Placed scenes whose medium is left out.
    pub without_medium: Vec<PathBuf>,
    /// The outermost scene first, each with its path as the system has it.
    open: Vec<(PathBuf, PathBuf)>,
}

/// A file's scene.
#[derive(Default)]
pub struct Loaded {
    /// Without its notices.
    pub scene: Scene,
    /// The boxes of its meshes.
    pub bounds: Vec<Aabb>,
}

impl Loaded {
    /// Measures the meshes of a scene.
    pub fn new(scene: Scene) -> Self {
        let bounds = scene.meshes.iter();
        let bounds = bounds.map(|mesh| Aabb::of_points(mesh.positions.iter().copied())).collect();
        Self { scene, bounds }
    }
}

impl Library {
    /// Begins to read a scene, which [`Library::close`] ends.
    ///
    /// # Errors
    /// That it is being read already, or that there are too many within one another.
    pub fn open(&mut self, path: &Path) -> Result<(), String> {
        let real = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if let Some(first) = self.open.iter().position(|(_, other)| *other == real) {
            let circle = self.open[first..].iter().map(|(path, _)| path.as_path());
            let names: Vec<_> =
                circle.chain([path]).map(|path| path.display().to_string()).collect();
            return Err(format!("a scene places itself: {}", names.join(" > ")));
        }
        if self.open.len() >= MAX_DEPTH {
            return Err(format!("more than {MAX_DEPTH} scenes are placed within one another"));
        }
        self.open.push((path.to_owned(), real));
        Ok(())
    }

    /// Ends the innermost scene.
    pub fn close(&mut self) {
        self.open.pop();
    }

    /// Whether the scene that is being read is placed by another.
    pub fn is_within(&self) -> bool {
        self.open.len() > 1
    }
}
