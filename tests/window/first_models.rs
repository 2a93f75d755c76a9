//! Models that open alone: from the command line, or dropped on the unchanged first scene.
//!
//! Catches: ships next to the model, a model that is too small, too large or overexposed, steps of
//! the wrong size, a window that differs from `render`, a drop without undo, a key `f` that
//! replaces the scene.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::Key;
use marraztu::app::actions::Chord::{Command, Lower, Named};
use marraztu::app::actions::Request;
use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::edit::{presenting, steps};
use marraztu_core::scene::{
    CameraMode, HALF_APERTURE, LoadOptions, Material, MaterialChoice, Object, Pose, Scene, Sides,
    Steps, Subject, View,
};
use marraztu_io::{self as io, Progress};
use marraztu_render::{Renderer, plan_frame};

use crate::dialogs::{CUBE, folder_with};
use crate::editor::Editor;

/// A file dropped onto the window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

impl Editor {
    fn open_at_start(&mut self, paths: &[&Path]) {
        let ctx = self.harness.ctx.clone();
        let paths = paths.iter().map(|path| path.to_path_buf()).collect();
        self.harness.state_mut().load_at_start(&ctx, paths);
    }

    pub(crate) fn drop_files(&mut self, paths: &[&Path]) {
        for path in paths {
            let file = Arc::new(Dropped(path.to_path_buf()));
            self.harness.input_mut().dropped_files.push(file);
        }
        self.settle();
    }

    fn names(&self) -> Vec<String> {
        self.scene().objects.iter().map(|(_, object)| object.name.clone()).collect()
    }
}

fn model(path: &Path) -> Object {
    let loaded = io::load(path, &LoadOptions::default(), &Progress::new()).unwrap();
    Object::new(Shared::new(loaded.model), MaterialChoice::File)
}

fn picture(scene: &Scene, view: &View, size: Size) -> marraztu_core::base::image::Picture {
    let shot = Shot::new(scene, view, &Settings::default(), size);
    Renderer::default().render(&plan_frame(&shot)).clone()
}

/// The first scene's cameras and lights with these objects, as the program opens them.
fn alone(objects: Vec<Object>) -> (Scene, View) {
    let (mut scene, view) = io::empty_scene();
    let (command, view) = presenting::alone(&scene, &view, objects).unwrap();
    command.apply(&mut scene).unwrap();
    (scene, view)
}

#[test]
fn a_model_of_the_command_line_opens_alone_framed_and_with_steps_that_fit() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::new();
    editor.open_at_start(&[&path]);
    editor.wait_until(|editor| editor.names() == ["cube"]);
    editor.settle();
    let (scene, view) = (editor.scene(), editor.view());
    let (wanted, wanted_view) = alone(vec![model(&path)]);
    let pose = |scene: &Scene, view: &View| *scene.selected_camera(view).pose.now();
    assert_eq!(pose(&scene, &view), pose(&wanted, &wanted_view));
    assert_eq!(scene.lights, wanted.lights, "it is lit as render lights it");
    let mut apertures =
        scene.lights.iter().filter_map(|(_, light)| (HALF_APERTURE.get)(&light.kind));
    assert!(
        apertures.all(|angle| angle == HALF_APERTURE.largest),
        "no edge of a cone from near by"
    );
    assert_eq!(steps::length(&scene, &view), 0.01, "a hundredth of the cube");
    assert!(editor.shows("step 0.01 by size"));
    assert!(editor.state().history.is_saved());
    assert_eq!(editor.state().file_name().as_deref(), Some("cube.obj"), "as the title says");
    assert_eq!(editor.steps(), 0);
    let place = |editor: &Editor| {
        let (scene, view) = (editor.scene(), editor.view());
        scene.objects.get(view.object.unwrap()).unwrap().placement.now().w_axis.truncate()
    };
    editor.press(Lower(Key::Z));
    let moved = place(&editor).length();
    assert!((moved - 0.01).abs() < 1e-12, "the model is selected: {moved}");
}

/// A cube with many vertices at one corner, so their mean is far from the centre of its box.
fn lopsided() -> String {
    let more = (0..40).map(|i| format!("v 1 1 {}\n", 0.9 + f64::from(i) / 400.0));
    let faces = (9..47).map(|i| format!("f {i} {} {}\n", i + 1, i + 2));
    format!("{}{}{}", CUBE, more.collect::<String>(), faces.collect::<String>())
}

