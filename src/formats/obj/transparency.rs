//! What `d` and `Tr` of a material library mean, on which writers do not agree.
//!
//! `d` is the opacity, from 0 to 1, and `Tr` is 1 - `d`; but old exporters wrote `Tr 1` for what is
//! opaque. Where all of a model would be invisible by the first reading, the second was meant.

use super::mtl::MtlMaterial;
use crate::formats::MtlTransparency;

/// How opacities of a file are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    /// As someone has said.
    Told(MtlTransparency),
    /// Neither `d` nor `Tr` counts.
    Opaque,
}

impl Reading {
    /// The opacity of a material, as it is told: perhaps not from 0 to 1.
    pub fn opacity(self, mtl: &MtlMaterial) -> f32 {
        let clear = mtl.tr.map(|tr| 1.0 - tr);
        let told = match self {
            Self::Told(MtlTransparency::File) => mtl.d.or(clear),
            Self::Told(MtlTransparency::D) => mtl.d.or(mtl.tr),
            Self::Told(MtlTransparency::Tr) => clear.or(mtl.d),
            Self::Opaque => None,
        };
        told.unwrap_or(1.0)
    }
}
