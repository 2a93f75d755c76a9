//! Named points in the space of accuracy, and what settings are called.

use crate::accuracy::Settings;
use crate::accuracy::axes::{AXES, Axis, AxisKind};

/// A named point in the space of accuracy.
#[derive(Debug)]
pub struct AccuracyPreset {
    /// Its word on the command line.
    pub word: &'static str,
    /// Its name on a button.
    pub label: &'static str,
    /// What it is for, in a sentence.
    pub what: &'static str,
    /// Where it differs from the default: keys of axes, with words of their choices.
    pub points: &'static [(&'static str, &'static str)],
    /// What is wrong with it, where that is what it is for.
    pub faults: &'static [&'static str],
}

/// Named points, from the fast to the exact; then two of history.
pub const ACCURACY_PRESETS: &[AccuracyPreset] = &[
    AccuracyPreset {
        word: "draft",
        label: "Draft",
        what: "Quick: light at vertices, the nearest texel.",
        points: &[("shading", "vertex"), ("filter", "nearest")],
        faults: &[],
    },
    AccuracyPreset {
        word: "default",
        label: "Default",
        what: "What the editor begins with: at most a quarter of a byte step of light is lost.",
        points: &[],
        faults: &[],
    },
    AccuracyPreset {
        word: "exact",
        label: "Exact",
        what: "At most one byte step from the reference on every pixel.",
        points: &[("arithmetic", "f64"), ("power", "library")],
        faults: &[],
    },
    AccuracyPreset {
        word: "ancestor-a",
        label: "Ancestor A (points)",
        what: "As ancestor A drew: points every 0.1 unit, lit at vertices, in 32 bits.",
        points: &[
            ("shading", "vertex"),
            ("power", "library"),
            ("stretched", "as-it-is"),
            ("vertices", "f32"),
            ("coverage", "points"),
            ("depth", "bits-24"),
            ("filter", "nearest"),
            ("rounding", "truncated"),
        ],
        faults: &[
            "holes in what is nearer than 97 units",
            "17 writes a pixel at a distance of 400, 100 at 966",
            "highlights smaller than a polygon dim or vanish",
            "normals lean with what is stretched",
            "vertices up to 2.5 pixels off, far from the origin",
            "surfaces nearer to each other than 0.06 unit at 1000 show through",
            "every colour half a step too dark",
        ],
    },
    AccuracyPreset {
        word: "ancestor-b",
        label: "Ancestor B (scan lines)",
        what: "As ancestor B drew: rows of pixels, textures without perspective.",
        points: &[
            ("shading", "vertex"),
            ("vertices", "f32"),
            ("coverage", "scan-lines"),
            ("interpolation", "affine"),
            ("depth", "f32"),
            ("filter", "nearest"),
            ("rounding", "truncated"),
        ],
        faults: &[
            "textures bend along the diagonal of every square",
            "outlines a pixel too wide, and seams written twice",
            "highlights smaller than a polygon dim or vanish",
            "vertices up to 2.5 pixels off, far from the origin",
            "surfaces nearer to each other than 0.06 unit at 1000 show through",
            "every colour half a step too dark",
        ],
    },
];

impl AccuracyPreset {
    /// The preset of this word.
    #[must_use]
    pub fn named(word: &str) -> Option<&'static Self> {
        ACCURACY_PRESETS.iter().find(|preset| preset.word == word)
    }

    /// The settings that the preset names. Models stay as they are chosen.
    #[must_use]
    pub fn of(&self, settings: &Settings) -> Settings {
        self.points.iter().fold(Settings::default().modelled_as(settings), |settings, point| {
            let choice = Axis::named(point.0).and_then(|axis| axis.choice(point.1));
            choice.expect("presets name axes and choices of the table").of(&settings)
        })
    }
}

impl AccuracyPreset {
    /// What it is for, and what is wrong with it.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self.faults {
            [] => self.what.to_owned(),
            faults => format!("{} Its faults: {}.", self.what, faults.join("; ")),
        }
    }
}

impl Settings {
    /// The reference: every axis at its most exact. Models stay as they are chosen, and so does an axis
    /// that is scored apart where it is at its default: pictures with several samples are judged against
    /// the one with most of them, each lit.
    #[must_use]
    pub fn reference(&self) -> Self {
        AXES.iter().fold(*self, |settings, axis| match axis.kind {
            AxisKind::ScoredApart if axis.default_choice().is(&settings) => settings,
            _ => axis.most_exact(&settings).of(&settings),
        })
    }

    /// The reference for the choices of the axis of this key: the same, with that axis at its most exact
    /// whatever it is scored by.
    #[must_use]
    pub fn reference_on(&self, key: &str) -> Self {
        // First, for what is most exact elsewhere may depend on it.
        let exact = Axis::named(key).map_or(*self, |axis| axis.most_exact(self).of(self));
        exact.reference()
    }

    /// These settings with the models that others have chosen.
    #[must_use]
    pub fn modelled_as(&self, others: &Self) -> Self {
        let models = AXES.iter().filter(|axis| axis.kind == AxisKind::Model);
        models.fold(*self, |settings, axis| axis.chosen(others).of(&settings))
    }

    /// In words, where they differ from the default: "shading vertex, filter nearest".
    #[must_use]
    pub fn in_words(&self) -> String {
        let preset = ACCURACY_PRESETS.iter().find(|preset| preset.of(self) == *self);
        let differs = |axis: &&Axis| axis.chosen(self).word != axis.default_choice().word;
        let words: Vec<String> = AXES
            .iter()
            .filter(differs)
            .filter(|axis| preset.is_none() || axis.kind == AxisKind::Model)
            .map(|axis| format!("{} {}", axis.key, axis.chosen(self).word))
            .collect();
        match (preset, words.is_empty()) {
            (Some(preset), true) => preset.label.to_owned(),
            (Some(preset), false) => format!("{}, {}", preset.label, words.join(", ")),
            (None, _) => words.join(", "),
        }
    }
}
