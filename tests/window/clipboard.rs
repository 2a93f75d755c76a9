//! Copy, cut and paste.
//!
//! Catches: clipboard keys that the window system sends as other events, text fields that lose
//! them, a copy exactly on top of its original, pasted items that differ, text of other programs.

use std::collections::BTreeSet;
use std::path::Path;

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, OutputCommand};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Command, Named};
use marraztu::app::actions::Request;
use marraztu_core::edit::several::Others;
use marraztu_core::scene::{ItemId, MaterialChoice, Object, Subject};

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;
use crate::panels::{click, type_text};

impl Editor {
    /// Sends an event, and returns the text it copied.
    fn copied(&mut self, event: Event) -> Option<String> {
        self.harness.event(event);
        let mut text = None;
        for _ in 0..3 {
            self.harness.step();
            for command in &self.harness.output().platform_output.commands {
                if let OutputCommand::CopyText(copied) = command {
                    text = Some(copied.clone());
                }
            }
        }
        for key in [Key::C, Key::X] {
            self.key(key, false, Modifiers::NONE);
        }
        self.settle();
        text
    }

    fn paste(&mut self, text: &str) {
        let objects = self.scene();
        let message = self.state().message.clone();
        self.harness.event(Event::Paste(text.to_owned()));
        self.settle();
        self.key(Key::V, false, Modifiers::NONE);
        self.wait_until(|editor| editor.scene() != objects || editor.state().message != message);
    }

    fn object_names(&self) -> Vec<String> {
        self.scene().objects.iter().map(|(_, object)| object.name.clone()).collect()
    }
}

#[test]
fn an_object_goes_as_text_to_another_window_and_comes_back() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::new();
    editor.drop_files(&[&path]);
    editor.wait_until(|editor| editor.scene().objects.len() == 1);
    editor.perform(Action::SubjectObject);
    let text = editor.copied(Event::Copy).expect("it is copied");
    assert!(text.contains("version: 1") && text.contains("\"cube\""), "{text}");
    assert!(text.contains(&path.display().to_string()), "the path leads there from everywhere");
    let mut other = Editor::new();
    other.paste(&text);
    assert_eq!(other.object_names(), ["cube", "r_falke", "x_wing", "cam"]);
    assert_eq!(other.state().selected(), other.view().object.map(ItemId::Object));
    assert_eq!(other.steps(), 1);
    other.press(Command(Key::Z));
    assert_eq!(other.object_names(), ["r_falke", "x_wing", "cam"]);
}

#[test]
fn each_press_pastes_whatever_key_stands_for_the_clipboard() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let text = editor.copied(Event::Copy).unwrap();
    let released = |key, place| {
        let (modifiers, pressed, repeat) = (Modifiers::COMMAND, false, false);
        Event::Key { key, physical_key: Some(place), pressed, repeat, modifiers }
    };
    // Ctrl+V of a Dvorak layout, and Shift+Insert of Windows, each while Ctrl or Shift stays down.
    let keys = [released(Key::V, Key::Period), released(Key::Insert, Key::Insert)];
    for (count, release) in keys.iter().flat_map(|key| [key; 2]).enumerate() {
        editor.harness.event(Event::Paste(text.clone()));
        editor.settle();
        // The system repeats the event while the key is held.
        editor.harness.event(Event::Paste(text.clone()));
        editor.settle();
        editor.harness.event(release.clone());
        editor.settle();
        assert_eq!(editor.scene().objects.len(), 4 + count, "{release:?}");
    }
}

#[test]
fn pastes_are_offset_from_the_original_and_from_each_other() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let text = editor.copied(Event::Copy).unwrap();
    editor.paste(&text);
    editor.paste(&text);
    assert_eq!(editor.object_names()[..2], ["r_falke 3", "r_falke 2"]);
    let scene = editor.scene();
    let place = |(_, object): (_, &Object)| format!("{:?}", object.placement.now().w_axis);
    let places: BTreeSet<String> = scene.objects.iter().map(place).collect();
    assert_eq!(places.len(), 5, "no two are in one place: {places:?}");
}

