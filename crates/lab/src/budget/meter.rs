//! Measures pictures: their times, and their errors in windows of the ideal.
//!
//! All pictures are compared with the same windows, so the difference of two errors is more certain
//! than each of them. Pictures are not kept: settings that remain are drawn again, which also tells
//! their time better.

use std::collections::BTreeMap;
use std::time::Duration;

use crate::dial::{ENOUGH, MOST_DRAWS, NARROW, details, squares_within, windows};
use crate::estimate::Estimate;
use crate::flip::Perceived;
use crate::picture_source::{PictureSource, cropped};
use crate::strata::Strata;
use crate::timing::{Clock, Work, time};
use marraztu_core::accuracy::{AXES, Samples, Settings, Shot};
use marraztu_core::base::image::{Picture, Size};
use marraztu_render::Renderer;
use marraztu_render::screen::coverage::PixelBox;

/// The side of a window in pixels, and of one that would take longer than [`LONG`]. FLIP looks
/// further than a window, so its windows are larger.
const SIDE: usize = 16;
const SLOW_SIDE: usize = 8;
const FLIP_SIDE: usize = 32;
const LONG: Duration = Duration::from_millis(60);

/// The windows that are drawn between two pictures.
const BATCH: usize = 8;

/// The times that new settings are drawn if that is quick, and the milliseconds spent on that.
const DRAWS: usize = 4;
const QUICK: f64 = 20.0;

/// The milliseconds of a picture that takes long.
const SLOW: f64 = 300.0;

/// The milliseconds spent on making a time certain, and the fewest times that a picture is drawn.
const STEADYING: f64 = 400.0;
const LEAST_DRAWS: usize = 3;

/// Settings with their figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The settings.
    pub settings: Settings,
    /// The milliseconds of a picture.
    pub ms: Estimate,
    /// The root mean square difference from the ideal, in byte steps.
    pub error: Estimate,
    /// The largest FLIP of a pixel among those compared, from 0 to 1, if it was asked for.
    pub flip: f64,
}

/// What is known of settings.
struct Known {
    settings: Settings,
    times: Vec<f64>,
    /// The squared error in each window.
    squares: BTreeMap<usize, f64>,
    error: Estimate,
    flip: f64,
}

impl Known {
    fn measured(&self) -> Measured {
        // The first picture builds what later ones reuse.
        let times = &self.times[usize::from(self.times.len() > 1)..];
        let ms = Estimate::of_times(times).unwrap_or(Estimate::exact(f64::INFINITY));
        Measured { settings: self.settings, ms, error: self.error, flip: self.flip }
    }
}

/// A window of the ideal.
struct Window {
    exact: Picture,
    /// The window with the pixels around it that FLIP looks at.
    outer: PixelBox,
    perceived: Option<Perceived>,
}

pub(super) struct Meter<'a> {
    source: &'a mut dyn PictureSource,
    clock: &'a mut dyn Clock,
    ideal: Settings,
    size: Size,
    /// Whether FLIP is measured, too.
    is_perceived: bool,
    windows: Vec<PixelBox>,
    details: Vec<f64>,
    strata: Strata,
    /// The pictures that show where windows are worthwhile.
    guides: Vec<Picture>,
    exact: BTreeMap<usize, Window>,
    known: Vec<Known>,
    /// The choices that were drawn, by the keys of their axes.
    seen: Vec<(&'static str, &'static str)>,
    drawn: usize,
    looked: Duration,
}

impl<'a> Meter<'a> {
    /// Prepares to measure a shot. The pictures of `guides` differ where there are details.
    pub(super) fn new(
        source: &'a mut dyn PictureSource,
        clock: &'a mut dyn Clock,
        (shot, is_perceived): (&Shot, bool),
        guides: &[Settings],
    ) -> Self {
        let draw = |settings: &Settings| {
            source.draw(settings);
            source.picture().clone()
        };
        let guides: Vec<Picture> = guides.iter().map(draw).collect();
        let side = match is_perceived {
            true => FLIP_SIDE,
            false => side(source, &shot.settings.ideal(), shot.size),
        };
        let windows: Vec<PixelBox> = windows(shot.size, side).collect();
        let details = details(&guides.iter().collect::<Vec<_>>(), &windows);
        let strata = Strata::new(&details, 1);
        Self {
            source,
            clock,
            ideal: shot.settings.ideal(),
            size: shot.size,
            is_perceived,
            windows,
            details,
            strata,
            guides,
            exact: BTreeMap::new(),
            known: Vec::new(),
            seen: Vec::new(),
            drawn: 0,
            looked: Duration::ZERO,
        }
    }