#[test]
fn the_first_drag_orbits_a_model_that_opened_alone_and_does_not_jump() {
    for arrival in ["start", "drop"] {
        let (_folder, path) = folder_with("cube.obj", &lopsided());
        let mut editor = Editor::new();
        match arrival {
            "start" => editor.open_at_start(&[&path]),
            _ => editor.drop_files(&[&path]),
        }
        editor.wait_until(|editor| editor.names() == ["cube"]);
        editor.settle();
        let view = editor.view();
        assert_eq!(view.subject, Subject::Object);
        let pose = |editor: &Editor| *editor.scene().selected_camera(&editor.view()).pose.now();
        let target = view.object.unwrap();
        let before = pose(&editor);
        assert_eq!(before.mode, CameraMode::Analysis { target });
        // The mean of the vertices is the centre of the orbit, and not the centre of the picture.
        let centre = editor.scene().objects.get(target).unwrap().centre(0.0);
        let aside = |pose: &Pose| {
            let ahead = centre - pose.eye;
            (ahead.dot(-pose.axes.z_axis) / ahead.length()).acos()
        };
        assert!(aside(&before) > 0.02, "it is framed by its box: {}", aside(&before));
        let [from, to] = [editor.at(0.5, 0.9), editor.at(0.52, 0.9)];
        editor.drag(egui::PointerButton::Primary, &[from, to]);
        // After the drag: same distance, another position, same offset from the centre.
        let after = pose(&editor);
        let distance = |pose: &Pose| pose.eye.distance(centre);
        assert!((distance(&after) - distance(&before)).abs() < 1e-9, "it orbits");
        assert!(after.eye.distance(before.eye) > 1e-3);
        assert!((aside(&after) - aside(&before)).abs() < 1e-6, "{arrival}: it is not aimed anew");
    }
}

#[test]
fn the_first_scene_flies() {
    let editor = Editor::new();
    let scene = editor.scene();
    assert_eq!(scene.selected_camera(&editor.view()).pose.now().mode, CameraMode::Fly);
    assert_eq!(editor.view().subject, Subject::Camera);
}

#[test]
fn a_model_of_points_is_one_notice_that_counts_them() {
    let (_folder, path) = folder_with("cloud.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    let mut editor = Editor::new();
    editor.open_at_start(&[&path]);
    editor.wait_until(|editor| editor.names() == ["cloud"]);
    for _ in 0..5 {
        editor.settle();
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let notices: Vec<&str> =
        editor.state().notices.iter().map(|notice| notice.text.as_str()).collect();
    let [only] = notices[..] else { panic!("{notices:?}") };
    assert!(only.starts_with("Opened cloud: 3 points, 3 vertices"), "{only}");
    assert!(editor.state().notices[0].details[0].contains(&path.display().to_string()));
}

#[test]
fn a_model_that_cannot_be_read_leaves_the_first_scene() {
    let (_folder, path) = folder_with("bad.obj", "v 0 zero 0\n");
    let mut editor = Editor::new();
    let before = editor.scene();
    editor.open_at_start(&[&path]);
    editor.wait_until(|editor| editor.shows("The file was not loaded"));
    assert!(editor.scene() == before);
    editor.press(Named(Key::Enter));
    assert!(editor.shows("Drop a model here"), "the strip says what else can be opened");
}

#[test]
fn a_scene_of_the_command_line_keeps_its_objects_if_models_are_added() {
    let (folder, path) = folder_with("cube.obj", CUBE);
    let file = folder.path().join("my.marraztu");
    let (scene, view) = io::default_scene();
    io::save(&file, &scene, &view, &Settings::default()).unwrap();
    let mut editor = Editor::new();
    // The scene comes first in either order of the arguments.
    editor.open_at_start(&[&path, &file]);
    editor.wait_until(|editor| editor.names().len() == 4);
    assert_eq!(editor.names()[0], "cube");
    assert!(editor.state().history.is_saved());
}

#[test]
fn a_drop_on_the_untouched_first_scene_takes_its_place_and_one_undo_brings_it_back() {
    let (folder, path) = folder_with("cube.obj", CUBE);
    let second = folder.path().join("second.obj");
    std::fs::write(&second, CUBE).unwrap();
    let mut editor = Editor::new();
    let (first, first_view) = (editor.scene(), editor.view());
    editor.drop_files(&[&path, &second]);
    editor.wait_until(|editor| editor.names() == ["second", "cube"]);
    assert_eq!(editor.steps(), 1);
    assert!(editor.view().steps.by_size);
    assert_eq!(editor.scene().background, Scene::NEUTRAL);
    editor.press(Command(Key::Z));
    assert!(editor.scene() == first, "with its blue");
    assert_eq!(editor.view().steps, Steps::DEFAULT, "the first scene has steps of 10");
    assert_eq!(editor.view().object, first_view.object);
    editor.perform(marraztu::app::actions::Action::Redo);
    assert_eq!(editor.names(), ["second", "cube"]);
    assert!(editor.view().steps.by_size);
}

#[test]
fn steps_chosen_after_a_drop_stay_over_undo_and_redo() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::new();
    editor.drop_files(&[&path]);
    editor.wait_until(|editor| editor.names() == ["cube"]);
    let mut view = editor.view();
    (view.steps.by_size, view.steps.translation) = (false, 3.0);
    let chosen = view.steps;
    editor.ask(Request::View(Box::new(view)));
    editor.press(Lower(Key::X));
    editor.press(Command(Key::Z));
    assert_eq!(editor.view().steps, chosen);
    // The first scene has its own steps, and the model has these again after redo.
    editor.press(Command(Key::Z));
    assert_eq!(editor.view().steps, Steps::DEFAULT);
    editor.perform(marraztu::app::actions::Action::Redo);
    assert_eq!(editor.view().steps, chosen);
    // Another change instead of redo leads to no model.
    editor.press(Command(Key::Z));
    editor.press(Lower(Key::X));
    editor.press(Command(Key::Z));
    editor.perform(marraztu::app::actions::Action::Redo);
    assert_eq!(editor.view().steps, Steps::DEFAULT);
}

#[test]
fn a_drop_on_a_scene_that_was_changed_asks_for_a_material_and_joins_it() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::new();
    editor.press(Lower(Key::Z));
    editor.drop_files(&[&path]);
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.click_label("Load");
    assert_eq!(editor.names(), ["cube", "r_falke", "x_wing", "cam"]);
}