#[test]
fn a_cut_is_one_step_and_several_items_keep_their_owners() {
    let mut editor = Editor::new();
    editor.perform_all(&[Action::SubjectObject, Action::AddObjectSpot]);
    let spot = editor.view().light.unwrap();
    editor.perform(Action::SubjectObject);
    let object = editor.view().object.unwrap();
    let both = [ItemId::Object(object), ItemId::Light(spot)];
    editor.ask(Request::Others(Others::new(both[0], both)));
    let (before, steps) = (editor.scene(), editor.steps());
    let text = editor.copied(Event::Cut).unwrap();
    assert_eq!(editor.steps(), steps + 1);
    assert!(!editor.scene().contains(both[0]) && !editor.scene().contains(both[1]));
    editor.paste(&text);
    let scene = editor.scene();
    assert_eq!(scene.objects.len(), before.objects.len());
    let (new, _) = scene.objects.iter().find(|(_, it)| it.name == "r_falke").unwrap();
    let owners = scene.lights.iter().filter_map(|(_, light)| light.kind.owner());
    let owner = marraztu_core::scene::SpotOwner::Object(new);
    assert!(owners.into_iter().any(|it| *it == owner), "the spot belongs to the new object");
    editor.press(Command(Key::Z));
    editor.press(Command(Key::Z));
    assert!(editor.scene() == before);
}

#[test]
fn a_material_is_pasted_to_the_selected_objects() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let scene = editor.scene();
    let (emerald, _) = scene.objects.iter().find(|(_, it)| it.name == "x_wing").unwrap();
    let wanted = scene.objects.get(emerald).unwrap().material.clone();
    let own = editor.view().object.unwrap();
    editor.ask(Request::Select(ItemId::Object(emerald)));
    editor.perform(Action::CopyMaterial);
    let text = marraztu_io::material_to_text(&wanted).unwrap();
    editor.ask(Request::Select(ItemId::Object(own)));
    editor.paste(&text);
    assert_eq!(editor.scene().objects.get(own).unwrap().material, wanted);
    assert!(matches!(wanted, MaterialChoice::Preset(_)));
}

#[test]
fn text_of_other_programs_is_refused_in_a_sentence() {
    let mut editor = Editor::new();
    let before = editor.scene();
    editor.paste("hello");
    let told = editor.state().message.clone().unwrap().text;
    assert_eq!(
        told,
        "cannot paste: the clipboard: it holds no objects, cameras, lights or material"
    );
    let missing = Path::new("/nowhere/none.obj").display().to_string();
    let text =
        format!("(version: 1, objects: [(id: 1, name: \"a\", model: File(path: \"{missing}\"))])");
    editor.paste(&text);
    assert!(editor.scene() == before || editor.scene().objects.len() == 4, "or a placeholder");
}

#[test]
fn text_fields_keep_the_keys_of_the_clipboard() {
    let mut editor = Editor::new();
    editor.press(Command(Key::K));
    let before = editor.scene();
    editor.harness.event(Event::Paste("wireframe".to_owned()));
    editor.settle();
    assert!(editor.scene() == before);
    assert_eq!(crate::palette::listed(&editor)[0], "Wireframe");
    editor.press(Named(Key::Escape));
}

#[test]
fn a_duplicate_is_offset_by_its_width() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let object = |editor: &Editor| {
        let id = editor.view().object.unwrap();
        editor.scene().objects.get(id).unwrap().clone()
    };
    let first = object(&editor);
    let bounds = marraztu_core::edit::arrange::world_box(&first, 0.0).unwrap();
    editor.press(Command(Key::D));
    assert_eq!(editor.steps(), 1);
    let way = (object(&editor).placement.now().w_axis - first.placement.now().w_axis).truncate();
    assert!((way.x - bounds.extent().x).abs() < 1e-9 && way.y == 0.0 && way.z == 0.0, "{way}");
    assert_eq!(editor.view().subject, Subject::Object);
    editor.press(Command(Key::Z));
    assert_eq!(editor.scene().objects.len(), 3);
}

#[test]
fn ctrl_a_selects_only_items_that_the_outline_lists() {
    let mut editor = Editor::of_size(1000.0, 900.0);
    editor.perform_all(&[Action::AddCube, Action::AddCube, Action::AddCube, Action::SubjectObject]);
    assert!(editor.state().has_filter(), "there are many items");
    click(&mut editor, Role::TextInput, "Filter by name");
    type_text(&mut editor, "cube");
    editor.press(Named(Key::Escape));
    editor.perform(Action::SelectAll);
    let names: Vec<String> = std::iter::once(editor.state().selected().unwrap())
        .chain(editor.state().others())
        .map(|id| editor.state().name(id).unwrap().to_owned())
        .collect();
    assert_eq!(names.len(), 3);
    assert!(names.iter().all(|name| name.starts_with("cube")), "{names:?}");
}
