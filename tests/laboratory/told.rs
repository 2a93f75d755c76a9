//! Tables, data files and plots contain every choice.

use marraztu::plots::{Look, overview_names, panel_svg, png, svg};
use marraztu_core::accuracy::{AXES, Axis, Choice, Samples, Settings};
use marraztu_lab::candidates::Group;
use marraztu_lab::error::{Measure, Region};
use marraztu_lab::report::{Budgets, Panels, Report, csv, markdown, tabs, text};
use marraztu_lab::sweep::{Against, Verdict};

use crate::bench::{FakeClock, FakeSource, found};

/// A report with wrong f32 light and slow f64 light.
fn report() -> Report {
    let arithmetic = Axis::named("arithmetic").unwrap();
    let planted = |word: &str| arithmetic.choice(word).map(|choice| (arithmetic, choice));
    let mut source = FakeSource::new(planted("f32"), None);
    let findings = found(&mut FakeClock::new(planted("f64")), &mut source);
    Report {
        scene: "a scene".to_owned(),
        command: "marraztu lab".to_owned(),
        measure: Measure::Rmse,
        region: Region::Whole,
        budgets: Budgets { error: Some(0.0), ms: Some(0.5) },
        findings,
    }
}

#[test]
fn a_choice_that_takes_longer_than_a_more_exact_one_says_why() {
    let subpixels = Axis::named("subpixels").unwrap();
    let slow = subpixels.choice("bits-0").unwrap();
    let why = slow.slower_because.unwrap();
    let mut clock = FakeClock::new(Some((subpixels, slow)));
    let findings = found(&mut clock, &mut FakeSource::new(None, None));
    let told = Report { findings, ..report() }.verdict_on(subpixels);
    assert!(told.contains(why), "{told}");
    assert!(!report().verdict_on(subpixels).contains(why));
}

/// Whether a choice is measured by itself: not the samples of the ideal.
fn is_measured(choice: &Choice) -> bool {
    let default = Settings::default();
    (choice.among)(&default).is_ok() && choice.of(&default).samples != Samples::TwoFiftySix
}

