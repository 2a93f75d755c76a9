//! The suite: scenes that make each axis of accuracy matter.
//!
//! In an ordinary scene, most choices make no difference because other work dominates the time.
//! Each scene here has one bottleneck, and each axis is measured in a scene with a bottleneck that
//! the axis affects. The scenes are procedural, so their detail can vary.

mod scenes;

use super::candidates::{Thoroughness, candidates};
use super::error::{Measure, Region};
use super::pairs::{Limits, Unmeasured, Watch};
use super::picture_source::Studio;
use super::report::{Budgets, Report};
use super::sweep::{Bench, Question};
use super::timing::Clock;
use marraztu_core::accuracy::{Axis, Settings, Shot};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Scene, View};
use marraztu_io as io;
use std::time::Duration;

/// A scene of the suite.
#[derive(Debug)]
pub struct SuiteScene {
    /// The name on the command line.
    pub word: &'static str,
    /// A description as a phrase.
    pub what: &'static str,
    /// The keys of the axes that are measured on it.
    pub axes: &'static [&'static str],
    /// The keys of the axes on it with choices that differ in time alone, each with the reason. On
    /// all others, the error of a choice can be seen.
    pub time_only: &'static [(&'static str, &'static str)],
    /// The width and height of the suite's pictures, divided by those of this scene's pictures.
    pub smaller: usize,
    make: fn(u32) -> (Scene, View),
}

/// The arithmetic of light differs in time alone.
const F32_LIGHT: (&str, &str) =
    ("arithmetic", "light in 32 bits is off by a hundredth of a byte step at most");

/// Pictures of rays that are not kept take long: a second of work for each 2 to 5 million of them.
const RAYS: usize = 4;

/// The scenes; together they cover every axis of accuracy.
pub const SUITE: &[SuiteScene] = &[
    SuiteScene {
        word: "first",
        what: "the first scene of the editor",
        axes: &["samples", "resolution", "shading", "arithmetic"],
        time_only: &[F32_LIGHT],
        smaller: 1,
        make: |_| io::default_scene(),
    },
    SuiteScene {
        word: "pixels",
        what: "one lit triangle over the whole picture",
        axes: &["arithmetic", "rounding", "values"],
        time_only: &[F32_LIGHT],
        smaller: 1,
        make: scenes::pixels,
    },
    SuiteScene {
        word: "vertices",
        what: "a million triangles, each about a pixel, 10,000,000 units from the origin",
        axes: &["vertices", "subpixels"],
        time_only: &[],
        smaller: 1,
        make: scenes::vertices,
    },
    SuiteScene {
        word: "highlights",
        what: "balls with exponents from 5 to 500, one of them flattened",
        axes: &["shading", "stretched", "specular"],
        time_only: &[],
        smaller: 1,
        make: scenes::highlights,
    },
    SuiteScene {
        word: "textures",
        what: "a textured floor up to the horizon, seen in a roll",
        axes: &["filter", "interpolation"],
        time_only: &[],
        smaller: 1,
        make: scenes::textures,
    },
    SuiteScene {
        word: "edges",
        what: "a fence of thin slats",
        axes: &["samples", "coverage"],
        time_only: &[],
        smaller: 1,
        make: scenes::edges,
    },
    SuiteScene {
        word: "far",
        what: "a ship 10,000,000 units from the origin",
        axes: &["vertices"],
        time_only: &[],
        smaller: 1,
        make: scenes::far,
    },
    SuiteScene {
        word: "depth",
        what: "pairs of surfaces 0.001 apart, from 2 to 2000 units away",
        axes: &["depth"],
        time_only: &[],
        smaller: 1,
        make: scenes::depth,
    },
    SuiteScene {
        word: "layers",
        what: "thirty-two glass balls, one inside another, each cut through by its neighbours",
        axes: &["transparency"],
        time_only: &[],
        smaller: 1,
        make: scenes::layers,
    },
    SuiteScene {
        word: "bumps",
        what: "balls with a height map, near and far",
        axes: &["bumps", "tangents"],
        time_only: &[],
        smaller: 1,
        make: scenes::bumps,
    },
    SuiteScene {
        word: "shadows",
        what: "balls on a floor under a sun, a bulb and a spot that cast shadows",
        axes: &["shadow-method", "terminator"],
        time_only: &[],
        smaller: 1,
        make: scenes::shadows,
    },
    SuiteScene {
        word: "soft",
        what: "the same with a sun of 6 degrees",
        axes: &["light-samples"],
        time_only: &[],
        smaller: RAYS,
        make: scenes::soft,
    },
    SuiteScene {
        word: "mirrors",
        what: "balls of glass and metal between two mirrors that face each other",
        axes: &["bounces"],
        time_only: &[],
        smaller: RAYS,
        make: scenes::mirrors,
    },
];

