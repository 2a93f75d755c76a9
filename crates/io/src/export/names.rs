//! Makes names of exported files unique and puts them on one line.
//!
//! OBJ readers merge materials and objects of the same name, and some glTF readers lose such nodes.
//! Duplicates are numbered as in Blender: `Paint`, `Paint.001`.

use std::collections::{HashMap, HashSet};

/// The names in use.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>,
    /// The last number of each repeated name, so a thousand equal names take one try each.
    numbers: HashMap<String, u32>,
}

impl Names {
    /// Takes `wanted`, with a number if the name is in use.
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

/// Makes a name fit into an OBJ or MTL statement. Readers take a `#` between blanks for a comment,
/// and a trailing `\` for a continuation; names from files contain neither.
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

/// Returns the prefix for names of files that OBJ or MTL statements refer to. A ` -` in such a name
/// would be read as an option.
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
