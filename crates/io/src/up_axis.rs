//! Detects the up axis that a model's file states.
//!
//! OBJ has no statement for the up axis. Some exporters write it in a comment at the top, and some
//! programs always use Z up. The shape is not considered: lying, upright and hanging models look
//! alike, and the distance from the origin must not affect the picture.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::packed::{Unpacked, unpacked_name};
use super::read::utf_8;
use super::stl::is_stl;
use marraztu_core::scene::UpAxis;

/// The number of bytes that are searched.
const HEAD: u64 = 8192;

/// Comments of programs that always use Z up, in lower case.
const WRITE_Z_UP: [&str; 4] =
    ["openscad obj exporter", "tinkercad", "created by freecad", "freecad v"];

/// The most characters of a comment that are quoted.
const LONGEST: usize = 60;

/// A statement about the up axis in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatedUp {
    /// The axis.
    pub up: UpAxis,
    /// The comment that contains the statement.
    pub comment: String,
}

/// Finds the up axis in the comments at the top of a file; `None` if there is no statement or the
/// file cannot be read.
pub fn stated_up(path: &Path) -> Option<StatedUp> {
    // Reading from a pipe would consume bytes that the loader needs.
    if !std::fs::metadata(path).ok()?.is_file() {
        return None;
    }
    let file = File::open(path).ok()?;
    let is_packed = path.file_name()?.to_str().and_then(unpacked_name).is_some();
    let mut head = Vec::new();
    let read = match is_packed {
        true => Unpacked::new(file).take(HEAD).read_to_end(&mut head),
        false => file.take(HEAD).read_to_end(&mut head),
    };
    read.ok()?;
    stated_in(&head)
}

/// Returns the up axis to read a file with: the axis that it states, z for STL, or y.
pub fn usual_up(path: &Path) -> UpAxis {
    stated_or_usual(stated_up(path), || is_stl(path))
}

/// Returns the up axis for a file with this statement.
pub(super) fn stated_or_usual(stated: Option<StatedUp>, is_stl: impl FnOnce() -> bool) -> UpAxis {
    match stated {
        Some(stated) => stated.up,
        // STL files are for printers and machines, and the plane of the table is z = 0.
        None if is_stl() => UpAxis::Z,
        None => UpAxis::default(),
    }
}

/// Finds the up axis in the comments before the first statement.
pub(super) fn stated_in(bytes: &[u8]) -> Option<StatedUp> {
    let head = &bytes[..bytes.len().min(usize::try_from(HEAD).unwrap_or(usize::MAX))];
    let head = utf_8(head.to_vec());
    let text = String::from_utf8_lossy(&head);
    let text = text.strip_prefix('\u{FEFF}').unwrap_or(&text);
    let lines = text.split(['\n', '\r']);
    let comments = lines.map(str::trim).filter(|line| !line.is_empty());
    let comments = comments.map_while(|line| line.strip_prefix('#'));
    comments.into_iter().find_map(|comment| {
        let comment = comment.trim_start_matches('#').trim();
        let up = up_of(&comment.to_lowercase())?;
        let end = comment.char_indices().nth(LONGEST).map_or(comment.len(), |(at, _)| at);
        Some(StatedUp { up, comment: comment[..end].to_owned() })
    })
}

/// The words for the up axis in a comment.
const UP: [&str; 3] = ["up", "upaxis", "upvector"];

/// Words that may come between a direction and its axis.
const SMALL: [&str; 4] = ["axis", "is", "vector", "points"];

/// Parses a comment in lower case: "z-up", "up axis: -y", "axis_forward=-z, up=y".
fn up_of(comment: &str) -> Option<UpAxis> {
    if WRITE_Z_UP.iter().any(|program| comment.contains(program)) {
        return Some(UpAxis::Z);
    }
    comment.split([',', ';', '|']).find_map(|clause| {
        let words = words(clause);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let at = words.iter().position(|word| UP.contains(word) || *word == "zup")?;
        if words[at] == "zup" {
            return Some(UpAxis::Z);
        }
        let is_full = |word: &&&str| !SMALL.contains(*word);
        let before = words[..at].iter().rev().find(is_full).and_then(|word| axis(word));
        let mut after = words[at + 1..].iter().filter(is_full);
        let [next, second, third] = std::array::from_fn(|_| after.next().copied());
        // "set up y forward" states no axis, but "up z forward y" does.
        let is_other = second.is_some_and(is_forward) && !third.is_some_and(is_axis);
        let after = next.filter(|_| !is_other).and_then(axis);
        // The first word tells whether axes precede directions: "z up y forward", "up z forward y".
        let is_direction = |word: &str| is_forward(word) || UP.contains(&word);
        let first = words.iter().find(|word| is_axis(word) || is_direction(word));
        if first.is_some_and(|word| is_axis(word)) { before.or(after) } else { after.or(before) }
    })
}

