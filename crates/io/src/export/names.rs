//! Names in exported files: on one line, and each only once.
//!
//! Readers merge materials and objects of OBJ that have the same name, and some readers of glTF
//! lose nodes that do. Repeated names are numbered as Blender does: `Paint`, `Paint.001`.

use std::collections::{HashMap, HashSet};

/// The names given so far.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>,
    /// The last number of each repeated name, so that a thousand equal names take one try each.
    numbers: HashMap<String, u32>,
}

impl Names {
    /// `wanted`, with a number if it is taken.
    pub(super) fn take(&mut self, wanted: &str) -> String {
        if self.taken.insert(wanted.to_owned()) {
            return wanted.to_owned();
        }
        let last = self.numbers.entry(wanted.to_owned()).or_default();
        loop {
            *last += 1;
            let name = format!("{wanted}.{last:03}");
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

/// A name as a statement of OBJ or MTL can hold it. Readers take a `#` between blanks for a
/// comment, and a `\` at the end for a line that goes on; names from files have neither.
pub(super) fn on_one_line(name: &str) -> String {
    let name: Vec<char> = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let is_blank =
        |i: Option<usize>| i.and_then(|i| name.get(i)).is_none_or(char::is_ascii_whitespace);
    let plain = |(i, c): (usize, &char)| match c {
        '#' if is_blank(i.checked_sub(1)) && is_blank(Some(i + 1)) => '_',
        c => *c,
    };
    let plain: String = name.iter().enumerate().map(plain).collect();
    let plain = plain.trim_matches(|c: char| c.is_ascii_whitespace());
    match plain.strip_suffix('\\') {
        Some(before) => format!("{before}_"),
        None => plain.to_owned(),
    }
}

/// The beginning of the names of the files that a statement of OBJ or MTL names: a ` -` in them
/// would be an option.
pub(super) fn companion(stem: &str) -> String {
    let name = on_one_line(stem).replace(" -", " _");
    match name.strip_prefix('-') {
        Some(rest) => format!("_{rest}"),
        None => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_repeated_name_gets_a_number_that_no_other_has() {
        let mut names = Names::default();
        let taken = ["a", "a.001", "a", "", "a", ""].map(|name| names.take(name));
        assert_eq!(taken, ["a", "a.001", "a.002", "", "a.003", ".001"]);
    }

    #[test]
    fn a_name_stays_on_its_line_and_has_no_comment() {
        let rows = [
            ("Material #25", "Material #25"),
            ("#1  b", "#1  b"),
            ("a # b", "a _ b"),
            ("#", "_"),
            (" a\nb\t", "a b"),
            ("C:\\x\\", "C:\\x_"),
            ("\u{e9}\u{5c71}", "\u{e9}\u{5c71}"),
        ];
        for (name, expected) in rows {
            assert_eq!(on_one_line(name), expected, "{name:?}");
        }
        assert_eq!(companion("-s 1 -o"), "_s 1 _o");
    }
}
