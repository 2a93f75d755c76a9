//! A picture of the dial, with its times.

use std::time::{Duration, Instant};

use super::{Estimate, MOST_DRAWS, NARROW, squares_within};
use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::base::image::{Picture, Size};
use marraztu_render::screen::coverage::PixelBox;
use marraztu_render::{Cancelled, FramePlan, Renderer, plan_frame};

/// The time spent on drawing a picture again while its time is uncertain.
const STEADYING: Duration = Duration::from_secs(2);

/// Pictures that take longer are not drawn as a whole, in milliseconds.
const SLOW: f64 = 1500.0;

/// The divisors of width and height of the smaller pictures that tell the time of a slow one.
const SMALLER: [usize; 2] = [6, 3];

/// The part by which the time of a slow picture may differ from what smaller ones tell.
const UNCERTAIN: f64 = 0.25;

#[derive(Debug)]
pub(super) struct Drawn {
    shot: Shot,
    plan: FramePlan,
    /// The milliseconds of each time that it was drawn.
    times: Vec<f64>,
    picture: Picture,
    /// The milliseconds of a slow picture, which is never drawn as a whole.
    slow: Option<f64>,
    /// The time that smaller pictures took.
    trying: Option<Duration>,
}

impl Drawn {
    pub(super) fn new(shot: Shot) -> Self {
        let plan = plan_frame(&shot);
        let (times, picture) = (Vec::new(), Picture::default());
        Self { shot, plan, times, picture, slow: None, trying: None }
    }

    pub(super) const fn settings(&self) -> Settings {
        self.shot.settings
    }

    pub(super) const fn is_slow(&self) -> bool {
        self.slow.is_some()
    }

    /// Returns the whole picture, unless it is slow.
    pub(super) fn picture(&self) -> Option<&Picture> {
        (!self.is_slow()).then_some(&self.picture)
    }

    /// Returns how often it was drawn. A slow picture needs no more.
    pub(super) fn draws(&self) -> usize {
        if self.is_slow() { usize::MAX } else { self.times.len() }
    }

    /// Draws the picture once more, or finds that it is slow.
    pub(super) fn draw(
        &mut self,
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<(), Cancelled> {
        if self.trying.is_none() {
            let begun = Instant::now();
            self.slow = self.slow_time(renderer, wanted)?;
            self.trying = Some(begun.elapsed());
            if self.is_slow() {
                return Ok(());
            }
        }
        let time = milliseconds(renderer, &self.plan, wanted)?;
        if self.times.is_empty() {
            self.picture = renderer.picture().clone();
        }
        self.times.push(time);
        Ok(())
    }

    /// Estimates the milliseconds of the picture from smaller ones: a time for any picture, and one
    /// for each pixel. `None` if it is not slow, or is enlarged and has no windows.
    fn slow_time(
        &self,
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Option<f64>, Cancelled> {
        let Size { width, height } = self.shot.size;
        let mut known: Vec<(f64, f64)> = Vec::new();
        for divisor in SMALLER {
            let size = Size::new(width.div_ceil(divisor), height.div_ceil(divisor));
            let plan = plan_frame(&Shot { size, ..self.shot.clone() });
            if known.is_empty() {
                // The first picture builds what later ones reuse.
                milliseconds(renderer, &plan, wanted)?;
            }
            let time = milliseconds(renderer, &plan, wanted)?;
            let pixels = size.area() as f64;
            if time * self.shot.size.area() as f64 / pixels < SLOW {
                return Ok(None);
            }
            known.push((pixels, time));
        }
        let [(few, quick), (more, slow)] = known[..] else { return Ok(None) };
        let each = ((slow - quick) / (more - few)).max(0.0);
        let time = slow + each * (self.shot.size.area() as f64 - more);
        Ok((time >= SLOW && self.plan.has_windows()).then_some(time))
    }

    /// Returns the sum of the squared byte differences from the ideal in a window.
    pub(super) fn squares(
        &self,
        exact: &Picture,
        window: PixelBox,
        renderer: &mut Renderer,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<f64, Cancelled> {
        let Some(picture) = self.picture() else {
            let own = renderer.render_window(&self.plan, window, wanted)?;
            let (right, bottom) = (window.right - window.left, window.bottom - window.top);
            return Ok(squares_within(&own, exact, &PixelBox { left: 0, top: 0, right, bottom }));
        };
        Ok(squares_within(picture, exact, &window))
    }

    /// Returns the milliseconds of the picture; `None` before it was drawn.
    pub(super) fn ms(&self) -> Option<Estimate> {
        let uncertain = |value: f64| Estimate {
            value,
            interval: [value * (1.0 - UNCERTAIN), value * (1.0 + UNCERTAIN)],
        };
        self.slow.map(uncertain).or_else(|| Estimate::of_times(&self.times))
    }

    pub(super) fn spent(&self) -> Duration {
        self.trying.unwrap_or_default()
            + Duration::from_secs_f64(self.times.iter().sum::<f64>() / 1e3)
    }

    /// Returns whether drawing it again would tell its time better.
    pub(super) fn is_unsteady(&self) -> bool {
        let is_narrow = Estimate::of_times(&self.times).is_some_and(|ms| ms.is_within(NARROW));
        let is_enough = self.draws() >= MOST_DRAWS || self.spent() >= STEADYING;
        self.draws() < 2 || !(is_narrow || is_enough)
    }
}

/// Returns the milliseconds of drawing a picture.
fn milliseconds(
    renderer: &mut Renderer,
    plan: &FramePlan,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<f64, Cancelled> {
    let begun = Instant::now();
    renderer.render_while(plan, wanted)?;
    Ok(begun.elapsed().as_secs_f64() * 1e3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slow picture has the errors that it would have as a whole.
    #[test]
    fn a_slow_picture_has_the_same_error_in_a_window() {
        let (scene, view) = marraztu_io::default_scene();
        let shot = Shot::new(&scene, &view, &Settings::default().refined(), Size::new(120, 80));
        let ideal = plan_frame(&shot.with(shot.settings.ideal()));
        let window = PixelBox { left: 48, top: 24, right: 80, bottom: 48 };
        let mut renderer = Renderer::default();
        let exact = renderer.render_window(&ideal, window, &|| true).unwrap();
        let mut drawn = Drawn::new(shot);
        drawn.draw(&mut renderer, &|| true).unwrap();
        assert!(drawn.picture().is_some(), "it is quick");
        let whole = drawn.squares(&exact, window, &mut renderer, &|| true).unwrap();
        assert!(whole > 0.0);
        drawn.slow = Some(2.0 * SLOW);
        let part = drawn.squares(&exact, window, &mut renderer, &|| true).unwrap();
        assert!((part / whole - 1.0).abs() < 0.01, "{part} for {whole}");
        assert!(!drawn.is_unsteady(), "it is not drawn again");
    }
}
