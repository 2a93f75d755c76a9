//! Presets of accuracy, the reference of some settings, and how settings are worded.

use crate::accuracy::Settings;
use crate::accuracy::axes::{AXES, Axis, AxisKind};

/// Settings with a name.
#[derive(Debug)]
pub struct AccuracyPreset {
    /// Its word on the command line.
    pub word: &'static str,
    /// Its name on a button.
    pub label: &'static str,
    /// Its purpose, in a sentence.
    pub what: &'static str,
    /// The choices that differ from the default, by the key of the axis and the choice's word.
    pub points: &'static [(&'static str, &'static str)],
    /// The known faults of an ancestor's algorithms.
    pub faults: &'static [&'static str],
}

/// The presets, from the fast to the exact, then those of the two ancestors.
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
            "holes in anything nearer than 97 units",
            "17 writes per pixel at a distance of 400, 100 at 966",
            "highlights smaller than a polygon dim or vanish",
            "normals lean with stretched objects",
            "vertices up to 2.5 pixels off, far from the origin",
            "surfaces closer than 0.06 unit show through each other at 1000",
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
            "surfaces closer than 0.06 unit show through each other at 1000",
            "every colour half a step too dark",
        ],
    },
];

impl AccuracyPreset {
    /// The preset with this word.
    #[must_use]
    pub fn named(word: &str) -> Option<&'static Self> {
        ACCURACY_PRESETS.iter().find(|preset| preset.word == word)
    }

    /// The preset's settings. Axes that are models keep their choices.
    #[must_use]
    pub fn of(&self, settings: &Settings) -> Settings {
        self.points.iter().fold(Settings::default().modelled_as(settings), |settings, point| {
            let choice = Axis::named(point.0).and_then(|axis| axis.choice(point.1));
            choice.expect("presets name axes and choices of the table").of(&settings)
        })
    }
}

impl AccuracyPreset {
    /// Its purpose and its faults.
    #[must_use]
    pub fn in_words(&self) -> String {
        match self.faults {
            [] => self.what.to_owned(),
            faults => format!("{} Its faults: {}.", self.what, faults.join("; ")),
        }
    }
}

impl Settings {
    /// The reference: every axis at its most exact choice. Axes that are models keep their choices,
    /// and so does an axis that is scored apart if it is at its default. Pictures with several
    /// samples are judged against the one with the most of them, each lit.
    #[must_use]
    pub fn reference(&self) -> Self {
        AXES.iter().fold(*self, |settings, axis| match axis.kind {
            AxisKind::ScoredApart if axis.default_choice().is(&settings) => settings,
            _ => axis.most_exact(&settings).of(&settings),
        })
    }

    /// The reference for the choices of one axis: [`Self::reference`] with that axis at its most
    /// exact choice in any case.
    #[must_use]
    pub fn reference_on(&self, key: &str) -> Self {
        // This axis comes first, since the most exact choices of others may depend on it.
        let exact = Axis::named(key).map_or(*self, |axis| axis.most_exact(self).of(self));
        exact.reference()
    }

    /// These settings with the models of `others`.
    #[must_use]
    pub fn modelled_as(&self, others: &Self) -> Self {
        let models = AXES.iter().filter(|axis| axis.kind == AxisKind::Model);
        models.fold(*self, |settings, axis| axis.chosen(others).of(&settings))
    }

    /// What differs from the default, in words: "shading vertex, filter nearest".
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
