//! The state of the dial.

use super::State;
use crate::app::drawing::dial::{DialFigures, DialWish, Dialled};
use marraztu_core::accuracy::{AccuracyPreset, Samples, Settings};
use marraztu_core::base::image::Size;
use marraztu_lab::dial::Figures;

/// The figures of the dial, and whether it is shown.
#[derive(Debug, Default)]
pub struct DialState {
    /// Whether the dial lies over the picture. Preferences show it.
    pub shown: bool,
    /// The last figures, and the picture that they belong to.
    pub(crate) last: Option<Box<DialFigures>>,
    /// Whether the last figures belong to the picture on screen.
    pub current: bool,
    /// The last settings in this scene that no preset has, to return to.
    pub own: Option<Settings>,
    /// The settings of the last finished picture.
    pub drawn: Option<Settings>,
}

impl DialState {
    /// Returns the last figures of the presets.
    pub fn figures(&self) -> &[Figures] {
        self.last.as_ref().map_or(&[], |last| &last.measured.rows)
    }

    /// Returns the last figures of settings. Choices of models do not matter.
    pub(crate) fn of(&self, settings: &Settings) -> Option<Figures> {
        let last = self.last.as_ref()?;
        last.measured.of(&last.of.at_rest(settings))
    }

    /// Returns the line from quick to exact: settings to draw with, and their figures. Samples
    /// that every picture at rest has are left to the refinement.
    pub(crate) fn line(&self) -> Vec<(Settings, Figures)> {
        let Some(last) = self.last.as_ref().filter(|_| self.current) else { return Vec::new() };
        let chosen = |figures: &Figures| {
            let fewer = Settings { samples: Samples::One, ..figures.settings };
            let is_refined = last.of.at_rest(&fewer) == figures.settings;
            (if is_refined { fewer } else { figures.settings }, *figures)
        };
        last.measured.line.iter().map(chosen).collect()
    }

    /// Returns the figures of settings that are on the line.
    pub(crate) fn on_line(&self, settings: &Settings) -> Option<Figures> {
        let at_rest = self.last.as_ref()?.of.at_rest(settings);
        let mut line = self.line().into_iter().map(|(_, figures)| figures);
        line.find(|figures| figures.settings == at_rest)
    }

    /// Returns settings as the window shows them at rest.
    pub(crate) fn at_rest(&self, settings: &Settings, state: &State) -> Settings {
        let DialWish { refined, .. } = state.wish();
        settings.at_rest(refined)
    }

    /// Keeps settings that neither a preset nor the line has.
    pub(crate) fn keep_own(&mut self, settings: &Settings) {
        let is_preset =
            AccuracyPreset::dial().iter().any(|preset| preset.of(settings) == *settings);
        if !is_preset && self.on_line(settings).is_none() {
            self.own = Some(*settings);
        }
    }
}

impl State {
    /// Returns whether the dial lies over the picture: it is an overlay like others.
    pub(crate) const fn shows_dial(&self) -> bool {
        self.dial.shown && self.overlays
    }

    fn wish(&self) -> DialWish {
        let refined = self.drawing.refines.then_some(self.drawing.refined);
        DialWish { refined, own: self.dial.own }
    }

    /// Returns the pictures of the dial; `None` if it is not measured now, because it is hidden or
    /// something else is measured.
    pub(crate) fn wanted_dial(&self) -> Option<DialWish> {
        let measures = self.shows_dial() && self.lab.running.is_none() && !self.is_animated();
        measures.then(|| self.wish())
    }

    /// Returns what the figures of the dial depend on.
    pub(crate) fn dialled(&self, size: Size) -> Dialled {
        Dialled::of(&self.shot(size), self.wish())
    }
}
