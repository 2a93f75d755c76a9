//! Every action is in a menu and in the palette, with the same effect in both.
//!
//! Catches: an action without an entry, an entry with another effect than its label, a menu taller
//! than the window.

use egui::Key;
use egui::accesskit::Role;
use egui_kittest::kittest::{By, NodeT as _, Queryable as _};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Named};

use crate::editor::Editor;
use crate::palette::listed;
use crate::panels::{click, type_text};

/// The paths of all menus and submenus.
const PATHS: [&[&str]; 15] = [
    &["File"],
    &["Edit"],
    &["Edit", "Select"],
    &["Edit", "Transform"],
    &["Edit", "History"],
    &["Add"],
    &["View"],
    &["View", "Over the picture"],
    &["View", "Camera"],
    &["View", "Light"],
    &["View", "Lights on and off"],
    &["Window"],
    &["Window", "Size"],
    &["Window", "Theme"],
    &["Help"],
];

/// The subjects for which each action is tried.
const SUBJECTS: [Action; 2] = [Action::SubjectObject, Action::SubjectLight];

fn open(editor: &mut Editor, path: &[&str]) {
    for (depth, name) in path.iter().enumerate() {
        click(editor, if depth == 0 { Role::Button } else { Role::MenuItem }, name);
        // Submenus open after a delay.
        editor.harness.run_steps(30);
    }
}

/// The entries of the open menus.
fn entries(editor: &Editor) -> Vec<(String, egui::Rect)> {
    let all = [Role::MenuItem, Role::MenuItemCheckBox]
        .into_iter()
        .flat_map(|role| editor.harness.query_all(By::new().role(role)));
    all.filter_map(|it| Some((it.accesskit_node().label()?, it.rect()))).collect()
}

/// The observable result of an action.
fn done(editor: &Editor) -> impl PartialEq + std::fmt::Debug + use<> {
    let state = editor.state();
    let shown = (state.panels, state.theme, state.overlays, state.gizmo, state.helpers);
    let modes = (state.aiming, state.explaining, state.renaming, state.others());
    // A search on a thread reports its result when it ends; that message is ignored.
    let told = state.message.clone().filter(|it| !it.text.contains("is in the picture"));
    (editor.view(), editor.steps(), shown, modes, told, state.zoom, state.settings)
}

/// Actions that quit the program, or open a system dialog in a window without one.
const LEFT_OUT: [Action; 2] = [Action::Quit, Action::CopyPicture];

#[test]
fn every_action_is_in_a_menu_with_the_same_effect() {
    let mut missing: Vec<Action> = Action::ALL.to_vec();
    for path in PATHS {
        let mut editor = Editor::of_size(900.0, 640.0);
        open(&mut editor, path);
        // The actions in this menu. A label that names a submenu is not an action.
        let here = entries(&editor);
        let is_menu = |label: &str| {
            PATHS.iter().any(|it| it.len() > 1 && it[0] == path[0] && it.last() == Some(&label))
        };
        let is_here = |action: &&Action| {
            let label = action.info().label;
            here.iter().any(|(other, _)| other == label) && !is_menu(label)
        };
        missing.retain(|action| !is_here(&action));
        for action in Action::ALL.iter().filter(is_here).filter(|it| !LEFT_OUT.contains(it)) {
            // Performs the action directly.
            let subject = SUBJECTS[0];
            // A fitted exposure depends on the size of the picture.
            let mut asked = Editor::of_size(900.0, 640.0);
            asked.perform(subject);
            if action.availability(asked.state()).is_err() {
                continue;
            }
            asked.perform(*action);
            // Performs it by a click in the menu, in a second editor.
            let mut clicked = Editor::of_size(900.0, 640.0);
            clicked.perform(subject);
            open(&mut clicked, path);
            let label = action.info().label;
            let is_it = |node: &egui_kittest::Node<'_>| {
                let role = node.accesskit_node().role();
                matches!(role, Role::MenuItem | Role::MenuItemCheckBox)
            };
            let entry = clicked.harness.query_all_by_label(label).find(is_it).unwrap();
            entry.click();
            clicked.settle();
            assert_eq!(done(&clicked), done(&asked), "{action:?} in {path:?}");
            assert!(clicked.scene() == asked.scene(), "{action:?} in {path:?}");
        }
    }
    assert!(missing.is_empty(), "in no menu: {missing:?}");
}

