//! The ten tasks of `docs/tasks.md`, by keyboard alone and by mouse alone.
//!
//! Catches: a path with more steps than the page states, or one that misses its goal.
//!
//! A step is a key, a typed word, a click, or a drag.

use std::path::Path;

use egui::accesskit::Role;
use egui::{Key, PointerButton, Pos2};
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{self, Command, CommandShift, Either, Lower, Named};
use marraztu::app::panels::Panel;
use marraztu_core::scene::{LightKind, MaterialChoice, Normals, Scene, SpotOwner};
use marraztu_io as io;

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;
use crate::panels::{click, control, middle, type_text};
use crate::undo_buttons::pull_to;

/// An editor, with a count of the steps taken in it.
struct Hand {
    editor: Editor,
    steps: usize,
}

impl Hand {
    fn at(editor: Editor) -> Self {
        Self { editor, steps: 0 }
    }

    fn after(actions: &[Action]) -> Self {
        let mut editor = Editor::of_size(1280.0, 800.0);
        editor.perform_all(actions);
        Self::at(editor)
    }

    fn press(&mut self, chord: Chord) {
        self.editor.press(chord);
        self.steps += 1;
    }

    fn write(&mut self, text: &str) {
        type_text(&mut self.editor, text);
        self.steps += 1;
    }

    /// Chooses a palette entry by its words.
    fn find(&mut self, words: &str) {
        self.press(Command(Key::K));
        self.write(words);
        self.press(Named(Key::Enter));
    }

    fn click(&mut self, role: Role, label: &str) {
        click(&mut self.editor, role, label);
        // Submenus open after a delay.
        self.editor.harness.run_steps(30);
        self.steps += 1;
    }

    fn click_at(&mut self, at: Pos2, button: PointerButton) {
        self.editor.harness.run_steps(60);
        self.editor.click(at, button);
        self.steps += 1;
    }

    /// Replaces the proposed path of a file. A user would accept the proposal; the test has to
    /// write to a temporary folder.
    fn elsewhere(&mut self, path: &Path) {
        self.editor.press(Command(Key::A));
        type_text(&mut self.editor, &path.display().to_string());
    }

    /// Like [`Self::elsewhere`], for the file field among the options of a picture.
    fn named(&mut self, path: &Path) {
        click(&mut self.editor, Role::TextInput, "File");
        self.elsewhere(path);
    }
}

/// The steps by keyboard and by mouse that the page's table states for a task.
fn promised(task: &str) -> [usize; 2] {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/tasks.md"));
    let page = page.unwrap();
    let row = page.lines().find(|line| line.starts_with(&format!("| {task} |")));
    let row = row.unwrap_or_else(|| panic!("the page has no {task:?}"));
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    [cells[2], cells[3]].map(|cell| cell.parse().unwrap())
}

fn holds(task: &str, keys: &Hand, mouse: &Hand) {
    assert_eq!([keys.steps, mouse.steps], promised(task), "{task}");
}

#[test]
fn a_model_is_opened_and_lit() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut keys = Hand::after(&[]);
    keys.press(Lower(Key::F));
    keys.elsewhere(&path);
    keys.steps += 1;
    keys.press(Named(Key::Enter));
    keys.editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    keys.press(Named(Key::Enter));
    keys.editor.wait_until(|editor| editor.scene().objects.len() == 4);
    keys.press(Chord::Text("."));
    let mut mouse = Hand::after(&[]);
    mouse.editor.drop_files(&[&path]);
    mouse.steps += 1;
    mouse.editor.wait_until(|editor| editor.scene().objects.len() == 1);
    holds("Open a model and light it", &keys, &mouse);
}

#[test]
fn three_objects_are_added() {
    let mut keys = Hand::after(&[Action::New]);
    let before = keys.editor.scene().objects.len();
    keys.find("cube");
    keys.press(Command(Key::D));
    keys.press(Command(Key::D));
    assert_eq!(keys.editor.scene().objects.len(), before + 3);
    let mut mouse = Hand::after(&[]);
    for shape in ["Cube", "Sphere", "Torus"] {
        mouse.click(Role::Button, "Add");
        mouse.click(Role::MenuItem, shape);
    }
    assert_eq!(mouse.editor.scene().objects.len(), before + 3);
    holds("Add three objects", &keys, &mouse);
}

