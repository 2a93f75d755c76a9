//! Computes the normals of a mesh's polygons and vertices, and assigns them to corners.

use glam::DVec3;
use rayon::prelude::*;

use crate::base::math;
use crate::scene::mesh::fans::{Limit, Rule, fan_points};
use crate::scene::mesh::index;
use crate::scene::mesh::normals::{cancels, narrow, shown_normal};
use crate::scene::mesh::outlines::Outlines;
use crate::scene::{CornerLists, Crease, MeshSource, NONE, Point, Smoothing, dvec3};

/// The most normals of a vertex that are compared; a vertex with more may get equal points.
const LONGEST: usize = 64;

/// The number of polygons with normals held in f64 at a time: they must stay in a cache.
const BLOCK: usize = 1 << 15;

/// The data computed from the normals of polygons.
#[derive(Debug)]
pub(crate) struct Computed {
    /// The polygons without area; ascending.
    pub(crate) without_area: Vec<u32>,
    /// The points of corners, beginning with one for each vertex.
    pub(crate) points: Vec<Point>,
    /// The point of each corner; empty if each corner has its vertex's point.
    of_corners: Vec<u32>,
}

impl Computed {
    pub(crate) fn of(outlines: &Outlines<'_>, vertices: usize, smoothing: &Smoothing) -> Self {
        let rule = match smoothing {
            Smoothing::Crease(crease) if *crease == Crease::SMOOTH => None,
            Smoothing::Crease(crease) => Some(Rule::Crease(Limit::new(*crease))),
            Smoothing::Groups(groups) => match groups.first() {
                Some(0) | None => Some(Rule::Groups(groups)),
                Some(one) if groups.par_iter().all(|group| group == one) => None,
                Some(_) => Some(Rule::Groups(groups)),
            },
        };
        let normals = Normals::of(outlines, vertices);
        let Some(rule) = rule else { return normals.points(outlines) };
        let (points, of_corners) = fan_points(outlines, &normals.sums, rule);
        Self { without_area: normals.without_area, points, of_corners }
    }
}

/// The unit normals of polygons, summed at each vertex.
#[derive(Debug)]
struct Normals {
    /// The polygons without area; ascending.
    without_area: Vec<u32>,
    /// The sum of the unit normals of the polygons around each vertex. A polygon counts once, even
    /// if it refers to the vertex twice.
    sums: Vec<DVec3>,
}

impl Normals {
    /// Returns the points of corners, each with the mean normal of all faces around its vertex.
    fn points(self, outlines: &Outlines<'_>) -> Computed {
        let smooth = |vertex: u32| {
            let sum = self.sums[vertex as usize];
            let normal = if cancels(sum) { None } else { math::unit(sum) };
            Point { position: vertex, normal: shown_normal(normal) }
        };
        let vertices = 0..index(self.sums.len());
        let mut points: Vec<Point> = vertices.into_par_iter().map(smooth).collect();
        let mut of_corners = Vec::new();
        if self.sums.par_iter().any(|sum| cancels(*sum)) {
            of_corners = alone(outlines, &self, &mut points);
        }
        Computed { without_area: self.without_area, points, of_corners }
    }

    fn of(outlines: &Outlines<'_>, vertices: usize) -> Self {
        let count = outlines.starts.len() - 1;
        let mut normals = Self { without_area: Vec::new(), sums: vec![DVec3::ZERO; vertices] };
        let mut last_polygon = vec![NONE; vertices];
        let mut block: Vec<Option<DVec3>> = Vec::new();
        // Normals are computed in parallel and added block by block, while they are in the cache.
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

    /// Adds the normals of the polygons from `first` on to their vertices. Each thread scans all of
    /// them and adds to its own vertices, so the order of a sum does not depend on the number of
    /// threads.
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
                    // Skips a polygon that has already been added to this vertex.
                    if std::mem::replace(last, index(polygon)) != index(polygon) {
                        sums[place] += *normal;
                    }
                }
            }
        });
    }
}

/// The points of a mesh's corners.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct CornerPoints {
    /// The point of each corner with the computed normal; empty if each has its vertex's point.
    smooth: Vec<u32>,
    /// The point of each corner with the file's normal; empty if the file has no normals.
    pub(crate) filed: Vec<u32>,
    /// The first point with a normal of the file; all later ones have them, too.
    first_filed: u32,
    /// Whether all corners have normals of the file.
    pub(crate) filed_only: bool,
}

impl CornerPoints {
    /// Returns the point of a corner with the computed normal; `vertices` lists the vertices of all
    /// corners.
    pub(crate) fn smooth(&self, vertices: &[u32], corner: usize) -> u32 {
        let list = if self.smooth.is_empty() { vertices } else { &self.smooth };
        list[corner]
    }

