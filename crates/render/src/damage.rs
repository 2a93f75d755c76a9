//! Finds the tiles of a picture that another plan damages, which have to be painted again.
//!
//! Only plans are compared; no pixel is touched. A tile stays valid while everything that reaches
//! into it is drawn as before. The old and new bounds of every changed draw are therefore damaged.
//! Bounds are boxes of pixels: sometimes too large, never too small.
//!
//! Numbers are compared by their bits: 0 and -0 are equal, but their reciprocals are not.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec4;
use serde::{Deserialize, Serialize};

use crate::frame::draw::{Draw, Lines};
use crate::frame::{FramePlan, Viewport};
use crate::screen::coverage::{PixelBox, SUBPIXELS};
use crate::screen::tiles::{TILE, tiles_of};
use marraztu_core::base::image::Size;
use marraztu_core::base::math::same_bits;
use marraztu_core::scene::ItemId;

mod change;
mod compared;
pub(crate) mod kept_shadows;
mod shadow_reach;

pub use change::Change;
use compared::Compared;

/// The tiles to be painted again, and the cause.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Damage {
    pub(crate) tiles: Tiles,
    /// The tiles that may show another triangle, or the same one at another position.
    surfaces: Tiles,
    /// Whether the triangles and lines on the screen changed, or their numbers did.
    pub(crate) geometry: bool,
    cause: DamageCause,
}

/// The reason why tiles are painted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DamageCause {
    /// No picture has been finished yet.
    First,
    /// The size of the picture changed.
    Size,
    /// Everything moved on the screen: the camera, lens or projection changed.
    Camera,
    /// The colour of the background changed.
    Background,
    /// The accuracy settings changed.
    Settings,
    /// A shadow-casting light or a caster changed.
    Shadows,
    /// Something changed that a surface may mirror, or show through refraction.
    Surroundings,
    /// The order of draws changed, which decides between equal depths.
    Order,
    /// These items changed. An empty list means that the picture stays the same.
    Items(Vec<(ItemId, Change)>),
}

impl Damage {
    /// Damages every tile.
    pub(crate) fn all(cause: DamageCause, size: Size) -> Self {
        let tiles = Tiles::all(size);
        Self { surfaces: tiles.clone(), tiles, geometry: true, cause }
    }

    /// Damages these rows of tiles of a picture that was never drawn.
    pub(crate) fn rows(size: Size, rows: &Range<usize>) -> Self {
        let mut tiles = Tiles::none(size);
        let columns = usize::try_from(tiles.columns).expect("not negative");
        tiles.painted[rows.start * columns..rows.end * columns].fill(true);
        Self { surfaces: tiles.clone(), tiles, geometry: true, cause: DamageCause::First }
    }

    /// Compares two plans.
    pub(crate) fn between(before: &FramePlan, after: &FramePlan) -> Self {
        if let Some(cause) = whole(before, after) {
            return Self::all(cause, after.size);
        }
        // Draws are matched by item. Each match also has to keep the order, which breaks ties of
        // depth.
        let mut old: BTreeMap<ItemId, usize> = BTreeMap::new();
        for (i, draw) in before.draws.iter().enumerate() {
            old.insert(draw.item, i);
        }
        let mut compared = Compared { before, after, pipelines: BTreeMap::new() };
        let mut tiles = Tiles::none(after.size);
        let mut surfaces = tiles.clone();
        let mut items = Vec::new();
        let mut geometry = before.draws.len() != after.draws.len();
        let mut next = 0;
        for draw in &after.draws {
            let Some(at) = old.remove(&draw.item) else {
                items.push((draw.item, Change::Came));
                surfaces.add(reach(draw, after));
                geometry = true;
                continue;
            };
            // This draw has changed places with another, so ties of depth may have other winners.
            if at < next {
                return Self::all(DamageCause::Order, after.size);
            }
            next = at + 1;
            let earlier = &before.draws[at];
            let Some(change) = compared.change(earlier, draw) else { continue };
            items.push((draw.item, change));
            // Other pixels can only show through if a surface moved or its holes changed.
            let shows_others = change != Change::Look || compared.has_other_holes(earlier, draw);
            let changed = if shows_others { &mut surfaces } else { &mut tiles };
            // The item leaves its old pixels and covers its new ones.
            changed.add(reach(earlier, before));
            changed.add(reach(draw, after));
            geometry |= change != Change::Look;
        }
        // The remaining old draws have disappeared.
        for (item, at) in old {
            items.push((item, Change::Went));
            surfaces.add(reach(&before.draws[at], before));
            geometry = true;
        }
        // Shadows come last: they add tiles of draws that did not change themselves.
        tiles.add_all(&surfaces);
        if !shadow_reach::add(before, after, &mut tiles) {
            return Self { surfaces, ..Self::all(DamageCause::Shadows, after.size) };
        }
        // If no draw changed, the tiles show the shadow of a caster outside the view.
        let out_of_view = items.is_empty() && tiles.count() > 0;
        let cause = if out_of_view { DamageCause::Shadows } else { DamageCause::Items(items) };
        Self { tiles, surfaces, geometry, cause }
    }