#[test]
fn why_an_object_is_not_seen_is_found() {
    let hidden = || Hand::after(&[Action::SubjectObject, Action::ToggleVisible]);
    let mut keys = hidden();
    keys.press(Either(Key::W));
    assert!(keys.editor.shows("r_falke is hidden"));
    let mut mouse = hidden();
    let row = middle(&mouse.editor, Role::ListBoxOption, "r_falke");
    mouse.click_at(row, PointerButton::Secondary);
    mouse.click(Role::MenuItem, Action::WhyUnseen.info().label);
    assert!(mouse.editor.shows("r_falke is hidden"));
    holds("Find out why an object is not seen", &keys, &mouse);
}

fn aim(scene: &Scene) -> glam::DVec3 {
    let aim = scene.lights.iter().find_map(|(_, light)| match &light.kind {
        LightKind::Spot { owner: SpotOwner::Fixed(aim), .. } => Some(aim.now().direction),
        _ => None,
    });
    aim.unwrap()
}

#[test]
fn a_spot_is_aimed() {
    let mut keys = Hand::after(&[Action::AddSpot]);
    keys.find("aim at");
    assert!(aim(&keys.editor.scene()).x < -0.99);
    let mut mouse = Hand::after(&[Action::AddSpot, Action::SubjectCamera]);
    let scene = mouse.editor.scene();
    let name = scene.lights.get(mouse.editor.view().light.unwrap()).unwrap().name.clone();
    mouse.click(Role::ListBoxOption, &name);
    mouse.click(Role::CheckBox, "Aim by a click");
    let rect = mouse.editor.picture();
    let ship = rect.center() - egui::vec2(0.6, 0.0) * rect.size().min_elem() / 2.0;
    mouse.click_at(ship, PointerButton::Primary);
    assert!(aim(&mouse.editor.scene()).x < -0.8);
    holds("Aim a spot", &keys, &mouse);
}

#[test]
fn shading_is_flat_or_smooth() {
    let mut keys = Hand::after(&[]);
    keys.press(Either(Key::I));
    // The button is visible in windows of the usual size and in small ones.
    let in_sight = |editor: &Editor, height: f32| {
        let button = control(editor, Role::RadioButton, "Normals: Face").rect();
        button.bottom() < height - 30.0
    };
    assert!(in_sight(&Editor::of_size(1024.0, 640.0), 640.0));
    let mut mouse = Hand::at(Editor::of_size(1280.0, 800.0));
    assert!(in_sight(&mouse.editor, 800.0));
    mouse.click(Role::RadioButton, "Normals: Face");
    for hand in [&keys, &mouse] {
        assert_eq!(hand.editor.view().normals, Normals::Face);
    }
    holds("Switch between flat and smooth", &keys, &mouse);
}

#[test]
fn ten_steps_are_undone() {
    let moved = || {
        let mut hand = Hand::after(&[Action::SubjectObject]);
        let before = hand.editor.scene();
        hand.editor.perform_all(&[Action::StepXUp; 10]);
        assert_eq!(hand.editor.steps(), 10);
        (before, hand)
    };
    let (before, mut keys) = moved();
    keys.editor.hold(Command(Key::Z), 9);
    keys.steps += 1;
    let (_, mut mouse) = moved();
    pull_to(&mut mouse.editor, "Undo", 10);
    mouse.steps += 1;
    let (_, mut panel) = moved();
    panel.editor.perform(Action::Panel(Panel::History));
    panel.click(Role::Button, "0  Beginning");
    for hand in [&keys, &mouse, &panel] {
        assert!(hand.editor.scene() == before);
    }
    holds("Undo ten steps", &keys, &mouse);
}

