//! Edges from left to right, as a line meets them that sweeps over a polygon.
//!
//! A list in chunks: an edge is put in and taken out in the time that a chunk takes. Nothing is
//! compared but when an edge is put in, so that the list stays a list whatever the order of edges
//! that cross.

/// The most edges of a chunk.
const CHUNK: usize = 512;

/// Edges from left to right.
#[derive(Debug)]
pub(super) struct Status {
    /// The chunks that have edges, from left to right, by their places in `chunks`.
    order: Vec<u32>,
    chunks: Vec<Vec<u32>>,
    /// The chunk of each edge, or [`NOWHERE`].
    home: Vec<u32>,
}

const NOWHERE: u32 = u32::MAX;

impl Status {
    /// Nothing yet of so many edges.
    pub(super) fn new(edges: usize) -> Self {
        Self { order: Vec::new(), chunks: Vec::new(), home: vec![NOWHERE; edges] }
    }

    pub(super) fn holds(&self, edge: u32) -> bool {
        self.home[edge as usize] != NOWHERE
    }

    /// The last edge of those that are what is asked for; these come first.
    pub(super) fn last_of(&self, is: impl Fn(u32) -> bool) -> Option<u32> {
        let (chunk, place) = self.place(is)?;
        place.checked_sub(1).map(|place| self.chunks[chunk as usize][place])
    }

    /// Puts in an edge behind those that are left of it.
    pub(super) fn insert(&mut self, edge: u32, is_left: impl Fn(u32) -> bool) {
        let (chunk, place) = self.place(is_left).unwrap_or_else(|| {
            self.order.push(super::number(self.chunks.len()));
            self.chunks.push(Vec::new());
            (super::number(self.chunks.len()) - 1, 0)
        });
        self.home[edge as usize] = chunk;
        let edges = &mut self.chunks[chunk as usize];
        edges.insert(place, edge);
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

    /// Puts an edge in the place of another, if that is there.
    pub(super) fn replace(&mut self, old: u32, new: u32) {
        let chunk = std::mem::replace(&mut self.home[old as usize], NOWHERE);
        let Some(edges) = self.chunks.get_mut(chunk as usize) else { return };
        if let Some(edge) = edges.iter_mut().find(|edge| **edge == old) {
            *edge = new;
            self.home[new as usize] = chunk;
        }
    }

    /// Takes out an edge, if it is there.
    pub(super) fn remove(&mut self, edge: u32) {
        let chunk = std::mem::replace(&mut self.home[edge as usize], NOWHERE);
        let Some(edges) = self.chunks.get_mut(chunk as usize) else { return };
        edges.retain(|other| *other != edge);
        if edges.is_empty() {
            self.order.retain(|other| *other != chunk);
        }
    }

    /// Behind the edges that are what is asked for: a chunk, and a place in it.
    fn place(&self, is: impl Fn(u32) -> bool) -> Option<(u32, usize)> {
        let first = |chunk: &u32| is(self.chunks[*chunk as usize][0]);
        let chunk = *self.order.get(self.order.partition_point(first).saturating_sub(1))?;
        Some((chunk, self.chunks[chunk as usize].partition_point(|edge| is(*edge))))
    }
}
