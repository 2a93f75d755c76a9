//! Zooming to a surface, the automatic near plane, earlier viewpoints, and the axes in the corner.
//!
//! Catches: a wheel that passes through the surface under the pointer or is cut open by the near
//! plane, in fly and in analysis; a near plane that stays near; a view that cannot be undone, or is
//! a step of the history; a disc of the axes that only looks like a handle.

use egui::{Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, vec2};
use glam::DVec3;
use marraztu::app::actions::Action;
use marraztu::app::actions::Chord::{Alt, Command, Lower, Named};
use marraztu::app::actions::Request;
use marraztu_core::edit::{Gesture, arrange, items};
use marraztu_core::scene::{Bounds, Lens, Pose};
use marraztu_io::{self as io, Progress};

use crate::editor::Editor;

const LEFT: PointerButton = PointerButton::Primary;

fn pose(editor: &Editor) -> Pose {
    *editor.scene().selected_camera(&editor.view()).pose.now()
}

fn lens(editor: &Editor) -> Lens {
    editor.scene().selected_camera(&editor.view()).lens
}

/// Turns the wheel; `waits` for the picture, which a fast hand does not.
fn wheel(editor: &mut Editor, notches: f32, waits: bool) {
    editor.harness.event(egui::Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, notches),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    if waits { editor.settle() } else { editor.harness.step() }
}

/// An editor with a single cube in the middle of the picture.
fn with_cube() -> (Editor, Bounds) {
    let mut editor = Editor::small();
    editor.perform_all(&[Action::SubjectObject, Action::SelectAll, Action::Delete]);
    editor.perform_all(&[Action::AddCube, Action::FrameSelection]);
    let scene = editor.scene();
    let (_, cube) = scene.objects.iter().next().unwrap();
    let bounds = arrange::world_box(cube, 0.0).unwrap();
    editor.hover(editor.at(0.5, 0.5));
    (editor, bounds)
}

#[test]
fn the_wheel_slows_down_before_the_surface_under_the_pointer_and_never_passes_it() {
    for (analysis, notches, waits) in
        [(false, 1.0, true), (false, 4.0, false), (true, 1.0, false), (true, 5.0, true)]
    {
        let (mut editor, cube) = with_cube();
        editor.perform(Action::SubjectCamera);
        if analysis {
            editor.perform(Action::ToggleFrame);
        }
        let made = editor.steps();
        let first = (pose(&editor), lens(&editor).near);
        let away = |editor: &Editor| pose(editor).eye.z - cube.max.z;
        let mut steps = Vec::new();
        for _ in 0..200 {
            let before = away(&editor);
            wheel(&mut editor, notches, waits);
            steps.push(before - away(&editor));
            assert!(away(&editor) > 0.0, "it is {} behind the surface", -away(&editor));
            let near = lens(&editor).near;
            assert!(near < away(&editor), "the plane at {near} cuts at {}", away(&editor));
        }
        assert!(away(&editor) < cube.extent().x / 100.0, "it comes close: {}", away(&editor));
        assert!(steps[20] < steps[10] && steps[10] < steps[0], "{steps:?}");
        assert!(editor.state().message.is_some(), "it says why it stops");
        for _ in 0..200 {
            wheel(&mut editor, -1.0, false);
            if away(&editor) > first.0.eye.z - cube.max.z {
                break;
            }
        }
        assert_eq!(lens(&editor).near, first.1, "the near plane has returned");
        assert_eq!(editor.steps(), made, "looking around is no step");
    }
}

#[test]
fn a_near_plane_that_is_set_by_hand_stays_and_stops_the_wheel_before_it_cuts() {
    let (mut editor, cube) = with_cube();
    let id = editor.view().camera;
    let fixed = Lens { near: 2.0, automatic_near: false, ..lens(&editor) };
    let command = items::set_lens(&editor.scene(), id, fixed).unwrap();
    let (gesture, label) = (Gesture::Whole, "Lens".to_owned());
    editor.ask(Request::Change { command, gesture, label });
    for _ in 0..100 {
        wheel(&mut editor, 1.0, false);
        assert!(pose(&editor).eye.z - cube.max.z >= 2.0 - 1e-9);
    }
    assert_eq!(lens(&editor), fixed);
    // It is part of the scene's file.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("near.marraztu");
    let (scene, view, settings) = (editor.scene(), editor.view(), editor.state().settings);
    io::save(&path, &scene, &view, &settings).unwrap();
    let opened = io::open(&path, &Progress::new()).unwrap();
    assert_eq!(opened.scene.selected_camera(&opened.view).lens, fixed);
}

#[test]
fn a_near_plane_that_cuts_nothing_is_left_alone() {
    let mut editor = Editor::new();
    let before = lens(&editor);
    editor.perform_all(&[Action::FrameAll, Action::LookTop, Action::LookFront]);
    let framed = lens(&editor);
    for _ in 0..10 {
        wheel(&mut editor, 1.0, false);
        wheel(&mut editor, -1.0, false);
    }
    editor.press(Lower(Key::Z));
    assert_eq!(lens(&editor), framed);
    assert!(before.automatic_near && before.near == 1.0);
}

