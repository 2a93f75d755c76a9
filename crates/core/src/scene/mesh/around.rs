//! The corners around each vertex of a mesh.

use glam::DVec3;
use rayon::prelude::*;

use crate::scene::mesh::index;
use crate::scene::mesh::outlines::Outlines;

/// The corners around each vertex, in the order of the vertices.
#[derive(Debug)]
pub(crate) struct Around {
    /// The start of each vertex's corners, and the end of the last vertex's corners.
    starts: Vec<u32>,
    /// The corners, in ascending order for each vertex.
    corners: Vec<u32>,
    polygons: Polygons,
}

/// The polygon of each corner.
#[derive(Debug)]
enum Polygons {
    Triangles,
    Quads,
    Mixed(Vec<u32>),
}

impl Around {
    pub(crate) fn of(outlines: &Outlines<'_>, vertices: usize) -> Self {
        // Each thread scans all corners and counts those at its own vertices, so no two threads
        // write to one count.
        let own = vertices.div_ceil(rayon::current_num_threads()).max(1 << 12);
        let mut starts = vec![0; vertices + 1];
        starts[1..].par_chunks_mut(own).enumerate().for_each(|(share, counts)| {
            let begin = index(share * own);
            for vertex in outlines.corners {
                if let Some(count) = counts.get_mut(vertex.wrapping_sub(begin) as usize) {
                    *count += 1;
                }
            }
        });
        // A running sum turns the counts into starts.
        let mut sum = 0;
        for start in &mut starts {
            sum += *start;
            *start = sum;
        }
        // Each thread gets the part of the list that belongs to its vertices.
        let mut corners = vec![0; outlines.corners.len()];
        let mut shares = Vec::new();
        let mut rest = &mut corners[..];
        for begin in (0..vertices).step_by(own) {
            let starts = &starts[begin..=vertices.min(begin + own)];
            let (share, others) =
                rest.split_at_mut((starts[starts.len() - 1] - starts[0]) as usize);
            shares.push((index(begin), starts, share));
            rest = others;
        }
        shares.into_par_iter().for_each(|(begin, starts, share)| {
            let mut places: Vec<u32> = starts.iter().map(|start| start - starts[0]).collect();
            // The last start is the end of all corners.
            places.pop();
            for (corner, vertex) in (0..).zip(outlines.corners) {
                if let Some(place) = places.get_mut(vertex.wrapping_sub(begin) as usize) {
                    share[*place as usize] = corner;
                    *place += 1;
                }
            }
        });
        Self { starts, corners, polygons: Polygons::of(outlines) }
    }

    /// Computes the normals of all polygons, unless all are triangles or all are quads: the normal
    /// of a small polygon is quickly computed again for each corner.
    pub(crate) fn large_normals(&self, outlines: &Outlines<'_>) -> Option<Vec<Option<DVec3>>> {
        matches!(self.polygons, Polygons::Mixed(_)).then(|| {
            let polygons = 0..outlines.starts.len() - 1;
            polygons.into_par_iter().map(|polygon| outlines.normal(polygon)).collect()
        })
    }

    /// Returns the corners around a vertex, ascending.
    pub(crate) fn corners(&self, vertex: usize) -> &[u32] {
        &self.corners[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// Returns the polygon of a corner.
    #[inline]
    pub(crate) fn polygon(&self, corner: u32) -> usize {
        let polygon = match &self.polygons {
            Polygons::Triangles => corner / 3,
            Polygons::Quads => corner / 4,
            Polygons::Mixed(polygons) => polygons[corner as usize],
        };
        polygon as usize
    }
}

impl Polygons {
    fn of(outlines: &Outlines<'_>) -> Self {
        let all = |sides: u32| outlines.starts.par_windows(2).all(|own| own[1] - own[0] == sides);
        if all(3) {
            return Self::Triangles;
        }
        if all(4) {
            return Self::Quads;
        }
        let mut polygons = Vec::with_capacity(outlines.corners.len());
        for (polygon, end) in (0..).zip(&outlines.starts[1..]) {
            polygons.resize(*end as usize, polygon);
        }
        Self::Mixed(polygons)
    }
}
