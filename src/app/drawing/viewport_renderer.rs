//! Draws the pictures of the viewport and answers picks.
//!
//! The quality of a picture adapts to the time it takes (see
//! [`adaptive_quality`](super::adaptive_quality)), and only what has changed is redrawn.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::ColorImage;
use serde::{Deserialize, Serialize};

use super::adaptive_quality::{AdaptiveQuality, Attempt};
use super::border::{Border, fills_most};
use super::dial::{DialFigures, IdleDial};
use super::images::present;
use super::painted::Painted;
use super::reduction::{Applicable, Reduction};
use super::refinement::{difference, next_samples};
use super::snapshot::{DrawOptions, Snapshot};
use marraztu_core::accuracy::{Samples, Settings, Shot};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{ItemId, Surface};
use marraztu_lab::cost::{self, Explained};
use marraztu_render::plan_frame;
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{Cancelled, Damage, FramePlan, Hit, Renderer};

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Drawn {
    #[serde(with = "super::images::without_pixels")]
    pub(crate) image: Arc<ColorImage>,
    /// The time from the snapshot to the finished picture in memory.
    pub(crate) time: Duration,
    pub(crate) triangles: usize,
    pub(crate) reduction: Reduction,
    /// The measured error of that reduction, in steps of a byte.
    pub(crate) lost: Option<f64>,
    /// The samples per pixel, if this is the last picture after refinement.
    pub(crate) refined: Option<Samples>,
    /// The parts that were redrawn, and why.
    pub(crate) changes: Damage,
}

/// The outcome of one step of refinement.
#[derive(Debug)]
pub(crate) enum Finer {
    /// Nothing is left to do.
    Done,
    /// A request arrived, so the step was cancelled.
    Disturbed,
    /// A reduction was measured.
    Measured,
    /// The picture is refined.
    Refined(Box<Drawn>),
    /// There are better figures for the dial.
    Dial(Box<DialFigures>),
}

/// The frame that is wanted while a frame is being drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Asked {
    /// This frame.
    This,
    /// A newer frame.
    Newer,
    /// No frame: the window is closing.
    Nothing,
}

/// The renderer, and the images that its pictures are copied to.
#[derive(Debug)]
pub(crate) struct ViewportRenderer {
    renderer: Renderer,
    /// Draws refined pictures and reductions to measure. Picks never read its buffers.
    finer: Renderer,
    /// The samples per pixel that the last picture is refined to.
    refined: Option<Samples>,
    /// The clock; tests replace it.
    clock: fn() -> Instant,
    quality: AdaptiveQuality,
    dial: IdleDial,
    /// The reduction of the last finished picture; `None` before the first.
    shown: Option<Reduction>,
    /// Whether the last frame was cancelled.
    gave_up: bool,
    /// Receives the progress of the picture that is being drawn.
    painted: Arc<Painted>,
    /// The last explanation.
    explained: Option<Arc<Explained>>,
    /// The copies of the last pictures, the latest at the end. The window may hold one and the code
    /// that paints it another, so one is free to copy into: no picture is overwritten while it is
    /// shown.
    images: [Arc<ColorImage>; 3],
}

impl ViewportRenderer {
    pub(crate) fn new(clock: fn() -> Instant, painted: Arc<Painted>) -> Self {
        Self {
            renderer: Renderer::default(),
            finer: Renderer::default(),
            refined: None,
            clock,
            quality: AdaptiveQuality::default(),
            dial: IdleDial::default(),
            shown: None,
            gave_up: false,
            painted,
            explained: None,
            images: <[Arc<ColorImage>; 3]>::default(),
        }
    }

