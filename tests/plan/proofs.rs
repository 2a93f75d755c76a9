//! The proofs, on fewer scenes than `marraztu prove` takes.

use marraztu::lab::prove::dice::Dice;
use marraztu::lab::prove::plan::{absent, samples};
use marraztu::lab::prove::{Proof, Tally};
use marraztu::render::FramePlan;

/// What is seen in a number of cases of a proof.
fn prove(name: &str, cases: u64) -> Tally {
    let proof = Proof::named(name).unwrap();
    let seen = proof.run(0..proof.lots(cases), &|_| {});
    seen.unwrap_or_else(|counterexample| panic!("{name}: {counterexample}"))
}

#[test]
fn what_is_planned_is_what_is_drawn_when_nothing_is_left_out() {
    let tally = prove("plan", 10_000);
    assert_eq!(tally.counts["scenes"], 10_000);
    assert!(tally.counts["pixels that show something"] > 2_000_000, "they show little: {tally}");
}

/// A face with a corner beyond what 32 bits hold, seen in parallel; a lamp that stands in a vertex.
#[test]
fn lots_in_which_a_claim_once_failed_hold() {
    for (name, lot) in [("scenes", 2456), ("plan", 4569)] {
        let seen = Proof::named(name).unwrap().run(lot..lot + 1, &|_| {});
        assert_eq!(seen.err(), None, "{name}");
    }
}

#[test]
fn every_broken_rule_is_caught() {
    let proof = Proof::named("rules").unwrap();
    assert_eq!(prove("rules", proof.whole).counts["breakages"], proof.whole);
}

#[test]
fn light_too_faint_to_matter_is_within_a_step() {
    let tally = prove("faint", 5_000);
    assert!(tally.counts["bytes a step off"] > 0, "nothing was left out: {tally}");
}

#[test]
fn what_is_not_seen_changes_no_byte_wherever_it_is_put() {
    prove("absent", 2_000);
}

#[test]
fn a_hundred_lights_that_are_off_leave_the_ways_of_drawing_as_they_are() {
    for seed in 0..50 {
        let it = samples::sample(seed);
        let more = absent::with_lights_off(&it, 100, &mut Dice::new(seed));
        let plan =
            |it: &samples::Sample| FramePlan::new(&it.scene, &it.view, &it.settings, it.size);
        assert_eq!(plan(&it).keys(), plan(&more).keys());
        assert!(plan(&it) == plan(&more), "scene {seed}");
    }
}
