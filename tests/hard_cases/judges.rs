//! Tests the oracles themselves on cases with known answers.

use marraztu_render::screen::coverage::Snapped;

use crate::claims::double_double::Double;
use crate::claims::exact::{span, wind};
use crate::claims::{PROOFS, Proof, Tally};

fn at(x: i32, y: i32) -> Snapped {
    Snapped { x, y }
}

#[test]
fn a_square_from_centre_to_centre_has_its_upper_and_left_pixels() {
    // A square from the centre of pixel (0, 0) to that of pixel (2, 2).
    let [a, b, c, d] = [at(128, 128), at(640, 128), at(640, 640), at(128, 640)];
    for y in 0..2 {
        let (upper, lower) = (span([a, b, c], y), span([a, c, d], y));
        let columns = (upper.end - upper.start) + (lower.end - lower.start);
        assert_eq!((columns, lower.start, upper.end), (2, 0, 2), "row {y}");
    }
    assert!(span([a, b, c], 2).is_empty() && span([a, c, d], -1).is_empty());
}

#[test]
fn an_outline_that_goes_round_twice_winds_twice() {
    let square = [at(0, 0), at(1024, 0), at(1024, 1024), at(0, 1024)];
    let twice: Vec<Snapped> = square.iter().chain(&square).copied().collect();
    let mut row = [9; 6];
    wind(&twice, 1, &mut row);
    assert_eq!(row, [2, 2, 2, 2, 0, 0]);
    let back: Vec<Snapped> = square.iter().rev().copied().collect();
    wind(&back, 3, &mut row);
    assert_eq!(row, [-1, -1, -1, -1, 0, 0]);
}

#[test]
fn double_double_keeps_digits_that_f64_loses() {
    let small = Double::from(1e-25);
    assert_eq!(((Double::ONE + small) - Double::ONE).nearest(), 1e-25);
    let third = Double::ONE / Double::from(3.0);
    assert!((third * Double::from(3.0) - Double::ONE).abs().nearest() < 1e-31);
    let two = Double::from(2.0).sqrt();
    assert!((two * two - Double::from(2.0)).abs().nearest() < 1e-31);
}

#[test]
fn the_sine_of_thirty_degrees_is_a_half() {
    let angle = Double::PI / Double::from(180.0) * Double::from(10.0);
    let (s, c) = angle.sin_cos();
    assert!((s * s + c * c - Double::ONE).abs().nearest() < 1e-31);
    // sin 3a = 3 sin a - 4 sin^3 a
    let triple = Double::from(3.0) * s - Double::from(4.0) * s * s * s;
    assert!((triple - Double::from(0.5)).abs().nearest() < 1e-31);
}

static EVEN: Proof = Proof {
    name: "even",
    claim: "no batch is the seventh",
    unit: "numbers",
    batch: 10,
    quick: 10,
    whole: 100,
    shows: &[("numbers", 1000)],
    regressions: &[],
    check: |batch| {
        assert_ne!(batch, 9, "this is seen as a counterexample");
        let mut tally = Tally::default();
        tally.count("numbers", 10);
        tally.error("error", 0.5);
        if batch == 7 { Err("this is the seventh".to_owned()) } else { Ok(tally) }
    },
};

#[test]
fn a_counterexample_is_named_by_its_batch_and_a_panic_is_one() {
    let tally = EVEN.run(0..7, &|_| {}).unwrap();
    assert_eq!((tally.counts["numbers"], tally.worst["error"]), (70, 0.5));
    assert_eq!(EVEN.run(0..8, &|_| {}).unwrap_err().batch, 7);
    assert_eq!(EVEN.run(8..10, &|_| {}).unwrap_err().batch, 9);
    assert_eq!((EVEN.batches(1), EVEN.batches(20), EVEN.batches(21)), (1, 2, 3));
}

#[test]
fn a_proof_with_too_few_significant_cases_is_idle() {
    let tally = EVEN.run(0..7, &|_| {}).unwrap();
    assert_eq!(EVEN.missing(&tally, 70), None);
    assert!(EVEN.missing(&tally, 2000).is_some());
}

#[test]
fn no_two_proofs_have_the_same_name() {
    for (i, proof) in PROOFS.iter().enumerate() {
        assert!(PROOFS[..i].iter().all(|other| other.name != proof.name), "{}", proof.name);
    }
}
