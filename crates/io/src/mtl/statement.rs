//! Single statements of an MTL file, read by tobj.
//!
//! Each call passes one statement in a form that tobj parses correctly: a grey becomes three
//! numbers, comments are removed, keywords get their usual case. A statement that tobj does not
//! know borrows the keyword of another with the same argument. Numbers stay in f64, as in the file.

use std::panic::catch_unwind;

use crate::obj::lines::{number, words};

/// Parses `Ka r g b`; a single number sets all three.
pub(super) fn ambient(rest: &[u8]) -> Option<[f64; 3]> {
    finite(material("Ka", &color(rest)?)?.ambient?)
}

/// Parses `Kd r g b`; a single number sets all three.
pub(super) fn diffuse(rest: &[u8]) -> Option<[f64; 3]> {
    finite(material("Kd", &color(rest)?)?.diffuse?)
}

/// Parses `Ks r g b`; a single number sets all three.
pub(super) fn specular(rest: &[u8]) -> Option<[f64; 3]> {
    finite(material("Ks", &color(rest)?)?.specular?)
}

/// Parses `Ke r g b`, which tobj does not know; a single number sets all three.
pub(super) fn emission(rest: &[u8]) -> Option<[f64; 3]> {
    specular(rest)
}

/// Parses `Ns x`. Also used for `illum x`, where tobj accepts only whole numbers.
pub(super) fn exponent(rest: &[u8]) -> Option<f64> {
    single(words(rest).next()?)
}

/// Parses `d x`. Also used for `Tr x`, which tobj does not know.
pub(super) fn opacity(rest: &[u8]) -> Option<f64> {
    let [opacity] = finite([material("d", &plain(words(rest).next()?)?)?.dissolve?])?;
    Some(opacity)
}

/// Parses a numeric argument of an option.
pub(super) fn single(word: &[u8]) -> Option<f64> {
    let [number] = finite([material("Ns", &plain(word)?)?.shininess?])?;
    Some(number)
}

/// Parses up to three numbers; `None` if the first word is not a number.
pub(super) fn numbers(rest: &[u8]) -> Option<Vec<f64>> {
    let numbers: Vec<f64> = words(rest).take(3).map_while(single).collect();
    (!numbers.is_empty()).then_some(numbers)
}

/// Parses the name of `map_Kd name`.
pub(super) fn texture(name: &str) -> Option<String> {
    material("map_Kd", name)?.diffuse_texture
}

/// Parses one statement with tobj; `None` if it is rejected.
fn material(keyword: &str, arguments: &str) -> Option<tobj::Material> {
    let text = format!("newmtl m\n{keyword} {arguments}\n");
    let read = || tobj::load_mtl_buf(&mut text.as_bytes());
    catch_unwind(read).ok()?.ok()?.0.pop()
}

/// Formats a colour as three numbers.
fn color(rest: &[u8]) -> Option<String> {
    let numbers: Option<Vec<String>> = words(rest).take(3).map(plain).collect();
    match &numbers?[..] {
        [r, g, b] => Some([r.as_str(), g, b].join(" ")),
        [grey] => Some([grey.as_str(); 3].join(" ")),
        _ => None,
    }
}

/// Formats a number for tobj. The shortest text of an f64 converts back to the same value.
fn plain(word: &[u8]) -> Option<String> {
    let value = number(word).ok()?.value;
    (!value.is_nan()).then(|| format!("{value:e}"))
}

fn finite<const N: usize>(numbers: [f64; N]) -> Option<[f64; N]> {
    numbers.iter().all(|x| x.is_finite()).then_some(numbers)
}
