//! Libraries of materials (MTL) that an OBJ file names.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::mtl::MtlMaterial;
use super::paths::confine;
use super::remarks::Remarks;
use super::{lines, mtl};
use crate::formats::{LoadError, read_file};
use crate::scene::Notice;

/// All materials of the libraries read so far.
pub(super) struct Libraries<'a> {
    scene: &'a Path,
    folder: &'a Path,
    read: HashSet<PathBuf>,
    /// By name, with the file that they stand in.
    pub materials: HashMap<String, (PathBuf, MtlMaterial)>,
    pub notices: Vec<Notice>,
}

impl<'a> Libraries<'a> {
    /// None yet, of a scene in a folder.
    pub fn new(scene: &'a Path, folder: &'a Path) -> Self {
        let (materials, notices) = (HashMap::new(), Vec::new());
        Self { scene, folder, read: HashSet::new(), materials, notices }
    }

    /// Loads what a `mtllib` statement names: one file whose name may hold spaces, or several.
    pub fn load(
        &mut self,
        names: &str,
        line: usize,
        remarks: &mut Remarks,
    ) -> Result<(), LoadError> {
        let whole = lines::unquote(names);
        let names = match confine(self.folder, whole) {
            Some(path) if path.is_file() => vec![whole.to_owned()],
            _ => lines::names(names),
        };
        for name in names {
            let problem = match confine(self.folder, &name) {
                Some(path) if path.is_file() => {
                    self.read(&path)?;
                    continue;
                }
                Some(_) => "is missing",
                None => "is not read: it leaves the scene's folder",
            };
            let instead = self.load_namesake()?;
            remarks.add(line, format!("material library {name:?} {problem}{instead}"));
        }
        Ok(())
    }

    /// Loads the library that is called like the scene, as a last resort; says so, if it is there.
    pub fn load_namesake(&mut self) -> Result<String, LoadError> {
        let path = self.scene.with_extension("mtl");
        if !path.is_file() {
            return Ok(String::new());
        }
        self.read(&path)?;
        Ok(format!("; {} is used instead", path.display()))
    }

    fn read(&mut self, path: &Path) -> Result<(), LoadError> {
        if !self.read.insert(path.to_path_buf()) {
            return Ok(());
        }
        let mut remarks = Remarks::new(path);
        for material in mtl::parse(&read_file(path)?, path, &mut remarks)? {
            if self.materials.contains_key(&material.name) {
                let name = &material.name;
                remarks.add(material.line, format!("material {name:?} again: the first counts"));
                continue;
            }
            self.materials.insert(material.name.clone(), (path.to_path_buf(), material));
        }
        self.notices.append(&mut remarks.finish());
        Ok(())
    }
}
