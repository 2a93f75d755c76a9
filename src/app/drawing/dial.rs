//! Measures the dial of the last picture while the user is idle.
//!
//! A measurement is kept until the picture is another one. Selecting something, or drawing with
//! another preset, changes nothing that the dial measures.

use super::snapshot::{Snapshot, pictured};
use super::viewport_renderer::Finer;
use marraztu_core::accuracy::{Samples, Settings, Shot};
use marraztu_core::base::image::Picture;
use marraztu_lab::dial::{Dial, Figures, Line, Step, of_dial};
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{Cancelled, Renderer, plan_frame};
use serde::{Deserialize, Serialize};

/// The pictures of the dial, besides the presets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DialWish {
    /// The samples per pixel that pictures are refined to.
    pub(crate) refined: Option<Samples>,
    /// The user's own settings, if no preset has them.
    pub(crate) own: Option<Settings>,
}

/// Everything that the figures of the dial depend on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Dialled {
    /// The models, with all other axes at their defaults, and the view without what the picture
    /// does not show.
    pub(crate) shot: Shot,
    /// The samples per pixel that pictures are refined to.
    pub(crate) refined: Option<Samples>,
}

/// The figures that were measured so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Measured {
    /// The presets, in their order; fewer before the ideal is known.
    pub(crate) rows: Vec<Figures>,
    /// The user's own settings.
    pub(crate) own: Option<Figures>,
    /// The settings that no other ones beat, from quick to exact.
    pub(crate) line: Vec<Figures>,
}

impl Measured {
    /// Returns the figures of settings, as the window shows them at rest.
    pub(crate) fn of(&self, settings: &Settings) -> Option<Figures> {
        let mut all = self.rows.iter().chain(&self.own).chain(&self.line);
        all.find(|figures| figures.settings == *settings).copied()
    }
}

#[derive(Clone, Debug)]
pub(crate) struct DialFigures {
    pub(crate) of: Dialled,
    pub(crate) measured: Measured,
}

impl Dialled {
    pub(crate) fn of(shot: &Shot, wish: DialWish) -> Self {
        let settings = Settings::default().modelled_as(&shot.settings);
        let shot = Shot { view: pictured(&shot.view), ..shot.with(settings) };
        Self { shot, refined: wish.refined }
    }

    /// Returns settings as the window shows them at rest. Choices of models do not matter.
    pub(crate) fn at_rest(&self, settings: &Settings) -> Settings {
        settings.modelled_as(&self.shot.settings).at_rest(self.refined)
    }

    fn rows(&self) -> Vec<Settings> {
        of_dial(&self.shot.settings, self.refined).map(|(_, settings)| settings).collect()
    }
}

/// The measurement of the last picture.
#[derive(Debug, Default)]
pub(crate) struct IdleDial {
    /// Draws what is measured, and windows of the ideal. No picture in the window comes from it.
    renderer: Renderer,
    of: Option<Dialled>,
    measured: Measured,
    /// The measurements in progress: the rows come first, then the user's own settings, then the
    /// line.
    rows: Option<Dial>,
    own: Option<(Settings, Dial)>,
    line: Option<Line>,
}

impl IdleDial {
    /// Takes the next step of measuring a picture, unless its figures are known.
    pub(crate) fn step(
        &mut self,
        snapshot: &Snapshot,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Finer {
        let Some(wish) = snapshot.options.dial else { return Finer::Done };
        let of = Dialled::of(&snapshot.shot, wish);
        if self.of.as_ref() != Some(&of) {
            let rows = Some(Dial::new(&of.shot, &of.rows()));
            let renderer = std::mem::take(&mut self.renderer);
            *self = Self { renderer, rows, of: Some(of.clone()), ..Self::default() };
        }
        let own = wish.own.map(|own| of.at_rest(&own));
        match self.measure(&of, own, wanted) {
            Err(Cancelled) => Finer::Disturbed,
            Ok(None) => Finer::Done,
            Ok(Some(Step::More)) => Finer::Measured,
            Ok(Some(Step::Better | Step::Done)) => {
                Finer::Dial(Box::new(DialFigures { of, measured: self.measured.clone() }))
            }
        }
    }

    /// Takes the next step of the first measurement that is not finished; `None` if all are.
    fn measure(
        &mut self,
        of: &Dialled,
        own: Option<Settings>,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<Step>, Cancelled> {
        let Self { renderer, measured, .. } = self;
        if let Some(dial) = &mut self.rows {
            let step = dial.step(renderer, wanted)?;
            measured.rows = dial.figures();
            if step == Step::Done {
                self.rows = None;
                let line = Line::new(&of.shot, of.refined, &measured.rows);
                measured.line = line.figures();
                self.line = Some(line);
            }
            return Ok(Some(step));
        }
        if self.own.as_ref().map(|(before, _)| *before) != own {
            // The figures of rows and of the line are known.
            let unknown = own.filter(|own| measured.of(own).is_none());
            self.own = unknown.map(|own| (own, Dial::new(&of.shot, &[own])));
        }
        if let Some((_, dial)) = &mut self.own {
            let step = dial.step(renderer, wanted)?;
            measured.own = dial.figures().first().copied();
            if step == Step::Done {
                self.own = None;
                // They may beat the points of the line.
                if let (Some(line), Some(own)) = (&mut self.line, measured.own) {
                    line.add(own);
                    measured.line = line.figures();
                }
            }
            return Ok(Some(step));
        }
        let Some(line) = &mut self.line else { return Ok(None) };
        let step = line.step(renderer, wanted)?;
        measured.line = line.figures();
        if step == Step::Done {
            self.line = None;
        }
        Ok(Some(step))
    }

    /// Draws a window of the ideal of a picture; `None` if that is no longer wanted.
    pub(crate) fn ideal(
        &mut self,
        snapshot: &Snapshot,
        window: PixelBox,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Option<Picture> {
        let plan = plan_frame(&snapshot.shot.with(snapshot.shot.settings.ideal()));
        self.renderer.render_window(&plan, window, wanted).ok()
    }
}
