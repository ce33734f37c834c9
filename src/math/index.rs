//! Newtypes of indices: a slot in one array is no index into another.

macro_rules! index {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[derive(bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// Stands for "none"; no array reaches it.
            pub const NONE: Self = Self(u32::MAX);

            /// The index as one into a slice.
            #[inline(always)]
            pub const fn index(self) -> usize {
                self.0 as usize
            }

            /// The newtype of an index into a slice.
            ///
            /// # Panics
            /// If it does not fit 32 bits; builders refuse such inputs before.
            #[inline]
            pub fn from_index(index: usize) -> Self {
                Self(u32::try_from(index).expect("fewer than 2^32 elements"))
            }
        }
    };
}

index! {
    /// What a structure is built over, by its running number: a triangle, or a placement.
    PrimId
}
index! {
    /// A node of an acceleration structure.
    NodeId
}
index! {
    /// A mesh: one list of triangles with one material.
    MeshId
}
index! {
    /// A placed mesh.
    InstanceId
}
index! {
    /// A material.
    MaterialId
}
index! {
    /// A texture: an image with a sampler and a colour space.
    TextureId
}

/// A triangle of the scene: which placed mesh, and which of its triangles. Ordered as the running
/// number over all placements is.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, bytemuck::Pod, bytemuck::Zeroable,
)]
#[repr(C)]
pub struct TriangleId {
    /// The placed mesh.
    pub instance: InstanceId,
    /// The triangle's number in the mesh.
    pub index: u32,
}

impl TriangleId {
    /// Stands for "none"; after all others.
    pub const NONE: Self = Self { instance: InstanceId::NONE, index: u32::MAX };

    /// A triangle of a list that is not placed: all are of the first instance.
    #[inline(always)]
    pub const fn unplaced(prim: PrimId) -> Self {
        Self { instance: InstanceId(0), index: prim.0 }
    }
}
