//! Typed indices: a vertex can't be passed where a face is meant.

/// An index of an element of a mesh, for tables that serve several kinds of them.
pub(crate) trait MeshId: Copy + Ord {
    /// The id as an index into a slice.
    fn index(self) -> usize;
}

macro_rules! index_type {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// The id of the `index`-th element.
            ///
            /// # Panics
            /// If `index` does not fit 32 bits; [`Mesh`](crate::mesh::Mesh) refuses input that large.
            #[must_use]
            pub fn from_index(index: usize) -> Self {
                Self(u32::try_from(index).expect("meshes are limited to 2^32 elements"))
            }

            /// The id as an index into a slice.
            #[must_use]
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl MeshId for $name {
            #[inline]
            fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

index_type! {
    /// Index of a vertex, as in the input.
    VertexId
}
index_type! {
    /// Index of a face (triangle), as in the input.
    FaceId
}
index_type! {
    /// Index of an edge; edges are numbered in the order of their (lower, higher) vertices.
    EdgeId
}
index_type! {
    /// Index of a piece: a set of faces connected by edges.
    PieceId
}
