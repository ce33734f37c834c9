//! Options that structures for packets share.

use crate::accel::{OptionSpec, Value, Values};

/// The side of a packet.
pub const SIZE: OptionSpec = OptionSpec {
    name: "size",
    summary: "rays along a side of a packet, where the slice is a raster",
    values: Values::Integer(2, 16),
    default: Value::Integer(16),
};
