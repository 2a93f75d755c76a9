//! Inserting, removing and changing items of the scene.

use glam::DVec3;
use marraztu_core::base::math::Axis;
use marraztu_core::edit::lights::{self, Channel};
use marraztu_core::edit::transform::Sign;
use marraztu_core::edit::{Refusal, items, motion};
use marraztu_core::scene::{
    CameraId, CommandError, ItemId, Lens, LightId, LightKind, MaterialChoice, Object, ObjectId,
    SpotOwner, Subject, Transformation,
};

use super::common;
use super::desk::{Desk, close, close_matrix, turned};

fn desk(subject: Subject) -> Desk {
    Desk::new(subject, Transformation::Translation)
}

fn names(desk: &Desk) -> Vec<&str> {
    desk.scene.objects.iter().map(|(_, object)| &*object.name).collect()
}

#[test]
fn a_new_object_goes_to_the_front_and_is_selected() {
    let mut desk = desk(Subject::Camera);
    for _ in 0..2 {
        let object = Object::new(common::model(), MaterialChoice::File);
        desk.perform(Ok(items::insert_object(&desk.scene, object)));
    }
    assert_eq!(names(&desk), ["plate 2", "plate", "object 3", "object 2", "object 1"]);
    assert_eq!(desk.view.object, Some(ObjectId(10)));
    assert_eq!((desk.scene.next_id, desk.view.subject), (11, Subject::Camera));
}

#[test]
fn inserting_objects_together_equals_inserting_them_one_by_one() {
    let objects = || {
        ["plate", "object 2", "plate", "object", "plate 2"].map(|name| {
            let mut object = Object::new(common::model(), MaterialChoice::File);
            object.name = name.to_owned();
            object
        })
    };
    let mut one_by_one = desk(Subject::Object);
    for object in objects() {
        one_by_one.perform(Ok(items::insert_object(&one_by_one.scene, object)));
    }
    let mut together = desk(Subject::Object);
    let before = together.scene.clone();
    let back = together.perform(Ok(items::insert_objects(&together.scene, objects().into())));
    assert_eq!(names(&together)[..3], ["plate 3", "object", "plate 2"]);
    assert!(together.scene == one_by_one.scene && together.view == one_by_one.view);
    together.perform(Ok(back));
    assert!(together.scene == before);
}

#[test]
fn a_change_of_all_objects_is_one_step() {
    let mut desk = desk(Subject::Object);
    let before = desk.scene.clone();
    let back = desk.perform(Ok(items::change_all_objects(&desk.scene, |object| {
        object.visible = false;
    })));
    assert!(desk.scene.objects.iter().all(|(_, object)| !object.visible));
    desk.perform(Ok(back));
    assert!(desk.scene == before);
}

#[test]
fn a_new_camera_is_placed_at_the_origin_and_selected() {
    let mut desk = desk(Subject::Camera);
    let command = items::insert_camera(&desk.scene, common::model(), MaterialChoice::File);
    let back = desk.perform(Ok(command));
    assert_eq!(desk.view.camera, CameraId(9));
    assert_eq!((desk.pose().eye, desk.pose().axes.z_axis), (DVec3::ZERO, DVec3::Z));
    assert_eq!(desk.scene.selected_camera(&desk.view).name, "camera 2");
    desk.perform(Ok(back));
    assert_eq!((desk.scene.next_id, desk.view.camera), (9, CameraId(0)));
}

#[test]
fn a_new_light_takes_the_lowest_free_slot() {
    let mut desk = desk(Subject::Light);
    desk.perform(items::remove(&desk.scene, ItemId::Light(LightId(6))));
    assert_eq!(desk.view.light, Some(LightId(5)), "another light than the selected one went");
    desk.perform(items::insert_light(&desk.scene, lights::sun()));
    let light = desk.scene.lights.get(desk.view.light.unwrap()).unwrap();
    assert_eq!((light.slot, &*light.name), (2, "sun 2"));
    desk.perform(items::insert_light(&desk.scene, lights::bulb()));
    assert_eq!(desk.scene.lights.get(desk.view.light.unwrap()).unwrap().slot, 5);
    let orphan = lights::spot(SpotOwner::Object(ObjectId(77)));
    assert_eq!(items::insert_light(&desk.scene, orphan), Err(Refusal::Gone));
}

