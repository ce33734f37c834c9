//! What structures for many rays share, whatever their trees: how a slice is cut into packets
//! (`cut`, `packets`), the rays of a packet and the tests of triangles by them (`rays`), trees
//! narrowed to a shaft (`hierarchy`, `entry`, `compress`, `narrow`), and what is done with rays that
//! do not run side by side.

mod compress;
mod cut;
mod entry;
mod hierarchy;
mod narrow;
mod packets;
mod rays;

#[cfg(test)]
pub use compress::Compression;
pub use entry::entry_point;
pub use hierarchy::{Branch, Branches, Hierarchy, Step};
pub use narrow::{Narrowing, Regions, Start, Started, Trees, View, Within};
pub use packets::{FEW, Packets, Plan, Pool, shoot_mixed, shoot_packets, shoot_singles};
pub use rays::{Ask, BUNDLES, Order, Rays};

use super::{OptionSpec, Value, Values};

/// The side of a packet.
pub const SIZE: OptionSpec = OptionSpec {
    name: "size",
    summary: "rays along a side of a packet, where the slice is a raster",
    values: Values::Integer(2, 16),
    default: Value::Integer(16),
};

/// How paths are compressed.
pub const PC: OptionSpec = OptionSpec {
    name: "pc",
    summary: "how paths are compressed; both make the same tree",
    values: Values::Choice(&["iterative", "recursive"]),
    default: Value::Choice("iterative"),
};
