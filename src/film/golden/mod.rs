//! Golden pictures: a folder of renders that later renders are held against.
//!
//! The folder holds `golden.toml` and EXR files:
//!
//! ```toml
//! render = ["--resolution", "128x128", "--spp", "64"]  # for all scenes
//!
//! [[scene]]
//! name = "cornell"
//! file = "../scenes/cornell.gltf"        # relative to this folder
//! render = ["--max-depth", "6"]          # after those for all
//! limits = { flip = 0.002 }              # else those of `limits` above, else the defaults
//! ```
//!
//! Who renders is for the caller to say: a [`RenderFn`].

mod check;
mod manifest;

pub use check::{Figures, Outcome, Pair, RenderError, RenderFn, Verdict, check, update};
pub use manifest::{GoldenScene, Limits, MANIFEST, Rule, load};
