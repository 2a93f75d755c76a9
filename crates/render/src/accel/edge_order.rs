//! The draw order of a mesh's edges.
//!
//! Edges follow the vertices as [`DrawOrder`] numbers them, so neighbours
//! in space are neighbours in memory. Each edge keeps its number among the mesh's edges, which
//! decides between equal depths. The draw order therefore does not change the picture.

use marraztu_core::scene::{Accelerator, AcceleratorPlace, Mesh, NONE};

use super::draw_order::{DrawOrder, index};

/// An edge in draw order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawEdge {
    /// The vertices at the ends, as indices into [`DrawOrder::x`];
    /// [`NONE`] if no triangle uses them.
    pub vertices: [u32; 2],
    /// The two polygons at the edge, or its only polygon twice. If the edge has more than two, the
    /// second entry is [`NONE`].
    pub polygons: [u32; 2],
    /// The edge's index in [`Mesh::edges`].
    pub number: u32,
}

/// The edges of a mesh in draw order.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeOrder {
    /// The edges.
    pub edges: Vec<DrawEdge>,
    /// Whether each polygon is one triangle with the polygon's number.
    pub triangles: bool,
}

impl Accelerator for EdgeOrder {
    const PLACE: AcceleratorPlace = AcceleratorPlace::EdgeOrder;

    fn build(mesh: &Mesh) -> Self {
        // Translate vertices of the mesh to vertices of the draw order.
        let mut vertices = vec![NONE; mesh.positions().len()];
        for triangle in &mesh.accelerator::<DrawOrder>().triangles {
            let corners = mesh.triangle(triangle.number as usize);
            for (corner, vertex) in corners.into_iter().zip(triangle.vertices) {
                vertices[mesh.vertex_of(corner) as usize] = vertex;
            }
        }
        let edges = mesh.edges().iter().enumerate().map(|(number, edge)| DrawEdge {
            vertices: edge.ends.map(|end| vertices[end as usize]),
            polygons: match *mesh.edge_polygons(edge) {
                [one] => [one; 2],
                [one, other] => [one, other],
                _ => [0, NONE],
            },
            number: index(number),
        });
        let mut edges: Vec<DrawEdge> = edges.collect();
        // The number makes the key unique, so an unstable sort is enough.
        let key = |edge: &DrawEdge| {
            let [a, b] = edge.vertices;
            (a.min(b), a.max(b), edge.number)
        };
        edges.sort_unstable_by_key(key);
        let one = |polygon: usize| mesh.triangles_of(index(polygon)) == (polygon..polygon + 1);
        Self { edges, triangles: (0..mesh.polygon_count()).all(one) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Accelerated as _;
    use marraztu_core::scene::{MeshSource, SourceCorner};

    /// A roof of two triangles over a square.
    #[test]
    fn an_edge_keeps_its_number_its_ends_and_its_polygons() {
        let mesh = Mesh::new(MeshSource {
            positions: vec![
                [0.0, 0.0, 0.0],
                [2.0, 0.0, 0.0],
                [2.0, 2.0, 0.0],
                [0.0, 2.0, 0.0],
                [1.0, 1.0, 1.0],
            ],
            ..MeshSource::of_polygons(
                [0, 1, 2, 3, 1, 0, 4, 2, 1, 4].map(SourceCorner::bare),
                vec![4, 3, 3],
            )
        })
        .unwrap();
        let order = mesh.edge_order();
        assert!(!order.triangles, "one is a square");
        assert_eq!(order.edges.len(), mesh.edges().len());
        let mut numbers = Vec::new();
        for edge in &order.edges {
            let own = &mesh.edges()[edge.number as usize];
            numbers.push(edge.number);
            for (vertex, end) in edge.vertices.into_iter().zip(own.ends) {
                let place = mesh.positions()[end as usize].map(f64::from);
                assert_eq!(mesh.draw_order().position(vertex), place);
            }
            let mut polygons = edge.polygons.to_vec();
            polygons.dedup();
            assert_eq!(polygons, mesh.edge_polygons(own));
        }
        numbers.sort_unstable();
        assert!(numbers.into_iter().eq(0..7));
    }
}
