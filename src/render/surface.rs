//! From what is seen to colours.
//!
//! The pixels of a block that show the same draw are gathered into rows, and the rows are computed
//! with: first where in its triangle each pixel lies, then the attributes there, with perspective,
//! then light, then bytes. A value that all corners share comes out as it went in, bit for bit, since
//! only differences are weighted.
//!
//! The place of a pixel in space is the point of its ray at its depth, so that the direction to the
//! observer is exact whatever the triangle.
//!
//! Perspective: Heckbert and Moreton, "Interpolation for Polygon Texture Mapping and Shading", 1991.

use fearless_simd::Level;
use glam::DVec3;

use super::attributes::{attributes, mix};
use super::corners::{Corners, gather_light, gather_places};
use super::effects::{BATCH, Batch, Light, Rows, load};
use super::frame::Frame;
use super::gather::Gathered;
use super::light::Lit;
use super::plan::{Back, Draw, FramePlan, Pipeline, Shaded, TileLight, TilePlan};
use super::real::{Kernel, Machine, Triple};
use super::texture;
use super::tile::{BLOCK, BLOCK_PIXELS, Seen, TILE_SIDE, seen};
use crate::base::color::Color;
use crate::scene::{LightAt, NONE};

/// Colours pixels. Each thread has its own.
#[derive(Debug)]
pub(super) struct Shader<'a, T> {
    plan: &'a FramePlan,
    frame: &'a Frame,
    lit: &'a Lit<T>,
    level: Level,
    /// The lights of the tile that is coloured.
    pub(super) tile: TilePlan,
    rows: Box<RowsOfBlock<T>>,
}

/// What is computed for the pixels of a block.
#[derive(Debug)]
struct RowsOfBlock<T> {
    gathered: Gathered<T>,
    batch: Batch<T>,
    texels: Rows<T>,
    colors: [[u8; 4]; BATCH],
}

/// The pixels of a block that are coloured together.
struct Group<'a> {
    draw: &'a Draw,
    draw_index: u32,
    base: u32,
    /// Places in the block.
    pixels: &'a [u8],
    numbers: &'a [u32; BLOCK_PIXELS],
    corner: [i32; 2],
}

impl Group<'_> {
    /// Whether all pixels of the block show one triangle.
    fn is_whole(&self) -> bool {
        let first = self.numbers[0];
        let other = self.numbers.iter().fold(0, |other, number| other | (number ^ first));
        self.pixels.len() == BLOCK_PIXELS && other == 0
    }
}

impl<'a, T: Light> Shader<'a, T> {
    pub(super) fn new(
        plan: &'a FramePlan,
        frame: &'a Frame,
        lit: &'a Lit<T>,
        level: Level,
    ) -> Self {
        let rows = RowsOfBlock {
            gathered: Gathered::default(),
            batch: Batch::default(),
            texels: [[T::default(); BATCH]; 3],
            colors: [[255; 4]; BATCH],
        };
        Self { plan, frame, lit, level, tile: TilePlan::default(), rows: Box::new(rows) }
    }

    /// Colours the pixels of a block whose upper left pixel is `corner` into the rows of a tile, from
    /// `at` on. What shows the background is left as it is.
    pub(super) fn block(
        &mut self,
        words: &[u64; BLOCK_PIXELS],
        corner: [i32; 2],
        tile: &mut [[u8; 4]],
        at: usize,
    ) {
        let mut numbers = [0; BLOCK_PIXELS];
        let mut waiting = 0_u64;
        let place = |i: usize| at + i / BLOCK as usize * TILE_SIDE + i % BLOCK as usize;
        for (i, word) in words.iter().enumerate() {
            match seen(*word) {
                Seen::Background => {}
                Seen::Line(number) => {
                    tile[place(i)] = self.frame.lines[number as usize].color;
                }
                Seen::Triangle(number) => {
                    numbers[i] = number;
                    waiting |= 1 << i;
                }
            }
        }
        while waiting != 0 {
            let first = numbers[waiting.trailing_zeros() as usize];
            let (draw_index, start) = self.frame.draw_of(first);
            let draw = &self.plan.draws[draw_index as usize];
            let pipeline = draw.pipeline_of(first - start.number);
            let mut pixels = [0; BATCH];
            let mut count = 0;
            let mut left = waiting;
            while left != 0 {
                let i = left.trailing_zeros();
                left &= left - 1;
                let number = numbers[i as usize];
                let own = (start.number..start.end).contains(&number)
                    && (draw.uniform.is_some()
                        || draw.pipeline_of(number - start.number) == pipeline);
                if own {
                    pixels[count] = u8::try_from(i).expect("below 64");
                    count += 1;
                    waiting &= !(1 << i);
                }
            }
            let base = start.number;
            let pixels = &pixels[..count];
            let group = Group { draw, draw_index, base, pixels, numbers: &numbers, corner };
            self.group(&group, pipeline);
            for (pixel, color) in pixels.iter().zip(&self.rows.colors) {
                tile[place(usize::from(*pixel))] = *color;
            }
        }
    }