    /// Returns the figures of settings, which are drawn a few times if they are new.
    pub(super) fn measure(&mut self, settings: &Settings) -> Measured {
        if let Some(measured) = self.known(settings) {
            return measured;
        }
        // A choice may build mipmaps or trees that later pictures reuse.
        let choices = AXES.iter().map(|axis| (axis.key, axis.chosen(settings).word));
        let fresh: Vec<_> = choices.filter(|choice| !self.seen.contains(choice)).collect();
        // What is built once hardly counts among pictures that take long.
        let is_slow = self.known.iter().any(|known| known.measured().ms.value > SLOW);
        if !fresh.is_empty() && !is_slow {
            self.seen.extend(fresh);
            self.source.draw(&Settings { samples: Samples::One, ..*settings });
        }
        let mut last = self.again(settings);
        let mut spent = last.ms.value;
        for _ in 1..DRAWS {
            if spent > QUICK {
                break;
            }
            last = self.again(settings);
            spent += last.ms.value;
        }
        last
    }

    /// Draws settings once more, and compares them with the windows that are new.
    pub(super) fn again(&mut self, settings: &Settings) -> Measured {
        let source = &mut *self.source;
        let time = self.clock.time(Work::Picture(settings), &mut || source.draw(settings));
        self.drawn += 1;
        let place = self.known.iter().position(|known| known.settings == *settings);
        let place = place.unwrap_or_else(|| {
            let (times, squares, error) = (Vec::new(), BTreeMap::new(), Estimate::exact(0.0));
            self.known.push(Known { settings: *settings, times, squares, error, flip: 0.0 });
            self.known.len() - 1
        });
        let known = &mut self.known[place];
        known.times.push(time.as_secs_f64() * 1e3);
        let picture = self.source.picture();
        let is_new = known.squares.len() < self.exact.len();
        for (part, window) in &self.exact {
            if known.squares.contains_key(part) {
                continue;
            }
            let inner = &self.windows[*part];
            known.squares.insert(*part, squares_within(picture, &window.exact, inner));
            known.flip = known.flip.max(window.flip(picture, inner));
        }
        if is_new {
            let bytes = bytes(self.size);
            let sum = self.strata.sum_of(&|part| known.squares[&part]);
            known.error = sum.map(|sum| libm::sqrt(sum / bytes));
        }
        self.known[place].measured()
    }

    /// Draws windows of the ideal for about this time, at least a few from each stratum. Returns
    /// whether there are new ones.
    pub(super) fn look_for(&mut self, time: Duration) -> bool {
        let (end, before) = (self.looked + time, self.exact.len());
        while !self.strata.is_begun() || self.looked < end {
            let Some(next) = self.strata.next() else { break };
            self.look_at(next);
            let window = &self.exact[&next];
            let squares = |it| squares_within(it, &window.exact, &self.windows[next]);
            let squares = self.guides.iter().map(squares).collect();
            self.strata.note(next, squares);
        }
        self.exact.len() > before
    }

    /// Draws a window of the ideal.
    fn look_at(&mut self, part: usize) {
        if self.exact.contains_key(&part) {
            return;
        }
        let reach = if self.is_perceived { Perceived::REACH } else { 0 };
        let inner = self.windows[part];
        let outer = grown(inner, reach, self.size);
        let (source, ideal) = (&mut *self.source, &self.ideal);
        let mut exact = Picture::default();
        self.looked += self.clock.time(Work::Picture(ideal), &mut || {
            exact = source.ideal_window(ideal, outer);
        });
        let perceived = self.is_perceived.then(|| Perceived::new(&exact));
        let exact = cropped(&exact, relative(&inner, outer));
        self.exact.insert(part, Window { exact, outer, perceived });
    }

    /// Compares settings with more windows until their error is certain, or windows have taken this
    /// time in all.
    pub(super) fn sharpen(&mut self, settings: &Settings, end: Duration) -> Estimate {
        let mut error = self.again(settings).error;
        while !error.is_within(ENOUGH) && self.looked < end && self.look_for(ROUND) {
            error = self.again(settings).error;
        }
        error
    }

    /// Draws settings until their time is certain, or for a while.
    pub(super) fn steady(&mut self, settings: &Settings) -> Measured {
        loop {
            let measured = self.again(settings);
            let times = self.entry(settings).map_or(&[][..], |known| &known.times);
            let is_steady = measured.ms.is_within(NARROW) || times.len() >= MOST_DRAWS;
            let is_enough = is_steady || times.iter().sum::<f64>() >= STEADYING;
            if times.len() >= LEAST_DRAWS && is_enough {
                return measured;
            }
        }
    }

    /// Compares settings with further windows of the ideal for about this time, those with most
    /// detail first. Returns false as soon as a pixel has a larger FLIP.
    pub(super) fn compare(&mut self, settings: &Settings, time: Duration, most: f64) -> bool {
        let mut order: Vec<usize> = (0..self.windows.len()).collect();
        order.sort_by(|a, b| self.details[*b].total_cmp(&self.details[*a]));
        let end = self.looked + time;
        for parts in order.chunks(BATCH) {
            if self.looked >= end {
                break;
            }
            for part in parts {
                self.look_at(*part);
            }
            if self.again(settings).flip > most {
                return false;
            }
        }
        true
    }

