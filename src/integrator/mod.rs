//! What light a path brings back.
//!
//! `path` is the algorithm of path tracing, one vertex at a time: a ray and what it hit go in, the
//! shadow ray to a light and the ray to go on with come out. Who traces them, and how many
//! together, is decided one floor up, in [`mod@crate::render`].
//!
//! | file | what it does |
//! |---|---|
//! | `path` | the steps of a vertex, in order |
//! | `lanes` | the same steps for many paths at once |
//! | `shadow_rays` | the shadow rays of a slice |
//! | `state` | what a path carries, and what goes in and out |
//! | `cone` | how wide a path is, for the levels of textures |
//! | `first_hit` | what the camera sees, apart from its light |
//! | `light` | emission, the environment and sampled lights, weighed |
//! | `mis` | multiple importance sampling: the power heuristic |
//! | `russian_roulette` | ends paths of little throughput |
//! | `medium` | a vertex in a medium, and how far paths fly in it |
//! | `transit` | light that comes through borders which do not bend it |
//! | `faceted` | a vertex on facets that a shading normal stands for |
//! | `crossing` | whether light crosses a surface |
//! | `nested_dielectrics`, `interior`, `borders` | the solids that a path is inside of |
//! | `dimensions` | which random numbers are used where |

mod borders;
mod cone;
mod crossing;
mod dimensions;
mod faceted;
mod first_hit;
mod interior;
mod lanes;
mod leaving;
mod light;
mod medium;
mod mis;
mod nested_dielectrics;
mod path;
mod russian_roulette;
mod shadow_rays;
mod state;
mod transit;

pub use dimensions::{LENS_DIMENSION, PIXEL_DIMENSION, TIME_DIMENSION};
pub use interior::Interior;
pub use lanes::{Vertices, add_environment_in_lanes, shade_in_lanes};
pub use medium::interior_at;
pub use path::{PathTracer, Transport};
pub use shadow_rays::{ShadowEnd, ShadowRays, Transits};
pub use state::{FirstHit, Path, PathSample, ShadowRay, Step};
pub use transit::Transit;
