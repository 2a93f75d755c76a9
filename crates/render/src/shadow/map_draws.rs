//! Renders the pictures of shadow maps.

use crate::accel::Accelerated as _;
use fearless_simd::Level;
use glam::{DMat3, DMat4, DVec3};
use rayon::prelude::*;

use super::map_bias::{Bordered, Limit, Picture};
use super::map_face::Face;
use crate::cancellation::Cancellation;
use crate::frame::FramePlan;
use crate::frame::draw::{Back, Draw, Lines, Pipeline, Shaded, uniform};
use crate::frame::shadows::{Caster, CasterPart, Shadows};
use crate::frame::variants::Variants;
use crate::lights::PhongMaterial;
use crate::raster::entries::key;
use crate::raster::geometry::ScreenGeometry;
use crate::raster::tile::Visibility;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::clip::Screen;
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use crate::screen::sample_positions::SamplePositions;
use crate::screen::tiles::{BLOCK_PIXELS, PIXELS, TILE, tiles_of};
use marraztu_core::accuracy::{Samples, ShadowMapForm, Transparency};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_core::base::math::each;
use marraztu_core::scene::{NormalSource, Normals};

/// Slightly more than half a texel, because corners are snapped to 1/256 of one.
const HALF: f64 = 0.51;

/// The largest slope that the bias takes into account, relative to 45 degrees.
const STEEPEST: f64 = 16.0;

/// A light's view for one picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapView {
    pub(super) view_from_world: DMat4,
    pub(super) clip_from_view: DMat4,
    /// The slope of a surface at 45 degrees, times the texels of a row: a depth or, in perspective,
    /// a fraction of the depth.
    pub(super) slope: f64,
    pub(super) is_perspective: bool,
}

/// The renderer of a frame's shadow maps.
#[derive(Debug)]
pub(super) struct MapDraws {
    plan: FramePlan,
    casters: Vec<Caster>,
    geometry: ScreenGeometry,
    form: ShadowMapForm,
    shown: Shown,
}

/// The rendered picture of a light; its memory is reused for the next picture.
#[derive(Debug, Default)]
struct Shown {
    /// A depth per texel (0 if empty) and the slope of its triangle, tile by tile and block by
    /// block.
    depths: Vec<f32>,
    slopes: Vec<f32>,
    /// Whether each tile has any texels.
    drawn: Vec<bool>,
}

impl MapDraws {
    /// Creates the draws of a plan's casters. The pictures of a map differ only in their view.
    pub(super) fn new(plan: &FramePlan, form: ShadowMapForm) -> Self {
        let casters = plan.shadows.casters.clone();
        // Only depths are read, so all parts without holes share one pipeline.
        let mut pipelines = vec![Pipeline::Flat(Color::WHITE)];
        let draws = casters.iter().map(|caster| draw(caster, &mut pipelines)).collect();
        // A map has one depth per texel, whatever samples and variants the view uses.
        let plan = FramePlan {
            size: Size::new(form.side, form.side),
            viewport: Size::new(form.side, form.side).into(),
            enlarged: None,
            samples: Samples::One,
            lit_by_sample: false,
            shift: [0; 2],
            transparency: Transparency::Threshold,
            variants: Variants::default(),
            line_width: 1,
            stroke_width: SUBPIXELS,
            lights: Vec::new(),
            light_ids: Vec::new(),
            shadows: Shadows::default(),
            draws,
            pipelines,
            ..plan.clone()
        };
        plan.prepare();
        let geometry = ScreenGeometry::default();
        Self { plan, casters, geometry, form, shown: Shown::default() }
    }