#[test]
fn attached_items_are_removed_and_restored_with_their_owner() {
    let mut desk = desk(Subject::Light);
    for owner in [ObjectId(3), ObjectId(2), ObjectId(3)] {
        desk.perform(items::insert_light(&desk.scene, lights::spot(SpotOwner::Object(owner))));
    }
    let before = desk.scene.clone();
    let back = desk.perform(items::remove(&desk.scene, ItemId::Object(ObjectId(3))));
    let left: Vec<u32> = desk.scene.lights.iter().map(|(_, light)| light.slot).collect();
    assert_eq!(left, [0, 1, 2, 3, 4, 6]);
    desk.perform(Ok(back));
    assert_eq!(desk.scene, before);
}

#[test]
fn the_last_camera_stays() {
    let desk = desk(Subject::Camera);
    let refusal = items::remove(&desk.scene, ItemId::Camera(CameraId(0))).unwrap_err();
    assert_eq!(refusal, Refusal::Command(CommandError::LastCamera));
}

#[test]
fn a_copy_has_the_place_and_not_the_past() {
    let mut desk = desk(Subject::Object);
    desk.press(Axis::X, Sign::Positive);
    let placement = desk.placement();
    desk.perform(items::duplicate(&desk.scene, ItemId::Object(ObjectId(3)), DVec3::ZERO));
    assert_eq!((desk.placement(), desk.object().placement.depth()), (placement, 0));
    assert_eq!(names(&desk)[0], "object 4", "the first number that is free");
    desk.perform(items::duplicate(&desk.scene, ItemId::Light(LightId(6)), DVec3::ZERO));
    let light = desk.scene.lights.get(desk.view.light.unwrap()).unwrap();
    assert_eq!((light.slot, &*light.name), (5, "bulb 2"));
}

#[test]
fn the_parts_of_an_object_become_objects_that_share_its_model() {
    let mut desk = desk(Subject::Object);
    desk.perform(items::toggle_part(&desk.scene, ObjectId(2), 1));
    let before = desk.scene.clone();
    let back = desk.perform(items::split(&desk.scene, ObjectId(2)));
    assert_eq!(names(&desk), ["object 3", "lower", "upper", "object 1"]);
    let pieces = [ObjectId(2), ObjectId(9)].map(|id| desk.scene.objects.get(id).unwrap());
    assert_eq!(pieces.map(|piece| piece.hidden_parts.clone()), [[1].into(), [0].into()]);
    assert_eq!(pieces.map(|piece| piece.visible), [true, false], "what was hidden stays so");
    assert_eq!(pieces[0].placement.now(), pieces[1].placement.now());
    desk.perform(Ok(back));
    assert_eq!(desk.scene, before);
}

#[test]
fn names_are_trimmed_and_never_empty() {
    let mut desk = desk(Subject::Object);
    let id = ItemId::Object(ObjectId(3));
    desk.perform(items::rename(&desk.scene, id, "  hawk "));
    assert_eq!(desk.object().name, "hawk");
    assert_eq!(items::rename(&desk.scene, id, " "), Err(Refusal::NoName));
}

#[test]
fn a_lens_through_which_nothing_could_be_drawn_is_refused() {
    let desk = desk(Subject::Camera);
    let lens = Lens { far: 0.5, ..Lens::default() };
    let refusal = items::set_lens(&desk.scene, CameraId(0), lens).unwrap_err();
    assert_eq!(refusal, Refusal::Command(CommandError::Lens));
}

#[test]
fn a_digit_puts_the_light_in_its_slot_on_and_out() {
    let mut desk = desk(Subject::Camera);
    desk.perform(lights::toggle_slot(&desk.scene, 3));
    assert!(!desk.scene.lights.get(LightId(7)).unwrap().on);
    assert_eq!(lights::toggle_slot(&desk.scene, 5), Err(Refusal::EmptySlot(5)));
    assert_eq!(lights::set_slot(&desk.scene, LightId(7), 1), Err(Refusal::SlotTaken(1)));
    desk.perform(lights::set_slot(&desk.scene, LightId(7), 9));
    desk.perform(lights::toggle_slot(&desk.scene, 9));
    assert!(desk.scene.lights.get(LightId(7)).unwrap().on);
}

