//! Reads values from words, each within its range.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use clap::ValueEnum;
use clap::builder::PossibleValue;

use crate::film::Window;
use crate::formats::{MissingTexture, MtlTransparency};
use crate::light::Preetham;
use crate::math::Vec3;

/// A kind of camera that no scene file has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum CameraModel {
    /// All around: longitude across, latitude down, twice as wide as high.
    Panorama,
}

/// What lights the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum LightArg {
    /// The first of the following that lights what is seen.
    #[default]
    Auto,
    /// What the scene and the other flags have, and nothing else.
    File,
    /// That, under a neutral sky.
    Sky,
    /// That, and a lamp at the camera.
    Camera,
}

impl LightArg {
    /// The name by which it is chosen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::File => "file",
            Self::Sky => "sky",
            Self::Camera => "camera",
        }
    }
}

/// What to show in place of a texture that cannot be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MissingTextureArg {
    /// Bright magenta; what holds no colours is left out.
    Magenta,
}

impl MissingTextureArg {
    /// What readers of scenes are told.
    pub fn option(chosen: Option<Self>) -> MissingTexture {
        match chosen {
            Some(Self::Magenta) => MissingTexture::Magenta,
            None => MissingTexture::Error,
        }
    }
}

/// Whether textures are looked up in levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum TextureLod {
    /// In the images as they are.
    #[default]
    Off,
    /// In images as coarse as what is seen of them.
    On,
}

/// What `d` and `Tr` of a material of an OBJ file mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MtlTransparencyArg {
    /// Both are opacities; d counts first.
    D,
    /// Tr is a transparency and counts first.
    Tr,
    /// Tr is a transparency; d counts first.
    File,
}

impl MtlTransparencyArg {
    /// What readers of scenes are told.
    pub fn option(self) -> MtlTransparency {
        match self {
            Self::D => MtlTransparency::D,
            Self::Tr => MtlTransparency::Tr,
            Self::File => MtlTransparency::File,
        }
    }
}

/// How to report the progress of a render.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ProgressStyle {
    /// A bar on a terminal, else plain lines.
    #[default]
    Auto,
    /// A bar.
    Bar,
    /// A line every ten seconds.
    Plain,
    /// A JSON object every second.
    Json,
    /// Lines of Open Job Description every second.
    Openjd,
    /// Not at all.
    None,
}

/// The segment from which Russian roulette may end a path; `None`: it never does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RouletteDepth(pub Option<u32>);

/// A text that is no [`RouletteDepth`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("neither a number nor `off`")]
pub struct NoDepth;

impl FromStr for RouletteDepth {
    type Err = NoDepth;

    fn from_str(text: &str) -> Result<Self, NoDepth> {
        if text == "off" {
            return Ok(Self(None));
        }
        text.parse().map(|depth| Self(Some(depth))).map_err(|_| NoDepth)
    }
}

/// What [`FromStr`] reads, with the error as text.
pub(super) fn from_str<T: FromStr<Err: Display>>(text: &str) -> Result<T, String> {
    text.parse().map_err(|error: T::Err| error.to_string())
}

/// Values between commas.
pub(super) fn list<T: FromStr<Err: Display>>(text: &str) -> Result<Vec<T>, String> {
    text.split(',').map(from_str).collect()
}

/// One of the values that a help lists.
pub(super) fn choice<T: ValueEnum>(text: &str) -> Result<T, String> {
    T::from_str(text, false)
}

/// The values that a help lists.
pub(super) fn choices<T: ValueEnum>() -> Vec<PossibleValue> {
    T::value_variants().iter().filter_map(ValueEnum::to_possible_value).collect()
}

/// Whether a switch is on.
pub(super) fn switch(text: &str) -> Result<bool, String> {
    text.parse().map_err(|_| "is either given or not: true or false".to_owned())
}

/// A whole number within a range.
pub fn whole<T>(text: &str, range: RangeInclusive<T>) -> Result<T, String>
where
    T: FromStr + PartialOrd + Display,
{
    let (least, most) = (range.start(), range.end());
    let value: T =
        text.parse().map_err(|_| format!("expected a whole number from {least} to {most}"))?;
    if range.contains(&value) {
        Ok(value)
    } else {
        Err(format!("{value} is not from {least} to {most}"))
    }
}

/// A number, neither infinite nor NaN.
pub fn finite(text: &str) -> Result<f32, String> {
    let value: f32 = text.trim().parse().map_err(|_| format!("`{text}` is not a number"))?;
    if value.is_finite() { Ok(value) } else { Err(format!("{value} is not finite")) }
}

/// A number above zero.
pub(super) fn positive(text: &str) -> Result<f32, String> {
    let value = finite(text)?;
    if value > 0.0 { Ok(value) } else { Err("must be above zero".to_owned()) }
}

/// A number, zero or above.
pub(super) fn not_negative(text: &str) -> Result<f32, String> {
    let value = finite(text)?;
    if value >= 0.0 { Ok(value) } else { Err("must not be below zero".to_owned()) }
}

fn within(text: &str, range: RangeInclusive<f32>) -> Result<f32, String> {
    let value = finite(text)?;
    let (least, most) = (*range.start(), *range.end());
    if range.contains(&value) { Ok(value) } else { Err(format!("must be from {least} to {most}")) }
}

/// Of the air, in the range of the model of the sky.
pub(super) fn turbidity(text: &str) -> Result<f32, String> {
    within(text, Preetham::TURBIDITY)
}

