//! How the inside of a solid scatters light, as files describe it.

use super::{TextureRef, Volume};
use crate::math::Vec3;
use crate::medium::{Medium, single_scattering_albedo};
use crate::texture::TextureRange;

/// The least share of light that counts as what is left: an attenuation colour of 0 leaves so
/// much.
const LEAST: f32 = 1e-7;

/// KHR_materials_volume_scatter: how much of what a volume takes away of light it scatters, and
/// whereto.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattering {
    /// What is scattered, by colour.
    pub color: ScatterColor,
    /// Multiplies the colour; a medium is even, so that the mean of the texture counts.
    pub color_texture: Option<TextureRef>,
    /// Mean cosine of the angle of a scattering: 1 goes on, 0 goes anywhere, -1 goes back.
    pub anisotropy: f32,
}

/// A colour of scattering, and what it is the albedo of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScatterColor {
    /// What a dense solid returns after all scatterings: about the colour that it seems to have.
    All(Vec3),
    /// What one scattering leaves.
    One(Vec3),
}

impl Scattering {
    /// None at all, but for what is set later.
    pub const NONE: Self =
        Self { color: ScatterColor::All(Vec3::ZERO), color_texture: None, anisotropy: 0.0 };

    /// The medium in a volume that scatters so, where the texture's mean is `texture`.
    pub fn medium(&self, volume: &Volume, texture: Vec3) -> Medium {
        let albedo = match self.color {
            ScatterColor::All(color) => single_scattering_albedo(color * texture, self.anisotropy),
            ScatterColor::One(color) => color * texture,
        };
        Medium::new(extinction(volume), albedo, self.anisotropy)
    }

    /// The place for its texture, and what that may hold.
    pub(super) fn ranged_slot_mut(&mut self) -> (&mut Option<TextureRef>, TextureRange) {
        (&mut self.color_texture, TextureRange::Unit)
    }
}

/// What a volume takes away of light, per metre: what is left after the attenuation distance is
/// the attenuation colour.
fn extinction(volume: &Volume) -> Vec3 {
    let distance = volume.attenuation_distance;
    volume.attenuation_color.map(|color| -libm::logf(color.clamp(LEAST, 1.0)) / distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_volume_tells_how_dense_it_is() {
        let attenuation_color = Vec3::new(0.5, 1.0, 0.0);
        let volume = Volume { attenuation_color, attenuation_distance: 0.5 };
        let color = ScatterColor::One(Vec3::new(0.9, 0.8, 0.7));
        let scattering = Scattering { color, color_texture: None, anisotropy: 0.25 };
        let medium = scattering.medium(&volume, Vec3::splat(0.5));
        assert!((medium.transmittance(1.0).x - 0.25).abs() < 1e-6);
        assert_eq!(medium.transmittance(1.0).y, 1.0);
        assert!(medium.transmittance(1.0).z < 1e-12);
        assert_eq!(medium.albedo(), Vec3::new(0.45, 0.4, 0.35));
        let endless = Volume { attenuation_distance: f32::INFINITY, ..volume };
        assert!(!scattering.medium(&endless, Vec3::ONE).scatters());
    }
}
