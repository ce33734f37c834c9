//! A page that shows what `dapple golden check` has looked at: one HTML file that needs no other.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use crate::files::{self, Flush};
use crate::film::compare::{FlipKind, Named, compare};
use crate::film::golden::{Outcome, Pair, Verdict};
use crate::film::tonemap::Tonemap;
use crate::film::{FilmError, Picture, png};

const HEAD: &str = r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>dapple golden check</title>
<style>
body { font: 15px/1.4 system-ui, sans-serif; margin: 2rem; background: #fafafa; color: #222; }
section { margin: 2rem 0; }
h2 { font-size: 1.1rem; margin: 0 0 .3rem; }
.same { color: #17692b; }
.not { color: #a11; }
.row { display: flex; flex-wrap: wrap; gap: 1rem; }
figure { margin: 0; }
figcaption { font-size: .85rem; color: #555; }
img { image-rendering: pixelated; min-width: 256px; max-width: 100%; border: 1px solid #ccc; }
</style>
</head>
<body>
<h1>dapple golden check</h1>
<p>The map of FLIP is black where nobody would see a difference and pale yellow where everybody
would. Pictures are shown by AgX.</p>
"#;

/// The page, which grows scene by scene.
pub struct Page {
    path: PathBuf,
    html: String,
}

impl Page {
    /// An empty page in a folder, which is made where there is none.
    ///
    /// # Errors
    /// [`FilmError::Write`] if it could not be written there.
    pub fn new(folder: &Path) -> Result<Self, FilmError> {
        let path = folder.join("index.html");
        std::fs::create_dir_all(folder)
            .and_then(|()| files::probe(&path))
            .map_err(|source| FilmError::write(&path, source))?;
        Ok(Self { path, html: HEAD.to_owned() })
    }

    /// Adds a scene; `word` says what became of it.
    ///
    /// # Errors
    /// [`FilmError::Invalid`] if a picture has no colours.
    pub fn add(
        &mut self,
        outcome: &Outcome,
        word: &str,
        pair: Option<&Pair>,
    ) -> Result<(), FilmError> {
        let class = if outcome.verdict == Verdict::Same { "same" } else { "not" };
        let name = escape(&outcome.name);
        self.put(format_args!(
            "<section>\n<h2>{name}: <span class=\"{class}\">{word}</span></h2>\n"
        ));
        if let Some(figures) = &outcome.figures {
            let (off, flip, relmse) = (figures.pixels_off, figures.flip, figures.relmse);
            self.put(format_args!(
                "<p>pixels off {off:.6}, FLIP {flip:.6}, relMSE {relmse:.3e}</p>\n"
            ));
        }
        if !outcome.reason.is_empty() {
            let reason = escape(&outcome.reason);
            self.put(format_args!("<p>{reason}</p>\n"));
        }
        if let Some(Pair { picture, golden }) = pair {
            self.put(format_args!("<div class=\"row\">\n"));
            self.add_figure("rendered now", &encode_for_display(picture)?);
            self.add_figure("golden", &encode_for_display(golden)?);
            if let Some(map) = draw_flip_map(picture, golden)? {
                self.add_figure("FLIP", &map);
            }
            self.put(format_args!("</div>\n"));
        }
        self.put(format_args!("</section>\n"));
        Ok(())
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`FilmError::Write`].
    pub fn write(mut self) -> Result<(), FilmError> {
        self.put(format_args!("</body>\n</html>\n"));
        files::write(&self.path, Flush::ToDisk, |file| file.write_all(self.html.as_bytes()))
            .map_err(|source| FilmError::write(&self.path, source))
    }

    fn add_figure(&mut self, caption: &str, file: &[u8]) {
        let data = STANDARD.encode(file);
        self.put(format_args!(
            "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{data}\">\
             <figcaption>{caption}</figcaption></figure>\n"
        ));
    }

    /// Writing to a string cannot fail.
    fn put(&mut self, text: std::fmt::Arguments<'_>) {
        let _ = self.html.write_fmt(text);
    }
}

fn encode_for_display(picture: &Picture) -> Result<Vec<u8>, FilmError> {
    png::encode(Path::new("the picture"), picture, Tonemap::Agx, 0.0, None)
}

/// None where the two are of different sizes.
fn draw_flip_map(picture: &Picture, golden: &Picture) -> Result<Option<Vec<u8>>, FilmError> {
    let named = |path, picture| Named { path: Path::new(path), picture };
    let pictures = (named("the render", picture), named("the golden picture", golden));
    let found = match compare(pictures.0, pictures.1, FlipKind::Hdr) {
        Ok(found) => found,
        Err(FilmError::Sizes(..)) => return Ok(None),
        Err(error) => return Err(error),
    };
    let map = png::encode_rgb8(found.width, found.height, &found.heatmap());
    map.map(Some).map_err(|error| FilmError::invalid(pictures.0.path, error.to_string()))
}

/// Text as HTML shows it.
fn escape(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    text.replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_the_page() {
        assert_eq!(escape("a<b> & \"c\""), "a&lt;b&gt; &amp; &quot;c&quot;");
    }
}
