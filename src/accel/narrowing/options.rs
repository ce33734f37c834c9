//! Options that structures with path compression share.

use crate::accel::{OptionSpec, Value, Values};

/// How paths are compressed.
pub const PC: OptionSpec = OptionSpec {
    name: "pc",
    summary: "how paths are compressed; both make the same tree",
    values: Values::Choice(&["iterative", "recursive"]),
    default: Value::Choice("iterative"),
};
