//! Surroundings that the command line asks for: a colour, or a latitude-longitude image.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::LoadError;
use super::environment_image::EnvironmentImage;
use super::environment_repair::NotFinite;
use crate::light::Environment;
use crate::math::Vec3;
use crate::scene::Notice;

/// What `--env` asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentSource {
    /// The same linear radiance from everywhere.
    Constant(Vec3),
    /// An image, of any format that textures may have but KTX2.
    File(PathBuf),
}

/// A text that is neither a colour nor the name of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a colour is three finite numbers, red, green and blue, none below zero, as in 0.5,0.6,1; nor \
     is it a file"
)]
pub struct NeitherColorNorFile;

impl FromStr for EnvironmentSource {
    type Err = NeitherColorNorFile;

    /// Three numbers between commas, not negative, are a colour; all else is a file, unless it is
    /// numbers and there is none of that name.
    fn from_str(text: &str) -> Result<Self, NeitherColorNorFile> {
        let numbers: Option<Vec<f32>> =
            text.split(',').map(|word| word.trim().parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[r, g, b]) if [r, g, b].iter().all(|v| v.is_finite() && *v >= 0.0) => {
                Ok(Self::Constant(Vec3::new(r, g, b)))
            }
            Some(_) if !Path::new(text).exists() => Err(NeitherColorNorFile),
            _ => Ok(Self::File(text.into())),
        }
    }
}

impl EnvironmentSource {
    /// The environment, times `scale`, turned by `rotate_degrees` as [`Environment::image`] tells;
    /// and what is odd about the file.
    ///
    /// # Errors
    /// As [`EnvironmentImage::read`].
    pub fn load(
        &self,
        scale: f32,
        rotate_degrees: f32,
        not_finite: NotFinite,
    ) -> Result<(Environment, Vec<Notice>), LoadError> {
        match self {
            Self::Constant(radiance) => Ok((Environment::constant(*radiance * scale), Vec::new())),
            Self::File(path) => {
                let (image, notices) = EnvironmentImage::read(path, not_finite)?;
                let EnvironmentImage { width, height, pixels } = image;
                let environment = Environment::image(width, height, pixels, scale, rotate_degrees);
                Ok((environment, notices))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_numbers_are_a_colour() {
        let parsed = |text: &str| text.parse::<EnvironmentSource>();
        let color = EnvironmentSource::Constant(Vec3::new(0.5, 1.0, 2.0));
        assert_eq!(parsed("0.5,1, 2"), Ok(color));
        assert_eq!(parsed("a.hdr"), Ok(EnvironmentSource::File("a.hdr".into())));
        for slip in ["1,2", "1,2,3,4", "-1,0,0", "nan,0,0", "1e99,0,0", "1"] {
            let message = parsed(slip).expect_err("neither a colour nor a file").to_string();
            assert!(message.starts_with("a colour is three"), "{message}");
        }
        let file = parsed("a,b").expect("the name of a file");
        let error =
            file.load(1.0, 0.0, NotFinite::Refuse).map(drop).expect_err("there is no such file");
        assert_eq!(error.to_string(), "a,b: no such file, nor is it a colour as R,G,B");
    }
}
