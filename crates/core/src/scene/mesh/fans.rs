//! Computes the normals of corners if some edges stay sharp.
//!
//! The faces around a vertex fall into fans. The faces of a fan are smooth with each other,
//! directly or through other faces of the fan, and their corners have the mean of the fan's unit
//! normals. The first fan uses the point with the vertex's number; the others have further points.
//!
//! In a fine model nearly every vertex has one fan. This case is found without looking at edges: if
//! the unit normals n_i of k faces have the sum S, then |S| = sum of n_i . S/|S|, so
//!
//!   |S| >= k - 1 + cos(c / 2)
//!
//! holds only if no n_i is farther from S than half of c, the largest angle of a smooth edge, and
//! no two are farther apart than c. The faces must also be connected. At all other vertices, faces
//! are joined edge by edge, in time k log k.

use glam::DVec3;
use rayon::prelude::*;

use crate::base::math;
use crate::scene::mesh::around::Around;
use crate::scene::mesh::index;
use crate::scene::mesh::normals::{cancels, narrow, shown_normal};
use crate::scene::mesh::outlines::Outlines;
use crate::scene::mesh::sets::Sets;
use crate::scene::{Crease, NONE, Point, dvec3};

/// Edges are sharp from this many degrees below the crease angle on. The 60 degrees of a hexagonal
/// bar with three decimals are exact to 0.2 only, and all of its edges have to look alike.
const TOLERANCE: f64 = 0.25;

/// The largest angle in degrees between faces that count as one plane: numbers in files have about
/// six digits.
const PLANE: f64 = 1e-4;

/// The most faces around a vertex or an edge that are compared pair by pair; more are sorted first.
const FEW: usize = 16;

/// The number of vertices that a thread takes at a time.
const BLOCK: usize = 4096;

/// The rule that makes faces around a vertex smooth with each other.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Rule<'a> {
    /// Faces are smooth if they share a smooth edge at the vertex.
    Crease(Limit),
    /// Faces are smooth if they share a smoothing group. Lists the group of each polygon, 0 for
    /// none.
    Groups(&'a [u32]),
}

/// The largest angle c of smooth edges, in the forms that comparisons need.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    /// cos^2(c / 2)
    cos2: f64,
    /// sin^2(c / 2)
    sin2: f64,
    /// 1 - cos(c / 2)
    slack: f64,
}

impl Limit {
    pub(crate) fn new(crease: Crease) -> Self {
        let half = |degrees: f64| degrees.to_radians() / 2.0;
        let largest = (crease.get() - TOLERANCE).max(PLANE);
        let (sin, cos) = libm::sincos(half(largest));
        // The quick check leaves room for rounding.
        let slack = 1.0 - libm::cos(half(largest - PLANE / 2.0));
        Self { cos2: cos * cos, sin2: sin * sin, slack }
    }

    /// Returns whether the angle between two unit vectors is at most c:
    ///
    ///   tan(angle / 2) = |a - b| / |a + b|
    ///
    /// The formula is accurate for small and for large angles; Kahan, "How Futile are Mindless
    /// Assessments of Roundoff in Floating-Point Computation?", 2006.
    fn joins(&self, a: DVec3, b: DVec3) -> bool {
        (a - b).length_squared() * self.cos2 <= (a + b).length_squared() * self.sin2
    }
}

/// Returns the points of all corners, beginning with one for each vertex, and the point of each
/// corner. The second list is empty if each corner has its vertex's point. `sums` are the sums of
/// the unit normals around each vertex.
pub(crate) fn fan_points(
    outlines: &Outlines<'_>,
    sums: &[DVec3],
    rule: Rule<'_>,
) -> (Vec<Point>, Vec<u32>) {
    let around = Around::of(outlines, sums.len());
    let sorter = Sorter { outlines, sums, normals: around.large_normals(outlines), around, rule };
    // Blocks of vertices are computed in parallel. The first points have the numbers of vertices.
    let mut points = vec![Point { position: 0, normal: [0.0; 3] }; sums.len()];
    let blocks = points.par_chunks_mut(BLOCK).enumerate();
    let blocks: Vec<Block> = blocks.map(|(i, own)| sorter.block(i * BLOCK, own)).collect();
    drop(sorter);
    let mut of_corners = Vec::new();
    if blocks.iter().any(|block| !block.corners.is_empty()) {
        of_corners = outlines.corners.to_vec();
    }
    // Further points follow block by block, so the result does not depend on the threads.
    points.reserve_exact(blocks.iter().map(|block| block.points.len()).sum());
    for block in blocks {
        let first = index(points.len());
        for (corner, place) in block.corners {
            of_corners[corner as usize] = first + place;
        }
        points.extend(block.points);
    }
    (points, of_corners)
}

