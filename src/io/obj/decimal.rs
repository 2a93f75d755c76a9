//! A number of 32 bits from its decimal digits, where that is quickly done and certainly right.
//!
//! Digits are gathered as a whole number m and a power of ten e; `m 10^e` in double precision is
//! wrong by at most two units of its last place, so rounding it once more gives the nearest `f32`
//! unless it lies that close to the middle between two of them. Whatever is longer, larger or that
//! close is left to the standard library, which is slower and always right.
//!
//! Clinger, "How to Read Floating Point Numbers Accurately", PLDI 1990, has the exact case; eight
//! digits at once are Lemire's, "Number Parsing at a Gigabyte per Second", Software: Practice and
//! Experience 2021.

/// The number that a text begins with, and what follows it; `None` says nothing about the text.
///
/// What is taken is `[+-]digits[.digits][e[+-]digits]`, with at least one digit before the `e`.
#[inline]
pub(super) fn decimal(text: &[u8]) -> Option<(f32, &[u8])> {
    let (negative, text) = sign(text);
    let (mantissa, rest) = digits(0, text);
    let mut many = text.len() - rest.len();
    let (mut mantissa, mut rest, mut exponent) = (mantissa, rest, 0);
    if let [b'.', fraction @ ..] = rest {
        (mantissa, rest) = digits(mantissa, fraction);
        exponent = fraction.len() - rest.len();
        many += exponent;
    }
    // Nineteen digits always fit into 64 bits.
    if many == 0 || many > 19 {
        return None;
    }
    let mut exponent = -i32::try_from(exponent).ok()?;
    if let [b'e' | b'E', power @ ..] = rest {
        let (back, power) = sign(power);
        let (value, after) = digits(0, power);
        if !(1..=4).contains(&(power.len() - after.len())) {
            return None;
        }
        let value = i32::try_from(value).ok()?;
        exponent += if back { -value } else { value };
        rest = after;
    }
    let magnitude = rounded(mantissa, exponent)?;
    Some((if negative { -magnitude } else { magnitude }, rest))
}

/// Whether a text begins with a minus, and what follows its sign.
#[inline]
fn sign(text: &[u8]) -> (bool, &[u8]) {
    match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    }
}

/// The digits that a text begins with, behind those of `before`, and what follows them. More than
/// nineteen in all give a number of no meaning.
#[inline]
fn digits(before: u64, mut text: &[u8]) -> (u64, &[u8]) {
    let mut number = before;
    while let Some((eight, rest)) = text.split_first_chunk() {
        let (value, count) = leading_digits(*eight);
        number = number.wrapping_mul(TENS[count]).wrapping_add(u64::from(value));
        if count < 8 {
            return (number, &text[count..]);
        }
        text = rest;
    }
    while let [digit @ b'0'..=b'9', rest @ ..] = text {
        number = number.wrapping_mul(10).wrapping_add(u64::from(digit - b'0'));
        text = rest;
    }
    (number, text)
}

/// The number that the digits are with which eight signs begin, and how many they are.
#[inline]
pub(super) fn leading_digits(text: [u8; 8]) -> (u32, usize) {
    // Digits become their values, all else more than 9.
    let values = u64::from_le_bytes(text) ^ 0x3030_3030_3030_3030;
    let beyond = values | values.wrapping_add(0x0606_0606_0606_0606);
    // A carry spoils only what follows the first sign that is no digit.
    let count = (beyond & 0xf0f0_f0f0_f0f0_f0f0).trailing_zeros() / 8;
    if count == 0 {
        return (0, 0);
    }
    // To the end, behind zeros; then neighbours are joined: to pairs, to fours, to eight.
    let values = values << (64 - 8 * count);
    let pairs = values.wrapping_mul(10).wrapping_add(values >> 8);
    let even = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(0x000f_4240_0000_0064);
    let odd = ((pairs >> 16) & 0x0000_00ff_0000_00ff).wrapping_mul(0x0000_2710_0000_0001);
    let value = (even.wrapping_add(odd) >> 32) as u32;
    (value, count as usize)
}

