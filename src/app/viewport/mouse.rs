//! Turns mouse input over the picture into requests.
//!
//! | input | does |
//! |---|---|
//! | left drag | analysis: orbit; fly: look. With Alt always orbit, with Shift pan |
//! | middle drag | pan |
//! | right held | look, and fly with W A S D Q E; a right click within 4 points is a menu |
//! | wheel, pinch | zoom towards the pointer; while flying, the speed |
//! | left drag on a handle of the gizmo | moves, rotates or scales; Ctrl snaps, numbers are typed |
//! | left drag on the axes in the corner | orbit; a click looks along the axis |
//! | Shift + left click | selects one more, or one less |
//! | Ctrl + left drag | selects all in a box |
//! | right press or Esc during another drag | back to where it began |
//!
//! Each drag is one gesture. So are the turns of the wheel while the pointer rests.

mod handles;

use egui::{Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, Rect, Response, Ui, Vec2};
use glam::{DVec2, DVec3};

use super::gizmo::{Gizmo, Grab};
use super::{Purpose, axes, comparison};
use crate::app::actions::{Request, Requests};
use crate::app::state::State;
use crate::app::widgets::gestures;
use marraztu_core::base::image::Size;
use marraztu_core::edit::{Gesture, Refusal, navigation, steps};
use marraztu_core::scene::{CameraMode, Command, Projection};
use marraztu_render::Hit;

/// The distance from the start, in points, within which a drag is a click.
const CLICK: f32 = 4.0;

/// The width of a splitter inside the picture, in points.
const SPLITTER: f32 = 4.0;

/// Points that a touchpad scrolls for one notch of a wheel.
const POINTS_A_NOTCH: f32 = 50.0;

/// The mouse over the picture.
#[derive(Debug)]
pub(crate) struct Mouse {
    drag: Option<Drag>,
    /// The speed of flight, relative to the default.
    speed: f64,
    /// The drags and typed amounts so far.
    count: u64,
    /// The gestures of the wheel so far.
    wheel: u64,
    /// Whether the last press of the left button hit the picture, and the one before it.
    pressed: [bool; 2],
    /// The handle of the gizmo that is dragged or gets a typed amount.
    grab: Option<Box<Grab>>,
}

/// The picture under the mouse.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Under<'a> {
    /// The area of the picture in the window.
    pub(crate) rect: Rect,
    /// Its size in pixels.
    pub(crate) size: Size,
    /// The hit under the pointer, if known.
    pub(crate) hit: Option<Hit>,
    /// The gizmo over the picture.
    pub(crate) gizmo: Option<&'a Gizmo>,
    /// The axes over the picture.
    pub(super) axes: &'a [axes::End],
    /// The text typed in this frame while a handle is held.
    pub(crate) typed: &'a str,
}

#[derive(Clone, Copy, Debug)]
struct Drag {
    motion: Motion,
    button: PointerButton,
    gesture: Gesture,
    from: Pos2,
    /// The position that was handled last, and the current one.
    at: Pos2,
    to: Pos2,
    /// Whether it has moved farther than a click.
    moved: bool,
    /// Whether it was cancelled: it has no effect until the button is released.
    over: bool,
    /// Whether Shift was held when it began.
    shift: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Motion {
    Look,
    Orbit,
    Pan,
    Fly,
    /// Drags a handle of the gizmo.
    Handle,
    /// Draws a box that selects the items in it.
    Box,
}

impl Default for Mouse {
    fn default() -> Self {
        Self { drag: None, speed: 1.0, count: 0, wheel: 0, pressed: [false; 2], grab: None }
    }
}

impl Mouse {
    /// Returns whether a button is held.
    pub(crate) const fn is_dragging(&self) -> bool {
        self.drag.is_some()
    }

    /// Returns whether letters steer.
    pub(crate) fn is_flying(&self) -> bool {
        self.drag.is_some_and(|drag| drag.motion == Motion::Fly && !drag.over)
    }

    /// Returns the speed of flight, while flying.
    pub(crate) fn flight(&self) -> Option<f64> {
        self.is_flying().then_some(self.speed)
    }

