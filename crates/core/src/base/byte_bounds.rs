//! Bounds of a byte over rectangles of a grid: the smallest and the largest value.
//!
//! Bounds are stored for cells of 4 x 4 bytes and, like the levels of a mipmap, for cells of twice
//! that side, up to one cell for the whole grid. This takes 17% of the memory of the bytes. A
//! rectangle gets the joined bounds of the few cells that it overlaps, so its bounds may be too
//! wide, but never too narrow.

use std::ops::RangeInclusive;

/// The side of the finest cells, as a power of two.
const FINEST: u32 = 2;
/// The largest number of cells that a rectangle overlaps along one side.
const MOST: usize = 4;

/// The smallest and the largest byte in rectangles of a grid. The bounds may be too wide, but never
/// too narrow.
#[derive(Clone, Debug)]
pub struct ByteBounds {
    /// The levels, from the finest cells to a single cell.
    levels: Vec<Cells>,
}

/// Cells of one size, row by row: the smallest and the largest byte in each.
#[derive(Clone, Debug)]
struct Cells {
    columns: usize,
    bounds: Vec<[u8; 2]>,
}

/// Joins the bounds of two parts.
fn joined([low, high]: [u8; 2], [other_low, other_high]: [u8; 2]) -> [u8; 2] {
    [low.min(other_low), high.max(other_high)]
}

/// The bounds of an empty set.
const NOTHING: [u8; 2] = [u8::MAX, 0];

impl Cells {
    /// Joins bounds, given row by row, into cells of `side` x `side`.
    fn new(width: usize, side: usize, bounds: impl Iterator<Item = [u8; 2]>) -> Self {
        let columns = width.div_ceil(side);
        let mut cells = Vec::new();
        for (i, own) in bounds.enumerate() {
            let (x, y) = (i % width, i / width);
            let at = y / side * columns + x / side;
            if at >= cells.len() {
                cells.resize(at + 1, NOTHING);
            }
            cells[at] = joined(cells[at], own);
        }
        Self { columns, bounds: cells }
    }
}

impl ByteBounds {
    /// Builds the levels for a grid with rows of `width`. Each element is a pair of bounds, so a
    /// plain byte is given twice.
    pub fn new(width: usize, bytes: impl Iterator<Item = [u8; 2]>) -> Self {
        let mut levels = vec![Cells::new(width, 1 << FINEST, bytes)];
        while let Some(last) = levels.last()
            && last.bounds.len() > 1
        {
            levels.push(Cells::new(last.columns, 2, last.bounds.iter().copied()));
        }
        Self { levels }
    }

    /// Returns bounds of the bytes in some columns and rows, which must be within the grid. In an
    /// empty grid, the smallest is above the largest.
    #[inline]
    pub fn over(&self, columns: &RangeInclusive<usize>, rows: &RangeInclusive<usize>) -> [u8; 2] {
        // The finest level with few enough cells gives the tightest bounds at a constant cost.
        let few = |range: &RangeInclusive<usize>, shift: u32| {
            (range.end() >> shift) - (range.start() >> shift) < MOST
        };
        let shifts = FINEST..;
        let found = self
            .levels
            .iter()
            .zip(shifts)
            .find(|(_, shift)| few(columns, *shift) && few(rows, *shift));
        let Some((cells, shift)) = found else { return NOTHING };
        let mut bounds = NOTHING;
        for row in rows.start() >> shift..=rows.end() >> shift {
            let first = row * cells.columns;
            let own = first + (columns.start() >> shift)..=first + (columns.end() >> shift);
            bounds = cells.bounds.get(own).unwrap_or_default().iter().copied().fold(bounds, joined);
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::image::Size;
    use crate::base::rng::Rng;

    const SIZES: [Size; 5] = [
        Size::new(1, 1),
        Size::new(1, 300),
        Size::new(3, 70),
        Size::new(64, 64),
        Size::new(101, 37),
    ];

    /// Ranges within `0..count`.
    fn range(rng: &mut Rng, count: usize) -> RangeInclusive<usize> {
        let (a, b) = (rng.index(count), rng.index(count));
        a.min(b)..=a.max(b)
    }

    /// Returns the exact bounds, by visiting each byte.
    fn exact(
        bytes: &[u8],
        width: usize,
        columns: &RangeInclusive<usize>,
        rows: &RangeInclusive<usize>,
    ) -> [u8; 2] {
        let own = rows.clone().flat_map(|y| &bytes[y * width..][columns.clone()]);
        own.fold(NOTHING, |bounds, byte| joined(bounds, [*byte; 2]))
    }

    #[test]
    fn bounds_hold_every_byte_and_are_exact_for_whole_cells() {
        let mut rng = Rng::new(5);
        for size in SIZES {
            let bytes: Vec<u8> = (0..size.area()).map(|_| rng.bits().to_le_bytes()[0]).collect();
            let bounds = ByteBounds::new(size.width, bytes.iter().map(|byte| [*byte; 2]));
            for _ in 0..300 {
                let (columns, rows) = (range(&mut rng, size.width), range(&mut rng, size.height));
                let [low, high] = bounds.over(&columns, &rows);
                let [least, largest] = exact(&bytes, size.width, &columns, &rows);
                assert!(low <= least && largest <= high, "{size:?} {columns:?} {rows:?}");
                // A rectangle of whole cells, at most four along a side.
                let whole = |range: &RangeInclusive<usize>, count: usize| {
                    let first = range.start() / 4 * 4;
                    first..=(first + 15).min(count - 1)
                };
                let cells = (whole(&columns, size.width), whole(&rows, size.height));
                let own = exact(&bytes, size.width, &cells.0, &cells.1);
                assert_eq!(bounds.over(&cells.0, &cells.1), own, "{size:?} {cells:?}");
            }
        }
    }

    #[test]
    fn of_nothing_the_least_is_above_the_largest() {
        let bounds = ByteBounds::new(0, std::iter::empty());
        assert_eq!(bounds.over(&(0..=0), &(0..=0)), NOTHING);
    }
}
