//! The light at vertices, for pixels coloured during triangle setup or drawing.

use std::ops::Range;

use fearless_simd::{Level, Simd, SimdBase as _, dispatch};

use super::light::{Lighting, Lit, Table};
use super::light_terms::LightTerms;
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw, Pipeline};
use crate::lights::Batch;
use crate::raster::hit_colors::{
    Conversion, CornerColors, CornerLight, Corners, LookUp, Triangles,
};
use crate::raster::hits::PACK;
use crate::raster::starts::DrawCorners;
use crate::screen::clip::{Screen, ScreenVertex};
use crate::shadow::rays::RayScratch;
use crate::simd::{Lanes as _, Sixteen};
use marraztu_core::accuracy::{Arithmetic, Coverage, Interpolation, LightAt};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{DrawOrder, Normals, Points};

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
        let variants = &plan.variants;
        let is_usual = plan.light_at == LightAt::Vertex
            && plan.arithmetic == Arithmetic::F32
            && variants.coverage == Coverage::Exact
            && variants.interpolation != Interpolation::EverySixteen
            && !plan.shadows.are_cast();
        // Early colouring only covers the usual settings, and wastes work on hidden pixels.
        let pays = is_usual && few_are_hidden(plan);
        pays.then_some(Self { level, plan, lit, terms })
    }
}

impl CornerLight for VertexLight<'_> {
    fn conversion(&self) -> Conversion<'_> {
        self.terms.conversion(self.plan)
    }

    fn begin<'a>(&'a self, corners: DrawCorners<'a>) -> Box<dyn LookUp + 'a> {
        let (batch, rays) = (Batch::default(), RayScratch::default());
        Box::new(Worker { frame: self, corners, batch, rays, numbers: 0..0, draw: None })
    }
}

/// The light of one thread's triangles, draw after draw.
#[derive(Debug)]
struct Worker<'a> {
    frame: &'a VertexLight<'a>,
    corners: DrawCorners<'a>,
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
    fn new(frame: &'a VertexLight<'a>, corners: DrawCorners<'a>, index: u32) -> Option<Self> {
        let VertexLight { level, plan, lit, terms } = *frame;
        let draw = &plan.draws[index as usize];
        let pipeline = draw.uniform.filter(|_| draw.back != Back::Red)?;
        let Pipeline::Shaded(shaded) = &plan.pipelines[pipeline as usize] else { return None };
        let stages = shaded.light.as_deref().filter(|_| shaded.extras.is_empty())?;
        let tables = lit.tables(index, pipeline);
        let order = draw.model.mesh.draw_order();
        tables[0].is_colored().then(|| Self {
            draw,
            order,
            points: order.points(draw.normal_source),
            vertices: corners.of(index as usize),
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
            let (draw, start) = self.corners.draw_of(number);
            self.numbers = start.number..start.end;
            self.draw = LitDraw::new(self.frame, self.corners, draw);
        }
        let own = self.draw.as_ref()?;
        let number = number - self.numbers.start;
        // Light is stored by corner with face normals, else by point.
        let places = match own.draw.normals {
            Normals::Face => own.draw.model.mesh.triangles()[number as usize].corners,
            Normals::Vertex => own.points.of(own.order, number, vertices),
        };
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
        let mut left = some;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % PACK;
            left &= left - 1;
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

/// The number of pixels per triangle of a model, counting its box on the screen, from which early
/// colouring pays although hidden pixels are coloured too. A knot with surfaces that hide each
/// other loses a third at 0.5 and a sixth at 0.9; a sphere gains at both.
const ENOUGH_PIXELS: f64 = 2.0;

/// Returns whether few pixels would be coloured unnecessarily.
fn few_are_hidden(plan: &FramePlan) -> bool {
    let (mut pixels, mut triangles) = (0.0, 0.0);
    for draw in &plan.draws {
        pixels += box_on_screen(draw, plan.size);
        triangles += draw.model.mesh.triangle_count() as f64;
    }
    pixels / triangles >= ENOUGH_PIXELS
}

/// Returns the pixels of the box around a draw on the screen, including pixels outside of the
/// picture. Infinite if a part of the draw is next to or behind the observer.
fn box_on_screen(draw: &Draw, size: Size) -> f64 {
    let Some(bounds) = draw.model.mesh.bounds() else { return 0.0 };
    let screen = Screen::new(draw.clip_from_object, size);
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for corner in bounds.corners() {
        let clip = screen.clip(corner.to_array());
        if clip[3] <= 0.0 {
            return f64::INFINITY;
        }
        for (axis, at) in screen.pixels(clip).into_iter().enumerate() {
            (low[axis], high[axis]) = (low[axis].min(at), high[axis].max(at));
        }
    }
    (high[0] - low[0]) * (high[1] - low[1])
}
