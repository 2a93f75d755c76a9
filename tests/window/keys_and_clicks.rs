//! Keys and clicks of an action have the same effect, and keys act only in the right place.
//!
//! Catches: an action that behaves differently by key, toggles that repeat, undo steps left by a
//! held key, Caps Lock, signs on other layouts, keys that a text field loses.

use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{
    self, Command, CommandShift, Either, Lower, Named, Shifted, Text, Upper,
};
use marraztu::app::actions::Request;
use marraztu::app::panels::Panel;
use marraztu::app::state::Tone;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::{Gesture, items};
use marraztu_core::scene::{Item, ItemId, LightKind, Subject};

use crate::editor::Editor;

/// Situations that may change the effect of an action.
const SITUATIONS: &[&[Action]] = &[
    &[],
    &[Action::SubjectObject],
    &[Action::SubjectObject, Action::Rotate, Action::ToggleFrame, Action::TogglePolygons],
    &[Action::SubjectObject, Action::Scale],
    &[Action::SubjectLight],
    &[Action::SubjectLight, Action::NextItem, Action::NextItem, Action::StepXUp],
    &[Action::ToggleFrame, Action::StepXUp, Action::Undo],
    &[Action::ToggleObserver, Action::AddBulb, Action::AddCameraSpot, Action::Delete],
];

/// Actions that would end the test; other tests cover their dialogs.
const LEFT_OUT: &[Action] = &[Action::Quit];

#[test]
fn every_action_does_the_same_by_each_of_its_keys_and_by_its_button() {
    for situation in SITUATIONS {
        let tried = Action::ALL.chunks(1).filter(|chunk| !LEFT_OUT.contains(&chunk[0]));
        for chunk in tried {
            let action = chunk[0];
            let in_situation = |mut editor: Editor| {
                editor.perform_all(situation);
                editor
            };
            let mut clicked = in_situation(Editor::with_buttons(chunk));
            clicked.click_button(action);
            for key in action.info().keys {
                let mut pressed = in_situation(Editor::small());
                pressed.press(*key);
                let of = format!("{action:?} by {key} after {situation:?}");
                assert!(clicked.scene() == pressed.scene(), "another scene: {of}");
                assert_eq!(clicked.view(), pressed.view(), "{of}");
                let shown = |editor: &Editor| (editor.state().panels, editor.state().theme);
                assert_eq!(shown(&clicked), shown(&pressed), "{of}");
                assert_eq!(clicked.steps(), pressed.steps(), "{of}");
            }
        }
    }
}

#[test]
fn an_action_that_is_refused_says_why_and_changes_nothing() {
    let mut editor = Editor::new();
    let (scene, view) = (editor.scene(), editor.view());
    for key in [Either(Key::S), Text("+"), Lower(Key::Q), Named(Key::Enter), Either(Key::U)] {
        editor.press(key);
        let message = editor.state().message.clone().expect("a reason is given");
        assert_eq!(message.tone, Tone::Refused, "{key}");
        assert!(editor.scene() == scene && editor.view() == view, "{key}");
    }
    assert_eq!(editor.steps(), 0);
}

#[test]
fn a_held_step_repeats_and_is_one_step_of_undo_and_of_u() {
    for undo in [Command(Key::Z), Either(Key::U)] {
        let mut editor = Editor::new();
        let eye = |editor: &Editor| editor.scene().selected_camera(&editor.view()).pose.now().eye;
        let before = eye(&editor);
        editor.hold(Lower(Key::Z), 4);
        assert!((eye(&editor) - before).length() > 49.0, "five steps of ten");
        assert_eq!(editor.steps(), 1);
        editor.press(undo);
        assert_eq!(eye(&editor), before, "{undo}");
    }
}

#[test]
fn two_presses_are_two_steps() {
    let mut editor = Editor::new();
    editor.press(Lower(Key::Z));
    editor.press(Lower(Key::Z));
    assert_eq!(editor.steps(), 2);
}

#[test]
fn keys_repeat_as_the_table_says_and_toggles_never_do() {
    for action in Action::ALL.iter().filter(|action| !LEFT_OUT.contains(action)) {
        let look = action.info();
        let Some(key) = look.keys.first() else { continue };
        let situation = [Action::SubjectLight, Action::NextItem];
        let begin = || {
            let mut editor = Editor::small();
            if matches!(look.group, marraztu::app::actions::Group::Light) {
                situation.into_iter().for_each(|action| editor.perform(action));
            }
            if *action == Action::NextPolygon {
                editor.perform(Action::TogglePolygons);
            }
            editor
        };
        let (mut once, mut held) = (begin(), begin());
        once.press(*key);
        held.hold(*key, 2);
        let same = once.scene() == held.scene()
            && once.view() == held.view()
            && once.state().panels == held.state().panels;
        let acts = once.scene() != begin().scene() || once.view() != begin().view();
        assert!(same || look.repeats, "{action:?} repeats");
        assert!(!(same && acts && look.repeats), "{action:?} does not repeat");
    }
}