    /// Cancels the current drag. Returns whether there was one.
    pub(crate) fn cancel(&mut self, requests: &mut Requests) -> bool {
        match &mut self.drag {
            Some(drag) if !drag.over => {
                drag.over = true;
                requests.push(Request::Abandon(drag.gesture));
                self.grab = None;
                true
            }
            None if self.grab.take().is_some() => {
                requests.push(Request::Abandon(self.typed_gesture()));
                true
            }
            _ => false,
        }
    }

    /// Adds the requests of this frame; returns the points of the picture to pick.
    pub(crate) fn ui(
        &mut self,
        ui: &Ui,
        response: &Response,
        state: &State,
        under: Under<'_>,
        requests: &mut Requests,
    ) -> Vec<(Pos2, Purpose)> {
        let mut picks = Vec::new();
        // Events are handled one by one: on a slow machine, a frame may contain a whole click.
        for event in ui.input(|input| input.events.clone()) {
            match event {
                Event::PointerButton { pos, button, pressed: true, modifiers } => {
                    if button == PointerButton::Primary {
                        let here = response.contains_pointer()
                            && !egui::Popup::is_any_open(ui.ctx())
                            && response.rect.contains(pos);
                        self.pressed = [here, self.pressed[0]];
                    }
                    let press = (pos, button, modifiers);
                    self.press(ui, response, (state, under), press, requests);
                }
                Event::PointerMoved(at) => {
                    if let Some(drag) = &mut self.drag {
                        drag.to = at;
                    }
                }
                Event::PointerButton { pos, button, pressed: false, .. } => {
                    self.release(ui, state, under, (pos, button), requests, &mut picks);
                }
                _ => {}
            }
        }
        self.pull(ui, &state.scene, under, requests);
        self.go_on(ui, state, under.size, requests);
        if self.drag.is_some_and(|drag| !ui.input(|input| input.pointer.button_down(drag.button))) {
            // It was released outside the window.
            (self.drag, self.grab) = (None, None);
        }
        // Both presses must hit the picture: the first of two clicks may have closed a notice over
        // it.
        if response.double_clicked_by(PointerButton::Primary) && self.pressed == [true; 2] {
            picks.extend(response.interact_pointer_pos().map(|at| (at, Purpose::Frame)));
        }
        if response.contains_pointer() {
            self.wheel(ui, state, under, requests);
        }
        picks
    }

