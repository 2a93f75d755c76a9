//! The menu of shapes, and shapes in scene files.
//!
//! Catches: a plane that cuts through the objects on it, a shape saved as a file, an added shape
//! that is not the subject.

use glam::DMat3;
use marraztu::app::actions::Action;
use marraztu_core::accuracy::Settings;
use marraztu_core::scene::{Object, Shape, Subject, dvec3};
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
        assert_eq!(Shape::of(&object.model), Some(shape));
        assert_eq!(DMat3::from_mat4(*object.placement.now()), DMat3::IDENTITY);
    }
    let scene = editor.scene();
    io::save(&path, &scene, &editor.view(), &Settings::default()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("name: \"torus\"") && text.contains("name: \"ground\""));
    assert!(!text.contains("path"), "no shape is a file");
    let opened = io::open(&path, &Progress::new()).unwrap();
    assert!(opened.findings.is_empty());
    assert!(opened.scene.objects == scene.objects);
}

#[test]
fn shapes_of_older_files_are_scaled_objects_of_one_unit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.marraztu");
    let text = "(version: 1, objects: [(id: 0, name: \"cube\", model: Own(\"cube\"), placement: \
        ((100.0, 0.0, 0.0, 0.0), (0.0, 100.0, 0.0, 0.0), (0.0, 0.0, 100.0, 0.0), \
        (5.0, 50.0, 7.0, 1.0)))], cameras: [(id: 1, name: \"camera\", eye: (0.0, 0.0, 400.0))])";
    std::fs::write(&path, text).unwrap();
    let opened = io::open(&path, &Progress::new()).unwrap();
    let (_, cube) = opened.scene.objects.iter().next().unwrap();
    assert!(cube.model == Shape::Cube.model());
    assert_eq!((cube.placement.now().x_axis.x, cube.largest_extent()), (100.0, 100.0));
    assert!(opened.scene.selected_camera(&opened.view).lens.automatic_near);
    io::save(&path, &opened.scene, &opened.view, &Settings::default()).unwrap();
    assert!(std::fs::read_to_string(&path).unwrap().contains("Own(\"cube\")"));
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
    let size = |editor: &Editor| {
        let scene = editor.scene();
        scene.objects.iter().next().map(|(_, first): (_, &Object)| first.largest_extent()).unwrap()
    };
    assert_eq!(size(&editor), 1000.0);
    editor.perform(Action::AddCube);
    assert_eq!(size(&editor), 100.0);
    assert!(floor < 0.0);
}
