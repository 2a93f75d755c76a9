//! The drawing thread, which keeps the window responsive however long a picture takes.
//!
//! Only the newest snapshot is drawn; a slow frame may be cancelled for it (see
//! [`adaptive_quality`](super::adaptive_quality)). Picks are answered from the last finished
//! picture before the next one is started, because that is the picture the user clicked on.
//!
//! While there are no requests, the last picture is refined step by step. Every request and every
//! event of the window interrupts the refinement. After the last step, the thread sleeps.
//!
//! WebAssembly has no threads. There, another instance of the program draws ([`server`]) and
//! exchanges messages with the window ([`elsewhere`]), or the window's thread draws between frames.

mod elsewhere;
pub(crate) mod message;
pub(crate) mod server;

use std::cell::RefCell;
use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use self::elsewhere::Elsewhere;
use super::border::Border;
use super::dial::DialFigures;
use super::painted::Painted;
use super::snapshot::Snapshot;
use super::viewport_renderer::{Asked, Drawn, Finer, ViewportRenderer};
use marraztu_core::base::image::Picture;
use marraztu_core::scene::ItemId;
use marraztu_lab::cost::Explained;
use marraztu_render::Hit;
use marraztu_render::screen::coverage::PixelBox;

/// The time without events after which the picture is refined.
const QUIET: Duration = Duration::from_millis(120);

/// A pick: the pixel to look up, and the purpose of the pick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pick<P> {
    pub(crate) at: [usize; 2],
    pub(crate) purpose: P,
}

/// Results of the worker.
#[derive(Debug)]
pub(crate) struct News<P> {
    /// The border of the item under the pointer. With a picture, it is the border there.
    pub(crate) border: Option<Border>,
    pub(crate) drawn: Option<Drawn>,
    /// The same picture with more samples per pixel; it arrives after `drawn`.
    pub(crate) refined: Option<Drawn>,
    /// The borders requested with the picture, if it was redrawn: of the first item, and of the
    /// others.
    pub(crate) outline: Option<[Option<Border>; 2]>,
    pub(crate) explained: Option<Arc<Explained>>,
    /// The figures of the dial for the last picture.
    pub(crate) dial: Option<Box<DialFigures>>,
    /// A window of the ideal of the last picture, as requested.
    pub(crate) ideal: Option<(PixelBox, Picture)>,
    pub(crate) picked: Vec<(Pick<P>, Option<Hit>)>,
    pub(crate) failed: bool,
}

/// The handle of the drawing thread, or of its substitute.
#[derive(Debug)]
pub(crate) struct Worker<P> {
    shared: Arc<Shared<P>>,
    last: Option<Snapshot>,
    place: Place<P>,
}

/// Where pictures are drawn.
#[derive(Debug)]
enum Place<P> {
    /// By a thread; `None` after its end.
    Thread(Option<JoinHandle<()>>),
    /// By the thread of the window, when it takes results.
    Here(Box<RefCell<Here>>),
    /// By another instance of the program.
    Elsewhere(Box<Elsewhere<P>>),
}

/// The worker on the thread of the window.
struct Here {
    painter: Painter,
    wake: Box<dyn Fn()>,
}

impl std::fmt::Debug for Here {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Here")
    }
}

#[derive(Debug)]
struct Shared<P> {
    desk: Mutex<Desk<P>>,
    changed: Condvar,
    /// Whether a newer picture is wanted; read between tiles.
    newer: AtomicBool,
    /// Whether a request or an event arrived since refinement began; read between tiles.
    disturbed: AtomicBool,
    /// Whether the thread has to stop.
    over: AtomicBool,
    /// The progress of the picture that is being drawn.
    painted: Arc<Painted>,
    /// Whether a request waits outside of this instance; asked between tiles of a refinement.
    is_awaited: fn() -> bool,
}

