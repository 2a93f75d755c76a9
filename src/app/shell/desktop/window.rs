//! The window painted by the CPU: its events, its frames, and their timing.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use egui::{Context, Event, FullOutput, RawInput, Rect, ViewportBuilder, ViewportCommand};
use egui::{TexturesDelta, ViewportEvent, ViewportId, ViewportInfo, pos2, vec2};
use egui_winit::accesskit_winit::{self, WindowEvent as ScreenReader};
use egui_winit::{ActionRequested, State};
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::raw_window_handle::{HasDisplayHandle, RawDisplayHandle};

use super::surface::Surface;
use super::{Make, StartError, display_error};
use crate::app::editor::App;
use crate::app::shell::LONGEST_SIDE;
use marraztu_painter::WindowFrame;

/// The minimum interval between frames.
const FASTEST: Duration = Duration::from_micros(1_000_000 / 144);
/// The minimum interval between frames of a window that is not visible.
const UNSEEN: Duration = Duration::from_millis(100);
/// The maximum time to wait for the display's permission to present a frame. After it, the editor
/// runs without presenting: some displays never respond for a window that is covered.
const PATIENCE: Duration = Duration::from_millis(250);
/// The time for which information of the display about the window is reused without an event.
const BELIEVED: Duration = Duration::from_secs(1);

/// An event that wakes the loop, other than events of the window.
#[derive(Debug)]
pub(super) enum Wake {
    /// A repaint was requested for this time, in this pass of egui.
    Repaint { at: Instant, pass: u64 },
    /// A screen reader requests something.
    Access(accesskit_winit::Event),
}

impl From<accesskit_winit::Event> for Wake {
    fn from(event: accesskit_winit::Event) -> Self {
        Self::Access(event)
    }
}

/// Whether the loop continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Flow {
    On,
    /// The window was asked to close, and the editor did not object.
    Left,
}

/// The window, the editor in it, and their state.
pub(super) struct Window {
    window: Arc<winit::window::Window>,
    ctx: Context,
    state: State,
    surface: Surface,
    editor: App,
    info: ViewportInfo,
    /// When the information was read; `None` if it is out of date.
    told_at: Option<Instant>,
    size: PhysicalSize<u32>,
    scale: f64,
    /// Whether the display says when to present a frame.
    is_paced: bool,
    opened_at: Instant,
    has_been_shown: bool,
    /// When the last frame began.
    last: Option<Instant>,
    /// When the next frame is requested.
    due: Option<Instant>,
    /// When the display was asked to present a frame.
    asked_at: Option<Instant>,
    actions: Vec<ActionRequested>,
    /// Textures that have not been painted yet.
    textures: TexturesDelta,
}

impl Window {
    pub(super) fn open(
        event_loop: &ActiveEventLoop,
        builder: ViewportBuilder,
        proxy: EventLoopProxy<Wake>,
        make: Make,
    ) -> Result<Self, StartError> {
        let ctx = Context::default();
        // The window stays hidden until the first frame. Screen readers must be attached before it
        // is shown.
        let builder = no_larger_than_the_screen(builder, event_loop).with_visible(false);
        let window = egui_winit::create_window(&ctx, event_loop, &builder);
        let window = Arc::new(window.map_err(|error| display_error(&error))?);
        let (scale, size) = (window.scale_factor(), window.inner_size());
        let mut state = State::new(
            ctx.clone(),
            ViewportId::ROOT,
            event_loop,
            Some(single(scale)),
            event_loop.system_theme(),
            Some(LONGEST_SIDE),
        );
        state.init_accesskit(event_loop, &window, proxy.clone());
        repaint_through(&ctx, proxy);
        let mut info = ViewportInfo::default();
        egui_winit::update_viewport_info(&mut info, &ctx, &window, true);
        let pixels_per_point = egui_winit::pixels_per_point(&ctx, &window);
        ctx.input_mut(|input| {
            input.raw.viewports.insert(ViewportId::ROOT, info.clone());
            input.pixels_per_point = pixels_per_point;
        });
        let handle = event_loop.display_handle().ok().map(|handle| handle.as_raw());
        // X11 does not say when frames are shown.
        let is_paced =
            !matches!(handle, Some(RawDisplayHandle::Xlib(_) | RawDisplayHandle::Xcb(_)));
        let surface = Surface::new(&window)?;
        // egui may lay out a frame twice, as in eframe.
        ctx.options_mut(|options| options.max_passes = TWICE);
        let editor = make(&ctx);
        let (told_at, now) = (None, Instant::now());
        Ok(Self {
            window,
            ctx,
            state,
            surface,
            editor,
            info,
            told_at,
            size,
            scale,
            is_paced,
            opened_at: now,
            has_been_shown: false,
            last: None,
            due: Some(now),
            asked_at: None,
            actions: Vec::new(),
            textures: TexturesDelta::default(),
        })
    }

    /// Tells the editor that the user has left.
    pub(super) fn leave(&mut self) {
        self.editor.end();
    }

