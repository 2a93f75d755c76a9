//! Adaptive quality: how the picture keeps up with the user.
//!
//! While something moves and frames take too long, they are drawn at reduced quality; as soon as
//! everything is still, at full quality. No code here reads a clock: times are passed in.
//!
//! A frame is cancelled for a newer one only at full quality, only if it takes longer than the
//! budget, and never twice in a row. So a slow frame never delays the next action, while in a
//! stream of changes at least every second frame is finished and shown. Frames at reduced quality
//! are always finished: cancelling them would not bring the next one sooner.

use std::time::Duration;

use crate::accuracy::{Filter, LightAt, Settings};
use crate::base::image::Size;

/// The time a frame may take before the picture lags behind the user: 30 frames a second.
const BUDGET: Duration = Duration::from_millis(33);

/// Seconds after the last change and the picture that shows it until a moving scene is still.
const STILL: f64 = 0.15;

/// A full frame that differs in time from the one before by this factor is of another scene.
const ANOTHER_SCENE: f64 = 1.5;

/// What is reduced in a picture so that it is drawn sooner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reduction {
    /// Light at vertices rather than at pixels.
    pub vertex_light: bool,
    /// The nearest texel rather than a mean of four.
    pub nearest_texels: bool,
    /// A quarter of the pixels, each shown as four.
    pub half_size: bool,
}

impl Reduction {
    /// Full quality.
    pub const NONE: Self = Self { vertex_light: false, nearest_texels: false, half_size: false };

    /// The reductions to try, in order; the first that is fast enough is used. Half size also comes
    /// alone, since a mesh may have more vertices than the picture has pixels.
    const ALL: [Self; 5] = [
        Self::NONE,
        Self { vertex_light: true, ..Self::NONE },
        Self { vertex_light: true, nearest_texels: true, half_size: false },
        Self { half_size: true, ..Self::NONE },
        Self { vertex_light: true, nearest_texels: true, half_size: true },
    ];

    /// Settings and size of the picture.
    pub(crate) fn applied(self, settings: Settings, size: Size) -> (Settings, Size) {
        let light = match settings.light {
            LightAt::Pixel | LightAt::Sample if self.vertex_light => LightAt::Vertex,
            light => light,
        };
        let filter = if self.nearest_texels { Filter::Nearest } else { settings.filter };
        let half = |pixels: usize| if self.half_size { pixels.div_ceil(2) } else { pixels };
        let size = Size::new(half(size.width), half(size.height));
        (Settings { light, filter, ..settings }, size)
    }

    /// In words: "light per vertex, half size". Empty at full quality.
    #[must_use]
    pub fn words(self) -> String {
        let words = [
            (self.vertex_light, "light per vertex"),
            (self.nearest_texels, "nearest texels"),
            (self.half_size, "half size"),
        ];
        let words: Vec<&str> = words.iter().filter(|(on, _)| *on).map(|(_, word)| *word).collect();
        words.join(", ")
    }
}

/// What can be reduced in this picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Applicable {
    pub(crate) settings: Settings,
    /// Whether any texture is shown.
    pub(crate) textured: bool,
}

impl Applicable {
    /// The part of a reduction that applies.
    fn limited(self, reduction: Reduction) -> Reduction {
        let Settings { light, filter, .. } = self.settings;
        Reduction {
            vertex_light: reduction.vertex_light
                && matches!(light, LightAt::Pixel | LightAt::Sample),
            nearest_texels: reduction.nearest_texels && self.textured && filter != Filter::Nearest,
            half_size: reduction.half_size,
        }
    }
}

/// Chooses the reduction from how long frames took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AdaptiveQuality {
    /// The time of the last whole frame at each reduction.
    whole: [Option<Duration>; Reduction::ALL.len()],
    /// The time of the last frame at full quality that was redrawn in part.
    part: Option<Duration>,
    last: Reduction,
}

