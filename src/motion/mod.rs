//! How things move while the shutter is open.
//!
//! Time runs from 0, when the shutter opens, to 1, when it closes; each sample of a pixel has a
//! time of its own. What moves is a chain of transforms, of which some change: each has tracks of
//! its translation, rotation and scale, which are evaluated at the sample's time itself, in f64, so
//! that a wheel that turns stays round, however fast it turns.
//!
//! | file | what is in it |
//! |---|---|
//! | `track` | a value over time, piece by piece |
//! | `link` | a transform of a chain |
//! | `path` | a chain of transforms over time |
//! | `frame` | what goes along with what |
//! | `course` | the same prepared, where one link moves |
//! | `sincos` | sine and cosine of small angles |
//! | `rigid` | what is left of a transform of something without size |
//! | `pieces` | how fast that moves at most, and so which boxes hold it |

mod course;
mod frame;
mod link;
mod path;
mod pieces;
mod rigid;
mod sincos;
mod track;

pub use frame::Frame;
pub use link::{Link, MovingParts};
pub use path::Motion;
pub use pieces::Piece;
pub use rigid::rigid;
pub use track::{Track, Value};
