//! The two forms of every BSDF: by glTF's letter, or conserving energy.

use crate::names::choices;

/// Whether a BSDF follows glTF's formulas to the letter, or conserves energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BsdfForm {
    /// glTF 2.0, Appendix B, with separable Smith shadowing. Gains energy at grazing angles and
    /// loses it on rough metal and rough glass.
    AppendixB,
    /// The same with compensation for multiple scattering, and with the opaque part below a
    /// dielectric scaled by what the coat lets through: white surfaces reflect all light.
    #[default]
    Conserving,
}

choices!(BsdfForm, "BSDF form", [AppendixB => "appendix-b", Conserving => "conserving"]);
