//! The identity of a mesh.

use std::sync::Arc;

/// Equal for clones of one mesh, and different for any other, for as long as somebody holds it. A cache derived from a
/// mesh keeps this to know whether it still belongs to the mesh that it is asked about.
#[derive(Clone, Debug, Default)]
pub(crate) struct MeshIdentity(Arc<u8>);

impl PartialEq for MeshIdentity {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for MeshIdentity {}