#[test]
fn the_key_f_adds_to_the_first_scene() {
    let (_folder, path) = folder_with("cube.obj", CUBE);
    let mut editor = Editor::new();
    editor.ask(Request::LoadFiles(vec![path]));
    editor.wait_until(|editor| editor.shows("Material of cube.obj"));
    editor.click_label("Load");
    assert_eq!(editor.names(), ["cube", "r_falke", "x_wing", "cam"]);
    assert_eq!(editor.view().steps, Steps::DEFAULT);
}

#[test]
fn only_highlights_reach_white_from_wherever_models_are_seen() {
    let white = Material::matte([0.2; 3], [1.0; 3]);
    let bright = Material { ambient: [0.9; 3], ..white };
    let grey = Material { diffuse: [0.5; 3], ..white };
    for (name, factor) in [("x_wing", 1.0), ("r_falke", 1e-4), ("ball", 1e6)] {
        for material in [white, bright, grey] {
            let ball = io::own_model(name).unwrap();
            let mut object = Object::new(ball, MaterialChoice::Own(material));
            object.sides = Sides::Two;
            let scale = glam::DMat4::from_scale(glam::DVec3::splat(factor));
            object.placement = marraztu_core::scene::Tracked::new(scale);
            let (scene, view) = alone(vec![object]);
            let picture = picture(&scene, &view, Size::new(160, 120));
            let background = scene.background.opaque();
            let shown: Vec<u8> = picture
                .pixels()
                .iter()
                .filter(|pixel| **pixel != background)
                .map(|pixel| pixel[0])
                .collect();
            let most = shown.iter().copied().max().unwrap();
            assert!(most < 255, "{name} is burnt out: {most}");
            // Balanced light also comes near to white somewhere.
            assert!(most > 120, "{name} is dark: {most}");
            let share = shown.len() as f64 / picture.pixels().len() as f64;
            assert!(share > 0.05, "{name} fills {share} of the picture");
        }
    }
}

#[test]
fn steps_by_size_stay_while_a_lone_object_is_moved_and_turned() {
    let (mut scene, mut view) = alone(vec![model_of("x_wing")]);
    let before = steps::length(&scene, &view);
    view.subject = Subject::Object;
    for axis in marraztu_core::base::math::Axis::ALL {
        for kind in [
            marraztu_core::scene::Transformation::Translation,
            marraztu_core::scene::Transformation::Rotation,
        ] {
            view.transformation = kind;
            let command = marraztu_core::edit::transform::step(
                &scene,
                &view,
                axis,
                marraztu_core::edit::transform::Sign::Positive,
                marraztu_core::edit::GesturePhase::First,
            );
            command.unwrap().apply(&mut scene).unwrap();
            assert_eq!(steps::length(&scene, &view), before);
        }
    }
}

fn model_of(name: &str) -> Object {
    Object::new(io::own_model(name).unwrap(), MaterialChoice::File)
}
