//! What is measured: structures, tilings and lights.

/// Tiles along a side of a picture, as the paper found best.
pub const ACROSS: u32 = 8;

/// The structures: name, id and options. Columns of a scene have this order.
pub const STRUCTURES: [(Method, &str, &str); 9] = [
    (Method::Packet, "bvh-packet", ""),
    (Method::EntryPoint, "bvh-entry-point", ""),
    (Method::Compressed, "bvh-path-compression", ""),
    (Method::CompressedEach, "bvh-path-compression", "per-packet=on"),
    (Method::Partition, "bvh-partition", ""),
    (Method::PartitionCompressed, "bvh-path-compression", "with=partition,per-packet=on"),
    (Method::Single, "bvh2", ""),
    (Method::SingleCompressed, "bvh-path-compression", "with=single"),
    (Method::Wide, "mbvh8", ""),
];

/// How rays are traced: a column of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Packets from the root.
    Packet,
    /// Packets from an entry point.
    EntryPoint,
    /// Packets over compressed paths.
    Compressed,
    /// The same, with a tree for each packet.
    CompressedEach,
    /// Partitioned packets from the root.
    Partition,
    /// Partitioned packets, with a tree for each.
    PartitionCompressed,
    /// Ray by ray.
    Single,
    /// Ray by ray over compressed paths.
    SingleCompressed,
    /// Eight children a node.
    Wide,
}

impl Method {
    /// Its place in [`STRUCTURES`].
    pub fn index(self) -> usize {
        STRUCTURES.iter().position(|(known, ..)| *known == self).expect("is among the structures")
    }
}

/// Tiles along a side that entry points are tried with, but for those of the tables.
pub const FINER: [u32; 3] = [16, 32, 64];

/// What shines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    /// A point of limited range.
    Ranged,
    /// A point that shines into a pyramid, as far as the scene reaches.
    Spot,
    /// A square, at which each pixel of a part of the picture aims a packet.
    Area,
}

impl LightKind {
    /// All, in the tables' order.
    pub const ALL: [Self; 3] = [Self::Ranged, Self::Spot, Self::Area];

    /// As tables name it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ranged => "ranged light",
            Self::Spot => "spot light",
            Self::Area => "area light",
        }
    }
}

/// The structures that trace rays to lights: name, id, options, and the region that is entered.
pub const LIGHT_STRUCTURES: [(&str, &str, &str, Region); 7] = [
    ("packet", "bvh-packet", "", Region::None),
    ("PC a slice", "bvh-path-compression", "", Region::None),
    ("PC a light", "bvh-path-compression", "", Region::Light),
    ("EP a light", "bvh-entry-point", "", Region::Light),
    ("bvh2", "bvh2", "", Region::None),
    ("bvh2 PC a light", "bvh-path-compression", "with=single", Region::Light),
    ("mbvh8", "mbvh8", "", Region::None),
];

/// What a tracer enters before rays are shot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Nothing.
    None,
    /// What the light reaches.
    Light,
}
