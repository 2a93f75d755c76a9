//! The edges that a sweep line crosses, from left to right.
//!
//! The list is divided into chunks, so inserting or removing an edge takes time in proportion to
//! the size of a chunk. Edges are compared only on insertion, so the list stays valid even if edges
//! cross.

/// The largest number of edges in a chunk.
const CHUNK: usize = 512;

/// Edges from left to right.
#[derive(Debug)]
pub(super) struct Status {
    /// The chunks with edges, from left to right, as indices into `chunks`.
    order: Vec<u32>,
    chunks: Vec<Vec<u32>>,
    /// The chunk of each edge; [`NOWHERE`] if the edge is not in the list.
    home: Vec<u32>,
}

const NOWHERE: u32 = u32::MAX;

impl Status {
    /// Creates an empty list for this number of edges.
    pub(super) fn new(edges: usize) -> Self {
        Self { order: Vec::new(), chunks: Vec::new(), home: vec![NOWHERE; edges] }
    }

    pub(super) fn holds(&self, edge: u32) -> bool {
        self.home[edge as usize] != NOWHERE
    }

    /// Returns the last edge for which `is` holds. The edges for which it holds must come first.
    pub(super) fn last_of(&self, is: impl Fn(u32) -> bool) -> Option<u32> {
        let (chunk, place) = self.place(is)?;
        place.checked_sub(1).map(|place| self.chunks[chunk as usize][place])
    }

    /// Inserts an edge after all edges on its left.
    pub(super) fn insert(&mut self, edge: u32, is_left: impl Fn(u32) -> bool) {
        let (chunk, place) = self.place(is_left).unwrap_or_else(|| {
            self.order.push(super::number(self.chunks.len()));
            self.chunks.push(Vec::new());
            (super::number(self.chunks.len()) - 1, 0)
        });
        self.home[edge as usize] = chunk;
        let edges = &mut self.chunks[chunk as usize];
        edges.insert(place, edge);
        // A full chunk is split in half, so insertion stays cheap.
        if edges.len() > CHUNK {
            let behind = edges.split_off(CHUNK / 2);
            let new = super::number(self.chunks.len());
            for edge in &behind {
                self.home[*edge as usize] = new;
            }
            self.chunks.push(behind);
            let at = self.order.iter().position(|other| *other == chunk);
            self.order.insert(at.map_or(self.order.len(), |at| at + 1), new);
        }
    }

    /// Replaces an edge by another, if it is in the list.
    pub(super) fn replace(&mut self, old: u32, new: u32) {
        let chunk = std::mem::replace(&mut self.home[old as usize], NOWHERE);
        let Some(edges) = self.chunks.get_mut(chunk as usize) else { return };
        if let Some(edge) = edges.iter_mut().find(|edge| **edge == old) {
            *edge = new;
            self.home[new as usize] = chunk;
        }
    }

    /// Removes an edge, if it is in the list.
    pub(super) fn remove(&mut self, edge: u32) {
        let chunk = std::mem::replace(&mut self.home[edge as usize], NOWHERE);
        let Some(edges) = self.chunks.get_mut(chunk as usize) else { return };
        edges.retain(|other| *other != edge);
        if edges.is_empty() {
            self.order.retain(|other| *other != chunk);
        }
    }

    /// Returns the position behind the edges for which `is` holds: a chunk, and an index in it.
    fn place(&self, is: impl Fn(u32) -> bool) -> Option<(u32, usize)> {
        let first = |chunk: &u32| is(self.chunks[*chunk as usize][0]);
        let chunk = *self.order.get(self.order.partition_point(first).saturating_sub(1))?;
        Some((chunk, self.chunks[chunk as usize].partition_point(|edge| is(*edge))))
    }
}
