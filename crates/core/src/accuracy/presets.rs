//! Presets of accuracy, the reference and the ideal, and how settings are worded.

use crate::accuracy::axes::{AXES, Axis, AxisKind};
use crate::accuracy::{Coverage, Resolution, Samples, Settings};

/// Settings with a name.
#[derive(Debug)]
pub struct AccuracyPreset {
    /// Its word on the command line.
    pub word: &'static str,
    /// Its name on a button.
    pub label: &'static str,
    /// A description of the preset and its drawbacks, in a sentence or two.
    pub what: &'static str,
    /// The settings of the preset.
    pub points: Points,
    /// The known faults of an ancestor's algorithms.
    pub faults: &'static [&'static str],
}

/// The settings of a preset. Axes that are models keep their choices.
#[derive(Clone, Copy, Debug)]
pub enum Points {
    /// The default, except for these choices: the key of the axis and the choice's word.
    Listed(&'static [(&'static str, &'static str)]),
    /// [`Settings::reference`], at the default number of samples.
    Reference,
    /// [`Settings::ideal`].
    Ideal,
}

/// All presets: first the dial's, from fast to exact, then the two ancestors.
pub const ACCURACY_PRESETS: &[AccuracyPreset] = &[
    AccuracyPreset {
        word: "draft",
        label: "Draft",
        what: "A quarter of the pixels, enlarged. Gives up fine detail and sharp edges.",
        points: Points::Listed(&[("resolution", "half")]),
        faults: &[],
    },
    AccuracyPreset {
        word: "default",
        label: "Default",
        what: "Light within a quarter of a byte step. Gives up smooth edges and distant textures \
            unless it is refined.",
        points: Points::Listed(&[]),
        faults: &[],
    },
    AccuracyPreset {
        word: "exact",
        label: "Exact",
        what: "Every choice at its most exact: the reference with as many samples. Gives up what \
            more samples would show, and time.",
        points: Points::Reference,
        faults: &[],
    },
    AccuracyPreset {
        word: "ideal",
        label: "Ideal",
        what: "Exact, with 256 samples in every pixel: all others are judged against it. Gives up \
            time alone.",
        points: Points::Ideal,
        faults: &[],
    },
    AccuracyPreset {
        word: "ancestor-a",
        label: "Ancestor A (points)",
        what: "Like ancestor A: points every 0.1 unit, lit at vertices, in 32 bits.",
        points: Points::Listed(&[
            ("shading", "vertex"),
            ("stretched", "as-it-is"),
            ("vertices", "f32"),
            ("coverage", "points"),
            ("depth", "bits-24"),
            ("filter", "nearest"),
            ("rounding", "truncated"),
            ("transparency", "threshold"),
        ]),
        faults: &[
            "holes in surfaces nearer than 97 units",
            "surfaces along the direction of view, such as a floor under a level camera, vanish",
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
        points: Points::Listed(&[
            ("shading", "vertex"),
            ("vertices", "f32"),
            ("coverage", "scan-lines"),
            ("interpolation", "affine"),
            ("depth", "f32"),
            ("filter", "nearest"),
            ("rounding", "truncated"),
            ("transparency", "threshold"),
        ]),
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
    pub fn named(word: &str) -> Option<&'static Self> {
        ACCURACY_PRESETS.iter().find(|preset| preset.word == word)
    }

    /// The presets of the dial, from the fast to the exact.
    pub fn dial() -> &'static [Self] {
        let ideal = ACCURACY_PRESETS.iter().position(|it| matches!(it.points, Points::Ideal));
        &ACCURACY_PRESETS[..=ideal.expect("the ideal is a preset")]
    }

    /// The preset's settings. Axes that are models keep their choices.
    pub fn of(&self, settings: &Settings) -> Settings {
        let default = Settings::default().modelled_as(settings);
        match self.points {
            Points::Listed(points) => points.iter().fold(default, |settings, point| {
                let choice = Axis::named(point.0).and_then(|axis| axis.choice(point.1));
                choice.expect("presets name axes and choices of the table").of(&settings)
            }),
            Points::Reference => default.reference(),
            Points::Ideal => default.ideal(),
        }
    }
}

impl AccuracyPreset {
    /// Describes the preset and its faults.
    pub fn in_words(&self) -> String {
        match self.faults {
            [] => self.what.to_owned(),
            faults => format!("{} Its faults: {}.", self.what, faults.join("; ")),
        }
    }
}

impl Settings {
    /// The ideal that pictures are judged against: every axis at its most exact choice, with 256
    /// samples per pixel, each lit. Axes that are models keep their choices.
    pub fn ideal(&self) -> Self {
        // Some choices are the most exact ones only with several samples, so these come first.
        let start = Self { samples: Samples::TwoFiftySix, ..*self };
        AXES.iter().fold(start, |settings, axis| axis.most_exact(&settings).of(&settings))
    }

    /// The reference with the same number of samples: all other axes as in the ideal.
    pub fn reference(&self) -> Self {
        Self { samples: self.samples, ..self.ideal() }
    }

    /// The picture that shows what one axis alone changes: these settings with this axis at its
    /// most exact choice, or at the default choice if it is a model.
    pub fn exact_in(&self, axis: &Axis) -> Self {
        match axis.kind {
            AxisKind::Scored => axis.most_exact(self).of(self),
            AxisKind::Model => axis.default_choice().of(self),
        }
    }

    /// Whether a picture can be refined by more samples per pixel: the ancestors' algorithms have
    /// one, and half resolution is chosen to save time.
    pub const fn can_refine(&self) -> bool {
        match (self.coverage, self.resolution) {
            (Coverage::ScanLines | Coverage::Points, _) | (_, Resolution::Half) => false,
            (Coverage::Exact | Coverage::F32Edges, Resolution::Full) => true,
        }
    }

    /// The settings of a picture in a file: at least [`Self::REFINED`] samples per pixel, as in a
    /// window in which nothing moves.
    pub const fn refined(self) -> Self {
        self.refined_to(Self::REFINED)
    }

    /// These settings with at least this number of samples per pixel, if they can be refined.
    pub const fn refined_to(self, samples: Samples) -> Self {
        let is_more = samples.count() > self.samples.count();
        Self { samples: if is_more && self.can_refine() { samples } else { self.samples }, ..self }
    }

    /// These settings as a picture at rest has them: with at least `refined` samples per pixel, if
    /// it is refined.
    pub fn at_rest(&self, refined: Option<Samples>) -> Self {
        refined.map_or(*self, |samples| self.refined_to(samples))
    }

    /// Describes the samples of a picture: "1 sample", "16 samples", "1/4 sample".
    pub fn samples_in_words(&self) -> String {
        match (self.resolution, self.samples) {
            (Resolution::Half, _) => "1/4 sample".to_owned(),
            (Resolution::Full, Samples::One) => "1 sample".to_owned(),
            (Resolution::Full, samples) => format!("{} samples", samples.count()),
        }
    }

    /// The samples per pixel of a picture in a file.
    pub const REFINED: Samples = Samples::Sixteen;

    /// These settings with the models of `others`.
    pub fn modelled_as(&self, others: &Self) -> Self {
        let models = AXES.iter().filter(|axis| axis.kind == AxisKind::Model);
        models.fold(*self, |settings, axis| axis.chosen(others).of(&settings))
    }

    /// The differences from the default, in words: "Gouraud shading, nearest texture filter".
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