    /// Draws the picture. Returns `None` if it equals the last one or was cancelled for a newer
    /// one.
    pub(crate) fn draw(
        &mut self,
        wanted: &Snapshot,
        asked: &(dyn Fn() -> Asked + Sync),
    ) -> Option<Drawn> {
        let begun = (self.clock)();
        // The reduction depends on the share of the picture to redraw at full quality.
        let mut plan = planned(wanted, Reduction::NONE);
        let mut changes = self.renderer.damage(&plan);
        let share = share(&changes);
        let DrawOptions { moving, budget, .. } = wanted.options;
        let applicable = applicable(wanted, plan.casts_rays());
        let reduction = self.quality.choose(moving, share, applicable, budget);
        if reduction != Reduction::NONE && !changes.is_nothing() {
            plan = planned(wanted, reduction);
            changes = self.renderer.damage(&plan);
        }
        if changes.is_nothing() {
            return self.unrefined(wanted, changes);
        }
        // A newer request cancels this frame only if the frame is too slow; see `Attempt`.
        let expected = self.quality.expected(reduction, share);
        let attempt =
            Attempt { reduction, expected, second: self.gave_up, budget: wanted.options.budget };
        let clock = self.clock;
        let wanted = || match asked() {
            Asked::This => true,
            Asked::Newer => !attempt.gives_way(clock().duration_since(begun)),
            Asked::Nothing => false,
        };
        let painted = &self.painted;
        let tell = |done, all| painted.tell(done, all);
        let drawn = self.renderer.redraw_watched(&plan, &wanted, &tell);
        painted.tell(0, 0);
        self.gave_up = drawn == Err(Cancelled);
        if self.gave_up {
            self.quality.record_given_up(share, clock().duration_since(begun));
            return None;
        }
        // The picture is finished: it is shown, and its time guides the next choice.
        present(&mut self.images, self.renderer.picture());
        (self.shown, self.refined) = (Some(reduction), None);
        let time = clock().duration_since(begun);
        self.quality.record(reduction, share, time);
        Some(self.drawn(time, changes))
    }

    /// Describes the picture that is shown now.
    fn drawn(&self, time: Duration, changes: Damage) -> Drawn {
        let reduction = self.shown.unwrap_or_default();
        Drawn {
            image: Arc::clone(&self.images[2]),
            time,
            triangles: self.renderer.triangles_drawn(),
            reduction,
            lost: self.quality.error(reduction),
            refined: self.refined,
            changes,
        }
    }

    /// Shows the picture as it was before refinement, if it is refined further than requested.
    fn unrefined(&mut self, wanted: &Snapshot, changes: Damage) -> Option<Drawn> {
        let refined = self.refined?;
        if wanted.options.refined.is_some_and(|most| most.count() >= refined.count()) {
            return None;
        }
        self.refined = None;
        present(&mut self.images, self.renderer.picture());
        Some(self.drawn(Duration::ZERO, changes))
    }

