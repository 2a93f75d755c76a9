//! An editor under test, driven by the events that a window system sends.

use std::cell::RefCell;

use egui::{Event, Key, Modifiers, PointerButton, Pos2, pos2};
use egui_kittest::{Harness, kittest::Queryable as _};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord;
use marraztu::app::state::State;
use marraztu::app::{App, actions::Request};
use marraztu_core::edit::Gesture;
use marraztu_core::scene::{Scene, View};
use marraztu_io as io;

/// An editor with the first scene.
pub(crate) struct Editor {
    pub(crate) harness: Harness<'static, App>,
    modifiers: RefCell<Modifiers>,
}

impl Editor {
    pub(crate) fn new() -> Self {
        Self::showing(|ui, app| app.editor_ui(ui))
    }

    /// An editor in a small window, which draws its pictures quickly.
    pub(crate) fn small() -> Self {
        Self::sized(egui::vec2(640.0, 240.0), |ui, app| app.editor_ui(ui))
    }

    /// An editor in a window so tall that its panels need no scrolling.
    pub(crate) fn tall() -> Self {
        Self::sized(egui::vec2(1200.0, 1700.0), |ui, app| app.editor_ui(ui))
    }

    pub(crate) fn of_size(width: f32, height: f32) -> Self {
        Self::sized(egui::vec2(width, height), |ui, app| app.editor_ui(ui))
    }

    /// An editor with an extra panel of buttons for these actions.
    pub(crate) fn with_buttons(actions: &'static [Action]) -> Self {
        Self::sized(egui::vec2(640.0, 240.0), move |ui, app| {
            let mut clicked = None;
            egui::Panel::left("buttons").show(ui, |ui| {
                for action in actions {
                    let button = ui.scope(|ui| action.button(ui, app.state()));
                    clicked = clicked.or(button.inner);
                    let place = button.response.rect.center();
                    ui.data_mut(|data| data.insert_temp(egui::Id::unique(action), place));
                }
            });
            app.editor_ui(ui);
            if let Some(action) = clicked {
                app.perform(ui.ctx(), action, Gesture::Whole);
            }
        })
    }

    pub(crate) fn showing(ui: impl FnMut(&mut egui::Ui, &mut App) + 'static) -> Self {
        Self::sized(egui::vec2(1000.0, 700.0), ui)
    }

    fn sized(size: egui::Vec2, ui: impl FnMut(&mut egui::Ui, &mut App) + 'static) -> Self {
        let (scene, view) = io::default_scene();
        let mut editor = Self {
            harness: Harness::builder()
                .with_size(size)
                .with_step_dt(1.0 / 60.0)
                .with_context_setup(marraztu::app::theme::install)
                .build_ui_state(ui, App::new(scene, view)),
            modifiers: RefCell::default(),
        };
        editor.settle();
        editor
    }

    /// Runs frames until everything requested is done and shown.
    pub(crate) fn settle(&mut self) {
        for _ in 0..2 {
            self.harness.step();
            self.harness.state().wait_for_picture();
        }
        self.harness.step();
        let mut frames = 0;
        while self.harness.state().is_searching() && frames < 1000 {
            std::thread::sleep(std::time::Duration::from_millis(1));
            self.harness.step();
            frames += 1;
        }
        // A new notice is laid out in one frame and shown in the next.
        if frames > 0 {
            self.harness.run_steps(2);
        }
    }

    pub(crate) fn state(&self) -> &State {
        self.harness.state().state()
    }

    pub(crate) fn scene(&self) -> Scene {
        self.state().scene.clone()
    }

    pub(crate) fn view(&self) -> View {
        self.state().view.clone()
    }

    /// The number of steps that can be undone.
    pub(crate) fn steps(&self) -> usize {
        self.state().history.position()
    }

    pub(crate) fn perform(&mut self, action: Action) {
        self.perform_all(&[action]);
    }

    pub(crate) fn perform_all(&mut self, actions: &[Action]) {
        let ctx = self.harness.ctx.clone();
        for action in actions {
            self.harness.state_mut().perform(&ctx, *action, Gesture::Whole);
        }
        self.settle();
    }

    pub(crate) fn ask(&mut self, ask: Request) {
        let ctx = self.harness.ctx.clone();
        self.harness.state_mut().answer(&ctx, ask);
        self.settle();
    }

    /// Presses and releases a key, with the events of a US keyboard.
    pub(crate) fn press(&mut self, chord: Chord) {
        self.hold(chord, 0);
    }

