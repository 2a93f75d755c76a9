//! The border around the visible part of an item in a picture.

use std::ops::Range;

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
        let mut border = Self { item, inner: Vec::new(), outer: Vec::new(), size };
        let none = vec![false; size.width];
        let row = |y: usize| own.chunks_exact(size.width.max(1)).nth(y).unwrap_or(&none);
        let columns: Vec<_> = (0..size.height).map(|y| marked(row(y))).collect();
        for y in 0..size.height {
            // Only neighbours of marked pixels are looked at. Above the first row, y - 1 wraps to a
            // row that does not exist.
            let near = [y.wrapping_sub(1), y, y + 1];
            let near_columns = near.iter().filter_map(|y| columns.get(*y)?.clone());
            let joined = near_columns.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
            let Some(joined) = joined else { continue };
            let [above, middle, below] = near.map(row);
            let is_own = |x: usize| middle.get(x).copied().unwrap_or(false);
            for x in joined.start.saturating_sub(1)..(joined.end + 1).min(size.width) {
                let beside = [is_own(x.wrapping_sub(1)), is_own(x + 1), above[x], below[x]];
                if is_own(x) && beside.contains(&false) {
                    put(&mut border.inner, x, y);
                } else if !is_own(x) && beside.contains(&true) {
                    put(&mut border.outer, x, y);
                }
            }
        }
        border
    }
}

/// Returns whether these pixels fill most of a picture: more than half of it, or from side to side
/// and to a third side.
pub(crate) fn fills_most(size: Size, own: &[bool]) -> bool {
    let rows = || own.chunks_exact(size.width.max(1));
    let is_in = |row: Option<&[bool]>| row.is_some_and(|row| row.contains(&true));
    let sides = [
        is_in(rows().next()),
        is_in(rows().next_back()),
        rows().any(|row| row.first() == Some(&true)),
        rows().any(|row| row.last() == Some(&true)),
    ];
    let count = own.iter().filter(|own| **own).count();
    2 * count > own.len() || sides.iter().filter(|side| **side).count() >= 3
}

/// Returns the columns from the first to the last marked pixel of a row.
fn marked(row: &[bool]) -> Option<Range<usize>> {
    let first = row.iter().position(|own| *own)?;
    let last = row.iter().rposition(|own| *own)?;
    Some(first..last + 1)
}

/// Adds a pixel to the last run, or as a run of its own.
fn put(runs: &mut Vec<Run>, x: usize, y: usize) {
    match runs.last_mut() {
        Some(run) if run.y == y && run.x + run.length == x => run.length += 1,
        _ => runs.push(Run { x, y, length: 1 }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Marks the pixels of a part of a picture of 10 x 8.
    fn part(columns: Range<usize>, rows: Range<usize>) -> Vec<bool> {
        let pixel = |i: usize| columns.contains(&(i % 10)) && rows.contains(&(i / 10));
        (0..80).map(pixel).collect()
    }

    #[test]
    fn walls_and_floors_fill_most_of_a_picture_and_objects_in_it_do_not() {
        let size = Size::new(10, 8);
        let cases = [
            ("a wall", part(0..10, 0..8), true),
            ("a floor", part(0..10, 6..8), true),
            ("a near object", part(1..9, 1..8), true),
            ("an object", part(2..6, 1..7), false),
            ("an object at a side", part(0..4, 2..8), false),
            ("a pole", part(4..5, 0..8), false),
            ("nothing", part(0..0, 0..0), false),
        ];
        for (what, own, expected) in cases {
            assert_eq!(fills_most(size, &own), expected, "{what}");
        }
    }
}
