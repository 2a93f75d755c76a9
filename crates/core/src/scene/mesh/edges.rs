//! The edges of a mesh: the sides of its polygons, each listed once.

use rayon::prelude::*;

use crate::scene::mesh::{Mesh, index};

/// A side of one or more polygons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The vertices at its ends, the smaller index first.
    pub ends: [u32; 2],
    /// The start of the edge's polygons in the list that [`Mesh::edge_polygons`] reads.
    first: u32,
    count: u32,
}

/// The edges of a mesh, sorted by their ends.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Edges {
    edges: Vec<Edge>,
    polygons: Vec<u32>,
}

impl Edges {
    pub(crate) fn of(mesh: &Mesh) -> Self {
        // Sides as (ends, polygon). Sorting brings equal ends together.
        let outlines = mesh.outlines();
        let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(outlines.corners.len());
        for polygon in 0..mesh.polygon_count() {
            let corners = outlines.vertices(polygon);
            for (i, &a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                if a != b {
                    sides.push(([a.min(b), a.max(b)], index(polygon)));
                }
            }
        }
        sides.par_sort_unstable();
        sides.dedup();
        // Counted first: these lists are the largest of a mesh, and none is longer than it must be.
        let by_edge = || sides.chunk_by(|(a, _), (b, _)| a == b);
        let mut edges: Vec<Edge> = Vec::with_capacity(by_edge().count());
        let mut first = 0;
        for sides in by_edge() {
            let count = index(sides.len());
            edges.push(Edge { ends: sides[0].0, first, count });
            first += count;
        }
        // The polygons take the memory of the sides.
        let mut polygons: Vec<u32> = sides.into_iter().map(|(_, polygon)| polygon).collect();
        polygons.shrink_to_fit();
        Self { edges, polygons }
    }

    pub(crate) fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Returns the polygons that have this edge as a side.
    pub(crate) fn polygons(&self, edge: &Edge) -> &[u32] {
        &self.polygons[edge.first as usize..(edge.first + edge.count) as usize]
    }
}
