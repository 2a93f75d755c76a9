//! The editor in an array of pixels, without a window of the system.
//!
//! The host, such as a page of a browser, passes egui's events, asks for frames, and shows the
//! rectangles that have changed. There are no system dialogs: a request to open files goes to the
//! host, and files are saved in [`CanvasShell::FILES`], where the host finds them.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::time::Duration;

use egui::{Context, Event, FullOutput, PlatformOutput, RawInput, Rect, Vec2};
use egui::{ViewportId, ViewportInfo, pos2, vec2};

use super::LONGEST_SIDE;
use crate::app::editor::App;
use crate::app::editor::jobs::JobKind;
use crate::app::state::{Notice, NoticeKind};
use crate::app::tasks::do_waiting;
use marraztu_io::{OwnFolders, Preferences};
use marraztu_painter::{Canvas, WindowFrame, WindowPainter};
use marraztu_render::screen::coverage::PixelBox;

/// The editor, its pixels, and the input since the last frame.
pub struct CanvasShell {
    ctx: Context,
    app: App,
    painter: WindowPainter,
    /// The output of frames that have not been painted yet.
    output: Option<FullOutput>,
    input: RawInput,
    pixels: Vec<u32>,
    size: [usize; 2],
    /// Pixels per point, without the zoom of the editor.
    scale: f32,
    /// Whether the pixels have not been painted yet.
    is_new: bool,
    /// The milliseconds until the next frame is due.
    due: Arc<AtomicU64>,
    /// Takes the files that the host was asked for.
    answer: Option<Sender<Option<Vec<PathBuf>>>>,
    /// Sentences of the host that wait for a notice.
    told: Vec<String>,
}

impl std::fmt::Debug for CanvasShell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { size, scale, .. } = self;
        f.debug_struct("CanvasShell").field("size", size).field("scale", scale).finish()
    }
}

/// The result of a frame.
#[expect(missing_debug_implementations, reason = "egui's output has none")]
pub struct Painted {
    /// The areas that have changed.
    pub changed: Vec<PixelBox>,
    /// The cursor, the text for the clipboard, the place of the text cursor, links to open.
    pub output: PlatformOutput,
    /// The extensions of the files that the user wants to open; the host answers by
    /// [`CanvasShell::answer`].
    pub wants: Option<Vec<&'static str>>,
    /// The scenes that the next frame reads. The host provides the files that they refer to, as far
    /// as it has them.
    pub opening: Vec<PathBuf>,
    /// The last message and everything reported over the picture, for screen readers.
    pub said: String,
    /// Whether work would be lost with the canvas, because it was not saved.
    pub unsaved: bool,
    /// If only the picture is shown: why there is none, in a sentence. The host shows it.
    pub fault: Option<String>,
}

impl CanvasShell {
    /// The folder for the user's files, if the host provides one.
    pub const FILES: &str = "/files";

    /// The folder for preferences and unsaved work.
    const OWN: &str = "/own";

    /// Starts the editor on a canvas of `size` pixels, with `scale` pixels per point. It opens
    /// these files, or the first scene.
    pub fn new(size: [usize; 2], scale: f32, files: Vec<PathBuf>) -> Self {
        let ctx = Context::default();
        // egui may lay out a frame twice, as in eframe.
        ctx.options_mut(|options| options.max_passes = TWICE);
        let due = Arc::new(AtomicU64::new(0));
        let theirs = Arc::clone(&due);
        ctx.set_request_repaint_callback(move |wish| {
            theirs.fetch_min(milliseconds(wish.delay), Ordering::Relaxed);
        });
        let own = Path::new(Self::OWN).is_dir().then(|| {
            let folders = OwnFolders::within(Path::new(Self::OWN));
            (Preferences::load(&folders), folders)
        });
        let mut app = App::start(&ctx, own);
        app.open_at_start(&ctx, files);
        Self {
            ctx,
            app,
            painter: WindowPainter::new(),
            output: None,
            input: RawInput { focused: true, ..RawInput::default() },
            pixels: vec![0; size[0] * size[1]],
            size,
            scale,
            is_new: true,
            due,
            answer: None,
            told: Vec::new(),
        }
    }

    /// Lets a [`DrawingServer`](crate::app::DrawingServer) of another instance draw the viewport.
    /// The host passes it each [`Self::request`], and each of its replies to [`Self::reply`].
    /// Without a call before the first frame, pictures are drawn here.
    pub const fn draw_elsewhere(&mut self) {
        self.app.draws_elsewhere = true;
    }

    /// Returns the next request to the drawing server, if there is one. To be called after each
    /// [`Self::run`], so that it draws while the frame is painted, and after each reply.
    pub fn request(&mut self) -> Option<Vec<u8>> {
        self.app.worker.as_mut()?.request()
    }

