//! The shape of a model: polygons of any size over shared vertices.
//!
//! A vertex is a `v` statement of the file. Polygons that refer to the same `v` share it, even
//! across groups. Lines and points ([`Stroke`]) refer to vertices, too. For lighting, a vertex and
//! a normal make a [`Point`]; each corner of a polygon has one point with the computed normal and
//! one with the file's normal.
//!
//! Data that few pictures need is computed on first use (`cache`). Meshes that differ only in their
//! computed normals share everything else.
//!
//! The fields are private and the constructor checks them, so no index is ever out of range.

pub(super) mod accelerator;
mod around;
mod bodies;
mod build;
pub(super) mod cache;
mod closed;
pub(super) mod edges;
mod fans;
mod normals;
mod offset;
pub(super) mod outlines;
mod placeholder;
mod points;
mod sets;
mod splits;
pub(super) mod strokes;
mod tangents;

use glam::{DMat4, DVec3};

pub use bodies::ClosedBodies;
pub use offset::split_positions;

use super::{Bounds, Smoothing, Stroke};
use crate::base::Shared;
use crate::scene::mesh::cache::{Found, FoundOfShape};
use crate::scene::mesh::points::CornerPoints;

/// Marks a missing index.
pub const NONE: u32 = u32::MAX;

/// The source of a mesh. Indices count from 0.
#[derive(Clone, Debug, Default)]
pub struct MeshSource {
    /// The origin of the positions in object space; finite.
    pub offset: DVec3,
    /// The positions of vertices, relative to the offset; all finite.
    pub positions: Vec<[f32; 3]>,
    /// Red, green and blue of each vertex, 0 to 1; empty if the file has no colours.
    pub colors: Vec<[f32; 3]>,
    /// Texture coordinates, with (0, 0) at the lower left; all finite.
    pub uvs: Vec<[f32; 2]>,
    /// Normals of the file, of any length; all finite.
    pub normals: Vec<[f32; 3]>,
    /// The corners of all polygons, in the order of the polygons.
    pub corners: Vec<SourceCorner>,
    /// The number of corners of each polygon: 3 or more.
    pub arities: Vec<u32>,
    /// The part that each polygon belongs to.
    pub polygon_parts: Vec<u32>,
    /// The lines and points.
    pub strokes: Vec<Stroke>,
    /// The parts; at least one if there is a polygon or a stroke.
    pub parts: Vec<Part>,
    /// The file's names for each part; empty if the mesh is not from a file.
    pub part_names: Vec<PartNames>,
    /// The rule for sharing computed normals between polygons.
    pub smoothing: Smoothing,
}

impl MeshSource {
    /// Creates one part with polygons of these corners and corner counts, without vertices.
    pub fn of_polygons(corners: impl IntoIterator<Item = SourceCorner>, arities: Vec<u32>) -> Self {
        Self {
            corners: corners.into_iter().collect(),
            polygon_parts: vec![0; arities.len()],
            arities,
            parts: vec![Part { name: String::new(), material: None }],
            ..Self::default()
        }
    }

    /// Adds a polygon to the first part.
    pub fn push_polygon(&mut self, corners: &[SourceCorner]) {
        self.corners.extend_from_slice(corners);
        self.arities.push(index(corners.len()));
        self.polygon_parts.push(0);
    }
}

/// A corner of a polygon in the file's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourceCorner {
    /// The corner's vertex.
    pub position: u32,
    /// The corner's texture coordinates, or [`NONE`].
    pub uv: u32,
    /// The corner's normal, or [`NONE`].
    pub normal: u32,
}

impl SourceCorner {
    /// Returns a corner without texture coordinates and without a normal.
    pub const fn bare(position: u32) -> Self {
        Self { position, uv: NONE, normal: NONE }
    }
}

/// A run of polygons, lines and points with the same `o`, `g` and `usemtl` in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// The part's name in the file.
    pub name: String,
    /// The part's material, as an index into the model's list; `None` if the file's material is
    /// missing.
    pub material: Option<u32>,
}

/// The file's names for a part, by statement; each is `None` before the first statement of its
/// kind. Exports keep them apart, while the outline shows [`Part::name`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct PartNames {
    /// The last `o`.
    pub object: Option<String>,
    /// The last `g` after that `o`.
    pub group: Option<String>,
    /// The last `usemtl`, even if the material does not exist.
    pub material: Option<String>,
}

/// A corner of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// The corner's vertex.
    pub position: u32,
    /// The corner's texture coordinates, or [`NONE`].
    pub uv: u32,
    /// The point with the computed normal.
    pub smooth: u32,
    /// The point with the file's normal if every corner of the polygon has one, else `smooth`.
    pub filed: u32,
}

