//! Helpers over the picture, arranging, and reloading models.
//!
//! Catches: a grid over objects or in files, wrong sizes, a change of several items that misses
//! some, a model that stays old or reloads in part.

use egui::Shape;
use egui_kittest::kittest::{By, NodeT as _, Queryable as _};
use glam::DVec3;
use marraztu::app::actions::{Action, Also, Request};
use marraztu_core::base::Shared;
use marraztu_core::edit::{Gesture, arrange, items};
use marraztu_core::scene::{
    Crease, ItemId, LightKind, LoadOptions, MaterialChoice, Object, PresetId, Scene,
};
use marraztu_io as io;

use crate::editor::Editor;

/// The thin lines over the picture.
fn lines(editor: &Editor) -> Vec<[egui::Pos2; 2]> {
    let rect = editor.picture();
    let mut lines = Vec::new();
    for clipped in &editor.harness.output().shapes {
        if let Shape::LineSegment { points, stroke } = &clipped.shape
            && stroke.width <= 1.0
            && clipped.clip_rect == rect
        {
            lines.push(*points);
        }
    }
    lines
}

#[test]
#[expect(clippy::cast_possible_truncation, reason = "places within the picture")]
fn the_grid_lies_behind_everything_and_in_no_file() {
    let mut editor = Editor::new();
    // Seen from above, the ships are in front of the ground.
    editor.perform_all(&[Action::ToggleGizmo, Action::LookTop, Action::FrameAll]);
    let (before, picture) = (lines(&editor).len(), editor.harness.state().shown_picture().unwrap());
    editor.perform(Action::ToggleGrid);
    let all = lines(&editor);
    assert!(all.len() > before + 40, "{} lines", all.len());
    let shown = editor.harness.state().shown_picture().unwrap();
    assert!(shown.pixels() == picture.pixels(), "the picture itself has no grid");
    let (rect, size) = (editor.picture(), shown.size());
    let mut covered = 0;
    for [a, b] in &all {
        let part = (*a + (*b - *a) * 0.5 - rect.min) / rect.size();
        let x = ((part.x * size.width as f32) as usize).min(size.width - 1);
        let y = ((part.y * size.height as f32) as usize).min(size.height - 1);
        let [r, g, b, _] = shown.pixels()[y * size.width + x];
        covered += usize::from([r, g, b] != editor.scene().background.0);
    }
    assert_eq!(covered, 0, "lines over objects");
    assert_eq!(editor.steps(), 0, "helpers and views are no steps");
}

pub(crate) fn texts(editor: &Editor) -> Vec<String> {
    fn collect(shape: &Shape, texts: &mut Vec<String>) {
        match shape {
            Shape::Vec(all) => all.iter().for_each(|shape| collect(shape, texts)),
            Shape::Text(text) => texts.push(text.galley.text().to_owned()),
            _ => {}
        }
    }
    let mut texts = Vec::new();
    editor.harness.output().shapes.iter().for_each(|it| collect(&it.shape, &mut texts));
    texts
}

#[test]
fn sizes_equal_the_bounding_box_in_the_world() {
    let mut editor = Editor::tall();
    editor.perform_all(&[Action::AddCube, Action::ToggleDimensions]);
    let size = {
        let scene = editor.scene();
        let object = scene.objects.get(editor.view().object.unwrap()).unwrap();
        arrange::world_box(object, 0.0).unwrap().extent()
    };
    assert_eq!(size, DVec3::splat(size.x));
    for letter in ["x", "y", "z"] {
        let text = format!("{letter} {}", size.x);
        assert!(texts(&editor).contains(&text), "{text}");
    }
    let whole = format!("{0} x {0} x {0}", size.x);
    assert!(editor.shows(&whole), "in the properties, too");
}

#[test]
fn directions_of_all_lights_are_drawn_on_request() {
    let mut editor = Editor::new();
    editor.perform_all(&[Action::AddSun, Action::AddSpot, Action::SubjectCamera]);
    let before = lines(&editor).len();
    editor.perform(Action::ToggleDirections);
    assert!(lines(&editor).len() > before + 32, "a cone has 32 sides");
}

