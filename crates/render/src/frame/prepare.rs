//! Computes the tables that drawing reads.

use super::FramePlan;
use super::draw::{Draw, Lines, Pipeline, Shaded};
use crate::accel::{Accelerated as _, Bvh, DrawOrder, EdgeOrder};
use marraztu_core::accuracy::{LightAt, Tangents};
use marraztu_core::scene::{Derived, Normals};

impl FramePlan {
    /// Computes every derived table of the meshes. Drawing threads must not compute any of them:
    /// see [`together`](crate::work_stealing::together).
    pub(crate) fn prepare(&self) {
        self.draws.iter().for_each(|draw| prepare(draw, self));
        self.shadows.prepare(self.variants.shadow_method);
        if let Some(around) = &self.surroundings {
            around.prepare();
            for draw in &around.draws {
                let _tree: &Bvh = draw.model.mesh.bvh();
            }
        }
    }
}

/// Computes every derived table of the mesh before drawing, so no thread has to wait for one.
fn prepare(draw: &Draw, plan: &FramePlan) {
    let pipelines = draw.part_pipelines.iter().flatten();
    let shaded: Vec<&Shaded> = pipelines
        .filter_map(|pipeline| match &plan.pipelines[*pipeline as usize] {
            Pipeline::Shaded(shaded) => Some(shaded),
            Pipeline::Flat(_) => None,
        })
        .collect();
    // Without light, no pixel reads facets or face normals.
    let lit = shaded.iter().any(|shaded| shaded.light.is_some());
    let flat = lit && plan.light_at == LightAt::Face;
    let by_face = lit && draw.normals == Normals::Face;
    // An opacity map counts by its alpha or its brightness, and the alpha of a transparent
    // texture may not count at all: both depend on the smallest alpha.
    for shaded in &shaded {
        let texture = shaded.texture.as_ref().filter(|_| shaded.opacity.is_some());
        for map in shaded.opacity_map.iter().chain(texture) {
            let _least: u8 = map.picture.least_alpha();
        }
    }
    let is_bumpy = shaded.iter().any(|shaded| shaded.extras.bump.is_some());
    let at_vertices = is_bumpy && plan.variants.tangents == Tangents::Vertex;
    let Lines { edges, face_normals, .. } = draw.lines;
    // Meshes keep their tables, so only the first frame that needs one pays for it.
    for (what, needed) in [
        (Derived::Tangents(draw.normal_source), at_vertices),
        (Derived::PolygonOf, true),
        (Derived::Edges, edges),
        (Derived::Facets, flat),
        (Derived::PolygonNormals, by_face || face_normals.is_some()),
        (Derived::Triangles, by_face),
        (Derived::Corners, by_face || edges),
    ] {
        if needed {
            draw.model.mesh.prepare(what);
        }
    }
    // Accessing an order builds it.
    let _order: &DrawOrder = draw.model.mesh.draw_order();
    if edges {
        let _order: &EdgeOrder = draw.model.mesh.edge_order();
    }
}
