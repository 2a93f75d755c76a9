//! Numbers that look random and are the same on every machine.
//!
//! SplitMix64 (Steele, Lea and Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA
//! 2014): every seed is as good as any other, so the number of a lot can be one.

use glam::DVec3;

/// Thrown again and again.
#[derive(Clone, Debug)]
pub struct Dice(u64);

impl Dice {
    /// Dice for the lot of this number.
    #[must_use]
    pub const fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 bits.
    pub const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from 0 to `n` - 1.
    pub fn below(&mut self, n: u64) -> u64 {
        (self.bits() >> 11) % n
    }

    /// A place in a list of `n`.
    pub fn index(&mut self, n: usize) -> usize {
        usize::try_from(self.below(n as u64)).expect("below a usize")
    }

    /// A whole number from `low` to `high`, both among them.
    pub fn between(&mut self, low: i32, high: i32) -> i32 {
        let span = i64::from(high) - i64::from(low) + 1;
        let up = self.below(span.unsigned_abs());
        i32::try_from(i64::from(low) + i64::try_from(up).expect("below 2^32")).expect("between")
    }

    /// One of some.
    pub fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.index(all.len())]
    }

    /// One of some that are not copied by themselves.
    pub fn pick<T: Clone>(&mut self, all: &[T]) -> T {
        all[self.index(all.len())].clone()
    }

    /// Whether this is so in so many of a hundred cases.
    pub fn percent(&mut self, percent: u64) -> bool {
        self.below(100) < percent
    }

    /// Whether this is one of `in_how_many` cases.
    pub fn chance(&mut self, in_how_many: u64) -> bool {
        self.below(in_how_many) == 0
    }

    /// A number from 0 to 1, 1 not among them.
    #[expect(clippy::cast_precision_loss, reason = "53 bits")]
    pub fn part(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A number from `low` to `high`.
    pub fn real(&mut self, low: f64, high: f64) -> f64 {
        low + self.part() * (high - low)
    }

    /// A place in the cube from -`size` to `size`.
    pub fn vector(&mut self, size: f64) -> DVec3 {
        DVec3::new(self.real(-size, size), self.real(-size, size), self.real(-size, size))
    }
}