    /// Takes one step of the work to do while the user is idle, unless `wanted` returns false:
    /// measures a reduction if pictures of this scene are too slow, or refines the last picture.
    pub(crate) fn refine(
        &mut self,
        snapshot: &Snapshot,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Finer {
        if snapshot.options.moving || self.gave_up {
            return Finer::Done;
        }
        let begun = (self.clock)();
        let full = planned(snapshot, Reduction::NONE);
        let applicable = applicable(snapshot, full.casts_rays());
        match self.shown {
            Some(Reduction::NONE) => {}
            Some(shown) if shown == Reduction::PREVIEW => {
                return self.complete(&full, snapshot, wanted);
            }
            Some(_) | None => return Finer::Done,
        }
        // Measurements come first: they decide the quality of the next drag.
        let measured = self.quality.unmeasured(applicable, snapshot.options.budget);
        if let Some(reduction) = measured.filter(|_| snapshot.options.coarse) {
            if self.finer.redraw(&planned(snapshot, reduction), wanted).is_err() {
                return Finer::Disturbed;
            }
            let time = (self.clock)().duration_since(begun);
            let error = difference(self.renderer.picture(), self.finer.picture(), reduction.shrink);
            self.quality.measured(reduction, time, error);
            return Finer::Measured;
        }
        // Each step raises the number of samples, so intermediate results appear early. The dial
        // comes last.
        let Some(samples) = next_samples(snapshot, self.refined) else {
            return self.dial.step(snapshot, wanted);
        };
        let settings = Settings { samples, ..snapshot.shot.settings };
        let shot = snapshot.shot.with(settings);
        let Ok(changes) = self.finer.redraw(&plan_frame(&shot), wanted) else {
            return Finer::Disturbed;
        };
        present(&mut self.images, self.finer.picture());
        self.refined = Some(samples);
        let time = (self.clock)().duration_since(begun);
        Finer::Refined(Box::new(self.drawn(time, changes)))
    }

    /// Draws the full picture after its preview.
    fn complete(
        &mut self,
        full: &FramePlan,
        snapshot: &Snapshot,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Finer {
        let begun = (self.clock)();
        let changes = self.renderer.damage(full);
        let painted = &self.painted;
        let tell = |done, all| painted.tell(done, all);
        let drawn = self.renderer.redraw_watched(full, wanted, &tell);
        painted.tell(0, 0);
        if drawn.is_err() {
            // Picks read the picture that is shown.
            let preview = planned(snapshot, Reduction::PREVIEW);
            _ = self.renderer.redraw(&preview, &|| true);
            return Finer::Disturbed;
        }
        present(&mut self.images, self.renderer.picture());
        (self.shown, self.refined) = (Some(Reduction::NONE), None);
        let time = (self.clock)().duration_since(begun);
        self.quality.record(Reduction::NONE, 1.0, time);
        Finer::Refined(Box::new(self.drawn(time, changes)))
    }

    /// Explains the effects of the last finished picture; `None` if that is not requested or has
    /// not changed.
    pub(crate) fn explain(&mut self, wanted: &Snapshot) -> Option<Arc<Explained>> {
        if !wanted.options.explain {
            self.explained = None;
            return None;
        }
        if self.gave_up {
            return None;
        }
        let of = reduced(wanted, self.shown?);
        let explained = cost::explain_with(&mut self.renderer, &of);
        if self.explained.as_deref() == Some(&explained) {
            return None;
        }
        self.explained = Some(Arc::new(explained));
        self.explained.clone()
    }

    /// Draws a window of the ideal of the last picture.
    pub(crate) fn ideal(
        &mut self,
        last: &Snapshot,
        window: PixelBox,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Option<Picture> {
        self.dial.ideal(last, window, wanted)
    }

    /// Returns whether the last picture was cancelled for a newer one.
    pub(crate) const fn was_given_up(&self) -> bool {
        self.gave_up
    }

    /// Finds one border around the visible parts of several items, filed under the id of one of
    /// them.
    pub(crate) fn border(&mut self, item: ItemId, all: &[ItemId]) -> Option<Border> {
        let (size, own) = self.mask(all)?;
        Some(Border::of(item, size, &own))
    }

    /// Finds the border around an item under the pointer; `None` if it fills most of the picture,
    /// as walls and floors do.
    pub(crate) fn border_under_pointer(&mut self, item: ItemId) -> Option<Border> {
        let (size, own) = self.mask(&[item])?;
        (!fills_most(size, &own)).then(|| Border::of(item, size, &own))
    }

    /// Marks the pixels inside the outline of these items.
    fn mask(&mut self, all: &[ItemId]) -> Option<(Size, Vec<bool>)> {
        self.shown?;
        let [width, height] = self.images[2].size;
        Some((Size::new(width, height), self.renderer.outlined_pixels(all)))
    }

    /// Returns the hit at a pixel of the picture at full size.
    pub(crate) fn hit(&mut self, [x, y]: [usize; 2]) -> Option<Hit> {
        let by = self.shown?.shrink.factor();
        self.renderer.hit(x / by, y / by)
    }
}

fn planned(wanted: &Snapshot, reduction: Reduction) -> FramePlan {
    plan_frame(&reduced(wanted, reduction))
}

fn reduced(wanted: &Snapshot, reduction: Reduction) -> Shot {
    let (settings, size) = reduction.applied(wanted.shot.settings, wanted.shot.size);
    Shot { settings, size, ..wanted.shot.clone() }
}

/// Returns the part of the picture that is redrawn, from 0 to 1.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 tiles")]
fn share(changes: &Damage) -> f64 {
    changes.tiles() as f64 / changes.tiles_in_all() as f64
}

fn applicable(wanted: &Snapshot, casts_rays: bool) -> Applicable {
    let textured = wanted.shot.scene.objects.iter().any(|(_, object)| {
        let own = object.model.materials.iter().any(|material| material.texture.is_some());
        object.visible && object.surface != Surface::Material && (own || object.texture.is_some())
    });
    let lights = wanted.shot.scene.lights.iter();
    let is_soft = lights.map(|(_, light)| light).any(|light| light.on && light.is_soft());
    Applicable { settings: wanted.shot.settings, textured, casts_rays: is_soft || casts_rays }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::OnceLock;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::super::reduction::Shrink;
    use super::*;
    use crate::app::drawing::border::Run;
    use crate::app::state::Statistics;
    use marraztu_core::base::color::Color;
    use marraztu_core::edit::items;
    use marraztu_core::scene::Command;
    use marraztu_io as io;

    fn snapshot(size: Size) -> Snapshot {
        let (scene, view) = io::default_scene();
        let budget = Duration::from_millis(33);
        let (moving, coarse, refined, dial, explain) = (false, true, None, None, false);
        let outlined = Vec::new();
        let options = DrawOptions { moving, coarse, budget, refined, dial, explain, outlined };
        Snapshot { shot: Shot::new(&scene, &view, &Settings::default(), size), options }
    }

    fn moving(mut snapshot: Snapshot) -> Snapshot {
        snapshot.options.moving = true;
        snapshot
    }

    /// Changes the background colour of a snapshot, which requires a full redraw.
    fn recolored(snapshot: &Snapshot, gray: u8) -> Snapshot {
        let mut other = snapshot.clone();
        Command::Background(Color([gray; 3])).apply(&mut other.shot.scene).unwrap();
        other
    }

    thread_local! {
        static NOW: Cell<Duration> = const { Cell::new(Duration::ZERO) };
    }

    /// Advances a clock by 40 ms each time it is read, so every frame takes 40 ms.
    fn slow() -> Instant {
        static BEGINNING: OnceLock<Instant> = OnceLock::new();
        let now = NOW.get() + Duration::from_millis(40);
        NOW.set(now);
        *marraztu_core::base::once::get_or_compute(&BEGINNING, Instant::now) + now
    }

    fn this() -> Asked {
        Asked::This
    }

    fn newer() -> Asked {
        Asked::Newer
    }

    #[test]
    fn the_time_that_is_shown_is_that_of_the_last_picture_that_was_drawn_in_part_or_whole() {
        let wanted = snapshot(Size::new(64, 48));
        let mut renderer = ViewportRenderer::new(Instant::now, Arc::default());
        let mut statistics = Statistics::default();
        let first = renderer.draw(&wanted, &this).unwrap();
        statistics.note(&first, 1);
        let mut finer = wanted.clone();
        finer.options.refined = Some(Samples::Four);
        assert!(matches!(renderer.refine(&finer, &|| true), Finer::Refined(_)));
        // Withdrawing the refinement shows the earlier picture again and takes no time.
        let again = renderer.draw(&wanted, &this).unwrap();
        assert_eq!(again.changes.tiles(), 0);
        statistics.note(&again, 2);
        assert_eq!((statistics.time, statistics.pictures), (first.time, 2));
        let other = renderer.draw(&recolored(&wanted, 9), &this).unwrap();
        statistics.note(&other, 3);
        assert_eq!(statistics.time, other.time);
    }

    #[test]
    fn a_new_picture_with_many_rays_is_preceded_by_one_of_few() {
        let lesson = io::lesson_scene("soft").unwrap();
        let own = snapshot(Size::new(256, 192));
        let shot = Shot::new(&lesson.scene, &lesson.view, &Settings::default(), own.shot.size);
        let wanted = Snapshot { shot, options: own.options };
        let mut renderer = ViewportRenderer::new(Instant::now, Arc::default());
        let preview = renderer.draw(&wanted, &this).unwrap();
        assert_eq!(preview.reduction, Reduction::PREVIEW);
        // Disturbed between two tiles, the preview stays, and can be picked.
        let asked = AtomicUsize::new(0);
        let disturbed = || asked.fetch_add(1, Ordering::Relaxed) < 10;
        assert!(matches!(renderer.refine(&wanted, &disturbed), Finer::Disturbed));
        let shown = Renderer::default().render(&planned(&wanted, Reduction::PREVIEW)).clone();
        assert_eq!(*renderer.renderer.picture(), shown);
        assert!(renderer.hit([128, 160]).is_some());
        let Finer::Refined(full) = renderer.refine(&wanted, &|| true) else { panic!("full") };
        assert_eq!((full.reduction, full.refined), (Reduction::NONE, None));
        let expected = Renderer::default().render(&planned(&wanted, Reduction::NONE)).clone();
        assert_eq!(*renderer.renderer.picture(), expected);
        assert_ne!(preview.image.pixels, full.image.pixels);
        // Nothing has changed, and the next picture is quick enough to be drawn at once.
        assert!(renderer.draw(&wanted, &this).is_none());
        let next = renderer.draw(&recolored(&wanted, 9), &this).unwrap();
        assert_eq!(next.reduction, Reduction::NONE);
    }

    #[test]
    fn a_border_runs_round_all_pixels_of_an_item_and_no_others() {
        let wanted = snapshot(Size::new(160, 120));
        let (size, item) = (wanted.shot.size, ItemId::Object(wanted.shot.view.object.unwrap()));
        let mut renderer = ViewportRenderer::new(Instant::now, Arc::default());
        renderer.draw(&wanted, &this).unwrap();
        let places = || (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
        let own: Vec<bool> = places()
            .map(|(x, y)| renderer.hit([x, y]).is_some_and(|hit| hit.item == item))
            .collect();
        assert_eq!(own, renderer.renderer.pixels_of(item));
        let is_own = |x: usize, y: usize| own[y * size.width + x];
        let border = renderer.border(item, &[item]).unwrap();
        let pixels = |runs: &[Run]| -> Vec<(usize, usize)> {
            runs.iter().flat_map(|run| (0..run.length).map(|i| (run.x + i, run.y))).collect()
        };
        let (inner, outer) = (pixels(&border.inner), pixels(&border.outer));
        assert!(!inner.is_empty());
        // The item does not touch the edge of the picture.
        for (x, y) in (1..159).flat_map(|x| (1..119).map(move |y| (x, y))) {
            let others = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
            let beside = |own: bool| others.iter().any(|(x, y)| is_own(*x, *y) == own);
            assert_eq!(inner.contains(&(x, y)), is_own(x, y) && beside(false), "{x} {y}");
            assert_eq!(outer.contains(&(x, y)), !is_own(x, y) && beside(true), "{x} {y}");
        }
    }

    #[test]
    fn a_snapshot_with_the_same_picture_is_not_drawn_again() {
        let mut renderer = ViewportRenderer::new(Instant::now, Arc::default());
        let mut wanted = snapshot(Size::new(16, 12));
        assert!(renderer.draw(&wanted, &this).is_some());
        wanted.shot.view.subject = marraztu_core::scene::Subject::Light;
        assert!(renderer.draw(&wanted, &this).is_none());
        wanted.options.moving = true;
        assert!(renderer.draw(&wanted, &this).is_none());
        wanted.shot.view.back_faces = true;
        assert!(renderer.draw(&wanted, &this).is_some());
    }

    #[test]
    fn while_a_slow_scene_moves_it_is_drawn_with_less_and_when_it_is_still_with_all() {
        let mut renderer = ViewportRenderer::new(slow, Arc::default());
        let still = snapshot(Size::new(161, 120));
        let first = renderer.draw(&still, &this).unwrap();
        assert_eq!((first.reduction, first.image.size), (Reduction::NONE, [161, 120]));
        for i in 0..11 {
            let moving = moving(recolored(&still, i));
            let drawn = renderer.draw(&moving, &this).unwrap();
            // Every frame takes 40 ms: each reduction is tried twice, and none keeps the budget.
            let half = "light per vertex, half size";
            let words =
                ["light per vertex", "half size", half, "light per vertex, quarter size", ""];
            let step = usize::from(i / 2).min(4);
            assert_eq!(drawn.reduction.words(), words[step], "frame {i}");
            let sizes = [[161, 120], [81, 60], [41, 30]];
            assert_eq!(drawn.image.size, sizes[drawn.reduction.shrink as usize]);
            assert_eq!(drawn.time, Duration::from_millis(40));
        }
        let last = renderer.draw(&still, &this).unwrap();
        assert_eq!(last.reduction, Reduction::NONE);
        assert!(last.image.pixels == first.image.pixels);
    }

    #[test]
    fn a_picture_of_half_the_size_is_asked_at_the_pixels_of_the_whole() {
        let mut renderer = ViewportRenderer::new(slow, Arc::default());
        let still = snapshot(Size::new(160, 120));
        renderer.draw(&still, &this).unwrap();
        let item = ItemId::Object(still.shot.view.object.unwrap());
        let places = |renderer: &mut ViewportRenderer| {
            let all = (0..120).flat_map(|y| (0..160).map(move |x| [x, y]));
            let own = all.filter(|at| renderer.hit(*at).is_some_and(|hit| hit.item == item));
            own.fold([0, 0, 0], |[n, x, y], at| [n + 1, x + at[0], y + at[1]])
        };
        let [count, x, y] = places(&mut renderer);
        let mut moving = moving(still.clone());
        let mut drawn = None;
        for gray in 0..3 {
            moving = recolored(&moving, gray);
            drawn = renderer.draw(&moving, &this);
        }
        assert_eq!(drawn.unwrap().reduction.shrink, Shrink::Half);
        let [half_count, half_x, half_y] = places(&mut renderer);
        // Half size covers the same area in the same place, except along the border.
        let near = |a: usize, b: usize, by: usize| a.abs_diff(b) <= by;
        assert!(near(count, half_count, count / 5), "{count} {half_count}");
        assert!(near(x / count, half_x / half_count, 2) && near(y / count, half_y / half_count, 2));
        assert_eq!(renderer.border(item, &[item]).unwrap().size, Size::new(80, 60));
    }

    #[test]
    fn a_newer_frame_cancels_a_slow_one_but_every_second_one_is_finished() {
        let mut renderer = ViewportRenderer::new(slow, Arc::default());
        let wanted = snapshot(Size::new(160, 120));
        let first = renderer.draw(&wanted, &newer);
        // The first frame's time was unknown, so it may have been finished or cancelled.
        if first.is_none() {
            renderer.draw(&wanted, &newer).unwrap();
        }
        let seen = renderer.hit([80, 60]);
        for gray in 0..6 {
            let finished = renderer.draw(&recolored(&wanted, gray), &newer).is_some();
            assert_eq!(finished, gray % 2 == 1, "frame {gray}");
            assert_eq!(renderer.hit([80, 60]), seen, "the picture that is seen is asked");
        }
        assert!(renderer.draw(&recolored(&wanted, 99), &|| Asked::Nothing).is_none());
    }

    #[test]
    fn only_changed_parts_are_drawn_again() {
        let mut renderer = ViewportRenderer::new(Instant::now, Arc::default());
        let mut wanted = snapshot(Size::new(640, 480));
        renderer.draw(&wanted, &this).unwrap();
        let (id, _) = wanted.shot.scene.objects.iter().next().unwrap();
        let command = items::toggle_shown(&wanted.shot.scene, ItemId::Object(id));
        command.unwrap().apply(&mut wanted.shot.scene).unwrap();
        let drawn = renderer.draw(&wanted, &this).unwrap();
        assert!((1..40).contains(&drawn.changes.tiles()), "{:?}", drawn.changes);
        let mut fresh = ViewportRenderer::new(Instant::now, Arc::default());
        let all = fresh.draw(&wanted, &this).unwrap();
        assert_eq!(all.changes.tiles(), 80);
        assert!(all.image.pixels == drawn.image.pixels);
    }
}