    /// Returns the point of a corner with the file's normal, or else with the computed normal.
    pub(crate) fn filed(&self, vertices: &[u32], corner: usize) -> u32 {
        if self.filed.is_empty() { self.smooth(vertices, corner) } else { self.filed[corner] }
    }

    /// Returns the point of a corner with the file's normal, if its polygon has normals of the
    /// file.
    pub(crate) fn of_file(&self, corner: usize) -> Option<u32> {
        self.filed.get(corner).copied().filter(|point| *point >= self.first_filed)
    }

    /// Returns whether points with computed normals have the numbers of their vertices, at all
    /// corners.
    pub(crate) const fn are_vertices(&self) -> bool {
        self.smooth.is_empty()
    }

    /// Replaces the computed normals and keeps the file's normals. Returns all points and the
    /// points of the corners.
    pub(crate) fn with_computed(
        &self,
        points: &[Point],
        computed: Computed,
        vertices: &[u32],
    ) -> (Vec<Point>, Self) {
        let Computed { points: mut all, of_corners, .. } = computed;
        let mut corners =
            Self { smooth: of_corners, first_filed: index(all.len()), ..Self::default() };
        if !self.filed.is_empty() {
            // The file's points move behind the new computed points.
            let filed = |corner: usize| match self.filed[corner].checked_sub(self.first_filed) {
                Some(place) => corners.first_filed + place,
                None => corners.smooth(vertices, corner),
            };
            corners.filed = (0..vertices.len()).into_par_iter().map(filed).collect();
            corners.filed_only = self.filed_only;
            all.extend_from_slice(&points[self.first_filed as usize..]);
        }
        (all, corners)
    }
}

/// Computes the points of a mesh and the points of its corners. Points with the file's normals
/// follow the points with computed normals.
pub(crate) fn points_and_corners(
    source: &MeshSource,
    lists: &CornerLists,
    starts: &[u32],
) -> (Computed, CornerPoints) {
    let outlines = Outlines { places: &source.positions, corners: &lists.positions, starts };
    let mut computed = Computed::of(&outlines, source.positions.len(), &source.smoothing);
    let smooth = std::mem::take(&mut computed.of_corners);
    let first_filed = index(computed.points.len());
    let mut corners = CornerPoints { smooth, first_filed, ..CornerPoints::default() };
    if !lists.normals.is_empty() {
        corners.filed = filed_points(source, lists, starts, &corners, &mut computed.points);
        corners.filed_only = corners.filed.par_iter().all(|point| *point >= first_filed);
    }
    (computed, corners)
}

/// Gives each corner its polygon's normal if the normals around its vertex cancel out. Returns an
/// empty list if no corner needs this.
fn alone(outlines: &Outlines<'_>, normals: &Normals, points: &mut Vec<Point>) -> Vec<u32> {
    let cancelled: Vec<bool> = normals.sums.par_iter().map(|sum| cancels(*sum)).collect();
    let vertices = outlines.corners;
    let alone = |i: &u32| cancelled[vertices[*i as usize] as usize];
    let alone: Vec<u32> = (0..index(vertices.len())).into_par_iter().filter(alone).collect();
    let mut smooth = Vec::new();
    // The corners of a polygon follow each other, so its normal is computed once for all of them.
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

/// Gives corners the file's normals if every corner of the polygon has one. Returns an empty list
/// if this holds for no polygon.
fn filed_points(
    source: &MeshSource,
    lists: &CornerLists,
    starts: &[u32],
    corners: &CornerPoints,
    points: &mut Vec<Point>,
) -> Vec<u32> {
    let CornerLists { positions: vertices, normals, .. } = lists;
    let unit = |normal: &[f32; 3]| math::unit(dvec3(*normal)).map(narrow);
    let units: Vec<Option<[f32; 3]>> = source.normals.par_iter().map(unit).collect();
    let unit = |i: usize| *units.get(normals[i] as usize)?;
    // The points with file normals form a chain at each vertex: `last` is its end, and each entry
    // of `chained` refers to the one before.
    let mut last = vec![NONE; source.positions.len()];
    let mut chained: Vec<(u32, u32)> = Vec::new();
    let first = points.len();
    let mut filed: Vec<u32> =
        (0..vertices.len()).into_par_iter().map(|i| corners.smooth(vertices, i)).collect();
    for polygon in starts.windows(2) {
        let own = polygon[0] as usize..polygon[1] as usize;
        if !own.clone().all(|i| unit(i).is_some()) {
            continue;
        }
        for i in own {
            // Corners of a vertex with equal normals share a point, so search the chain for this
            // normal.
            let (vertex, normal) = (vertices[i], normals[i]);
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