    /// Renders a picture. `None` if it is empty.
    pub(super) fn face(&mut self, level: Level, view: &MapView) -> Option<Face> {
        let Self { plan, casters, geometry, form, shown } = self;
        // Only the transforms change from picture to picture.
        (plan.view_from_world, plan.clip_from_view) = (view.view_from_world, view.clip_from_view);
        for (draw, caster) in plan.draws.iter_mut().zip(casters) {
            draw.view_from_object = view.view_from_world * caster.world_from_object;
            draw.clip_from_object = view.clip_from_view * draw.view_from_object;
            draw.mirrored = DMat3::from_mat4(draw.view_from_object).determinant() < 0.0;
        }
        // A picture is always finished: cancellation is checked between lights.
        let watch = Cancellation::new(&|| true);
        geometry.build(level, plan, SamplePositions::default(), &watch);
        let (plan, geometry) = (&*plan, &*geometry);
        let [columns, rows] = tiles_of(plan.size);
        let count = usize::try_from(columns * rows).expect("not negative");
        if (0..count).all(|tile| geometry.is_empty(tile)) {
            return None;
        }
        // Slopes are computed from the corners of visible triangles in clip space.
        let screens: Vec<Screen> = plan
            .draws
            .iter()
            .map(|draw| Screen::new(draw.clip_from_object, plan.viewport))
            .collect();
        Tile { level, plan, geometry, screens: &screens }.draw_all(count, shown);
        // Bias needs the neighbours of each texel, so it starts after all tiles are drawn.
        let picture = Picture { side: form.side, depths: &shown.depths, slopes: &shown.slopes };
        let limit = limit(view, *form);
        let mut texels = vec![0.0; count * PIXELS];
        let tiles = texels.par_chunks_mut(PIXELS).enumerate();
        tiles.for_each_init(Bordered::default, |bordered, (tile, texels)| {
            if shown.drawn[tile] {
                bordered.biased(level, picture, (tile, &limit), texels);
            }
        });
        let clip_from_world = view.clip_from_view * view.view_from_world;
        Some(Face::new(clip_from_world, form.side, texels))
    }
}

/// Computes the limits of the bias for a picture.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "maps are small, and the nearest f32 is meant"
)]
fn limit(view: &MapView, form: ShadowMapForm) -> Limit {
    let reach = HALF + if form.is_filtered { 1.0 } else { 0.0 };
    let steepest = STEEPEST * view.slope / form.side as f64;
    Limit { reach: reach as f32, steepest: steepest as f32, is_perspective: view.is_perspective }
}

/// The inputs for drawing the tiles of a map.
struct Tile<'a> {
    level: Level,
    plan: &'a FramePlan,
    geometry: &'a ScreenGeometry,
    screens: &'a [Screen],
}