/// The further points of a block of vertices.
#[derive(Debug, Default)]
struct Block {
    points: Vec<Point>,
    /// Corners with further points, each with the point's index in the block.
    corners: Vec<(u32, u32)>,
}

/// The faces around one vertex while they are sorted into fans. Faces have the order of their
/// polygons; faces without area are left out.
#[derive(Debug, Default)]
struct Fans {
    polygons: Vec<u32>,
    normals: Vec<DVec3>,
    /// Each corner with the index of its face.
    corners: Vec<(u32, u32)>,
    /// The faces of each fan.
    sets: Sets,
    sums: Vec<DVec3>,
    /// The index of each face's point in the block; [`NONE`] for the vertex's point.
    points: Vec<u32>,
    /// The other ends of edges, or smoothing groups, each paired with a face.
    keys: Vec<(u32, u32)>,
}

struct Sorter<'a> {
    outlines: &'a Outlines<'a>,
    sums: &'a [DVec3],
    /// The normals of polygons, if computing them again is slow.
    normals: Option<Vec<Option<DVec3>>>,
    around: Around,
    rule: Rule<'a>,
}

impl Sorter<'_> {
    /// Fills in the points of the vertices from `first` on.
    fn block(&self, first: usize, points: &mut [Point]) -> Block {
        let mut block = Block::default();
        let mut fans = Fans::default();
        for (vertex, point) in (first..).zip(points) {
            *point = Point { position: index(vertex), normal: shown_normal(None) };
            let corners = self.around.corners(vertex);
            let sum = self.sums[vertex];
            if self.is_one_fan(corners, sum) {
                point.normal = shown_normal(math::unit(sum));
            } else {
                self.find_fans(corners, point.position, &mut fans);
                Self::add_points(&mut fans, point, &mut block);
            }
        }
        block
    }

    /// Returns the normal of a polygon; `None` for one without area.
    fn normal(&self, polygon: usize) -> Option<DVec3> {
        match &self.normals {
            Some(normals) => normals[polygon],
            None => self.outlines.normal(polygon),
        }
    }

    /// Returns whether a quick check shows that all faces around a vertex form one fan. Faces
    /// without area, and faces that use the vertex twice, make the sum of the normals too short to
    /// pass.
    #[expect(clippy::cast_precision_loss, reason = "few faces")]
    fn is_one_fan(&self, corners: &[u32], sum: DVec3) -> bool {
        if corners.len() < 2 {
            return true;
        }
        match self.rule {
            Rule::Crease(limit) => {
                corners.len() <= FEW
                    && sum.length() >= corners.len() as f64 - limit.slack
                    && self.is_connected(corners)
            }
            Rule::Groups(groups) => {
                let group = |corner: &u32| groups[self.around.polygon(*corner)];
                let own = group(&corners[0]);
                own != 0 && corners.iter().all(|corner| group(corner) == own) && !cancels(sum)
            }
        }
    }

    /// Returns whether at most `FEW` faces around a vertex are connected edge by edge.
    fn is_connected(&self, corners: &[u32]) -> bool {
        let mut sides = [[NONE; 2]; FEW];
        for (sides, corner) in sides.iter_mut().zip(corners) {
            *sides = self.neighbours(*corner);
        }
        let sides = &mut sides[..corners.len()];
        // The two ends of a chain of faces, to which the other faces are appended.
        let [mut a, mut b] = sides[0];
        for done in 1..sides.len() {
            let meets = |[p, q]: &[u32; 2]| [a, b].contains(p) || [a, b].contains(q);
            let Some(next) = sides[done..].iter().position(meets) else { return false };
            sides.swap(done, done + next);
            match sides[done] {
                [p, q] if p == b => b = q,
                [p, q] if q == b => b = p,
                [p, q] if p == a => a = q,
                [p, _] => a = p,
            }
        }
        true
    }

    /// Returns the vertices before and after a corner of a polygon.
    #[inline]
    fn neighbours(&self, corner: u32) -> [u32; 2] {
        let own = self.around.polygon(corner);
        let [begin, end] = [own, own + 1].map(|i| self.outlines.starts[i]);
        let before = if corner == begin { end - 1 } else { corner - 1 };
        let after = if corner + 1 == end { begin } else { corner + 1 };
        [before, after].map(|corner| self.outlines.corners[corner as usize])
    }

    /// Sorts the faces around a vertex into fans.
    fn find_fans(&self, corners: &[u32], vertex: u32, fans: &mut Fans) {
        fans.polygons.clear();
        fans.normals.clear();
        fans.corners.clear();
        // A polygon that uses the vertex twice is one face with two corners.
        for corner in corners {
            let polygon = self.around.polygon(*corner);
            if fans.polygons.last() != Some(&index(polygon)) {
                let Some(normal) = self.normal(polygon) else { continue };
                fans.polygons.push(index(polygon));
                fans.normals.push(normal);
            }
            fans.corners.push((*corner, index(fans.polygons.len() - 1)));
        }
        fans.sets.reset(fans.polygons.len());
        let mut keys = std::mem::take(&mut fans.keys);
        keys.clear();
        match self.rule {
            Rule::Crease(limit) => {
                // Faces at one edge have the same other end, so sorting brings them together.
                for (corner, face) in &fans.corners {
                    let others = self.neighbours(*corner).into_iter();
                    keys.extend(
                        others.filter(|other| *other != vertex).map(|other| (other, *face)),
                    );
                }
                keys.sort_unstable();
                keys.dedup();
                for edge in keys.chunk_by(|a, b| a.0 == b.0) {
                    self.join_at_edge(edge, vertex, limit, fans);
                }
            }
            Rule::Groups(groups) => {
                let group = |(face, polygon): (u32, &u32)| (groups[*polygon as usize], face);
                // After sorting, faces of one group follow each other.
                keys.extend((0..).zip(&fans.polygons).map(group).filter(|(group, _)| *group != 0));
                keys.sort_unstable();
                for two in keys.windows(2).filter(|two| two[0].0 == two[1].0) {
                    fans.sets.join(two[0].1, two[1].1);
                }
            }
        }
        fans.keys = keys;
    }

    /// Joins the faces at one edge that are smooth with each other. Each entry of `edge` is the
    /// other end of the edge and a face.
    fn join_at_edge(&self, edge: &[(u32, u32)], vertex: u32, limit: Limit, fans: &mut Fans) {
        if edge.len() <= FEW {
            for (i, (_, a)) in edge.iter().enumerate() {
                for (_, b) in &edge[i + 1..] {
                    Self::join_two(*a, *b, limit, fans);
                }
            }
            return;
        }
        // The normals of flat faces at an edge lie on a circle about it. If two faces are smooth
        // with each other, so are all neighbours between them: comparing neighbours is enough.
        let sorted = self.sorted_about_edge(edge, vertex, fans);
        for (a, b) in sorted.iter().zip(sorted.iter().cycle().skip(1)) {
            Self::join_two(*a, *b, limit, fans);
        }
    }

    fn join_two(a: u32, b: u32, limit: Limit, fans: &mut Fans) {
        if limit.joins(fans.normals[a as usize], fans.normals[b as usize]) {
            fans.sets.join(a, b);
        }
    }

    /// Sorts the faces at an edge by the angles of their normals about it.
    fn sorted_about_edge(&self, edge: &[(u32, u32)], vertex: u32, fans: &Fans) -> Vec<u32> {
        let place = |vertex: u32| dvec3(self.outlines.places[vertex as usize]);
        let along = math::unit(place(edge[0].0) - place(vertex)).unwrap_or(DVec3::Z);
        let (x, y) = along.any_orthonormal_pair();
        let angle = |(_, face): &(u32, u32)| {
            let normal = fans.normals[*face as usize];
            (libm::atan2(normal.dot(y), normal.dot(x)), *face)
        };
        let mut sorted: Vec<(f64, u32)> = edge.iter().map(angle).collect();
        sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        sorted.into_iter().map(|(_, face)| face).collect()
    }

    /// Gives each fan around a vertex a point; the first fan gets the vertex's point. If the
    /// normals of a fan cancel out, each of its faces gets a point.
    fn add_points(fans: &mut Fans, own: &mut Point, block: &mut Block) {
        // The sum of a fan's normals is kept at its first face.
        let faces = 0..index(fans.polygons.len());
        fans.sums.clear();
        fans.sums.resize(fans.polygons.len(), DVec3::ZERO);
        for face in faces.clone() {
            let first = fans.sets.first(face);
            fans.sums[first as usize] += fans.normals[face as usize];
        }
        // The first face of a fan adds its point. Later faces of the fan find it there.
        fans.points.clear();
        for face in faces {
            let first = fans.sets.first(face);
            let sum = fans.sums[first as usize];
            let of_fan = if cancels(sum) {
                narrow(fans.normals[face as usize])
            } else if first == face {
                shown_normal(math::unit(sum))
            } else {
                let point = fans.points[first as usize];
                fans.points.push(point);
                continue;
            };
            if face == 0 {
                own.normal = of_fan;
                fans.points.push(NONE);
            } else {
                fans.points.push(index(block.points.len()));
                block.points.push(Point { normal: of_fan, ..*own });
            }
        }
        // Corners without an entry have their vertex's point.
        let moved =
            fans.corners.iter().map(|(corner, face)| (*corner, fans.points[*face as usize]));
        block.corners.extend(moved.filter(|(_, point)| *point != NONE));
    }
}
