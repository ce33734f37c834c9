//! `bvh-packet`, `bvh-partition`, `bvh-entry-point`, `bvh-path-compression`: the binary hierarchy,
//! many rays at a time.
//!
//! A slice is cut into packets of up to 256 rays: blocks of its raster if it is one, runs of rays
//! otherwise (`accel::packet`, which packets through kd-trees share). A packet walks the tree of
//! `bvh2` together (`walk`): a node is fetched once for all its rays, and most decisions are made
//! once.
//!
//! `bvh-packet` follows I. Wald, S. Boulos and P. Shirley, "Ray tracing deformable scenes using
//! dynamic bounding volume hierarchies", 2007. A packet enters a box if its first active ray does,
//! skips it if the shaft around all rays misses it, and otherwise asks ray by ray until one enters;
//! all rays behind that one are carried along. Use it for primary rays, and for others that run
//! side by side among triangles not much smaller than the packet.
//!
//! `bvh-partition` follows R. Overbeck, R. Ramamoorthi and W. R. Mark, "Large ray packets for
//! real-time Whitted ray tracing", 2008. All rays are asked at each node, and those that do not
//! enter stay behind: more work near the root, less near the leaves. Use it where triangles are
//! small.
//!
//! `bvh-entry-point` and `bvh-path-compression` (`accel::narrowing`) follow A. Reshetov, A.
//! Soupikov and J. Hurley, "Multi-level ray tracing algorithm", 2005, and J. Barczak, "An improved
//! multi-level raytracing algorithm". The slice's own shaft goes through the tree first. Packets
//! then start at the deepest node that holds all that the shaft meets, or walk a tree of those
//! nodes alone where it meets something on either side. The trade: one walk of the shaft for each
//! slice, against every packet's way down to where the slice is. An entry point seldom lies deep; a
//! compressed tree saves nodes below it too, the more the larger the scene is beside the slice. Use
//! them for slices of many packets (`per-packet=on` with `with=partition`, as in the paper's table
//! 4). A tracer that has entered a region (a screen, what a light reaches) starts from what that
//! region meets: screen, tile, packet.
//!
//! The shaft of a raster of rays from one point is found from its corners, and a packet that does
//! not lie in it is walked from the root. The shaft of other slices is found from all their rays;
//! where that fails, the shaft of the batch is used if it holds the rays, and otherwise they start
//! at the root.
//!
//! Three things differ from all these papers. Rays are tested against boxes and triangles eight at
//! a time, as a *bundle*: the first bundle decides, and bundles are what is partitioned. Boxes are
//! held against planes around the packet (Reshetov et al. 2005, as Barczak does for path
//! compression), not tested by interval arithmetic; once all rays have hit something, the planes
//! are closed behind the last hit. And packets whose rays head different ways are split.
//!
//! Rays that do not run side by side are walked one by one, as by `bvh2`: packets whose slopes
//! differ by more than a half, and groups of fewer than four rays. Why the hits are brute force's:
//! each ray passes the slab test of the box of every leaf whose triangles it is tested against,
//! then a filter, then the exact test; and a box is skipped only if the slab test of each ray says
//! so, or the shaft, which never says so of a box that one of its rays would enter
//! ([`crate::geom::shaft`]).

mod packet_bvh;
mod place;
mod single;
mod slice;
#[cfg(test)]
mod tests;
mod variants;
mod walk;

pub use variants::{ENTRY_POINT, PACKET, PARTITION, PATH_COMPRESSION};
