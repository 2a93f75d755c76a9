//! Finds edges that a corner of another face lies on (T-junctions).
//!
//! Rounding separates such a corner from the edge, because it belongs to one face only, and pixels
//! in the gap may be missed. Only an edge with a face on one side can be split, and only by an end
//! of another such edge. A grid finds these ends; its cells are as wide as the mean length of these
//! edges.

use std::collections::HashMap;

use glam::DVec3;

use crate::scene::{Edge, Mesh, dvec3};

/// A corner lies on an edge if its distance is less than this fraction of the edge's length.
const NEAR: f64 = 1e-6;

/// The number of edge-corner pairs that are tested: a few seconds of work.
const BUDGET: usize = 50_000_000;

impl Mesh {
    /// Counts the edges that corners of other faces split. The count may be too low in meshes with
    /// very many edges that have a face on one side only.
    pub fn split_edges(&self) -> usize {
        let open: Vec<&Edge> =
            self.edges().iter().filter(|edge| self.edge_polygons(edge).len() == 1).collect();
        let place = |vertex: u32| dvec3(self.positions()[vertex as usize]);
        let lengths = open.iter().map(|edge| place(edge.ends[0]).distance(place(edge.ends[1])));
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2^32 edges")]
        let cell = lengths.sum::<f64>() / open.len().max(1) as f64;
        #[expect(clippy::cast_possible_truncation, reason = "what is beyond is held to the border")]
        let cells = |p: DVec3| (p / cell).floor().to_array().map(|x| x as i64);

        // Sort the ends of open edges into the cells of the grid.
        let mut corners: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        let mut ends: Vec<u32> = open.iter().flat_map(|edge| edge.ends).collect();
        ends.sort_unstable();
        ends.dedup();
        for vertex in ends {
            corners.entry(cells(place(vertex))).or_default().push(vertex);
        }

        // An edge is compared with the corners in all cells that its box overlaps.
        let mut budget = BUDGET;
        let mut splits = |edge: &&&Edge| {
            let [a, b] = edge.ends.map(place);
            let (low, high) = (cells(a.min(b) - cell * NEAR), cells(a.max(b) + cell * NEAR));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    for z in low[2]..=high[2] {
                        let Some(left) = budget.checked_sub(1) else { return false };
                        budget = left;
                        let near = corners.get(&[x, y, z]).map_or(&[][..], Vec::as_slice);
                        budget = budget.saturating_sub(near.len());
                        if near.iter().any(|vertex| stands_on(place(*vertex), a, b)) {
                            return true;
                        }
                    }
                }
            }
            false
        };
        open.iter().filter(|edge| splits(edge)).count()
    }
}

/// Returns whether a point lies on the segment from `a` to `b`, but not at an end.
fn stands_on(p: DVec3, a: DVec3, b: DVec3) -> bool {
    let along = b - a;
    let square = along.length_squared();
    let t = (p - a).dot(along) / square;
    // A point as near to an end as to the edge counts as the end.
    t > NEAR && t < 1.0 - NEAR && (p - a - along * t).length_squared() < square * NEAR * NEAR
}
