//! The proofs, on fewer scenes than `marraztu prove` takes.

use marraztu::lab::proof::random::Random;
use marraztu::lab::proof::{absent, plan, scenes};
use marraztu::render::FramePlan;
use marraztu::render::plan::rules::Rules;

const SCENES: u64 = 10_000;

#[test]
fn what_is_planned_is_what_is_drawn_when_nothing_is_left_out() {
    match plan::plan_is_full(&Rules::sound(), 0..SCENES) {
        Ok(tally) => assert!(tally.pixels > 200 * SCENES, "they show little: {tally:?}"),
        Err(difference) => panic!("{difference}"),
    }
}

#[test]
fn every_broken_rule_is_caught() {
    for breakage in plan::breakages() {
        let caught = plan::caught_by(&breakage, 0..SCENES);
        assert!(caught.is_some(), "{breakage:?}");
    }
}

#[test]
fn light_too_faint_to_matter_is_within_a_step() {
    match plan::faint_is_within_a_step(0..SCENES / 2) {
        Ok(tally) => assert!(tally.steps > 0, "nothing was left out: {tally:?}"),
        Err(difference) => panic!("{difference}"),
    }
}

#[test]
fn what_is_not_seen_changes_no_byte_wherever_it_is_put() {
    assert_eq!(absent::seen_after_all(0..SCENES / 5), None);
}

#[test]
fn a_hundred_lights_that_are_off_leave_the_ways_of_drawing_as_they_are() {
    for seed in 0..50 {
        let it = scenes::sample(seed);
        let more = absent::with_lights_off(&it, 100, &mut Random::new(seed));
        let plan = |it: &scenes::Sample| FramePlan::new(&it.scene, &it.view, &it.settings, it.size);
        assert_eq!(plan(&it).keys(), plan(&more).keys());
        assert!(plan(&it) == plan(&more), "scene {seed}");
    }
}
