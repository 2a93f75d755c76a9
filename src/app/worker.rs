//! Draws on a thread of its own, so that the window answers however long a picture takes.
//!
//! The newest wish is drawn and older ones are forgotten. What is seen at a pixel is asked of the
//! picture that was drawn last, before the next one is begun: that is the one the user clicked on.

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use egui::ColorImage;

use crate::base::image::{Picture, Size};
use crate::lab::cost::{self, Explained};
use crate::render::{FramePlan, Hit, Renderer};
use crate::scene::{ItemId, Scene, Settings, View};

/// Everything that a picture depends on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Snapshot {
    pub(super) scene: Scene,
    pub(super) view: View,
    pub(super) settings: Settings,
    pub(super) size: Size,
    /// Whether it shall be said what the picture is made of.
    pub(super) explain: bool,
}

/// A drawn picture.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    pub(super) image: Arc<ColorImage>,
    pub(super) time: Duration,
    pub(super) triangles: usize,
}

/// A question what is seen at a pixel, and what it is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pick<P> {
    pub(super) at: [usize; 2],
    pub(super) purpose: P,
}

/// Where an item's visible part ends in a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Border {
    pub(super) item: ItemId,
    /// Its own pixels along the border, in runs from left to right.
    pub(super) inner: Vec<Run>,
    /// The pixels beside them that are not its own.
    pub(super) outer: Vec<Run>,
}

/// Pixels beside one another in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub(super) x: usize,
    pub(super) y: usize,
    pub(super) length: usize,
}

/// What the worker has to tell.
#[derive(Debug)]
pub(super) struct News<P> {
    pub(super) border: Option<Border>,
    pub(super) drawn: Option<Drawn>,
    pub(super) explained: Option<Arc<Explained>>,
    pub(super) picked: Vec<(Pick<P>, Option<Hit>)>,
    pub(super) failed: bool,
}

