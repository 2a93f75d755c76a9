//! Tables, data and plots hold every choice.

use marraztu::accuracy::{AXES, Axis, Choice, LightAt, Samples, Settings};
use marraztu::lab::candidates::Group;
use marraztu::lab::error::Measure;
use marraztu::lab::report::{Budgets, Chart, MarkKind, Report, csv, png, svg, tabs, text};
use marraztu::lab::sweep::Against;
use marraztu::lab::sweep::Row;

use crate::bench::{FakeClock, FakeSource, found};

/// A report in which 32 bits are wrong and 64 bits are slow.
fn report() -> Report {
    let arithmetic = Axis::named("arithmetic").unwrap();
    let planted = |word: &str| arithmetic.choice(word).map(|choice| (arithmetic, choice));
    let mut source = FakeSource::new(planted("f32"), None);
    let findings = found(&mut FakeClock::new(planted("f64")), &mut source);
    Report {
        scene: "a scene".to_owned(),
        command: "marraztu lab".to_owned(),
        measure: Measure::Rmse,
        budgets: Budgets { error: Some(0.0), ms: Some(0.5) },
        findings,
    }
}

#[test]
fn the_table_has_a_row_for_every_choice_of_every_axis() {
    let report = report();
    let (text, csv) = (text(&report), csv(&report));
    for axis in AXES {
        assert!(text.contains(&format!("--{}", axis.key)), "{text}");
        let own = |choice: &&Choice| (choice.among)(&Settings::default()).is_ok();
        for choice in axis.choices.iter().filter(own) {
            let rows = report.findings.rows.iter();
            let row =
                rows.clone().find(|r| r.group == Group::Axis(axis.key) && r.name == choice.label);
            assert!(row.is_some(), "{} {}", axis.key, choice.word);
            assert!(text.contains(choice.label), "{text}");
        }
    }
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), report.findings.rows.len() + 1);
    let columns = lines[0].split(',').count();
    for line in lines {
        let quotes = line.split('"').step_by(2).map(|plain| plain.matches(',').count());
        assert_eq!(quotes.sum::<usize>() + 1, columns, "{line}");
    }
    // The same fields with tabs between; none has a comma outside of quotes.
    for (line, of_csv) in tabs(&report).lines().zip(csv.lines()) {
        assert_eq!(line.split('\t').count(), columns, "{line}");
        assert_eq!(line.replace('\t', ","), of_csv.replace('"', ""));
    }
}

#[test]
fn json_holds_what_the_table_holds() {
    let report = report();
    let value: serde_json::Value = serde_json::from_str(&report.json()).unwrap();
    assert_eq!(value["points"].as_array().unwrap().len(), report.findings.points.len());
    assert_eq!(value["rows"].as_array().unwrap().len(), report.findings.rows.len());
    assert_eq!(value["points"][0]["ratio"]["quartiles"]["median"], 1.0);
    assert_eq!(value["points"][0]["settings"]["shading"], "Pixel");
    assert_eq!(value["kernels"].as_array().unwrap().len(), 4);
    assert_eq!(value["command"], "marraztu lab");
}

#[test]
fn budgets_are_answered_or_said_to_be_too_small() {
    let mut report = report();
    // Nothing takes half a millisecond, and 64 bits are exact.
    let exact = report.findings.points.iter().position(|point| point.name == "arithmetic f64");
    assert_eq!((report.fastest().flatten(), report.most_exact()), (exact, Some(None)));
    let answers = report.answers();
    assert!(answers[0].contains("at most 0: arithmetic f64: 3 ms, 0"), "{answers:?}");
    assert!(answers[1].contains("none that was measured"), "{answers:?}");
    report.budgets = Budgets::default();
    assert_eq!(report.answers(), [""; 0]);
}

#[test]
fn a_chart_puts_an_error_of_0_under_all_others_and_slow_right_of_fast() {
    let chart = Chart::new(&report());
    let mark = |name: &str| chart.marks.iter().find(|mark| mark.name == name).unwrap();
    let (default, slow, model) =
        (mark("Default"), mark("Exact"), mark("Default, specular half-vector"));
    assert_eq!((default.kind, slow.kind), (MarkKind::Default, MarkKind::Preset));
    assert!(default.on_front && default.current && slow.on_front && !slow.current);
    // A model takes no part.
    assert!(model.kind == MarkKind::Model && !model.on_front);
    assert!(default.at[1] > slow.at[1] + 0.9);
    assert!((slow.at[0] - default.at[0] - libm::log10(3.0)).abs() < 1e-9);
    let zero = chart.y.ticks.iter().find(|(_, label)| label == "0").unwrap();
    assert_eq!(zero.0, slow.at[1]);
    for mark in &chart.marks {
        for (scale, at) in [(&chart.x, mark.at[0]), (&chart.y, mark.at[1])] {
            assert!(scale.range[0] < at && at < scale.range[1], "{}", mark.name);
        }
    }
}