impl Tile<'_> {
    /// Draws all tiles in parallel.
    fn draw_all(&self, count: usize, shown: &mut Shown) {
        let Shown { depths, slopes, drawn } = shown;
        for row in [&mut *depths, &mut *slopes] {
            row.resize(count * PIXELS, 0.0);
        }
        drawn.resize(count, false);
        let tiles = depths.par_chunks_mut(PIXELS).zip(slopes.par_chunks_mut(PIXELS));
        let tiles = tiles.zip(drawn.par_iter_mut()).enumerate();
        tiles.for_each_init(
            Visibility::default,
            |visibility, (tile, ((depths, slopes), drawn))| {
                // Cleared only if the last picture drew this tile.
                if *drawn {
                    depths.fill(0.0);
                    slopes.fill(0.0);
                }
                *drawn = !self.geometry.is_empty(tile);
                if *drawn {
                    self.draw(visibility, tile, depths, slopes);
                }
            },
        );
    }

    /// Draws a tile: the depth and slope of each texel, block by block.
    fn draw(
        &self,
        visibility: &mut Visibility,
        tile: usize,
        depths: &mut [f32],
        slopes: &mut [f32],
    ) {
        let Self { level, plan, geometry, .. } = *self;
        let [columns, _] = tiles_of(plan.size);
        let at = i32::try_from(tile).expect("a map has few tiles");
        let (left, top) = (at % columns * TILE, at / columns * TILE);
        let bounds = PixelBox { left, top, right: left + TILE, bottom: top + TILE };
        visibility.draw(level, plan, geometry, (tile, bounds));
        let blocks = depths.chunks_mut(BLOCK_PIXELS).zip(slopes.chunks_mut(BLOCK_PIXELS));
        for (block, (depths, slopes)) in blocks.enumerate() {
            if !visibility.shows(block) {
                continue;
            }
            let words = visibility.entries(level, block, 0);
            // The triangles of the left and upper texels, with their slopes: most texels reuse one
            // of them.
            let (mut last, mut above) = ((u32::MAX, 0.0), [(u32::MAX, 0.0); 8]);
            for (i, ((depth, slope), word)) in depths.iter_mut().zip(slopes).zip(words).enumerate()
            {
                let Visible::Triangle(number) = seen(word) else { continue };
                let around = [last, above[i % 8], above[(i % 8 + 1) % 8]];
                let known = around.into_iter().find(|(other, _)| *other == number);
                last = known.unwrap_or_else(|| (number, self.slope(number)));
                above[i % 8] = last;
                (*depth, *slope) = (f32::from_bits(key(word)), last.1);
            }
        }
    }

    /// Computes the largest change of a triangle's depth from texel to texel.
    ///
    /// With the corners p, q, r in homogeneous pixels (x, y, w) and their z, the plane of depths is
    /// (zp (q x r) + zq (r x p) + zr (p x q)) / (p . (q x r)), even if a corner is behind the
    /// light.
    #[expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
    fn slope(&self, number: u32) -> f32 {
        let (draw, start) = self.geometry.draw_of(number);
        let screen = &self.screens[draw as usize];
        let order = self.plan.draws[draw as usize].model.mesh.draw_order();
        let clip = each(order.vertices_of(number - start.number), |vertex| {
            screen.clip(order.position(vertex))
        });
        let [p, q, r] = clip
            .map(|[x, y, _, w]| DVec3::new((x + w) * screen.half[0], (w - y) * screen.half[1], w));
        let [zp, zq, zr] = clip.map(|[_, _, z, _]| z);
        let plane = q.cross(r) * zp + r.cross(p) * zq + p.cross(q) * zr;
        let slope = (plane.x.abs() + plane.y.abs()) / p.dot(q.cross(r)).abs();
        // A triangle seen exactly edge-on has no finite slope.
        if slope.is_finite() { slope as f32 } else { 0.0 }
    }
}

/// Creates the draw of a caster, for a view that is set later.
fn draw(caster: &Caster, pipelines: &mut Vec<Pipeline>) -> Draw {
    let mut pipeline = |part: &CasterPart| {
        let Some(pipeline) = pipeline_of(part) else { return 0 };
        pipelines.push(pipeline);
        u32::try_from(pipelines.len() - 1).expect("a scene has fewer parts")
    };
    // Maps know no colours: light passes through glass undimmed.
    let is_opaque = |part: &&CasterPart| part.filter.is_none();
    let part_pipelines: Vec<Option<u32>> = caster
        .parts
        .iter()
        .map(|part| part.as_ref().filter(is_opaque).map(&mut pipeline))
        .collect();
    Draw {
        item: caster.item,
        model: caster.model.clone(),
        clip_from_object: DMat4::IDENTITY,
        view_from_object: DMat4::IDENTITY,
        view_from_normal: DMat3::IDENTITY,
        mirrored: false,
        // Both sides of a surface cast shadows.
        back: Back::Lit,
        culls_opaque: false,
        normals: Normals::Vertex,
        normal_source: NormalSource::Computed,
        uniform: uniform(&part_pipelines),
        bodies: Vec::new(),
        part_pipelines,
        polygons: caster.polygons.clone(),
        filled: true,
        lines: Lines::NONE,
        strokes: None,
    }
}

/// Creates the alpha test of a part, if it has holes.
fn pipeline_of(part: &CasterPart) -> Option<Pipeline> {
    let holes = part.holes.as_ref()?;
    Some(Pipeline::Shaded(Shaded {
        texture: holes.texture.clone(),
        cutout: Some(holes.opacity),
        opacity_map: holes.map.clone(),
        ..Shaded::unlit(PhongMaterial::default())
    }))
}
