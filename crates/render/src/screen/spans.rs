//! Interpolates with perspective at every sixteenth pixel only.
//!
//! A division per pixel was too slow for games of 1996. They divided each row of a triangle into
//! spans of sixteen pixels from its left end, the last one shorter, with perspective at the ends of
//! a span and linear interpolation between. Abrash, "Graphics Programming Black Book", 1997,
//! chapter 70.

use super::coverage::{Grid, Snapped, doubled_area};

/// The number of pixels in a span.
const PIECE: i64 = 16;

/// The weights of a triangle's second and third corner.
type Weights = [f64; 2];

/// A row of pixels in a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// The columns of the first and last pixel with a centre inside.
    first: i64,
    last: i64,
    /// The linear weights at column 0, and their steps to the right.
    at_start: Weights,
    step: Weights,
    by_w: [f64; 3],
}

impl Row {
    /// Sets up row `y` of a triangle with these corners and their 1/w.
    #[expect(clippy::cast_precision_loss, reason = "the nearest number is meant")]
    pub(crate) fn new(corners: [Snapped; 3], by_w: [f64; 3], y: i32, grid: Grid) -> Self {
        let parts = i64::from(grid.parts());
        let area = doubled_area(corners);
        let sign = area.signum();
        let middle = |i: i64| i * parts + parts / 2;
        let (mut first, mut last) = (i64::MIN, i64::MAX);
        let (mut at_start, mut step) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            // The edge opposite to the corner: sign e(column) >= 0 with e = a column + b.
            let [p, q] = [corners[(i + 1) % 3], corners[(i + 2) % 3]]
                .map(|at| [i64::from(at.x), i64::from(at.y)]);
            let a = sign * (p[1] - q[1]) * parts;
            let b = sign
                * ((q[0] - p[0]) * (middle(i64::from(y)) - p[1])
                    - (q[1] - p[1]) * (middle(0) - p[0]));
            // e >= 0 bounds the row from the left if e grows to the right, else from the right.
            // Both divisions round inwards.
            match a {
                0 => {}
                1.. => first = first.max(-(b.div_euclid(a))),
                _ => last = last.min(b.div_euclid(-a)),
            }
            // The signed edge value over the area is the barycentric coordinate.
            let area = (sign * area) as f64;
            (at_start[i], step[i]) = (b as f64 / area, a as f64 / area);
        }
        let (at_start, step) = ([at_start[1], at_start[2]], [step[1], step[2]]);
        Self { first, last, at_start, step, by_w }
    }

    /// Returns the span of a pixel. `None` if the row is a single pixel or the pixel is outside.
    #[expect(clippy::cast_precision_loss, reason = "columns are small numbers")]
    pub(crate) fn span(&self, x: i32) -> Option<Span> {
        let (Self { first, last, .. }, x) = (*self, i64::from(x));
        if !(first..=last).contains(&x) || first == last {
            return None;
        }
        let from = first + (x - first) / PIECE * PIECE;
        let to = (from + PIECE).min(last);
        // The last pixel of a row ends the span before it.
        let from = if from == to { from - PIECE.min(from - first) } else { from };
        let (start, end) = (self.weights(from as f64), self.weights(to as f64));
        let per_pixel = 1.0 / (to - from) as f64;
        let step = [0, 1].map(|i| (end[i] - start[i]) * per_pixel);
        Some(Span { from, to, start, step })
    }

    /// Returns the weights at a column, with or without a span.
    pub(crate) fn at(&self, x: i32) -> Weights {
        self.span(x).map_or_else(|| self.weights(f64::from(x)), |span| span.at(x))
    }

    /// Computes the perspective-correct weights at a column.
    fn weights(&self, x: f64) -> Weights {
        let [second, third] = [0, 1].map(|i| self.at_start[i] + x * self.step[i]);
        let [w0, w1, w2] = self.by_w;
        // 1 / w is linear on the screen.
        let w = 1.0 / (w0 + second * (w1 - w0) + third * (w2 - w0));
        [second * w1 * w, third * w2 * w]
    }
}

