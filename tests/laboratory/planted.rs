//! Planted slowdowns and errors are attributed to the right choice only.

use std::collections::BTreeSet;

use marraztu_core::accuracy::{Axis, AxisKind, Choice, LightAt, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_io::default_scene;
use marraztu_lab::attribution::attribute;
use marraztu_lab::candidates::Group;
use marraztu_lab::error::{Error, Measure, Region};
use marraztu_lab::pairs::Ratio;
use marraztu_lab::picture_source::{PictureSource as _, Studio};
use marraztu_lab::report::{Budgets, Panels, Report};
use marraztu_lab::statistics::Quartiles;
use marraztu_lab::sweep::{Findings, Measured, Verdict};

use crate::bench::{FakeClock, FakeSource, Planted, found, plantable};

/// The rows of single axes: name, row with its measurement, and whether it is the planted choice.
fn rows<'a>(
    findings: &'a Findings,
    planted: &(&'static Axis, &'static Choice),
) -> Vec<(String, (&'a Measured, &'a Error), bool)> {
    let rows = findings.rows.iter().filter_map(|row| {
        let Group::Axis(key) = row.group else { return None };
        let axis = Axis::named(key).unwrap();
        let point = &findings.points[row.point];
        let here = key == planted.0.key && axis.chosen(&point.settings).word == planted.1.word;
        Some((format!("{key} {}", row.name), (point, &row.error), here))
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
        for (name, (point, _), here) in rows(&findings, &planted) {
            let (ratio, verdict) =
                if here { (3.0, Verdict::Slower) } else { (1.0, Verdict::Alike) };
            assert_eq!((point.ratio.quartiles.median, point.verdict), (ratio, verdict), "{name}");
        }
        for point in &findings.points {
            let slow = planted.1.is(&point.settings);
            assert_eq!(point.verdict == Verdict::Slower, slow, "{}", point.name);
            assert_eq!(point.ideal.map_or(0, |it| it.whole.largest), 0, "{}", point.name);
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
        for (name, (point, error), here) in rows(&findings, &planted) {
            assert_eq!(error.whole.largest, if here { 9 } else { 0 }, "{name}");
            // One byte of 192 is off by 9.
            let rmse = if here { libm::sqrt(81.0 / 192.0) } else { 0.0 };
            assert!((error.whole.rmse - rmse).abs() < 1e-12, "{name}");
            assert_eq!((error.inside, point.change), (error.whole, error.whole), "{name}");
            assert_eq!((error.coverage, error.flip > 0.0), (0, here), "{name}");
            assert_eq!(point.verdict, Verdict::Alike, "{name}");
        }
        let mut source = FakeSource::new(None, Some(planted));
        let findings = found(&mut FakeClock::new(None), &mut source);
        for (name, (_, error), here) in rows(&findings, &planted) {
            assert_eq!(
                (error.coverage, error.whole.largest),
                (usize::from(here && planted.0.key != "samples"), 0),
                "{name}"
            );
        }
    }
}

#[test]
fn the_error_of_a_pixel_is_attributed_to_the_axis_that_causes_it() {
    let face: Planted = plantable().find(|(_, choice)| choice.word == "face");
    let coarse = Settings { light: LightAt::Face, ..Settings::default() };
    // The error is planted in column 3 of row 3.
    let attribution_at = |at| attribute(&mut FakeSource::new(face, None), &coarse, at).unwrap();
    let found = attribution_at([3, 3]);
    assert_eq!((found.exact, found.ours, found.steps()), ([100; 3], [109, 100, 100], 9));
    let steps: Vec<(&str, i32)> = found.shares.iter().map(|s| (s.axis, s.steps)).collect();
    assert_eq!(steps[0], ("shading", 9));
    assert!(steps[1..].iter().all(|(_, steps)| *steps == 0), "{steps:?}");
    assert_eq!(attribution_at([4, 3]).steps(), 0);
    assert_eq!(attribute(&mut FakeSource::new(face, None), &coarse, [8, 0]), None);
}

fn report_on(findings: Findings) -> Report {
    Report {
        scene: "a scene".to_owned(),
        command: String::new(),
        measure: Measure::Rmse,
        region: Region::Whole,
        budgets: Budgets::default(),
        findings,
    }
}

/// Returns the verdict on a scene with a planted slowdown or error.
fn verdict(slow: Planted, wrong: Planted) -> String {
    let findings = found(&mut FakeClock::new(slow), &mut FakeSource::new(wrong, None));
    report_on(findings).verdict().join(" ")
}

#[test]
fn the_verdict_names_a_planted_slowdown_and_no_other_choice() {
    let choices: Vec<_> = plantable().filter(|(axis, _)| axis.kind != AxisKind::Model).collect();
    for planted in &choices {
        let text = verdict(Some(*planted), None);
        let name = planted.0.in_words(planted.1);
        assert!(text.to_lowercase().contains(&name.to_lowercase()), "{name}: {text}");
        assert!(text.contains("3.0x"), "{name}: {text}");
        assert!(text.ends_with("Nothing saves more than the noise (0.1%)."), "{text}");
        assert_eq!(text.matches("3.0x").count(), 1, "{text}");
    }
    assert_eq!(
        verdict(None, None),
        "At 8x8, 1 sample per pixel, on a scene, each choice alone, errors against the ideal: \
         nothing saves more than the noise (0.1%)."
    );
}

#[test]
fn the_verdict_names_a_planted_error_and_its_cost() {
    let scored = |(axis, _): &(&Axis, &Choice)| axis.kind != AxisKind::Model;
    for planted in plantable().filter(scored) {
        let text = verdict(None, Some(planted));
        let name = planted.0.in_words(planted.1).to_lowercase();
        let exact = planted.1.word == planted.0.most_exact(&Settings::default()).word;
        // The most exact choice is the reference of its axis, so an error in it appears in the
        // others.
        let named = text.to_lowercase().contains(&name);
        assert!(named || (exact && planted.0.kind == AxisKind::Scored), "{name}: {text}");
        if !exact {
            let only = format!("with the error in brackets: {name} (0.65).");
            assert!(text.to_lowercase().contains(&only), "{text}");
        }
    }
}

/// Figures as a published page has them: each sentence follows from a rule.
#[test]
fn the_verdict_names_the_gain_of_samples_and_calls_64_bits_not_worth_it() {
    let choice = |key: &str, word: &str| {
        let axis = Axis::named(key).unwrap();
        (axis, axis.choice(word).unwrap())
    };
    let mut findings = found(&mut FakeClock::new(None), &mut FakeSource::new(None, None));
    // Replaces the measured figures of a choice by exact ones.
    let mut edit = |(_, chosen): (&Axis, &Choice), ratio: f64, rmse: f64, largest: u8| {
        let default = chosen.is(&Settings::default());
        let points = findings.points.iter_mut();
        let settings = chosen.of(&Settings::default());
        for point in points.filter(|point| point.settings == settings || default) {
            if point.settings == settings {
                point.ratio.quartiles = Quartiles { lower: ratio, median: ratio, upper: ratio };
                point.ratio.interval = [ratio; 2];
                point.verdict = Verdict::of(&point.ratio, 0.06);
                point.ideal.as_mut().unwrap().whole.rmse = rmse;
                point.change.largest = largest;
                point.change.differing = 4e-5;
            }
        }
        let place = findings.points.iter().position(|point| point.settings == settings).unwrap();
        for row in findings.rows.iter_mut().filter(|row| row.point == place) {
            row.error.whole.rmse = rmse;
        }
    };
    edit(choice("samples", "1"), 1.0, 2.3, 0);
    edit(choice("samples", "4"), 2.1, 0.78, 90);
    edit(choice("samples", "16"), 7.5, 0.42, 90);
    edit(choice("arithmetic", "f64"), 2.1, 2.3, 1);
    findings.floor = 0.06;
    let report = Report {
        scene: "this scene".to_owned(),
        command: String::new(),
        measure: Measure::Rmse,
        region: Region::Whole,
        budgets: Budgets::default(),
        findings,
    };
    let text = report.verdict().join(" ");
    assert!(
        text.starts_with(
            "At 8x8, 1 sample per pixel, on this scene, each choice alone, errors against the \
             ideal: 4 samples per pixel cost 2.1x and cut the error from 2.3 to 0.78 of 255 (16: \
             7.5x, 0.42)."
        ),
        "{text}"
    );
    let bits = "Light in 64 bits costs 2.1x and changes 0.004% of the bytes by one step: not \
                worth it here.";
    assert!(text.contains(bits), "{text}");
    assert!(text.ends_with("Nothing saves more than the noise (6%)."), "{text}");
}

/// The machine is busy while one choice is measured: most of its pictures take four or sixteen
/// times as long, but not all of them.
#[test]
fn a_busy_machine_changes_no_verdict() {
    let subpixels = Axis::named("subpixels").unwrap();
    let slow = subpixels.choice("bits-0").unwrap();
    let verdict_with = |disturbed: &'static Choice| {
        let mut clock = FakeClock::new(Some((subpixels, slow)));
        clock.disturbed = Some((subpixels, disturbed));
        let findings = found(&mut clock, &mut FakeSource::new(None, None));
        assert_eq!(findings.floor, 0.0);
        let rows = rows(&findings, &(subpixels, disturbed));
        let (_, (point, _), _) = rows.iter().find(|(_, _, here)| *here).unwrap();
        let report = report_on(findings.clone());
        (point.verdict, report.verdict_on(subpixels), report)
    };
    // The slow choice is disturbed, and still slower by itself.
    let (verdict, told, report) = verdict_with(slow);
    assert_eq!(verdict, Verdict::Slower, "{told}");
    assert!(told.contains(slow.slower_because.unwrap()), "{told}");
    let panels = Panels::new(&report);
    let mark = panels.of(Some("subpixels")).marks.iter().find(|mark| mark.label == slow.label);
    let [from, to] = mark.unwrap().noise;
    assert!(from <= libm::log10(3.0) + 1e-9 && to > libm::log10(3.0), "{from} to {to}");
    // The exact choice is disturbed; it could take as long as the default.
    let exact = subpixels.most_exact(&Settings::default());
    let (verdict, told, _) = verdict_with(exact);
    assert!(matches!(verdict, Verdict::Alike | Verdict::Busy), "{told}");
    assert!(told.contains(slow.slower_because.unwrap()), "{told}");
}

#[test]
fn a_ratio_that_may_be_twice_as_large_says_that_the_machine_is_too_busy() {
    let mut ratio = Ratio::once(1.1, 1.0);
    assert_eq!(Verdict::of(&ratio, 0.0), Verdict::Slower);
    assert_eq!(Verdict::of(&ratio, 0.2), Verdict::Alike);
    ratio.interval = [0.5, 3.0];
    assert_eq!(Verdict::of(&ratio, 0.0), Verdict::Busy);
}

#[test]
fn the_ideal_of_one_pixel_is_that_of_the_whole_picture() {
    let (scene, view) = default_scene();
    let ideal = Settings::default().ideal();
    let mut studio = Studio::new(Shot::new(&scene, &view, &ideal, Size::new(64, 48)));
    studio.draw(&ideal);
    let whole = studio.picture().clone();
    let mut colors = BTreeSet::new();
    for at in [[0, 0], [63, 47], [20, 24], [32, 24], [33, 20], [40, 30], [50, 24]] {
        let [r, g, b, _] = whole.pixel(at[0], at[1]);
        assert_eq!(studio.ideal_pixel(&ideal, at), [r, g, b], "{at:?}");
        colors.insert([r, g, b]);
    }
    assert!(colors.len() > 2, "{colors:?}");
}
