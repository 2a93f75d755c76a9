//! Mouse input for handles of the gizmo and for selection boxes.

use egui::{Rect, Ui};

use super::{CLICK, Motion, Mouse, Under};
use crate::app::actions::{Request, Requests};
use crate::app::viewport::gizmo::{Grab, Pull};
use crate::app::widgets::gestures;
use marraztu_core::edit::Gesture;
use marraztu_core::scene::Scene;

impl Mouse {
    /// Returns the handle being dragged, once the press is more than a click.
    pub(crate) fn grab(&self) -> Option<&Grab> {
        let moved = self.drag.is_none_or(|drag| drag.moved && !drag.over);
        self.grab.as_deref().filter(|grab| moved || grab.is_typed())
    }

    /// Begins to take a typed amount for a handle, without the mouse.
    pub(crate) fn type_amount(&mut self, grab: Grab) {
        if self.drag.is_none() {
            self.count += 1;
            self.grab = Some(Box::new(grab));
        }
    }

    /// Returns whether typed letters and numbers belong to a handle.
    pub(crate) const fn is_typing(&self) -> bool {
        self.grab.is_some()
    }

    pub(crate) fn selection_box(&self) -> Option<Rect> {
        let drag = self.drag.filter(|drag| drag.motion == Motion::Box && drag.moved && !drag.over);
        drag.map(|drag| Rect::from_two_pos(drag.from, drag.to))
    }

    /// Lets the held handle follow the pointer and the typed text.
    pub(super) fn pull(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        under: Under<'_>,
        requests: &mut Requests,
    ) {
        let typed_gesture = self.typed_gesture();
        let Some(grab) = &mut self.grab else { return };
        let snap = ui.input(|input| input.modifiers.command);
        let Some(drag) = &mut self.drag else {
            let pull = Pull { to: under.rect.center(), snap: false, typed: under.typed };
            if grab.follow_typed(scene, pull, typed_gesture, requests) {
                self.grab = None;
            }
            return;
        };
        drag.moved |= (drag.to - drag.from).length() > CLICK;
        if !drag.moved && !grab.is_typed() && under.typed.is_empty() {
            return;
        }
        let pull = Pull { to: drag.to, snap, typed: under.typed };
        if grab.follow(scene, pull, drag.gesture, requests) {
            // The drag has ended, and the release of the button has no further effect.
            (drag.over, self.grab) = (true, None);
        }
    }

    /// Ends a typed amount at a press of the mouse and keeps its effect.
    pub(super) fn end_typing(&mut self, requests: &mut Requests) {
        if self.grab.take().is_some_and(|grab| !grab.is_typed()) {
            requests.push(Request::Abandon(self.typed_gesture()));
        }
    }

    /// Returns the gesture of an amount that is typed without the mouse.
    pub(super) fn typed_gesture(&self) -> Gesture {
        gestures::numbered(self.count, "typed amount")
    }
}
