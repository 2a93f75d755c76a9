//! Compiles the programs of a frame: how each surface is coloured, by facts that hold for a whole
//! draw.
//!
//! This is the only place that chooses. Facts of a single triangle or block, such as clipping, can
//! still send it from a fast path to the slots, which can do everything.

use crate::frame::draw::{Back, Draw, Pipeline, Shaded};
use crate::frame::program::{LightOp, OtherPath, Program, Programs, VertexLight, WholePath};
use crate::frame::shading_mode::ShadingMode;
use crate::frame::{Eye, FramePlan};
use marraztu_core::accuracy::{Arithmetic, LightAt, Rounding};

/// Compiles the programs of all draws of a frame.
pub(crate) fn compile(plan: &FramePlan, to: &mut Programs) {
    let compiler = Compiler::new(plan);
    to.begin(compiler.mode);
    (to.looks_up_faces, to.are_quick) = (compiler.looks_up_faces, are_quick(plan));
    for draw in &plan.draws {
        to.add(draw, |pipeline| compiler.program(draw, pipeline));
    }
}

/// Compiles the programs of surroundings: rays meet points, wherever the picture is lit.
pub(crate) fn compile_around(plan: &FramePlan, to: &mut Programs) {
    to.begin(plan.shading_mode());
    for draw in &plan.draws {
        to.add(draw, |pipeline| match &plan.pipelines[pipeline as usize] {
            Pipeline::Shaded(Shaded { light: Some(_), .. }) => {
                Program { light: LightOp::Points, ..Program::FLAT }
            }
            Pipeline::Shaded(_) | Pipeline::Flat(_) => Program::FLAT,
        });
    }
}

/// Chooses for the surfaces of a plan.
pub(super) struct Compiler<'a> {
    plan: &'a FramePlan,
    mode: ShadingMode,
    looks_up_faces: bool,
}

impl<'a> Compiler<'a> {
    pub(super) fn new(plan: &'a FramePlan) -> Self {
        let mode = plan.shading_mode();
        let mut compiler = Self { plan, mode, looks_up_faces: false };
        // Looking up the colours of faces pays if they are uniform for most pixels.
        let mut pipelines = plan.pipelines.iter();
        compiler.looks_up_faces = match plan.light_at {
            LightAt::Face => pipelines.any(|pipeline| compiler.is_uniform(pipeline)),
            LightAt::Vertex | LightAt::Pixel | LightAt::Sample => {
                pipelines.all(|pipeline| compiler.is_uniform(pipeline))
            }
        };
        compiler
    }

    /// Compiles the program of a draw with one of its pipelines.
    pub(super) fn program(&self, draw: &Draw, pipeline: u32) -> Program {
        let pipeline = &self.plan.pipelines[pipeline as usize];
        let faces = self.looks_up_faces && self.is_uniform(pipeline);
        let Pipeline::Shaded(shaded) = pipeline else {
            let others = if faces { OtherPath::Faces } else { OtherPath::Slots };
            return Program { others, ..Program::FLAT };
        };
        let light = self.light(shaded);
        let is_located = shaded.varies() || matches!(light, LightOp::Points | LightOp::Vertices(_));
        let joins = self.joins(draw, shaded);
        let others = match (faces, joins && self.may_be_tiny(shaded, light)) {
            (true, _) => OtherPath::Faces,
            (false, true) => OtherPath::Each,
            (false, false) => OtherPath::Slots,
        };
        Program {
            whole: self.whole(draw, pipeline).0,
            others,
            joins,
            light,
            is_located,
            is_by_triangle: !is_located && self.mode.rounding != Rounding::Dithered,
        }
    }

    fn light(&self, shaded: &Shaded) -> LightOp {
        match self.plan.light_at {
            _ if shaded.light.is_none() => LightOp::None,
            LightAt::Pixel | LightAt::Sample => LightOp::Points,
            LightAt::Face => LightOp::Faces,
            LightAt::Vertex => LightOp::Vertices(self.vertex_light(shaded)),
        }
    }

    fn vertex_light(&self, shaded: &Shaded) -> VertexLight {
        let Shaded { texture, vertex_colors, extras, .. } = shaded;
        if texture.is_some() || *vertex_colors || extras.reads_texels() {
            return VertexLight::Light;
        }
        // What is added comes before rounding, and so does encoding.
        let is_final = extras.is_empty() && !self.mode.is_linear();
        if is_final { VertexLight::Bytes } else { VertexLight::Colors }
    }