#[test]
fn caps_lock_has_no_say() {
    let eye = |editor: &Editor| editor.scene().selected_camera(&editor.view()).pose.now().eye;
    let (mut plain, mut capital) = (Editor::new(), Editor::new());
    plain.press(Lower(Key::Z));
    // With Caps Lock on, only the text event differs.
    capital.key(Key::Z, true, Modifiers::NONE);
    capital.harness.event(Event::Text("Z".to_owned()));
    capital.key(Key::Z, false, Modifiers::NONE);
    capital.settle();
    assert_eq!(eye(&plain), eye(&capital));
}

#[test]
fn plus_and_minus_go_by_the_text_on_every_layout() {
    // A German keyboard has a separate + key, which egui reports as Plus or another key. The key
    // that egui calls Minus types a sharp s there.
    let spot = |editor: &Editor| {
        let lights = editor.scene().lights;
        lights.iter().find_map(|(_, light)| match light.kind {
            LightKind::Spot { half_aperture, .. } => Some(half_aperture),
            _ => None,
        })
    };
    let mut editor = Editor::new();
    editor.perform(Action::SubjectLight);
    editor.perform(Action::NextItem);
    editor.perform(Action::NextItem);
    let before = spot(&editor).unwrap();
    editor.key(Key::CloseBracket, true, Modifiers::NONE);
    editor.harness.event(Event::Text("+".to_owned()));
    editor.key(Key::CloseBracket, false, Modifiers::NONE);
    editor.settle();
    assert_eq!(spot(&editor), Some(before + 5.0));
    editor.key(Key::Minus, true, Modifiers::NONE);
    editor.harness.event(Event::Text("ß".to_owned()));
    editor.key(Key::Minus, false, Modifiers::NONE);
    editor.settle();
    assert_eq!(spot(&editor), Some(before + 5.0), "Minus that types something else is no -");
}

#[test]
fn a_sign_that_needs_shift_acts_again_if_shift_was_let_go_first() {
    let mut editor = Editor::new();
    let event = |editor: &Editor, key, pressed, modifiers| {
        let physical_key = Some(Key::Equals);
        let event = Event::Key { key, physical_key, pressed, repeat: false, modifiers };
        editor.harness.event(event);
    };
    let with_shift = Modifiers { shift: true, ..Modifiers::CTRL | Modifiers::COMMAND };
    for presses in 1..4_u8 {
        event(&editor, Key::Plus, true, with_shift);
        editor.settle();
        event(&editor, Key::Equals, false, Modifiers::CTRL | Modifiers::COMMAND);
        editor.settle();
        let zoom = editor.state().zoom;
        assert!((zoom - (1.0 + 0.1 * f32::from(presses))).abs() < 1e-3, "{zoom}");
    }
}

#[test]
fn signs_under_alt_ask_for_nothing() {
    let mut editor = Editor::new();
    let before = editor.view();
    editor.set_modifiers(Modifiers::ALT);
    editor.key(Key::Questionmark, true, Modifiers::ALT);
    editor.harness.event(Event::Text("?".to_owned()));
    editor.key(Key::Questionmark, false, Modifiers::ALT);
    editor.set_modifiers(Modifiers::NONE);
    editor.settle();
    assert!(!editor.state().panels.has(Panel::CheatSheet));
    assert_eq!(editor.view(), before);
}

#[test]
fn tab_enter_and_arrows_stay_in_the_viewport_from_the_first_frame_on() {
    let mut editor = Editor::with_buttons(Action::ALL);
    editor.perform(Action::SubjectObject);
    let first = editor.view().object;
    for expected in [false, false, true] {
        editor.press(Named(Key::Tab));
        assert_eq!(editor.view().object == first, expected, "three objects, round and round");
    }
    let shown = editor.state().panels;
    for key in [Key::ArrowUp, Key::ArrowLeft, Key::Space] {
        editor.press(Named(key));
    }
    editor.press(Named(Key::Tab));
    assert_ne!(editor.view().object, first, "the viewport still has the keyboard");
    assert_eq!(editor.state().panels, shown);
}