impl AdaptiveQuality {
    /// Chooses the reduction of the next picture; `share` (0 to 1) is the part of it that has to be
    /// redrawn at full quality.
    pub(crate) fn choose(&self, moving: bool, share: f64, applicable: Applicable) -> Reduction {
        if !moving || self.expected(Reduction::NONE, share).is_none_or(|time| time <= BUDGET) {
            return Reduction::NONE;
        }
        let mut quickest = (Reduction::NONE, self.expected(Reduction::NONE, share));
        for reduction in &Reduction::ALL[1..] {
            let reduction = applicable.limited(*reduction);
            if reduction == Reduction::NONE {
                continue;
            }
            let time = self.expected(reduction, 1.0);
            if time.is_none_or(|time| time <= BUDGET) {
                return reduction;
            }
            if time < quickest.1 {
                quickest = (reduction, time);
            }
        }
        quickest.0
    }

    /// The expected time of a frame, if known.
    pub(crate) fn expected(&self, reduction: Reduction, share: f64) -> Option<Duration> {
        let whole = self.whole[place(reduction)];
        if reduction != Reduction::NONE || share >= 1.0 {
            return whole;
        }
        self.part.or(whole.map(|whole| whole.mul_f64(share)))
    }

    /// Records the time of a frame.
    pub(crate) fn record(&mut self, reduction: Reduction, share: f64, time: Duration) {
        let again = std::mem::replace(&mut self.last, reduction) == reduction;
        if reduction != Reduction::NONE {
            // The first frame at a reduction also allocates memory.
            if again {
                self.whole[place(reduction)] = Some(time);
            }
        } else if share < 1.0 {
            self.part = Some(time);
        } else {
            let before = self.whole[0].map_or(0.0, |before| before.as_secs_f64());
            let times = time.as_secs_f64() / before;
            if !(1.0 / ANOTHER_SCENE..=ANOTHER_SCENE).contains(&times) {
                self.whole = [None; Reduction::ALL.len()];
                self.part = None;
            }
            self.whole[0] = Some(time);
        }
    }

    /// Records that a frame at full quality was cancelled after this time: it takes longer.
    pub(crate) fn record_given_up(&mut self, share: f64, after: Duration) {
        let known = if share < 1.0 { &mut self.part } else { &mut self.whole[0] };
        *known = (*known).max(Some(after));
    }
}

/// The index of the times of a reduction; those that differ only in what does not apply share one.
fn place(reduction: Reduction) -> usize {
    Reduction::ALL.iter().position(|other| *other == reduction).unwrap_or(match reduction {
        Reduction { half_size: true, .. } => Reduction::ALL.len() - 1,
        _ => 2,
    })
}

/// A frame that is being drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    pub(crate) reduction: Reduction,
    /// Its expected time, if known.
    pub(crate) expected: Option<Duration>,
    /// Whether the frame before it was cancelled.
    pub(crate) second: bool,
}

impl Attempt {
    /// Whether it is cancelled for a newer frame after this time.
    pub(crate) fn gives_way(&self, elapsed: Duration) -> bool {
        let time = self.expected.map_or(elapsed, |expected| expected.max(elapsed));
        self.reduction == Reduction::NONE && !self.second && time > BUDGET
    }
}

/// What happened since the last frame.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Happening {
    /// The picture differs from the last one.
    pub(crate) changed: bool,
    /// A mouse button is held.
    pub(crate) held: bool,
    /// A picture is being drawn.
    pub(crate) drawing: bool,
}

/// Whether the picture is changing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    /// When it changed last, or was still being drawn, in seconds.
    changed: Option<f64>,
    held: bool,
    moving: bool,
}