/// Degrees above the horizon.
pub(super) fn elevation(text: &str) -> Result<f32, String> {
    within(text, 0.0..=90.0)
}

/// Degrees that a light is across.
pub(super) fn diameter(text: &str) -> Result<f32, String> {
    within(text, 0.0..=180.0)
}

/// Zero to one.
pub(super) fn share(text: &str) -> Result<f32, String> {
    within(text, 0.0..=1.0)
}

/// Degrees, below half a turn.
pub(super) fn field_of_view(text: &str) -> Result<f32, String> {
    let degrees = positive(text)?;
    if degrees < 180.0 { Ok(degrees) } else { Err("must be below 180 degrees".to_owned()) }
}

/// A number of threads; 0: one per core.
pub fn threads(text: &str) -> Result<usize, String> {
    let threads = text.parse().map_err(|_| "not a number of threads".to_owned())?;
    if threads <= 4096 { Ok(threads) } else { Err("4096 threads at most".to_owned()) }
}

fn numbers<const N: usize, T: FromStr>(text: &str, form: &str) -> Result<[T; N], String> {
    let parts: Vec<T> = text
        .split(',')
        .map(|part| part.trim().parse())
        .collect::<Result<_, _>>()
        .map_err(|_| format!("expected {form}"))?;
    parts.try_into().map_err(|_| format!("expected {form}"))
}

/// Three numbers between commas.
pub(super) fn vector(text: &str) -> Result<Vec3, String> {
    let vector = Vec3::from(numbers::<3, f32>(text, "three numbers, as in 0,1.5,-2")?);
    if vector.is_finite() { Ok(vector) } else { Err("a number is not finite".to_owned()) }
}

/// A direction: three numbers between commas, or the name of an axis.
pub(super) fn direction(text: &str) -> Result<Vec3, String> {
    let (sign, axis) = match text.trim().strip_prefix('-') {
        Some(axis) => (-1.0, axis),
        None => (1.0, text.trim().trim_start_matches('+')),
    };
    match axis {
        "x" | "X" => Ok(Vec3::X * sign),
        "y" | "Y" => Ok(Vec3::Y * sign),
        "z" | "Z" => Ok(Vec3::Z * sign),
        _ => vector(text),
    }
}

/// Two corners of a part of the frame.
pub(super) fn window(text: &str) -> Result<Window, String> {
    let [x0, y0, x1, y1] = numbers::<4, i32>(text, "four whole numbers: x0,y0,x1,y1")?;
    let window = Window { x0, y0, x1, y1 };
    if window.area() == 0 {
        return Err("the second corner must be to the right of and below the first".to_owned());
    }
    Ok(window)
}

/// Column, row and number of a sample.
pub(super) fn sample_id(text: &str) -> Result<(u32, u32, u64), String> {
    let [x, y, sample] = numbers::<3, u64>(text, "column, row and sample, as in 12,34,0")?;
    let side = |value: u64| u32::try_from(value).map_err(|_| "outside of any frame".to_owned());
    Ok((side(x)?, side(y)?, sample))
}

/// Sides of up to 65,536, with an `x` between them, or a comma as in TOML's `[640, 480]`. Beyond,
/// two pixels would share their random numbers.
pub fn resolution(text: &str) -> Result<(u32, u32), String> {
    const MOST_PIXELS: u64 = 1 << 28;
    let form = || "expected width and height in pixels, as in 640x480".to_owned();
    let (width, height) = text.split_once(['x', 'X', ',']).ok_or_else(form)?;
    let side = |text: &str| text.parse::<u32>().map_err(|_| form());
    let (width, height) = (side(width)?, side(height)?);
    if !(1..=65_536).contains(&width) || !(1..=65_536).contains(&height) {
        return Err("sides are 1 to 65536 pixels".to_owned());
    }
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(format!("{MOST_PIXELS} pixels at most"));
    }
    Ok((width, height))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_checked() {
        assert_eq!(resolution("640x480"), Ok((640, 480)));
        for wrong in ["640", "0x1", "1x65537", "65536x65536", "axb", "-1x3"] {
            assert!(resolution(wrong).is_err(), "{wrong}");
        }
        assert!(window("0,0,0,5").is_err());
        assert_eq!(window("1,2,3,4"), Ok(Window { x0: 1, y0: 2, x1: 3, y1: 4 }));
    }

    #[test]
    fn numbers_have_their_ranges() {
        assert_eq!((not_negative("0"), not_negative("2.5")), (Ok(0.0), Ok(2.5)));
        assert!(not_negative("-1").is_err() && not_negative("nan").is_err());
        assert!(positive("0").is_err() && field_of_view("180").is_err());
        assert!(threads("4097").is_err() && threads("-1").is_err());
    }

    #[test]
    fn directions_may_be_axes() {
        assert_eq!((direction("z"), direction("-Y")), (Ok(Vec3::Z), Ok(Vec3::NEG_Y)));
        assert_eq!(direction("0,-1,2"), Ok(Vec3::new(0.0, -1.0, 2.0)));
        assert!(direction("w").is_err() && direction("").is_err());
    }

    #[test]
    fn roulette_can_be_off() {
        assert_eq!("off".parse(), Ok(RouletteDepth(None)));
        assert_eq!("7".parse(), Ok(RouletteDepth(Some(7))));
        assert!("never".parse::<RouletteDepth>().is_err());
    }
}
