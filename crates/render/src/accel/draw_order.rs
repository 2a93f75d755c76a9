//! The draw order of a mesh: the order of triangles and vertices that draws fastest.
//!
//! Triangles follow a Morton curve through the mesh's box, and vertices are numbered by first use,
//! so neighbours in space are neighbours in memory. Each triangle keeps its number in the file's
//! order, which decides between equal depths. The draw order therefore does not change the picture.
//! Morton, "A Computer Oriented Geodetic Data Base", IBM 1966.

use glam::DVec3;
use prefetch_index::prefetch_index;
use rayon::prelude::*;

use super::clusters::{Cluster, DrawTriangle, clusters};
use marraztu_core::base::lists::sorted_by_keys;
use marraztu_core::scene::{
    Accelerator, AcceleratorPlace, Bounds, Mesh, NONE, NormalSource, dvec3,
};

/// The triangles and vertices of a mesh in their fastest draw order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawOrder {
    /// The x coordinates of the vertices that triangles use.
    pub x: Vec<f32>,
    /// The y coordinates; see [`Self::x`].
    pub y: Vec<f32>,
    /// The z coordinates; see [`Self::x`].
    pub z: Vec<f32>,
    /// The triangles.
    pub triangles: Vec<DrawTriangle>,
    /// The clusters of the triangles; empty if they were not computed.
    pub clusters: Vec<Cluster>,
    /// The index in [`Self::triangles`] of each triangle of the mesh; empty if it equals the
    /// number.
    places: Vec<u32>,
    /// The vertices of each triangle of the mesh, for direct access during shading: a million
    /// triangles, lit at vertices, take 0.93 of the time. Empty if [`Self::places`] is.
    vertices_by_number: Vec<[u32; 3]>,
    smooth: Points,
    /// The points with normals of the file; empty if the file has no normals.
    filed: Points,
}

/// The points of a mesh with one kind of normals, numbered by first use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Points {
    /// The points of each triangle, in the order of [`DrawOrder::triangles`]. Empty if each vertex
    /// has one normal: points and vertices then have the same numbers.
    of: Vec<[u32; 3]>,
    /// The unit normals of the points.
    pub normals: Vec<[f32; 3]>,
    /// The vertices of the points, as indices into [`DrawOrder::x`]; empty if both have the same
    /// numbers.
    pub vertices: Vec<u32>,
}

impl Points {
    /// Returns the points of a triangle with these vertices, in the draw order `order`.
    #[inline(always)]
    #[must_use]
    pub fn of(&self, order: &DrawOrder, number: u32, vertices: [u32; 3]) -> [u32; 3] {
        if self.of.is_empty() { vertices } else { self.of[order.place(number) as usize] }
    }

    /// Prefetches the normals at some vertices, if points and vertices have the same numbers.
    #[inline(always)]
    pub fn prefetch(&self, vertices: [u32; 3]) {
        if self.of.is_empty() {
            vertices.iter().for_each(|vertex| prefetch_index(&self.normals, *vertex as usize));
        }
    }
}

impl Accelerator for DrawOrder {
    const PLACE: AcceleratorPlace = AcceleratorPlace::DrawOrder;

    /// Sorts the triangles along a Morton curve.
    fn build(mesh: &Mesh) -> Self {
        let Some(bounds) = mesh.bounds() else { return Self::default() };
        let count = mesh.triangle_count();
        let key = |number: usize| morton(mesh, bounds, vertices(mesh, number));
        // A key has thirty bits, ten for each axis.
        let numbers = sorted_by_keys((0..count).into_par_iter().map(key).collect(), 30);
        // The inverse permutation leads from the number of a triangle to its place.
        let mut places = vec![0; count];
        for (place, number) in (0..).zip(&numbers) {
            places[*number as usize] = place;
        }
        let triangle = |number| DrawTriangle { vertices: vertices(mesh, number as usize), number };
        let triangles = numbers.into_par_iter().map(triangle).collect();
        let mut order = Self { places, ..Self::of(mesh, triangles) };
        let vertices = |place: &u32| order.triangles[*place as usize].vertices;
        order.vertices_by_number = order.places.par_iter().map(vertices).collect();
        let place = |vertex| DVec3::from_array(order.position(vertex));
        Self { clusters: clusters(&order.triangles, place), ..order }
    }
}

impl DrawOrder {
    /// Keeps the order of the file.
    pub(super) fn as_filed(mesh: &Mesh) -> Self {
        let triangle = |number| DrawTriangle { vertices: vertices(mesh, number as usize), number };
        let numbers = (0..index(mesh.triangle_count())).into_par_iter();
        Self::of(mesh, numbers.map(triangle).collect())
    }