    /// Takes a reply of the drawing server. `None` means that it has stopped and a new one takes
    /// its place.
    pub fn reply(&mut self, reply: Option<&[u8]>) {
        if let Some(worker) = &mut self.app.worker {
            worker.hear(reply);
        }
    }

    /// Returns the next job of a kind for another instance, if there is one. The host passes it to
    /// [`do_job`](crate::app::do_job) there, all that it tells to [`Self::told`], and its end,
    /// after the files that it has written, to [`Self::done`]. To be called after each frame, if
    /// pictures are drawn elsewhere.
    pub fn job(&mut self, kind: JobKind) -> Option<Vec<u8>> {
        match kind {
            JobKind::Measure => self.app.lab.elsewhere.take_job(),
            JobKind::Make => self.app.making.take_job(),
            JobKind::Compare => self.app.comparing.take_job(),
        }
    }

    /// Returns whether the result of a job of a kind is awaited. If not, the host may stop it.
    pub fn awaits(&self, kind: JobKind) -> bool {
        match kind {
            JobKind::Measure => self.app.lab.elsewhere.is_awaited(),
            JobKind::Make => self.app.making.is_elsewhere(),
            JobKind::Compare => self.app.comparing.is_awaited(),
        }
    }

    /// Takes what a job of a kind tells while it is done.
    pub fn told(&mut self, kind: JobKind, told: &str) {
        match kind {
            JobKind::Measure => self.app.lab.hear(told),
            JobKind::Make => self.app.making.hear(told),
            JobKind::Compare => {}
        }
        self.due.store(0, Ordering::Relaxed);
    }

    /// Takes the end of a job of a kind. Anything else means that the job has failed.
    pub fn done(&mut self, kind: JobKind, end: &[u8]) {
        match kind {
            JobKind::Measure => self.app.lab.elsewhere.end(end),
            JobKind::Make => self.app.making.end_elsewhere(end),
            JobKind::Compare => self.app.comparing.end(end),
        }
        self.due.store(0, Ordering::Relaxed);
    }

    /// Shows only the picture, to orbit it: a page in which it is embedded. Models are seen from
    /// degrees to the right of the front, and up.
    pub fn show_picture_only(&mut self, from: Option<[f64; 2]>) {
        self.app.state.picture_only = true;
        self.app.state.overlays = false;
        self.app.models_from = from;
    }

    /// Changes the size of the canvas.
    pub fn resize(&mut self, size: [usize; 2], scale: f32) {
        (self.size, self.scale, self.is_new) = (size, scale, true);
        self.pixels = vec![0; size[0] * size[1]];
        self.due.store(0, Ordering::Relaxed);
    }

    /// Adds an event to the input of the next frame.
    pub fn hear(&mut self, event: Event) {
        if let Event::WindowFocused(focused) = event {
            self.input.focused = focused;
        }
        self.input.events.push(event);
        self.due.store(0, Ordering::Relaxed);
    }

    /// Shows a sentence of the host in a notice.
    pub fn tell(&mut self, sentence: String) {
        self.told.push(sentence);
        self.due.store(0, Ordering::Relaxed);
    }

    /// Drops files on the editor.
    pub fn drop_files(&mut self, files: Vec<PathBuf>) {
        self.app.open_files(&self.ctx, files);
        self.due.store(0, Ordering::Relaxed);
    }

    /// Gives the files that the editor has asked for; none if the user has cancelled.
    pub fn answer(&mut self, files: Vec<PathBuf>) {
        if let Some(answer) = self.answer.take() {
            // The editor may have stopped waiting.
            let _ = answer.send(Some(files));
        }
        self.due.store(0, Ordering::Relaxed);
    }

    /// Returns the zoom of the editor, which multiplies the scale.
    pub fn zoom(&self) -> f32 {
        self.ctx.zoom_factor()
    }

    /// Returns the time until the next frame is due, or `None` if nothing will change by itself.
    pub fn due(&self) -> Option<Duration> {
        let due = self.due.load(Ordering::Relaxed);
        (due != u64::MAX).then(|| Duration::from_millis(due))
    }