#[test]
fn a_scene_is_saved_and_opened_again() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.marraztu");
    let mut keys = Hand::after(&[Action::SubjectObject, Action::StepXUp]);
    let scene = keys.editor.scene();
    keys.press(Command(Key::Q));
    assert!(keys.editor.shows("Save the scene?"));
    keys.press(Named(Key::Enter));
    keys.elsewhere(&path);
    keys.press(Named(Key::Enter));
    keys.editor.wait_until(|_| path.exists());
    let opened = || io::open(&path, &io::Progress::new()).unwrap().scene;
    let places = |scene: &Scene| -> Vec<glam::DMat4> {
        scene.objects.iter().map(|(_, object)| *object.placement.now()).collect()
    };
    assert_eq!(places(&opened()), places(&scene));
    // Opening takes one step: its name on the command line, or a click in the strip.
    keys.steps += 1;
    std::fs::remove_file(&path).unwrap();
    let mut mouse = Hand::after(&[Action::SubjectObject, Action::StepXUp]);
    // The close button asks like the key does.
    mouse.editor.perform(Action::Quit);
    mouse.steps += 1;
    mouse.click(Role::Button, "Save");
    mouse.elsewhere(&path);
    mouse.click(Role::Button, "Save");
    mouse.editor.wait_until(|_| path.exists());
    assert_eq!(places(&opened()), places(&scene));
    mouse.steps += 1;
    holds("Save, quit, and open it again", &keys, &mouse);
}

#[test]
fn work_is_recovered() {
    let folder = tempfile::tempdir().unwrap();
    {
        let mut editor = Editor::keeping(folder.path());
        editor.press(Lower(Key::Z));
        editor.harness.state().wait_for_journal();
    }
    let mut keys = Hand::at(Editor::keeping(folder.path()));
    keys.press(CommandShift(Key::R));
    keys.editor.wait_until(|editor| editor.is_offered() == 0);
    let scene = keys.editor.scene();
    keys.editor.harness.state().wait_for_journal();
    let steps = keys.steps;
    drop(keys);
    let mut mouse = Hand::at(Editor::keeping(folder.path()));
    mouse.click(Role::Button, "Recover");
    mouse.editor.wait_until(|editor| editor.is_offered() == 0);
    assert!(mouse.editor.scene().cameras == scene.cameras);
    let keys = Hand { steps, editor: Editor::small() };
    holds("Recover after a crash", &keys, &mouse);
}

#[test]
fn an_object_gets_a_custom_colour() {
    let own = |hand: &Hand| -> [f64; 3] {
        let scene = hand.editor.scene();
        match scene.objects.get(hand.editor.view().object.unwrap()).unwrap().material {
            MaterialChoice::Own(material) => material.diffuse,
            ref other => panic!("{other:?}"),
        }
    };
    let mut keys = Hand::after(&[Action::SubjectObject]);
    keys.find("#ff8000");
    assert_eq!(own(&keys), [1.0, f64::from(0x80_u8) / 255.0, 0.0]);
    assert_eq!(keys.editor.steps(), 1);
    let mut mouse = Hand::after(&[Action::SubjectObject]);
    mouse.click(Role::RadioButton, "Material: your own");
    let before = own(&mouse);
    mouse.click(Role::ColorWell, "Diffuse colour");
    let shade = middle(&mouse.editor, Role::ColorWell, "Diffuse colour: shade");
    mouse.click_at(shade, PointerButton::Primary);
    assert_ne!(own(&mouse), before);
    holds("Give an object a colour of your own", &keys, &mouse);
}

#[test]
fn a_turntable_is_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("turn.gif");
    let small = || Hand::at(Editor::of_size(700.0, 600.0));
    let mut keys = small();
    keys.press(Command(Key::F12));
    keys.named(&path);
    keys.press(Named(Key::Enter));
    keys.editor.wait_until(|_| path.exists());
    std::fs::remove_file(&path).unwrap();
    let mut mouse = small();
    mouse.click(Role::Button, "File");
    mouse.click(Role::MenuItem, Action::SaveTurntable.info().label);
    mouse.named(&path);
    mouse.click(Role::Button, "Save");
    mouse.editor.wait_until(|_| path.exists());
    holds("Save a turntable", &keys, &mouse);
}