#[test]
fn every_action_is_in_the_palette_with_the_same_effect() {
    for subject in SUBJECTS {
        let tried = |it: &&Action| **it != Action::Palette && !LEFT_OUT.contains(it);
        for action in Action::ALL.iter().filter(tried) {
            let mut asked = Editor::small();
            asked.perform_all(&[subject, *action]);
            let mut chosen = Editor::small();
            chosen.perform(subject);
            chosen.press(Command(Key::K));
            type_text(&mut chosen, action.info().label);
            let place = listed(&chosen).iter().position(|label| label == action.info().label);
            let place = place.unwrap_or_else(|| panic!("{action:?} is not found by its label"));
            assert!(place < 4, "{action:?} is the {place}th for its own label");
            for _ in 0..place {
                chosen.press(Named(Key::ArrowDown));
            }
            chosen.press(Named(Key::Enter));
            assert_eq!(done(&chosen), done(&asked), "{action:?} with {subject:?}");
            assert!(chosen.scene() == asked.scene(), "{action:?} with {subject:?}");
        }
    }
}

/// The texts and the narrow upright rectangles on the screen, such as scroll bars.
fn texts_and_bars(editor: &Editor) -> (Vec<(String, egui::Rect)>, Vec<egui::Rect>) {
    fn collect(
        shape: &egui::Shape,
        texts: &mut Vec<(String, egui::Rect)>,
        bars: &mut Vec<egui::Rect>,
    ) {
        match shape {
            egui::Shape::Vec(all) => all.iter().for_each(|shape| collect(shape, texts, bars)),
            egui::Shape::Text(text) => {
                texts.push((text.galley.text().to_owned(), text.visual_bounding_rect()));
            }
            egui::Shape::Rect(bar)
                if (2.0..16.0).contains(&bar.rect.width()) && bar.rect.height() > 40.0 =>
            {
                bars.push(bar.rect);
            }
            _ => {}
        }
    }
    let (mut texts, mut bars) = (Vec::new(), Vec::new());
    let shapes = &editor.harness.output().shapes;
    shapes.iter().for_each(|it| collect(&it.shape, &mut texts, &mut bars));
    (texts, bars)
}

#[test]
fn the_scroll_bar_of_a_menu_covers_no_key() {
    let mut editor = Editor::of_size(640.0, 400.0);
    open(&mut editor, &["File"]);
    // The bar shows while the pointer is over the menu.
    let entry = entries(&editor)[2].1.center();
    editor.hover(entry);
    editor.harness.run_steps(20);
    let (texts, bars) = texts_and_bars(&editor);
    let keys: Vec<_> = texts.iter().filter(|(text, _)| text.starts_with("Ctrl+")).collect();
    assert!(keys.len() > 3 && !bars.is_empty(), "{keys:?} {bars:?}");
    for (key, rect) in keys {
        let covered = bars.iter().any(|bar| bar.intersects(*rect));
        assert!(!covered, "{key} at {rect}: {bars:?}");
    }
}

#[test]
fn every_menu_fits_into_a_low_window() {
    for size in [[1024.0, 640.0], [640.0, 400.0]] {
        for path in PATHS {
            let mut editor = Editor::of_size(size[0], size[1]);
            open(&mut editor, path);
            let last = entries(&editor)
                .into_iter()
                .max_by(|(_, a), (_, b)| a.bottom().total_cmp(&b.bottom()));
            if let Some((label, rect)) = last {
                // A menu clips entries that are scrolled out of view; the menu itself is in the
                // window.
                let limit = if size[1] < 500.0 { f32::INFINITY } else { size[1] };
                assert!(rect.bottom() <= limit, "{label} of {path:?} at {rect:?} in {size:?}");
            }
        }
    }
}
