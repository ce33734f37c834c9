//! A picture: a frame, the part of it that is there, and float channels by name.

use super::FilmError;
use crate::math::DVec3;
use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

/// The layer of denoised colours.
pub const DENOISED: &str = "denoised";

/// A rectangle of pixels, absolute in the frame, y downwards; `x1` and `y1` are not included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Window {
    /// The leftmost column.
    pub x0: i32,
    /// The topmost row.
    pub y0: i32,
    /// One past the rightmost column.
    pub x1: i32,
    /// One past the bottommost row.
    pub y1: i32,
}

impl Window {
    /// The window of a whole frame.
    ///
    /// # Panics
    /// If a side does not fit an `i32`.
    pub fn of_size(width: usize, height: usize) -> Self {
        let side = |pixels| i32::try_from(pixels).expect("sides fit an i32");
        Self { x0: 0, y0: 0, x1: side(width), y1: side(height) }
    }

    /// Pixels per row; 0 if the window is empty.
    pub fn width(&self) -> usize {
        (i64::from(self.x1) - i64::from(self.x0)).max(0) as usize
    }

    /// The number of rows; 0 if the window is empty.
    pub fn height(&self) -> usize {
        (i64::from(self.y1) - i64::from(self.y0)).max(0) as usize
    }

    /// The number of pixels.
    pub fn area(&self) -> usize {
        self.width() * self.height()
    }
}

impl fmt::Display for Window {
    /// As `--crop` takes it: `x0,y0,x1,y1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{},{}", self.x0, self.y0, self.x1, self.y1)
    }
}

/// One channel of a picture: a float per pixel of the crop, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// `R`, `albedo.G`, `depth.Z`.
    pub name: String,
    /// The values.
    pub samples: Vec<f32>,
}

/// Named float channels over a part of a frame, and what is told of them in a file's header.
///
/// The colours are `R G B A`: linear Rec. 709, alpha associated (colours are already multiplied by
/// it). Other AOVs are prefixed: `albedo.R`, `normal.X`, `position.X`, `depth.Z`,
/// `variance.R` (of the pixel's mean), `samples.Y`, `cost.Y`, `denoised.R`.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The whole image plane: the display window of the file.
    pub frame: Window,
    /// The part that has pixels: the data window of the file.
    pub crop: Window,
    /// Header strings by name, such as `dapple/seed`.
    pub strings: BTreeMap<String, String>,
    channels: Vec<Channel>,
}

impl Picture {
    /// A picture without channels.
    ///
    /// # Examples
    /// ```
    /// use dapple::{Picture, Window};
    ///
    /// let frame = Window::of_size(2, 1);
    /// let mut picture = Picture::new(frame, frame);
    /// picture.set_channel("depth.Z", vec![1.5, f32::INFINITY]);
    /// assert_eq!(picture.channel("depth.Z"), Some(&[1.5, f32::INFINITY][..]));
    /// ```
    pub fn new(frame: Window, crop: Window) -> Self {
        Self { frame, crop, strings: BTreeMap::new(), channels: Vec::new() }
    }

    /// Pixels per row of the crop.
    pub fn width(&self) -> usize {
        self.crop.width()
    }

    /// Rows of the crop.
    pub fn height(&self) -> usize {
        self.crop.height()
    }

