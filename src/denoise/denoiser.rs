//! Adds denoised colours to a picture.

use std::ffi::CStr;
use std::path::{Path, PathBuf};

use super::error::DenoiseError;
use super::library::Device;
use super::locate::{Candidate, Surroundings};
use crate::film::Picture;
use crate::film::picture::DENOISED;

/// Open Image Denoise, found and ready.
pub struct Denoiser {
    device: Device,
}

/// An image of the library, by its name there.
type Image<'a> = (&'static CStr, &'a [[f32; 3]]);

impl Denoiser {
    /// Finds the library and prepares it for so many threads; 0: one per core.
    ///
    /// It is the file, or lies in the folder, that the environment variable `DAPPLE_OIDN` names.
    /// Without that, it is where the system's loader looks for libraries, or in the Python package
    /// `pyoidn` of the active environment, of the first `python3` on the path, or of the user.
    ///
    /// # Errors
    /// All but [`DenoiseError::Failed`] and [`DenoiseError::Picture`].
    pub fn find(threads: usize) -> Result<Self, DenoiseError> {
        Self::find_among(&Surroundings::of_process(), threads)
    }

    fn find_among(surroundings: &Surroundings, threads: usize) -> Result<Self, DenoiseError> {
        let mut first = None;
        for candidate in surroundings.candidates()? {
            let (path, is_file) = match candidate {
                Candidate::Name(name) => (PathBuf::from(name), false),
                Candidate::File(file) => (file, true),
            };
            match Device::open(&path, threads) {
                Ok(device) => return Ok(Self { device }),
                // What the loader does not find by name is no library that fails.
                Err(message) if is_file => {
                    first.get_or_insert(DenoiseError::Unusable { path, message });
                }
                Err(_) => {}
            }
        }
        Err(first.unwrap_or(DenoiseError::Absent))
    }

    /// The library with its version, as in `Open Image Denoise 2.5.1`.
    pub fn name(&self) -> String {
        let [major, minor, patch] = self.device.version();
        format!("Open Image Denoise {major}.{minor}.{patch}")
    }

    /// Adds the layer `denoised` to a picture, made of its colours and, if they are there, of its
    /// layers `albedo` and `normal`, which are denoised first. The header says with what. All other
    /// layers stay as they are.
    ///
    /// Alpha counts as it does for the colours, which are multiplied by it. Where nothing is, no
    /// light is added. Colours that are not finite count as black.
    ///
    /// # Errors
    /// [`DenoiseError::Picture`] without colours, with `path` to name the picture;
    /// [`DenoiseError::Failed`].
    pub fn denoise(&self, picture: &mut Picture, path: &Path) -> Result<(), DenoiseError> {
        let size = (picture.width(), picture.height());
        let mut colours = picture.rgb(path)?;
        clamp(&mut colours, 0.0, f32::MAX);
        let aux = |layer, suffixes, name, least| {
            let Some(mut noisy) = picture.aov(layer, suffixes) else { return Ok(None) };
            clamp(&mut noisy, least, 1.0);
            self.filter(size, &[(name, &noisy)], &[]).map(Some)
        };
        let albedo = aux("albedo", "RGB", c"albedo", 0.0)?;
        // The library takes no normals without an albedo.
        let normal = if albedo.is_some() { aux("normal", "XYZ", c"normal", -1.0)? } else { None };

        let mut images: Vec<Image> = vec![(c"color", &colours)];
        images.extend(albedo.as_deref().map(|pixels| (c"albedo", pixels)));
        images.extend(normal.as_deref().map(|pixels| (c"normal", pixels)));
        let flags = if albedo.is_some() { &[c"hdr", c"cleanAux"][..] } else { &[c"hdr"] };
        let mut clean = self.filter(size, &images, flags)?;
        clear_nothing(&mut clean, &colours, picture.channel("A"));
        picture.set_aov(DENOISED, "RGB", &clean);
        picture.strings.insert("dapple/denoise".to_owned(), self.name());
        Ok(())
    }

    fn filter(
        &self,
        size: (usize, usize),
        images: &[Image<'_>],
        flags: &[&'static CStr],
    ) -> Result<Vec<[f32; 3]>, DenoiseError> {
        let mut output = vec![[0.0; 3]; size.0 * size.1];
        self.device.filter(size, images, flags, &mut output).map_err(DenoiseError::Failed)?;
        Ok(output)
    }
}

/// Limits values to `least..=most`. A pixel with a value that is not finite is black.
fn clamp(pixels: &mut [[f32; 3]], least: f32, most: f32) {
    for pixel in pixels {
        let finite = pixel.iter().all(|value| value.is_finite());
        *pixel = if finite { pixel.map(|value| value.clamp(least, most)) } else { [0.0; 3] };
    }
}

/// Makes pixels black that are black and have no alpha.
fn clear_nothing(clean: &mut [[f32; 3]], noisy: &[[f32; 3]], alphas: Option<&[f32]>) {
    for ((clean, noisy), &alpha) in clean.iter_mut().zip(noisy).zip(alphas.unwrap_or_default()) {
        if alpha <= 0.0 && *noisy == [0.0; 3] {
            *clean = [0.0; 3];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said where the library is not as it should be.
    fn error(surroundings: &Surroundings) -> DenoiseError {
        match Denoiser::find_among(surroundings, 1) {
            Ok(found) => panic!("there is {}", found.name()),
            Err(error) => error,
        }
    }

    #[test]
    fn a_file_that_is_no_library_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("oidn.so");
        std::fs::write(&file, b"text").expect("written");
        let error = error(&Surroundings { chosen: Some(file.clone()), ..Default::default() });
        assert_eq!(error.exit_code(), 3);
        assert!(error.to_string().starts_with(&format!("{}: ", file.display())), "{error}");
    }

    #[test]
    fn an_absent_library_comes_with_how_to_get_it() {
        let text = DenoiseError::Absent.to_string();
        assert!(text.contains("pip install pyoidn") && text.contains("DAPPLE_OIDN"), "{text}");
        assert_eq!(DenoiseError::Absent.exit_code(), 3);
    }

    #[test]
    fn what_the_library_is_given_is_finite_and_in_range() {
        let mut pixels = [[0.5, -1.0, 7.0], [f32::NAN, 1.0, 1.0], [1.0, f32::INFINITY, 1.0]];
        clamp(&mut pixels, 0.0, 1.0);
        assert_eq!(pixels, [[0.5, 0.0, 1.0], [0.0; 3], [0.0; 3]]);
    }

    #[test]
    fn no_light_is_added_where_nothing_is() {
        let noisy = [[0.0; 3], [0.0; 3], [0.1; 3]];
        let mut clean = [[0.2; 3]; 3];
        clear_nothing(&mut clean, &noisy, Some(&[0.0, 0.5, 0.0]));
        assert_eq!(clean, [[0.0; 3], [0.2; 3], [0.2; 3]]);
        clear_nothing(&mut clean, &noisy, None);
        assert_eq!(clean[1], [0.2; 3]);
    }
}
