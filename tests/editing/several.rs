//! Changes of several selected items, and pasted items.
//!
//! Catches: a motion, a colour or a place that is copied from one item instead of made anew for
//! each.

use glam::{DMat3, DMat4, DVec3};
use marraztu_core::base::color::Color;
use marraztu_core::edit::copies::{self, Copies};
use marraztu_core::edit::{Change, GesturePhase, items, motion, several};
use marraztu_core::scene::{
    Aim, ItemId, Light, LightId, LightKind, Object, ObjectId, Orbit, Scene, Spin, SpotOwner,
    Subject, Tracked, Transformation,
};

use super::desk::{Desk, close, close_matrix};

const BULB: LightId = LightId(6);
const OBJECTS: [ObjectId; 2] = [ObjectId(3), ObjectId(2)];

/// A desk with a second bulb, at (0, 0, 50); both bulbs circle, at 30 and 60 degrees a second.
fn with_two_bulbs() -> (Desk, LightId) {
    let mut desk = Desk::new(Subject::Light, Transformation::Translation);
    let orbit = Orbit { on: true, speed: 60.0, since: 0.0 };
    let kind = LightKind::Bulb { position: Tracked::new(DVec3::Z * 50.0), orbit };
    desk.perform(items::insert_light(&desk.scene, kind));
    let other = desk.view.light.unwrap();
    desk.perform(motion::toggle_orbit(&desk.scene, BULB, 0.0));
    (desk, other)
}

fn light(scene: &Scene, id: LightId) -> &Light {
    scene.lights.get(id).unwrap()
}

/// The place of a bulb at a time.
fn place(light: &Light, time: f64) -> DVec3 {
    let LightKind::Bulb { position, orbit } = &light.kind else { panic!("{light:?}") };
    orbit.at(*position.now(), time)
}

#[test]
fn a_change_of_the_orbit_of_several_bulbs_moves_none() {
    let (mut desk, other) = with_two_bulbs();
    let places = |desk: &Desk| [BULB, other].map(|id| place(light(&desk.scene, id), 2.0));
    let before = places(&desk);
    close(before[1], DVec3::new(50.0 * 0.75_f64.sqrt(), 0.0, -25.0));
    desk.view.light = Some(BULB);
    let others = [ItemId::Light(other)];
    desk.perform(several::each_light(&desk.scene, &desk.view, &others, |scene, _, id| {
        motion::toggle_orbit(scene, id, 2.0)
    }));
    let orbits = [BULB, other].map(|id| *light(&desk.scene, id).kind.orbit().unwrap());
    assert_eq!(orbits.map(|orbit| (orbit.on, orbit.speed)), [(false, 30.0), (false, 60.0)]);
    for (now, before) in places(&desk).into_iter().zip(before) {
        close(now, before);
    }
}

#[test]
fn a_change_of_the_spin_of_several_objects_turns_none() {
    let mut desk = Desk::new(Subject::Object, Transformation::Translation);
    let axes = [[true, false, false], [false, true, false]];
    for (id, (axes, speed)) in OBJECTS.into_iter().zip(axes.into_iter().zip([90.0, 20.0])) {
        let spin = Spin { axes, speed, since: 0.0 };
        desk.perform(motion::set_spin(&desk.scene, id, spin, 0.0, GesturePhase::First));
    }
    let objects =
        |desk: &Desk| OBJECTS.map(|id| desk.scene.objects.get(id).unwrap().world_from_object(3.0));
    let before = objects(&desk);
    let others = [ItemId::Object(OBJECTS[1])];
    let first = GesturePhase::First;
    desk.view.object = Some(OBJECTS[0]);
    let each = |act: &dyn Fn(&Scene, ObjectId) -> Change| {
        several::each_object(&desk.scene, &desk.view, &others, |scene, _, id| act(scene, id))
    };
    let faster = each(&|scene, id| {
        let own = scene.objects.get(id).unwrap().spin;
        motion::set_spin(scene, id, Spin { speed: 45.0, ..own }, 3.0, first)
    });
    let applied = each(&|scene, id| motion::apply_spin(scene, id, 3.0));
    for (command, speeds) in [(faster, [45.0, 45.0]), (applied, [90.0, 20.0])] {
        let mut after = Desk { scene: desk.scene.clone(), view: desk.view.clone() };
        after.perform(command);
        let spins = OBJECTS.map(|id| after.scene.objects.get(id).unwrap().spin);
        assert_eq!(spins.map(|spin| (spin.axes, spin.since)), axes.map(|axes| (axes, 3.0)));
        assert_eq!(spins.map(|spin| spin.speed), speeds);
        for (now, before) in objects(&after).into_iter().zip(before) {
            close_matrix(now, before);
        }
    }
}