    /// Returns the number of painted tiles, of 64 x 64 pixels each.
    #[must_use]
    pub fn tiles(&self) -> usize {
        self.tiles.count()
    }

    /// Returns the number of tiles in the picture.
    #[must_use]
    pub const fn tiles_in_all(&self) -> usize {
        self.tiles.painted.len()
    }

    /// Returns whether the picture stays the same.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        self.tiles() == 0
    }

    /// Returns the cause of the damage.
    #[must_use]
    pub const fn cause(&self) -> &DamageCause {
        &self.cause
    }
}

/// Returns the reason to paint everything, if there is one.
fn whole(before: &FramePlan, after: &FramePlan) -> Option<DamageCause> {
    // The other fields are compared draw by draw, or are not visible in the picture.
    let FramePlan {
        size,
        viewport,
        enlarged,
        background,
        eye,
        arithmetic,
        light_at,
        samples,
        lit_by_sample,
        shift: _,
        spacing: _,
        filter,
        transparency,
        variants,
        view_from_world,
        clip_from_view,
        line_width,
        stroke_width,
        lights: _,
        panoramas,
        shadows,
        draws: _,
        pipelines: _,
        surroundings: _,
        rules,
        light_ids: _,
        sample: _,
    } = after;
    let moved = *eye != before.eye
        || *viewport != before.viewport
        || !same_bits(view_from_world, &before.view_from_world)
        || !same_bits(clip_from_view, &before.clip_from_view);
    let settings = *arithmetic != before.arithmetic
        || *light_at != before.light_at
        || *samples != before.samples
        || *lit_by_sample != before.lit_by_sample
        || *filter != before.filter
        || *transparency != before.transparency
        || *variants != before.variants
        || *line_width != before.line_width
        || *stroke_width != before.stroke_width
        || *rules != before.rules;
    // The first reason that applies is reported.
    match () {
        () if (*size, *enlarged) != (before.size, before.enlarged) => Some(DamageCause::Size),
        () if moved => Some(DamageCause::Camera),
        () if settings => Some(DamageCause::Settings),
        () if *background != before.background || *panoramas != before.panoramas => {
            Some(DamageCause::Background)
        }
        () if !shadows.is_same(&before.shadows) && !shadow_reach::is_known(before, after) => {
            Some(DamageCause::Shadows)
        }
        () if !have_same_surroundings(before, after) => Some(DamageCause::Surroundings),
        () => None,
    }
}

/// Returns whether rays see the same in both plans.
fn have_same_surroundings(before: &FramePlan, after: &FramePlan) -> bool {
    match (before.surroundings.as_deref(), after.surroundings.as_deref()) {
        (None, None) => true,
        (Some(before), Some(after)) => {
            let Damage { tiles, cause, .. } = Damage::between(before, after);
            let is_alike = matches!(cause, DamageCause::Items(items) if items.is_empty());
            is_alike && tiles.count() == 0 && after.shadows.is_same(&before.shadows)
        }
        _ => false,
    }
}

