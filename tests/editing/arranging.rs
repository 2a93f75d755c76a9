//! Dropping objects to the ground, aligning them, and moving them back to their place in the file.
//!
//! Catches: an object above or below the ground, a vertical plane taken for the ground, an object
//! that also moves along another axis.

use glam::{DMat4, DVec3, EulerRot};
use marraztu_core::base::{Shared, math::Axis};
use marraztu_core::edit::arrange::{align, drop_to_ground, ground, reset, world_box};
use marraztu_core::edit::{GesturePhase, Refusal, items, shapes, transform};
use marraztu_core::scene::{
    ItemId, LoadOptions, MaterialChoice, Object, ObjectId, Scene, Shape, Subject, View,
};
use marraztu_io::{self as io, Progress};

fn lowest(scene: &Scene, id: ObjectId) -> f64 {
    world_box(scene.objects.get(id).unwrap(), 0.0).unwrap().min.y
}

#[test]
fn a_dropped_object_lands_on_the_ground_or_on_a_horizontal_plane() {
    let (mut scene, view) = io::default_scene();
    let id = view.object.unwrap();
    let first = GesturePhase::First;
    drop_to_ground(&scene, &view, first).unwrap().apply(&mut scene).unwrap();
    assert!(lowest(&scene, id).abs() < 1e-12);
    assert_eq!(drop_to_ground(&scene, &view, first), Err(Refusal::OnGround));
    let plane = scene.next_id;
    shapes::insert(&scene, &view, Shape::Plane).apply(&mut scene).unwrap();
    let up = DMat4::from_translation(DVec3::Y * 70.0);
    let of_plane = |object: &mut Object| {
        object.placement = object.placement.replaced(up * *object.placement.now());
    };
    let raise = items::change_object(&scene, ObjectId(plane), of_plane).unwrap();
    raise.apply(&mut scene).unwrap();
    let height = scene.objects.get(ObjectId(plane)).unwrap().placement.now().w_axis.y;
    drop_to_ground(&scene, &view, first).unwrap().apply(&mut scene).unwrap();
    assert!((lowest(&scene, id) - height).abs() < 1e-9, "{height}");
    // A vertical plane does not count as ground.
    let turn = DMat4::from_rotation_x(1.0);
    let tilt = |object: &mut Object| {
        object.placement = object.placement.replaced(*object.placement.now() * turn);
    };
    items::change_object(&scene, ObjectId(plane), tilt).unwrap().apply(&mut scene).unwrap();
    assert_eq!(ground(&scene, id), 0.0);
}

#[test]
fn an_object_reaches_as_far_as_its_shown_parts() {
    let (mut scene, mut view) = io::empty_scene();
    let text = "v 0 1 0\nv 1 1 0\nv 0 2 0\nv 0 5 0\nv 1 5 0\nv 0 7 0\n\
        g low\nf 1 2 3\ng high\nf 4 5 6\n";
    let loaded = io::parse(text.as_bytes(), "a", None, &LoadOptions::default(), &Progress::new());
    let model = Shared::new(loaded.unwrap().model);
    let mut object = Object::new(model, MaterialChoice::File);
    let heights = |object: &Object| world_box(object, 0.0).map(|it| (it.min.y, it.max.y));
    assert_eq!(heights(&object), Some((1.0, 7.0)));
    object.hidden_parts = [0].into();
    assert_eq!(heights(&object), Some((5.0, 7.0)));
    let (middle, radius) = object.bounding_sphere(0.0).unwrap();
    assert_eq!(middle, DVec3::new(0.5, 6.0, 0.0));
    assert!((radius - 1.25_f64.sqrt()).abs() < 1e-12);
    // Its lowest shown point lands on the ground.
    items::insert_object(&scene, object.clone()).apply(&mut scene).unwrap();
    let id = scene.objects.first().unwrap();
    view.object = Some(id);
    drop_to_ground(&scene, &view, GesturePhase::First).unwrap().apply(&mut scene).unwrap();
    assert_eq!(lowest(&scene, id), 0.0);
    object.hidden_parts = [0, 1].into();
    assert_eq!(heights(&object), None);
}