#[derive(Debug)]
struct Desk<P> {
    wanted: Option<Snapshot>,
    picks: VecDeque<Pick<P>>,
    /// The item under the pointer to outline from now on, if that is to change.
    border: Option<Option<ItemId>>,
    /// The window of the ideal to draw, on request.
    ideal: Option<PixelBox>,
    news: News<P>,
    busy: bool,
    /// When drawing of the current picture began.
    begun: Option<Instant>,
    closed: bool,
    /// Whether nothing is left to refine.
    settled: bool,
    /// The earliest time at which refinement may begin.
    quiet_at: Instant,
}

impl<P: Copy + Send + 'static> Worker<P> {
    /// Starts the thread; `wake` is called whenever there are results. In WebAssembly, which has no
    /// threads, the window's thread draws when it takes the results.
    pub(crate) fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        if cfg!(target_family = "wasm") {
            return Ok(Self::here(wake, || false));
        }
        let shared = Shared::new(|| false);
        let theirs = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("painter".to_owned())
            .spawn(move || work(&theirs, &wake))?;
        Ok(Self { shared, last: None, place: Place::Thread(Some(thread)) })
    }

    /// Draws on this thread, when results are taken.
    fn here(wake: impl Fn() + 'static, is_awaited: fn() -> bool) -> Self {
        let shared = Shared::new(is_awaited);
        let painter = Painter::new(Arc::clone(&shared.painted));
        let here = Here { painter, wake: Box::new(wake) };
        Self { shared, last: None, place: Place::Here(Box::new(RefCell::new(here))) }
    }

    /// Lets another instance of the program draw, which the shell exchanges messages with.
    pub(crate) fn elsewhere(wake: impl Fn() + 'static) -> Self {
        let elsewhere = Elsewhere::new(Box::new(wake));
        Self {
            shared: Shared::new(|| false),
            last: None,
            place: Place::Elsewhere(Box::new(elsewhere)),
        }
    }

    /// Returns the message to the other instance that draws, if there is one and it is due.
    pub(crate) fn request(&mut self) -> Option<Vec<u8>> {
        let Self { shared, place: Place::Elsewhere(elsewhere), .. } = self else { return None };
        elsewhere.request(shared)
    }

    /// Takes a message of the other instance. `None` means that it has failed and was replaced.
    pub(crate) fn hear(&mut self, reply: Option<&[u8]>) {
        if let Self { shared, place: Place::Elsewhere(elsewhere), .. } = self {
            elsewhere.hear(shared, reply);
        }
    }

    /// Requests this picture, unless it equals the last request.
    pub(crate) fn draw(&mut self, snapshot: Snapshot) {
        if self.last.as_ref() == Some(&snapshot) {
            return;
        }
        self.last = Some(snapshot.clone());
        let mut desk = self.shared.lock();
        desk.wanted = Some(snapshot);
        // These belong to the picture before.
        (desk.news.dial, desk.news.ideal, desk.ideal) = (None, None, None);
        self.shared.disturb(&mut desk);
        self.shared.newer.store(true, Ordering::Relaxed);
        drop(desk);
        self.shared.changed.notify_all();
    }

    /// Returns whether the worker is busy or has requests.
    pub(crate) fn is_drawing(&self) -> bool {
        self.shared.lock().is_answering()
    }

    /// Returns how long the requested picture has been in progress, if it is not finished.
    pub(crate) fn drawing_for(&self) -> Option<Duration> {
        self.shared.lock().begun.map(|begun| begun.elapsed())
    }

    /// Returns the finished fraction of the requested picture, if it is known.
    pub(crate) fn painted(&self) -> Option<f64> {
        self.shared.painted.fraction()
    }

    pub(crate) const fn last(&self) -> Option<&Snapshot> {
        self.last.as_ref()
    }

    /// Requests the item at a pixel of the last picture.
    pub(crate) fn pick(&self, pick: Pick<P>) {
        self.ask(|desk| desk.picks.push_back(pick));
    }

    /// Requests the border of the item under the pointer, in the last picture and in those after.
    pub(crate) fn border(&self, item: Option<ItemId>) {
        self.ask(|desk| desk.border = Some(item));
    }

    /// Requests a window of the ideal of the last picture.
    pub(crate) fn ideal(&self, window: PixelBox) {
        self.ask(|desk| desk.ideal = Some(window));
    }

    fn ask(&self, request: impl FnOnce(&mut Desk<P>)) {
        request(&mut self.shared.lock());
        self.shared.disturbed.store(true, Ordering::Relaxed);
        self.shared.changed.notify_all();
    }

    /// Interrupts refinement, because something happens in the window.
    pub(crate) fn stir(&self) {
        self.shared.disturb(&mut self.shared.lock());
    }

    /// Takes the results since the last call.
    pub(crate) fn news(&self) -> News<P> {
        if let Place::Here(here) = &self.place {
            here.borrow_mut().work(&self.shared);
        }
        std::mem::take(&mut self.shared.lock().news)
    }

    /// Waits until all requests are answered.
    pub(crate) fn wait(&self) {
        self.wait_while(Desk::is_answering);
    }

    /// Waits until all requests are answered and nothing is left to refine.
    pub(crate) fn wait_until_refined(&self) {
        self.wait_while(|desk| desk.is_answering() || !desk.settled);
    }

    fn wait_while(&self, busy: impl Fn(&Desk<P>) -> bool) {
        // A poisoned lock means that the thread has ended.
        drop(self.shared.changed.wait_while(self.shared.lock(), |desk| busy(desk)));
    }
}

