//! Where the copies of a `[[place]]` stand.

use glam::DAffine3;

use super::reader::Table;
use super::transform::transform;
use crate::formats::LoadError;
use crate::math::DVec3;

/// Where copies stand, as a place tells it; each is multiplied under the place's own transform.
pub enum Copies<'d> {
    /// There are none: the file stands where the place does.
    None,
    /// Here they are.
    Listed(Vec<DAffine3>),
    /// In a file, see [`CopiesFile`](crate::formats::copies::CopiesFile).
    InFile(&'d str),
}

impl<'d> Copies<'d> {
    /// Reads the key `copies` of a place.
    pub fn read(table: &Table<'d>) -> Result<Self, LoadError> {
        if !table.has("copies") {
            return Ok(Self::None);
        }
        if table.is_text("copies") {
            return Ok(Self::InFile(table.required_text("copies")?));
        }
        let stands = |copy: Result<[f64; 3], Table>| match copy {
            Ok(translate) => Ok(DAffine3::from_translation(DVec3::from_array(translate))),
            Err(table) => {
                let stands = transform(&table)?;
                table.finish()?;
                Ok(stands)
            }
        };
        table
            .points_or_tables("copies")?
            .into_iter()
            .map(stands)
            .collect::<Result<_, _>>()
            .map(Self::Listed)
    }
}