    /// Numbers the vertices of these triangles by first use. On entry, `triangles` refer to
    /// vertices of the mesh.
    fn of(mesh: &Mesh, mut triangles: Vec<DrawTriangle>) -> Self {
        // Each vertex gets the next number at its first use.
        let mut places = vec![NONE; mesh.positions().len()];
        let mut used = Vec::with_capacity(places.len());
        for vertex in triangles.iter_mut().flat_map(|triangle| &mut triangle.vertices) {
            let place = &mut places[*vertex as usize];
            if *place == NONE {
                *place = index(used.len());
                used.push(*vertex);
            }
            *vertex = *place;
        }
        // Freed early: the table is as large as a row of coordinates.
        drop(places);
        let coordinate = |axis: usize| -> Vec<f32> {
            used.par_iter().map(|vertex| mesh.positions()[*vertex as usize][axis]).collect()
        };
        let [x, y, z] = [0, 1, 2].map(coordinate);
        let mut order = Self { x, y, z, triangles, ..Self::default() };
        // With one normal at each vertex, points are vertices and need no separate numbers.
        order.smooth = if mesh.has_smooth_vertices() {
            let normal = |vertex: &u32| mesh.points()[*vertex as usize].normal;
            Points {
                of: Vec::new(),
                normals: used.par_iter().map(normal).collect(),
                vertices: Vec::new(),
            }
        } else {
            order.points_of(mesh, NormalSource::Computed)
        };
        if mesh.has_file_normals() {
            order.filed = order.points_of(mesh, NormalSource::File);
        }
        order
    }

    /// Prefetches the data that [`Self::vertices_of`] reads.
    #[inline(always)]
    pub fn prefetch(&self, number: u32) {
        prefetch_index(&self.vertices_by_number, number as usize);
    }

    /// Returns the vertices of a triangle of the mesh, as indices into [`Self::x`].
    #[inline(always)]
    #[must_use]
    pub fn vertices_of(&self, number: u32) -> [u32; 3] {
        match self.vertices_by_number.get(number as usize) {
            Some(vertices) => *vertices,
            None => self.triangles[number as usize].vertices,
        }
    }

    /// Returns the index of a triangle of the mesh in [`Self::triangles`].
    #[inline(always)]
    fn place(&self, number: u32) -> u32 {
        if self.places.is_empty() { number } else { self.places[number as usize] }
    }

    /// Returns the points with one kind of normals.
    #[must_use]
    pub const fn points(&self, source: NormalSource) -> &Points {
        match source {
            NormalSource::File if !self.filed.normals.is_empty() => &self.filed,
            // A mesh without normals in its file shows the computed ones.
            NormalSource::File | NormalSource::Computed => &self.smooth,
        }
    }

    fn points_of(&self, mesh: &Mesh, source: NormalSource) -> Points {
        // Points are numbered by first use, like vertices.
        let mut points = Points::default();
        let mut places = vec![NONE; mesh.points().len()];
        for triangle in &self.triangles {
            let corners = mesh.triangle(triangle.number as usize);
            let of = std::array::from_fn(|i| {
                let point = mesh.point_of(corners[i], source) as usize;
                if places[point] == NONE {
                    places[point] = index(points.normals.len());
                    points.normals.push(mesh.points()[point].normal);
                    points.vertices.push(triangle.vertices[i]);
                }
                places[point]
            });
            points.of.push(of);
        }
        let of_vertices = self.triangles.iter().map(|triangle| triangle.vertices);
        if points.of.iter().copied().eq(of_vertices) {
            // Both are numbered by first use, so equal lists mean equal numbers.
            (points.of, points.vertices) = (Vec::new(), Vec::new());
        }
        points
    }

    /// Returns the position of a vertex.
    #[inline(always)]
    #[must_use]
    pub fn position(&self, vertex: u32) -> [f64; 3] {
        let i = vertex as usize;
        [f64::from(self.x[i]), f64::from(self.y[i]), f64::from(self.z[i])]
    }
}

/// Returns the vertices of a triangle, by the mesh's numbers.
fn vertices(mesh: &Mesh, number: usize) -> [u32; 3] {
    mesh.triangle(number).map(|corner| mesh.vertex_of(corner))
}

/// Returns the position of a triangle's centre on the Morton curve, with ten bits for each axis.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "held to ten bits just before"
)]
fn morton(mesh: &Mesh, bounds: Bounds, vertices: [u32; 3]) -> u32 {
    let [a, b, c] = vertices.map(|vertex| dvec3(mesh.positions()[vertex as usize]));
    // All axes share one scale, so cells are cubes; it is never 0, even if all points coincide.
    let extent = bounds.extent().max_element().max(f64::MIN_POSITIVE);
    let place = ((a + b + c) / 3.0 - bounds.min) / extent * 1023.0;
    let bits = place.to_array().map(|x| spread(x.clamp(0.0, 1023.0) as u32));
    bits[0] | bits[1] << 1 | bits[2] << 2
}

/// Spreads the ten bits of a number to every third place.
const fn spread(bits: u32) -> u32 {
    // Each step halves the groups of bits and moves their upper halves up.
    let bits = (bits | bits << 16) & 0x0300_00ff;
    let bits = (bits | bits << 8) & 0x0300_f00f;
    let bits = (bits | bits << 4) & 0x030c_30c3;
    (bits | bits << 2) & 0x0924_9249
}

pub(super) fn index(i: usize) -> u32 {
    u32::try_from(i).expect("the mesh has checked that everything can be numbered")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_spread_to_every_third_place() {
        assert_eq!(spread(0b11_1111_1111), 0o1_111_111_111);
        assert_eq!(spread(0b101), 0o101);
    }
}
