//! Chooses how pixels are coloured, by facts that hold for a whole draw or frame.
//!
//! This is the only place that chooses. Facts of a single triangle or block, such as clipping, can
//! still send it from a fast path to the fragment list.

use crate::frame::color_path::{ColorPath, ColorPaths, FullPath, ListPath};
use crate::frame::draw::{Back, Draw, Pipeline, Shaded};
use crate::frame::{Eye, FramePlan};
use marraztu_core::accuracy::{Arithmetic, Coverage, LightAt, Rounding};

/// Chooses the paths of all draws of a frame.
pub(crate) fn choose(plan: &FramePlan, to: &mut ColorPaths) {
    to.clear();
    for draw in &plan.draws {
        let pipelines = draw.part_pipelines.iter().flatten();
        to.add(pipelines.map(|pipeline| (*pipeline, color_path(plan, draw, *pipeline))));
    }
    to.looks_up_faces = looks_up_faces(plan);
    to.quick = is_quick(plan);
}

/// Chooses the path of a draw with one of its pipelines.
pub(crate) fn color_path(plan: &FramePlan, draw: &Draw, pipeline: u32) -> ColorPath {
    let pipeline = &plan.pipelines[pipeline as usize];
    let (full, list) = (full_path(plan, draw, pipeline), list_path(plan, draw, pipeline));
    ColorPath { full, list }
}

fn full_path(plan: &FramePlan, draw: &Draw, pipeline: &Pipeline) -> FullPath {
    let shaded = match pipeline {
        pipeline if is_uniform(plan, pipeline) => return FullPath::Fill,
        // Red back faces need the triangle of each pixel.
        Pipeline::Shaded(shaded) if is_plain(plan, draw) => shaded,
        Pipeline::Shaded(_) | Pipeline::Flat(_) => return FullPath::List,
    };
    let linear = plan.variants.are_linear();
    match plan.light_at {
        LightAt::Vertex if shows_corner_light(shaded) && !linear => FullPath::Corners,
        // Only fragment lists combine such light with texels, maps or linear values.
        LightAt::Vertex | LightAt::Face if shaded.light.is_some() => FullPath::List,
        LightAt::Face | LightAt::Vertex | LightAt::Pixel | LightAt::Sample => {
            let stages = shaded.light.as_deref().unwrap_or_default();
            // One pass over a block knows a texture and uniform emission, but no shadows.
            let is_simple = shaded.extras.even_glow().is_some()
                && !(linear && shaded.texture.is_some())
                && !plan.shadows.any_of(stages);
            if is_simple { FullPath::Light } else { FullPath::List }
        }
    }
}

fn list_path(plan: &FramePlan, draw: &Draw, pipeline: &Pipeline) -> ListPath {
    let Pipeline::Shaded(shaded) = pipeline else { return ListPath::Alone };
    // Lists of several blocks must not read the block of a pixel, as shadows do. With light per
    // face, slots of all triangles are lit for each list, so joining lists does not pay.
    let joins = is_plain(plan, draw)
        && plan.light_at != LightAt::Face
        && shaded.extras.is_empty()
        && !plan.shadows.are_cast();
    // The light of tiny triangles is computed for pixels or is the colour of vertices, and nothing
    // else is read from a table of triangles.
    let is_lit = shaded.light.is_some()
        && match plan.light_at {
            LightAt::Pixel => true,
            LightAt::Vertex => !plan.variants.are_linear(),
            LightAt::Face | LightAt::Sample => false,
        };
    let may_be_tiny = is_lit
        && plan.eye == Eye::Point
        && plan.raster_mode().coverage == Coverage::Exact
        && shaded.texture.is_none()
        && shaded.opacity.is_none()
        && !shaded.vertex_colors;
    match (joins, may_be_tiny) {
        (true, true) => ListPath::Tiny,
        (true, false) => ListPath::Joined,
        (false, _) => ListPath::Alone,
    }
}

/// Whether fast paths may be used at all: they compute in f32, and do not know red back faces.
fn is_plain(plan: &FramePlan, draw: &Draw) -> bool {
    plan.arithmetic == Arithmetic::F32 && draw.back != Back::Red
}

/// Whether all pixels of a triangle have one colour.
pub(crate) fn is_uniform(plan: &FramePlan, pipeline: &Pipeline) -> bool {
    match pipeline {
        Pipeline::Flat(_) => true,
        Pipeline::Shaded(shaded) => {
            shaded.texture.is_none()
                && !shaded.vertex_colors
                && !shaded.extras.reads_texels()
                // Dithering rounds the same colour differently from pixel to pixel.
                && plan.variants.rounding != Rounding::Dithered
                && (shaded.light.is_none() || plan.light_at == LightAt::Face)
        }
    }
}

/// Whether a pixel shows nothing but the interpolated light at the corners of its triangle.
fn shows_corner_light(shaded: &Shaded) -> bool {
    shaded.light.is_some()
        && shaded.texture.is_none()
        && !shaded.vertex_colors
        && shaded.extras.is_empty()
}

/// Whether looking up the colours of faces pays: they are uniform for most pixels.
fn looks_up_faces(plan: &FramePlan) -> bool {
    let mut pipelines = plan.pipelines.iter();
    match plan.light_at {
        LightAt::Face => pipelines.any(|pipeline| is_uniform(plan, pipeline)),
        LightAt::Vertex | LightAt::Pixel | LightAt::Sample => {
            pipelines.all(|pipeline| is_uniform(plan, pipeline))
        }
    }
}

/// Whether little is computed for a pixel: light and textures are not looked up for each.
fn is_quick(plan: &FramePlan) -> bool {
    let is_plain = |pipeline: &Pipeline| match pipeline {
        Pipeline::Flat(_) => true,
        Pipeline::Shaded(shaded) => shaded.texture.is_none() && !shaded.extras.reads_texels(),
    };
    matches!(plan.light_at, LightAt::Face | LightAt::Vertex) && plan.pipelines.iter().all(is_plain)
}

/// Words a path for the plan, in a few letters: the panel has narrow columns.
pub(super) fn in_words(path: ColorPath) -> String {
    let full = match path.full {
        FullPath::Fill => "one colour",
        FullPath::Corners => "corners",
        FullPath::Light => "blocks",
        FullPath::List => "lists",
    };
    let list = match path.list {
        ListPath::Alone => "",
        ListPath::Joined => ", joined",
        ListPath::Tiny => ", tiny",
    };
    format!("{full}{list}")
}