#[test]
fn the_table_has_a_row_for_every_choice_of_every_axis() {
    let report = report();
    let (text, csv) = (text(&report), csv(&report));
    for axis in AXES {
        assert!(text.contains(&format!("--{}", axis.key)), "{text}");
        let own = |choice: &&Choice| is_measured(choice);
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
    // The tabular form has the same fields. Commas occur inside quotes only.
    for (line, of_csv) in tabs(&report).lines().zip(csv.lines()) {
        assert_eq!(line.split('\t').count(), columns, "{line}");
        assert_eq!(line.replace('\t', ","), of_csv.replace('"', ""));
    }
}

#[test]
fn json_holds_the_content_of_the_table() {
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
    // No choice fits into half a millisecond; f64 light is exact, and Exact is the first with it.
    let exact = report.findings.points.iter().position(|point| point.name == "Exact, 16 samples");
    assert_eq!((report.fastest().flatten(), report.most_exact()), (exact, Some(None)));
    let answers = report.answers();
    assert!(answers[0].contains("at most 0: Exact, 16 samples: 3 ms, 0"), "{answers:?}");
    assert!(answers[1].contains("no measured choice"), "{answers:?}");
    report.budgets = Budgets::default();
    assert_eq!(report.answers(), [""; 0]);
}

#[test]
fn a_panel_puts_an_error_of_0_under_all_others_and_slow_right_of_fast() {
    let report = report();
    let panels = Panels::new(&report);
    let panel = panels.of(Some("arithmetic"));
    let [fast, slow] = &panel.marks[..] else { panic!("{panel:?}") };
    assert_eq!([&fast.label, &slow.label], ["32 bits", "64 bits"]);
    assert_eq!([fast.is_default, slow.is_default], [true, false]);
    assert_eq!([fast.current, slow.current], [true, false]);
    assert!(fast.at[1] > slow.at[1] + 0.9);
    assert!((slow.at[0] - fast.at[0] - libm::log10(3.0)).abs() < 1e-9);
    assert_eq!(slow.at[1], panels.zero);
    let zero = panels.y.ticks.iter().find(|(_, label)| label == "0").unwrap();
    assert_eq!(zero.0, panels.zero);
    for panel in panels.axes.iter().chain([&panels.overview]) {
        for mark in &panel.marks {
            for (scale, at) in [(&panels.x, mark.at[0]), (&panels.y, mark.at[1])] {
                assert!(scale.range[0] < at && at < scale.range[1], "{}", mark.label);
            }
        }
    }
}

#[test]
fn every_axis_has_a_panel_with_its_choices_from_coarse_to_exact() {
    let report = report();
    let panels = Panels::new(&report);
    assert_eq!(panels.axes.len(), AXES.len());
    for (axis, panel) in AXES.iter().zip(&panels.axes) {
        let own = axis.choices.iter().filter(|choice| is_measured(choice));
        let labels: Vec<&str> = own.map(|choice| choice.label).collect();
        assert!(panel.marks.iter().map(|mark| &mark.label).eq(labels.iter()), "{panel:?}");
        assert_eq!(panel.marks.iter().filter(|mark| mark.is_default).count(), 1, "{panel:?}");
    }
}

#[test]
fn an_axis_is_judged_alone_and_everything_else_against_the_ideal() {
    let report = report();
    for row in &report.findings.rows {
        let is_axis = matches!(row.group, Group::Axis(_));
        assert_eq!(row.against == Against::Axis, is_axis, "{row:?}");
        let point = &report.findings.points[row.point];
        let is_model = point.settings.modelled_as(&Settings::default()) != point.settings;
        assert_eq!(point.ideal.is_none(), is_model, "{row:?}");
    }
    let ideal = report.findings.rows.iter().find(|row| row.name == "Ideal, 256 samples").unwrap();
    assert_eq!(report.findings.points[ideal.point].ratio.pairs, 1, "it is drawn once");
    assert_eq!(ideal.error.whole.largest, 0);
    let text = text(&report);
    assert!(text.contains("All others: against the ideal"), "{text}");
}

/// Uses a plot with a Pareto front as long as possible.
#[test]
fn the_overview_names_at_most_ten_and_no_two_names_overlap() {
    let mut report = report();
    // In steps of three, choices take a little longer and have a slightly smaller error. The first
    // ones share one position.
    for (i, point) in report.findings.points.iter_mut().enumerate() {
        let step = (i / 3) as f64;
        point.ratio.quartiles.median = 1.0 + 0.02 * step;
        point.ms = point.ratio.quartiles.median;
        point.verdict = if i == 0 { Verdict::Alike } else { Verdict::Slower };
        let mut error = report.findings.rows[0].error;
        error.whole.rmse = 9.0 / (1.0 + 0.1 * step) - 1e-3 * i as f64;
        point.ideal = Some(error);
    }
    let overview = report.overview();
    assert!((5..=10).contains(&overview.len()) && overview.contains(&0), "{overview:?}");
    let names = overview_names(&report);
    assert_eq!(names.len(), overview.len());
    for (i, (name, text)) in names.iter().enumerate() {
        for (other, box_of_other) in &names[..i] {
            assert!(!text.overlaps(box_of_other), "{name} and {other}");
        }
    }
}

#[test]
fn figures_cover_all_pixels_or_on_request_pixels_with_equal_coverage() {
    let subpixels = Axis::named("subpixels").unwrap();
    let coarse = subpixels.choice("bits-0").map(|choice| (subpixels, choice));
    // The pixel with other coverage has the wrong colour too.
    let mut source = FakeSource::new(coarse, coarse);
    source.same_pixel = true;
    let findings = found(&mut FakeClock::new(None), &mut source);
    let mut report = Report { findings, ..report() };
    let of = |report: &Report| {
        let mut rows = report.findings.rows.iter();
        let row = rows.find(|row| row.group == Group::Axis("subpixels") && row.name == "0");
        report.error(row.unwrap())
    };
    assert!((of(&report) - libm::sqrt(81.0 / 192.0)).abs() < 1e-12);
    assert!(text(&report).contains("all pixels"));
    report.region = Region::Inside;
    assert_eq!(of(&report), 0.0);
    assert!(text(&report).contains("pixels with equal coverage"));
    report.measure = Measure::Flip;
    assert!(of(&report) > 0.0, "FLIP is always of all pixels");
}

#[test]
fn the_plots_name_every_choice_in_svg_and_are_drawn_in_png_light_and_dark() {
    let report = report();
    for (look, paper, data) in [
        (Look::Light, [255, 255, 255, 255], [0, 114, 178, 255]),
        (Look::Dark, [24, 24, 28, 255], [86, 180, 233, 255]),
    ] {
        let svg = svg(&report, look).unwrap();
        for axis in AXES {
            assert!(svg.contains(axis.label), "{} is not in the plot", axis.label);
        }
        for sentence in report.verdict() {
            let start: String = sentence.chars().take(12).collect();
            assert!(svg.replace('\n', "").contains(&start), "{start} is not in the plot");
        }
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(panel_svg(&report, Some("depth"), look).unwrap().contains("Reversed depth"));
        let png = png(&report, look).unwrap();
        let of = |color: [u8; 4]| png.pixels().iter().filter(|pixel| **pixel == color).count();
        assert!(of(paper) > 100_000 && of(data) > 500, "{look:?}: {} {}", of(paper), of(data));
    }
    for axis in AXES {
        let rows = markdown(&report, axis).lines().count() - 2;
        assert_eq!(rows, report.findings.rows_of(axis).count(), "{}", axis.key);
    }
}

#[test]
fn every_choice_says_what_it_does_and_what_error_to_expect() {
    for axis in AXES {
        let hints = axis.choices.iter().flat_map(|choice| [choice.what, choice.error]);
        assert!(hints.into_iter().all(|text| !text.is_empty()), "{}", axis.key);
    }
}
