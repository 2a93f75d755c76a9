//! The border around the visible part of an item in a picture.

use serde::{Deserialize, Serialize};

use marraztu_core::base::image::Size;
use marraztu_core::scene::ItemId;

/// The border around the visible part of an item in a picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Border {
    pub(crate) item: ItemId,
    /// The pixels of the item along the border, in runs from left to right.
    pub(crate) inner: Vec<Run>,
    /// The neighbouring pixels of other items.
    pub(crate) outer: Vec<Run>,
    /// The size of the picture.
    pub(crate) size: Size,
}

/// Adjacent pixels in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Run {
    pub(crate) x: usize,
    pub(crate) y: usize,
    pub(crate) length: usize,
}

impl Border {
    /// Finds the border of the pixels marked in `own`, a mask stored row by row.
    pub(crate) fn of(item: ItemId, size: Size, own: &[bool]) -> Self {
        let is_own =
            |x: usize, y: usize| x < size.width && y < size.height && own[y * size.width + x];
        // At x = 0 and y = 0, x - 1 and y - 1 wrap to `usize::MAX`, which is outside of the picture
        // too.
        let beside = |x: usize, y: usize, own: bool| {
            is_own(x.wrapping_sub(1), y) == own
                || is_own(x + 1, y) == own
                || is_own(x, y.wrapping_sub(1)) == own
                || is_own(x, y + 1) == own
        };
        let inner = runs(size, |x, y| is_own(x, y) && beside(x, y, false));
        let outer = runs(size, |x, y| !is_own(x, y) && beside(x, y, true));
        Self { item, inner, outer, size }
    }
}

/// Collects the pixels that satisfy `chosen` into runs.
fn runs(size: Size, chosen: impl Fn(usize, usize) -> bool) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for y in 0..size.height {
        for x in (0..size.width).filter(|x| chosen(*x, y)) {
            match runs.last_mut() {
                Some(run) if run.y == y && run.x + run.length == x => run.length += 1,
                _ => runs.push(Run { x, y, length: 1 }),
            }
        }
    }
    runs
}