impl<P> Drop for Worker<P> {
    fn drop(&mut self) {
        self.shared.lock().closed = true;
        self.shared.over.store(true, Ordering::Relaxed);
        self.shared.changed.notify_all();
        if let Place::Thread(thread) = &mut self.place
            && let Some(thread) = thread.take()
        {
            // If the thread panicked, it has reported its failure already.
            let _ = thread.join();
        }
    }
}

impl<P> Default for News<P> {
    fn default() -> Self {
        let (border, drawn, refined, outline) = (None, None, None, None);
        let (explained, dial, ideal, picked, failed) = (None, None, None, Vec::new(), false);
        Self { border, drawn, refined, outline, explained, dial, ideal, picked, failed }
    }
}

impl<P> Desk<P> {
    fn has_work(&self) -> bool {
        self.wanted.is_some()
            || !self.picks.is_empty()
            || self.border.is_some()
            || self.ideal.is_some()
    }

    fn is_answering(&self) -> bool {
        self.busy || self.has_work()
    }
}

impl<P> Shared<P> {
    fn new(is_awaited: fn() -> bool) -> Arc<Self> {
        let (wanted, picks, border, ideal) = (None, VecDeque::new(), None, None);
        let (busy, begun, closed) = (false, None, false);
        let (settled, quiet_at, news) = (true, Instant::now(), News::default());
        let desk =
            Desk { wanted, picks, border, ideal, news, busy, begun, closed, settled, quiet_at };
        Arc::new(Self {
            desk: Mutex::new(desk),
            changed: Condvar::new(),
            newer: AtomicBool::new(false),
            disturbed: AtomicBool::new(false),
            over: AtomicBool::new(false),
            painted: Arc::default(),
            is_awaited,
        })
    }

    fn lock(&self) -> MutexGuard<'_, Desk<P>> {
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Interrupts refinement until the window has been quiet for a while.
    fn disturb(&self, desk: &mut Desk<P>) {
        desk.quiet_at = Instant::now() + QUIET;
        self.disturbed.store(true, Ordering::Relaxed);
    }

    /// Returns whether work in the background goes on; asked between tiles.
    fn goes_on_until(&self, end: &AtomicBool) -> bool {
        let is_over = [end, &self.over].iter().any(|flag| flag.load(Ordering::Relaxed));
        !is_over && !(self.is_awaited)()
    }

    /// Returns the time until the next work, or `None` if only a request brings some.
    fn rest(&self) -> Option<Duration> {
        let desk = self.lock();
        match (desk.has_work(), desk.settled) {
            (true, _) => Some(Duration::ZERO),
            (false, false) => Some(desk.quiet_at.saturating_duration_since(Instant::now())),
            (false, true) => None,
        }
    }