/// An editor next to a text field.
fn with_text_field() -> Editor {
    let mut text = String::new();
    Editor::showing(move |ui, app| {
        egui::Panel::left("field").show(ui, |ui| {
            let label = ui.label("Words");
            ui.text_edit_singleline(&mut text).labelled_by(label.id);
        });
        app.editor_ui(ui);
    })
}

#[test]
fn typing_into_a_text_field_triggers_no_action() {
    let mut editor = with_text_field();
    editor.press(Lower(Key::Z));
    let (scene, view, shown) = (editor.scene(), editor.view(), editor.state().panels);
    let steps = editor.steps();
    editor.harness.get_by_role(egui::Role::TextInput).click();
    editor.settle();
    let typed = Action::ALL.iter().flat_map(|action| action.info().keys);
    let harmless = |key: &&Chord| {
        !matches!(key, Command(_) | CommandShift(_) | Named(_) | Shifted(_))
            || **key == Command(Key::Z)
    };
    for key in typed.filter(harmless) {
        editor.press(*key);
    }
    assert!(editor.scene() == scene, "not even Ctrl+Z, which is the field's own");
    assert_eq!((editor.view(), editor.state().panels, editor.steps()), (view, shown, steps));
    let field = editor.harness.get_by_role(egui::Role::TextInput);
    assert!(field.value().is_some_and(|text| !text.is_empty()), "the field got it");
}

#[test]
fn esc_in_a_text_field_gives_the_keyboard_back_and_does_not_leave() {
    let mut editor = with_text_field();
    editor.press(Lower(Key::Z));
    editor.harness.get_by_role(egui::Role::TextInput).click();
    editor.settle();
    editor.press(Named(Key::Escape));
    assert!(!editor.shows("Save the scene?"));
    editor.press(Lower(Key::Z));
    assert_eq!(editor.steps(), 2, "the viewport has the keyboard again");
}

#[test]
fn undo_and_redo_walk_through_everything_that_changes_the_scene() {
    let mut editor = Editor::new();
    let mut scenes = vec![editor.scene()];
    let actions = [
        Action::StepXUp,
        Action::TakeBack,
        Action::Light2,
        Action::AddBulb,
        Action::Duplicate,
        Action::Delete,
        Action::ToggleVisible,
    ];
    for action in actions {
        editor.perform(action);
        assert_eq!(editor.steps(), scenes.len(), "{action:?} is one step");
        scenes.push(editor.scene());
    }
    for scene in scenes.iter().rev().skip(1) {
        editor.press(Command(Key::Z));
        assert!(editor.scene() == *scene);
    }
    for (at, scene) in scenes.iter().enumerate().skip(1) {
        editor.press(if at % 2 == 0 { CommandShift(Key::Z) } else { Command(Key::Y) });
        assert!(editor.scene() == *scene);
    }
}

#[test]
fn selection_and_view_are_not_undo_steps() {
    let mut editor = Editor::new();
    for key in [Lower(Key::C), Named(Key::Tab), Either(Key::L), Either(Key::O), Upper(Key::C)] {
        editor.press(key);
    }
    assert_eq!(editor.steps(), 0);
    assert!(editor.state().history.is_saved());
}

#[test]
fn a_new_item_is_selected_and_removing_it_selects_the_next() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let ids: Vec<_> = editor.scene().objects.ids().collect();
    editor.press(Command(Key::D));
    let copy = editor.view().object.unwrap();
    assert!(!ids.contains(&copy));
    editor.press(Named(Key::Delete));
    assert_eq!(editor.view().object, Some(ids[0]));
    for _ in ids {
        editor.press(Named(Key::Delete));
    }
    assert_eq!((editor.view().object, editor.scene().objects.len()), (None, 0));
    editor.press(Upper(Key::C));
    assert!(editor.state().message.is_some(), "there is no object to look from");
}

#[test]
fn a_renamed_item_has_its_name_and_a_name_of_blanks_is_refused() {
    let mut editor = Editor::new();
    let id = ItemId::Camera(editor.view().camera);
    let mut rename = |name: &str| {
        editor.press(Named(Key::F2));
        assert_eq!(editor.state().renaming, Some(id));
        editor.press(Command(Key::A));
        editor.harness.event(Event::Text(name.to_owned()));
        editor.settle();
        editor.press(Named(Key::Enter));
        (editor.state().name(id).map(str::to_owned), editor.state().renaming)
    };
    assert_eq!(rename("  eye "), (Some("eye".to_owned()), None));
    assert_eq!(rename("  "), (Some("eye".to_owned()), None));
}

