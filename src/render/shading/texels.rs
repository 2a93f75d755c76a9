//! The footprint of a pixel on its texture, and vertex colours.

use glam::DVec3;

use crate::render::frame::FramePlan;
use crate::render::frame::draw::Draw;
use crate::render::raster::geometry::ScreenGeometry;
use crate::render::screen::weights::Weights;
use crate::render::texture::uv::uvs;
use crate::scene::dvec3;

/// The footprint of a pixel: the differences of uv to its neighbours on the right and below.
#[cold]
pub(crate) fn uv_ways(
    (plan, frame): (&FramePlan, &ScreenGeometry),
    draw_index: u32,
    number: u32,
    [x, y]: [i32; 2],
) -> [[f64; 2]; 2] {
    let draw = &plan.draws[draw_index as usize];
    let Some(uvs) = uvs(draw, number) else { return [[0.0; 2]; 2] };
    let corners = frame.corners_of(plan, draw_index);
    let parts = Weights::new(plan, draw, corners, number, [0; 2]);
    let at = |pixel: [i32; 2]| -> [f64; 2] {
        let weights = parts.at(pixel).to_array();
        [0, 1].map(|axis| (0..3).map(|i| weights[i] * uvs[i][axis]).sum())
    };
    let own = at([x, y]);
    [at([x + 1, y]), at([x, y + 1])].map(|it| [it[0] - own[0], it[1] - own[1]])
}

/// The interpolated vertex colour.
pub(crate) fn color(draw: &Draw, number: u32, weights: DVec3) -> [f64; 3] {
    let mesh = &draw.model.mesh;
    let own = mesh.triangles()[number as usize];
    let [a, b, c] = own
        .corners
        .map(|corner| dvec3(mesh.colors()[mesh.corners()[corner as usize].position as usize]));
    (a + (b - a) * weights.y + (c - a) * weights.z).to_array()
}
