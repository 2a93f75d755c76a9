//! The edges of a mesh in the order in which they are drawn fastest.
//!
//! Along the vertices as [`DrawOrder`](super::DrawOrder) numbers them, so that what is near in space
//! is near in memory. Each edge keeps its number among the mesh's edges, which decides between equal
//! depths, so that the order cannot show.

use super::mesh::index;
use super::{Mesh, NONE};

/// An edge as it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawEdge {
    /// The vertices at its ends, as places in [`DrawOrder::x`](super::DrawOrder::x); [`NONE`] where no
    /// triangle uses them.
    pub vertices: [u32; 2],
    /// Its two polygons, or the same twice where it has one; the second is [`NONE`] where it has more.
    pub polygons: [u32; 2],
    /// Its place in [`Mesh::edges`].
    pub number: u32,
}

/// The edges of a mesh as they are drawn, and whether all of its polygons are triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeOrder {
    /// The edges.
    pub edges: Vec<DrawEdge>,
    /// Whether each polygon is one triangle, with the polygon's number.
    pub triangles: bool,
}

impl EdgeOrder {
    /// The order for a mesh.
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut vertices = vec![NONE; mesh.positions().len()];
        for triangle in &mesh.draw_order().triangles {
            let corners = mesh.triangles()[triangle.number as usize].corners;
            for (corner, vertex) in corners.into_iter().zip(triangle.vertices) {
                vertices[mesh.corners()[corner as usize].position as usize] = vertex;
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
        let key = |edge: &DrawEdge| {
            let [a, b] = edge.vertices;
            (a.min(b), a.max(b), edge.number)
        };
        edges.sort_unstable_by_key(key);
        let one = |polygon: usize| mesh.triangles_of(index(polygon)) == (polygon..polygon + 1);
        Self { edges, triangles: (0..mesh.polygon_count()).all(one) }
    }
}
