//! What is measured: structures, and what their leaves hold.

/// The structures: with references and a cache of 100 MB, as in the paper, then with triangles in
/// the leaves. `bvh2` is the one that its mode's others are compared to. `auto` is built as it
/// likes.
pub const STRUCTURES: [(&str, usize, Mode); 7] = [
    ("bvh2", 2, Mode::Cache),
    ("mbvh4", 4, Mode::Cache),
    ("bvh2", 2, Mode::Inline),
    ("mbvh4", 4, Mode::Inline),
    ("mbvh8", 8, Mode::Inline),
    ("mbvh16", 16, Mode::Inline),
    (AUTO, 8, Mode::Inline),
];

/// The default of renders.
pub const AUTO: &str = "auto";

/// Those of figure 4, which all store their triangles: its columns and curves.
pub const INCOHERENT: [&str; 4] = ["bvh2", "mbvh4", "mbvh8", PACKETS];
/// Traces packets of rays together.
pub const PACKETS: &str = "bvh-packet";

/// Figure 4's abscissae.
pub const INCOHERENCE: [f32; 10] = [0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0];

/// What leaves hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Ids; what they name is kept in a cache of 100 MB.
    Cache,
    /// Triangles.
    Inline,
}

impl Mode {
    /// As the option `triangles` names it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cache => "cache",
            Self::Inline => "inline",
        }
    }
}
