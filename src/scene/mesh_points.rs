//! The normals of a mesh's polygons and vertices, and the corners that name them.

use glam::DVec3;
use rayon::prelude::*;

use super::mesh::index;
use super::mesh_build::Outlines;
use super::{CornerLists, MeshSource, NONE, Point, dvec3};
use crate::base::math;

/// Unit normals that cancel out leave only their rounding errors, which are less.
const CANCELLED: f64 = 1e-9;

/// How many normals of a vertex are looked through; a vertex with more may have a point twice.
const LONGEST: usize = 64;

/// Polygons whose normals are held with all their digits at a time: few enough to stay in a cache.
const BLOCK: usize = 1 << 15;

/// What the normals of polygons are around each vertex.
#[derive(Debug)]
pub(super) struct Normals {
    /// The polygons without area; ascending.
    pub(super) without_area: Vec<u32>,
    /// For each vertex the sum of the unit normals of the polygons around it; a polygon that names
    /// the vertex twice is around it once.
    pub(super) sums: Vec<DVec3>,
}

impl Normals {
    pub(super) fn of(outlines: &Outlines<'_>, vertices: usize) -> Self {
        let count = outlines.starts.len() - 1;
        let mut normals = Self { without_area: Vec::new(), sums: vec![DVec3::ZERO; vertices] };
        let mut last_polygon = vec![NONE; vertices];
        let mut block: Vec<Option<DVec3>> = Vec::new();
        for first in (0..count).step_by(BLOCK) {
            let own = first..count.min(first + BLOCK);
            let normal = |polygon: usize| outlines.normal(polygon);
            own.clone().into_par_iter().map(normal).collect_into_vec(&mut block);
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

/// The points of a mesh's corners, as a list for each thing that they name.
#[derive(Debug, Default)]
pub(super) struct CornerPoints {
    /// The vertex of each corner.
    pub(super) vertices: Vec<u32>,
    /// Its place on the texture, or [`NONE`]; empty where no corner has one.
    pub(super) uvs: Vec<u32>,
    /// Its point with the computed normal; empty where each has its vertex's.
    smooth: Vec<u32>,
    /// Its point with the file's normal; empty where no corner has one.
    pub(super) filed: Vec<u32>,
}

impl CornerPoints {
    /// The point of a corner with the computed normal.
    pub(super) fn smooth(&self, corner: usize) -> u32 {
        let list = if self.smooth.is_empty() { &self.vertices } else { &self.smooth };
        list[corner]
    }

    /// Its point with the file's normal, or else with the computed one.
    pub(super) fn filed(&self, corner: usize) -> u32 {
        if self.filed.is_empty() { self.smooth(corner) } else { self.filed[corner] }
    }

    /// Whether the points of all corners with computed normals are numbered as the vertices.
    pub(super) const fn are_vertices(&self) -> bool {
        self.smooth.is_empty()
    }
}

/// The points of a mesh, and its corners, which name them.
pub(super) fn points_and_corners(
    source: &MeshSource,
    lists: CornerLists,
    starts: &[u32],
    normals: &Normals,
) -> (Vec<Point>, CornerPoints) {
    let CornerLists { positions: vertices, uvs, normals: filed } = lists;
    let mut corners = CornerPoints { vertices, uvs, ..CornerPoints::default() };
    let smooth = |vertex: u32| {
        let sum = normals.sums[vertex as usize];
        let normal = if cancels(sum) { None } else { math::unit(sum) };
        Point { position: vertex, normal: shown_normal(normal) }
    };
    let vertices = 0..index(normals.sums.len());
    let mut points: Vec<Point> = vertices.into_par_iter().map(smooth).collect();
    if normals.sums.par_iter().any(|sum| cancels(*sum)) {
        let outlines = Outlines { places: &source.positions, corners: &corners.vertices, starts };
        corners.smooth = alone(&outlines, normals, &mut points);
    }
    if !filed.is_empty() {
        corners.filed = filed_points(source, &filed, starts, &corners, &mut points);
    }
    (points, corners)
}

/// Whether the unit normals whose sum this is cancel out.
fn cancels(sum: DVec3) -> bool {
    sum.length() <= CANCELLED
}

/// Gives each corner its polygon's normal where those around its vertex cancel out; empty where none
/// do around any vertex of a polygon that has a normal.
fn alone(outlines: &Outlines<'_>, normals: &Normals, points: &mut Vec<Point>) -> Vec<u32> {
    let cancelled: Vec<bool> = normals.sums.par_iter().map(|sum| cancels(*sum)).collect();
    let vertices = outlines.corners;
    let alone = |i: &u32| cancelled[vertices[*i as usize] as usize];
    let alone: Vec<u32> = (0..index(vertices.len())).into_par_iter().filter(alone).collect();
    let mut smooth = Vec::new();
    // A polygon's corners follow each other: its normal is computed once for all of them.
    let mut last = (usize::MAX, None);
    for i in alone {
        let polygon = outlines.starts.partition_point(|start| *start <= i) - 1;
        if last.0 != polygon {
            last = (polygon, outlines.normal(polygon));
        }
        if let Some(normal) = last.1 {
            if smooth.is_empty() {
                smooth = vertices.to_vec();
            }
            smooth[i as usize] = index(points.len());
            points.push(Point { position: vertices[i as usize], normal: narrow(normal) });
        }
    }
    smooth
}

/// Gives corners the file's normals, where every corner of the polygon has one; empty where that is
/// so of none.
fn filed_points(
    source: &MeshSource,
    normals: &[u32],
    starts: &[u32],
    corners: &CornerPoints,
    points: &mut Vec<Point>,
) -> Vec<u32> {
    let unit = |normal: &[f32; 3]| math::unit(dvec3(*normal)).map(narrow);
    let units: Vec<Option<[f32; 3]>> = source.normals.par_iter().map(unit).collect();
    let unit = |i: usize| *units.get(normals[i] as usize)?;
    // The points of a vertex that have normals of the file are a chain: the last one, and for each
    // the one before.
    let mut last = vec![NONE; source.positions.len()];
    let mut chained: Vec<(u32, u32)> = Vec::new();
    let first = points.len();
    let mut filed: Vec<u32> =
        (0..corners.vertices.len()).into_par_iter().map(|i| corners.smooth(i)).collect();
    for polygon in starts.windows(2) {
        let own = polygon[0] as usize..polygon[1] as usize;
        if !own.clone().all(|i| unit(i).is_some()) {
            continue;
        }
        for i in own {
            let (vertex, normal) = (corners.vertices[i], normals[i]);
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
            filed[i] = index(first + at as usize);
        }
    }
    if chained.is_empty() { Vec::new() } else { filed }
}

/// A normal as it is shown: (0, 0, 1) where there is none.
pub(super) fn shown_normal(normal: Option<DVec3>) -> [f32; 3] {
    narrow(normal.unwrap_or(DVec3::Z))
}

fn narrow(v: DVec3) -> [f32; 3] {
    v.as_vec3().to_array()
}
