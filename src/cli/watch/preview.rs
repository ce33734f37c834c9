//! The preview: a PNG of what there is so far.

use std::io::Write;
use std::path::PathBuf;

use crate::files::{self, Flush};
use crate::film::{FilmError, Picture, Tonemap, png};

/// Where a preview goes, and how it looks: as the PNG of the end does.
#[derive(Clone, Debug)]
pub struct Preview {
    /// The file.
    pub path: PathBuf,
    /// How light is shown.
    pub tonemap: Tonemap,
    /// By how many stops it is brightened.
    pub exposure: f32,
}

impl Preview {
    /// Writes it, with the label of the PNG of the end if it is that; whoever looks meanwhile sees
    /// the one before.
    ///
    /// # Errors
    /// [`FilmError::Write`]; [`FilmError::Invalid`] if the picture has no colours.
    pub fn write(&self, picture: &Picture, label: Option<&str>) -> Result<(), FilmError> {
        let path = &self.path;
        let bytes = png::encode(path, picture, self.tonemap, self.exposure, label)?;
        files::write(path, Flush::WhenIdle, |file| file.write_all(&bytes))
            .map_err(|source| FilmError::write(path, source))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Window;

    #[test]
    fn a_preview_looks_like_the_png_of_the_end() {
        let folder = tempfile::tempdir().expect("a folder");
        let window = Window::of_size(3, 2);
        let mut picture = Picture::new(window, window);
        picture.set_aov("", "RGB", &[[0.1, 0.2, 0.4]; 6]);
        let (path, end) = (folder.path().join("a.png"), folder.path().join("b.png"));
        std::fs::write(&path, "old").expect("written");
        let preview = Preview { path: path.clone(), tonemap: Tonemap::Agx, exposure: 1.5 };
        preview.write(&picture, None).expect("written");
        png::write(&end, &picture, Tonemap::Agx, 1.5, None).expect("written");
        assert_eq!(std::fs::read(&path).expect("there"), std::fs::read(&end).expect("there"));
        let preview = Preview { path: folder.path().join("no/a.png"), ..preview };
        assert_eq!(preview.write(&picture, None).expect_err("no folder").exit_code(), 4);
    }
}
