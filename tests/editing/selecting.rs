//! The selection after each change.

use marraztu_core::edit::selection::{self, cycle_subject};
use marraztu_core::edit::{GesturePhase, Refusal, items};
use marraztu_core::scene::{
    CameraId, Command, ItemId, LightId, ObjectId, Observer, PolygonMode, Subject, Transformation,
};

use super::desk::Desk;

fn desk(subject: Subject) -> Desk {
    Desk::new(subject, Transformation::Translation)
}

#[test]
fn tab_goes_round_the_list_of_the_subject() {
    let mut desk = desk(Subject::Object);
    let mut seen = Vec::new();
    for _ in 0..4 {
        desk.choose(selection::next(&desk.scene, &desk.view, GesturePhase::First));
        seen.push(desk.view.object.unwrap().0);
    }
    assert_eq!(seen, [2, 1, 3, 2]);
    desk.view.subject = Subject::Light;
    for _ in 0..4 {
        desk.choose(selection::next(&desk.scene, &desk.view, GesturePhase::First));
    }
    assert_eq!(desk.view.light, Some(LightId(4)), "from the sun round to ambient light");
    desk.view.subject = Subject::Camera;
    assert_eq!(
        selection::next(&desk.scene, &desk.view, GesturePhase::First),
        Err(Refusal::OnlyOne)
    );
}

#[test]
fn the_subject_goes_round_and_leaving_objects_ends_scaling() {
    let mut desk = desk(Subject::Camera);
    let mut seen = Vec::new();
    for _ in 0..3 {
        cycle_subject(&mut desk.view);
        seen.push(desk.view.subject);
        if desk.view.subject == Subject::Object {
            selection::set_transformation(&mut desk.view, Transformation::Scaling).unwrap();
        }
    }
    assert_eq!(seen, [Subject::Object, Subject::Light, Subject::Camera]);
    assert_eq!(desk.view.transformation, Transformation::Translation);
    selection::set_transformation(&mut desk.view, Transformation::Rotation).unwrap();
    cycle_subject(&mut desk.view);
    assert_eq!(desk.view.transformation, Transformation::Rotation, "only scaling is left");
}

#[test]
fn enter_goes_round_the_polygons_and_another_object_begins_at_0() {
    let mut desk = desk(Subject::Object);
    let enter = |desk: &mut Desk| selection::next_polygon(&desk.scene, &mut desk.view);
    assert_eq!(enter(&mut desk), Err(Refusal::NotInPolygonMode));
    selection::toggle_polygons(&desk.scene, &mut desk.view).unwrap();
    assert_eq!(desk.view.polygons, Some(PolygonMode::begin()));
    enter(&mut desk).unwrap();
    let mode = desk.view.polygons.clone().unwrap();
    assert_eq!((mode.current, mode.shown.len()), (1, 2));
    enter(&mut desk).unwrap();
    assert_eq!(desk.view.polygons.as_ref().unwrap().current, 0, "round");

    let same = selection::select(&desk.scene, &desk.view, ItemId::Object(ObjectId(3))).unwrap();
    assert_eq!(same.view.polygons.unwrap().shown.len(), 2, "no change of selection");
    let other = selection::select(&desk.scene, &desk.view, ItemId::Object(ObjectId(1))).unwrap();
    assert_eq!(other.view.polygons, Some(PolygonMode::begin()));
    let far = selection::go_to_polygon(&desk.scene, &mut desk.view, 2);
    assert_eq!(far, Err(Refusal::Gone));
}

#[test]
fn after_a_removal_the_next_is_selected_else_the_one_before() {
    let mut desk = desk(Subject::Object);
    desk.view.polygons = Some(PolygonMode::begin());
    selection::next_polygon(&desk.scene, &mut desk.view).unwrap();
    desk.choose(selection::next(&desk.scene, &desk.view, GesturePhase::First));
    let remove = |desk: &mut Desk| {
        let id = ItemId::Object(desk.view.object.unwrap());
        desk.perform(items::remove(&desk.scene, id));
        desk.view.object.map(|id| id.0)
    };
    assert_eq!(remove(&mut desk), Some(1), "of 3, 2, 1 the one after 2");
    assert_eq!(desk.view.polygons, Some(PolygonMode::begin()));
    assert_eq!(remove(&mut desk), Some(3), "the one before the last");
    desk.view.observer = Observer::Object;
    assert_eq!(remove(&mut desk), None);
    assert_eq!(desk.view.observer, Observer::Camera);
    assert_eq!(desk.view.polygons, None);
    let refusal = selection::toggle_observer(&desk.scene, &mut desk.view);
    assert_eq!(refusal.unwrap_err().to_string(), "there is no object");
}

#[test]
fn items_that_undo_restores_are_selected_and_items_that_it_removes_are_not() {
    let mut desk = desk(Subject::Object);
    let back =
        desk.perform(items::duplicate(&desk.scene, ItemId::Object(ObjectId(2)), glam::DVec3::ZERO));
    assert_eq!(desk.view.object, Some(ObjectId(9)), "the new one is selected");
    desk.perform(Ok(back));
    assert_eq!(desk.view.object, Some(ObjectId(3)));
    desk.choose(selection::select(&desk.scene, &desk.view, ItemId::Object(ObjectId(1))));
    let back = desk.perform(items::remove(&desk.scene, ItemId::Object(ObjectId(1))));
    assert_eq!(desk.view.object, Some(ObjectId(2)));
    desk.perform(Ok(back));
    assert_eq!(desk.view.object, Some(ObjectId(1)));
}

#[test]
fn a_view_that_names_missing_items_is_corrected() {
    let mut desk = desk(Subject::Light);
    desk.view.object = Some(ObjectId(77));
    desk.view.camera = CameraId(77);
    desk.view.light = Some(LightId(77));
    desk.view.transformation = Transformation::Scaling;
    desk.view.polygons = Some(PolygonMode { current: 9, shown: [0, 9].into() });
    selection::settle(&desk.scene, &mut desk.view);
    assert_eq!(desk.view.object, Some(ObjectId(3)));
    assert_eq!(desk.view.camera, CameraId(0));
    assert_eq!(desk.view.light, Some(LightId(4)));
    assert_eq!(desk.view.transformation, Transformation::Translation);
    assert_eq!(desk.view.polygons, Some(PolygonMode::begin()));
}

#[test]
fn a_click_in_the_outline_makes_its_kind_the_subject() {
    let desk = desk(Subject::Camera);
    let picked = selection::pick(&desk.scene, &desk.view, ItemId::Light(LightId(6))).unwrap();
    assert_eq!(selection::selected(&picked.view), Some(ItemId::Light(LightId(6))));
    let gone = selection::pick(&desk.scene, &desk.view, ItemId::Light(LightId(99)));
    assert_eq!(gone, Err(Refusal::Gone));
}

#[test]
fn removing_another_item_leaves_the_selection_alone() {
    let mut desk = desk(Subject::Object);
    desk.perform(Ok(Command::Remove(ItemId::Object(ObjectId(1)))));
    assert_eq!(desk.view.object, Some(ObjectId(3)));
}
