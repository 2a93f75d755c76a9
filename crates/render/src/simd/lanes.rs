//! Lanes: load numbers from rows in memory, some at a time, and store them.

use super::gather::SLOTS;
use super::real::Real;
use super::vec3::Vec3;

/// The number of positions that are lit together at most: those of some blocks of 8 x 8 pixels. It
/// is small enough for the L1 cache, and large enough that the calls of kernels cost little beside
/// their work. Rows of a power of two would begin at addresses that processors take for the same
/// when they compare a load with the stores before it: 3 to 5% of a picture of one triangle.
pub const BATCH: usize = 240;

/// Loads numbers from rows in memory, some at a time, and stores them.
///
/// Code that is generic over lanes is compiled for each: see [`Kernel`].
pub trait Lanes: Copy {
    /// The numbers in memory.
    type Number: Copy;
    /// The vector of [`Self::LANES`] numbers that equations compute with.
    type R: Real;
    /// A vector of [`Self::LANES`] slots.
    type Slots: Copy;
    /// How many numbers are loaded at a time.
    const LANES: usize;
    /// Loads numbers of a row from `at` on.
    fn load(self, row: &[Self::Number], at: usize) -> Self::R;
    /// Loads numbers of four interleaved rows from `at` on.
    fn load_four(self, rows: &[[Self::Number; 4]], at: usize) -> [Self::R; 4];
    /// Stores numbers in four interleaved rows from `at` on.
    fn store_four(self, values: [Self::R; 4], rows: &mut [[Self::Number; 4]], at: usize);
    /// Stores numbers in a row from `at` on.
    fn store(self, value: Self::R, row: &mut [Self::Number], at: usize);
    /// Loads integers of a row from `at` on.
    fn whole(self, row: &[i32], at: usize) -> Self::R;
    /// Stores colours in a row of pixels: red, green, blue and 255, as bytes in this order, each
    /// rounded like [`Number::byte`](super::Number::byte).
    fn store_pixels(self, color: Vec3<Self::R>, row: &mut [u32], at: usize);
    /// The same, each the integer part of 255 times the number plus a threshold from 0 to 1.
    fn store_pixels_by(self, color: Vec3<Self::R>, threshold: Self::R, row: &mut [u32], at: usize);
    /// Stores colours in three rows: red, green and blue as the bytes of [`Self::store_pixels_by`]
    /// before they are rounded down, in units of 2^-16.
    fn store_parts(
        self,
        color: Vec3<Self::R>,
        threshold: Self::R,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    );
    /// A constant.
    fn lift(self, constant: f64) -> Self::R;
    /// One number for all.
    fn set(self, number: Self::Number) -> Self::R;
    /// Loads slots for [`Self::pick`].
    fn slots(self, slots: &[i32], at: usize) -> Self::Slots;
    /// Gathers the numbers of a row at some slots, all below `PAGES` times sixteen.
    fn pick<const PAGES: usize>(self, row: &[Self::Number; SLOTS], slots: Self::Slots) -> Self::R;
    /// Whether any number is more than its counterpart.
    fn any_more(self, a: Self::R, b: Self::R) -> bool;
}

/// Work that is written once for every [`Lanes`] over the same numbers.
pub trait Kernel<T> {
    /// Does the work. Implementations are `#[inline(always)]`, so that they are compiled for the
    /// instruction set of the lanes.
    fn run<M: Lanes<Number = T>>(self, lanes: M);
}

/// The fixed-point units per step of a byte when colours are added up.
pub(crate) const PARTS: f64 = 65536.0;
