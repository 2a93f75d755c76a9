//! The suite measures every axis, and its page has a section for each axis.

use marraztu::plots::{Look, page_html, page_markdown, png, sections};
use marraztu_core::accuracy::{AXES, Axis, AxisKind, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_lab::pairs::Watch;
use marraztu_lab::picture_source::{PictureSource as _, Reference, Studio};
use marraztu_lab::suite::{SUITE, SuiteDetail, run};
use marraztu_lab::timing::WallClock;

#[test]
fn every_axis_is_measured_on_a_scene_in_which_it_means_something() {
    for suite in SUITE {
        let (scene, view) = suite.open(SuiteDetail::TINY.detail);
        assert_eq!(suite.measured().len(), suite.axes.len(), "{}", suite.word);
        for axis in suite.measured() {
            assert_eq!((axis.sense)(&scene, &view), Ok(()), "{} {}", suite.word, axis.key);
        }
    }
    for axis in AXES {
        assert!(SUITE.iter().any(|suite| suite.axes.contains(&axis.key)), "{}", axis.key);
    }
}

/// The difference of two errors that can be seen in tables and plots, in byte steps.
const VISIBLE: f64 = 0.3;

/// What is wrong with an axis on a scene of the suite, given the word and error of each choice.
fn mute(axis: &Axis, of_time: bool, errors: &[(&str, f64)]) -> Vec<String> {
    let default = axis.default_choice().word;
    let place = |word: &str| axis.choices.iter().position(|choice| choice.word == word).unwrap();
    let usual = errors.iter().find(|(word, _)| *word == default).map_or(0.0, |(_, error)| *error);
    let others = || errors.iter().filter(|(word, _)| *word != default);
    let shows = others().any(|(_, error)| (error - usual).abs() >= VISIBLE);
    let mut faults = Vec::new();
    match (of_time, shows) {
        (false, false) => faults.push(format!("no choice differs by {VISIBLE}: {errors:?}")),
        (true, true) => faults.push(format!("not only the time differs: {errors:?}")),
        (false, true) | (true, false) => {}
    }
    let is_coarse = |word: &str| axis.kind == AxisKind::Model || place(word) < place(default);
    for (word, error) in others().filter(|(word, _)| !of_time && is_coarse(word)) {
        if *error == 0.0 {
            faults.push(format!("{word} is exact"));
        }
    }
    faults
}

#[test]
fn every_axis_shows_its_errors_on_its_scenes_and_no_coarse_choice_is_exact_there() {
    let base = Settings::default();
    let mut faults = Vec::new();
    for suite in SUITE {
        let (scene, view) = suite.open(150);
        let mut studio = Studio::new(Shot::new(&scene, &view, &base, Size::new(320, 180)));
        for axis in suite.measured() {
            let exact = studio.rendering(&Reference::Alone(axis).of(&base));
            let own =
                axis.choices.iter().filter(|it| it.is_of_its_own(&scene, &view, &base).is_ok());
            let errors: Vec<(&str, f64)> = own
                .map(|it| (it.word, studio.rendering(&it.of(&base)).error(&exact).whole.rmse))
                .collect();
            let of_time = suite.time_only.iter().any(|(key, _)| *key == axis.key);
            let own = mute(axis, of_time, &errors).into_iter();
            faults.extend(own.map(|fault| format!("{} on {}: {fault}", axis.key, suite.word)));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn an_axis_without_errors_has_to_say_that_it_is_about_time() {
    let axis = Axis::named("coverage").unwrap();
    let errors = |scan_lines, f32_edges| {
        [("points", 9.0), ("scan-lines", scan_lines), ("f32-edges", f32_edges), ("exact", 0.0)]
    };
    assert!(mute(axis, false, &errors(5.0, 0.1)).is_empty());
    assert_eq!(mute(axis, false, &errors(5.0, 0.0)), ["f32-edges is exact"]);
    assert_eq!(mute(axis, true, &errors(5.0, 0.1)).len(), 1);
    let small = [("f32-edges", 0.1), ("exact", 0.0)];
    assert_eq!(mute(axis, false, &small).len(), 1);
    assert!(mute(axis, true, &small).is_empty());
    // An exemption names an axis of its scene, and a reason.
    for suite in SUITE {
        for (key, reason) in suite.time_only {
            assert!(suite.axes.contains(key) && !reason.is_empty(), "{} {key}", suite.word);
        }
    }
}

#[test]
fn a_tiny_suite_gives_a_page_with_a_section_for_every_axis() {
    let scenes: Vec<_> = SUITE.iter().collect();
    let (mut clock, watch, mut told) = (WallClock::default(), Watch::default(), 0);
    let mut tell = |_: &_| told += 1;
    let reports = run(&scenes, &SuiteDetail::TINY, &mut clock, &watch, &mut tell).unwrap();
    assert_eq!((reports.len(), told), (SUITE.len(), SUITE.len()));
    let keys: Vec<&str> = sections(&reports).map(|(axis, _)| axis.key).collect();
    assert!(keys.iter().copied().eq(AXES.iter().map(|axis| axis.key)), "{keys:?}");
    let page = page_markdown(&reports, &|key| format!("pictures/{key}.svg"));
    let html = page_html(&reports).unwrap();
    for axis in AXES {
        assert!(page.contains(&format!("### {}\n", axis.label)), "{page}");
        assert!(page.contains(&format!("(pictures/{}-", axis.key)), "{page}");
        assert!(html.contains(&format!("<h2>{}</h2>", axis.label)));
    }
    assert!(reports.iter().all(|report| report.command == "marraztu lab --suite=tiny"));
    assert!(page.contains("marraztu lab --suite=tiny") && !page.contains("--size"));
    let panels: usize = SUITE.iter().map(|suite| suite.axes.len()).sum();
    assert_eq!(html.matches("<svg").count(), 2 * panels);
    assert!(png(&reports[0], Look::Dark).is_ok());
    // Each scene shows its topic in the errors, which need no clock.
    let rmse = |scene: &str, key: &str, label: &str| {
        let place = SUITE.iter().position(|suite| suite.word == scene).unwrap();
        let findings = &reports[place].findings;
        let axis = Axis::named(key).unwrap();
        let row = findings.rows_of(axis).find(|row| row.name == label).unwrap();
        row.error.whole.rmse
    };
    assert!(rmse("highlights", "shading", "Flat") > 2.0 * rmse("highlights", "shading", "Phong"));
    assert!(rmse("edges", "samples", "1") > 1.5 * rmse("edges", "samples", "4"));
    assert!(rmse("depth", "depth", "16 bits") > rmse("depth", "depth", "Reversed depth"));
}
