//! Detects whether the picture is changing. No code here reads a clock: times are passed in.

/// The seconds without a change, and without a picture in progress, after which a scene is still.
const STILL: f64 = 0.15;

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

/// Tracks whether the picture is changing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Motion {
    /// When the picture last changed or was still being drawn, in seconds.
    changed: Option<f64>,
    held: bool,
    moving: bool,
}

impl Motion {
    /// Returns whether the picture is moving.
    ///
    /// It moves if it changes while a mouse button is held, or repeatedly without a button, as with
    /// the wheel or a held key. It is still again when the button is released or soon after the
    /// last change, but not before the picture of that change is drawn.
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

    /// Returns the seconds until the picture is still unless it changes again; `None` if it is
    /// still.
    pub(crate) fn rest(&self, now: f64) -> Option<f64> {
        let changed = self.changed.filter(|_| self.moving)?;
        Some((changed + STILL - now).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn motion_ends_only_after_the_last_picture_is_drawn() {
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
    fn a_held_key_counts_as_motion_and_a_single_press_does_not() {
        let mut motion = Motion::default();
        assert!(!motion.notice(1.0, KEY));
        assert!(!motion.notice(1.01, NONE));
        assert!(!motion.notice(2.0, KEY), "another key, later");
        assert!(motion.notice(2.03, KEY), "it repeats");
        assert!(motion.notice(2.1, NONE));
        assert!(!motion.notice(2.2, NONE), "still");
    }

    #[test]
    fn a_click_that_changes_something_does_not_count_as_motion() {
        let mut motion = Motion::default();
        assert!(!motion.notice(1.0, HELD));
        assert!(!motion.notice(1.05, KEY));
        assert!(!motion.notice(1.06, NONE));
    }
}