/// Bounds the pixels that a draw may cover.
///
/// The projection of everything in front of the near plane is within the projection of its bounding
/// box. If the box reaches the near plane, or normals stick out of it, the bounds are the whole
/// picture.
fn reach(draw: &Draw, plan: &FramePlan) -> PixelBox {
    let [right, bottom] = [plan.size.width, plan.size.height]
        .map(|pixels| i32::try_from(pixels).expect("pictures have 32-bit sizes"));
    let all = PixelBox { left: 0, top: 0, right, bottom };
    let Lines { edges: _, face_normals, vertex_normals, color: _ } = draw.lines;
    let Some(bounds) = draw.model.mesh.bounds() else { return all };
    if face_normals.is_some() || vertex_normals.is_some() {
        return all;
    }
    let corners = bounds.corners().map(|corner| draw.clip_from_object * corner.extend(1.0));
    // The margin is the width of lines.
    let width = plan.line_width.max(plan.stroke_width / SUBPIXELS + 1);
    around(plan, &corners, f64::from(width)).unwrap_or(all)
}

/// Bounds the pixels that the convex hull of points in clip space may cover, plus a margin. `None`
/// if the hull reaches the near plane.
#[expect(clippy::cast_possible_truncation, reason = "brought into the picture, which is small")]
fn around(plan: &FramePlan, points: &[DVec4], margin: f64) -> Option<PixelBox> {
    let [right, bottom] = [plan.size.width, plan.size.height]
        .map(|pixels| i32::try_from(pixels).expect("pictures have 32-bit sizes"));
    let all = PixelBox { left: 0, top: 0, right, bottom };
    let Viewport { width, height } = plan.viewport;
    let [mut low, mut high] = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for clip in points {
        let before_the_near_plane = clip.w > 0.0 && clip.z <= clip.w;
        let at = [(clip.x / clip.w + 1.0) * width / 2.0, (1.0 - clip.y / clip.w) * height / 2.0];
        if !before_the_near_plane || !at.iter().all(|at| at.is_finite()) {
            return None;
        }
        for axis in 0..2 {
            (low[axis], high[axis]) = (low[axis].min(at[axis]), high[axis].max(at[axis]));
        }
    }
    // One more pixel for rounding and snapping.
    let margin = margin + 1.0;
    // Clamped to fit i32; pictures are smaller.
    let [left, top] = low.map(|at| (at - margin).floor().clamp(-1e6, 1e6) as i32);
    let [right, bottom] = high.map(|at| (at + margin).ceil().clamp(-1e6, 1e6) as i32);
    Some(PixelBox { left, top, right, bottom }.intersection(all))
}

/// A set of tiles of a picture, row by row.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Tiles {
    columns: i32,
    painted: Vec<bool>,
}

impl Tiles {
    fn all(size: Size) -> Self {
        let [columns, rows] = tiles_of(size);
        let count = usize::try_from(columns * rows).expect("not negative");
        Self { columns, painted: vec![true; count] }
    }

    fn none(size: Size) -> Self {
        let mut tiles = Self::all(size);
        tiles.painted.fill(false);
        tiles
    }

    /// Adds the tiles that a box of pixels touches.
    fn add(&mut self, pixels: PixelBox) {
        if pixels.is_empty() {
            return;
        }
        for row in pixels.top / TILE..=(pixels.bottom - 1) / TILE {
            for column in pixels.left / TILE..=(pixels.right - 1) / TILE {
                let tile = usize::try_from(row * self.columns + column).expect("not negative");
                self.painted[tile] = true;
            }
        }
    }

    /// Adds the tiles of another set of the same picture.
    fn add_all(&mut self, others: &Self) {
        for (own, other) in self.painted.iter_mut().zip(&others.painted) {
            *own |= other;
        }
    }

    fn count(&self) -> usize {
        self.painted.iter().filter(|painted| **painted).count()
    }

    /// Returns whether a tile is in the set.
    pub(crate) fn contains(&self, tile: usize) -> bool {
        self.painted[tile]
    }
}
