//! What a surface shows of itself at a pixel: where it is on its texture, which colour its vertices give,
//! and whether it is there at all.

use glam::DVec3;

use super::texture;
use super::weights::weights;
use crate::render::geometry::frame::Frame;
use crate::render::plan::{Draw, FramePlan, Pipeline};
use crate::scene::{NONE, dvec3};

/// The place on the texture; `None` where a corner has none.
pub(super) fn uv(draw: &Draw, number: u32, weights: DVec3) -> Option<[f64; 2]> {
    let [a, b, c] = uvs(draw, number)?;
    let between = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
        let value = a[axis] + (b[axis] - a[axis]) * weights.y + (c[axis] - a[axis]) * weights.z;
        value.clamp(low, high)
    };
    Some([between(0), between(1)])
}

/// The places on the texture of a triangle's corners; `None` where one has none.
fn uvs(draw: &Draw, number: u32) -> Option<[[f64; 2]; 3]> {
    let mesh = &draw.model.mesh;
    let own = mesh.triangles()[number as usize];
    let ids = own.corners.map(|corner| mesh.corners()[corner as usize].uv);
    (!ids.contains(&NONE)).then(|| ids.map(|id| mesh.uvs()[id as usize].map(f64::from)))
}

/// How far off on the texture the pixels to the right and below lie of a pixel of a triangle of a draw.
#[cold]
pub(super) fn uv_ways(
    (plan, frame): (&FramePlan, &Frame),
    draw_index: u32,
    number: u32,
    [x, y]: [i32; 2],
) -> [[f64; 2]; 2] {
    let draw = &plan.draws[draw_index as usize];
    let Some(uvs) = uvs(draw, number) else { return [[0.0; 2]; 2] };
    let corners = frame.corners_of(plan, draw_index);
    let at = |pixel: [i32; 2]| -> [f64; 2] {
        let weights = weights(plan, draw, corners, number, (pixel, [0; 2])).to_array();
        [0, 1].map(|axis| (0..3).map(|i| weights[i] * uvs[i][axis]).sum())
    };
    let own = at([x, y]);
    [at([x + 1, y]), at([x, y + 1])].map(|it| [it[0] - own[0], it[1] - own[1]])
}

/// The vertex colours' mixture.
pub(super) fn color(draw: &Draw, number: u32, weights: DVec3) -> [f64; 3] {
    let mesh = &draw.model.mesh;
    let own = mesh.triangles()[number as usize];
    let [a, b, c] = own
        .corners
        .map(|corner| dvec3(mesh.colors()[mesh.corners()[corner as usize].position as usize]));
    (a + (b - a) * weights.y + (c - a) * weights.z).to_array()
}

/// Whether a triangle with a texture that leaves some of it out is drawn in a place of a pixel, shifted
/// by so many parts of a pixel from its middle.
pub(in crate::render) fn is_opaque(
    plan: &FramePlan,
    frame: &Frame,
    number: u32,
    place: ([i32; 2], [i32; 2]),
) -> bool {
    let (index, start) = frame.draw_of(number);
    let draw = &plan.draws[index as usize];
    let number = number - start.number;
    let Pipeline::Shaded(shaded) = &plan.pipelines[draw.pipeline_of(number) as usize] else {
        return true;
    };
    let (Some(opacity), Some(texture)) = (shaded.cutout, &shaded.texture) else { return true };
    let weights = weights(plan, draw, frame.corners_of(plan, index), number, place);
    let Some(uv) = uv(draw, number, weights) else { return true };
    texture::sample::<f64>(texture, uv, plan.filter)[3] * opacity >= 0.5
}
