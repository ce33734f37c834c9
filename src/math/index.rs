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
    /// A triangle of the scene, counted over all instances in their order.
    TriangleId
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
