//! The layout of the window: nothing overlaps, and no text is cut off.
//!
//! Catches: a panel that draws outside its area, a label without room, a panel that stays small
//! when its window grows again, a long name that displaces controls.

use egui::{Rect, Shape};
use egui_kittest::kittest::Queryable as _;
use marraztu::app::actions::{Action, Request};
use marraztu::app::panels::{OpenPanels, Panel};
use marraztu_core::edit::{Gesture, items};
use marraztu_core::scene::ItemId;

use crate::editor::Editor;

/// Window sizes in points: 640 x 400, 1024 x 640, 1280 x 800 and 1920 x 1080 pixels at 100%, 150%
/// and 200%.
const SIZES: [[f32; 2]; 11] = [
    [1920.0, 1080.0],
    [1280.0, 720.0],
    [1280.0, 800.0],
    [960.0, 540.0],
    [853.0, 533.0],
    [683.0, 427.0],
    [1024.0, 640.0],
    [512.0, 320.0],
    [640.0, 400.0],
    [427.0, 267.0],
    [320.0, 200.0],
];

/// A text on the screen.
struct Text {
    text: String,
    /// The area of the text, and the visible part of the window around it.
    rect: Rect,
    clip: Rect,
    elided: bool,
}

fn collect(shape: &Shape, clip: Rect, texts: &mut Vec<Text>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| collect(shape, clip, texts)),
        Shape::Text(text) if !text.galley.text().trim().is_empty() => texts.push(Text {
            text: text.galley.text().to_owned(),
            rect: text.visual_bounding_rect(),
            clip,
            elided: text.galley.elided,
        }),
        _ => {}
    }
}

/// The texts outside the picture.
fn texts(editor: &Editor) -> Vec<Text> {
    let picture = editor.picture();
    let mut texts = Vec::new();
    for clipped in &editor.harness.output().shapes {
        collect(&clipped.shape, clipped.clip_rect, &mut texts);
    }
    texts.retain(|text| {
        let seen = text.rect.intersect(text.clip);
        seen.width() > 0.5 && seen.height() > 0.5 && !picture.expand(1.0).contains_rect(seen)
    });
    texts
}

/// Lists texts that are cut off or overlap. Names given by the user may end in an ellipsis.
fn faults(editor: &Editor, names: &[&str], sideways: bool) -> Vec<String> {
    let all = texts(editor);
    let is_name = |text: &str| {
        let head = text.split("...").next().unwrap_or(text);
        text.contains("...  |")
            || names.iter().any(|name| text.contains(name) || name.contains(head))
    };
    let mut faults = Vec::new();
    for (i, one) in all.iter().enumerate() {
        let seen = one.rect.intersect(one.clip);
        if one.elided && !is_name(&one.text) {
            faults.push(format!("{:?} ends in dots", one.text));
        }
        if one.rect.width() - seen.width() > 1.0 && !sideways {
            faults.push(format!("{:?} is cut off: {} of {}", one.text, seen, one.rect));
        }
        for other in &all[i + 1..] {
            let both = seen.intersect(other.rect.intersect(other.clip));
            if both.width() > 2.0 && both.height() > 3.0 {
                faults.push(format!("{:?} and {:?} share {both}", one.text, other.text));
            }
        }
    }
    faults
}

fn resize(editor: &mut Editor, [width, height]: [f32; 2]) {
    editor.harness.set_size(egui::vec2(width, height));
    editor.settle();
    editor.harness.run_steps(2);
}

fn check(editor: &Editor, names: &[&str], what: &str) {
    let [width, height] = editor.harness.ctx.content_rect().size().into();
    // Tables without room scroll sideways.
    let found = faults(editor, names, width < 900.0);
    assert!(found.is_empty(), "{what} in {width} x {height}:\n{}", found.join("\n"));
}

/// The panels that a narrow window shows one at a time.
const COLUMNS: [Action; 3] =
    [Action::Panel(Panel::Outline), Action::Panel(Panel::View), Action::Panel(Panel::Properties)];

fn check_all(editor: &mut Editor, names: &[&str]) {
    for size in SIZES {
        resize(editor, size);
        for subject in [Action::SubjectCamera, Action::SubjectObject, Action::SubjectLight] {
            editor.perform(subject);
            check(editor, names, "panels");
        }
        if editor.state().narrow {
            for action in COLUMNS {
                editor.perform(action);
                check(editor, names, action.info().label);
            }
            editor.perform(COLUMNS[2]);
        }
        editor.perform_all(&[Action::Panel(Panel::Plan), Action::Panel(Panel::Laboratory)]);
        editor.settle();
        check(editor, names, "plan and laboratory");
        editor.perform_all(&[Action::Panel(Panel::Plan), Action::Panel(Panel::Laboratory)]);
    }
}

