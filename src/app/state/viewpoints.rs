//! Earlier and later viewpoints to return to. They are separate from the history of the scene.

use marraztu_core::edit::{Gesture, Viewpoint};
use marraztu_core::scene::{Scene, View};

/// The number of viewpoints that are kept.
const MOST: usize = 200;

/// The viewpoints before and after the present one, and the viewpoint of the scene's file.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewpoints {
    earlier: Vec<Viewpoint>,
    later: Vec<Viewpoint>,
    /// The viewpoint with which the scene was opened or last saved.
    pub(crate) saved: Viewpoint,
    /// The gesture that left the last viewpoint.
    gesture: Gesture,
}

/// A viewpoint to go to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ViewStep {
    Earlier,
    Later,
    Saved,
}

impl Viewpoints {
    /// Begins at the viewpoint of a new scene.
    pub(crate) const fn new(saved: Viewpoint) -> Self {
        Self { earlier: Vec::new(), later: Vec::new(), saved, gesture: Gesture::Whole }
    }

    /// Notes that a gesture has moved the view. Its movements count as one.
    pub(crate) fn note(&mut self, before: Viewpoint, after: &Viewpoint, gesture: Gesture) {
        let goes_on = gesture != Gesture::Whole && gesture == self.gesture;
        if goes_on || before.is_like(after) || self.earlier.last() == Some(&before) {
            return;
        }
        self.gesture = gesture;
        if self.earlier.len() == MOST {
            self.earlier.remove(0);
        }
        self.earlier.push(before);
        self.later.clear();
    }

    /// Forgets a gesture that was cancelled.
    pub(crate) fn abandon(&mut self, gesture: Gesture) {
        if gesture != Gesture::Whole && gesture == self.gesture {
            self.earlier.pop();
            self.gesture = Gesture::Whole;
        }
    }

    /// Returns the viewpoint that a step leads to: the next one with a camera that still exists and
    /// another picture than now.
    pub(crate) fn at(&self, step: ViewStep, scene: &Scene, view: &View) -> Option<Viewpoint> {
        let now = Viewpoint::of(scene, view);
        let leads_on = |it: &&Viewpoint| !it.is_like(&now) && it.shown(scene, view).1.is_ok();
        match step {
            ViewStep::Earlier => self.earlier.iter().rev().find(leads_on).copied(),
            ViewStep::Later => self.later.iter().rev().find(leads_on).copied(),
            ViewStep::Saved => Some(self.saved).filter(|saved| leads_on(&saved)),
        }
    }

    /// Goes from the present viewpoint to the viewpoint of a step.
    pub(crate) fn walk(&mut self, now: Viewpoint, step: ViewStep, to: &Viewpoint) {
        self.gesture = Gesture::Whole;
        let (from, onto) = match step {
            ViewStep::Earlier => (&mut self.earlier, &mut self.later),
            ViewStep::Later => (&mut self.later, &mut self.earlier),
            ViewStep::Saved => return self.note(now, to, Gesture::Whole),
        };
        // Viewpoints that led nowhere are dropped.
        while from.pop().is_some_and(|left| left != *to) {}
        onto.push(now);
    }
}