#[test]
fn several_lights_get_the_whole_colour_even_of_one_that_has_parts_of_it() {
    let (mut desk, other) = with_two_bulbs();
    desk.perform(items::change_light(&desk.scene, other, |light| light.color = Color([0, 0, 255])));
    desk.view.light = Some(BULB);
    let (others, red) = ([ItemId::Light(other)], Color([255, 0, 0]));
    let set = |light: &mut Light| light.color = red;
    desk.perform(several::change_lights(&desk.scene, &desk.view, &others, set));
    assert_eq!([BULB, other].map(|id| light(&desk.scene, id).color), [red, red]);
}

#[test]
fn bulbs_and_fixed_spots_are_pasted_next_to_their_originals_like_objects() {
    let (mut desk, _) = with_two_bulbs();
    desk.view.time = 2.0;
    let object: Object = desk.scene.objects.get(OBJECTS[0]).unwrap().clone();
    let aim = Tracked::new(Aim { position: DVec3::ONE, direction: DVec3::NEG_Z });
    let owner = SpotOwner::Fixed(aim);
    let spot = LightKind::Spot { owner, half_aperture: 10.0, exponent: 1.0 };
    let bulb = light(&desk.scene, BULB).clone();
    let lights = vec![(BULB, bulb.clone()), (LightId(90), Light::new("spot", 0, spot))];
    let copies = Copies { objects: vec![(OBJECTS[0], object.clone())], cameras: vec![], lights };
    desk.perform(copies::insert(&desk.scene, &desk.view, copies));
    let placed: DMat4 = *desk.scene.objects.iter().next().unwrap().1.placement.now();
    let by = (placed.w_axis - object.placement.now().w_axis).truncate();
    assert!(by.length() > 1.0 && DMat3::from_mat4(placed) == DMat3::IDENTITY, "{by}");
    let mut pasted = desk.scene.lights.iter().map(|(_, light)| light).skip(6);
    close(place(pasted.next().unwrap(), 2.0), place(&bulb, 2.0) + by);
    let aim = pasted.next().and_then(|spot| spot.kind.owner()).and_then(SpotOwner::fixed);
    close(aim.unwrap().now().position, DVec3::ONE + by);
}

#[test]
fn a_piece_of_a_split_object_is_pasted_where_it_was_unless_something_shows_its_part_there() {
    let mut desk = Desk::new(Subject::Object, Transformation::Translation);
    let whole = ObjectId(2);
    let place = *desk.scene.objects.get(whole).unwrap().placement.now();
    desk.perform(items::split(&desk.scene, whole));
    let [lower, upper] = [whole, ObjectId(9)];
    let piece = desk.scene.objects.get(lower).unwrap().clone();
    let copies = || Copies { objects: vec![(lower, piece.clone())], ..Copies::default() };
    let pasted = |desk: &Desk| *desk.scene.objects.iter().next().unwrap().1.placement.now();
    // The other piece has the same file and the same place.
    desk.perform(items::remove(&desk.scene, ItemId::Object(lower)));
    desk.perform(copies::insert(&desk.scene, &desk.view, copies()));
    close_matrix(pasted(&desk), place);
    desk.perform(copies::insert(&desk.scene, &desk.view, copies()));
    assert!((pasted(&desk).w_axis - place.w_axis).length() > 1.0);
    // The whole object shows the part, too.
    for id in desk.scene.objects.ids().filter(|id| *id != upper).collect::<Vec<_>>() {
        desk.perform(items::remove(&desk.scene, ItemId::Object(id)));
    }
    let all = |object: &mut Object| object.hidden_parts.clear();
    desk.perform(items::change_object(&desk.scene, upper, all));
    desk.perform(copies::insert(&desk.scene, &desk.view, copies()));
    assert!((pasted(&desk).w_axis - place.w_axis).length() > 1.0);
}
