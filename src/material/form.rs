//! The two forms of every BSDF: by glTF's letter, or conserving energy.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// How faithful to glTF's letter, or to the conservation of energy, a BSDF is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BsdfForm {
    /// glTF 2.0, Appendix B, with separable Smith shadowing. Gains energy at grazing angles and
    /// loses it on rough metal and rough glass.
    AppendixB,
    /// The same with multiple scattering made up for, and the opaque part below a dielectric
    /// scaled by what the coat lets through: white surfaces reflect all light.
    #[default]
    Conserving,
}

impl BsdfForm {
    /// All, in the order of `--bsdf`'s help.
    pub const ALL: [Self; 2] = [Self::AppendixB, Self::Conserving];

    /// As `--bsdf` spells it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::AppendixB => "appendix-b",
            Self::Conserving => "conserving",
        }
    }
}

/// A name that is no [`BsdfForm`].
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("no bsdf form '{0}'; there are appendix-b and conserving")]
pub struct UnknownForm(String);

impl FromStr for BsdfForm {
    type Err = UnknownForm;

    fn from_str(name: &str) -> Result<Self, UnknownForm> {
        let found = Self::ALL.into_iter().find(|form| form.name() == name);
        found.ok_or_else(|| UnknownForm(name.to_owned()))
    }
}

impl fmt::Display for BsdfForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
