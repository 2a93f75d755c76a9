//! The line from quick to exact: the settings that no other ones beat in this view, of all single
//! choices and of the combinations that promise most.

use super::{Dial, Figures, Step};
use crate::budget::model::{self, predictions};
use crate::budget::{FreeAxis, free_axes, is_sound};
use crate::front::{Point, front};
use marraztu_core::accuracy::{Choice, Samples, Settings, Shot};
use marraztu_render::{Cancelled, Renderer};

/// The most combinations that are measured.
const COMBINATIONS: usize = 8;

/// A step along the line has to reduce the error by this part.
const GAIN: f64 = 0.1;

/// Points of the line are further apart in time.
const CLOSE: f64 = 1.05;

/// A choice has to save this part of the time, or to be more exact.
const WORTHWHILE: f64 = 0.05;

/// A measurement of the line in progress.
#[derive(Debug)]
pub struct Line {
    shot: Shot,
    refined: Option<Samples>,
    free: Vec<FreeAxis>,
    dial: Dial,
    known: Vec<Figures>,
    /// Whether combinations are measured, after all single choices.
    combines: bool,
}

impl Line {
    /// Prepares to measure the line of a shot with the default settings. Pictures at rest have at
    /// least `refined` samples; `rows` are known already.
    pub fn new(shot: &Shot, refined: Option<Samples>, rows: &[Figures]) -> Self {
        let (free, base) = (free_axes(shot, &[]), shot.settings);
        let mut all = vec![base.at_rest(refined)];
        for choice in free.iter().flat_map(|free| &free.choices) {
            let settings = choice.of(&base).at_rest(refined);
            if (choice.among)(&base).is_ok() && !all.contains(&settings) {
                all.push(settings);
            }
        }
        let dial = Dial::new(shot, &all);
        Self { shot: shot.clone(), refined, free, dial, known: rows.to_vec(), combines: false }
    }

    /// Takes the next step: draws one picture or one window.
    ///
    /// # Errors
    /// [`Cancelled`] if `wanted` returns false. The step can then be taken again.
    pub fn step(
        &mut self,
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Step, Cancelled> {
        if self.dial.step(renderer, wanted)? != Step::Done {
            return Ok(Step::More);
        }
        let measured = self.dial.figures();
        measured.iter().for_each(|it| self.add(*it));
        if self.combines {
            return Ok(Step::Done);
        }
        self.combines = true;
        let combinations = self.combinations(&measured);
        self.dial = Dial::new(&self.shot, &combinations);
        Ok(if combinations.is_empty() { Step::Done } else { Step::Better })
    }

    /// Adds figures that were measured elsewhere, unless those of their settings are known.
    pub fn add(&mut self, figures: Figures) {
        if !self.known.iter().any(|known| known.settings == figures.settings) {
            self.known.push(figures);
        }
    }

    /// Returns the combinations of choices that are predicted to be on the front.
    fn combinations(&self, measured: &[Figures]) -> Vec<Settings> {
        let base = self.shot.settings;
        let of = |settings: &Settings| {
            let at_rest = settings.at_rest(self.refined);
            let found = measured.iter().find(|it| it.settings == at_rest)?;
            Some([found.ms.value, found.error?.value * found.error?.value])
        };
        let Some(start) = of(&base) else { return Vec::new() };
        let steps = self.free.iter().map(|free| {
            let step = |choice: &&'static Choice| {
                let [ms, error] = of(&choice.of(&base))?;
                let (time, error) = (ms / start[0], error - start[1]);
                let is_of_use = time < 1.0 - WORTHWHILE || error < 0.0;
                is_of_use.then_some(model::Step { choice, time, error })
            };
            free.choices.iter().filter_map(step).collect()
        });
        let steps: Vec<Vec<model::Step>> = steps.collect();
        let all = predictions((base, start), &steps);
        let is_known = |it: &Settings| self.known.iter().any(|known| known.settings == *it);
        let mut new: Vec<Settings> = Vec::new();
        for (settings, _) in all {
            let at_rest = settings.at_rest(self.refined);
            if is_sound(&settings, &base) && !is_known(&at_rest) && !new.contains(&at_rest) {
                new.push(at_rest);
            }
        }
        // Some from quick to exact.
        let count = new.len().min(COMBINATIONS);
        (0..count).map(|i| new[i * new.len() / count]).collect()
    }

    /// Returns the front of all that is known, from quick to exact.
    pub fn figures(&self) -> Vec<Figures> {
        let known = self.known.iter().filter_map(|it| {
            let point = Point { time: it.ms.value, error: it.error?.value };
            point.time.is_finite().then_some((*it, point))
        });
        let (known, points): (Vec<Figures>, Vec<Point>) = known.unzip();
        let mut line: Vec<Figures> = Vec::new();
        for i in front(&points, GAIN) {
            // If the next point is hardly slower, this one is of no use.
            let is_close = |last: &mut Figures| known[i].ms.value < CLOSE * last.ms.value;
            line.pop_if(is_close);
            line.push(known[i]);
        }
        line
    }
}

#[cfg(test)]
mod tests {
    use super::super::of_dial;
    use super::*;
    use marraztu_core::base::image::Size;

    #[test]
    fn the_line_falls_from_quick_to_exact_and_has_more_than_the_presets() {
        let (scene, view) = marraztu_io::default_scene();
        let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(160, 120));
        let refined = Some(Samples::Sixteen);
        let rows: Vec<Settings> = of_dial(&shot.settings, refined).map(|(_, it)| it).collect();
        let (mut dial, mut renderer) = (Dial::new(&shot, &rows), Renderer::default());
        while dial.step(&mut renderer, &|| true) != Ok(Step::Done) {}
        let mut line = Line::new(&shot, refined, &dial.figures());
        assert!(!line.figures().is_empty());
        while line.step(&mut renderer, &|| true) != Ok(Step::Done) {}
        let figures = line.figures();
        assert!(line.known.len() > rows.len() + 4, "{}", line.known.len());
        for pair in figures.windows(2) {
            let [quick, exact] = [&pair[0], &pair[1]];
            assert!(quick.ms.value <= exact.ms.value, "{figures:?}");
            assert!(exact.error.unwrap().value < 0.91 * quick.error.unwrap().value);
        }
        assert_eq!(figures.last().map(|it| it.error.unwrap().value), Some(0.0));
    }
}
