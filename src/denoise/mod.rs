//! Denoising by Open Image Denoise, whose library is looked for when it is asked for.
//!
//! Nothing here is needed to build or to render: the library is opened by name at run time. The
//! denoised colours depend on the library's version and on the processor. They are the only layer
//! besides `cost` that does.
//!
//! | file | what it does |
//! |---|---|
//! | [`denoiser`] | adds the layer to a picture |
//! | `locate` | where the library may lie |
//! | `library` | the library's functions: the unsafe code |
//! | `error` | what may go wrong |

pub mod denoiser;
mod error;
mod library;
mod locate;

pub use denoiser::Denoiser;
pub use error::DenoiseError;
