//! The keyboard in the panels: F6 from region to region, Tab within one, arrows within a group.
//!
//! Catches: a control that no key reaches, a group of choices with a stop for each choice, a focus
//! out of view.

use std::collections::BTreeSet;

use egui::accesskit::{Action as Deed, Role};
use egui::{Key, Rect};
use egui_kittest::kittest::{By, NodeT as _, Queryable as _};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{self, Named};

use crate::editor::Editor;

/// The largest number of Tab presses from the start of a region to any of its controls.
const MOST: usize = 15;

/// Name and area of the control with the keyboard focus.
fn focused(editor: &Editor) -> Option<(String, Rect)> {
    let all = editor.harness.query_all(By::new().predicate(|node| node.is_focused()));
    let node = all.last()?;
    Some((node.accesskit_node().label().unwrap_or_default(), node.rect()))
}

/// The names of all controls that can have the focus.
fn stops(editor: &Editor) -> BTreeSet<String> {
    let all = editor.harness.query_all(
        By::new().predicate(|node| node.data().supports_action(Deed::Focus) && !node.is_disabled()),
    );
    all.filter_map(|node| node.accesskit_node().label()).filter(|name| !name.is_empty()).collect()
}

fn press(editor: &mut Editor, key: Key) {
    editor.key(key, true, egui::Modifiers::NONE);
    editor.harness.run_steps(2);
    editor.key(key, false, egui::Modifiers::NONE);
    editor.harness.run_steps(2);
}

/// Collects the controls that F6 and then at most 15 presses of Tab reach, region by region.
fn reached(editor: &mut Editor) -> BTreeSet<String> {
    let window = editor.harness.ctx.content_rect();
    let (mut reached, mut firsts) = (BTreeSet::new(), Vec::new());
    for region in 1..40 {
        editor.press(Named(Key::Escape));
        editor.settle();
        let view = editor.harness.get_by_label("Viewport").rect();
        editor.click(view.left_bottom() + egui::vec2(30.0, -30.0), egui::PointerButton::Primary);
        for _ in 0..region {
            press(editor, Key::F6);
        }
        match focused(editor) {
            Some((name, _)) if name == "Viewport" => return reached,
            None => panic!("nothing has the keyboard after F6 x {region}"),
            Some((name, _)) => firsts.push(name),
        }
        for tabs in 0..=MOST {
            if let Some((name, rect)) = focused(editor) {
                if name == "Viewport" {
                    // There, Tab selects the next light or object.
                    reached.insert(name);
                    break;
                }
                assert!(window.contains_rect(rect.shrink(1.0)), "{name} is out of sight: {rect}");
                reached.insert(name);
            }
            if tabs < MOST {
                press(editor, Key::Tab);
            }
        }
    }
    panic!("F6 never comes back to the viewport: {firsts:?}");
}

#[test]
fn every_control_is_within_fifteen_tabs_of_a_region_that_f6_goes_to() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    for subject in [Action::SubjectObject, Action::SubjectLight] {
        editor.perform(subject);
        let all = stops(&editor);
        assert!(all.len() > 40, "{all:?}");
        let reached = reached(&mut editor);
        let missed: Vec<&String> = all.difference(&reached).collect();
        assert!(missed.is_empty(), "{subject:?}: no key reaches {missed:?}");
    }
}

#[test]
fn shift_f6_goes_the_same_regions_backwards() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    let names = |editor: &mut Editor, chord: Chord| {
        let at = editor.at(0.1, 0.9);
        editor.click(at, egui::PointerButton::Primary);
        let mut names = Vec::new();
        for _ in 0..40 {
            editor.press(chord);
            match focused(editor) {
                Some((name, _)) if name != "Viewport" => names.push(name),
                _ => break,
            }
        }
        names
    };
    let forwards = names(&mut editor, Named(Key::F6));
    let mut backwards = names(&mut editor, Chord::Shifted(Key::F6));
    backwards.reverse();
    assert!(forwards.len() > 4);
    assert_eq!(forwards, backwards);
}

#[test]
fn a_group_of_choices_is_one_stop_and_the_arrows_go_through_it() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    let radios = editor.harness.query_all(By::new().role(Role::RadioButton)).count();
    let stops = editor.harness.query_all(By::new().predicate(|node| {
        node.role() == Role::RadioButton && node.data().supports_action(Deed::Focus)
    }));
    let stops = stops.count();
    assert!(stops >= 10 && stops * 3 < radios, "{stops} stops of {radios}");
    while focused(&editor).is_none_or(|(name, _)| name != "Keys act on") {
        press(&mut editor, Key::F6);
    }
    press(&mut editor, Key::Tab);
    let name = |editor: &Editor| focused(editor).unwrap().0;
    assert_eq!(name(&editor), "Subject: Camera");
    press(&mut editor, Key::ArrowRight);
    assert_eq!(name(&editor), "Subject: Object");
    assert_eq!(Action::SubjectCamera.is_on(editor.state()), Some(true), "nothing is chosen yet");
    press(&mut editor, Key::Enter);
    assert_eq!(Action::SubjectObject.is_on(editor.state()), Some(true));
    press(&mut editor, Key::Tab);
    assert_eq!(name(&editor), "Transformation: Move");
}
