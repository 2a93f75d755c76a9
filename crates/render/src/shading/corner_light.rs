//! The light at vertices, for pixels coloured during triangle setup or drawing.

use crate::accel::Accelerated as _;
use std::ops::Range;

use crate::simd::dispatch;
use fearless_simd::{Level, Simd, SimdBase as _};

use super::light::{Lighting, Lit, Table};
use super::light_terms::LightTerms;
use crate::accel::{DrawOrder, Points};
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw, Pipeline};
use crate::lights::Batch;
use crate::plan::color_path::{colors_early, shows_corner_light};
use crate::raster::hit_colors::{
    Conversion, CornerColors, CornerLight, Corners, LookUp, Triangles,
};
use crate::raster::hits::PACK;
use crate::raster::inputs::Inputs;
use crate::screen::clip::ScreenVertex;
use crate::shadow::rays::RayScratch;
use crate::simd::{Bits, Lanes as _, Sixteen};
use marraztu_core::scene::Normals;

/// The light at the vertices of a frame. See [`CornerLight`].
#[derive(Debug)]
pub(crate) struct VertexLight<'a> {
    level: Level,
    plan: &'a FramePlan,
    lit: &'a Lit<f32>,
    terms: &'a LightTerms<f32>,
}

impl<'a> VertexLight<'a> {
    /// Creates the light of a frame with one sample per pixel, if colouring triangles early pays.
    pub(crate) fn new(
        level: Level,
        plan: &'a FramePlan,
        lit: &'a Lit<f32>,
        terms: &'a LightTerms<f32>,
    ) -> Option<Self> {
        colors_early(plan).then_some(Self { level, plan, lit, terms })
    }
}

impl CornerLight for VertexLight<'_> {
    fn conversion(&self) -> Conversion<'_> {
        self.terms.conversion(self.plan)
    }

    fn begin<'a>(&'a self, inputs: &'a Inputs) -> Box<dyn LookUp + 'a> {
        let (batch, rays) = (Batch::default(), RayScratch::default());
        Box::new(Worker { frame: self, inputs, batch, rays, numbers: 0..0, draw: None })
    }
}

/// The light of one thread's triangles, draw after draw.
#[derive(Debug)]
struct Worker<'a> {
    frame: &'a VertexLight<'a>,
    inputs: &'a Inputs,
    /// The batch for lighting vertices.
    batch: Batch<f32>,
    rays: RayScratch,
    /// The triangles of the last draw, by their numbers in the frame.
    numbers: Range<u32>,
    /// The last draw, if its triangles show interpolated light only.
    draw: Option<LitDraw<'a>>,
}

/// The sources of the light at the corners of one draw's triangles.
#[derive(Debug)]
struct LitDraw<'a> {
    draw: &'a Draw,
    order: &'a DrawOrder,
    points: &'a Points,
    vertices: &'a [ScreenVertex],
    tables: [&'a Table<f32>; 2],
    lighting: Lighting<'a, f32>,
}

impl<'a> LitDraw<'a> {
    /// Returns `None` if a pixel of the draw shows more than interpolated light.
    fn new(frame: &'a VertexLight<'a>, inputs: &'a Inputs, index: u32) -> Option<Self> {
        let VertexLight { level, plan, lit, terms } = *frame;
        let draw = &plan.draws[index as usize];
        // Several pipelines or red back faces would need a decision per triangle.
        let pipeline = draw.uniform.filter(|_| draw.back != Back::Red)?;
        let Pipeline::Shaded(shaded) = &plan.pipelines[pipeline as usize] else { return None };
        let stages = shaded.light.as_deref().filter(|_| shows_corner_light(shaded))?;
        let tables = lit.tables(index, pipeline);
        let order = draw.model.mesh.draw_order();
        Some(Self {
            draw,
            order,
            points: order.points(draw.normal_source),
            vertices: inputs.corners_of(index as usize),
            tables,
            lighting: Lighting { level, draw, stages, terms: terms.of(pipeline), tracer: None },
        })
    }
}

impl<'a> Worker<'a> {
    /// Returns the draw of a triangle, and the colours at its corners.
    #[inline(always)]
    fn look_up(
        &mut self,
        number: u32,
        vertices: [u32; 3],
        clockwise: bool,
    ) -> Option<(&LitDraw<'a>, CornerColors)> {
        // Consecutive triangles mostly belong to one draw.
        if !self.numbers.contains(&number) {
            let (draw, start) = self.inputs.draw_of(number);
            self.numbers = start.number..start.end;
            self.draw = LitDraw::new(self.frame, self.inputs, draw);
        }
        let own = self.draw.as_ref()?;
        let number = number - self.numbers.start;
        // Light is stored by corner with face normals, else by point.
        let places = match own.draw.normals {
            Normals::Face => own.draw.model.mesh.triangles()[number as usize].corners,
            Normals::Vertex => own.points.of(own.order, number, vertices),
        };
        // Back faces run clockwise on the screen, and front faces do on mirrored objects.
        let turned = clockwise != own.draw.mirrored;
        let table = own.tables[usize::from(turned && own.draw.back == Back::Lit)];
        let mut colors = [[0.0; 4]; 3];
        for (color, place) in colors.iter_mut().zip(places) {
            let scratch = (&mut self.batch, &mut self.rays);
            *color = table.diffuse(place, &own.lighting, scratch);
        }
        Some((own, colors))
    }
}

impl LookUp for Worker<'_> {
    fn set(&mut self, triangles: &Triangles<'_>, to: &mut Corners) -> bool {
        let Triangles { numbers, vertices, some, clockwise } = *triangles;
        let mut colors = [[[0.0; 4]; PACK]; 3];
        for lane in Bits(some) {
            let lane = lane % PACK;
            let corners = vertices.map(|row| row[lane]);
            let clockwise = clockwise >> lane & 1 == 1;
            // One unknown colour rejects the whole group: its pixels are coloured later.
            let Some((own, known)) = self.look_up(numbers[lane], corners, clockwise) else {
                return false;
            };
            for corner in 0..3 {
                to.by_w[corner][lane] = own.vertices[corners[corner] as usize].inverse_w;
                colors[corner][lane] = known[corner];
            }
        }
        dispatch!(self.frame.level, simd => put(simd, &colors, &mut to.colors));
        true
    }

    fn corners(
        &mut self,
        number: u32,
        vertices: [u32; 3],
        clockwise: bool,
    ) -> Option<CornerColors> {
        Some(self.look_up(number, vertices, clockwise)?.1)
    }
}

/// Stores the colours at first corners, and the differences of the others from them.
#[inline(always)]
fn put<S: Simd>(simd: S, colors: &[[[f32; 4]; PACK]; 3], to: &mut [[[f32; PACK]; 3]; 3]) {
    let lanes = Sixteen(simd);
    let [first, second, third] = colors;
    let a = lanes.load_four(first, 0);
    let b = lanes.load_four(second, 0);
    let c = lanes.load_four(third, 0);
    for i in 0..3 {
        a[i].store_slice(&mut to[0][i]);
        (b[i] - a[i]).store_slice(&mut to[1][i]);
        (c[i] - a[i]).store_slice(&mut to[2][i]);
    }
}
