//! The menu of shapes, and shapes in scene files.
//!
//! Catches: a plane that cuts through the objects on it, a shape saved as a file, an added shape
//! that is not the subject.

use marraztu::app::actions::Action;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{Shape, Subject, dvec3};
use marraztu_io::{self as io, Progress};

use crate::editor::Editor;

const ADD: [Action; 6] = [
    Action::AddGround,
    Action::AddPlane,
    Action::AddCube,
    Action::AddSphere,
    Action::AddCylinder,
    Action::AddTorus,
];

#[test]
fn shapes_are_added_by_their_actions_and_come_back_from_a_scene_file_by_their_kind() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shapes.marraztu");
    let mut editor = Editor::small();
    for (action, shape) in ADD.into_iter().zip(Shape::ALL) {
        let before = editor.steps();
        editor.perform(action);
        assert_eq!(editor.steps(), before + 1);
        let (scene, view) = (editor.scene(), editor.view());
        let object = scene.objects.get(view.object.unwrap()).unwrap();
        assert_eq!((&*object.name, view.subject), (shape.name(), Subject::Object));
        assert!(object.model == shape.model());
    }
    let scene = editor.scene();
    io::save(&path, &scene, &editor.view(), &Settings::default()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("Own(\"torus\")") && text.contains("Own(\"ground\")"));
    let opened = io::open(&path, &Progress::new()).unwrap();
    assert!(opened.findings.is_empty());
    assert!(opened.scene.objects == scene.objects);
}

#[test]
fn the_plane_lies_below_everything_and_touches_it() {
    let mut editor = Editor::small();
    let lowest = |editor: &Editor, plane: bool| {
        let scene = editor.scene();
        let of = scene.objects.iter().filter(|(_, object)| (object.name == "plane") == plane);
        let heights = of.flat_map(|(_, object)| {
            let m = object.world_from_object(0.0);
            object.model.mesh.positions().iter().map(move |p| m.transform_point3(dvec3(*p)).y)
        });
        heights.fold(f64::INFINITY, f64::min)
    };
    let floor = lowest(&editor, false);
    editor.perform(Action::AddPlane);
    assert_eq!(lowest(&editor, true), floor);
    // The ground does not enlarge steps or further shapes.
    let scale = |editor: &Editor| {
        let scene = editor.scene();
        let (_, first) = scene.objects.iter().next().unwrap();
        first.placement.now().x_axis.x
    };
    assert_eq!(scale(&editor), 1000.0);
    editor.perform(Action::AddCube);
    assert_eq!(scale(&editor), 100.0);
    assert!(floor < 0.0);
}
