//! Looking around, which is not a step of the history.
//!
//! Catches: Ctrl+Z that moves the view, a view that jumps on undo or redo of something else, undone
//! steps lost by looking around, a question about saving after looking around.

use egui::{Key, Modifiers, PointerButton, Vec2};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, CommandShift, Either, Lower};
use marraztu_core::scene::Pose;

use crate::editor::Editor;

impl Editor {
    fn pose(&self) -> Pose {
        *self.scene().selected_camera(&self.view()).pose.now()
    }

    /// Drags the view with the left button.
    fn look_around(&mut self) {
        let places = [(0.5, 0.2), (0.55, 0.25), (0.6, 0.2)].map(|(x, y)| self.at(x, y));
        self.drag(PointerButton::Primary, &places);
    }
}

#[test]
fn ctrl_z_undoes_the_last_change_and_keeps_the_view() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let before = editor.scene().objects.clone();
    editor.press(Lower(Key::X));
    let moved = editor.scene().objects.clone();
    let first = editor.pose();
    editor.look_around();
    editor.perform_all(&[Action::FrameAll, Action::LookTop]);
    let seen = editor.pose();
    assert_ne!(seen, first);
    assert_eq!(editor.steps(), 1);
    editor.press(Command(Key::Z));
    assert!(editor.scene().objects == before);
    assert_eq!(editor.pose(), seen);
    editor.look_around();
    let seen = editor.pose();
    editor.press(CommandShift(Key::Z));
    assert!(editor.scene().objects == moved, "looking around loses no undone step");
    assert_eq!(editor.pose(), seen);
}

#[test]
fn steps_that_change_the_camera_otherwise_leave_its_view_alone() {
    let mut editor = Editor::new();
    // Visibility belongs to the camera that looks around.
    editor.perform_all(&[Action::ToggleVisible, Action::ToggleLocked, Action::ToggleLocked]);
    editor.look_around();
    let seen = editor.pose();
    for key in [Command(Key::Z), Command(Key::Z), Command(Key::Z), Command(Key::Y)] {
        editor.press(key);
        assert_eq!(editor.pose(), seen, "{key}");
    }
}

#[test]
fn a_key_that_moves_the_camera_is_undone_bit_by_bit() {
    let mut editor = Editor::new();
    let first = editor.pose();
    editor.press(Lower(Key::Z));
    editor.look_around();
    let seen = editor.pose();
    editor.press(Command(Key::Z));
    assert_eq!(editor.pose(), first);
    editor.press(Command(Key::Y));
    assert_eq!(editor.pose(), seen, "redo brings back where the camera was");
}

#[test]
fn in_analysis_undo_of_a_move_aims_the_camera_from_where_it_is() {
    let mut editor = Editor::new();
    editor.perform_all(&[Action::ToggleFrame, Action::SubjectObject]);
    let scene = editor.scene();
    editor.press(Lower(Key::X));
    editor.look_around();
    let eye = editor.pose().eye;
    editor.press(Command(Key::Z));
    assert!(editor.scene().objects == scene.objects);
    assert_eq!(editor.pose().eye, eye, "it does not jump back");
    let object = editor.scene().objects.get(editor.view().object.unwrap()).unwrap().clone();
    let towards = (object.centre(0.0) - eye).normalize_or_zero();
    assert!((towards + editor.pose().axes.z_axis).length() < 1e-9, "it looks at the object");
    editor.press(Command(Key::Y));
    assert_eq!(editor.pose().eye, eye);
    let object = editor.scene().objects.get(editor.view().object.unwrap()).unwrap().clone();
    let towards = (object.centre(0.0) - eye).normalize_or_zero();
    assert!((towards + editor.pose().axes.z_axis).length() < 1e-9, "redo aims it again");
}

#[test]
fn looking_around_needs_no_saving_and_u_takes_it_back() {
    let mut editor = Editor::new();
    let first = editor.pose();
    editor.look_around();
    editor.hover(editor.at(0.5, 0.2));
    let (unit, modifiers) = (egui::MouseWheelUnit::Line, Modifiers::NONE);
    let (delta, phase) = (Vec2::new(0.0, 1.0), egui::TouchPhase::Move);
    let source = egui::MouseWheelSource::Unknown;
    editor.harness.event(egui::Event::MouseWheel { unit, delta, phase, source, modifiers });
    editor.settle();
    assert!(editor.state().history.is_saved());
    editor.press(Either(Key::U));
    editor.press(Command(Key::Z));
    editor.press(Either(Key::U));
    editor.press(Either(Key::U));
    assert_eq!(editor.pose(), first);
    let mut editor = Editor::new();
    editor.look_around();
    assert!(editor.leaves_by(Command(Key::Q)));
}