/// The thread that draws.
#[derive(Debug)]
pub(super) struct Worker<P> {
    shared: Arc<Shared<P>>,
    last: Option<Snapshot>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared<P> {
    desk: Mutex<Desk<P>>,
    changed: Condvar,
}

#[derive(Debug)]
struct Desk<P> {
    wanted: Option<Snapshot>,
    picks: VecDeque<Pick<P>>,
    /// The item whose border is wanted.
    border: Option<ItemId>,
    news: News<P>,
    busy: bool,
    closed: bool,
}

impl<P: Copy + Send + 'static> Worker<P> {
    /// Starts the thread; `wake` is called whenever there is news.
    pub(super) fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let news = News::none();
        let (wanted, picks, border) = (None, VecDeque::new(), None);
        let desk = Desk { wanted, picks, border, news, busy: false, closed: false };
        let shared = Arc::new(Shared { desk: Mutex::new(desk), changed: Condvar::new() });
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("painter".to_owned())
            .spawn(move || work(&theirs, &wake))?;
        Ok(Self { shared, last: None, thread: Some(thread) })
    }

    /// Wants this picture, unless it is the one that was wanted last.
    pub(super) fn draw(&mut self, snapshot: Snapshot) {
        if self.last.as_ref() == Some(&snapshot) {
            return;
        }
        self.last = Some(snapshot.clone());
        self.shared.lock().wanted = Some(snapshot);
        self.shared.changed.notify_all();
    }

    /// Asks what is seen at a pixel of the picture that was drawn last.
    pub(super) fn pick(&self, pick: Pick<P>) {
        self.shared.lock().picks.push_back(pick);
        self.shared.changed.notify_all();
    }

    /// Asks where the visible part of an item ends in the picture that was drawn last.
    pub(super) fn border(&self, item: ItemId) {
        self.shared.lock().border = Some(item);
        self.shared.changed.notify_all();
    }

    /// What there is to tell since it was last asked.
    pub(super) fn news(&self) -> News<P> {
        let mut desk = self.shared.lock();
        std::mem::replace(&mut desk.news, News::none())
    }

    /// Waits until everything that was asked is done.
    pub(super) fn wait(&self) {
        let mut desk = self.shared.lock();
        while desk.busy || desk.has_work() {
            desk = self.shared.changed.wait(desk).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl<P> Drop for Worker<P> {
    fn drop(&mut self) {
        self.shared.lock().closed = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // It has told its failure already, if it had any.
            let _ = thread.join();
        }
    }
}

impl<P> News<P> {
    const fn none() -> Self {
        Self { border: None, drawn: None, explained: None, picked: Vec::new(), failed: false }
    }
}

impl<P> Desk<P> {
    fn has_work(&self) -> bool {
        self.wanted.is_some() || !self.picks.is_empty() || self.border.is_some()
    }
}

impl<P> Shared<P> {
    fn lock(&self) -> MutexGuard<'_, Desk<P>> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Draws and answers until the desk is closed.
fn work<P: Copy>(shared: &Shared<P>, wake: &impl Fn()) {
    let mut painter = Painter::default();
    loop {
        let (picks, border, wanted) = {
            let mut desk = shared.lock();
            desk.busy = false;
            shared.changed.notify_all();
            while !desk.has_work() && !desk.closed {
                desk = shared.changed.wait(desk).unwrap_or_else(PoisonError::into_inner);
            }
            if desk.closed {
                return;
            }
            desk.busy = true;
            (std::mem::take(&mut desk.picks), desk.border.take(), desk.wanted.take())
        };
        let picked: Vec<_> = picks.into_iter().map(|pick| (pick, painter.hit(pick.at))).collect();
        let border = border.and_then(|item| painter.border(item));
        if !picked.is_empty() || border.is_some() {
            let mut desk = shared.lock();
            desk.news.picked.extend(picked);
            desk.news.border = border.or(desk.news.border.take());
            drop(desk);
            wake();
        }
        let Some(wanted) = wanted else { continue };
        // A fault of the renderer costs a picture, not the user's work.
        match catch_unwind(AssertUnwindSafe(|| painter.draw(&wanted))) {
            Ok(None) => {}
            Ok(Some(drawn)) => {
                shared.lock().news.drawn = Some(drawn);
                wake();
            }
            Err(_) => {
                painter = Painter::default();
                shared.lock().news.failed = true;
                wake();
                continue;
            }
        }
        // After the picture, which nobody should wait for because of it.
        if let Ok(Some(explained)) = catch_unwind(AssertUnwindSafe(|| painter.explain(&wanted))) {
            shared.lock().news.explained = Some(explained);
            wake();
        }
    }
}

/// The renderer, and the memory that its pictures are shown from.
#[derive(Debug, Default)]
struct Painter {
    renderer: Renderer,
    plan: Option<FramePlan>,
    /// What was said last of what the picture is made of.
    explained: Option<Arc<Explained>>,
    /// One is shown while the other is drawn.
    images: [Arc<ColorImage>; 2],
}

impl Painter {
    /// Draws the picture; `None` where it is the one that was drawn last.
    fn draw(&mut self, wanted: &Snapshot) -> Option<Drawn> {
        let begun = Instant::now();
        let plan = FramePlan::new(&wanted.scene, &wanted.view, &wanted.settings, wanted.size);
        if self.plan.as_ref().is_some_and(|before| plan.left_out_after(before).is_some()) {
            return None;
        }
        let picture = self.renderer.render(&plan);
        let image = Arc::make_mut(&mut self.images[0]);
        show(picture, image);
        self.images.swap(0, 1);
        self.plan = Some(plan);
        Some(Drawn {
            image: Arc::clone(&self.images[1]),
            time: begun.elapsed(),
            triangles: self.renderer.triangles_drawn(),
        })
    }

    /// What the picture that was drawn last is made of; `None` where that is not wanted, or was said.
    fn explain(&mut self, wanted: &Snapshot) -> Option<Arc<Explained>> {
        if !wanted.explain {
            self.explained = None;
            return None;
        }
        let Snapshot { scene, view, settings, size, .. } = wanted;
        let explained = cost::explain_with(&self.renderer, (scene, view, settings, *size));
        if self.explained.as_deref() == Some(&explained) {
            return None;
        }
        self.explained = Some(Arc::new(explained));
        self.explained.clone()
    }

    fn hit(&self, [x, y]: [usize; 2]) -> Option<Hit> {
        self.plan.as_ref().and_then(|_| self.renderer.hit(x, y))
    }
}

impl Painter {
    /// Where the visible part of an item ends.
    fn border(&self, item: ItemId) -> Option<Border> {
        let size = self.plan.as_ref()?.size();
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
        Some(Border { item, inner, outer })
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
    use super::*;
    use crate::io;

    #[test]
    fn a_border_runs_round_all_pixels_of_an_item_and_no_others() {
        let (scene, view) = io::default_scene();
        let item = ItemId::Object(view.object.unwrap());
        let (settings, size) = (Settings::default(), Size::new(160, 120));
        let mut painter = Painter::default();
        painter.draw(&Snapshot { scene, view, settings, size, explain: false }).unwrap();
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
        let (scene, mut view) = io::default_scene();
        let (settings, size) = (Settings::default(), Size::new(16, 12));
        let mut painter = Painter::default();
        let snapshot = |view: &View| Snapshot {
            scene: scene.clone(),
            view: view.clone(),
            settings,
            size,
            explain: false,
        };
        assert!(painter.draw(&snapshot(&view)).is_some());
        view.subject = crate::scene::Subject::Light;
        assert!(painter.draw(&snapshot(&view)).is_none());
        view.back_faces = true;
        assert!(painter.draw(&snapshot(&view)).is_some());
    }
}
