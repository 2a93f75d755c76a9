//! The number types of pictures, and lanes: several numbers at a time.

use fearless_simd::Level;

use super::gather::SLOTS;
use super::real::Real;
use super::vec3::Vec3;

/// The largest number of positions lit together: the pixels of several blocks of 8 x 8 pixels. It
/// is small enough for the L1 cache, and large enough that calling a kernel costs little compared
/// with its work. It is not a power of two: such rows would start at addresses that alias when
/// processors compare a load with earlier stores, which costs 3 to 5% of a picture of one triangle.
pub const BATCH: usize = 240;

/// A number type that pictures can be computed in.
pub trait Number:
    Real + Default + PartialEq + Into<f64> + Send + Sync + std::fmt::Debug + 'static
{
    /// Converts to the nearest number of this type.
    fn from_f64(number: f64) -> Self;
    /// Returns the byte nearest to 255 times the number, clamped and rounded. NaN gives 0.
    fn byte(self) -> u8;
    /// Runs a kernel with the lanes for such numbers and the instructions of this level.
    fn run(level: Level, kernel: impl Kernel<Self>);
}

/// Loads several numbers at a time from rows in memory, and stores them.
///
/// Generic code is compiled for each kind of lanes: see [`Kernel`].
pub trait Lanes: Copy {
    /// The number type in memory.
    type Number: Number;
    /// The vector of [`Self::LANES`] numbers that equations compute with.
    type R: Real;
    /// [`Self::LANES`] slots, and how many are in use.
    type Slots: Copy;
    /// The number of lanes.
    const LANES: usize;
    /// Loads numbers of a row, starting at `at`.
    fn load(self, row: &[Self::Number], at: usize) -> Self::R;
    /// Loads numbers of four interleaved rows, starting at `at`.
    fn load_four(self, rows: &[[Self::Number; 4]], at: usize) -> [Self::R; 4];
    /// Stores numbers in four interleaved rows, starting at `at`.
    fn store_four(self, values: [Self::R; 4], rows: &mut [[Self::Number; 4]], at: usize);
    /// Stores numbers in a row, starting at `at`.
    fn store(self, value: Self::R, row: &mut [Self::Number], at: usize);
    /// Loads integers of a row, starting at `at`.
    fn whole(self, row: &[i32], at: usize) -> Self::R;
    /// Stores colours in a row of pixels: red, green, blue and 255, as bytes in this order, each
    /// rounded like [`Number::byte`].
    #[inline(always)]
    fn store_pixels(self, color: Vec3<Self::R>, row: &mut [u32], at: usize) {
        self.store_pixels_by(color, self.lift(0.5), row, at);
    }
    /// Stores colours like [`Self::store_pixels`], but each byte is the integer part of 255 times
    /// the number plus a threshold from 0 to 1.
    fn store_pixels_by(self, color: Vec3<Self::R>, threshold: Self::R, row: &mut [u32], at: usize);
    /// Stores colours in three rows (red, green and blue) as the bytes of [`Self::store_pixels_by`]
    /// before rounding down, in units of 2^-16.
    fn store_parts(
        self,
        color: Vec3<Self::R>,
        threshold: Self::R,
        rows: &mut [[u32; BATCH]; 3],
        at: usize,
    );
    /// Repeats a constant in all lanes.
    #[inline(always)]
    fn lift(self, constant: f64) -> Self::R {
        self.set(Self::Number::from_f64(constant))
    }
    /// Repeats one number in all lanes.
    fn set(self, number: Self::Number) -> Self::R;
    /// Loads slots for [`Self::pick`], all below `count`.
    fn slots(self, slots: (&[i32], usize), at: usize) -> Self::Slots;
    /// Gathers the numbers of a row at some slots.
    fn pick(self, row: &[Self::Number; SLOTS], slots: Self::Slots) -> Self::R;
    /// Returns whether any number is more than its counterpart.
    fn any_more(self, a: Self::R, b: Self::R) -> bool;
}

/// Work that is written once for every [`Lanes`] over the same numbers.
pub trait Kernel<T> {
    /// Does the work. Implementations are `#[inline(always)]`, which compiles them for the
    /// instruction set of the lanes.
    fn run<M: Lanes<Number = T>>(self, lanes: M);
}

/// The fixed-point units per step of a byte, for sums of colours.
pub(crate) const PARTS: f64 = 65536.0;
