//! Eight boxes side by side, for SIMD code that compares a ray with all of them.

/// A box: its smallest and its largest coordinates.
pub(crate) type Box3 = [[f32; 3]; 2];

/// A box without points.
pub(crate) const EMPTY: Box3 = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];

/// Eight boxes, coordinate by coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct EightBoxes {
    /// The smallest coordinates of each box, then the largest ones, along each axis.
    pub(crate) rows: [[[f32; Self::COUNT]; 3]; 2],
}

impl EightBoxes {
    /// The number of boxes.
    pub(crate) const COUNT: usize = 8;

    /// Sets one of the boxes.
    pub(crate) fn set(&mut self, i: usize, to: Box3) {
        for (rows, corner) in self.rows.iter_mut().zip(to) {
            rows.iter_mut().zip(corner).for_each(|(row, x)| row[i] = x);
        }
    }

    /// Returns one of the boxes.
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Box3 {
        self.rows.map(|rows| rows.map(|row| row[i]))
    }

    /// Returns the box around all of them.
    pub(crate) fn around(&self) -> Box3 {
        (0..Self::COUNT).map(|i| self.get(i)).fold(EMPTY, union)
    }
}

impl Default for EightBoxes {
    fn default() -> Self {
        Self { rows: EMPTY.map(|corner| corner.map(|x| [x; Self::COUNT])) }
    }
}

/// Returns the box around two boxes.
pub(crate) fn union([low, high]: Box3, [other_low, other_high]: Box3) -> Box3 {
    let least = |axis: usize| low[axis].min(other_low[axis]);
    let largest = |axis: usize| high[axis].max(other_high[axis]);
    [std::array::from_fn(least), std::array::from_fn(largest)]
}
