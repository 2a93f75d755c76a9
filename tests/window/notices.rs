//! Notices, and the up axis that the notice of an opened model offers.
//!
//! Catches: notices that stay over the picture, vanish under the pointer or get lost; harmless
//! findings worded like faults; models that lie on their side.

use std::path::Path;

use egui::Key;
use egui::accesskit::Role;
use egui_kittest::kittest::{By, NodeT as _, Queryable as _};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Named};
use marraztu::app::actions::Request;
use marraztu::app::state::Notice;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{ItemId, UpAxis};
use marraztu_io as io;
use marraztu_render::{Renderer, plan_frame};

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;
use crate::panels::{click, control};

impl Editor {
    /// Replaces the first scene by a model that opens alone.
    fn open_alone(&mut self, path: &Path) {
        let count = self.state().notices.len() + self.state().past_notices.len();
        self.drop_files(&[path]);
        self.wait_until(|editor| {
            editor.state().notices.len() + editor.state().past_notices.len() > count
        });
        self.settle();
    }

    fn up(&self) -> UpAxis {
        let scene = self.scene();
        let (_, object) = scene.objects.iter().next().unwrap();
        object.model.options.up
    }

    /// The maximum y of the first object.
    fn top(&self) -> f64 {
        let scene = self.scene();
        let (_, object) = scene.objects.iter().next().unwrap();
        marraztu_core::edit::arrange::world_box(object, 0.0).unwrap().max.y
    }
}

/// A tower of height 5 along Z.
const TOWER: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n\
    v 0 0 5\nv 1 0 5\nv 1 1 5\nv 0 1 5\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// A face of height 5 along Z.
const TOWER_STL: &str = "solid tower\nfacet normal 0 1 0\nouter loop\n\
    vertex 0 0 0\nvertex 0 0 5\nvertex 1 0 0\nendloop\nendfacet\nendsolid tower\n";

#[test]
fn a_notice_that_needs_no_answer_goes_to_the_status_line_and_is_listed_there() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    assert!(editor.shows("Opened cube: 6 faces, 8 vertices"), "it is no list of findings");
    editor.harness.run_steps(400);
    assert!(!editor.state().notices.is_empty(), "6.7 seconds");
    editor.harness.run_steps(120);
    assert!(editor.state().notices.is_empty(), "8.7 seconds");
    click(&mut editor, Role::Button, "1 notice");
    assert!(editor.shows("Opened cube"), "the list is one click away");
    editor.click_label("Clear");
    assert!(editor.state().past_notices.is_empty() && !editor.shows("1 notice"));
}

#[test]
fn a_notice_stays_while_the_pointer_is_over_it_and_one_that_asks_stays() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    let at = control(&editor, Role::Button, "Dismiss").rect().center();
    editor.hover(at);
    editor.harness.run_steps(700);
    assert_eq!(editor.state().notices.len(), 1);
    let away = editor.at(0.5, 0.9);
    editor.hover(away);
    editor.harness.run_steps(520);
    assert!(editor.state().notices.is_empty());
    // The notice about a distant object offers to frame it.
    editor.perform_all(&[Action::SubjectObject, Action::ToggleVisible, Action::WhyUnseen]);
    editor.harness.run_steps(700);
    assert_eq!(editor.state().notices.len(), 1, "it offers to show it");
}

#[test]
fn a_notice_says_opened_for_a_complete_file_and_names_the_losses_of_another() {
    let text = format!("{CUBE}f 1 2\n");
    let (folder, path) = folder_with("odd.obj", &text);
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    let Notice { text, details, .. } = editor.state().notices[0].clone();
    assert!(!details.is_empty(), "there is something to list");
    assert!(text.starts_with("Opened odd: ") && !text.contains("finding"), "{text}");
    let lossy = folder.path().join("lossy.obj");
    std::fs::write(&lossy, format!("mtllib none.mtl\n{CUBE}")).unwrap();
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&lossy);
    let text = &editor.state().notices[0].text;
    assert!(text.starts_with("lossy: ") && text.contains("none.mtl"), "{text}");
}