/// A vertex with one of its normals, at which light is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The vertex.
    pub position: u32,
    /// The normal, of length 1, in object space.
    pub normal: [f32; 3],
}

/// A triangle of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// The corners, as indices into [`Mesh::corners`], with the orientation of the polygon.
    pub corners: [u32; 3],
    /// The polygon.
    pub polygon: u32,
}

/// The shape of a model: polygons over shared vertices, with the data derived from them.
pub struct Mesh {
    pub(super) shape: Shared<Shape>,
    pub(super) smoothing: Smoothing,
    pub(super) points: Vec<Point>,
    pub(super) corners: CornerPoints,
    /// Whether each polygon is one triangle.
    pub(super) triangles_only: bool,
    /// Whether the mesh is a box that replaces a missing shape.
    pub(super) is_placeholder: bool,
    pub(super) found: Found,
}

/// The part of a mesh that does not depend on computed normals.
pub(super) struct Shape {
    pub(super) offset: DVec3,
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) uvs: Vec<[f32; 2]>,
    /// The vertex of each corner.
    pub(super) corners: Vec<u32>,
    /// The texture coordinates of each corner, or [`NONE`]; empty if no corner has one.
    pub(super) corner_uvs: Vec<u32>,
    pub(super) starts: Vec<u32>,
    pub(super) polygon_parts: Vec<u32>,
    pub(super) strokes: Vec<Stroke>,
    pub(super) without_area: Vec<u32>,
    /// The vertices that no face and no stroke uses, ascending.
    pub(super) unused: Vec<u32>,
    pub(super) parts: Vec<Part>,
    pub(super) part_names: Vec<PartNames>,
    pub(super) bounds: Option<Bounds>,
    pub(super) mean: DVec3,
    pub(super) found: FoundOfShape,
}

impl PartialEq for Shape {
    fn eq(&self, other: &Self) -> bool {
        self.offset == other.offset
            && self.positions == other.positions
            && self.colors == other.colors
            && self.uvs == other.uvs
            && self.corners == other.corners
            && self.corner_uvs == other.corner_uvs
            && self.starts == other.starts
            && self.polygon_parts == other.polygon_parts
            && self.strokes == other.strokes
            && self.parts == other.parts
            && self.part_names == other.part_names
    }
}

/// Shows the source data only; derived data follows from it.
impl std::fmt::Debug for Mesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Mesh")
            .field("positions", &self.shape.positions)
            .field("corners", &self.shape.corners)
            .field("starts", &self.shape.starts)
            .field("parts", &self.shape.parts)
            .finish_non_exhaustive()
    }
}

