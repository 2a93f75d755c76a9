//! Aiming lights at points and at the selection.
//!
//! Catches: a spot that jumps when it is aimed, a wrong target, a direction of NaN.

use glam::DVec3;
use marraztu_core::base::math;
use marraztu_core::edit::{GesturePhase, Refusal, aiming, items, lights};
use marraztu_core::scene::{LightId, LightKind};
use marraztu_io as io;

#[test]
fn a_spot_that_follows_its_owner_is_aimed_from_where_it_is_and_stays_there() {
    let (mut scene, mut view) = io::default_scene();
    let mut aimed = 0;
    for id in scene.lights.ids().collect::<Vec<_>>() {
        view.light = Some(id);
        let at = DVec3::new(30.0, -20.0, 10.0);
        let before = aiming::stands(&scene, &view, id);
        let Ok(command) = aiming::aim(&scene, &view, id, at, GesturePhase::First) else {
            let refused = aiming::can_aim(&scene, &view);
            assert_eq!(refused, Err(Refusal::NotAimed));
            continue;
        };
        command.apply(&mut scene).unwrap();
        aimed += 1;
        let (before, after) = (before.unwrap(), aiming::stands(&scene, &view, id).unwrap());
        let to = math::unit(at - before.position).unwrap();
        assert!(to.dot(after.direction) > 0.999_999);
        if matches!(scene.lights.get(id).unwrap().kind, LightKind::Spot { .. }) {
            assert_eq!(after.position, before.position);
        }
    }
    assert_eq!(aimed, 3, "the sun and both spots");
}

#[test]
fn a_light_is_aimed_at_the_selection_but_not_at_its_own_position() {
    let (mut scene, mut view) = io::default_scene();
    let spot = items::insert_light(&scene, lights::spot(lights::fixed())).unwrap();
    let before: Vec<LightId> = scene.lights.ids().collect();
    spot.apply(&mut scene).unwrap();
    view.light = scene.lights.ids().find(|id| !before.contains(id));
    let id = aiming::can_aim(&scene, &view).unwrap();
    let refused = aiming::aim(&scene, &view, id, DVec3::ZERO, GesturePhase::First);
    assert_eq!(refused, Err(Refusal::AimedAtItself));
    let command = aiming::aim_at_selection(&scene, &view, GesturePhase::First).unwrap();
    command.apply(&mut scene).unwrap();
    // The selected object is on the left.
    assert!(aiming::stands(&scene, &view, id).unwrap().direction.x < -0.99);
}