impl Motion {
    /// Whether the picture is moving: it changes while a mouse button is held, or repeatedly
    /// without one, as with the wheel or a held key. It is still again when the button is released
    /// or soon after the last change, but not before the picture of that change is drawn.
    pub(crate) fn notice(&mut self, now: f64, happening: Happening) -> bool {
        let Happening { changed, held, drawing } = happening;
        let let_go = std::mem::replace(&mut self.held, held) && !held;
        let lately = self.changed.is_some_and(|then| now - then < STILL);
        let lately = (lately || (self.moving && drawing)) && !let_go;
        if changed || (self.moving && drawing) {
            self.changed = Some(now);
        }
        self.moving = if changed { held || lately } else { self.moving && lately };
        self.moving
    }

    /// The seconds until it is still unless it changes again; `None` if it is still.
    pub(crate) fn rest(&self, now: f64) -> Option<f64> {
        let changed = self.changed.filter(|_| self.moving)?;
        Some((changed + STILL - now).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Applicable {
        Applicable { settings: Settings::default(), textured: true }
    }

    fn ms(time: u64) -> Duration {
        Duration::from_millis(time)
    }

    /// Draws frames whose times are these until the choice stays, and says what that is.
    fn settled(
        quality: &mut AdaptiveQuality,
        applicable: Applicable,
        times: [u64; 5],
    ) -> Reduction {
        let mut last = Reduction::NONE;
        for _ in 0..20 {
            last = quality.choose(true, 1.0, applicable);
            quality.record(last, 1.0, ms(times[place(last)]));
        }
        last
    }

    #[test]
    fn the_most_accurate_picture_that_is_quick_enough_is_chosen_and_else_the_quickest() {
        let [_, vertex, nearest, half, least] = Reduction::ALL;
        for (times, chosen) in [
            ([20, 1, 1, 1, 1], Reduction::NONE),
            ([33, 1, 1, 1, 1], Reduction::NONE),
            ([60, 30, 20, 20, 10], vertex),
            ([60, 40, 20, 20, 10], nearest),
            ([60, 70, 70, 20, 10], half),
            ([200, 150, 100, 60, 30], least),
            ([900, 850, 800, 300, 250], least),
            ([900, 1200, 1200, 300, 350], half),
            ([100, 110, 110, 110, 110], Reduction::NONE),
        ] {
            let mut quality = AdaptiveQuality::default();
            assert_eq!(settled(&mut quality, all(), times), chosen, "{times:?}");
            assert_eq!(quality.choose(false, 1.0, all()), Reduction::NONE, "still: with all");
        }
    }

    #[test]
    fn nothing_is_given_up_that_the_picture_does_not_have() {
        let times = [500, 400, 300, 200, 100];
        let plain = Applicable { textured: false, ..all() };
        let reduction = settled(&mut AdaptiveQuality::default(), plain, times);
        assert_eq!(reduction.words(), "light per vertex, half size");
        let settings = Settings { light: LightAt::Face, ..all().settings };
        let flat = Applicable { settings, textured: false };
        assert_eq!(settled(&mut AdaptiveQuality::default(), flat, times).words(), "half size");
        let (applied, size) = Reduction::ALL[4].applied(settings, Size::new(801, 600));
        assert_eq!((applied.light, size), (LightAt::Face, Size::new(401, 300)));
    }

    #[test]
    fn where_only_a_part_is_drawn_again_its_own_time_counts() {
        let mut quality = AdaptiveQuality::default();
        quality.record(Reduction::NONE, 1.0, ms(100));
        assert_eq!(quality.choose(true, 0.2, all()), Reduction::NONE, "20 ms of 100");
        assert_ne!(quality.choose(true, 0.5, all()), Reduction::NONE, "50 ms of 100");
        quality.record(Reduction::NONE, 0.2, ms(60));
        assert_ne!(quality.choose(true, 0.2, all()), Reduction::NONE, "it was 60 ms");
        assert_ne!(quality.choose(true, 1.0, all()), Reduction::NONE);
    }

    #[test]
    fn what_another_scene_took_is_forgotten() {
        let mut quality = AdaptiveQuality::default();
        assert_eq!(settled(&mut quality, all(), [60, 70, 70, 20, 10]), Reduction::ALL[3]);
        quality.record(Reduction::NONE, 1.0, ms(70));
        assert_eq!(quality.choose(true, 1.0, all()), Reduction::ALL[3], "about the same");
        quality.record(Reduction::NONE, 1.0, ms(300));
        assert_eq!(quality.choose(true, 1.0, all()), Reduction::ALL[1], "tried again");
    }

    #[test]
    fn in_a_stream_of_changes_every_second_frame_is_finished() {
        let slow = Attempt { reduction: Reduction::NONE, expected: Some(ms(500)), second: false };
        assert!(slow.gives_way(ms(0)));
        assert!(!Attempt { second: true, ..slow }.gives_way(ms(10_000)));
        // What is soon there is waited for, and what is coarse is drawn for the stream's sake.
        let quick = Attempt { expected: Some(ms(20)), ..slow };
        assert!(!quick.gives_way(ms(30)) && quick.gives_way(ms(40)));
        assert!(!Attempt { reduction: Reduction::ALL[4], ..slow }.gives_way(ms(10_000)));
        let unknown = Attempt { expected: None, ..slow };
        assert!(!unknown.gives_way(ms(30)) && unknown.gives_way(ms(40)));
    }

    #[test]
    fn a_frame_that_was_given_up_is_known_to_be_slow() {
        let mut quality = AdaptiveQuality::default();
        quality.record(Reduction::NONE, 1.0, ms(5));
        quality.record_given_up(1.0, ms(40));
        assert_eq!(quality.choose(true, 1.0, all()), Reduction::ALL[1]);
        quality.record_given_up(1.0, ms(2));
        assert_eq!(quality.expected(Reduction::NONE, 1.0), Some(ms(40)));
    }

    const DRAG: Happening = Happening { changed: true, held: true, drawing: false };
    const HELD: Happening = Happening { changed: false, ..DRAG };
    const KEY: Happening = Happening { held: false, ..DRAG };
    const NONE: Happening = Happening { changed: false, held: false, drawing: false };

    #[test]
    fn a_drag_moves_until_it_rests_or_is_let_go() {
        let mut motion = Motion::default();
        assert!(!motion.notice(1.0, HELD), "pressed");
        assert!(motion.notice(1.1, DRAG));
        assert!(motion.notice(1.2, HELD));
        let rest = motion.rest(1.2).unwrap();
        assert!((rest - 0.05).abs() < 1e-9);
        assert!(!motion.notice(1.26, HELD), "held, and still");
        assert_eq!(motion.rest(1.26), None);
        assert!(motion.notice(5.0, DRAG), "dragged on");
        assert!(!motion.notice(5.01, KEY), "let go");
    }

    #[test]
    fn what_moves_is_not_still_before_its_picture_is_drawn() {
        let mut motion = Motion::default();
        let drawing = Happening { drawing: true, ..HELD };
        assert!(!motion.notice(0.5, drawing), "it does not begin to move by being drawn");
        assert!(motion.notice(1.0, DRAG));
        assert!(motion.notice(1.4, drawing));
        assert!(motion.notice(1.5, HELD), "drawn");
        assert!(!motion.notice(1.56, HELD));
        assert!(!motion.notice(1.57, drawing), "that is the picture with all");
    }

    #[test]
    fn one_key_is_no_motion_and_a_held_one_is() {
        let mut motion = Motion::default();
        assert!(!motion.notice(1.0, KEY));
        assert!(!motion.notice(1.01, NONE));
        assert!(!motion.notice(2.0, KEY), "another key, later");
        assert!(motion.notice(2.03, KEY), "it repeats");
        assert!(motion.notice(2.1, NONE));
        assert!(!motion.notice(2.2, NONE), "still");
    }

    #[test]
    fn a_click_that_changes_something_is_no_motion() {
        let mut motion = Motion::default();
        assert!(!motion.notice(1.0, HELD));
        assert!(!motion.notice(1.05, KEY));
        assert!(!motion.notice(1.06, NONE));
    }
}