#[test]
fn a_colour_stays_within_0_and_255_and_belongs_to_the_subject_of_lights() {
    let mut desk = desk(Subject::Light);
    let step = |desk: &Desk, by| lights::step_color(&desk.scene, &desk.view, Channel::Green, by);
    assert_eq!(step(&desk, 1), Err(Refusal::Limit("green", 255)));
    for _ in 0..255 {
        desk.perform(step(&desk, -1));
    }
    assert_eq!(desk.scene.lights.get(LightId(5)).unwrap().color.0, [255, 0, 255]);
    assert_eq!(step(&desk, -1).unwrap_err().to_string(), "green is already at 0");
    desk.view.subject = Subject::Object;
    assert_eq!(step(&desk, 1), Err(Refusal::OnlyLights));
}

#[test]
fn a_half_aperture_stays_within_0_and_90_degrees_and_belongs_to_spots() {
    let mut desk = desk(Subject::Light);
    let step = |desk: &Desk, by| lights::step_aperture(&desk.scene, &desk.view, by);
    assert_eq!(step(&desk, 5.0), Err(Refusal::NotASpot));
    desk.view.light = Some(LightId(8));
    let aperture = |desk: &Desk| match desk.scene.lights.get(LightId(8)).unwrap().kind {
        LightKind::Spot { half_aperture, .. } => half_aperture,
        _ => f64::NAN,
    };
    for expected in [17.5, 12.5, 7.5, 2.5, 0.0] {
        desk.perform(step(&desk, -lights::APERTURE_STEP));
        assert_eq!(aperture(&desk), expected);
    }
    assert_eq!(step(&desk, -5.0), Err(Refusal::Limit("the half-aperture", 0)));
    while let Ok(command) = step(&desk, 5.0) {
        desk.perform(Ok(command));
    }
    assert_eq!(aperture(&desk), 90.0);
}

#[test]
fn switching_a_spin_off_leaves_the_object_as_it_was_seen() {
    let mut desk = desk(Subject::Object);
    let start = desk.placement();
    desk.perform(motion::toggle_spin(&desk.scene, ObjectId(3), Axis::Y, 2.0));
    assert_eq!(desk.object().placement.depth(), 0, "switching on moves nothing");
    // 30 degrees a second from second 2 to second 5.
    let seen = desk.object().world_from_object(5.0);
    close_matrix(seen, start * glam::DMat4::from_mat3(turned(Axis::Y, 90.0)));
    desk.perform(motion::toggle_spin(&desk.scene, ObjectId(3), Axis::X, 5.0));
    close_matrix(desk.object().world_from_object(5.0), seen);
    desk.perform(motion::apply_spin(&desk.scene, ObjectId(3), 6.0));
    assert!(desk.object().spin.is_on());
    let seen = desk.object().world_from_object(7.0);
    desk.perform(motion::toggle_spin(&desk.scene, ObjectId(3), Axis::X, 7.0));
    desk.perform(motion::toggle_spin(&desk.scene, ObjectId(3), Axis::Y, 7.0));
    assert!(!desk.object().spin.is_on());
    close_matrix(desk.placement(), seen);
    let refusal = motion::apply_spin(&desk.scene, ObjectId(3), 8.0);
    assert_eq!(refusal, Err(Refusal::NotSpinning));
}

#[test]
fn a_bulb_that_circles_is_moved_along_the_worlds_axes_as_it_is_seen() {
    let mut desk = desk(Subject::Light);
    desk.perform(motion::toggle_orbit(&desk.scene, LightId(6), 1.0));
    desk.view.light = Some(LightId(6));
    // A quarter turn later the light is seen at (-200, 0, 0). It moves 10 along X and stops there.
    desk.view.time = 4.0;
    desk.press(Axis::X, Sign::Positive);
    desk.perform(motion::toggle_orbit(&desk.scene, LightId(6), 4.0));
    close(desk.light().0, DVec3::X * -190.0);
}

#[test]
fn a_bulb_that_stops_circling_stays_where_it_is() {
    let mut desk = desk(Subject::Light);
    desk.perform(motion::toggle_orbit(&desk.scene, LightId(6), 1.0));
    desk.perform(motion::toggle_orbit(&desk.scene, LightId(6), 4.0));
    desk.view.light = Some(LightId(6));
    // A quarter turn takes -Z to -X.
    close(desk.light().0, DVec3::X * -200.0);
    desk.take_back();
    close(desk.light().0, DVec3::Z * -200.0);
    let refusal = motion::toggle_orbit(&desk.scene, LightId(5), 0.0);
    assert_eq!(refusal, Err(Refusal::NotABulb));
}