#[test]
fn earlier_views_come_back_one_by_one_and_later_ones_again() {
    let mut editor = Editor::new();
    let mut seen = vec![pose(&editor)];
    assert!(Action::PreviousView.availability(editor.state()).is_err());
    editor.perform(Action::FrameAll);
    seen.push(pose(&editor));
    let places = [(0.5, 0.2), (0.55, 0.25), (0.6, 0.2)].map(|(x, y)| editor.at(x, y));
    editor.drag(LEFT, &places);
    seen.push(pose(&editor));
    editor.hover(editor.at(0.4, 0.2));
    for _ in 0..3 {
        wheel(&mut editor, 1.0, true);
    }
    seen.push(pose(&editor));
    editor.perform(Action::LookTop);
    seen.push(pose(&editor));
    for expected in seen.iter().rev().skip(1) {
        editor.press(Alt(Key::ArrowLeft));
        assert_eq!(pose(&editor), *expected);
    }
    editor.press(Alt(Key::ArrowLeft));
    assert_eq!(editor.state().message.as_ref().unwrap().text, "there is no earlier view");
    for expected in seen.iter().skip(1) {
        editor.press(Alt(Key::ArrowRight));
        assert_eq!(pose(&editor), *expected);
    }
    assert!(Action::NextView.availability(editor.state()).is_err());
    assert_eq!(editor.steps(), 0);
    assert!(editor.state().history.is_saved());
    // A new view takes the place of the later ones.
    editor.press(Alt(Key::ArrowLeft));
    editor.perform(Action::LookRight);
    assert!(Action::NextView.availability(editor.state()).is_err());
    editor.press(Alt(Key::ArrowLeft));
    assert_eq!(pose(&editor), seen[3]);
}

#[test]
fn the_projection_and_the_camera_come_back_with_the_view_and_changes_of_objects_stay() {
    let mut editor = Editor::new();
    let (first, view) = (pose(&editor), editor.view());
    editor.perform(Action::ToggleProjection);
    editor.perform_all(&[Action::SubjectObject, Action::StepXUp, Action::LookTop]);
    let moved = editor.scene().objects.clone();
    editor.perform_all(&[Action::PreviousView, Action::PreviousView]);
    assert_eq!((pose(&editor), editor.view().projection), (first, view.projection));
    assert!(editor.scene().objects == moved);
    editor.press(Command(Key::Z));
    assert_eq!(pose(&editor), first, "Ctrl+Z undoes the move of the object alone");
    assert!(editor.scene().objects != moved);
    // A camera that is gone is skipped.
    editor.perform_all(&[Action::SubjectCamera, Action::Duplicate]);
    let copy = editor.view().camera;
    editor.perform(Action::LookRight);
    editor.perform_all(&[Action::Delete, Action::PreviousView]);
    assert_ne!(editor.view().camera, copy);
}

#[test]
fn a_cancelled_drag_leaves_no_earlier_view() {
    let mut editor = Editor::new();
    let [from, to] = [(0.5, 0.2), (0.7, 0.3)].map(|(x, y)| editor.at(x, y));
    editor.hover(from);
    editor.button(from, LEFT, true);
    editor.hover(to);
    editor.press(Named(Key::Escape));
    editor.button(to, LEFT, false);
    assert!(Action::PreviousView.availability(editor.state()).is_err());
}

#[test]
fn the_saved_view_is_the_one_of_the_opened_or_saved_scene() {
    let mut editor = Editor::new();
    let first = pose(&editor);
    assert!(Action::SavedView.availability(editor.state()).is_err());
    editor.perform_all(&[Action::FrameAll, Action::LookTop]);
    let top = pose(&editor);
    editor.perform(Action::SavedView);
    assert_eq!(pose(&editor), first);
    editor.press(Alt(Key::ArrowLeft));
    assert_eq!(pose(&editor), top, "it can be undone, too");
    assert_eq!(editor.steps(), 0);
}

/// The middle of the axes' disc in the upper right corner of the picture.
fn axes(editor: &Editor) -> Pos2 {
    editor.picture().right_top() + vec2(-46.0, 46.0)
}

#[test]
fn a_drag_of_the_axes_orbits_and_a_click_on_an_end_looks_along_it() {
    let mut editor = Editor::new();
    editor.perform(Action::SubjectObject);
    let before = pose(&editor);
    let object = editor.view().object.unwrap();
    let centre = editor.scene().objects.get(object).unwrap().centre(0.0);
    // From the letter X, over the disc.
    let from = axes(&editor) + vec2(30.0, 0.0);
    editor.drag(LEFT, &[from, from - vec2(40.0, 10.0), from - vec2(60.0, 20.0)]);
    let after = pose(&editor);
    assert!(after.eye.distance(before.eye) > 10.0, "it orbits in fly, too");
    let distances = [before, after].map(|pose| pose.eye.distance(centre));
    assert!((distances[0] - distances[1]).abs() < 1e-6, "{distances:?}");
    editor.press(Alt(Key::ArrowLeft));
    assert_eq!(pose(&editor), before);
    editor.harness.run_steps(60);
    editor.click(from, LEFT);
    assert!((pose(&editor).axes.z_axis - DVec3::X).length() < 1e-9, "from the right");
    assert_eq!(editor.steps(), 0);
}

#[test]
fn a_click_on_the_disc_between_the_ends_selects_nothing_behind_it() {
    let mut editor = Editor::new();
    let (view, scene) = (editor.view(), editor.scene());
    editor.click(axes(&editor) + vec2(18.0, 18.0), LEFT);
    assert_eq!(editor.view(), view);
    assert!(editor.scene() == scene);
}