/// A span of a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    from: i64,
    to: i64,
    start: Weights,
    step: Weights,
}

impl Span {
    /// Returns whether a column belongs to the span.
    #[inline(always)]
    pub(crate) fn holds(&self, x: i32) -> bool {
        let x = i64::from(x);
        self.from <= x && x < self.to
    }

    /// Interpolates the weights at a column.
    #[inline(always)]
    #[expect(clippy::cast_precision_loss, reason = "columns are small numbers")]
    pub(crate) fn at(&self, x: i32) -> Weights {
        let way = (i64::from(x) - self.from) as f64;
        [self.start[0] + way * self.step[0], self.start[1] + way * self.step[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid::Usual;

    fn at(x: i32, y: i32) -> Snapped {
        Snapped { x: x * 256, y: y * 256 }
    }

    /// Returns the largest error of linear interpolation between two ends with distances in the
    /// ratio r, relative to the length between them: (sqrt r - 1) / (sqrt r + 1).
    fn most(ratio: f64) -> f64 {
        (ratio.sqrt() - 1.0) / (ratio.sqrt() + 1.0)
    }

    /// Along a wall from z 2.2 to 100, 800 pixels wide, with 1024 texels.
    #[test]
    fn a_wall_is_as_wrong_as_the_equation_of_perspective_says() {
        let corners = [at(0, 0), at(800, 0), at(0, 160_000)];
        let row = Row::new(corners, [1.0 / 2.2, 1.0 / 100.0, 1.0 / 2.2], 0, GRID);
        let apart = |x: i32| {
            let span = row.span(x).unwrap().at(x)[0];
            (span - row.weights(f64::from(x))[0]).abs() * 1024.0
        };
        let sixteen = (0..799).map(apart).fold(0.0, f64::max);
        // w and the texel at a column's centre, and the error of spans of sixteen.
        let w = |x: i32| {
            let t = (f64::from(x) + 0.5) / 800.0;
            1.0 / (1.0 / 2.2 + t * (1.0 / 100.0 - 1.0 / 2.2))
        };
        let texel = |x: i32| (f64::from(x) + 0.5) / 800.0 / 100.0 * w(x) * 1024.0;
        let piece = |i: i32| {
            let (from, to) = (16 * i, (16 * i + 16).min(799));
            (texel(to) - texel(from)) * most(w(to) / w(from))
        };
        let pieces = (0..50).map(piece).fold(0.0, f64::max);
        assert!((0.9..1.001).contains(&(sixteen / pieces)), "{sixteen} of {pieces}");
    }

    #[test]
    fn spans_of_a_row_begin_at_its_left_end_and_end_at_its_right() {
        // The centres of row 0 are inside from 10 to 53.
        let corners = [at(10, -10), at(10, 30), at(70, -10)];
        let row = Row::new(corners, [1.0, 0.5, 0.25], 0, GRID);
        let (first, last) = (10, 53);
        for x in first..=last {
            let span = row.span(x).unwrap();
            assert!(span.holds(x) || x == last, "{x}: {span:?}");
            assert!(span.to - span.from <= 16, "{x}: {span:?}");
            let starts = (span.from - i64::from(first)) % 16 == 0;
            assert!(starts || span.to == i64::from(last), "{x}: {span:?}");
        }
        assert!(row.span(first - 1).is_none() && row.span(last + 1).is_none());
    }

    #[test]
    fn a_corner_has_all_of_itself() {
        let corners = [[128, 128], [10_368, 128], [128, 5248]].map(|[x, y]| Snapped { x, y });
        for ([x, y], want) in [([0, 0], [0.0, 0.0]), ([40, 0], [1.0, 0.0]), ([0, 20], [0.0, 1.0])] {
            let row = Row::new(corners, [1.0, 0.5, 0.25], y, GRID);
            assert_eq!(row.weights(f64::from(x)), want);
        }
    }
}
