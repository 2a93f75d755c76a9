//! Planted slowdowns and errors are attributed to the right choice, and to no other.

use marraztu::accuracy::{Axis, AxisKind, Choice, LightAt, Settings};
use marraztu::lab::attribution::attribute;
use marraztu::lab::candidates::Group;
use marraztu::lab::sweep::{Findings, Measured, Verdict};

use crate::bench::{FakeClock, FakeSource, Planted, found, plantable};

/// The rows of single axes, with whether the planted choice is theirs.
fn rows<'a>(
    findings: &'a Findings,
    planted: &(&'static Axis, &'static Choice),
) -> Vec<(String, &'a Measured, bool)> {
    let rows = findings.rows.iter().filter_map(|row| {
        let Group::Axis(key) = row.group else { return None };
        let axis = Axis::named(key).unwrap();
        let point = &findings.points[row.point];
        let here = key == planted.0.key && axis.chosen(&point.settings).word == planted.1.word;
        Some((format!("{key} {}", row.name), point, here))
    });
    let rows: Vec<_> = rows.collect();
    assert_eq!(rows.iter().filter(|(_, _, here)| *here).count(), 1);
    rows
}

#[test]
fn a_planted_slowdown_shows_in_its_own_row_and_in_no_other() {
    for planted in plantable() {
        let findings = found(&mut FakeClock::new(Some(planted)), &mut FakeSource::new(None, None));
        assert_eq!(findings.floor, 0.0);
        for (name, point, here) in rows(&findings, &planted) {
            let (ratio, verdict) =
                if here { (3.0, Verdict::Slower) } else { (1.0, Verdict::Alike) };
            assert_eq!((point.ratio.quartiles.median, point.verdict), (ratio, verdict), "{name}");
        }
        for point in &findings.points {
            let slow = planted.1.is(&point.settings);
            assert_eq!(point.verdict == Verdict::Slower, slow, "{}", point.name);
            assert_eq!(point.error.largest, 0, "{}", point.name);
        }
    }
}

#[test]
fn a_planted_error_shows_in_its_own_row_and_in_no_other() {
    let not_exact = |(axis, choice): &(&Axis, &Choice)| {
        axis.kind == AxisKind::Scored && choice.word != axis.most_exact(&Settings::default()).word
    };
    for planted in plantable().filter(not_exact) {
        let mut source = FakeSource::new(Some(planted), None);
        let findings = found(&mut FakeClock::new(None), &mut source);
        for (name, point, here) in rows(&findings, &planted) {
            let error = &point.error;
            assert_eq!(error.largest, if here { 9 } else { 0 }, "{name}");
            // One byte of 192 is off by 9.
            let rmse = if here { libm::sqrt(81.0 / 192.0) } else { 0.0 };
            assert!((error.rmse - rmse).abs() < 1e-12, "{name}");
            assert_eq!((error.coverage, error.flip > 0.0), (0, here), "{name}");
            assert_eq!(point.verdict, Verdict::Alike, "{name}");
        }
        let mut source = FakeSource::new(None, Some(planted));
        let findings = found(&mut FakeClock::new(None), &mut source);
        for (name, point, here) in rows(&findings, &planted) {
            assert_eq!(
                (point.error.coverage, point.error.largest),
                (usize::from(here), 0),
                "{name}"
            );
        }
    }
}

#[test]
fn the_error_of_a_pixel_is_attributed_to_the_axis_that_causes_it() {
    let face: Planted = plantable().find(|(_, choice)| choice.word == "face");
    let coarse = Settings { light: LightAt::Face, ..Settings::default() };
    // Column 3 of row 3 is the pixel in which the error is planted.
    let attribution_at = |at| attribute(&mut FakeSource::new(face, None), &coarse, at).unwrap();
    let found = attribution_at([3, 3]);
    assert_eq!((found.exact, found.ours, found.steps()), ([100; 3], [109, 100, 100], 9));
    let steps: Vec<(&str, i32)> = found.shares.iter().map(|s| (s.axis, s.steps)).collect();
    assert_eq!(steps[0], ("shading", 9));
    assert!(steps[1..].iter().all(|(_, steps)| *steps == 0), "{steps:?}");
    assert_eq!(attribution_at([4, 3]).steps(), 0);
    assert_eq!(attribute(&mut FakeSource::new(face, None), &coarse, [8, 0]), None);
}