fn is_forward(word: &str) -> bool {
    ["forward", "front", "back"].contains(&word)
}

/// Returns whether a word names an axis, including those that [`axis`] excludes.
fn is_axis(word: &str) -> bool {
    ["x", "y", "z"].contains(&word.trim_start_matches('-'))
}

/// Splits a clause into words. A minus sign belongs to a word if a separator precedes it.
fn words(clause: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    for letter in clause.chars() {
        let is_new = words.last().is_none_or(String::is_empty);
        match letter {
            '-' if is_new => words.push("-".to_owned()),
            'a'..='z' | '0'..='9' => {
                if let Some(word) = words.last_mut() {
                    word.push(letter);
                }
            }
            _ => words.push(String::new()),
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Parses the name of an axis. X is excluded: no program uses it, and "up x 2" is a factor.
fn axis(word: &str) -> Option<UpAxis> {
    let all = [UpAxis::Y, UpAxis::Z, UpAxis::MinusY, UpAxis::MinusZ];
    all.into_iter().find(|up| up.word() == word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_that_a_comment_states_is_found() {
        for (comment, up) in [
            ("Z-up", UpAxis::Z),
            ("z_up, units: mm", UpAxis::Z),
            ("ZUP", UpAxis::Z),
            ("up axis: Z", UpAxis::Z),
            ("Up = +Z", UpAxis::Z),
            ("up_axis=Y", UpAxis::Y),
            ("The Z axis is up", UpAxis::Z),
            ("Z up, Y forward", UpAxis::Z),
            ("Z up Y forward", UpAxis::Z),
            ("axis_forward='-Z', axis_up='Y'", UpAxis::Y),
            ("Up: Z  Forward: Y", UpAxis::Z),
            ("Forward: Y  Up: Z", UpAxis::Z),
            ("Right: X  Up: -Z  Forward: Y", UpAxis::MinusZ),
            ("Up axis = +Z (Forward +Y)", UpAxis::Z),
            ("Up axis: Y, forward axis: -Z", UpAxis::Y),
            ("Y axis up, Z axis front", UpAxis::Y),
            ("Z up Y axis forward X right", UpAxis::Z),
            ("-Z forward Y up X right", UpAxis::Y),
            ("y forward up z", UpAxis::Z),
            ("Back: -Y  Up: Z  Forward: Y", UpAxis::Z),
            ("right-handed Z up Y forward", UpAxis::Z),
            ("X = right  Z = up  Y = forward", UpAxis::Z),
            ("up: -Y", UpAxis::MinusY),
            ("OpenSCAD obj exporter", UpAxis::Z),
            ("Object Export From Tinkercad Server 2015", UpAxis::Z),
            ("Created by FreeCAD <https://www.freecad.org>", UpAxis::Z),
        ] {
            let text = format!("\n# first\n#  {comment}\nv 1 2 3\n");
            let stated = stated_in(text.as_bytes()).map(|stated| stated.up);
            assert_eq!(stated, Some(up), "{comment}");
            let wide: Vec<u8> =
                format!("\u{FEFF}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
            assert_eq!(stated_in(&wide).map(|stated| stated.up), Some(up), "UTF-16: {comment}");
        }
    }

    #[test]
    fn nothing_is_concluded_from_other_comments_and_statements() {
        for text in [
            "",
            "# Blender 4.0.2\n# www.blender.org\nv 0 0 1\n",
            "# cleaned up by hand\nv 0 0 1",
            "# set up a mesh\n# group z\nv 0 0 1",
            "# set up z forward\nv 0 0 1",
            "# looked up y front faces\nv 0 0 1",
            "# scaled up x 2\nv 0 0 1",
            "v 0 0 1\n# z-up\n",
            "# 8 vertices\no up_z\n",
            "# 8 vertices\ro up_z\r",
        ] {
            assert_eq!(stated_in(text.as_bytes()), None, "{text}");
        }
    }
}
