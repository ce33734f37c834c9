//! The rows of the table.

use super::packet_bvh::{PER_PACKET, PacketBvh, WITH, With};
use crate::accel::Variant;
use crate::accel::bvh::build::{BUILD, REFINE};
use crate::accel::bvh::leaves::{CACHE, TRIANGLES};
use crate::accel::narrowing::{PC, Start};
use crate::accel::packet::SIZE;

/// The row of packets.
pub const PACKET: Variant = Variant {
    id: "bvh-packet",
    summary: "bvh2's tree by packets of 16 by 16 rays: first active, early descent, shaft culling",
    paper: "Wald, Boulos and Shirley, Ray Tracing Deformable Scenes using Dynamic BVHs, 2007",
    options: &[BUILD, REFINE, TRIANGLES, CACHE, SIZE],
    build: |input| Ok(Box::new(PacketBvh::build(input, Start::Root, With::Packet)?)),
};

/// The row of partitioned packets.
pub const PARTITION: Variant = Variant {
    id: "bvh-partition",
    summary: "bvh2's tree by packets of 16 by 16 rays, partitioned at each node",
    paper: "Overbeck, Ramamoorthi and Mark, Large Ray Packets for Real-time Whitted Ray \
            Tracing, 2008",
    options: &[BUILD, REFINE, TRIANGLES, CACHE, SIZE],
    build: |input| Ok(Box::new(PacketBvh::build(input, Start::Root, With::Partition)?)),
};

/// The row of entry points.
pub const ENTRY_POINT: Variant = Variant {
    id: "bvh-entry-point",
    summary: "bvh-packet from the deepest node that holds all that a slice's shaft meets",
    paper: "Reshetov, Soupikov and Hurley, Multi-Level Ray Tracing Algorithm, 2005; Fowler 2009",
    options: &[BUILD, REFINE, TRIANGLES, CACHE, SIZE, WITH],
    build: |input| Ok(Box::new(PacketBvh::build(input, Start::EntryPoint, With::new(input))?)),
};

/// The row of path compression.
pub const PATH_COMPRESSION: Variant = Variant {
    id: "bvh-path-compression",
    summary: "packets over a tree of those nodes alone that a slice's shaft meets both sides of",
    paper: "Barczak, An Improved Multi-Level Raytracing Algorithm",
    options: &[BUILD, REFINE, TRIANGLES, CACHE, SIZE, WITH, PC, PER_PACKET],
    build: |input| {
        let chosen = |name: &str, word: &str| input.options.choice(name) == word;
        let start = Start::Compressed {
            recursive: chosen("pc", "recursive"),
            per_packet: chosen("per-packet", "on"),
        };
        Ok(Box::new(PacketBvh::build(input, start, With::new(input))?))
    },
};