    fn press(
        &mut self,
        ui: &Ui,
        response: &Response,
        (state, under): (&State, Under<'_>),
        (from, button, modifiers): (Pos2, PointerButton, Modifiers),
        requests: &mut Requests,
    ) {
        if self.drag.is_some() {
            if button == PointerButton::Secondary {
                self.cancel(requests);
            }
            return;
        }
        // A press in a panel ends it, too: a typed amount starts from the scene as it was.
        self.end_typing(requests);
        if comparison::grip(state, response.rect).is_some_and(|grip| grip.contains(from)) {
            return;
        }
        // At the border of the picture, a press belongs to a splitter.
        if !response.rect.shrink(SPLITTER).contains(from) {
            return;
        }
        // A press that closes a menu has no other effect.
        if !response.contains_pointer() || egui::Popup::is_any_open(ui.ctx()) {
            return;
        }
        // The button and the modifiers select the motion; a handle under the pointer comes first.
        let pose = state.scene.selected_camera(&state.view).pose.now();
        let held = under.gizmo.and_then(|gizmo| Some((gizmo, gizmo.handle_at(from)?)));
        let motion = match button {
            // The axes lie over everything else.
            PointerButton::Primary if axes::has(under.axes, under.rect, from) => Motion::Orbit,
            PointerButton::Primary if state.picture_only && !modifiers.shift => Motion::Orbit,
            PointerButton::Secondary if state.picture_only => Motion::Pan,
            PointerButton::Secondary => Motion::Fly,
            PointerButton::Middle => Motion::Pan,
            PointerButton::Primary if !modifiers.alt && !modifiers.shift && held.is_some() => {
                Motion::Handle
            }
            PointerButton::Primary if modifiers.alt => Motion::Orbit,
            PointerButton::Primary if modifiers.shift => Motion::Pan,
            PointerButton::Primary if modifiers.command => Motion::Box,
            PointerButton::Primary => match pose.mode_with(state.view.object) {
                CameraMode::Fly => Motion::Look,
                CameraMode::Analysis { .. } => Motion::Orbit,
            },
            PointerButton::Extra1 | PointerButton::Extra2 => return,
        };
        let gesture = self.gesture("drag");
        let (to, at) = (from, from);
        if let (Motion::Handle, Some((gizmo, handle))) = (motion, held) {
            self.grab = Some(Box::new(Grab::new(state, gizmo, handle, from)));
        }
        let (moved, over, shift) = (false, false, modifiers.shift);
        self.drag = Some(Drag { motion, button, gesture, from, at, to, moved, over, shift });
    }

    /// Applies the movement of the pointer since the last call.
    fn go_on(&mut self, ui: &Ui, state: &State, size: Size, requests: &mut Requests) {
        let Some(drag) = &mut self.drag else { return };
        // The first movement includes the part during which the drag could still become a click.
        drag.moved |= (drag.to - drag.from).length() > CLICK;
        let by = if drag.moved { drag.to - drag.at } else { Vec2::ZERO };
        if drag.moved {
            drag.at = drag.to;
        }
        let drag = *drag;
        if drag.over || matches!(drag.motion, Motion::Handle | Motion::Box) {
            return;
        }
        if by != Vec2::ZERO {
            let pixels = by * ui.ctx().pixels_per_point();
            let command = moving(drag, state, pixels, size);
            requests.push(navigating(command, drag.gesture));
        }
        if drag.motion == Motion::Fly {
            self.fly(ui, drag, state, requests);
        }
    }

    fn release(
        &mut self,
        ui: &Ui,
        state: &State,
        under: Under<'_>,
        (to, button): (Pos2, PointerButton),
        requests: &mut Requests,
        picks: &mut Vec<(Pos2, Purpose)>,
    ) {
        match &mut self.drag {
            Some(drag) if drag.button == button => drag.to = to,
            _ => return,
        }
        // The movement up to the release belongs to the drag.
        self.go_on(ui, state, under.size, requests);
        self.pull(ui, &state.scene, under, requests);
        let typed = self.grab.take().is_some_and(|grab| grab.is_typed());
        let Some(drag) = self.drag.take() else { return };
        if drag.motion == Motion::Box && drag.moved && !drag.over {
            picks.push((drag.from, Purpose::Box(Rect::from_two_pos(drag.from, drag.to))));
        }
        // A press without a drag is a click.
        if drag.moved || drag.over || typed {
            return;
        }
        match drag.button {
            PointerButton::Primary if drag.shift || drag.motion == Motion::Box => {
                picks.push((drag.from, Purpose::SelectAlso));
            }
            PointerButton::Primary => picks.push((drag.from, Purpose::Select)),
            PointerButton::Secondary => picks.push((drag.from, Purpose::Menu(drag.from))),
            _ => {}
        }
    }

    /// Moves the camera by the keys that are held with the right button.
    fn fly(&mut self, ui: &Ui, drag: Drag, state: &State, requests: &mut Requests) {
        let held = |key| ui.input(|input| f64::from(u8::from(input.key_down(key))));
        let along = |back, forth| held(forth) - held(back);
        let way = DVec3::new(along(Key::A, Key::D), along(Key::Q, Key::E), along(Key::W, Key::S));
        if way == DVec3::ZERO {
            return;
        }
        if let Some(drag) = &mut self.drag {
            drag.moved = true;
        }
        let (dt, modifiers) = ui.input(|input| (input.stable_dt.min(0.1), input.modifiers));
        let haste = match (modifiers.shift, modifiers.alt) {
            (true, false) => 4.0,
            (false, true) => 0.25,
            _ => 1.0,
        };
        // Ten steps of translation per second.
        let distance = step(state) * 10.0 * self.speed * haste * f64::from(dt);
        let command = navigation::fly(
            &state.scene,
            &state.view,
            way.clamp_length_max(1.0) * distance,
            state.phase(drag.gesture),
        );
        requests.push(navigating(command, drag.gesture));
        ui.ctx().request_repaint();
    }

    fn wheel(&mut self, ui: &Ui, state: &State, under: Under<'_>, requests: &mut Requests) {
        let Under { rect, size, hit, .. } = under;
        let (notches, moved, at) = ui.input(|input| {
            let notches = input.events.iter().map(notches).sum::<f64>();
            (notches, input.pointer.delta() != Vec2::ZERO, input.pointer.latest_pos())
        });
        // Moving the pointer or holding a key begins a new gesture.
        if moved || !ui.input(|input| input.keys_down.is_empty()) {
            self.wheel += 1;
        }
        let (Some(at), true) = (at, notches != 0.0) else { return };
        if self.is_flying() {
            self.speed = (self.speed * libm::pow(1.2, notches)).clamp(1e-3, 1e3);
            return;
        }
        if self.is_dragging() {
            return;
        }
        let gesture = gestures::numbered(self.wheel, "wheel");
        let at = (at - rect.min) * ui.ctx().pixels_per_point();
        let pointer = navigation::Pointer {
            at: DVec2::new(f64::from(at.x), f64::from(at.y)),
            depth: hit.and_then(|hit| distance(state, hit.depth)),
        };
        let phase = state.phase(gesture);
        let command = navigation::zoom(&state.scene, &state.view, notches, pointer, size, phase);
        requests.push(navigating(command, gesture));
    }

    fn gesture(&mut self, source: &str) -> Gesture {
        self.count += 1;
        gestures::numbered(self.count, source)
    }
}

/// Returns the command for a movement of the pointer, in pixels.
#[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
fn moving(drag: Drag, state: &State, pixels: Vec2, size: Size) -> Result<Command, Refusal> {
    let (scene, view) = (&state.scene, &state.view);
    let phase = state.phase(drag.gesture);
    let (dx, dy) = (f64::from(pixels.x), f64::from(pixels.y));
    let shorter = size.width.min(size.height) as f64;
    match drag.motion {
        Motion::Pan => navigation::pan(scene, view, DVec2::new(dx, dy), size, phase),
        Motion::Orbit => {
            // Half a turn across the shorter side.
            let angle = std::f64::consts::PI / shorter;
            navigation::orbit(scene, view, -dx * angle, -dy * angle, phase)
        }
        Motion::Look | Motion::Fly => {
            let lens = scene.selected_camera(view).lens;
            let angle = 2.0 * lens.half_angle.to_radians() / shorter;
            navigation::look(scene, view, -dx * angle, -dy * angle, phase)
        }
        // Other functions handle these motions.
        Motion::Handle | Motion::Box => Err(Refusal::Gone),
    }
}

/// Returns the request for a movement of the view.
fn navigating(command: Result<Command, Refusal>, gesture: Gesture) -> Request {
    match command {
        Ok(command) => Request::Navigate { command, gesture },
        Err(refusal) => Request::Refuse(refusal.to_string()),
    }
}

/// Returns the turn of the wheel in notches, positive towards the picture.
fn notches(event: &Event) -> f64 {
    match event {
        Event::MouseWheel { unit, delta, .. } => f64::from(match unit {
            MouseWheelUnit::Line => delta.y,
            MouseWheelUnit::Point => delta.y / POINTS_A_NOTCH,
            MouseWheelUnit::Page => delta.y * 10.0,
        }),
        Event::Zoom(factor) if *factor > 0.0 => {
            -libm::log(f64::from(*factor)) / libm::log(navigation::NOTCH)
        }
        _ => 0.0,
    }
}

/// Returns the length of a step of translation.
fn step(state: &State) -> f64 {
    steps::length(&state.scene, &state.view)
}

/// Returns the distance in front of the camera for a depth in the picture: the projection's depth z
/// = n (f - d) / (d (f - n)), solved for d.
fn distance(state: &State, depth: f32) -> Option<f64> {
    let lens = state.scene.selected_camera(&state.view).lens;
    let (near, far) = (lens.near, lens.far);
    (state.view.projection == Projection::Perspective)
        .then(|| near * far / (f64::from(depth) * (far - near) + near))
}