#[test]
fn why_outside_the_view_offers_to_frame() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.perform_all(&[Action::SubjectObject, Action::LookTop, Action::SubjectCamera]);
    // Turns the camera away.
    for _ in 0..18 {
        editor.perform(Action::StepXUp);
    }
    editor.perform(Action::WhyUnseen);
    editor.wait_until(|editor| !editor.state().notices.is_empty());
    editor.settle();
    click(&mut editor, Role::Button, "Frame");
    assert!(editor.state().notices.is_empty());
}

#[test]
fn the_up_axis_is_switched_in_the_notice_as_one_step_and_for_others_only_on_request() {
    let (folder, path) = folder_with("tower.obj", TOWER);
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    assert_eq!((editor.up(), editor.top()), (UpAxis::Y, 1.0));
    let steps = editor.steps();
    click(&mut editor, Role::Button, "Z up");
    editor.wait_until(|editor| editor.up() == UpAxis::Z);
    assert_eq!((editor.steps(), editor.top()), (steps + 1, 5.0));
    assert!(editor.shows("Dismiss"), "the notice stays for another thought");
    editor.press(Command(Key::Z));
    assert_eq!((editor.up(), editor.top()), (UpAxis::Y, 1.0));
    editor.press(Command(Key::Y));
    assert_eq!(editor.top(), 5.0);
    // The next model opens as its file is, until the user asks for another default.
    let next = folder.path().join("next.obj");
    std::fs::write(&next, TOWER).unwrap();
    for (asks, expected) in [(false, UpAxis::Y), (true, UpAxis::Z)] {
        if asks {
            click(&mut editor, Role::Button, "Z up");
            editor.wait_until(|editor| editor.up() == UpAxis::Z);
            // The properties offer it, too.
            editor.click_label("Use for all from now on");
            let button = control(&editor, Role::Button, "Use for all from now on");
            assert!(button.accesskit_node().is_disabled(), "it is the default now");
        }
        editor.perform(Action::New);
        editor.click_label("Discard");
        editor.open_alone(&next);
        assert_eq!(editor.up(), expected);
        assert_eq!(editor.shows("Z is up, as you prefer."), asks);
    }
}

#[test]
fn an_axis_chosen_in_the_dialog_of_a_model_is_that_of_this_model() {
    let (_folder, path) = folder_with("tower.obj", TOWER);
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    let id = editor.view().object.unwrap();
    editor.ask(Request::TurnUp(vec![id], UpAxis::Z));
    editor.wait_until(|editor| editor.up() == UpAxis::Z);
    assert_eq!(editor.state().up, UpAxis::Y);
}

/// Hides all objects and asks for each why it is not seen.
fn with_hidden_objects() -> Editor {
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.perform(Action::SubjectObject);
    for _ in 0..editor.scene().objects.len() {
        editor.perform_all(&[Action::ToggleVisible, Action::WhyUnseen, Action::NextItem]);
    }
    editor
}

#[test]
fn notices_of_one_kind_are_shown_as_one_with_a_count() {
    let mut editor = with_hidden_objects();
    assert_eq!(editor.state().notices.len(), 3);
    assert!(editor.shows("3 objects are hidden") && !editor.shows("r_falke is hidden"));
    let steps = editor.steps();
    click(&mut editor, Role::Button, "Show all");
    assert!(editor.scene().objects.iter().all(|(_, object)| object.visible));
    assert_eq!(editor.steps(), steps + 1);
    assert!(editor.state().notices.is_empty());
}

#[test]
fn a_notice_is_withdrawn_when_it_no_longer_holds() {
    for way in [Action::Undo, Action::ToggleVisible, Action::Delete] {
        let mut editor = Editor::of_size(1280.0, 800.0);
        editor.perform_all(&[Action::SubjectObject, Action::ToggleVisible, Action::WhyUnseen]);
        assert!(editor.shows("r_falke is hidden"));
        editor.perform(way);
        assert!(!editor.shows("r_falke is hidden"), "{way:?}");
    }
}