#[test]
fn in_every_window_panels_lie_side_by_side_and_texts_are_whole() {
    check_all(&mut Editor::of_size(1280.0, 800.0), &[]);
}

#[test]
fn long_and_foreign_names_push_nothing_aside() {
    const NAMES: [&str; 2] = [
        "a_very_long_name_of_an_object_that_no_panel_has_room_for_whatever_its_width_may_be",
        "Žluťoučký kůň, ελληνικά, русский, Übergröße und noch viel mehr als das, was Platz hat",
    ];
    let mut editor = Editor::of_size(1280.0, 800.0);
    let scene = editor.scene();
    let camera = scene.cameras.ids().next().map(ItemId::Camera);
    let light = scene.lights.ids().next().map(ItemId::Light);
    let object = scene.objects.ids().next().map(ItemId::Object);
    for (id, name) in [(object, NAMES[0]), (camera, NAMES[1]), (light, NAMES[0])] {
        let command = items::rename(&editor.scene(), id.unwrap(), name).unwrap();
        let label = "Rename".to_owned();
        editor.ask(Request::Change { command, gesture: Gesture::Whole, label });
    }
    check_all(&mut editor, &NAMES);
}

#[test]
fn a_window_that_shrank_and_grew_has_its_panels_back() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    let place = |editor: &Editor, name: &str| editor.harness.get_by_label(name).rect();
    let before = (editor.picture(), place(&editor, "Height of the view switches"));
    editor.perform_all(&[Action::Panel(Panel::Plan), Action::Panel(Panel::Laboratory)]);
    let open = (editor.picture(), place(&editor, "Height of the laboratory"));
    for size in [[640.0, 400.0], [320.0, 200.0], [1024.0, 640.0], [1280.0, 800.0]] {
        resize(&mut editor, size);
    }
    assert_eq!((editor.picture(), place(&editor, "Height of the laboratory")), open);
    editor.perform_all(&[Action::Panel(Panel::Plan), Action::Panel(Panel::Laboratory)]);
    assert_eq!((editor.picture(), place(&editor, "Height of the view switches")), before);
}

#[test]
fn a_splitter_is_dragged_and_a_double_click_puts_it_back() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    let before = editor.picture();
    let grip = editor.harness.get_by_label("Width of the properties").rect().center();
    editor.drag(egui::PointerButton::Primary, &[grip, grip - egui::vec2(60.0, 0.0)]);
    assert_eq!(editor.picture().width(), before.width() - 60.0);
    assert_eq!(editor.steps(), 0, "a size is no step");
    let grip = grip - egui::vec2(60.0, 0.0);
    editor.harness.run_steps(60);
    editor.click(grip, egui::PointerButton::Primary);
    editor.click(grip, egui::PointerButton::Primary);
    assert_eq!(editor.picture(), before);
}

#[test]
fn a_narrow_window_shows_the_picture_with_one_panel_at_a_time() {
    let mut editor = Editor::of_size(640.0, 400.0);
    let whole = editor.picture().width();
    assert!(whole > 580.0, "panels are folded: {whole}");
    for action in COLUMNS {
        editor.click_label(action.info().label);
        assert_eq!(action.is_on(editor.state()), Some(true), "{action:?}");
        let on = COLUMNS.iter().filter(|other| other.is_on(editor.state()) == Some(true));
        assert_eq!(on.count(), 1);
        assert!(editor.picture().width() < whole - 200.0);
    }
    editor.click_label(COLUMNS[2].info().label);
    assert_eq!(editor.picture().width(), whole);
}

#[test]
fn a_presentation_shows_the_picture_in_large_type_and_gives_everything_back() {
    let mut editor = Editor::of_size(1400.0, 1000.0);
    let (panels, window) = (editor.state().panels, editor.state().window());
    let (before, zoom) = (editor.picture(), editor.state().zoom);
    assert!(editor.shows("File") && panels != OpenPanels::NONE);
    for end in [Action::Escape, Action::Present] {
        editor.perform(Action::Present);
        editor.settle();
        assert!(!editor.shows("File") && editor.shows("ends the presentation"));
        assert_eq!(editor.state().panels, OpenPanels::NONE);
        assert_eq!(editor.state().window(), window, "a scene that is saved keeps its panels");
        assert!(editor.state().zoom > 1.4 * zoom);
        // A key still opens a panel.
        editor.perform(Action::Panel(Panel::Plan));
        assert!(editor.state().panels.has(Panel::Plan));
        editor.perform(end);
        editor.settle();
        assert_eq!((editor.state().panels, editor.state().zoom), (panels, zoom), "{end:?}");
        assert_eq!(editor.picture(), before);
    }
}
