//! The suite measures every axis, and its page has a section for each axis.

use marraztu::plots::{Look, page_html, page_markdown, png, sections};
use marraztu_core::accuracy::{AXES, Axis};
use marraztu_lab::pairs::Watch;
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