    /// Returns the time of the next frame.
    pub(super) fn next(&self) -> Option<Instant> {
        if let Some(asked_at) = self.asked_at {
            return Some(asked_at + PATIENCE);
        }
        let least = if self.is_seen() { FASTEST } else { UNSEEN };
        let earliest = self.last.map(|last| last + least);
        self.due.map(|due| earliest.map_or(due, |earliest| due.max(earliest)))
    }

    /// Handles a repaint request of egui from this pass.
    pub(super) fn wake(&mut self, at: Instant, pass: u64) {
        // Older requests were fulfilled by frames since then.
        let now = self.ctx.cumulative_pass_nr_for(ViewportId::ROOT);
        if now == pass || now == pass + 1 {
            self.want(at);
        }
    }

    fn want(&mut self, at: Instant) {
        self.due = Some(self.due.map_or(at, |due| due.min(at)));
    }

    pub(super) fn hear(&mut self, event: &WindowEvent) {
        match event {
            // The event may be older than the current size.
            WindowEvent::Resized(_) => self.size = self.window.inner_size(),
            WindowEvent::ScaleFactorChanged { scale_factor, .. } => self.scale = *scale_factor,
            WindowEvent::Occluded(occluded) => {
                self.info.occluded = Some(*occluded);
                self.surface.expose();
                self.want(Instant::now());
            }
            WindowEvent::CloseRequested => {
                self.info.events.push(ViewportEvent::Close);
                self.ctx.request_repaint();
                self.want(Instant::now());
            }
            _ => {}
        }
        // All other events may change the window, so its information is read again.
        if !matches!(
            event,
            WindowEvent::CursorMoved { .. }
                | WindowEvent::MouseInput { .. }
                | WindowEvent::MouseWheel { .. }
                | WindowEvent::KeyboardInput { .. }
        ) {
            self.told_at = None;
        }
        if self.state.on_window_event(&self.window, event).repaint {
            self.want(Instant::now());
        }
    }

    pub(super) fn hear_motion(&mut self, delta: (f64, f64)) {
        if self.state.on_mouse_motion(delta) {
            self.want(Instant::now());
        }
    }

    pub(super) fn hear_screen_reader(&mut self, event: ScreenReader) {
        match event {
            ScreenReader::InitialTreeRequested => self.ctx.enable_accesskit(),
            ScreenReader::ActionRequested(request) => {
                self.state.on_accesskit_action_request(request);
            }
            ScreenReader::AccessibilityDeactivated => return self.ctx.disable_accesskit(),
        }
        self.want(Instant::now());
    }

    /// Handles the display's request to paint the window.
    pub(super) fn redraw(&mut self, event_loop: &ActiveEventLoop) -> Result<Flow, StartError> {
        if self.is_paced {
            return self.frame(event_loop, true);
        }
        // On X11, the event only says that a part of the window was uncovered.
        self.surface.expose();
        self.want(Instant::now());
        Ok(Flow::On)
    }

    pub(super) fn frame_if_due(
        &mut self,
        event_loop: &ActiveEventLoop,
    ) -> Result<Flow, StartError> {
        let now = Instant::now();
        if self.next().is_none_or(|next| next > now) {
            return Ok(Flow::On);
        }
        // A display that paces frames is asked first; without an answer in time, the editor runs
        // anyway.
        let is_late = self.asked_at.take().is_some();
        if self.is_paced && self.is_seen() && !is_late && self.last.is_some() {
            self.asked_at = Some(now);
            self.window.request_redraw();
            return Ok(Flow::On);
        }
        self.frame(event_loop, !is_late)
    }

    fn is_seen(&self) -> bool {
        self.info.minimized != Some(true) && self.info.occluded != Some(true)
    }

    /// Runs the editor with the input since the last frame, and presents the result.
    fn frame(&mut self, event_loop: &ActiveEventLoop, show: bool) -> Result<Flow, StartError> {
        let now = Instant::now();
        (self.last, self.due, self.asked_at) = (Some(now), None, None);
        // Information about the window comes from the display, so it is reused for a while.
        if self.told_at.is_none_or(|then| now - then > BELIEVED) {
            egui_winit::update_viewport_info(&mut self.info, &self.ctx, &self.window, false);
            self.told_at = Some(now);
        }
        let input = self.input();
        let asked_to_close = input.viewport().close_requested();
        let (editor, parent) = (&mut self.editor, &*self.window);
        let output = self.ctx.run_ui(input, |ui| editor.frame_within(ui, parent));
        self.info.events.clear();
        let FullOutput { platform_output, textures_delta, shapes, pixels_per_point, .. } = output;
        // Textures are collected even if nothing is painted, since egui sends each change only
        // once.
        self.textures.append(textures_delta);
        let (state, window) = (&mut self.state, &self.window);
        state.handle_platform_output_with_event_loop(window, event_loop, platform_output);
        let mut viewports = output.viewport_output;
        let commands = viewports.remove(&ViewportId::ROOT).map(|viewport| viewport.commands);
        if self.obey(commands.unwrap_or_default(), asked_to_close) == Flow::Left {
            return Ok(Flow::Left);
        }
        // A screenshot needs pixels, even of a window that is not visible.
        let wants_copy = self.actions.iter().any(ActionRequested::wants_paint);
        let mut copy = None;
        if (show && self.is_seen()) || wants_copy {
            let primitives = self.ctx.tessellate(shapes, pixels_per_point);
            let ground = self.ctx.global_style().visuals.panel_fill;
            let frame = WindowFrame { primitives, scale: pixels_per_point, ground };
            let size = self.size.into();
            copy = self.surface.show(size, frame, &mut self.textures, wants_copy)?;
            if !std::mem::replace(&mut self.has_been_shown, true) {
                self.window.set_visible(true);
            }
        }
        self.act(copy.map(Arc::new).as_ref());
        Ok(Flow::On)
    }

