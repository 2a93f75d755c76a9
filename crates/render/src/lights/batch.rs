//! Batches of positions that light shaders read and write: an array for each quantity.

use glam::DMat3;

use crate::simd::{BATCH, Lanes, Number, Vec3};

/// Positions on surfaces with their normals and their light: an array for each quantity.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Batch<T> {
    /// The number of positions; entries beyond it are meaningless.
    pub(crate) len: usize,
    /// The positions, in view space.
    pub(crate) position: [[T; BATCH]; 3],
    /// The normals: of length 1, or zero at positions without a normal.
    pub(crate) normal: [[T; BATCH]; 3],
    /// The directions to the observer, of length 1: V.
    pub(crate) to_eye: [[T; BATCH]; 3],
    /// The factors of the highlight exponents from a map, if there is one.
    pub(crate) exponent: [T; BATCH],
    /// The light to be multiplied by the surface colour: ambient and diffuse.
    pub(crate) diffuse: [[T; BATCH]; 3],
    /// The light that keeps its colour: specular.
    pub(crate) specular: [[T; BATCH]; 3],
}

impl<T: Copy + Default> Default for Batch<T> {
    fn default() -> Self {
        let zero = [[T::default(); BATCH]; 3];
        Self {
            len: 0,
            position: zero,
            normal: zero,
            to_eye: zero,
            exponent: [T::default(); BATCH],
            diffuse: zero,
            specular: zero,
        }
    }
}

impl<T: Copy + Default> Batch<T> {
    /// Sets the light at all positions to 0.
    pub(crate) fn darken(&mut self) {
        // Kernels load whole vectors, so the last one is cleared beyond `len`, too.
        let end = self.len.next_multiple_of(16).min(BATCH);
        for row in self.diffuse.iter_mut().chain(&mut self.specular) {
            row[..end].fill(T::default());
        }
    }
}

impl<T: Number> Batch<T> {
    /// Stores samples, starting at `at`.
    #[inline(always)]
    pub(crate) fn put<M: Lanes<Number = T>>(&mut self, lanes: M, sample: Sample<M::R>, at: usize) {
        store(lanes, sample.position, &mut self.position, at);
        store(lanes, sample.normal, &mut self.normal, at);
        store(lanes, sample.to_eye, &mut self.to_eye, at);
    }
}

/// A position on a surface with its normal and its direction to the observer; or several, in lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<R> {
    /// See [`Batch::position`].
    pub(crate) position: Vec3<R>,
    /// See [`Batch::normal`].
    pub(crate) normal: Vec3<R>,
    /// See [`Batch::to_eye`].
    pub(crate) to_eye: Vec3<R>,
    /// See [`Batch::exponent`].
    pub(crate) exponent: R,
}

/// The light that a light shader reflects from a position to the observer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reflected<R> {
    /// See [`Batch::diffuse`].
    pub(crate) diffuse: Vec3<R>,
    /// See [`Batch::specular`]; `None` if it is zero.
    pub(crate) specular: Option<Vec3<R>>,
}

/// Repeats three numbers in all lanes.
#[inline(always)]
pub(crate) fn set<M: Lanes>(lanes: M, numbers: [M::Number; 3]) -> Vec3<M::R> {
    Vec3([lanes.set(numbers[0]), lanes.set(numbers[1]), lanes.set(numbers[2])])
}

/// Returns the columns of a matrix.
pub(crate) fn columns<T: Number>(m: DMat3) -> [[T; 3]; 3] {
    m.to_cols_array_2d().map(|column| column.map(T::from_f64))
}

/// Multiplies a vector by a matrix given by its columns.
#[inline(always)]
pub(crate) fn turned<M: Lanes>(
    lanes: M,
    [a, b, c]: [[M::Number; 3]; 3],
    Vec3([x, y, z]): Vec3<M::R>,
) -> Vec3<M::R> {
    set(lanes, a).times(x).plus(set(lanes, b).times(y)).plus(set(lanes, c).times(z))
}

/// Three rows of numbers.
pub(crate) type Rows<T> = [[T; BATCH]; 3];

/// Loads three numbers from three rows.
#[inline(always)]
pub(crate) fn load<M: Lanes>(lanes: M, [x, y, z]: &Rows<M::Number>, at: usize) -> Vec3<M::R> {
    Vec3([lanes.load(x, at), lanes.load(y, at), lanes.load(z, at)])
}

/// Stores three numbers in three rows.
#[inline(always)]
pub(crate) fn store<M: Lanes>(
    lanes: M,
    value: Vec3<M::R>,
    [x, y, z]: &mut Rows<M::Number>,
    at: usize,
) {
    lanes.store(value.0[0], x, at);
    lanes.store(value.0[1], y, at);
    lanes.store(value.0[2], z, at);
}
