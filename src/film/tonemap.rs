//! Linear light to display values.

use crate::math::{Mat3, Vec3};
use crate::names::choices;

/// How linear Rec. 709 becomes what a display is sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Tonemap {
    /// T. Sobotka's AgX, as fitted by B. Wrensch, "Minimal AgX Implementation", 2022 (base look):
    /// highlights lose their colour gradually instead of being cut off channel by channel.
    #[default]
    Agx,
    /// Clamped to `[0, 1]`, then the transfer function of IEC 61966-2-1: for measuring, and for
    /// pictures that are in range already.
    Srgb,
}

choices!(Tonemap, "tone map", [Agx => "agx", Srgb => "srgb"]);

impl Tonemap {
    /// Display values in `[0, 1]` of a linear Rec. 709 colour. NaN becomes black.
    pub fn apply(self, linear: Vec3) -> Vec3 {
        let linear =
            Vec3::from_array(linear.to_array().map(|it| if it.is_nan() { 0.0 } else { it }));
        match self {
            Self::Agx => agx(linear),
            Self::Srgb => Vec3::from_array(linear.to_array().map(srgb_from_linear)),
        }
    }
}

/// The sRGB transfer function (IEC 61966-2-1) of a value that is clamped to `[0, 1]` first.
pub fn srgb_from_linear(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * libm::powf(linear, 1.0 / 2.4) - 0.055
    }
}

/// The inverse of [`srgb_from_linear`].
pub fn linear_from_srgb(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.040_45 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}

fn agx(linear: Vec3) -> Vec3 {
    /// Rec. 709 to AgX's inset primaries, and back.
    const INSET: Mat3 = Mat3::from_cols_array(&[
        0.842_479_06,
        0.042_328_242,
        0.042_375_656, //
        0.078_433_6,
        0.878_468_64,
        0.078_433_6, //
        0.079_223_745,
        0.079_166_13,
        0.879_143,
    ]);
    const OUTSET: Mat3 = Mat3::from_cols_array(&[
        1.196_879,
        -0.052_896_85,
        -0.052_971_635, //
        -0.098_020_88,
        1.151_903_1,
        -0.098_043_45, //
        -0.099_029_74,
        -0.098_961_18,
        1.151_073_7,
    ]);
    /// The stops around middle grey (0.18) that the curve maps: -10 to +6.5.
    const STOPS: (f32, f32) = (-12.473_93, 4.026_069);

    // Beyond 2^64 all is white anyway, and infinities would become NaN in the matrix.
    let inset = INSET * linear.clamp(Vec3::ZERO, Vec3::splat(1.8e19));
    let curve = |value: f32| {
        let stops = libm::log2f(value.max(1e-10)).clamp(STOPS.0, STOPS.1);
        let x = (stops - STOPS.0) / (STOPS.1 - STOPS.0);
        // Horner's form of Wrensch's sixth-order fit of the default contrast.
        (((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x + 0.1191) * x - 0.00232
    };
    let contrast = Vec3::new(curve(inset.x), curve(inset.y), curve(inset.z));
    // Already encoded for a display: no transfer function follows.
    (OUTSET * contrast).clamp(Vec3::ZERO, Vec3::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_is_the_standard() {
        // Values of the IEC formula; 0.2140 is the usual "half as bright to the eye".
        for (linear, display) in [(0.0, 0.0), (0.002, 0.02584), (0.2140411, 0.5), (1.0, 1.0)] {
            assert!((srgb_from_linear(linear) - display).abs() < 1e-6, "{linear}");
            assert!((linear_from_srgb(display) - linear).abs() < 1e-6, "{display}");
        }
        let clamped = Tonemap::Srgb.apply(Vec3::new(-1.0, f32::INFINITY, f32::NAN));
        assert!(clamped.abs_diff_eq(Vec3::Y, 1e-6), "{clamped}");
    }

    #[test]
    fn agx_maps_greys_to_greys_and_rises() {
        let mut last = -1.0;
        for step in -48..=24 {
            let grey = 0.18 * libm::exp2f(step as f32 / 4.0);
            let display = Tonemap::Agx.apply(Vec3::splat(grey));
            assert!((display.x - display.y).abs() < 2e-3 && (display.y - display.z).abs() < 2e-3);
            assert!(display.y >= last - 2e-4, "{grey}: {display} after {last}");
            last = display.y;
        }
        // Middle grey is the pivot of the curve, where the display value is a half.
        let middle = Tonemap::Agx.apply(Vec3::splat(0.18)).y;
        assert!((middle - 0.5).abs() < 5e-3, "{middle}");
    }

    #[test]
    fn agx_whitens_bright_colours_and_takes_any_float() {
        let bright = Tonemap::Agx.apply(Vec3::new(200.0, 0.0, 0.0));
        assert!(bright.y > 0.3 && bright.x > bright.y, "{bright}");
        for extreme in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN, f32::MAX, -1.0] {
            let display = Tonemap::Agx.apply(Vec3::new(extreme, 1.0, extreme));
            assert!(display.is_finite() && display.min_element() >= 0.0, "{extreme}: {display}");
        }
    }

    #[test]
    fn words_name_tone_maps() {
        for tonemap in Tonemap::ALL {
            assert_eq!(tonemap.to_string().parse(), Ok(tonemap));
        }
        assert!("aces".parse::<Tonemap>().is_err());
    }
}
