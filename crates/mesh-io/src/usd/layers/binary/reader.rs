//! Numbers of a crate file one after the other, and the structures that are made of them.

use super::{
    rep::{Rep, kind},
    tables::{Tables, bounded},
};
use crate::usd::{
    fault::Fault,
    layers::spec::{ArcTarget, ListOp, Retiming},
};

/// A place in the file, from which numbers are read one after the other.
pub(super) struct Reader<'t> {
    tables: &'t Tables,
    at: u64,
}

impl<'t> Reader<'t> {
    pub(super) fn new(tables: &'t Tables, at: u64) -> Self {
        Self { tables, at }
    }

    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N], Fault> {
        let bytes = self.tables.source.array(self.at)?;
        self.at += N as u64;
        Ok(bytes)
    }

    pub(super) fn long(&mut self) -> Result<u64, Fault> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn index(&mut self) -> Result<u32, Fault> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn double(&mut self) -> Result<f64, Fault> {
        self.array().map(f64::from_le_bytes)
    }

    /// Goes as far from here as a number that stands here says.
    pub(super) fn jump(&mut self) -> Result<(), Fault> {
        let start = self.at;
        let distance = self.array().map(i64::from_le_bytes)?;
        let at = start.checked_add_signed(distance);
        self.at = at.ok_or_else(|| Fault::new("refers to bytes beyond its end"))?;
        Ok(())
    }

    /// Elements of a size, as many as a number before them says.
    pub(super) fn elements<const N: usize>(&mut self) -> Result<Vec<[u8; N]>, Fault> {
        let count = self.long()?;
        self.some::<N>(count)
    }

    pub(super) fn some<const N: usize>(&mut self, count: u64) -> Result<Vec<[u8; N]>, Fault> {
        let size = count.checked_mul(N as u64).ok_or_else(|| Fault::new("refers to bytes beyond its end"))?;
        let bytes = self.tables.source.read(self.at, size)?;
        self.at += size;
        Ok(bytes.as_chunks::<N>().0.to_vec())
    }

    fn string(&mut self) -> Result<String, Fault> {
        let index = self.index()?;
        self.tables.string(index).map(ToOwned::to_owned)
    }

    pub(super) fn selections(&mut self) -> Result<Vec<(String, String)>, Fault> {
        let count = self.long()?;
        let count = bounded(&self.tables.source, count, 8)?;
        (0..count).map(|_| Ok((self.string()?, self.string()?))).collect()
    }

    fn retiming(&mut self) -> Result<Retiming, Fault> {
        Ok(Retiming { offset: self.double()?, scale: self.double()? })
    }

    pub(super) fn retimings(&mut self) -> Result<Vec<Retiming>, Fault> {
        let count = self.long()?;
        let count = bounded(&self.tables.source, count, 16)?;
        (0..count).map(|_| self.retiming()).collect()
    }

    /// A list of edits, by a function that reads one list.
    pub(super) fn list_op<T>(&mut self, read: impl Fn(&mut Self) -> Result<Vec<T>, Fault>) -> Result<ListOp<T>, Fault> {
        let [flags] = self.array()?;
        let mut list = |bit: u8| if flags >> bit & 1 == 1 { read(self) } else { Ok(Vec::new()) };
        // In this order in the file; what was `added` in old files stands before what is appended.
        let [explicit, mut added, prepended, mut appended, deleted] =
            [list(1)?, list(2)?, list(5)?, list(6)?, list(3)?];
        added.append(&mut appended);
        Ok(ListOp { explicit: (flags & 1 == 1).then_some(explicit), prepended, appended: added, deleted })
    }

    fn arcs(&mut self, has_data: bool) -> Result<Vec<ArcTarget>, Fault> {
        let count = self.long()?;
        let count = bounded(&self.tables.source, count, 8)?;
        (0..count).map(|_| self.arc(has_data)).collect()
    }

    /// A reference (`has_data`) or a payload.
    fn arc(&mut self, has_data: bool) -> Result<ArcTarget, Fault> {
        let asset = self.string()?;
        let prim = self.index()?;
        let prim = self.tables.path(prim)?;
        let retiming = if has_data || self.tables.version >= 8 { self.retiming()? } else { Retiming::default() };
        if has_data {
            self.skip_dictionary()?;
        }
        Ok(ArcTarget { asset, prim, retiming })
    }

    /// Custom data of a reference.
    fn skip_dictionary(&mut self) -> Result<(), Fault> {
        for _ in 0..self.long()? {
            self.index()?;
            // A value: the distance to its representation, which lies behind what it refers to.
            let distance = self.array().map(i64::from_le_bytes)?;
            let at = (self.at - 8).checked_add_signed(distance).filter(|at| *at >= self.at);
            self.at = at.ok_or_else(|| Fault::new("has a dictionary that is broken"))?;
            self.long()?;
        }
        Ok(())
    }

    pub(super) fn references(&mut self) -> Result<ListOp<ArcTarget>, Fault> {
        self.list_op(|reader| reader.arcs(true))
    }

    /// The paths of a list that were not deleted.
    pub(super) fn paths(&mut self) -> Result<Vec<String>, Fault> {
        let tables = self.tables;
        let op = self.list_op(|reader| reader.elements::<4>())?;
        let items = [op.explicit.unwrap_or_default(), op.prepended, op.appended].concat();
        tables.texts(items, |index| tables.path(index))
    }

    /// A list of payloads, or in old files one payload.
    pub(super) fn payloads(&mut self, rep: Rep) -> Result<ListOp<ArcTarget>, Fault> {
        if rep.kind() == kind::PAYLOAD {
            let explicit = Some(vec![self.arc(false)?]);
            return Ok(ListOp { explicit, ..ListOp::default() });
        }
        self.list_op(|reader| reader.arcs(false))
    }

    /// A compressed block.
    pub(super) fn block(&mut self) -> Result<Vec<u8>, Fault> {
        let length = self.long()?;
        self.tables.source.read(self.at, length)
    }
}
