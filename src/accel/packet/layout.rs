//! How a slice is cut into packets.

use crate::accel::Batch;
use crate::math::{Ray, Vec3};

/// Rays of a packet at most: 16 by 16.
pub const RAYS: usize = 256;

/// The packets of a slice: blocks of its raster as near to square as can be, or runs of rays where
/// it is none.
pub struct PacketLayout<'a> {
    rays: &'a [Ray],
    most: usize,
    /// Cells of the raster.
    width: usize,
    height: usize,
    /// Rays of a cell.
    each: usize,
    /// Cells of a packet along each side, as powers of two.
    sides: [u32; 2],
    /// Places of a packet's cells, in Morton order, and their numbers from the first on.
    cells: Vec<(u8, u8, u32)>,
}

impl<'a> PacketLayout<'a> {
    /// Cuts a slice into packets of at most so many rays.
    pub fn new(batch: &Batch<'a>, most: usize) -> Self {
        let rays = batch.rays();
        let grid = batch.grid().filter(|&(_, _, each)| each > 0);
        let (width, height, each) = grid.unwrap_or((rays.len(), 1, 1));
        let mut sides = [0, 0];
        // As long as twice as many cells along the shorter side fit.
        while each << (sides[0] + sides[1] + 1) <= most {
            sides[usize::from(height > 1 && sides[0] > sides[1])] += 1;
        }
        let cell = |code: usize| {
            let (x, y) = (compact_bits(code), compact_bits(code >> 1));
            (x as u8, y as u8, ((y * width + x) * each) as u32)
        };
        let count = if sides[1] == 0 { 0 } else { 1_usize << (sides[0] + sides[1]) };
        Self { rays, most, width, height, each, sides, cells: (0..count).map(cell).collect() }
    }

    /// How many packets there are, along each side.
    fn counts(&self) -> [usize; 2] {
        [self.width.div_ceil(1 << self.sides[0]), self.height.div_ceil(1 << self.sides[1])]
    }

    /// How many packets there are; a cell of many rays is several.
    pub fn count(&self) -> usize {
        let [across, down] = self.counts();
        across * down * self.parts()
    }

    fn parts(&self) -> usize {
        self.each.div_ceil(self.most)
    }

    /// Lists the numbers of a packet's rays, near ones one after the other, and tells the
    /// directions of its corners.
    pub fn list(&self, packet: usize, members: &mut Vec<u32>) -> [Vec3; 4] {
        members.clear();
        let [across, _] = self.counts();
        let (block, part) = (packet / self.parts(), packet % self.parts());
        let start = [(block % across) << self.sides[0], (block / across) << self.sides[1]];
        let size = [
            (self.width - start[0]).min(1 << self.sides[0]),
            (self.height - start[1]).min(1 << self.sides[1]),
        ];
        let first_of = |x: usize, y: usize| {
            ((start[1] + y) * self.width + start[0] + x) * self.each + part * self.most
        };
        let count = (self.each - part * self.most).min(self.most);
        if size[1] == 1 {
            // A run, whatever its length.
            let first = first_of(0, 0);
            let last = first_of(size[0] - 1, 0) + count;
            members.extend(first as u32..last as u32);
        } else {
            let first = first_of(0, 0) as u32;
            let whole = size == self.sides.map(|side| 1 << side);
            if whole && self.each == 1 {
                // As nearly all are: copied without a look at each.
                members.extend(self.cells.iter().map(|&(.., from)| first + from));
            } else {
                for &(x, y, from) in &self.cells {
                    if usize::from(x) < size[0] && usize::from(y) < size[1] {
                        members.extend(first + from..first + from + count as u32);
                    }
                }
            }
        }
        let corner = |x: usize, y: usize, i: usize| self.rays[first_of(x, y) + i].direction();
        let (x, y) = (size[0] - 1, size[1] - 1);
        if x + y == 0 {
            return [0, count - 1, 0, count - 1].map(|i| corner(0, 0, i));
        }
        [corner(0, 0, 0), corner(x, 0, 0), corner(0, y, 0), corner(x, y, 0)]
    }
}

/// The bits at even places, packed: a coordinate of a Morton code.
fn compact_bits(code: usize) -> usize {
    (0..5).fold(0, |packed, bit| packed | ((code >> (2 * bit)) & 1) << bit)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list_all(grid: Option<(u32, u32)>, count: usize) -> Vec<Vec<u32>> {
        let ray = |i: usize| Ray::new(Vec3::ZERO, Vec3::new(i as f32, 0.0, 1.0), 0.0, 1.0);
        let rays: Vec<Ray> = (0..count).map(ray).collect();
        let batch = Batch::new(&rays);
        let batch = grid.map_or(batch, |(width, height)| batch.with_grid(width, height));
        let layout = PacketLayout::new(&batch, RAYS);
        let mut members = Vec::new();
        let list = |packet| {
            layout.list(packet, &mut members);
            members.clone()
        };
        (0..layout.count()).map(list).collect()
    }

    #[test]
    fn every_ray_is_in_one_packet_whatever_the_raster() {
        let rasters = [(20, 40, 1), (17, 33, 1), (16, 16, 16), (5, 3, 7), (3, 2, 300), (1, 70, 4)];
        for (width, height, each) in rasters {
            let count = (width * height * each) as usize;
            for grid in [Some((width, height)), None, Some((width + 1, 1009))] {
                let packets = list_all(grid, count);
                assert!(packets.iter().all(|packet| (1..=RAYS).contains(&packet.len())));
                let mut all = packets.concat();
                all.sort_unstable();
                assert!(all.iter().copied().eq(0..count as u32), "{grid:?}, {count}");
            }
        }
        assert!(list_all(None, 0).is_empty());
    }

    #[test]
    fn packets_are_blocks_of_pixels() {
        let packets = list_all(Some((32, 32)), 1024);
        assert_eq!(packets.len(), 4);
        // Eight in a row are four by two.
        assert_eq!(packets[1][..8], [16, 17, 48, 49, 18, 19, 50, 51]);
        // With 16 rays in each, a packet is four by four pixels.
        let packets = list_all(Some((16, 16)), 4096);
        assert_eq!(packets.len(), 16);
        assert_eq!((packets[0][16], packets[0][32]), (16, 256));
    }
}
