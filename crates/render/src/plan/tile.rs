//! Light culling per tile, after the depths of the tile are known and before it is coloured.
//!
//! The pixels of a tile and its nearest and farthest depth bound a piece of the view frustum that
//! contains everything the tile shows. A light that does not reach the piece is removed from the
//! stages of the tile, so no pixel has to check.

use glam::DVec3;

use super::rules::{LitSurface, Reading};
use crate::frame::draw::{Pipeline, Shaded, Stage};
use crate::frame::{Eye, FramePlan, Viewport};
use crate::lights::region::Region;
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use marraztu_core::accuracy::Samples;

/// The error of interpolating a depth or 1/w in f32, relative to the largest value.
const ROUNDING: f64 = 2e-6;

/// The stages of a tile. Each thread reuses one from tile to tile.
#[derive(Debug, Default)]
pub(crate) struct TilePlan {
    /// The region that contains everything the tile shows, if any pipeline needs it.
    region: Option<Region>,
    /// The decision about each pipeline in this tile, if it was made already.
    decided: Vec<Option<Decided>>,
    /// The pipelines with a decision for this tile.
    seen: Vec<usize>,
    /// The indices of the kept stages, one list after another.
    kept: Vec<u32>,
}

/// The decision about a pipeline in a tile: a range of `kept`.
#[derive(Clone, Copy, Debug)]
struct Decided {
    from: usize,
    to: usize,
    needs_positions: bool,
}

/// The lights that colour a tile, for one pipeline.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileLight<'a> {
    /// All stages of the pipeline, in the order of the scene.
    pub(crate) stages: &'a [Stage],
    /// The indices of the evaluated stages, if not all are.
    pub(crate) kept: Option<&'a [u32]>,
    /// Whether any of them reads positions and normals.
    pub(crate) needs_positions: bool,
}

impl<'a> TileLight<'a> {
    /// Returns all lights of a surface.
    pub(crate) fn of(shaded: &'a Shaded) -> Self {
        let Shaded { needs_positions, .. } = *shaded;
        Self { stages: shaded.stages(), kept: None, needs_positions }
    }
}

impl TilePlan {
    /// Begins a tile. `depths` returns the smallest and largest depth of its triangles, if it has
    /// any.
    pub(crate) fn begin(
        &mut self,
        plan: &FramePlan,
        bounds: PixelBox,
        depths: impl FnOnce() -> Option<[f32; 2]>,
    ) {
        // Only entries of the last tile are cleared, because a frame may have many pipelines.
        for pipeline in self.seen.drain(..) {
            self.decided[pipeline] = None;
        }
        self.kept.clear();
        let tiled =
            |pipeline: &Pipeline| matches!(pipeline, Pipeline::Shaded(Shaded { tiled: true, .. }));
        // With several samples, a pixel may be lit at a point that has another depth.
        let middles = plan.samples == Samples::One || plan.lit_by_sample;
        let tiled = middles && plan.pipelines.iter().any(tiled);
        // Finding the depths reads the whole tile, so it is only done for lights with a reach.
        let depths = tiled.then(depths);
        self.region = depths.flatten().map(|depths| region(plan, bounds, depths.map(f64::from)));
        self.decided.resize(plan.pipelines.len(), None);
    }

    /// Returns the lights of a surface in this tile.
    pub(crate) fn light<'a>(
        &'a mut self,
        plan: &FramePlan,
        pipeline: u32,
        shaded: &'a Shaded,
    ) -> TileLight<'a> {
        let stages = shaded.stages();
        let Some(region) = self.region.filter(|_| shaded.tiled) else {
            return TileLight::of(shaded);
        };
        let at = pipeline as usize;
        let decided = match self.decided[at] {
            Some(decided) => decided,
            None => self.decide(plan, shaded, stages, &region),
        };
        // New decisions are listed, so the next tile can clear them.
        if self.decided[at].replace(decided).is_none() {
            self.seen.push(at);
        }
        let Decided { from, to, needs_positions } = decided;
        TileLight { stages, kept: Some(&self.kept[from..to]), needs_positions }
    }

    fn decide(
        &mut self,
        plan: &FramePlan,
        shaded: &Shaded,
        stages: &[Stage],
        region: &Region,
    ) -> Decided {
        let material = &shaded.material;
        let light = |place: u32| &plan.lights[stages[place as usize].light as usize];
        let reaches = |place: &u32| {
            let Stage { effect, light: number, .. } = stages[*place as usize];
            if plan.shadows.radius(number) > 0.0 {
                return true;
            }
            let (light, region, turning) = (light(*place), Some(region), None);
            plan.rules.tile(&LitSurface { effect, light, material, region, turning }).is_none()
        };
        let from = self.kept.len();
        let count = u32::try_from(stages.len()).expect("fewer than 2^32 lights");
        self.kept.extend((0..count).filter(reaches));
        let kept = self.kept[from..].iter().map(|place| &stages[*place as usize]);
        let needs_positions =
            shaded.extras.rays.is_some() || plan.rules.positions(&Reading::of(kept)).is_none();
        Decided { from, to: self.kept.len(), needs_positions }
    }
}

/// Computes the region of view space that projects to these pixels and depths.
fn region(plan: &FramePlan, bounds: PixelBox, [low, high]: [f64; 2]) -> Region {
    let m = &plan.clip_from_view;
    let (zz, zw) = (m.z_axis.z, m.w_axis.z);
    let Viewport { width, height } = plan.viewport;
    let [right, down] = plan.shift.map(|shift| f64::from(shift) / f64::from(SUBPIXELS));
    let axis = plan.axis();
    // A pixel as x and y at w = 1; in orthographic projection, at any depth.
    let ray = |x: i32, y: i32| {
        let (x, y) = (f64::from(x) + right, f64::from(y) + down);
        let (x, y) = (x * 2.0 / width - 1.0, 1.0 - y * 2.0 / height);
        [(x - axis[0]) / m.x_axis.x, (y - axis[1]) / m.y_axis.y]
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
        // The depth is zw / w - zz. 1/w is at most its value at the near plane, where the depth is
        // 1.
        Eye::Point => {
            let inverse = |depth: f64| (depth + zz) / zw;
            let error = ROUNDING * inverse(1.0);
            let farthest = inverse(0.0);
            // 1/w minus its error could be 0 or negative, so the far plane bounds w.
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