#[test]
fn objects_are_dropped_and_brought_in_line_in_one_step() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    editor.perform(Action::SelectAll);
    let steps = editor.steps();
    editor.perform(Action::DropToGround);
    let boxes = |editor: &Editor| -> Vec<marraztu_core::scene::Bounds> {
        let scene = editor.scene();
        scene.objects.iter().map(|(_, it)| arrange::world_box(it, 0.0).unwrap()).collect()
    };
    assert!(boxes(&editor).iter().all(|it| it.min.y.abs() < 1e-9), "{:?}", boxes(&editor));
    editor.perform(Action::AlignZ);
    let middles: Vec<f64> = boxes(&editor).iter().map(|it| it.centre().z).collect();
    assert!(middles.iter().all(|z| (z - middles[0]).abs() < 1e-9), "{middles:?}");
    assert_eq!(editor.steps(), steps + 2);
}

#[test]
fn several_lights_show_mixed_numbers_and_are_set_together() {
    let mut editor = Editor::tall();
    editor.perform_all(&[Action::AddSpot, Action::AddSpot]);
    let spots: Vec<_> = {
        let scene = editor.scene();
        let own = scene.lights.iter().filter(|(_, it)| it.name.starts_with("spot"));
        own.map(|(id, _)| id).collect()
    };
    let [first, second] = spots[spots.len() - 2..] else { panic!("{spots:?}") };
    let narrow = marraztu_core::edit::lights::set_number(
        &editor.scene(),
        second,
        &marraztu_core::scene::HALF_APERTURE,
        10.0,
    )
    .unwrap();
    change(&mut editor, narrow);
    let both = vec![ItemId::Light(first), ItemId::Light(second)];
    editor.ask(Request::SelectAlso(both, Also::Only));
    let field = editor.harness.query_all(By::new().label("Half-aperture")).next().unwrap();
    assert_eq!(field.value().as_deref().map(|it| it.contains("mixed")), Some(true));
    // Shadows switched on for one light are switched on for both.
    editor.click_label("Casts shadows");
    let scene = editor.scene();
    let casts = |id| scene.lights.get(id).unwrap().shadows;
    assert!(casts(first) && casts(second));
    assert!(matches!(scene.lights.get(second).unwrap().kind, LightKind::Spot { .. }));
}

fn change(editor: &mut Editor, command: marraztu_core::scene::Command) {
    let (gesture, label) = (Gesture::Whole, "Change".to_owned());
    editor.ask(Request::Change { command, gesture, label });
}

const ONE: &str = "v 0 0 0\nv 60 0 0\nv 0 60 0\nf 1 2 3\n";
const TWO: &str = "v 0 0 0\nv 60 0 0\nv 0 60 0\nv 60 60 0\nf 1 2 3\nf 2 4 3\n";
const THREE: &str = "v 0 0 0\nv 60 0 0\nv 0 60 0\nf 1 2 3\nf 1 2 3\nf 1 2 3\n";

/// An editor with a model file of one triangle.
fn with_file(path: &std::path::Path) -> Editor {
    std::fs::write(path, ONE).unwrap();
    with_model(path)
}

/// An editor with this model file.
fn with_model(path: &std::path::Path) -> Editor {
    let loaded = io::load(path, &LoadOptions::default(), &io::Progress::new()).unwrap();
    let silver = MaterialChoice::Preset(PresetId::SILVER);
    let object = Object::new(Shared::new(loaded.model), silver);
    let mut editor = Editor::new();
    let command = items::insert_object(&editor.scene(), object);
    change(&mut editor, command);
    assert_eq!(polygons(&editor.scene()), 1);
    editor
}

/// The number of polygons of the first object.
fn polygons(scene: &Scene) -> usize {
    scene.objects.iter().next().unwrap().1.model.mesh.polygon_count()
}

