//! Consecutive numbers for some of the ids of a mesh.

use crate::mesh::MeshId;

/// Slots of an empty table; a power of two.
const FEWEST_SLOTS: usize = 256;
/// Slots for each number at least.
const SLOTS_PER_NUMBER: usize = 3;
/// So many ids that follow one another lie side by side: two to this power.
const RUN_BITS: u32 = 3;

/// The ids that have a number, in the order in which they came, and a hash table from id to number that is no larger
/// than they need: that of a small patch stays in the fastest cache, while a table of the whole mesh does not.
///
/// Slots carry the epoch in which they were written, so that emptying the table wipes nothing. Nothing is decided by
/// the order of the slots.
#[derive(Clone, Debug)]
pub(super) struct Numbering<K> {
    keys: Vec<K>,
    /// For each slot its epoch and a number.
    slots: Vec<(u32, u32)>,
    /// Slots in use, less one, and what hashes are shifted by to number their runs.
    mask: usize,
    shift: u32,
    epoch: u32,
}

impl<K> Default for Numbering<K> {
    fn default() -> Self {
        // Slots of epoch 0 are void from the start.
        Self {
            keys: Vec::new(),
            slots: vec![(0, 0); FEWEST_SLOTS],
            mask: FEWEST_SLOTS - 1,
            shift: shift_of(FEWEST_SLOTS),
            epoch: 1,
        }
    }
}

impl<K: MeshId> Numbering<K> {
    /// Takes all numbers away.
    pub(super) fn clear(&mut self) {
        self.keys.clear();
        self.mask = FEWEST_SLOTS - 1;
        self.shift = shift_of(FEWEST_SLOTS);
        self.begin_epoch();
    }

    fn begin_epoch(&mut self) {
        self.epoch = self.epoch.checked_add(1).unwrap_or_else(|| {
            // The epochs have run out: slots of earlier ones with the same number must not count again.
            self.slots.fill((0, 0));
            1
        });
    }

    /// The number of an id, if it has one.
    #[inline]
    pub(super) fn get(&self, key: K) -> Option<u32> {
        self.find(key).ok()
    }

    /// The number of an id, or the slot where it is to be written.
    #[inline]
    fn find(&self, key: K) -> Result<u32, usize> {
        let mut slot = self.first_slot(key);
        loop {
            let (epoch, number) = self.slots[slot];
            if epoch != self.epoch {
                return Err(slot);
            }
            if self.keys[number as usize] == key {
                return Ok(number);
            }
            slot = (slot + 1) & self.mask;
        }
    }

    /// Multiplicative hashing (Knuth 1973) of runs of ids: within a run ids keep their order, since those of neighbours
    /// in the mesh are often near each other.
    #[inline]
    fn first_slot(&self, key: K) -> usize {
        #[expect(clippy::cast_possible_truncation, reason = "ids fit 31 bits")]
        let id = key.index() as u32;
        let run = (id >> RUN_BITS).wrapping_mul(0x9e37_79b1) >> self.shift;
        (run << RUN_BITS | id & ((1 << RUN_BITS) - 1)) as usize
    }

    /// The number of an id, which it gets if it has none; and whether it had none.
    #[inline]
    pub(super) fn number(&mut self, key: K) -> (u32, bool) {
        match self.find(key) {
            Ok(number) => (number, false),
            Err(slot) => {
                let number = narrow(self.keys.len());
                self.keys.push(key);
                self.slots[slot] = (self.epoch, number);
                if SLOTS_PER_NUMBER * self.keys.len() > self.mask {
                    self.grow();
                }
                (number, true)
            }
        }
    }

    /// Doubles the table.
    #[cold]
    fn grow(&mut self) {
        self.mask = 2 * self.mask + 1;
        self.shift = shift_of(self.mask + 1);
        self.begin_epoch();
        if self.slots.len() <= self.mask {
            self.slots.resize(self.mask + 1, (0, 0));
        }
        for number in 0..self.keys.len() {
            if let Err(slot) = self.find(self.keys[number]) {
                self.slots[slot] = (self.epoch, narrow(number));
            }
        }
    }

    /// The ids that have a number, in the order of their numbers.
    pub(super) fn keys(&self) -> &[K] {
        &self.keys
    }
}

/// What a hash of 32 bits is shifted by to number the runs of so many slots.
fn shift_of(num_slots: usize) -> u32 {
    u32::BITS - (num_slots.ilog2() - RUN_BITS)
}

pub(super) fn narrow(index: usize) -> u32 {
    u32::try_from(index).expect("a patch has no more elements than its mesh, whose indices fit 31 bits")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::VertexId;

    #[test]
    fn numbering_of_many_ids_counts_them_in_order_and_forgets_them_when_cleared() {
        let mut numbering = Numbering::default();
        let ids: Vec<VertexId> = (0..3000u32).map(|k| VertexId(k.wrapping_mul(7919) % 100_003)).collect();
        for _ in 0..2 {
            for (number, &id) in (0u32..).zip(&ids) {
                assert_eq!(numbering.number(id), (number, true));
                assert_eq!(numbering.number(id), (number, false));
            }
            assert_eq!(numbering.keys(), ids);
            assert!((0u32..).zip(&ids).all(|(number, &id)| numbering.get(id) == Some(number)));
            assert_eq!(numbering.get(VertexId(100_003)), None);
            numbering.clear();
            assert!(numbering.keys().is_empty() && ids.iter().all(|&id| numbering.get(id).is_none()));
        }
    }

    #[test]
    fn numbering_whose_epochs_run_out_holds_nothing_old() {
        let mut numbering = Numbering::default();
        numbering.number(VertexId(3));
        numbering.epoch = u32::MAX;
        numbering.clear();
        assert_eq!((numbering.epoch, numbering.get(VertexId(3))), (1, None));
    }
}