    /// Waits for work or for the time to refine; `None` if the desk is closed.
    fn next(&self) -> Option<Due<P>> {
        let mut desk = self.lock();
        (desk.busy, desk.begun) = (false, None);
        self.changed.notify_all();
        loop {
            if desk.closed {
                return None;
            }
            desk = match self.due(&mut desk) {
                Due::Wait(rest) => {
                    let waited = self.changed.wait_timeout(desk, rest);
                    waited.unwrap_or_else(PoisonError::into_inner).0
                }
                Due::Never => self.changed.wait(desk).unwrap_or_else(PoisonError::into_inner),
                due => return Some(due),
            };
        }
    }

    /// Takes the next work from the desk, if it is due.
    fn due(&self, desk: &mut Desk<P>) -> Due<P> {
        // Requests come before refinement, and all of them are taken at once.
        if desk.has_work() {
            desk.busy = true;
            desk.begun = desk.wanted.is_some().then(Instant::now);
            self.newer.store(false, Ordering::Relaxed);
            return Due::Answer(Box::new(Asking {
                picks: std::mem::take(&mut desk.picks),
                border: desk.border.take(),
                ideal: desk.ideal.take(),
                wanted: desk.wanted.take(),
            }));
        }
        // Without anything to refine, there is nothing to do until a request or the end.
        if desk.settled {
            return Due::Never;
        }
        // Refinement waits for a quiet moment, unless a request comes earlier.
        let rest = desk.quiet_at.saturating_duration_since(Instant::now());
        if !rest.is_zero() {
            return Due::Wait(rest);
        }
        self.disturbed.store(false, Ordering::Relaxed);
        Due::Refine
    }
}

/// Requests of the window: answer picks, outline an item, draw a window of the ideal, draw a
/// picture.
struct Asking<P> {
    picks: VecDeque<Pick<P>>,
    border: Option<Option<ItemId>>,
    ideal: Option<PixelBox>,
    wanted: Option<Snapshot>,
}

/// The next task of the thread, or the time until then.
enum Due<P> {
    /// Answer requests.
    Answer(Box<Asking<P>>),
    /// Refine the last picture by a step.
    Refine,
    Wait(Duration),
    Never,
}

/// Draws pictures and answers requests until the desk is closed.
fn work<P: Copy + Send>(shared: &Shared<P>, wake: &impl Fn()) {
    let mut painter = Painter::new(Arc::clone(&shared.painted));
    while let Some(due) = shared.next() {
        painter.work(shared, wake, due);
    }
}

impl Here {
    /// Answers all requests, or refines the picture by a step.
    fn work<P: Copy + Send>(&mut self, shared: &Shared<P>) {
        let Self { painter, wake } = self;
        let due = shared.due(&mut shared.lock());
        if matches!(due, Due::Never) {
            return;
        }
        // The picture is shown before it is refined.
        painter.work(shared, wake, due);
        let mut desk = shared.lock();
        (desk.busy, desk.begun) = (false, None);
        drop(desk);
        // The next frame looks again.
        wake();
    }
}

/// Draws pictures, and keeps the last snapshot.
struct Painter {
    renderer: ViewportRenderer,
    last: Option<Snapshot>,
    outlined: Vec<ItemId>,
    /// The item under the pointer.
    hovered: Option<ItemId>,
}

impl Painter {
    fn new(painted: Arc<Painted>) -> Self {
        let renderer = ViewportRenderer::new(Instant::now, painted);
        Self { renderer, last: None, outlined: Vec::new(), hovered: None }
    }

