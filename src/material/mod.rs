//! How surfaces scatter light: a closed set of BSDFs over resolved parameters.
//!
//! Directions are unit vectors of a local frame whose Z is the shading normal. `wo` points towards
//! the viewer, `wi` towards the light. `wo.z < 0` is a hit from behind: opaque surfaces scatter
//! alike on both sides; for a dielectric it means inside.
//!
//! Everything that transports radiance across a boundary scales it by the square of the relative
//! index of refraction (Veach, PhD thesis 1997, 5.2), so these are BSDFs for paths from the camera.
//!
//! | file | what it holds |
//! |---|---|
//! | `params`, `layers`, `form` | what a material is at a point |
//! | `bsdf`, `base`, `layered` | the BSDF: which lobes the parameters make |
//! | `lambert`, `metallic_roughness`, `translucent`, `anisotropic` | bases |
//! | `dielectric`, `mixed`, `filmed` | bases that are clear, wholly or in part |
//! | `clearcoat`, `sheen` | layers |
//! | `boundary`, `rough_dielectric`, `glass_multiple` | glass, smooth and rough |
//! | `ggx`, `anisotropic_ggx`, `fresnel`, `thin_film`, `dispersion` | what lobes are made of |
//! | `facets`, `facet_walk` | any of them on the two facets that a shading normal stands for |
//! | `lanes` | bases in lanes, for many paths at once |
//! | `layer_base`, `cover` | what lies below layers; what lies on glass |
//! | `layer_energy`, `layer_losses`, `layer_columns` | what is lost under layers and comes back |
//! | `layer_solids`, `layer_glass` | the same of solids that light passes |
//! | `energy`, `glass_energy`, `anisotropic_energy` | albedos, by which energy is conserved |

mod anisotropic;
mod anisotropic_energy;
mod anisotropic_ggx;
mod base;
mod boundary;
mod bsdf;
mod clearcoat;
mod cover;
mod dielectric;
mod dispersion;
mod energy;
mod facet_walk;
mod facets;
mod filmed;
mod form;
mod fresnel;
mod ggx;
mod glass_energy;
mod glass_multiple;
mod lambert;
pub mod lanes;
mod layer_base;
mod layer_columns;
mod layer_energy;
mod layer_glass;
mod layer_losses;
mod layer_solids;
mod layered;
mod layers;
mod metallic_roughness;
mod mixed;
mod params;
mod rough_dielectric;
mod sample;
mod sheen;
#[cfg(test)]
mod tests;
mod thin_film;
mod translucent;

pub use base::BaseBsdf;
pub use bsdf::Bsdf;
pub use dielectric::Dielectric;
pub use dispersion::Wavelength;
pub use facet_walk::{FacetNumbers, FacetSample, MOST_SCATTERINGS, OnFacet};
pub use facets::Facets;
pub use form::BsdfForm;
pub use lambert::Lambert;
pub use layered::Layered;
pub use layers::Layers;
pub use metallic_roughness::MetallicRoughness;
pub use mixed::Mixed;
pub use params::SurfaceParams;
pub use sample::BsdfSample;
pub use translucent::Translucent;
