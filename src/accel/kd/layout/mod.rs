//! Layouts: how nodes lie in memory. They know nothing of builds and traversals.

mod basic;
mod clustered;
mod compact;
mod nodes;
#[cfg(test)]
mod tests;
mod treelet;

pub use basic::Basic;
pub use clustered::Clustered;
pub use compact::{Compact, Packed};
pub use nodes::{Layout, Nodes, View};
pub use treelet::{Treelet, TreeletFilled};