    /// Returns the pixels row by row: blue in the lowest byte, then green, red and a zero.
    pub fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// Copies red, green, blue and opacity of the pixels of an area, row by row. `at` is its left
    /// upper pixel. Returns whether all of it is within the canvas; if not, nothing is copied.
    pub fn copy_rgba(&self, at: [usize; 2], size: [usize; 2], into: &mut Vec<u8>) -> bool {
        let ends = [0, 1].map(|axis| at[axis].saturating_add(size[axis]));
        if ends[0] > self.size[0] || ends[1] > self.size[1] {
            return false;
        }
        into.clear();
        for row in at[1]..ends[1] {
            let begin = row * self.size[0];
            let pixels = &self.pixels[begin + at[0]..begin + ends[0]];
            into.extend(pixels.iter().flat_map(|pixel| {
                let [blue, green, red, _] = pixel.to_le_bytes();
                [red, green, blue, 255]
            }));
        }
        true
    }

    /// Returns the number of columns and rows.
    pub const fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Runs the editor at a time in seconds, with the input since the last frame, and paints it.
    pub fn frame(&mut self, time: f64) -> Painted {
        self.run(time);
        self.paint()
    }

    /// Runs the editor at a time in seconds, with the input since the last frame.
    pub fn run(&mut self, time: f64) {
        self.due.store(u64::MAX, Ordering::Relaxed);
        // The last frame has shown that this work begins.
        do_waiting();
        // A scene that is being opened replaces the notices, too.
        if self.app.loading.is_empty() {
            self.app
                .state
                .notices
                .extend(self.told.drain(..).map(|text| Notice::new(NoticeKind::Program, text)));
        }
        let mut input = self.input.take();
        input.time = Some(time);
        input.viewport_id = ViewportId::ROOT;
        input.max_texture_side = Some(LONGEST_SIDE);
        let points = self.extent() / (self.scale * self.zoom());
        input.screen_rect = Some(Rect::from_min_size(pos2(0.0, 0.0), points));
        let native_pixels_per_point = Some(self.scale);
        let info = ViewportInfo { native_pixels_per_point, ..ViewportInfo::default() };
        input.viewports.insert(ViewportId::ROOT, info);
        let app = &mut self.app;
        let output = self.ctx.run_ui(input, |ui| app.frame(ui));
        match &mut self.output {
            Some(before) => before.append(output),
            None => self.output = Some(output),
        }
    }

    /// Paints what the editor has shown. To be called after [`Self::run`].
    pub fn paint(&mut self) -> Painted {
        let output = self.output.take().unwrap_or_default();
        let FullOutput { platform_output, mut textures_delta, shapes, pixels_per_point, .. } =
            output;
        let primitives = self.ctx.tessellate(shapes, pixels_per_point);
        let ground = self.ctx.global_style().visuals.panel_fill;
        let frame = WindowFrame { primitives, scale: pixels_per_point, ground };
        let age = usize::from(!std::mem::take(&mut self.is_new));
        let mut canvas = Canvas { pixels: &mut self.pixels, size: self.size, age };
        let mut changed = self.painter.paint(&mut canvas, frame, &mut textures_delta);
        if age == 0 {
            let [right, bottom] = self.size.map(|count| i32::try_from(count).unwrap_or(i32::MAX));
            changed = vec![PixelBox { left: 0, top: 0, right, bottom }];
        }
        Painted {
            changed,
            output: platform_output,
            wants: self.file_request(),
            opening: std::mem::take(&mut self.app.opening),
            said: self.app.state().said(),
            unsaved: !self.app.is_all_saved(),
            fault: self.fault(),
        }
    }

    /// Returns why nothing is shown, if only the picture is.
    fn fault(&self) -> Option<String> {
        let fault = self.app.dialogs.fault().filter(|_| self.app.state.picture_only);
        fault.map(str::to_owned)
    }

    /// Passes a request to open files to the host. A file to be saved needs no question: the host
    /// takes it from the folder of files.
    fn file_request(&mut self) -> Option<Vec<&'static str>> {
        let request = self.app.dialogs.file_request()?;
        self.ctx.request_repaint();
        if request.saves {
            let name = if request.name.is_empty() { "untitled" } else { &request.name };
            // The editor has just asked, so it listens.
            let _ = request.answer.send(Some(vec![Path::new(Self::FILES).join(name)]));
            return None;
        }
        self.answer = Some(request.answer);
        Some(request.endings)
    }

    #[expect(clippy::cast_precision_loss, reason = "canvases have fewer than 2^24 pixels a side")]
    fn extent(&self) -> Vec2 {
        vec2(self.size[0] as f32, self.size[1] as f32)
    }
}

impl Drop for CanvasShell {
    fn drop(&mut self) {
        // egui reports dropped textures as a fault.
        if let Some(output) = self.output.take() {
            output.drop_without_applying_deltas();
        }
    }
}

const TWICE: std::num::NonZeroUsize = std::num::NonZeroUsize::new(2).expect("is not 0");

/// Rounds a time up, so that the frame is not too early.
fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_micros().div_ceil(1000)).unwrap_or(u64::MAX)
}