    /// Returns the figures of the ideal. Its time is that of its windows, less what each of them
    /// takes whatever it shows.
    pub(super) fn ideal(&self) -> Measured {
        let count = self.exact.len().max(1);
        let drawn: f64 = self.exact.values().map(|it| area(&it.outer)).sum();
        let part = drawn / self.size.area().max(1) as f64;
        let ms = self.looked.as_secs_f64() * 1e3;
        let whole = ms / part.max(1e-9);
        // Each window is prepared as the whole picture is, which is drawn in larger ones.
        let larger = ms / count as f64 * Renderer::window_count(self.size) as f64;
        let ms = Estimate { value: whole, interval: [larger.min(whole), whole] };
        Measured { settings: self.ideal, ms, error: Estimate::exact(0.0), flip: 0.0 }
    }

    fn entry(&self, settings: &Settings) -> Option<&Known> {
        self.known.iter().find(|known| known.settings == *settings)
    }

    /// Returns the figures of settings that were measured.
    pub(super) fn known(&self, settings: &Settings) -> Option<Measured> {
        self.entry(settings).map(Known::measured)
    }

    /// Returns the figures of all settings that were measured.
    pub(super) fn all(&self) -> Vec<Measured> {
        self.known.iter().map(Known::measured).collect()
    }

    /// Returns the part of the picture that was compared with the ideal.
    pub(super) fn compared(&self) -> f64 {
        let compared: f64 = self.exact.keys().map(|part| area(&self.windows[*part])).sum();
        compared / self.size.area().max(1) as f64
    }

    /// Returns the number of pictures that were drawn.
    pub(super) const fn drawn(&self) -> usize {
        self.drawn
    }

    /// Returns the time that windows of the ideal have taken.
    pub(super) const fn looked(&self) -> Duration {
        self.looked
    }

    pub(super) fn now(&self) -> Duration {
        self.clock.now()
    }
}

/// Returns the side of windows of the ideal, after drawing one in the middle: where each pixel
/// takes long, small windows tell more in the same time.
fn side(source: &mut dyn PictureSource, ideal: &Settings, size: Size) -> usize {
    let at = |side: usize| (side / 2).saturating_sub(SLOW_SIDE / 2);
    let (left, top) = (at(size.width), at(size.height));
    let to = |side: usize| i32::try_from(side).unwrap_or(i32::MAX);
    let window = PixelBox {
        left: to(left),
        top: to(top),
        right: to((left + SLOW_SIDE).min(size.width)),
        bottom: to((top + SLOW_SIDE).min(size.height)),
    };
    let took = time(|| _ = source.ideal_window(ideal, window));
    let times = (SIDE * SIDE).div_ceil(SLOW_SIDE * SLOW_SIDE);
    let is_long = took * u32::try_from(times).unwrap_or(u32::MAX) > LONG;
    if is_long { SLOW_SIDE } else { SIDE }
}

/// The time for windows before settings are drawn again.
const ROUND: Duration = Duration::from_millis(150);

impl Window {
    /// Returns the largest FLIP of a pixel of a whole picture; 0 if it is not measured.
    fn flip(&self, picture: &Picture, inner: &PixelBox) -> f64 {
        let Some(exact) = &self.perceived else { return 0.0 };
        let other = Perceived::new(&cropped(picture, self.outer));
        other.largest(exact, &relative(inner, self.outer))
    }
}

/// Returns the place of a window in another one.
const fn relative(inner: &PixelBox, outer: PixelBox) -> PixelBox {
    PixelBox {
        left: inner.left - outer.left,
        top: inner.top - outer.top,
        right: inner.right - outer.left,
        bottom: inner.bottom - outer.top,
    }
}

/// Returns the pixels of a window.
fn area(window: &PixelBox) -> f64 {
    f64::from(window.right - window.left) * f64::from(window.bottom - window.top)
}

/// Returns a window with this many further pixels on each side, within the picture.
fn grown(window: PixelBox, reach: usize, size: Size) -> PixelBox {
    let to = |side: usize| i32::try_from(side).unwrap_or(i32::MAX);
    PixelBox {
        left: (window.left - to(reach)).max(0),
        top: (window.top - to(reach)).max(0),
        right: (window.right + to(reach)).min(to(size.width)),
        bottom: (window.bottom + to(reach)).min(to(size.height)),
    }
}

/// Returns the number of bytes of a picture that count.
fn bytes(size: Size) -> f64 {
    (3 * size.area().max(1)) as f64
}