/// 10^0 to 10^8.
const TENS: [u64; 9] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// `mantissa 10^exponent` as the nearest number of 32 bits, where double precision decides it.
#[inline]
#[expect(clippy::cast_precision_loss, reason = "half a unit of the last place, counted below")]
#[expect(clippy::cast_possible_truncation, reason = "the rounding that is meant")]
fn rounded(mantissa: u64, exponent: i32) -> Option<f32> {
    let power = POWERS.get(exponent.unsigned_abs() as usize)?;
    let number = mantissa as f64;
    let value = if exponent < 0 { number / power } else { number * power };
    // The 29 bits that an f32 has not; their middle is where it is decided which one is nearest.
    let below = value.to_bits() & 0x1fff_ffff;
    let decided = below.abs_diff(0x1000_0000) > 4;
    // No number in question is so small that an f32 has fewer bits for it.
    (decided && value < 1e38).then_some(value as f32)
}

/// The powers of ten that double precision has exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// What the quick way makes of a whole text, held against the standard library.
    fn check(text: &str) -> Option<f32> {
        let (value, rest) = decimal(text.as_bytes())?;
        assert_eq!(rest, b"", "{text}");
        let right: f32 = text.parse().unwrap();
        assert_eq!(value.to_bits(), right.to_bits(), "{text} is {right:?}, not {value:?}");
        Some(value)
    }

    #[test]
    fn numbers_as_files_have_them_are_read_the_quick_way() {
        for text in [
            "0",
            "-0",
            "1.",
            ".5",
            "+12.25",
            "-0.0378297",
            "1.220000",
            "1e-3",
            "-4.5E+2",
            "0.12345678901234567",
            "123456789",
            "9999999999999999999",
            "0.00000000",
        ] {
            assert!(check(text).is_some(), "{text}");
        }
        assert!(check("-0").unwrap().is_sign_negative());
    }

    #[test]
    fn what_is_no_such_number_is_left_to_others() {
        for text in ["", "-", ".", "e5", "1e", "1e+", "nan", "inf", "--1", "1e99999"] {
            assert_eq!(decimal(text.as_bytes()), None, "{text}");
        }
        // Longer than can be gathered, larger than can be held, and halfway between two numbers.
        for text in ["12345678901234567890", "1e39", "1e-30", "16777217", "0.50000002980232238"] {
            assert_eq!(decimal(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn digits_end_before_any_other_sign() {
        for count in 0..=8 {
            for sign in 0..=u8::MAX {
                let mut text = *b"98765432";
                if count < 8 {
                    text[count] = sign;
                }
                let right = text.iter().take_while(|sign| sign.is_ascii_digit());
                let right =
                    right.fold((0, 0), |(n, i), sign| (n * 10 + u32::from(sign - b'0'), i + 1));
                assert_eq!(leading_digits(text), right, "{text:?}");
            }
        }
    }

    #[test]
    fn a_number_ends_where_it_ends() {
        assert_eq!(decimal(b"1.5 2"), Some((1.5, &b" 2"[..])));
        assert_eq!(decimal(b"1.5.2"), Some((1.5, &b".2"[..])));
        assert_eq!(decimal(b"123456781/2"), Some((123_456_781.0_f32, &b"/2"[..])));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn every_number_is_the_nearest_one(text in "[-+]?[0-9]{1,12}(\\.[0-9]{0,12})?(e[-+]?[0-9]{1,2})?") {
            check(&text);
        }

        /// Texts that lie as close to the middle between two numbers as their digits allow.
        #[test]
        fn middles_between_two_numbers_are_rounded_rightly(
            bits in 0x2000_0000..0x5f00_0000_u32,
            digits in 1..17_usize,
            nudge in -3..4_i64,
        ) {
            let [low, high] = [bits, bits + 1].map(|bits| f64::from(f32::from_bits(bits)));
            let middle = f64::from_bits((0.5 * (low + high)).to_bits().wrapping_add_signed(nudge));
            check(&format!("{middle:.digits$e}"));
            check(&format!("{middle:.digits$}"));
        }
    }
}