#[test]
fn others_come_in_line_with_the_selected_object_along_one_axis_alone() {
    let (mut scene, view) = io::default_scene();
    let first = GesturePhase::First;
    let ids: Vec<ObjectId> = scene.objects.ids().collect();
    let others: Vec<ItemId> = ids.iter().copied().map(ItemId::Object).collect();
    let middles = |scene: &Scene| -> Vec<DVec3> {
        let middle = |id: &ObjectId| world_box(scene.objects.get(*id).unwrap(), 0.0);
        ids.iter().map(|id| middle(id).unwrap().centre()).collect()
    };
    let before = middles(&scene);
    let middle_x = |at: usize| before[at].x;
    align(&scene, &view, &others, Axis::X, first).unwrap().apply(&mut scene).unwrap();
    let after = middles(&scene);
    let own = ids.iter().position(|id| view.object == Some(*id)).unwrap();
    for (before, after) in before.iter().zip(&after) {
        assert!((after.x - middle_x(own)).abs() < 1e-9);
        assert!((after.y - before.y).abs() < 1e-9 && (after.z - before.z).abs() < 1e-9);
    }
    assert_eq!(align(&scene, &view, &[], Axis::X, first), Err(Refusal::NothingToAlign));
}

#[test]
fn objects_in_line_up_to_rounding_are_not_aligned_again() {
    let (mut scene, mut view) = io::default_scene();
    let ids: Vec<ObjectId> = scene.objects.ids().collect();
    let others: Vec<ItemId> = ids.iter().copied().map(ItemId::Object).collect();
    let place = |scene: &mut Scene, id, to: DMat4| {
        let place = |object: &mut Object| object.placement = object.placement.replaced(to);
        items::change_object(scene, id, place).unwrap().apply(scene).unwrap();
    };
    let places = [DVec3::new(3.1, 0.7, -0.3), DVec3::new(-0.117, 1e-9, 4e3)];
    for (i, id) in ids.iter().enumerate() {
        let turn = 0.3 + 1.1 * i as f64;
        let turn = DMat4::from_euler(EulerRot::XYZ, turn, 0.7 * turn, -0.4 * turn);
        place(&mut scene, *id, DMat4::from_translation(places[i % 2]) * turn);
    }
    let first = GesturePhase::First;
    for id in ids {
        view.object = Some(id);
        // The others are not in line with it yet.
        let now = *scene.objects.get(id).unwrap().placement.now();
        place(&mut scene, id, DMat4::from_translation(DVec3::new(0.1, 0.2, 0.3)) * now);
        for axis in Axis::ALL {
            align(&scene, &view, &others, axis, first).unwrap().apply(&mut scene).unwrap();
            let again = align(&scene, &view, &others, axis, first).err();
            assert_eq!(again, Some(Refusal::NothingToAlign), "{id:?} {axis:?}");
        }
    }
}

#[test]
fn a_reset_object_is_where_its_file_has_it() {
    let (mut scene, view) = io::default_scene();
    let first = GesturePhase::First;
    let id = view.object.unwrap();
    let before = *scene.objects.get(id).unwrap().placement.now();
    reset(&scene, &view, first).unwrap().apply(&mut scene).unwrap();
    assert_eq!(*scene.objects.get(id).unwrap().placement.now(), DMat4::IDENTITY);
    assert_eq!(reset(&scene, &view, first), Err(Refusal::NotTransformed));
    let back = transform::take_back(&scene, &View { subject: Subject::Object, ..view });
    back.unwrap().apply(&mut scene).unwrap();
    assert_eq!(*scene.objects.get(id).unwrap().placement.now(), before);
}