    fn group(&mut self, group: &Group<'_>, pipeline: u32) {
        match &self.plan.pipelines[pipeline as usize] {
            Pipeline::Flat(color) => self.rows.colors.fill(color.opaque()),
            Pipeline::Shaded(shaded) => {
                self.gather(group, pipeline);
                let rows = &mut *self.rows;
                rows.batch.len = group.pixels.len();
                rows.gathered.locate(self.level);
                if shaded.light.is_some() {
                    self.light(group, pipeline, shaded);
                }
                self.texels(group, shaded);
                let rows = &mut *self.rows;
                let lit = shaded.light.is_some();
                let RowsOfBlock { batch, texels, colors, .. } = rows;
                T::run(self.level, Finish { batch, texels, lit, colors });
            }
        }
        if group.draw.back == Back::Red {
            for i in 0..group.pixels.len() {
                if self.rows.gathered.back[i] {
                    self.rows.colors[i] = Color::BACK_FACE.opaque();
                }
            }
        }
    }

    /// Light at the pixels of the group.
    fn light(&mut self, group: &Group<'_>, pipeline: u32, shaded: &Shaded) {
        let rows = &mut *self.rows;
        match self.plan.light_at {
            LightAt::Pixel => {
                let TileLight { stages, places, .. } = self.tile.light(self.plan, pipeline, shaded);
                if places {
                    attributes(self.level, self.plan, group.draw, &rows.gathered, &mut rows.batch);
                }
                for row in rows.batch.diffuse.iter_mut().chain(&mut rows.batch.specular) {
                    row.fill(T::default());
                }
                run(stages, shaded, self.plan, self.level, &mut rows.batch);
            }
            LightAt::Face | LightAt::Vertex => {
                mix(self.level, &rows.gathered, &mut rows.batch);
            }
        }
    }

    /// Takes what is known of the triangles at the pixels of the group.
    fn gather(&mut self, group: &Group<'_>, pipeline: u32) {
        let (plan, frame, lit) = (self.plan, self.frame, self.lit);
        let vertices = frame.vertices_of(plan, group.draw_index);
        let rows = &mut self.rows.gathered;
        rows.len = group.pixels.len();
        rows.exact = 0;
        let take = |number: u32, corners: &mut Corners<T>| {
            corners.take(plan, group.draw, vertices, number);
            match plan.light_at {
                LightAt::Pixel => gather_places(group.draw, number, corners),
                _ => {
                    let draw = (group.draw_index, group.draw);
                    gather_light(plan, lit, draw, number, pipeline, corners);
                }
            }
        };
        let mut corners = Corners::default();
        if group.is_whole() {
            let number = group.numbers[0] - group.base;
            take(number, &mut corners);
            if rows.put_whole(self.level, group.corner, &corners, plan) {
                return;
            }
        }
        let mut last = NONE;
        for (i, pixel) in group.pixels.iter().enumerate() {
            let number = group.numbers[usize::from(*pixel)] - group.base;
            if number != last {
                last = number;
                take(number, &mut corners);
            }
            let [left, top] = group.corner;
            let (x, y) = (left + i32::from(pixel % 8), top + i32::from(pixel / 8));
            rows.put(i, [x, y], &corners, plan, group.draw, number);
        }
    }