#[test]
fn a_slider_changed_by_a_drag_is_one_step_of_undo_with_the_frame_in_which_it_is_let_go() {
    let mut editor = Editor::showing(|ui, app| {
        let mut ask = None;
        egui::Panel::left("properties of mine").show(ui, |ui| {
            let (scene, view) = (&app.state().scene, &app.state().view);
            let id = view.light.unwrap();
            let mut red = scene.lights.get(id).unwrap().color.0[0];
            let slider = ui.add(egui::Slider::new(&mut red, 0..=255).text("Red"));
            if slider.changed() {
                let gesture = marraztu::app::widgets::gestures::of(&slider);
                let command = items::change_light(scene, id, |light| light.color.0[0] = red);
                let (command, label) = (command.unwrap(), "Red".to_owned());
                ask = Some(Request::Change { command, gesture, label });
            }
        });
        app.editor_ui(ui);
        if let Some(ask) = ask {
            app.answer(ui.ctx(), ask);
        }
    });
    let before = editor.scene();
    let slider = editor.harness.get_by_role(egui::Role::Slider).rect();
    let at = |part: f32| egui::pos2(slider.left() + part * slider.width(), slider.center().y);
    for round in 1..=2 {
        editor.harness.drag_at(at(0.1));
        editor.harness.step();
        for part in [0.2, 0.4, 0.6, 0.5] {
            editor.harness.hover_at(at(part));
            editor.harness.step();
        }
        // The pointer still moves while the button is released, as it does in practice.
        editor.harness.drop_at(at(0.3));
        editor.settle();
        assert_eq!(editor.steps(), round, "a second drag is a second step");
    }
    editor.press(Command(Key::Z));
    editor.press(Command(Key::Z));
    assert!(editor.scene() == before);
}

#[test]
fn keys_act_again_after_a_slider_was_dragged() {
    let mut value = 0.5;
    let mut editor = Editor::showing(move |ui, app| {
        egui::Panel::left("slider").show(ui, |ui| {
            ui.add(egui::Slider::new(&mut value, 0.0..=1.0).text("Value"));
        });
        app.editor_ui(ui);
    });
    let slider = editor.harness.get_by_role(egui::Role::Slider).rect();
    editor.drag(egui::PointerButton::Primary, &[slider.left_center(), slider.center()]);
    editor.press(Lower(Key::Z));
    assert_eq!(editor.steps(), 1);
}

#[test]
fn a_spinning_object_follows_the_clock_without_undo_steps() {
    let mut editor = Editor::new();
    let id = editor.view().object.unwrap();
    let mut object = editor.scene().objects.get(id).unwrap().clone();
    object.spin.axes[Axis::Y.index()] = true;
    let command = marraztu_core::scene::Command::Replace(Item::Object(id, Box::new(object)));
    let (gesture, label) = (Gesture::Whole, "Spin".to_owned());
    let begin = editor.view().time;
    editor.ask(Request::Change { command, gesture, label });
    let pictures = editor.state().statistics.pictures;
    editor.settle();
    assert!(editor.view().time > begin);
    assert!(editor.state().statistics.pictures > pictures);
    assert_eq!(editor.steps(), 1);
}

#[test]
fn a_scene_that_stays_as_it_is_is_drawn_once() {
    let mut editor = Editor::new();
    editor.settle();
    let pictures = editor.state().statistics.pictures;
    editor.press(Lower(Key::C));
    editor.settle();
    assert_eq!(editor.state().statistics.pictures, pictures);
    editor.press(Lower(Key::Z));
    assert_eq!(editor.state().statistics.pictures, pictures + 1);
    assert_eq!(editor.view().subject, Subject::Object);
}

#[test]
fn the_panels_get_the_keyboard_by_f6_and_give_it_back_by_esc() {
    let mut editor = Editor::new();
    editor.press(Lower(Key::Z));
    let is_focused = |editor: &Editor| editor.harness.get_by_label("Viewport").is_focused();
    for way_back in [Key::Escape; 2] {
        assert!(is_focused(&editor));
        editor.press(Named(Key::F6));
        assert!(!is_focused(&editor));
        let view = editor.view();
        for key in [Named(Key::Tab), Named(Key::Tab), Named(Key::Tab), Lower(Key::C)] {
            editor.press(key);
        }
        assert!(!is_focused(&editor), "Tab goes on in the panels");
        assert_eq!(editor.view(), view, "letters ask for nothing there");
        editor.press(Named(way_back));
        assert!(!editor.shows("Save the scene?"));
    }
    editor.press(Lower(Key::C));
    assert_eq!(editor.view().subject, Subject::Object);
}
