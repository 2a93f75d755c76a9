//! Budgets: settings are searched, printed as options, and the picture is that of these options.

use std::path::Path;

use marraztu_core::base::image::Picture;
use marraztu_io as io;
use marraztu_lab::budget::VISIBLE;
use marraztu_lab::flip::difference;

use super::{ends_with, folder};

/// Draws with a budget, and returns its note and the options in it.
fn budgeted(folder: &Path, arguments: &[&str]) -> (String, Vec<String>) {
    let all = [&["render", "--out", "budget.png", "--size", "64x48"], arguments].concat();
    let (out, err) = ends_with(0, folder, &all);
    assert_eq!(out, "");
    let note = err.lines().find(|line| line.contains("against the ideal")).unwrap().to_owned();
    let options = note.rsplit_once(": ").unwrap().1;
    let options = options.strip_prefix("the given options").unwrap_or(options);
    let options = options.split_whitespace().map(str::to_owned).collect();
    (note, options)
}

/// Draws the picture of these options, and returns its bytes.
fn bytes(folder: &Path, arguments: &[&str]) -> Vec<u8> {
    let all = [&["render", "--out", "pinned.png", "--size", "64x48"], arguments].concat();
    ends_with(0, folder, &all);
    std::fs::read(folder.join("pinned.png")).unwrap()
}

fn rmse(a: &Picture, b: &Picture) -> f64 {
    let pairs = a.pixels().iter().zip(b.pixels());
    let step = |a: &[u8; 4], b: &[u8; 4], i: usize| f64::from(a[i].abs_diff(b[i])).powi(2);
    let sum: f64 = pairs.map(|(a, b)| (0..3).map(|i| step(a, b, i)).sum::<f64>()).sum();
    (sum / (3 * a.pixels().len()) as f64).sqrt()
}

/// Returns the words of the options.
fn words(options: &[String]) -> Vec<&str> {
    options.iter().map(String::as_str).collect()
}

#[test]
fn a_picture_for_a_budget_is_that_of_the_printed_options_and_keeps_the_promise() {
    let folder = folder();
    let folder = folder.path();
    bytes(folder, &["--preset", "ideal"]);
    let ideal = io::load_picture(&folder.join("pinned.png")).unwrap();
    for budget in [&["--error", "3"][..], &["--error", "1"], &["--within", "50ms"], &["--unseen"]] {
        let (note, options) = budgeted(folder, budget);
        let drawn = std::fs::read(folder.join("budget.png")).unwrap();
        assert_eq!(drawn, bytes(folder, &words(&options)), "{note}");
        assert!(options.contains(&"--samples".to_owned()), "{note}");
        let picture = io::load_picture(&folder.join("budget.png")).unwrap();
        match budget {
            ["--error", most] => {
                let error = rmse(&picture, &ideal);
                assert!(error <= most.parse().unwrap(), "{error}: {note}");
            }
            ["--unseen"] => assert!(difference(&picture, &ideal) <= VISIBLE, "{note}"),
            _ => assert!(note.contains("within 50 ms: "), "{note}"),
        }
    }
}

#[test]
fn the_pictures_of_a_turn_have_the_settings_of_the_first_one() {
    let folder = folder();
    let folder = folder.path();
    let turn = |out: &str, options: &[&str]| {
        let all = ["turntable", "--out", out, "--size", "48x36", "--frames", "3"];
        let (_, err) = ends_with(0, folder, &[&all[..], options].concat());
        let read =
            |i: u32| std::fs::read(folder.join(out).join(format!("frame-{i:03}.png"))).unwrap();
        (err, (1..=3).map(read).collect::<Vec<_>>())
    };
    let (err, budgeted) = turn("budget", &["--error", "2"]);
    let options = err.lines().find(|line| line.contains("against the ideal")).unwrap();
    let options: Vec<&str> = options.rsplit_once(": ").unwrap().1.split_whitespace().collect();
    assert!(options.contains(&"--samples"), "{err}");
    assert!(budgeted == turn("pinned", &options).1, "{err}");
}

#[test]
fn options_of_axes_stay_fixed_and_are_not_printed_again() {
    let folder = folder();
    let folder = folder.path();
    let fixed = ["--samples", "4", "--shading", "vertex"];
    let (note, options) = budgeted(folder, &[&["--error", "60"], &fixed[..]].concat());
    assert!(!options.iter().any(|it| ["--samples", "--shading"].contains(&it.as_str())), "{note}");
    let drawn = std::fs::read(folder.join("budget.png")).unwrap();
    assert_eq!(drawn, bytes(folder, &[&fixed[..], &words(&options)].concat()), "{note}");
    // A model is not searched either.
    let (_, options) = budgeted(folder, &["--error", "60", "--values", "linear"]);
    assert!(!options.contains(&"--values".to_owned()));
}

#[test]
fn an_impossible_budget_names_the_nearest_settings_and_draws_nothing() {
    let folder = folder();
    let folder = folder.path();
    for (budget, says) in [
        (&["--within", "0.000001ms"][..], "nothing is drawn within"),
        (&["--error", "0", "--samples", "1"], "no other settings have an error of at most 0"),
        (&["--unseen", "--samples", "1"], "nothing looks like the ideal"),
    ] {
        let all = [&["render", "--out", "none.png", "--size", "64x48"], budget].concat();
        let (_, err) = ends_with(1, folder, &all);
        assert!(err.contains(says) && err.contains(" ms"), "{err}");
        assert!(!folder.join("none.png").exists());
    }
    for wrong in [
        &["--within", "20ms", "--error", "1"][..],
        &["--within", "20ms", "--unseen"],
        &["--error", "1", "--unseen"],
        &["--within", "20ms", "--preset", "draft"],
        &["--unseen", "--transparent"],
        &["--within", "20"],
        &["--error", "-1"],
        &["--within", "20ms", "--layers", "depth"],
    ] {
        let all = [&["render", "--out", "none.png"], wrong].concat();
        ends_with(2, folder, &all);
    }
}