fn until(editor: &mut Editor, is_done: impl Fn(&Editor) -> bool) {
    for _ in 0..400 {
        if is_done(editor) {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
        editor.settle();
    }
    panic!("it does not come");
}

#[test]
fn models_are_read_again_in_one_step_and_a_broken_file_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sail.obj");
    let mut editor = with_file(&path);
    let before = editor.scene();
    std::fs::write(&path, TWO).unwrap();
    editor.perform(Action::ReloadModels);
    until(&mut editor, |editor| polygons(&editor.scene()) == 2);
    assert_eq!(editor.state().history.steps().last(), Some("Reload sail"));
    editor.perform(Action::Undo);
    assert!(editor.scene() == before);
    std::fs::remove_file(&path).unwrap();
    editor.perform(Action::ReloadModels);
    until(&mut editor, |editor| editor.shows("The model is unchanged"));
    assert!(editor.scene() == before);
    // Without model files there is nothing to reload.
    let mut editor = Editor::new();
    editor.perform(Action::ReloadModels);
    let told = editor.harness.get_by_role(egui::accesskit::Role::Alert).accesskit_node().label();
    assert_eq!(told.as_deref(), Some("no object was loaded from a file"));
}

#[test]
fn a_file_that_is_saved_again_while_it_is_reloaded_is_shown_in_its_last_version() {
    // Between two reloads, the user does nothing, or changes the model's options.
    for changes_crease in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sail.obj");
        let mut editor = with_file(&path);
        let ctx = editor.harness.ctx.clone();
        for version in [TWO, THREE] {
            std::fs::write(&path, version).unwrap();
            let app = editor.harness.state_mut();
            app.perform(&ctx, Action::ReloadModels, Gesture::Whole);
            // No frame takes the first version before the second is read.
            std::thread::sleep(std::time::Duration::from_millis(200));
        }
        if changes_crease {
            let id = editor.scene().objects.ids().next().unwrap();
            let crease = Crease::new(90.0).unwrap();
            let command = items::set_crease(&editor.scene(), id, crease).unwrap();
            change(&mut editor, command);
        }
        until(&mut editor, |editor| polygons(&editor.scene()) == 3);
    }
}

#[test]
fn a_file_that_another_program_saves_is_reloaded_automatically() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sail.obj");
    let mut editor = with_file(&path);
    editor.perform(Action::ToggleWatch);
    std::fs::write(&path, TWO).unwrap();
    until(&mut editor, |editor| polygons(&editor.scene()) == 2);
    editor.perform(Action::ToggleWatch);
    assert_eq!(Action::ToggleWatch.is_on(editor.state()), Some(false));
}

#[test]
fn a_material_file_that_another_program_saves_is_reloaded_with_its_model() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sail.obj");
    let paint = |text: &str| {
        std::fs::write(folder.path().join("sail.mtl"), format!("newmtl paint\n{text}\n")).unwrap();
    };
    paint("Kd 1 0 0");
    std::fs::write(&path, format!("mtllib sail.mtl\nusemtl paint\n{ONE}")).unwrap();
    let mut editor = with_model(&path);
    editor.perform(Action::ToggleWatch);
    let before = editor.scene();
    paint("Kd 0 0.5 0");
    until(&mut editor, |editor| editor.scene() != before);
    assert_eq!(editor.state().history.steps().last(), Some("Reload sail"));
}

#[test]
fn a_model_that_has_changed_on_disk_is_mentioned_and_reloaded_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sail.obj");
    let mut editor = with_file(&path);
    editor.settle();
    for (text, reloads) in [(TWO, false), (ONE, true)] {
        std::fs::write(&path, text).unwrap();
        until(&mut editor, |editor| editor.shows("sail.obj has changed on disk"));
        let before = editor.scene();
        if reloads {
            editor.perform(Action::ReloadModels);
        } else {
            crate::panels::click(&mut editor, egui::accesskit::Role::Button, "Reload");
        }
        until(&mut editor, |editor| editor.scene() != before);
        editor.settle();
        assert!(!editor.shows("has changed on disk"));
    }
}

/// The white borders over the picture: that of the item under the pointer.
fn borders(editor: &Editor) -> Vec<egui::Mesh> {
    let shapes = editor.harness.output().shapes.iter();
    let meshes = shapes.filter_map(|clipped| match &clipped.shape {
        Shape::Mesh(mesh) => Some(egui::Mesh::clone(mesh)),
        _ => None,
    });
    let is_white = |mesh: &egui::Mesh| {
        mesh.texture_id == egui::TextureId::default()
            && mesh.vertices.iter().any(|vertex| vertex.color == egui::Color32::WHITE)
    };
    meshes.filter(is_white).collect()
}

