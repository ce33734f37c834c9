//! What a `[[place]]` says.

use std::path::PathBuf;

use glam::DAffine3;

use super::copies::Copies;
use super::material::Overrides;
use super::reader::Table;
use super::transform::transform;
use crate::formats::{LoadError, LoadOptions};

/// A file, where it stands and what is changed of it.
pub struct Placement<'d> {
    /// For messages.
    pub table: Table<'d>,
    /// The file, as the scene spells it.
    pub name: &'d str,
    scene: Option<String>,
    variant: Option<String>,
    animation: Option<String>,
    time: Option<f32>,
    /// Where it stands, or all of its copies do.
    pub to_world: DAffine3,
    /// Where its copies stand within that.
    pub copies: Copies<'d>,
    /// What is changed of its materials.
    pub overrides: Overrides,
}

/// What of a file is loaded: its path, one of its scenes, one of its variants, one of its
/// animations, the bits of the time that it is posed at, and whether it stands still there.
pub type Part = (PathBuf, [Option<String>; 3], Option<u32>, bool);

impl<'d> Placement<'d> {
    pub fn read(table: Table<'d>) -> Result<Self, LoadError> {
        let name = table.required_text("file")?;
        let owned = |key| Ok::<_, LoadError>(table.text(key)?.map(str::to_owned));
        let (scene, variant) = (owned("scene")?, owned("variant")?);
        let animation = owned("animation")?;
        let time = table.number_in("time", -f32::MAX..=f32::MAX)?;
        let (to_world, copies) = (transform(&table)?, Copies::read(&table)?);
        let overrides = match table.table("material")? {
            Some(tables) => Overrides::read(&tables)?,
            None => Overrides::default(),
        };
        table.finish()?;
        Ok(Self { table, name, scene, variant, animation, time, to_world, copies, overrides })
    }

    /// What of its file is loaded, under the options of the scene that places it.
    pub fn part(&self, path: PathBuf, options: &LoadOptions) -> Part {
        let time = self.time.or(options.time).map(f32::to_bits);
        let names = [&self.scene, &self.variant, &self.animation].map(Clone::clone);
        (path, names, time, self.time.is_some())
    }

    /// How its file is loaded, under the options of the scene that places it.
    pub fn options(&self, options: &LoadOptions) -> LoadOptions {
        LoadOptions {
            strict: false,
            scene: self.scene.clone(),
            variant: self.variant.clone(),
            animation: self.animation.clone(),
            time: self.time.or(options.time),
            // What has a time of its own stands still.
            shutter: options.shutter.filter(|_| self.time.is_none()),
            ..options.clone()
        }
    }
}
