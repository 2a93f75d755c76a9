//! The normals of a mesh's polygons and vertices, and the corners that name them.

use glam::DVec3;
use rayon::prelude::*;

use super::mesh::index;
use super::mesh_build::Outlines;
use super::{Corner, CornerLists, MeshSource, NONE, Point, dvec3, newell};
use crate::base::math;

/// Unit normals that cancel out leave only their rounding errors, which are less.
const CANCELLED: f64 = 1e-9;

/// How many normals of a vertex are looked through; a vertex with more may have a point twice.
const LONGEST: usize = 64;

/// Polygons whose normals are held with all their digits at a time: few enough to stay in a cache.
const BLOCK: usize = 1 << 15;

/// The normals of all polygons, and what they are around each vertex.
#[derive(Debug)]
pub(super) struct Normals {
    /// Of length 1; (0, 0, 1) for a polygon without area.
    pub(super) polygons: Vec<[f32; 3]>,
    /// The polygons without area; ascending.
    pub(super) without_area: Vec<u32>,
    /// For each vertex the sum of the unit normals of the polygons around it; a polygon that names
    /// the vertex twice is around it once.
    pub(super) sums: Vec<DVec3>,
}

impl Normals {
    pub(super) fn of(outlines: &Outlines<'_>, vertices: usize) -> Self {
        let count = outlines.starts.len() - 1;
        let mut normals = Self {
            polygons: Vec::with_capacity(count),
            without_area: Vec::new(),
            sums: vec![DVec3::ZERO; vertices],
        };
        let mut last_polygon = vec![NONE; vertices];
        let mut block: Vec<Option<DVec3>> = Vec::new();
        for first in (0..count).step_by(BLOCK) {
            let own = first..count.min(first + BLOCK);
            let normal = |polygon: usize| math::unit(newell(outlines.of(polygon)));
            own.clone().into_par_iter().map(normal).collect_into_vec(&mut block);
            let shown = |normal: &Option<DVec3>| narrow(normal.unwrap_or(DVec3::Z));
            normals.polygons.extend(block.iter().map(shown));
            let without = own.zip(&block).filter(|(_, normal)| normal.is_none());
            normals.without_area.extend(without.map(|(polygon, _)| index(polygon)));
            normals.add(outlines, first, &block, &mut last_polygon);
        }
        normals
    }

    /// Adds the normals of polygons from `first` on to those of their vertices. Every thread goes
    /// through all of them and adds to its own vertices: the order of no sum depends on how many
    /// threads there are.
    fn add(
        &mut self,
        outlines: &Outlines<'_>,
        first: usize,
        normals: &[Option<DVec3>],
        last_polygon: &mut [u32],
    ) {
        let own = self.sums.len().div_ceil(rayon::current_num_threads()).max(1 << 12);
        let shares = self.sums.par_chunks_mut(own).zip(last_polygon.par_chunks_mut(own));
        shares.enumerate().for_each(|(share, (sums, last_polygon))| {
            let begin = index(share * own);
            for (polygon, normal) in (first..).zip(normals) {
                let Some(normal) = normal else { continue };
                for vertex in outlines.vertices(polygon) {
                    let place = vertex.wrapping_sub(begin) as usize;
                    let Some(last) = last_polygon.get_mut(place) else { continue };
                    if std::mem::replace(last, index(polygon)) != index(polygon) {
                        sums[place] += *normal;
                    }
                }
            }
        });
    }
}

/// The points of a mesh, and its corners, which name them.
pub(super) fn points_and_corners(
    source: &MeshSource,
    lists: &CornerLists,
    starts: &[u32],
    normals: &Normals,
) -> (Vec<Point>, Vec<Corner>) {
    let sums = &normals.sums;
    let has_normal = |vertex: u32| sums[vertex as usize].length() > CANCELLED;
    let smooth = |vertex: u32| {
        let sum = sums[vertex as usize];
        let normal = if sum.length() > CANCELLED { math::unit(sum) } else { None };
        Point { position: vertex, normal: narrow(normal.unwrap_or(DVec3::Z)) }
    };
    let mut points: Vec<Point> = (0..index(sums.len())).into_par_iter().map(smooth).collect();
    let corner = |i: usize| {
        let position = lists.positions[i];
        Corner { position, uv: lists.uv(i), smooth: position, filed: position }
    };
    let mut corners: Vec<Corner> = (0..lists.positions.len()).into_par_iter().map(corner).collect();

    // Where the normals around a vertex cancel out, each corner has its polygon's.
    let alone = |i: &u32| !has_normal(lists.positions[*i as usize]);
    let alone: Vec<u32> = (0..index(corners.len())).into_par_iter().filter(alone).collect();
    for i in alone {
        let polygon = starts.partition_point(|start| *start <= i) - 1;
        if normals.without_area.binary_search(&index(polygon)).is_err() {
            let corner = &mut corners[i as usize];
            corner.smooth = index(points.len());
            corner.filed = corner.smooth;
            points.push(Point { position: corner.position, normal: normals.polygons[polygon] });
        }
    }
    if !lists.normals.is_empty() {
        add_filed(source, lists, starts, &mut points, &mut corners);
    }
    (points, corners)
}

/// Gives corners the file's normals, where every corner of the polygon has one.
fn add_filed(
    source: &MeshSource,
    lists: &CornerLists,
    starts: &[u32],
    points: &mut Vec<Point>,
    corners: &mut [Corner],
) {
    let unit = |normal: &[f32; 3]| math::unit(dvec3(*normal)).map(narrow);
    let units: Vec<Option<[f32; 3]>> = source.normals.par_iter().map(unit).collect();
    let unit = |i: usize| *units.get(lists.normal(i) as usize)?;
    // The points of a vertex that have normals of the file are a chain: the last one, and for each
    // the one before.
    let mut last = vec![NONE; source.positions.len()];
    let mut chained: Vec<(u32, u32)> = Vec::new();
    let first = points.len();
    for polygon in starts.windows(2) {
        let own = polygon[0] as usize..polygon[1] as usize;
        if !own.clone().all(|i| unit(i).is_some()) {
            continue;
        }
        for i in own {
            let (vertex, normal) = (lists.positions[i], lists.normal(i));
            let mut at = last[vertex as usize];
            let mut looked_at = 0;
            while at != NONE && chained[at as usize].0 != normal {
                looked_at += 1;
                at = if looked_at < LONGEST { chained[at as usize].1 } else { NONE };
            }
            if at == NONE {
                at = index(chained.len());
                chained.push((normal, std::mem::replace(&mut last[vertex as usize], at)));
                let normal = unit(i).expect("every normal of this polygon has been looked at");
                points.push(Point { position: vertex, normal });
            }
            corners[i].filed = index(first + at as usize);
        }
    }
}

fn narrow(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}
