//! Three numbers: directions, positions and colours.

use super::real::Real;

/// Three numbers: a direction, a position, or light in red, green and blue.
#[derive(Clone, Copy, Debug)]
pub struct Vec3<R>(pub [R; 3]);

impl<R: Real> Vec3<R> {
    /// Repeats three constants in as many lanes as `like` has.
    #[inline(always)]
    pub fn lift(like: R, [x, y, z]: [f64; 3]) -> Self {
        Self([like.lift(x), like.lift(y), like.lift(z)])
    }

    /// Computes the dot product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    /// Computes the cross product.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    /// Multiplies each number by `factor`.
    #[inline(always)]
    #[must_use]
    pub fn times(self, factor: R) -> Self {
        let [x, y, z] = self.0;
        Self([x * factor, y * factor, z * factor])
    }

    /// Adds number by number.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a + x, b + y, c + z])
    }

    /// Subtracts number by number.
    #[inline(always)]
    #[must_use]
    pub fn minus(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a - x, b - y, c - z])
    }

    /// Multiplies number by number.
    #[inline(always)]
    #[must_use]
    pub fn product(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([a * x, b * y, c * z])
    }

    /// Normalises to length 1. A vector without length stays 0.
    #[inline(always)]
    #[must_use]
    pub fn unit(self) -> Self {
        self.times(self.dot(self).reciprocal_root())
    }
}
