//! The bounding box of a set of points.

use glam::DVec3;

/// The extent of a set of points, in object space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The smallest coordinates.
    pub min: DVec3,
    /// The largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// Returns the extent of points; `None` if the list is empty.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points.into_iter().map(Self::at).reduce(|all, p| all.around(&p))
    }

    /// Returns the box of one point.
    pub const fn at(point: DVec3) -> Self {
        Self { min: point, max: point }
    }

    /// Returns the box around two boxes.
    #[must_use]
    pub fn around(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Returns the middle of the box.
    pub fn centre(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Returns length, height and width of the box.
    pub fn extent(&self) -> DVec3 {
        self.max - self.min
    }

    /// Returns the point of the box nearest to a point.
    pub fn nearest_to(&self, place: DVec3) -> DVec3 {
        place.max(self.min).min(self.max)
    }

    /// Returns the eight corners of the box.
    pub fn corners(&self) -> [DVec3; 8] {
        let pick = |i: usize, bit: usize, axis: usize| {
            if i & bit == 0 { self.min[axis] } else { self.max[axis] }
        };
        std::array::from_fn(|i| DVec3::new(pick(i, 1, 0), pick(i, 2, 1), pick(i, 4, 2)))
    }
}