    /// Chooses the path of blocks that one triangle covers fully, and says why.
    fn whole(&self, draw: &Draw, pipeline: &Pipeline) -> (WholePath, &'static str) {
        let (plan, is_linear) = (self.plan, self.mode.is_linear());
        let shaded = match pipeline {
            Pipeline::Flat(_) => return (WholePath::Fill, "one colour"),
            Pipeline::Shaded(shaded) => shaded,
        };
        if self.is_uniform(pipeline) {
            let is_lit = shaded.light.is_some();
            let why = if is_lit { "one colour per face" } else { "one colour" };
            return (WholePath::Fill, why);
        }
        // One pass knows a texture, vertex colours and uniform emission, in f32.
        let extras = &shaded.extras;
        let why = match self.light(shaded) {
            _ if plan.arithmetic == Arithmetic::F64 => "64-bit numbers",
            _ if draw.back == Back::Red => "red back faces",
            LightOp::Faces => "colours differ within faces",
            LightOp::Vertices(VertexLight::Light) => "vertices hold light, not colours",
            LightOp::Vertices(VertexLight::Colors) if is_linear => "linear values",
            LightOp::Vertices(VertexLight::Colors) => "more than interpolated colours",
            LightOp::Points if plan.shadows.any_of(shaded.stages()) => "shadows",
            LightOp::Points | LightOp::None if extras.even_glow().is_none() => "maps or mirrors",
            LightOp::Points | LightOp::None if is_linear && shaded.texture.is_some() => {
                "texels in linear values"
            }
            LightOp::Vertices(VertexLight::Bytes) | LightOp::Points | LightOp::None => {
                return (WholePath::One, "by block");
            }
        };
        (WholePath::Slots, why)
    }

    /// Says how a draw with one of its pipelines is coloured, in a few letters: the panel of the
    /// plan has narrow columns.
    pub(super) fn in_words(&self, draw: &Draw, pipeline: u32) -> String {
        let (path, why) = self.whole(draw, &self.plan.pipelines[pipeline as usize]);
        match path {
            WholePath::Fill | WholePath::One => why.to_owned(),
            WholePath::Slots => format!("by pixel: {why}"),
        }
    }

    /// Whether a list may hold several blocks. It must not read the block of a pixel, as shadows
    /// do; with light per face, it does not pay, because all slots are lit for each list.
    fn joins(&self, draw: &Draw, shaded: &Shaded) -> bool {
        self.is_plain(draw)
            && self.plan.light_at != LightAt::Face
            && shaded.extras.is_empty()
            && !self.plan.shadows.are_cast()
    }

    /// Whether each lane may hold a triangle: it reads nothing but corners and light.
    fn may_be_tiny(&self, shaded: &Shaded, light: LightOp) -> bool {
        let is_lit = match light {
            LightOp::Points => true,
            LightOp::Vertices(_) => !self.mode.is_linear(),
            LightOp::Faces | LightOp::None => false,
        };
        is_lit
            && self.plan.eye == Eye::Point
            && !self.mode.clamps
            && shaded.texture.is_none()
            && shaded.opacity.is_none()
            && !shaded.vertex_colors
    }

    /// Whether fast paths may be used at all: they compute in f32, and do not know red back faces.
    fn is_plain(&self, draw: &Draw) -> bool {
        self.plan.arithmetic == Arithmetic::F32 && draw.back != Back::Red
    }

    /// Whether all pixels of a triangle have one colour.
    fn is_uniform(&self, pipeline: &Pipeline) -> bool {
        let Pipeline::Shaded(shaded) = pipeline else { return true };
        !shaded.varies()
            // Dithering rounds the same colour differently from pixel to pixel.
            && self.mode.rounding != Rounding::Dithered
            && (shaded.light.is_none() || self.plan.light_at == LightAt::Face)
    }
}

/// Whether little is computed for a pixel: light and textures are not looked up for each.
fn are_quick(plan: &FramePlan) -> bool {
    let is_plain = |pipeline: &Pipeline| match pipeline {
        Pipeline::Flat(_) => true,
        Pipeline::Shaded(shaded) => shaded.texture.is_none() && !shaded.extras.reads_texels(),
    };
    matches!(plan.light_at, LightAt::Face | LightAt::Vertex) && plan.pipelines.iter().all(is_plain)
}
