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
        let polygons = sides.iter().map(|(_, polygon)| *polygon).collect();
        let mut edges: Vec<Edge> = Vec::new();
        for (i, (ends, _)) in sides.iter().enumerate() {
            match edges.last_mut() {
                Some(last) if last.ends == *ends => last.count += 1,
                _ => edges.push(Edge { ends: *ends, first: index(i), count: 1 }),
            }
        }
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