/// The place of the ship at (-100, 0, 0), seen from (0, 0, 400).
fn ship(editor: &Editor) -> egui::Pos2 {
    let rect = editor.picture();
    let aside = -100.0 / 400.0 / 22.5_f32.to_radians().tan();
    rect.center() + egui::vec2(aside, 0.0) * rect.size().min_elem() / 2.0
}

#[test]
fn the_border_under_the_pointer_is_that_of_the_picture_on_screen() {
    let mut editor = Editor::new();
    let ship = ship(&editor);
    editor.hover(ship);
    editor.settle();
    let before = borders(&editor);
    assert_eq!(before.len(), 1, "the pointer is over a ship");
    // The camera moves, and the very first frame with the new picture is looked at.
    let ctx = editor.harness.ctx.clone();
    editor.harness.state_mut().perform(&ctx, Action::StepZUp, Gesture::Whole);
    editor.harness.step();
    editor.harness.state().wait_for_picture();
    editor.harness.step();
    let first = borders(&editor);
    assert_ne!(first, before);
    editor.settle();
    assert_eq!(first, borders(&editor));
    // Another scene has other borders.
    editor.harness.state_mut().perform(&ctx, Action::SubjectObject, Gesture::Whole);
    editor.harness.state_mut().perform(&ctx, Action::Delete, Gesture::Whole);
    editor.harness.step();
    editor.harness.state().wait_for_picture();
    editor.harness.step();
    assert!(borders(&editor).is_empty(), "the ship is gone");
}

#[test]
fn a_wall_under_the_pointer_has_no_border() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wall.obj");
    let wall = "v -9e3 -9e3 -900\nv 9e3 -9e3 -900\nv 9e3 9e3 -900\nv -9e3 9e3 -900\nf 1 2 3 4\n";
    std::fs::write(&path, wall).unwrap();
    let mut editor = with_model(&path);
    let at = editor.at(0.5, 0.9);
    editor.hover(at);
    editor.settle();
    assert!(editor.shows("wall") && borders(&editor).is_empty());
    let ship = ship(&editor);
    editor.hover(ship);
    editor.settle();
    assert_eq!(borders(&editor).len(), 1);
}

/// The texts over the picture, with their places.
fn places(editor: &Editor) -> Vec<(String, egui::Rect)> {
    fn collect(shape: &Shape, clip: egui::Rect, places: &mut Vec<(String, egui::Rect)>) {
        match shape {
            Shape::Vec(all) => all.iter().for_each(|shape| collect(shape, clip, places)),
            Shape::Text(text) => {
                let rect = text.visual_bounding_rect().intersect(clip);
                if rect.width() > 1.0 && rect.height() > 1.0 {
                    places.push((text.galley.text().to_owned(), rect));
                }
            }
            _ => {}
        }
    }
    let (mut places, picture) = (Vec::new(), editor.picture());
    for clipped in &editor.harness.output().shapes {
        collect(&clipped.shape, clipped.clip_rect, &mut places);
    }
    // Letters of the axes may lie one behind the other.
    places.retain(|(text, rect)| picture.contains_rect(*rect) && text.chars().count() > 2);
    places
}

#[test]
fn statistics_history_and_dial_do_not_share_a_corner() {
    use marraztu::app::panels::Panel;
    for [width, height] in [[1280.0, 800.0], [640.0, 400.0]] {
        let mut editor = Editor::of_size(width, height);
        for _ in 0..20 {
            editor.perform(Action::StepXUp);
        }
        editor.perform_all(&[Action::Panel(Panel::History), Action::Panel(Panel::Statistics)]);
        editor.hover(editor.at(0.5, 0.5));
        editor.harness.run_steps(3);
        let all = places(&editor);
        for text in ["triangles drawn", "History"] {
            let is_it = |(other, _): &(String, egui::Rect)| other.contains(text);
            assert!(all.iter().any(is_it), "{text} in {width} x {height}: {all:?}");
        }
        for (i, (text, rect)) in all.iter().enumerate() {
            for (other, place) in &all[i + 1..] {
                let both = rect.intersect(*place);
                let overlap = both.width() > 2.0 && both.height() > 3.0;
                assert!(!overlap, "{text:?} and {other:?} share {both} in {width} x {height}");
            }
        }
    }
}
