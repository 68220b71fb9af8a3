//! A map by id that is emptied in constant time: for stages that look at a small part of a mesh, again and again.

use crate::mesh::MeshId;

/// Values for some of the ids of a mesh, in a dense table whose entries carry the epoch in which they were written.
///
/// Emptying the map begins a new epoch, which makes all older entries void; nothing is wiped. Ids are listed in the
/// order in which they came.
///
/// Cost: a lookup is one access; memory is that of the whole mesh, taken once.
#[derive(Clone, Debug)]
pub(crate) struct SparseMap<K, V> {
    epoch: u32,
    entries: Vec<(u32, V)>,
    keys: Vec<K>,
}

impl<K, V> Default for SparseMap<K, V> {
    fn default() -> Self {
        // Entries of epoch 0 are void from the start.
        Self { epoch: 1, entries: Vec::new(), keys: Vec::new() }
    }
}

impl<K: MeshId, V: Copy + Default> SparseMap<K, V> {
    /// Empties the map and makes room for ids below `num_ids`.
    pub(crate) fn reset(&mut self, num_ids: usize) {
        self.keys.clear();
        self.epoch = self.epoch.checked_add(1).unwrap_or_else(|| {
            // The epochs have run out: entries of earlier ones with the same number must not count again.
            self.entries.fill((0, V::default()));
            1
        });
        self.entries.resize(num_ids, (0, V::default()));
    }

    /// The value of an id, if it has one.
    #[inline]
    pub(crate) fn get(&self, key: K) -> Option<V> {
        let (epoch, value) = self.entries[key.index()];
        (epoch == self.epoch).then_some(value)
    }

    /// Whether an id has a value.
    #[inline]
    pub(crate) fn contains(&self, key: K) -> bool {
        self.entries[key.index()].0 == self.epoch
    }

    /// Gives an id a value, in place of the one that it had.
    #[inline]
    pub(crate) fn set(&mut self, key: K, value: V) {
        *self.entry(key) = value;
    }

    /// Gives an id a value unless it has one already; whether it had none.
    #[inline]
    pub(crate) fn insert(&mut self, key: K, value: V) -> bool {
        let is_new = !self.contains(key);
        if is_new {
            self.set(key, value);
        }
        is_new
    }

    /// The value of an id, made by default where it has none.
    #[inline]
    pub(crate) fn entry(&mut self, key: K) -> &mut V {
        let entry = &mut self.entries[key.index()];
        if entry.0 != self.epoch {
            *entry = (self.epoch, V::default());
            self.keys.push(key);
        }
        &mut entry.1
    }

    /// The ids that have a value, in the order in which they came.
    pub(crate) fn keys(&self) -> &[K] {
        &self.keys
    }

    /// Sorts the list of ids.
    pub(crate) fn sort_keys(&mut self) {
        self.keys.sort_unstable();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexId;

    #[test]
    fn sparse_map_after_reset_holds_nothing() {
        let mut map = SparseMap::<VertexId, u32>::default();
        map.reset(3);
        assert!(map.insert(VertexId(2), 7) && !map.insert(VertexId(2), 8));
        *map.entry(VertexId(0)) += 5;
        assert_eq!(map.get(VertexId(2)), Some(7));
        assert_eq!(map.get(VertexId(0)), Some(5));
        assert_eq!(map.keys(), [VertexId(2), VertexId(0)]);
        map.reset(4);
        assert_eq!([0, 2, 3].map(|id| map.get(VertexId(id))), [None; 3]);
        assert!(map.keys().is_empty());
    }

    #[test]
    fn sparse_map_whose_epochs_run_out_holds_nothing_old() {
        let mut map = SparseMap::<VertexId, u32>::default();
        map.reset(1);
        map.set(VertexId(0), 1);
        map.epoch = u32::MAX;
        map.reset(1);
        assert_eq!((map.epoch, map.get(VertexId(0))), (1, None));
    }
}
