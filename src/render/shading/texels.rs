//! What a surface shows of itself at a pixel: where it is on its texture, which colour its vertices give,
//! and whether it is there at all.

use glam::DVec3;

use super::texture;
use super::weights::Weights;
use crate::render::geometry::frame::Frame;
use crate::render::plan::{Draw, FramePlan, Pipeline, Shaded};
use crate::scene::{Filter, NONE, Texture, dvec3};

/// The places on the texture of a triangle's corners.
pub(super) type Uvs = [[f64; 2]; 3];

/// The place on the texture between those of the corners.
#[inline(always)]
pub(super) fn uv([a, b, c]: Uvs, weights: DVec3) -> [f64; 2] {
    let between = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
        let value = a[axis] + (b[axis] - a[axis]) * weights.y + (c[axis] - a[axis]) * weights.z;
        value.clamp(low, high)
    };
    [between(0), between(1)]
}

/// The places on the texture of a triangle's corners; `None` where one has none.
pub(super) fn uvs(draw: &Draw, number: u32) -> Option<Uvs> {
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
    let parts = Weights::new(plan, draw, corners, number, [0; 2]);
    let at = |pixel: [i32; 2]| -> [f64; 2] {
        let weights = parts.at(pixel).to_array();
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

/// A triangle with a texture that leaves some of it out.
#[derive(Debug)]
pub(in crate::render) struct Holes<'a> {
    weights: Weights<'a>,
    uvs: Uvs,
    texture: &'a Texture,
    opacity: f64,
    filter: Filter,
}

impl<'a> Holes<'a> {
    /// Those of a triangle, in places of pixels that are shifted by so many parts of a pixel from their
    /// middles; `None` where it has none.
    pub(in crate::render) fn of(
        plan: &'a FramePlan,
        frame: &Frame,
        number: u32,
        shift: [i32; 2],
    ) -> Option<Self> {
        let (index, start) = frame.draw_of(number);
        let draw = &plan.draws[index as usize];
        let number = number - start.number;
        let pipeline = &plan.pipelines[draw.pipeline_of(number) as usize];
        let Pipeline::Shaded(Shaded { cutout: Some(opacity), texture: Some(texture), .. }) =
            pipeline
        else {
            return None;
        };
        Some(Self {
            weights: Weights::new(plan, draw, frame.corners_of(plan, index), number, shift),
            uvs: uvs(draw, number)?,
            texture,
            opacity: *opacity,
            filter: plan.filter,
        })
    }

    /// Whether it is drawn in a pixel.
    #[inline(always)]
    pub(in crate::render) fn is_opaque(&self, pixel: [i32; 2]) -> bool {
        let uv = uv(self.uvs, self.weights.at(pixel));
        texture::sample::<f64>(self.texture, uv, self.filter)[3] * self.opacity >= 0.5
    }
}