    /// Collects the input since the last frame.
    fn input(&mut self) -> RawInput {
        let size = vec2(pixels(self.size.width), pixels(self.size.height));
        let size = size / (single(self.scale) * self.ctx.zoom_factor());
        let input = self.state.egui_input_mut();
        input.time = Some(self.opened_at.elapsed().as_secs_f64());
        let has_size = size.x > 0.0 && size.y > 0.0;
        input.screen_rect = has_size.then(|| Rect::from_min_size(pos2(0.0, 0.0), size));
        input.viewport_id = ViewportId::ROOT;
        let mut info = self.info.clone();
        info.native_pixels_per_point = Some(single(self.scale));
        input.viewports.insert(ViewportId::ROOT, info);
        input.take()
    }

    /// Performs the editor's commands to the window.
    fn obey(&mut self, commands: Vec<ViewportCommand>, asked_to_close: bool) -> Flow {
        if asked_to_close && !commands.contains(&ViewportCommand::CancelClose) {
            return Flow::Left;
        }
        if !commands.is_empty() {
            let (info, actions) = (&mut self.info, &mut self.actions);
            let window = &self.window;
            egui_winit::process_viewport_commands(&self.ctx, info, commands, window, actions);
            self.told_at = None;
            // Some displays change the size immediately, without an event.
            self.size = self.window.inner_size();
        }
        Flow::On
    }

    /// Performs clipboard actions and screenshots.
    fn act(&mut self, copy: Option<&Arc<egui::ColorImage>>) {
        for action in std::mem::take(&mut self.actions) {
            let event = match action {
                ActionRequested::Screenshot(callback) => {
                    if let Some(copy) = copy {
                        callback.complete(Arc::clone(copy));
                    }
                    None
                }
                ActionRequested::PaintWhileHidden => None,
                ActionRequested::Cut => Some(Event::Cut),
                ActionRequested::Copy => Some(Event::Copy),
                ActionRequested::Paste => pasted(&mut self.state),
            };
            self.state.egui_input_mut().events.extend(event);
        }
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        // egui reports dropped textures as a fault.
        self.textures.clear();
    }
}

const TWICE: std::num::NonZeroUsize = std::num::NonZeroUsize::new(2).expect("is not 0");

fn pasted(state: &mut State) -> Option<Event> {
    match state.clipboard_text() {
        Some(text) => {
            let text = text.replace("\r\n", "\n");
            (!text.is_empty()).then_some(Event::Paste(text))
        }
        None => state.clipboard_image().map(|image| Event::PasteImage(Arc::new(image))),
    }
}

/// Lets egui wake the loop from any thread.
fn repaint_through(ctx: &Context, proxy: EventLoopProxy<Wake>) {
    let proxy = Mutex::new(proxy);
    ctx.set_request_repaint_callback(move |wish| {
        // A time beyond the range of the clock means never.
        let Some(at) = Instant::now().checked_add(wish.delay) else { return };
        let wake = Wake::Repaint { at, pass: wish.current_cumulative_pass_nr };
        // After the end of the loop, repaints are ignored.
        let _ = proxy.lock().unwrap_or_else(PoisonError::into_inner).send_event(wake);
    });
}

/// Limits the size to that of the largest screen: some displays fail with larger windows.
fn no_larger_than_the_screen(
    builder: ViewportBuilder,
    event_loop: &ActiveEventLoop,
) -> ViewportBuilder {
    let screens = event_loop.available_monitors().map(|monitor| {
        let size = monitor.size().to_logical::<f32>(monitor.scale_factor());
        vec2(size.width, size.height)
    });
    match (builder.inner_size, screens.reduce(egui::Vec2::max)) {
        (Some(size), Some(screen)) if screen.x > 0.0 && screen.y > 0.0 => {
            builder.with_inner_size(size.min(screen))
        }
        _ => builder,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "egui's scales are single")]
const fn single(scale: f64) -> f32 {
    scale as f32
}

#[expect(clippy::cast_precision_loss, reason = "windows have fewer than 2^24 pixels a side")]
const fn pixels(count: u32) -> f32 {
    count as f32
}