#[test]
fn a_notice_about_an_object_out_of_view_goes_once_the_view_shows_it() {
    let mut editor = Editor::of_size(1280.0, 800.0);
    // Half a turn away.
    for _ in 0..18 {
        editor.perform(Action::StepXUp);
    }
    editor.perform(Action::WhyUnseen);
    editor.wait_until(|editor| !editor.state().notices.is_empty());
    assert!(editor.shows("r_falke is out of view"));
    for _ in 0..18 {
        editor.perform(Action::StepXDown);
    }
    editor.wait_until(|editor| editor.state().notices.is_empty());
}

/// Counts the objects with a pixel in the picture.
fn seen(editor: &Editor) -> usize {
    let state = editor.state();
    // The last picture may be smaller, since the scene was moving.
    let side = editor.picture().size();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "few pixels")]
    let size = Size::new(side.x as usize, side.y as usize);
    let shot = Shot::new(&state.scene, &state.view, &state.settings, size);
    let mut renderer = Renderer::default();
    renderer.render(&plan_frame(&shot));
    let ids = state.scene.objects.ids().map(ItemId::Object);
    ids.filter(|id| renderer.pixels_of(*id).contains(&true)).count()
}

/// A scene of 60 cubes in a row, some of them seen.
const ROW: &str = r#"(
    version: 1,
    objects: [OBJECTS],
    cameras: [(id: 99, name: "camera 1", eye: (0.0, 0.0, 30.0))],
    view: (subject: Object, object: Some(1), camera: 99),
)"#;

#[test]
fn a_scene_with_many_objects_out_of_view_opens_with_one_notice_that_counts_only_them() {
    let (folder, _path) = folder_with("cube.obj", CUBE);
    let object = |i: usize| {
        let x = 3 * i;
        format!(
            "(id: {}, name: \"c{i}\", model: File(path: \"cube.obj\"), placement: (\
            (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), ({x}, 0, 0, 1))),",
            i + 1
        )
    };
    let objects: String = (0..60).map(object).collect();
    let file = folder.path().join("row.marraztu");
    std::fs::write(&file, ROW.replace("OBJECTS", &objects)).unwrap();
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.ask(Request::LoadFiles(vec![file]));
    editor.wait_until(|editor| !editor.state().notices.is_empty());
    editor.settle();
    // What the picture shows decides.
    let unseen = editor.state().notices.len();
    let shown = seen(&editor);
    let texts: Vec<_> = editor.state().notices.iter().map(|notice| &notice.text).collect();
    assert_eq!(unseen + shown, 60, "{shown} are seen: {texts:?}");
    assert!(shown > 2, "{shown} are seen");
    assert!(editor.shows(&format!("{unseen} objects are")), "one notice");
    let buttons = editor.harness.query_all_by_label("Frame all").count();
    assert_eq!(buttons, 1);
    click(&mut editor, Role::Button, "Frame all");
    // The smallest of them may lie between the centres of pixels.
    assert!(seen(&editor) >= 55);
    assert!(editor.state().notices.is_empty());
}

#[test]
fn notices_cover_neither_the_dial_nor_the_axes_and_stay_in_the_picture() {
    for size in [[1280.0, 800.0], [900.0, 640.0], [640.0, 400.0]] {
        let mut editor = Editor::of_size(size[0], size[1]);
        editor.perform_all(&[Action::SubjectObject, Action::ToggleVisible, Action::WhyUnseen]);
        let (_folder, path) = folder_with("odd.obj", &format!("{CUBE}f 1 2\n"));
        editor.ask(Request::LoadFiles(vec![path]));
        editor.wait_until(|editor| editor.shows("Material of"));
        editor.press(Named(Key::Enter));
        editor.wait_until(|editor| editor.state().notices.len() > 1);
        editor.harness.run_steps(4);
        let places = ["Dismiss", "Dismiss all", "Show"];
        let picture = editor.picture();
        let dial = editor.harness.query_all_by_label_contains("Accuracy").next();
        let dial = dial.map(|dial| dial.rect());
        let buttons = places.into_iter().flat_map(|place| {
            let all = editor.harness.query_all(By::new().role(Role::Button).label(place));
            all.map(move |button| (place, button.rect()))
        });
        for (place, rect) in buttons.collect::<Vec<_>>() {
            assert!(picture.contains_rect(rect), "{place} at {rect} in {size:?}");
            let axes = egui::Rect::from_min_max(
                picture.right_top() - egui::vec2(92.0, 0.0),
                picture.right_top() + egui::vec2(0.0, 92.0),
            );
            assert!(!rect.intersects(axes), "{place} at {rect} in {size:?}");
            assert!(dial.is_none_or(|dial| !rect.intersects(dial)), "{place} in {size:?}");
        }
        click(&mut editor, Role::Button, "Dismiss all");
        assert!(editor.state().notices.is_empty());
    }
}

