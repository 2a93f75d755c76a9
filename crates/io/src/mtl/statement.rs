//! Single statements of an MTL file, read by tobj.
//!
//! Each call passes one statement in a form that tobj parses correctly: a grey becomes three
//! numbers, comments are removed, and a statement borrows the keyword of another with the same
//! argument: tobj does not know all, and accepts only whole numbers for `illum`. Numbers stay in
//! f64, as in the file.

use std::panic::catch_unwind;

use crate::obj::lines::{number, words};

/// Parses the colour of `Ka`, `Kd`, `Ks` or `Ke`; a single number sets all three.
pub(super) fn color(rest: &[u8]) -> Option<[f64; 3]> {
    let numbers: Option<Vec<String>> = words(rest).take(3).map(plain).collect();
    let three = match &numbers?[..] {
        [r, g, b] => [r.as_str(), g, b].join(" "),
        [grey] => [grey.as_str(); 3].join(" "),
        _ => return None,
    };
    let color = material("Kd", &three)?.diffuse?;
    color.iter().all(|x| x.is_finite()).then_some(color)
}

/// Parses the number of `Ns`, `d`, `Tr` or `illum`.
pub(super) fn scalar(rest: &[u8]) -> Option<f64> {
    single(words(rest).next()?)
}

/// Parses a numeric argument of an option.
pub(super) fn single(word: &[u8]) -> Option<f64> {
    material("Ns", &plain(word)?)?.shininess.filter(|number| number.is_finite())
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

/// Formats a number for tobj. The shortest text of an f64 converts back to the same value.
fn plain(word: &[u8]) -> Option<String> {
    let value = number(word).ok()?.value;
    (!value.is_nan()).then(|| format!("{value:e}"))
}
