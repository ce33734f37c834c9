//! What must hold for BSDFs, by sampling them.

mod delta;
mod every_bsdf;
mod facets;
mod family;
mod lanes;
mod layers;