    /// The channels, sorted by name (by bytes, as OpenEXR files have them).
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The values of a channel, row by row.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        let index =
            self.channels.binary_search_by(|channel| channel.name.as_str().cmp(name)).ok()?;
        Some(&self.channels[index].samples)
    }

    /// Adds a channel, or replaces the one of that name.
    ///
    /// # Panics
    /// If `samples` is not one value per pixel of the crop.
    pub fn set_channel(&mut self, name: impl Into<String>, samples: Vec<f32>) {
        assert_eq!(samples.len(), self.crop.area(), "a channel has one sample per pixel");
        let name = name.into();
        match self.channels.binary_search_by(|channel| channel.name.cmp(&name)) {
            Ok(index) => self.channels[index].samples = samples,
            Err(index) => self.channels.insert(index, Channel { name, samples }),
        }
    }

    /// Adds an AOV of three channels: `albedo.R`, `albedo.G`, `albedo.B` for `"albedo"` and
    /// `suffixes` `RGB`. The colours are the AOV `""`, whose channels have no prefix.
    ///
    /// # Panics
    /// If `values` is not one value per pixel of the crop, or `suffixes` is not three letters.
    pub fn set_aov(&mut self, aov: &str, suffixes: &str, values: &[[f32; 3]]) {
        assert_eq!(suffixes.chars().count(), 3, "an AOV of vectors has three channels");
        for (axis, suffix) in suffixes.chars().enumerate() {
            let samples = values.iter().map(|value| value[axis]).collect();
            self.set_channel(channel_name(aov, suffix), samples);
        }
    }

    /// The three channels of an AOV, if all are there; see [`Picture::set_aov`].
    pub fn aov(&self, aov: &str, suffixes: &str) -> Option<Vec<[f32; 3]>> {
        let mut of_suffix = suffixes.chars().map(|suffix| self.channel(&channel_name(aov, suffix)));
        let (x, y, z) = (of_suffix.next()??, of_suffix.next()??, of_suffix.next()??);
        Some(x.iter().zip(y).zip(z).map(|((&x, &y), &z)| [x, y, z]).collect())
    }

    /// The colours: `R`, `G`, `B`, or luminance and chroma (`Y`, `RY`, `BY`) of Rec. 709, or `Y`
    /// thrice. `path` is for the message.
    ///
    /// # Errors
    /// [`FilmError::Invalid`] that lists the channels, if none of them is there.
    pub fn rgb(&self, path: &Path) -> Result<Vec<[f32; 3]>, FilmError> {
        self.rgb_by(DVec3::new(0.2126, 0.7152, 0.0722), path)
    }

    /// [`Picture::rgb`], where red, green and blue have other shares in the luminance.
    pub(super) fn rgb_by(&self, shares: DVec3, path: &Path) -> Result<Vec<[f32; 3]>, FilmError> {
        let invalid = |message: &str| Err(FilmError::invalid(path, message));
        if let Some(colours) = self.aov("", "RGB") {
            return Ok(colours);
        }
        let Some(grey) = self.channel("Y") else {
            return invalid(&no_colours(self.channels.iter().map(|it| it.name.as_str())));
        };
        if self.channel("X").is_some() && self.channel("Z").is_some() {
            return invalid(
                "the channels X, Y and Z are not supported: they may be a place as well as CIE \
                 XYZ; convert the file to R, G and B",
            );
        }
        if self.channel("X").is_some() {
            return invalid(
                "has X and Y and no Z: its colours cannot be told; convert the file to R, G and B",
            );
        }
        match (self.channel("RY"), self.channel("BY")) {
            (None, None) => Ok(grey.iter().map(|&y| [y; 3]).collect()),
            (Some(red), Some(blue)) => {
                let all = grey.iter().zip(red).zip(blue);
                Ok(all.map(|((&y, &ry), &by)| of_chroma([y, ry, by], shares)).collect())
            }
            (Some(_), None) => invalid("has RY and no BY: its colours cannot be told"),
            (None, Some(_)) => invalid("has BY and no RY: its colours cannot be told"),
        }
    }

    /// The colours to be looked at: those of the layer `denoised`, if it is there, or else
    /// [`Picture::rgb`].
    ///
    /// # Errors
    /// Those of [`Picture::rgb`].
    pub fn shown_rgb(&self, path: &Path) -> Result<Vec<[f32; 3]>, FilmError> {
        self.aov(DENOISED, "RGB").map_or_else(|| self.rgb(path), Ok)
    }

    /// Drops all channels for which `keep` is false.
    pub fn retain_channels(&mut self, keep: impl Fn(&str) -> bool) {
        self.channels.retain(|channel| keep(&channel.name));
    }
}

/// Red, green and blue of a luminance, and of (R - Y) / Y and (B - Y) / Y.
fn of_chroma([y, ry, by]: [f32; 3], shares: DVec3) -> [f32; 3] {
    let [y, ry, by] = [y, ry, by].map(f64::from);
    let (red, blue) = ((ry + 1.0) * y, (by + 1.0) * y);
    let green = (y - shares.x * red - shares.z * blue) / shares.y;
    [red, green, blue].map(|value| value as f32)
}

fn channel_name(aov: &str, suffix: char) -> String {
    if aov.is_empty() { suffix.to_string() } else { format!("{aov}.{suffix}") }
}

/// The message about an image without colours.
pub(super) fn no_colours<'a>(channels: impl Iterator<Item = &'a str>) -> String {
    let channels: Vec<_> = channels.collect();
    format!("no channels R, G, B and no Y; it has {}", channels.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn aovs_are_channels_by_name() {
        let mut picture =
            Picture::new(Window::of_size(4, 4), Window { x0: 1, y0: 2, x1: 3, y1: 3 });
        picture.set_aov("normal", "XYZ", &[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
        picture.set_aov("", "RGB", &[[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]);
        assert_eq!(picture.channel("normal.Y"), Some(&[2.0, 5.0][..]));
        let names: Vec<_> = picture.channels().iter().map(|it| it.name.as_str()).collect();
        assert_eq!(names, ["B", "G", "R", "normal.X", "normal.Y", "normal.Z"]);
        let colours = picture.rgb(Path::new("a")).expect("there");
        assert_eq!(colours, [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]);
        assert_eq!(picture.aov("albedo", "RGB"), None);
    }

    #[test]
    fn grey_pictures_have_colours_and_others_say_what_they_have() {
        let mut picture = Picture::new(Window::of_size(1, 1), Window::of_size(1, 1));
        picture.set_channel("Z", vec![1.0]);
        let error = picture.rgb(Path::new("a.exr")).expect_err("no colours");
        assert_eq!(error.to_string(), "a.exr: no channels R, G, B and no Y; it has Z");
        picture.set_channel("Y", vec![0.5]);
        assert_eq!(picture.rgb(Path::new("a.exr")).expect("grey"), [[0.5; 3]]);
    }

    #[test]
    fn denoised_colours_are_shown_and_those_without_are_kept() {
        let mut picture = Picture::new(Window::of_size(1, 1), Window::of_size(1, 1));
        picture.set_aov("", "RGB", &[[1.0; 3]]);
        let path = Path::new("a");
        assert_eq!(picture.shown_rgb(path).expect("there"), [[1.0; 3]]);
        picture.set_aov(DENOISED, "RGB", &[[0.5; 3]]);
        assert_eq!(picture.shown_rgb(path).expect("there"), [[0.5; 3]]);
        assert_eq!(picture.rgb(path).expect("there"), [[1.0; 3]]);
    }

    #[test]
    fn an_empty_window_has_no_pixels() {
        let window = Window { x0: i32::MIN, y0: 5, x1: i32::MAX, y1: 5 };
        assert_eq!((window.width(), window.height(), window.area()), (u32::MAX as usize, 0, 0));
    }
}