    fn work<P: Copy + Send>(&mut self, shared: &Shared<P>, wake: &impl Fn(), due: Due<P>) {
        let Asking { picks, border, ideal, wanted } = match due {
            Due::Answer(asking) => *asking,
            Due::Refine => return self.refine(shared, wake),
            Due::Wait(_) | Due::Never => return,
        };
        let Self { renderer, last, hovered, .. } = self;
        // Picks and borders refer to the picture on screen, so they are answered before it changes.
        let picked: Vec<_> = picks.into_iter().map(|pick| (pick, renderer.hit(pick.at))).collect();
        *hovered = border.unwrap_or(*hovered);
        let border = border.flatten().and_then(|item| renderer.border_under_pointer(item));
        if !picked.is_empty() || border.is_some() {
            let mut desk = shared.lock();
            desk.news.picked.extend(picked);
            desk.news.border = border.or(desk.news.border.take());
            drop(desk);
            wake();
        }
        if let (Some(window), Some(last), None) = (ideal, &*last, &wanted) {
            let goes_on = || shared.goes_on_until(&shared.newer);
            let drawn = catch_unwind(AssertUnwindSafe(|| renderer.ideal(last, window, &goes_on)));
            if let Ok(Some(picture)) = drawn {
                shared.lock().news.ideal = Some((window, picture));
                wake();
            }
        }
        let Some(wanted) = wanted else { return };
        if !self.draw(shared, wake, &wanted) {
            // A renderer that panicked may hold inconsistent buffers, so it is replaced.
            self.renderer = ViewportRenderer::new(Instant::now, Arc::clone(&shared.painted));
            self.last = None;
            return;
        }
        shared.lock().settled = false;
        // The explanation comes after the picture, which it would delay.
        let explain = || self.renderer.explain(&wanted);
        if let Ok(Some(explained)) = catch_unwind(AssertUnwindSafe(explain)) {
            shared.lock().news.explained = Some(explained);
            wake();
        }
        self.last = Some(wanted);
    }

    /// Draws a picture. Returns false if the renderer panicked: the fault costs one picture, not
    /// the user's work.
    fn draw<P: Copy + Send>(
        &mut self,
        shared: &Shared<P>,
        wake: &impl Fn(),
        wanted: &Snapshot,
    ) -> bool {
        let Self { renderer, outlined, hovered, .. } = self;
        // The renderer asks between tiles, without a lock.
        let asked = || match shared.over.load(Ordering::Relaxed) {
            true => Asked::Nothing,
            false if shared.newer.load(Ordering::Relaxed) => Asked::Newer,
            false => Asked::This,
        };
        let Ok(drawn) = catch_unwind(AssertUnwindSafe(|| renderer.draw(wanted, &asked))) else {
            shared.lock().news.failed = true;
            wake();
            return false;
        };
        let another = wanted.options.outlined != *outlined && !renderer.was_given_up();
        if drawn.is_some() || another {
            // The outline is taken from this very picture, so it never lags behind.
            let (first, others) = wanted.options.outlined.split_first().unzip();
            let own = first.and_then(|item| renderer.border(*item, &[*item]));
            let others = others.filter(|others| !others.is_empty());
            let others = others.and_then(|all| renderer.border(*first?, all));
            let outline = [own, others];
            outlined.clone_from(&wanted.options.outlined);
            let hovered = hovered.filter(|_| drawn.is_some());
            let border = hovered.and_then(|item| renderer.border_under_pointer(item));
            let mut desk = shared.lock();
            if drawn.is_some() {
                // A border of the picture before would lie over this one.
                desk.news.border = border;
                (desk.news.drawn, desk.news.refined) = (drawn, None);
            }
            desk.news.outline = Some(outline);
            drop(desk);
            wake();
        }
        true
    }

    /// Refines the last picture by a step, unless a request interrupts it.
    fn refine<P: Copy + Send>(&mut self, shared: &Shared<P>, wake: &impl Fn()) {
        let Self { renderer, last, .. } = self;
        let go_on = || shared.goes_on_until(&shared.disturbed);
        let step = || last.as_ref().map_or(Finer::Done, |last| renderer.refine(last, &go_on));
        match catch_unwind(AssertUnwindSafe(step)) {
            Ok(Finer::Refined(drawn)) => {
                shared.lock().news.refined = Some(*drawn);
                wake();
            }
            Ok(Finer::Dial(figures)) => {
                shared.lock().news.dial = Some(figures);
                wake();
            }
            Ok(Finer::Disturbed | Finer::Measured) => {}
            // If refinement fails, the unrefined picture remains on screen.
            Ok(Finer::Done) | Err(_) => {
                let mut desk = shared.lock();
                desk.settled = !desk.has_work();
            }
        }
    }
}