/// The size, thoroughness and detail of a suite run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SuiteDetail {
    /// The size of the pictures.
    pub size: Size,
    /// The thoroughness of the measurements.
    pub thoroughness: Thoroughness,
    /// The detail of the scenes, in thousandths of their full triangle count.
    pub detail: u32,
}

impl SuiteDetail {
    /// Takes less than ten minutes on two cores.
    pub const WHOLE: Self = Self {
        size: Size::new(1280, 720),
        thoroughness: Thoroughness { combinations: 0, presets: false, ..Thoroughness::QUICK },
        detail: 1000,
    };
    /// Takes a few seconds, for a smoke test.
    pub const TINY: Self = Self {
        size: Size::new(64, 36),
        thoroughness: Thoroughness {
            word: "tiny",
            limits: Limits { pairs: 1, least: 1, time: Duration::ZERO },
            combinations: 0,
            time: Duration::ZERO,
            presets: false,
        },
        detail: 2,
    };
}

impl SuiteScene {
    /// Finds a scene by name.
    pub fn named(word: &str) -> Option<&'static Self> {
        SUITE.iter().find(|scene| scene.word == word)
    }

    /// Builds the scene and its view; `detail` is in thousandths of the full triangle count.
    pub fn open(&self, detail: u32) -> (Scene, View) {
        (self.make)(detail.max(1))
    }

    /// Returns the axes that are measured on this scene.
    pub fn measured(&self) -> Vec<&'static Axis> {
        self.axes.iter().filter_map(|key| Axis::named(key)).collect()
    }

    /// Returns the command that repeats the measurement.
    fn command(&self, detail: &SuiteDetail) -> String {
        let Size { width, height } = detail.size;
        // A name of the suite means a detail; the size is independent of it.
        let (word, usual) = match detail.detail == SuiteDetail::TINY.detail {
            true => ("tiny", SuiteDetail::TINY.size),
            false => (self.word, SuiteDetail::WHOLE.size),
        };
        let size = match detail.size == usual {
            true => String::new(),
            false => format!(" --size {width}x{height}"),
        };
        format!("marraztu lab --suite={word}{size}")
    }
}

/// Measures scenes of the suite one after the other. `tell` is called after each.
///
/// # Errors
/// The same as [`super::sweep::sweep`].
pub fn run(
    scenes: &[&'static SuiteScene],
    detail: &SuiteDetail,
    clock: &mut dyn Clock,
    watch: &Watch,
    tell: &mut dyn FnMut(&Report),
) -> Result<Vec<Report>, Unmeasured> {
    let mut reports = Vec::new();
    for (i, suite) in scenes.iter().enumerate() {
        // Each scene is an equal part of the progress.
        let part = |i: usize| f64::from(u32::try_from(i).unwrap_or(0)) / scenes.len() as f64;
        let watch = watch.clone().with(&watch.progress.part(part(i), part(i + 1)));
        let report = measured(suite, detail, clock, &watch)?;
        tell(&report);
        reports.push(report);
    }
    Ok(reports)
}

/// Measures one scene: the default, and the choices of its axes.
fn measured(
    suite: &'static SuiteScene,
    detail: &SuiteDetail,
    clock: &mut dyn Clock,
    watch: &Watch,
) -> Result<Report, Unmeasured> {
    let (scene, view) = suite.open(detail.detail);
    let current = Settings::default();
    let question = Question::new(current, suite.measured(), detail.thoroughness);
    // Presets are skipped: on some scenes the ancestors' algorithms would take minutes.
    let found = candidates(&scene, &view, &question);
    let Size { width, height } = detail.size;
    let size = Size::new((width / suite.smaller).max(1), (height / suite.smaller).max(1));
    let mut studio = Studio::new(Shot::new(&scene, &view, &current, size));
    let mut bench = Bench { clock, source: &mut studio, watch, question: &question, size };
    let findings = bench.run(found, &mut |_| {})?;
    Ok(Report {
        scene: format!("suite scene {}", suite.word),
        command: suite.command(detail),
        measure: Measure::Rmse,
        region: Region::Whole,
        budgets: Budgets::default(),
        findings,
    })
}
