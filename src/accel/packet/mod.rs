//! Packets: many rays that walk a structure together, whatever its tree.
//!
//! A slice is cut into packets ([`layout`]), each of which is handed to a walk, ray by ray where
//! its rays do not run side by side ([`trace`]). The rays of a packet are kept in bundles, eight to
//! a vector ([`rays`]).

mod layout;
mod options;
mod rays;
mod trace;

pub use layout::PacketLayout;
pub use options::SIZE;
pub use rays::{BUNDLES, EnteredRays, PacketContext, PacketRays};
pub use trace::{
    FEW, Plan, RayLists, WalkPacket, trace_mixed_packets, trace_packets, trace_singles,
};