/// The reasons why a mesh cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeshError {
    /// A list has the wrong length.
    #[error("the mesh's list of {0} has the wrong length")]
    Length(&'static str),
    /// A number is infinite or NaN.
    #[error("the mesh has {0} that are not finite")]
    NotFinite(&'static str),
    /// An index points past the end.
    #[error("the mesh refers to {0} number {1}, which does not exist")]
    Index(&'static str, u32),
    /// A polygon has fewer than three corners.
    #[error("polygon {0} has fewer than three corners")]
    Short(u32),
    /// A list has more than 2^32 - 2 elements.
    #[error("the mesh has more {0} than can be numbered")]
    TooMany(&'static str),
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        self.shape == other.shape
            && self.smoothing == other.smoothing
            && self.points == other.points
            && self.corners == other.corners
            && self.is_placeholder == other.is_placeholder
    }
}

impl Mesh {
    /// Returns the origin of positions, bounds and mean in object space. It is 0 unless the model
    /// is far from its origin.
    pub fn offset(&self) -> DVec3 {
        self.shape.offset
    }

    /// Returns the transformation from the space of the positions to object space.
    pub fn object_from_mesh(&self) -> DMat4 {
        DMat4::from_translation(self.shape.offset)
    }

    /// Returns the positions of all vertices, relative to [`Self::offset`].
    pub fn positions(&self) -> &[[f32; 3]] {
        &self.shape.positions
    }

    /// Returns the positions of the vertices that a face or a stroke uses, relative to
    /// [`Self::offset`]; all positions if the mesh has neither.
    pub fn used_positions(&self) -> impl Iterator<Item = DVec3> {
        used(&self.shape.positions, &self.shape.unused)
    }

    /// Returns the positions of the corners of all polygons and of the ends of all strokes in some
    /// parts, relative to [`Self::offset`]. A shared vertex comes once for each of them.
    pub fn positions_of_parts(
        &self,
        some: impl Fn(u32) -> bool + Copy,
    ) -> impl Iterator<Item = DVec3> {
        let shape = &self.shape;
        let polygons = shape.polygon_parts.iter().zip(shape.starts.windows(2));
        let corners = polygons
            .filter(move |(part, _)| some(**part))
            .flat_map(|(_, ends)| &shape.corners[ends[0] as usize..ends[1] as usize]);
        let strokes = shape.strokes.iter().filter(move |stroke| some(stroke.part));
        let ends = strokes.flat_map(|stroke| &stroke.ends);
        corners.chain(ends).map(|vertex| dvec3(shape.positions[*vertex as usize]))
    }

    /// Returns the vertices that no face and no stroke uses, ascending.
    pub fn unused_vertices(&self) -> &[u32] {
        &self.shape.unused
    }

    /// Returns red, green and blue of each vertex; empty if the file has no colours.
    pub fn colors(&self) -> &[[f32; 3]] {
        &self.shape.colors
    }

    /// Returns all texture coordinates.
    pub fn uvs(&self) -> &[[f32; 2]] {
        &self.shape.uvs
    }

    /// Returns the vertices with their normals. The first points have the order of
    /// [`Self::positions`] and computed normals, one for each vertex. Further computed normals
    /// follow, then the file's normals.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Returns the number of polygons.
    pub fn polygon_count(&self) -> usize {
        self.shape.polygon_parts.len()
    }

    /// Returns the corners of one polygon.
    pub fn polygon(&self, polygon: u32) -> &[Corner] {
        &self.corners()[self.corners_of(polygon)]
    }

    /// Returns the range of one polygon's corners in [`Self::corners`].
    pub fn corners_of(&self, polygon: u32) -> std::ops::Range<usize> {
        self.shape.starts[polygon as usize] as usize
            ..self.shape.starts[polygon as usize + 1] as usize
    }

    /// Returns whether a corner of a polygon has texture coordinates.
    pub fn has_uvs(&self, polygon: u32) -> bool {
        let uvs = self.shape.corner_uvs.get(self.corners_of(polygon));
        uvs.is_some_and(|uvs| uvs.iter().any(|uv| *uv != NONE))
    }

    /// Returns the part that each polygon belongs to.
    pub fn polygon_parts(&self) -> &[u32] {
        &self.shape.polygon_parts
    }

    /// Returns the polygons without area, in ascending order; they have no normal.
    pub fn without_area(&self) -> &[u32] {
        &self.shape.without_area
    }

    /// Returns the mean of a polygon's corners.
    pub fn polygon_centre(&self, polygon: u32) -> DVec3 {
        mean(self.outlines().of(polygon as usize))
    }

    /// Returns the range of one polygon's triangles in [`Self::triangles`].
    pub fn triangles_of(&self, polygon: u32) -> std::ops::Range<usize> {
        // Every earlier polygon has two triangles less than it has corners.
        let corners = self.corners_of(polygon);
        let before = 2 * polygon as usize;
        corners.start - before..corners.end - before - 2
    }

    /// Returns the runs of the file's `o`, `g` and `usemtl`.
    pub fn parts(&self) -> &[Part] {
        &self.shape.parts
    }

    /// Returns the file's names for a part; all `None` if the mesh is not from a file.
    pub fn part_names(&self, part: u32) -> &PartNames {
        const NAMELESS: &PartNames = &PartNames { object: None, group: None, material: None };
        self.shape.part_names.get(part as usize).unwrap_or(NAMELESS)
    }

    /// Returns whether any polygon has normals of the file.
    pub const fn has_file_normals(&self) -> bool {
        !self.corners.filed.is_empty()
    }

    /// Returns whether every polygon has normals of the file.
    pub const fn has_file_normals_only(&self) -> bool {
        self.has_file_normals() && self.corners.filed_only
    }

    /// Returns the rule for sharing computed normals between polygons.
    pub const fn smoothing(&self) -> &Smoothing {
        &self.smoothing
    }

    /// Returns the extent of [`Self::used_positions`]; `None` without vertices.
    pub fn bounds(&self) -> Option<Bounds> {
        self.shape.bounds
    }

    /// Returns the mean of [`Self::used_positions`], the target of orbit cameras.
    pub fn mean(&self) -> DVec3 {
        self.shape.mean
    }
}

/// Leaves out the unused positions, unless all are unused; `unused` is ascending.
fn used<'a>(positions: &'a [[f32; 3]], unused: &'a [u32]) -> impl Iterator<Item = DVec3> {
    let mut unused = if unused.len() == positions.len() { &[] } else { unused };
    let is_used = move |(vertex, _): &(u32, &[f32; 3])| match unused {
        [first, rest @ ..] if first == vertex => {
            unused = rest;
            false
        }
        _ => true,
    };
    (0..).zip(positions).filter(is_used).map(|(_, p)| dvec3(*p))
}

/// Returns the normal of a polygon, with twice its area as length:
///
///   n = sum over sides p, q of (p - o) x (q - o),   o the first corner
///
/// This is Newell's method with corners relative to the first one, so small polygons far from the
/// origin stay exact. Sutherland, Sproull and Schumacker, "A Characterization of Ten Hidden-Surface
/// Algorithms", ACM Computing Surveys 1974.
pub fn newell(corners: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let Some(origin) = corners.clone().next() else { return DVec3::ZERO };
    let from = corners.clone().map(|p| p - origin);
    let to = corners.skip(1).map(|p| p - origin);
    from.zip(to).fold(DVec3::ZERO, |sum, (p, q)| sum + p.cross(q))
}

/// Converts three numbers of a file to double precision.
pub fn dvec3(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[expect(clippy::cast_precision_loss, reason = "fewer than 2^32 points")]
pub(super) fn mean(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let (sum, count) = points.fold((DVec3::ZERO, 0_usize), |(sum, n), p| (sum + p, n + 1));
    sum / count.max(1) as f64
}

/// Converts an index to 32 bits. `check` has made sure that it fits.
pub(super) fn index(i: usize) -> u32 {
    u32::try_from(i).expect("the constructor has checked that everything can be numbered")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds a roof: two squares that meet at a right angle along the side from vertex 0 to
    /// vertex 1.
    fn roof() -> MeshSource {
        MeshSource {
            positions: vec![
                [0.0, 1.0, 0.0],
                [0.0, 1.0, 1.0],
                [-1.0, 0.0, 1.0],
                [-1.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 0.0, 1.0],
            ],
            ..MeshSource::of_polygons([0, 3, 2, 1, 0, 1, 5, 4].map(SourceCorner::bare), vec![4, 4])
        }
    }

    #[test]
    fn the_normal_on_the_ridge_is_the_mean_of_both_sides() {
        let mesh = Mesh::new(roof()).unwrap();
        let half = std::f32::consts::FRAC_1_SQRT_2;
        assert_eq!(mesh.points()[0].normal, [0.0, 1.0, 0.0]);
        assert_eq!(mesh.polygon_normals(), [[-half, half, 0.0], [half, half, 0.0]]);
    }

    #[test]
    fn a_radius_is_kept_for_the_last_placement() {
        let mesh = Mesh::new(roof()).unwrap();
        let [once, twice] = [1.0, 2.0].map(|scale| DMat4::from_scale(DVec3::splat(scale)));
        assert_eq!(mesh.radius_of(once, || 1.0), 1.0);
        assert_eq!(mesh.radius_of(once, || 3.0), 1.0, "not computed again");
        assert_eq!(mesh.radius_of(twice, || 2.0), 2.0);
        assert_eq!(mesh.radius_of(once, || 1.0), 1.0);
    }

    #[test]
    fn a_shared_side_is_one_edge_of_two_polygons() {
        let mesh = Mesh::new(roof()).unwrap();
        assert_eq!(mesh.edges().len(), 7);
        let ridge = mesh.edges().iter().find(|edge| edge.ends == [0, 1]).unwrap();
        assert_eq!(mesh.edge_polygons(ridge), [0, 1]);
    }

    #[test]
    fn opposite_normals_give_each_corner_its_own_polygons_normal() {
        let mut source = roof();
        // The same square twice, seen from opposite sides.
        source.corners = [0, 3, 2, 1, 1, 2, 3, 0].map(SourceCorner::bare).to_vec();
        let mesh = Mesh::new(source).unwrap();
        for polygon in 0..2 {
            for corner in mesh.polygon(polygon) {
                let normal = mesh.points()[corner.smooth as usize].normal;
                assert_eq!(normal, mesh.polygon_normals()[polygon as usize]);
            }
        }
    }

    #[test]
    fn file_normals_count_only_where_every_corner_has_one() {
        let mut source = roof();
        source.normals = vec![[0.0, 0.0, 2.0]];
        for corner in &mut source.corners[..5] {
            corner.normal = 0;
        }
        let mesh = Mesh::new(source).unwrap();
        assert!(
            mesh.polygon(0)
                .iter()
                .all(|c| mesh.points()[c.filed as usize].normal == [0.0, 0.0, 1.0])
        );
        assert!(mesh.polygon(1).iter().all(|c| c.filed == c.smooth));
    }

    #[test]
    fn indices_out_of_range_and_nan_positions_are_refused() {
        let mut source = roof();
        source.corners[3].position = 6;
        assert_eq!(Mesh::new(source).unwrap_err(), MeshError::Index("vertex", 6));
        let mut source = roof();
        source.positions[0][1] = f32::NAN;
        assert_eq!(Mesh::new(source).unwrap_err(), MeshError::NotFinite("positions"));
    }
}
