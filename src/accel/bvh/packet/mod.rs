//! `bvh-packet`, `bvh-partition`, `bvh-entry-point`, `bvh-path-compression`: the binary hierarchy,
//! many rays at a time.
//!
//! A slice is cut into packets of up to 256 rays: blocks of its raster where it is one, runs of
//! rays where it is not (`accel::packet`, which packets through kd-trees share). A packet walks the
//! tree of `bvh2` together (`walk`), so that a node is fetched once for all of its rays and most
//! decisions are made once.
//!
//! `bvh-packet`: I. Wald, S. Boulos and P. Shirley, "Ray tracing deformable scenes using dynamic
//! bounding volume hierarchies", 2007. A box is entered if the first ray that was under way enters
//! it, passed by if the shaft around all does, and else asked ray by ray until one enters. All rays
//! behind that one are carried along. Take it for primary rays and others that run side by side
//! among triangles that are not much smaller than the packet.
//!
//! `bvh-partition`: R. Overbeck, R. Ramamoorthi and W. R. Mark, "Large ray packets for real-time
//! Whitted ray tracing", 2008. All rays are asked at each node, and those that do not enter stay
//! behind: more work near the root, less near the leaves. Take it where the triangles are small.
//!
//! `bvh-entry-point` (`entry`) and `bvh-path-compression` (`compress`): A. Reshetov, A. Soupikov
//! and J. Hurley, "Multi-level ray tracing algorithm", 2005; J. Barczak, "An improved multi-level
//! raytracing algorithm". A slice's own shaft is taken through the tree first, and packets then
//! start at the node that holds all that it meets, or walk a tree of those nodes alone where
//! something is met on either side. What this trades: a walk of the shaft per slice for every
//! packet's way down to where the slice is. An entry point seldom lies deep; a compressed tree
//! spares nodes below it too, the more the larger the scene is beside the slice. Take them for
//! slices of many packets (`per-packet=on` with `with=partition`, as the paper's table 4 did). The
//! tracer that has entered a region, a screen or what a light reaches, or that of a `view`, starts
//! from what is met there: screen, tile, packet. The shaft of a raster of rays from one point is
//! taken from its corners, and a packet that does not lie in it is walked from the root; that of
//! other slices is found by all their rays. A slice that has none is given that of its batch if it
//! holds it, and is else walked from the root.
//!
//! Where we differ from all: rays are asked about boxes and triangles eight at a time, a *bundle*,
//! so that the first bundle decides, and bundles are what is partitioned; boxes are held against
//! planes around the packet (Reshetov et al. 2005, as Barczak does for path compression) and not by
//! interval arithmetic, and once all rays have hit something the planes are closed behind the last
//! hit; packets whose rays head different ways are split.
//!
//! What is not coherent is walked ray by ray, as by `bvh2`: packets whose slopes differ by more
//! than a half, runs of fewer than four rays. Why the answers are brute force's: each ray is asked
//! by the slab test about the box of every leaf whose triangles it is tested against, by a filter
//! and by the exact test; and a box is passed by only if the slab test of each ray says so, or the
//! shaft, which never says so of a box that one would enter ([`crate::geom::shaft`]).

mod packet_bvh;
mod place;
mod single;
mod slice;
#[cfg(test)]
mod tests;
mod variants;
mod walk;

pub use variants::{ENTRY_POINT, PACKET, PARTITION, PATH_COMPRESSION};