#[test]
fn an_axis_that_the_file_states_is_used_and_said() {
    let (folder, path) = folder_with("tower.obj", &format!("# up axis: Z\n{TOWER}"));
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    assert_eq!((editor.up(), editor.top()), (UpAxis::Z, 5.0));
    assert!(editor.shows("Z is up: its file says \"up axis: Z\"."));
    // A statement in the file takes precedence over the remembered choice.
    let y = folder.path().join("y.obj");
    std::fs::write(&y, format!("# Y-up\n{TOWER}")).unwrap();
    let mut editor = Editor::of_size(1280.0, 800.0);
    let preferences = marraztu_io::Preferences { up: UpAxis::Z, ..Default::default() };
    editor.ask(Request::Preferences(Box::new(preferences)));
    editor.open_alone(&y);
    assert_eq!(editor.up(), UpAxis::Y);
}

#[test]
fn the_z_axis_of_stl_files_is_up_as_on_the_command_line() {
    let (_folder, path) = folder_with("tower.stl", TOWER_STL);
    for last in [UpAxis::Y, UpAxis::MinusY] {
        let mut editor = Editor::of_size(1280.0, 800.0);
        let preferences = marraztu_io::Preferences { up: last, ..Default::default() };
        editor.ask(Request::Preferences(Box::new(preferences)));
        editor.open_alone(&path);
        assert_eq!((editor.up(), editor.top()), (UpAxis::Z, 5.0));
        assert!(editor.shows("Z is up, as usual in STL files."));
    }
}

#[test]
fn the_properties_switch_the_up_axis_too() {
    let (_folder, path) = folder_with("tower.obj", TOWER);
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    let id = editor.view().object.unwrap();
    editor.ask(Request::Select(ItemId::Object(id)));
    click(&mut editor, Role::RadioButton, "Up axis: Z");
    editor.wait_until(|editor| editor.up() == UpAxis::Z);
    assert_eq!(editor.top(), 5.0);
}

#[test]
fn a_missing_texture_is_offered_until_one_is_chosen() {
    let (folder, path) = folder_with("cube.obj", &format!("mtllib cube.mtl\nusemtl a\n{CUBE}"));
    std::fs::write(folder.path().join("cube.mtl"), "newmtl a\nmap_Kd wood.png\n").unwrap();
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    editor.harness.run_steps(600);
    assert!(editor.shows("The texture of cube was not found"), "it waits for an answer");
    let texture = folder.path().join("found.png");
    io::save_picture(&texture, &Picture::filled(Size::new(2, 2), [200, 100, 50, 255])).unwrap();
    editor.click_label("Find...");
    editor.type_path(&texture);
    editor.wait_until(|editor| !editor.shows("The texture of cube was not found"));
    let scene = editor.scene();
    assert!(scene.objects.iter().next().unwrap().1.texture.is_some());
}

#[test]
fn past_notices_are_listed_by_an_action() {
    let (_folder, path) = folder_with("odd.obj", &format!("{CUBE}f 1 2\n"));
    let mut editor = Editor::of_size(1280.0, 800.0);
    editor.open_alone(&path);
    click(&mut editor, Role::Button, "Dismiss");
    assert!(editor.state().notices.is_empty() && editor.shows("1 notice"));
    editor.perform(Action::PastNotices);
    assert!(editor.shows("Notices") && editor.shows("line"));
}
