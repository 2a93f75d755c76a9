//! Draws the pictures that the viewport shows, and knows what is on them.
//!
//! A picture is drawn with as much as the hand leaves time for (see [`pace`](super::pace)), and only
//! what has changed of the one before is drawn again.

use std::sync::Arc;
use std::time::{Duration, Instant};

use egui::ColorImage;

use super::pace::{Attempt, Economy, Pace, Wealth};
use crate::base::image::{Picture, Size};
use crate::lab::cost::{self, Explained};
use crate::render::{Changes, FramePlan, GivenUp, Hit, Renderer};
use crate::scene::{ItemId, Scene, Settings, Surface, View};

/// Everything that a picture depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Snapshot {
    pub(super) scene: Scene,
    pub(super) view: View,
    pub(super) settings: Settings,
    pub(super) size: Size,
    /// Whether it is on the move, so that a coarser picture in time is better than none.
    pub(super) moving: bool,
    /// Whether it shall be said what the picture is made of.
    pub(super) explain: bool,
}

impl Snapshot {
    /// Whether another one shows something else than the passing of time.
    pub(super) fn differs_from(&self, other: &Self) -> bool {
        let Self { scene, view, settings, size, moving: _, explain: _ } = self;
        let view = |of: &View| View { time: view.time, ..of.clone() };
        (*settings, *size) != (other.settings, other.size)
            || *scene != other.scene
            || self.view != view(&other.view)
    }
}

/// A drawn picture.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    pub(super) image: Arc<ColorImage>,
    /// From the snapshot to the finished picture in memory.
    pub(super) time: Duration,
    pub(super) triangles: usize,
    /// What it does without.
    pub(super) economy: Economy,
    /// What of it was drawn anew, and why.
    pub(super) changes: Changes,
}

/// Where an item's visible part ends in a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Border {
    pub(super) item: ItemId,
    /// Its own pixels along the border, in runs from left to right.
    pub(super) inner: Vec<Run>,
    /// The pixels beside them that are not its own.
    pub(super) outer: Vec<Run>,
    /// How large the picture is.
    pub(super) size: Size,
}

/// Pixels beside one another in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) length: usize,
}

/// What is asked for while a frame is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asked {
    /// Still this frame.
    This,
    /// Another one.
    Newer,
    /// None any more.
    Nothing,
}

/// The renderer, and the memory that its pictures are shown from.
#[derive(Debug)]
pub(super) struct Painter {
    renderer: Renderer,
    /// The time: tests have one that they turn by hand.
    clock: fn() -> Instant,
    pace: Pace,
    /// What the last finished picture does without; `None` before the first.
    shown: Option<Economy>,
    /// Whether the last frame was given up.
    gave_up: bool,
    /// What was said last of what the picture is made of.
    explained: Option<Arc<Explained>>,
    /// One is shown while the other is drawn.
    images: [Arc<ColorImage>; 2],
}

impl Painter {
    pub(super) fn new(clock: fn() -> Instant) -> Self {
        Self {
            renderer: Renderer::default(),
            clock,
            pace: Pace::default(),
            shown: None,
            gave_up: false,
            explained: None,
            images: <[Arc<ColorImage>; 2]>::default(),
        }
    }

    /// Draws the picture; `None` where it is the one that was drawn last, or was given up for what
    /// is asked for by then.
    pub(super) fn draw(
        &mut self,
        wanted: &Snapshot,
        asked: &(dyn Fn() -> Asked + Sync),
    ) -> Option<Drawn> {
        let begun = (self.clock)();
        let mut plan = planned(wanted, Economy::NONE);
        let mut changes = self.renderer.changes(&plan);
        let share = share(&changes);
        let economy = self.pace.choose(wanted.moving, share, wealth(wanted));
        if economy != Economy::NONE && !changes.is_nothing() {
            plan = planned(wanted, economy);
            changes = self.renderer.changes(&plan);
        }
        if changes.is_nothing() {
            return None;
        }
        let expected = self.pace.expected(economy, share);
        let attempt = Attempt { economy, expected, second: self.gave_up };
        let clock = self.clock;
        let wanted = || match asked() {
            Asked::This => true,
            Asked::Newer => !attempt.gives_way(clock().duration_since(begun)),
            Asked::Nothing => false,
        };
        let drawn = self.renderer.redraw(&plan, &wanted);
        self.gave_up = drawn == Err(GivenUp);
        if self.gave_up {
            self.pace.record_given_up(share, clock().duration_since(begun));
            return None;
        }
        let image = Arc::make_mut(&mut self.images[0]);
        show(self.renderer.picture(), image);
        self.images.swap(0, 1);
        self.shown = Some(economy);
        let time = clock().duration_since(begun);
        self.pace.record(economy, share, time);
        Some(Drawn {
            image: Arc::clone(&self.images[1]),
            time,
            triangles: self.renderer.triangles_drawn(),
            economy,
            changes,
        })
    }

