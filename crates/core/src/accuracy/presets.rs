//! Presets of accuracy, the reference of some settings, and how settings are worded.

use crate::accuracy::axes::{AXES, Axis, AxisKind};
use crate::accuracy::{Coverage, Samples, Settings};

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
        what: "Fast: light at vertices, nearest texel.",
        points: &[("shading", "vertex"), ("filter", "nearest")],
        faults: &[],
    },
    AccuracyPreset {
        word: "default",
        label: "Default",
        what: "The default of the editor: loses at most a quarter of a byte step of light.",
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
        what: "Like ancestor A: points every 0.1 unit, lit at vertices, in 32 bits.",
        points: &[
            ("shading", "vertex"),
            ("power", "library"),
            ("stretched", "as-it-is"),
            ("vertices", "f32"),
            ("coverage", "points"),
            ("depth", "bits-24"),
            ("filter", "nearest"),
            ("rounding", "truncated"),
            ("transparency", "threshold"),
        ],
        faults: &[
            "holes in surfaces nearer than 97 units",
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
        what: "Like ancestor B: rows of pixels, textures without perspective.",
        points: &[
            ("shading", "vertex"),
            ("vertices", "f32"),
            ("coverage", "scan-lines"),
            ("interpolation", "affine"),
            ("depth", "f32"),
            ("filter", "nearest"),
            ("rounding", "truncated"),
            ("transparency", "threshold"),
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
    /// The reference: every axis at its most exact choice, one sample at the centre of each pixel.
    /// Axes that are models keep their choices. Samples per pixel are judged against
    /// [`Self::sampled`].
    #[must_use]
    pub fn reference(&self) -> Self {
        // The most exact choices of other axes may depend on those that are scored apart.
        let apart = |axis: &&Axis| axis.kind == AxisKind::ScoredApart;
        let base = AXES
            .iter()
            .filter(apart)
            .fold(*self, |settings, axis| axis.default_choice().of(&settings));
        let others = AXES.iter().filter(|axis| !apart(axis));
        others.fold(base, |settings, axis| axis.most_exact(&settings).of(&settings))
    }

    /// The settings of the 256 pictures that are averaged as the reference for samples per pixel:
    /// the default, with the models of these settings. They do not depend on any other choice.
    #[must_use]
    pub fn sampled(&self) -> Self {
        Self::default().modelled_as(self)
    }

    /// Whether a picture can be refined by more samples per pixel: the ancestors' algorithms have
    /// one.
    #[must_use]
    pub const fn can_refine(&self) -> bool {
        match self.coverage {
            Coverage::Exact | Coverage::F32Edges => true,
            Coverage::ScanLines | Coverage::Points => false,
        }
    }

    /// The settings of a picture in a file: at least [`Self::REFINED`] samples per pixel, as in a
    /// window in which nothing moves.
    #[must_use]
    pub const fn refined(self) -> Self {
        let more = Self::REFINED.count() > self.samples.count();
        Self {
            samples: if more && self.can_refine() { Self::REFINED } else { self.samples },
            ..self
        }
    }

    /// The samples per pixel of a picture in a file.
    pub const REFINED: Samples = Samples::Sixteen;

    /// These settings with the models of `others`.
    #[must_use]
    pub fn modelled_as(&self, others: &Self) -> Self {
        let models = AXES.iter().filter(|axis| axis.kind == AxisKind::Model);
        models.fold(*self, |settings, axis| axis.chosen(others).of(&settings))
    }

    /// The differences from the default, in words: "Gouraud shading, nearest texture filter".
    #[must_use]
    pub fn in_words(&self) -> String {
        let preset = ACCURACY_PRESETS.iter().find(|preset| preset.of(self) == *self);
        let differs = |axis: &&Axis| axis.chosen(self).word != axis.default_choice().word;
        let words: Vec<String> = AXES
            .iter()
            .filter(differs)
            .filter(|axis| preset.is_none() || axis.kind == AxisKind::Model)
            .map(|axis| axis.in_words(axis.chosen(self)))
            .collect();
        match (preset, words.is_empty()) {
            (Some(preset), true) => preset.label.to_owned(),
            (Some(preset), false) => format!("{}, {}", preset.label, words.join(", ")),
            (None, _) => words.join(", "),
        }
    }
}
