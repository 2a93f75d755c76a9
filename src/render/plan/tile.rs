//! What a tile of the picture does without, once its depths are known and before it is coloured.
//!
//! The pixels of a tile and the nearest and farthest of its depths are a piece of the view's pyramid,
//! and all that the tile shows lies in it. A light that misses the piece is taken out of the lists of
//! stages that the tile is coloured by; so no pixel asks.

use glam::DVec3;

use super::rules::{Meeting, Reading};
use super::{Eye, FramePlan, Pipeline, Shaded, Stage, bounded};
use crate::render::coverage::PixelBox;
use crate::render::region::Region;
use crate::render::tile::{self, BLOCK_PIXELS, Seen, Visibility};
use crate::scene::LeaveOut;

/// What interpolating a depth, or one by w, in 32 bits may be wrong by, as a part of the largest.
const ROUNDING: f64 = 2e-6;

/// The stages of a tile. Each thread has its own, and keeps its memory.
#[derive(Debug, Default)]
pub(in crate::render) struct TilePlan {
    /// Where everything is that the tile shows, where it matters.
    region: Option<Region>,
    /// By pipeline: what was decided, if it was in this tile.
    decided: Vec<Option<Decided>>,
    /// The lists of stages, one behind the other.
    stages: Vec<Stage>,
    kept: Vec<Stage>,
}

/// What was decided about a pipeline in a tile.
#[derive(Clone, Copy, Debug)]
struct Decided {
    from: usize,
    to: usize,
    places: bool,
    dropped: f64,
}

/// The lights that a tile is coloured by, with one pipeline.
#[derive(Clone, Copy, Debug)]
pub(in crate::render) struct TileLight<'a> {
    /// In the order of the scene.
    pub(in crate::render) stages: &'a [Stage],
    /// Whether any of them looks at places and normals.
    pub(in crate::render) places: bool,
    /// What the lights that were left out add at most, in steps of a byte.
    pub(in crate::render) dropped: f64,
}

impl TilePlan {
    /// Turns to a tile whose visibility is known.
    pub(in crate::render) fn begin(
        &mut self,
        plan: &FramePlan,
        visibility: &Visibility,
        bounds: PixelBox,
    ) {
        self.decided.clear();
        self.stages.clear();
        let tiled =
            |pipeline: &Pipeline| matches!(pipeline, Pipeline::Shaded(Shaded { tiled: true, .. }));
        let depths = plan.pipelines.iter().any(tiled).then(|| depths(visibility));
        self.region = depths.flatten().map(|depths| region(plan, bounds, depths));
        if self.region.is_some() {
            self.decided.resize(plan.pipelines.len(), None);
        }
    }

    /// The lights of a surface in this tile.
    pub(in crate::render) fn light<'a>(
        &'a mut self,
        plan: &FramePlan,
        pipeline: u32,
        shaded: &'a Shaded,
    ) -> TileLight<'a> {
        let stages = shaded.light.as_deref().unwrap_or_default();
        let whole = TileLight { stages, places: shaded.places, dropped: shaded.dropped };
        let Some(region) = self.region.filter(|_| shaded.tiled) else { return whole };
        let at = pipeline as usize;
        let decided = match self.decided[at] {
            Some(decided) => decided,
            None => self.decide(plan, shaded, stages, &region),
        };
        self.decided[at] = Some(decided);
        let Decided { from, to, places, dropped } = decided;
        TileLight { stages: &self.stages[from..to], places, dropped }
    }

    fn decide(
        &mut self,
        plan: &FramePlan,
        shaded: &Shaded,
        stages: &[Stage],
        region: &Region,
    ) -> Decided {
        let matter = &shaded.matter;
        self.kept.clear();
        self.kept.extend(stages.iter().filter(|stage| {
            let lamp = &plan.lamps[stage.lamp as usize];
            let meeting =
                Meeting { effect: stage.effect, lamp, matter, region: Some(region), facing: None };
            plan.rules.tile(&meeting).is_none()
        }));
        let mut dropped = shaded.dropped;
        if plan.leave_out == LeaveOut::HalfStep {
            let budget = bounded::LIGHTS - dropped;
            let lit = (&plan.lamps[..], matter);
            dropped += bounded::thin(&mut self.kept, lit, Some(region), budget, |_, _| {});
        }
        let from = self.stages.len();
        self.stages.extend_from_slice(&self.kept);
        let places = plan.rules.places(&Reading { stages: &self.kept }).is_none();
        Decided { from, to: self.stages.len(), places, dropped }
    }
}

/// The farthest and the nearest depth of all triangles that a tile shows.
fn depths(visibility: &Visibility) -> Option<[f64; 2]> {
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for block in 0..BLOCK_PIXELS {
        let (words, _) = visibility.block(block);
        for word in words {
            if let Seen::Triangle(_) = tile::seen(*word) {
                let depth = tile::depth(*word);
                (low, high) = (low.min(depth), high.max(depth));
            }
        }
    }
    (low <= high).then(|| [f64::from(low), f64::from(high)])
}

/// The piece of view space whose pixels and depths these are.
fn region(plan: &FramePlan, bounds: PixelBox, [low, high]: [f64; 2]) -> Region {
    let m = &plan.clip_from_view;
    let (zz, zw) = (m.z_axis.z, m.w_axis.z);
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    let (width, height) = (plan.size.width as f64, plan.size.height as f64);
    let ray = |x: i32, y: i32| {
        let (x, y) = (f64::from(x) * 2.0 / width - 1.0, 1.0 - f64::from(y) * 2.0 / height);
        [x / m.x_axis.x, y / m.y_axis.y]
    };
    let rays = [
        ray(bounds.left, bounds.top),
        ray(bounds.right, bounds.top),
        ray(bounds.left, bounds.bottom),
        ray(bounds.right, bounds.bottom),
    ];
    let place: [fn([f64; 2], f64) -> DVec3; 2] =
        [|[x, y], w| DVec3::new(x * w, y * w, -w), |[x, y], z| DVec3::new(x, y, z)];
    let (ends, place) = match plan.eye {
        // The depth is zw / w - zz, and 1/w is at most that of the near plane, where it is 1.
        Eye::Point => {
            let inverse = |depth: f64| (depth + zz) / zw;
            let error = ROUNDING * inverse(1.0);
            let farthest = inverse(0.0);
            let w = |inverse_w: f64| 1.0 / inverse_w.max(farthest * (1.0 - ROUNDING));
            ([w(inverse(low) - error), w(inverse(high) + error)], place[0])
        }
        // The depth is zz z + zw.
        Eye::Parallel => {
            let z = |depth: f64| (depth - zw) / zz;
            let error = ROUNDING * (z(0.0).abs() + z(1.0).abs() + (z(1.0) - z(0.0)).abs());
            ([z(low) - error, z(high) + error], place[1])
        }
    };
    let corner = |i: usize| place(rays[i / 2], ends[i % 2]);
    Region::new(std::array::from_fn(corner), 0.0)
}
