//! Measures the dial of the last picture while the user is idle.
//!
//! A measurement is kept until the picture is another one. Selecting something, or drawing with
//! another preset, changes nothing that the dial measures.

use super::snapshot::{Snapshot, pictured};
use super::viewport_renderer::Finer;
use marraztu_core::accuracy::{Samples, Settings, Shot};
use marraztu_core::base::image::Picture;
use marraztu_lab::dial::{Dial, Figures, Step, of_dial};
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{Renderer, plan_frame};
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
    pub(crate) wish: DialWish,
}

#[derive(Clone, Debug)]
pub(crate) struct DialFigures {
    pub(crate) of: Dialled,
    /// The time and the error of each preset, in their order, and of the user's settings before the
    /// ideal; fewer before the ideal is known.
    pub(crate) figures: Vec<Figures>,
}

impl Dialled {
    pub(crate) fn of(shot: &Shot, wish: DialWish) -> Self {
        let own = wish.own.map(|own| own.modelled_as(&shot.settings));
        let settings = Settings::default().modelled_as(&shot.settings);
        let shot = Shot { view: pictured(&shot.view), ..shot.with(settings) };
        Self { shot, wish: DialWish { own, ..wish } }
    }

    /// Returns settings as the window shows them at rest.
    pub(crate) fn at_rest(&self, settings: &Settings) -> Settings {
        self.wish.refined.map_or(*settings, |samples| settings.refined_to(samples))
    }

    fn all(&self) -> Vec<Settings> {
        let presets = of_dial(&self.shot.settings, self.wish.refined).map(|(_, settings)| settings);
        let mut all: Vec<Settings> = presets.collect();
        let own = self.wish.own.map(|own| self.at_rest(&own));
        all.extend(own.filter(|own| !all.contains(own)));
        all
    }
}

/// The measurement of the last picture.
#[derive(Debug, Default)]
pub(crate) struct IdleDial {
    /// Draws what is measured, and windows of the ideal. No picture in the window comes from it.
    renderer: Renderer,
    of: Option<Dialled>,
    /// The measurement, while it is in progress.
    dial: Option<Dial>,
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
            self.dial = Some(Dial::new(&of.shot, &of.all()));
            self.of = Some(of.clone());
        }
        let Some(dial) = &mut self.dial else { return Finer::Done };
        let Ok(step) = dial.step(&mut self.renderer, wanted) else { return Finer::Disturbed };
        let figures = dial.figures();
        if step == Step::Done {
            self.dial = None;
        }
        match step {
            Step::More => Finer::Measured,
            Step::Better | Step::Done => Finer::Dial(Box::new(DialFigures { of, figures })),
        }
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