    /// t at the pixels of the group: texel x tint x vertex colour, each 1 where absent.
    fn texels(&mut self, group: &Group<'_>, shaded: &Shaded) {
        let rows = &mut *self.rows;
        for (row, tint) in rows.texels.iter_mut().zip(shaded.tint) {
            row.fill(T::from_f64(tint));
        }
        if shaded.texture.is_none() && !shaded.vertex_colors {
            return;
        }
        for (i, pixel) in group.pixels.iter().enumerate() {
            let number = group.numbers[usize::from(*pixel)] - group.base;
            let weights = rows.gathered.weights(i);
            if let Some(texture) = &shaded.texture
                && let Some(uv) = uv(group.draw, number, weights)
            {
                let texel = texture::sample::<T>(texture, uv, self.plan.filter);
                for (row, part) in rows.texels.iter_mut().zip(texel) {
                    row[i] = row[i] * part;
                }
            }
            if shaded.vertex_colors {
                for (row, part) in rows.texels.iter_mut().zip(color(group.draw, number, weights)) {
                    row[i] = row[i] * T::from_f64(part);
                }
            }
        }
    }
}

/// I = t D + S where lit, t elsewhere; as bytes.
struct Finish<'a, T> {
    batch: &'a Batch<T>,
    texels: &'a Rows<T>,
    lit: bool,
    colors: &'a mut [[u8; 4]; BATCH],
}

impl<T: Light> Kernel<T> for Finish<'_, T> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { batch, texels, lit, colors } = self;
        let mut bytes = [[0; BATCH]; 3];
        for at in (0..batch.len).step_by(M::LANES) {
            let mut light = load(machine, texels, at);
            if lit {
                let (Triple([r, g, b]), Triple([tr, tg, tb])) =
                    (load(machine, &batch.diffuse, at), light);
                let specular = load(machine, &batch.specular, at);
                light = Triple([tr * r, tg * g, tb * b]).plus(specular);
            }
            machine.store_bytes(light.0[0], &mut bytes[0], at);
            machine.store_bytes(light.0[1], &mut bytes[1], at);
            machine.store_bytes(light.0[2], &mut bytes[2], at);
        }
        let [r, g, b] = &bytes;
        for (((color, r), g), b) in colors.iter_mut().zip(r).zip(g).zip(b) {
            *color = (r | g << 8 | b << 16 | 255 << 24_i32).to_le_bytes();
        }
    }
}

/// Adds up the light of some stages at every place of a batch.
pub(super) fn run<T: Light>(
    stages: &[super::plan::Stage],
    shaded: &Shaded,
    plan: &FramePlan,
    level: Level,
    batch: &mut Batch<T>,
) {
    for stage in stages {
        let lamp = &plan.lamps[stage.lamp as usize];
        T::add_light(stage.variant(), level, batch, lamp, &shaded.matter);
    }
}

/// The place on the texture; `None` where a corner has none.
fn uv(draw: &Draw, number: u32, weights: DVec3) -> Option<[f64; 2]> {
    let mesh = &draw.model.mesh;
    let own = mesh.triangles()[number as usize];
    let ids = own.corners.map(|corner| mesh.corners()[corner as usize].uv);
    if ids.contains(&NONE) {
        return None;
    }
    let [a, b, c] = ids.map(|id| mesh.uvs()[id as usize].map(f64::from));
    let between = |axis: usize| {
        let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
        let value = a[axis] + (b[axis] - a[axis]) * weights.y + (c[axis] - a[axis]) * weights.z;
        value.clamp(low, high)
    };
    Some([between(0), between(1)])
}

/// The vertex colours' mixture.
fn color(draw: &Draw, number: u32, weights: DVec3) -> [f64; 3] {
    let mesh = &draw.model.mesh;
    let own = mesh.triangles()[number as usize];
    let [a, b, c] = own.corners.map(|corner| {
        crate::scene::dvec3(mesh.colors()[mesh.corners()[corner as usize].position as usize])
    });
    (a + (b - a) * weights.y + (c - a) * weights.z).to_array()
}

/// Whether a triangle with a texture that leaves pixels out is drawn at one of them.
pub(super) fn is_opaque(plan: &FramePlan, frame: &Frame, number: u32, pixel: [i32; 2]) -> bool {
    let (index, start) = frame.draw_of(number);
    let draw = &plan.draws[index as usize];
    let number = number - start.number;
    let Pipeline::Shaded(shaded) = &plan.pipelines[draw.pipeline_of(number) as usize] else {
        return true;
    };
    let (Some(opacity), Some(texture)) = (shaded.cutout, &shaded.texture) else { return true };
    let vertices = frame.vertices_of(plan, index);
    let corners = Corners::<f64>::new(plan, draw, vertices, number);
    let weights = corners.weights(plan, draw, number, pixel);
    let Some(uv) = uv(draw, number, weights) else { return true };
    texture::sample::<f64>(texture, uv, plan.filter)[3] * opacity >= 0.5
}