/// The point of a row.
fn point(report: &Report, key: &'static str, name: &str) -> usize {
    let is_it = |row: &&Row| row.group == Group::Axis(key) && row.name == name;
    report.findings.rows.iter().find(is_it).unwrap().point
}

#[test]
fn several_samples_are_judged_against_sixty_four_each_lit_and_have_a_front_of_their_own() {
    let report = report();
    let all = [Samples::One, Samples::Four, Samples::Sixteen, Samples::SixtyFour];
    for (samples, name) in all.into_iter().zip(["1", "4", "16", "64"]) {
        let i = point(&report, "samples", name);
        let found = &report.findings.points[i];
        assert_eq!((found.settings.samples, found.against), (samples, Against::Apart), "{name}");
        let reference = found.reference;
        assert_eq!((reference.samples, reference.light), (Samples::SixtyFour, LightAt::Sample));
        assert!(!report.front().contains(&i), "{name}");
    }
    let apart = report.front_apart();
    assert!(!apart.is_empty());
    assert!(apart.iter().all(|i| report.findings.points[*i].against == Against::Apart));
    let chart = Chart::new(&report);
    let mark = &chart.marks[point(&report, "samples", "4")];
    assert_eq!((mark.kind, mark.name.as_str()), (MarkKind::Apart, "samples 4"));
    let (text, svg) = (text(&report), svg(&report).unwrap());
    assert!(text.contains("samples per pixel (against 64 samples, each lit), --samples"), "{text}");
    assert!(svg.contains("samples 4 ") || svg.contains("samples 4:"), "{svg}");
    assert!(svg.contains("(against 64 samples)") && !svg.contains("samples 4 (a model"), "{svg}");
}

#[test]
fn choices_with_different_coverage_are_on_no_front_but_that_of_flip() {
    let subpixels = Axis::named("subpixels").unwrap();
    let coarse = subpixels.choice("bits-0").map(|choice| (subpixels, choice));
    // All take as long and look the same.
    let findings = found(&mut FakeClock::new(None), &mut FakeSource::new(None, coarse));
    let mut report = Report { findings, ..report() };
    let coarse = point(&report, "subpixels", "0");
    assert_eq!(report.findings.points[coarse].error.coverage, 1);
    for measure in Measure::ALL {
        report.measure = measure;
        assert_eq!(report.is_scored(coarse), measure == Measure::Flip, "{measure:?}");
        assert!(report.is_scored(0));
        assert_eq!(report.front().contains(&coarse), measure == Measure::Flip, "{measure:?}");
    }
    report.measure = Measure::Rmse;
    assert!(svg(&report).unwrap().contains("(other pixels)"));
}

#[test]
fn the_plot_names_every_point_in_svg_and_draws_them_in_png() {
    let report = report();
    let svg = svg(&report).unwrap();
    for point in &report.findings.points {
        assert!(svg.contains(&point.name), "{} is not in the plot", point.name);
    }
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
    let png = png(&report).unwrap();
    let of = |color: [u8; 4]| png.pixels().iter().filter(|pixel| **pixel == color).count();
    // The front's green, a preset's blue, and letters. The marks of the axes all lie under others
    // here.
    for color in [[0, 158, 115, 255], [0, 114, 178, 255], [34, 34, 40, 255]] {
        assert!(of(color) > 10, "{color:?} is seen {} times", of(color));
    }
}

#[test]
fn every_axis_has_three_sentences_to_teach() {
    for axis in AXES {
        let lesson = &Axis::named(axis.key).unwrap().lesson;
        for sentence in [lesson.what, lesson.coarse, lesson.shows] {
            assert!(sentence.ends_with('.') && sentence.len() > 20, "{}: {sentence}", axis.key);
        }
        let hints = axis.choices.iter().flat_map(|choice| [choice.what, choice.error]);
        assert!(hints.into_iter().all(|text| !text.is_empty()), "{}", axis.key);
    }
}