    /// What the picture that was finished last is made of; `None` where that is not wanted, or was
    /// said.
    pub(super) fn explain(&mut self, wanted: &Snapshot) -> Option<Arc<Explained>> {
        if !wanted.explain {
            self.explained = None;
            return None;
        }
        if self.gave_up {
            return None;
        }
        let (settings, size) = self.shown?.applied(wanted.settings, wanted.size);
        let of = (&wanted.scene, &wanted.view, &settings, size);
        let explained = cost::explain_with(&mut self.renderer, of);
        if self.explained.as_deref() == Some(&explained) {
            return None;
        }
        self.explained = Some(Arc::new(explained));
        self.explained.clone()
    }

    /// What is seen at a pixel of a picture with all.
    pub(super) fn hit(&mut self, [x, y]: [usize; 2]) -> Option<Hit> {
        let [x, y] = if self.shown?.half_size { [x / 2, y / 2] } else { [x, y] };
        self.renderer.hit(x, y)
    }
}

fn planned(wanted: &Snapshot, economy: Economy) -> FramePlan {
    let (settings, size) = economy.applied(wanted.settings, wanted.size);
    FramePlan::new(&wanted.scene, &wanted.view, &settings, size)
}

/// Which part of the picture is drawn again, from 0 to 1.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 tiles")]
fn share(changes: &Changes) -> f64 {
    changes.tiles() as f64 / changes.tiles_in_all() as f64
}

fn wealth(wanted: &Snapshot) -> Wealth {
    let textured = wanted.scene.objects.iter().any(|(_, object)| {
        let own = object.model.materials.iter().any(|material| material.texture.is_some());
        object.visible && object.surface != Surface::Material && (own || object.texture.is_some())
    });
    Wealth { settings: wanted.settings, textured }
}

impl Painter {
    /// Where the visible part of an item ends.
    pub(super) fn border(&mut self, item: ItemId) -> Option<Border> {
        self.shown?;
        let size = self.images[1].size;
        let size = Size::new(size[0], size[1]);
        let own = self.renderer.pixels_of(item);
        let is_own =
            |x: usize, y: usize| x < size.width && y < size.height && own[y * size.width + x];
        // Beyond the left and upper sides x - 1 and y - 1 wrap to what is beyond the others.
        let beside = |x: usize, y: usize, own: bool| {
            is_own(x.wrapping_sub(1), y) == own
                || is_own(x + 1, y) == own
                || is_own(x, y.wrapping_sub(1)) == own
                || is_own(x, y + 1) == own
        };
        let inner = runs(size, |x, y| is_own(x, y) && beside(x, y, false));
        let outer = runs(size, |x, y| !is_own(x, y) && beside(x, y, true));
        Some(Border { item, inner, outer, size })
    }
}

/// The pixels that are `chosen`, in runs.
fn runs(size: Size, chosen: impl Fn(usize, usize) -> bool) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for y in 0..size.height {
        for x in (0..size.width).filter(|x| chosen(*x, y)) {
            match runs.last_mut() {
                Some(run) if run.y == y && run.x + run.length == x => run.length += 1,
                _ => runs.push(Run { x, y, length: 1 }),
            }
        }
    }
    runs
}

