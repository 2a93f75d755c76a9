//! The state of the dial.

use super::State;
use crate::app::drawing::dial::{DialFigures, Dialled};
use marraztu_core::accuracy::{AccuracyPreset, Samples};
use marraztu_core::base::image::Size;
use marraztu_lab::dial::{Figures, of_dial};

/// The figures of the dial, and whether it is shown.
#[derive(Debug, Default)]
pub struct DialState {
    /// Whether the dial lies over the picture. Preferences show it.
    pub shown: bool,
    /// The last figures, and the picture that they belong to.
    pub(crate) last: Option<Box<DialFigures>>,
    /// Whether the last figures belong to the picture on screen.
    pub current: bool,
}

impl DialState {
    /// Returns the last figures.
    #[must_use]
    pub fn figures(&self) -> &[Figures] {
        self.last.as_ref().map_or(&[], |last| &last.figures)
    }

    /// Returns the last figures of a preset.
    pub(crate) fn of(&self, preset: &AccuracyPreset) -> Option<Figures> {
        let last = self.last.as_ref()?;
        let mut all = of_dial(&last.of.models, last.of.refined);
        let (_, settings) = all.find(|(other, _)| other.word == preset.word)?;
        last.figures.iter().find(|figures| figures.settings == settings).copied()
    }
}

impl State {
    /// Returns whether the dial lies over the picture: it is an overlay like others.
    pub(crate) const fn shows_dial(&self) -> bool {
        self.dial.shown && self.overlays
    }

    /// Returns the samples per pixel that the pictures of the dial are refined to; `None` if the
    /// dial is not measured now, because it is hidden or something else is measured.
    pub(crate) fn dial_refined_to(&self) -> Option<Option<Samples>> {
        let measures = self.shows_dial() && self.lab.running.is_none() && !self.is_animated();
        measures.then(|| self.drawing.refines.then_some(self.drawing.refined))
    }

    /// Returns what the figures of the dial depend on.
    pub(crate) fn dialled(&self, size: Size) -> Dialled {
        let refined = self.drawing.refines.then_some(self.drawing.refined);
        Dialled::of((&self.scene, &self.view), &self.settings, size, refined)
    }
}