    /// Presses a key, holds it for `repeats` repetitions, and releases it.
    pub(crate) fn hold(&mut self, chord: Chord, repeats: usize) {
        let (key, modifiers, text) = events_of(chord);
        self.set_modifiers(modifiers);
        for _ in 0..=repeats {
            self.key(key, true, modifiers);
            if let Some(text) = &text {
                self.harness.event(Event::Text(text.clone()));
            }
            self.settle();
        }
        self.key(key, false, modifiers);
        self.set_modifiers(Modifiers::NONE);
        self.settle();
    }

    pub(crate) fn key(&self, key: Key, pressed: bool, modifiers: Modifiers) {
        let repeat = false;
        self.harness.event(Event::Key { key, physical_key: None, pressed, repeat, modifiers });
    }

    pub(crate) fn set_modifiers(&self, modifiers: Modifiers) {
        if *self.modifiers.borrow() != modifiers {
            self.harness.event(Event::ModifiersChanged(modifiers));
            *self.modifiers.borrow_mut() = modifiers;
        }
    }

    /// The area of the picture.
    pub(crate) fn picture(&self) -> egui::Rect {
        self.harness.get_by_label("Viewport").rect()
    }

    /// A position in the picture, from (0, 0) upper left to (1, 1) lower right.
    pub(crate) fn at(&self, x: f32, y: f32) -> Pos2 {
        let rect = self.picture();
        pos2(rect.left() + x * rect.width(), rect.top() + y * rect.height())
    }

    pub(crate) fn hover(&mut self, at: Pos2) {
        self.harness.event(Event::PointerMoved(at));
        self.settle();
    }

    pub(crate) fn button(&mut self, at: Pos2, button: PointerButton, pressed: bool) {
        let modifiers = *self.modifiers.borrow();
        self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        self.settle();
    }

    pub(crate) fn click(&mut self, at: Pos2, button: PointerButton) {
        self.hover(at);
        self.button(at, button, true);
        self.button(at, button, false);
        self.settle();
    }

    /// Drags from the first position over the others, and releases at the last.
    pub(crate) fn drag(&mut self, button: PointerButton, places: &[Pos2]) {
        self.hover(places[0]);
        self.button(places[0], button, true);
        for place in &places[1..] {
            self.hover(*place);
        }
        self.button(places[places.len() - 1], button, false);
    }

    /// Clicks the control with this label, the topmost if there are several.
    pub(crate) fn click_label(&mut self, label: &str) {
        let found = self.harness.query_all_by_label(label).last();
        found.unwrap_or_else(|| panic!("nothing is called {label}")).click();
        self.settle();
    }

    /// Clicks a button of the extra panel.
    pub(crate) fn click_button(&mut self, action: Action) {
        let place = self.harness.ctx.data(|data| data.get_temp(egui::Id::unique(action)));
        self.click(place.expect("the panel has this button"), PointerButton::Primary);
    }

    pub(crate) fn shows(&self, label: &str) -> bool {
        self.harness.query_all_by_label_contains(label).next().is_some()
    }
}

/// The key, modifiers and text of a chord, as a keyboard sends them.
pub(crate) fn events_of(chord: Chord) -> (Key, Modifiers, Option<String>) {
    let command = Modifiers { ctrl: true, command: true, ..Modifiers::NONE };
    match chord {
        Chord::Lower(key) | Chord::Either(key) => {
            (key, Modifiers::NONE, Some(key.name().to_lowercase()))
        }
        Chord::Upper(key) => (key, Modifiers::SHIFT, Some(key.name().to_owned())),
        Chord::Named(key) => (key, Modifiers::NONE, None),
        Chord::Shifted(key) => (key, Modifiers::SHIFT, None),
        Chord::Alt(key) => (key, Modifiers::ALT, None),
        Chord::Text("+") => (Key::Plus, Modifiers::SHIFT, Some("+".to_owned())),
        Chord::Text("-") => (Key::Minus, Modifiers::NONE, Some("-".to_owned())),
        Chord::Text(".") => (Key::Period, Modifiers::NONE, Some(".".to_owned())),
        Chord::Text(sign) => (Key::Questionmark, Modifiers::SHIFT, Some(sign.to_owned())),
        Chord::Command(key) => (key, command, None),
        Chord::CommandShift(key) => (key, command | Modifiers::SHIFT, None),
    }
}