/// Copies opaque pixels; those are the same with and without multiplication by alpha.
fn show(picture: &Picture, image: &mut ColorImage) {
    let Size { width, height } = picture.size();
    if image.size != [width, height] {
        *image = ColorImage::filled([width, height], egui::Color32::BLACK);
    }
    let bytes: &mut [[u8; 4]] = bytemuck::cast_slice_mut(&mut image.pixels);
    bytes.copy_from_slice(picture.pixels());
}

/// The picture that an image of the viewport shows.
pub(super) fn picture(image: &ColorImage) -> Option<Picture> {
    let [width, height] = image.size;
    let pixels: &[[u8; 4]] = bytemuck::cast_slice(&image.pixels);
    Picture::from_pixels(Size::new(width, height), pixels.to_vec())
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::OnceLock;

    use super::*;
    use crate::base::color::Color;
    use crate::io;
    use crate::scene::Command;

    fn snapshot(size: Size) -> Snapshot {
        let (scene, view) = io::default_scene();
        Snapshot { scene, view, settings: Settings::default(), size, moving: false, explain: false }
    }

    /// The same in another colour, for which everything has to be drawn.
    fn recolored(snapshot: &Snapshot, gray: u8) -> Snapshot {
        let mut other = snapshot.clone();
        Command::Background(Color([gray; 3])).apply(&mut other.scene).unwrap();
        other
    }

    thread_local! {
        static NOW: Cell<Duration> = const { Cell::new(Duration::ZERO) };
    }

    /// A clock that goes on by 40 ms whenever it is looked at: that is what every frame takes.
    fn slow() -> Instant {
        static BEGINNING: OnceLock<Instant> = OnceLock::new();
        let now = NOW.get() + Duration::from_millis(40);
        NOW.set(now);
        *crate::base::once::get_or_compute(&BEGINNING, Instant::now) + now
    }

    fn this() -> Asked {
        Asked::This
    }

    fn newer() -> Asked {
        Asked::Newer
    }

    #[test]
    fn a_border_runs_round_all_pixels_of_an_item_and_no_others() {
        let wanted = snapshot(Size::new(160, 120));
        let (size, item) = (wanted.size, ItemId::Object(wanted.view.object.unwrap()));
        let mut painter = Painter::new(Instant::now);
        painter.draw(&wanted, &this).unwrap();
        let places = || (0..size.height).flat_map(|y| (0..size.width).map(move |x| (x, y)));
        let own: Vec<bool> = places()
            .map(|(x, y)| painter.hit([x, y]).is_some_and(|hit| hit.item == item))
            .collect();
        assert_eq!(own, painter.renderer.pixels_of(item));
        let is_own = |x: usize, y: usize| own[y * size.width + x];
        let border = painter.border(item).unwrap();
        let pixels = |runs: &[Run]| -> Vec<(usize, usize)> {
            runs.iter().flat_map(|run| (0..run.length).map(|i| (run.x + i, run.y))).collect()
        };
        let (inner, outer) = (pixels(&border.inner), pixels(&border.outer));
        assert!(!inner.is_empty());
        assert!(outer.iter().all(|(x, y)| !is_own(*x, *y)));
        // Nothing of the item lies at the picture's edge.
        for (x, y) in (1..159).flat_map(|x| (1..119).map(move |y| (x, y))) {
            let others = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
            let beside = others.iter().any(|(x, y)| !is_own(*x, *y));
            assert_eq!(inner.contains(&(x, y)), is_own(x, y) && beside, "{x} {y}");
        }
    }

    #[test]
    fn a_snapshot_whose_picture_is_the_same_is_not_drawn_again() {
        let mut painter = Painter::new(Instant::now);
        let mut wanted = snapshot(Size::new(16, 12));
        assert!(painter.draw(&wanted, &this).is_some());
        wanted.view.subject = crate::scene::Subject::Light;
        assert!(painter.draw(&wanted, &this).is_none());
        wanted.moving = true;
        assert!(painter.draw(&wanted, &this).is_none());
        wanted.view.back_faces = true;
        assert!(painter.draw(&wanted, &this).is_some());
    }

    #[test]
    fn while_a_slow_scene_moves_it_is_drawn_with_less_and_when_it_is_still_with_all() {
        let mut painter = Painter::new(slow);
        let still = snapshot(Size::new(161, 120));
        let first = painter.draw(&still, &this).unwrap();
        assert_eq!((first.economy, first.image.size), (Economy::NONE, [161, 120]));
        for i in 0..9 {
            let moving = Snapshot { moving: true, ..recolored(&still, i) };
            let drawn = painter.draw(&moving, &this).unwrap();
            // Every frame takes 40 ms: each economy is tried twice, and no one helps.
            let words = ["light per vertex", "half size", "light per vertex, half size", ""];
            let step = usize::from(i / 2).min(3);
            assert_eq!(drawn.economy.words(), words[step], "frame {i}");
            let half = drawn.economy.half_size;
            assert_eq!(drawn.image.size, if half { [81, 60] } else { [161, 120] });
            assert_eq!(drawn.time, Duration::from_millis(40));
        }
        let last = painter.draw(&still, &this).unwrap();
        assert_eq!(last.economy, Economy::NONE);
        assert!(last.image.pixels == first.image.pixels);
    }

    #[test]
    fn a_picture_of_half_the_size_is_asked_at_the_pixels_of_the_whole() {
        let mut painter = Painter::new(slow);
        let still = snapshot(Size::new(160, 120));
        painter.draw(&still, &this).unwrap();
        let item = ItemId::Object(still.view.object.unwrap());
        let places = |painter: &mut Painter| {
            let all = (0..120).flat_map(|y| (0..160).map(move |x| [x, y]));
            let own = all.filter(|at| painter.hit(*at).is_some_and(|hit| hit.item == item));
            own.fold([0, 0, 0], |[n, x, y], at| [n + 1, x + at[0], y + at[1]])
        };
        let [count, x, y] = places(&mut painter);
        let mut moving = Snapshot { moving: true, ..still.clone() };
        let mut drawn = None;
        for gray in 0..3 {
            moving = recolored(&moving, gray);
            drawn = painter.draw(&moving, &this);
        }
        assert!(drawn.unwrap().economy.half_size);
        let [half_count, half_x, half_y] = places(&mut painter);
        // As many pixels in the same place, but for the border.
        let near = |a: usize, b: usize, by: usize| a.abs_diff(b) <= by;
        assert!(near(count, half_count, count / 5), "{count} {half_count}");
        assert!(near(x / count, half_x / half_count, 2) && near(y / count, half_y / half_count, 2));
        assert_eq!(painter.border(item).unwrap().size, Size::new(80, 60));
    }

    #[test]
    fn a_slow_frame_gives_way_to_a_newer_one_and_in_a_stream_every_second_is_finished() {
        let mut painter = Painter::new(slow);
        let wanted = snapshot(Size::new(160, 120));
        let first = painter.draw(&wanted, &newer);
        // How long it takes was not known: it may have been finished or not.
        if first.is_none() {
            painter.draw(&wanted, &newer).unwrap();
        }
        let seen = painter.hit([80, 60]);
        for gray in 0..6 {
            let finished = painter.draw(&recolored(&wanted, gray), &newer).is_some();
            assert_eq!(finished, gray % 2 == 1, "frame {gray}");
            assert_eq!(painter.hit([80, 60]), seen, "the picture that is seen is asked");
        }
        assert!(painter.draw(&recolored(&wanted, 99), &|| Asked::Nothing).is_none());
    }

    #[test]
    fn only_what_changed_is_drawn_again() {
        let mut painter = Painter::new(Instant::now);
        let mut wanted = snapshot(Size::new(640, 480));
        painter.draw(&wanted, &this).unwrap();
        let (id, _) = wanted.scene.objects.iter().next().unwrap();
        let command = crate::edit::items::toggle_shown(&wanted.scene, ItemId::Object(id)).unwrap();
        command.apply(&mut wanted.scene).unwrap();
        let drawn = painter.draw(&wanted, &this).unwrap();
        assert!((1..40).contains(&drawn.changes.tiles()), "{:?}", drawn.changes);
        let mut fresh = Painter::new(Instant::now);
        let all = fresh.draw(&wanted, &this).unwrap();
        assert_eq!(all.changes.tiles(), 80);
        assert!(all.image.pixels == drawn.image.pixels);
    }
}
