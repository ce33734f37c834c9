//! The packets of tev's protocol that a render needs.
//!
//! A packet is its length in bytes, these four included, a type, and fields without padding.
//! Numbers are little-endian, names end with a zero. Facts of `src/Ipc.cpp` of
//! <https://github.com/Tom94/tev>.

/// Makes an image, or replaces the one of that name.
const CREATE_IMAGE: u8 = 4;
/// Sets pixels of several channels, at offsets and strides of their own.
const UPDATE_IMAGE_V3: u8 = 6;

/// A rectangle of an image, in its pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// The leftmost column.
    pub x: usize,
    /// The topmost row.
    pub y: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// The packet that makes an image.
pub fn create(name: &str, (width, height): (usize, usize), channels: &[&str]) -> Vec<u8> {
    let mut packet = Packet::new(CREATE_IMAGE, name);
    packet.ints(&[width, height]);
    packet.names(channels);
    packet.finish()
}

/// The packet that sets a tile: of each pixel, row by row, the values of all channels.
pub fn update(
    name: &str,
    channels: &[&str],
    tile: Tile,
    values: impl Iterator<Item = f32>,
) -> Vec<u8> {
    let mut packet = Packet::new(UPDATE_IMAGE_V3, name);
    packet.names(channels);
    packet.ints(&[tile.x, tile.y, tile.width, tile.height]);
    // Offsets, then strides.
    let offsets = 0..channels.len();
    packet.longs(offsets.chain(channels.iter().map(|_| channels.len())));
    packet.0.extend(values.flat_map(f32::to_le_bytes));
    packet.finish()
}

struct Packet(Vec<u8>);

impl Packet {
    /// Without its length. No packet grabs the focus.
    fn new(kind: u8, image: &str) -> Self {
        let mut packet = Self(vec![0, 0, 0, 0, kind, 0]);
        packet.name(image);
        packet
    }

    fn name(&mut self, name: &str) {
        self.0.extend(name.bytes().filter(|&byte| byte != 0));
        self.0.push(0);
    }

    /// How many names there are, and the names.
    fn names(&mut self, names: &[&str]) {
        self.ints(&[names.len()]);
        for name in names {
            self.name(name);
        }
    }

    fn ints(&mut self, values: &[usize]) {
        self.0.extend(values.iter().flat_map(|&value| (value as i32).to_le_bytes()));
    }

    fn longs(&mut self, values: impl Iterator<Item = usize>) {
        self.0.extend(values.flat_map(|value| (value as i64).to_le_bytes()));
    }

    fn finish(mut self) -> Vec<u8> {
        let length = self.0.len() as u32;
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_are_laid_out_as_tev_reads_them() {
        let packet = create("ab", (3, 258), &["R"]);
        let expected =
            [&[23, 0, 0, 0, 4, 0][..], b"ab\0", &[3, 0, 0, 0, 2, 1, 0, 0, 1, 0, 0, 0], b"R\0"]
                .concat();
        assert_eq!((packet.len(), packet), (23, expected));

        let tile = Tile { x: 1, y: 2, width: 1, height: 1 };
        let packet = update("a", &["R", "G"], tile, [1.0, -2.0].into_iter());
        let ints = [1, 2, 1, 1].map(|it: i32| it.to_le_bytes()).concat();
        let longs = [0, 1, 2, 2].map(|it: i64| it.to_le_bytes()).concat();
        let floats = [1.0_f32, -2.0].map(f32::to_le_bytes).concat();
        let body = [b"\x06\0a\0\x02\0\0\0R\0G\0", &*ints, &longs, &floats].concat();
        let length = (body.len() as u32 + 4).to_le_bytes();
        assert_eq!(packet, [&length[..], &body].concat());
    }
}
