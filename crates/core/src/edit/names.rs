//! Unused names for new items in a list.

use std::collections::{HashMap, HashSet};

/// The names in use in a list, and the names given since.
#[derive(Debug, Default)]
pub(super) struct Names<'a> {
    taken: HashSet<&'a str>,
    given: HashSet<String>,
    /// The next number to try for each name without its number: all lower ones from 2 on are in
    /// use.
    next: HashMap<String, u64>,
}

impl<'a> FromIterator<&'a str> for Names<'a> {
    fn from_iter<I: IntoIterator<Item = &'a str>>(names: I) -> Self {
        Self { taken: names.into_iter().collect(), ..Self::default() }
    }
}

impl Names<'_> {
    /// Takes `wish` if it is free, otherwise with the lowest free number appended.
    ///
    /// Names are only added, so each number is tried once, regardless of the number of names.
    pub(super) fn take(&mut self, wish: &str) -> String {
        if self.is_free(wish) {
            self.given.insert(wish.to_owned());
            return wish.to_owned();
        }
        let stem = stem(wish);
        let mut number = self.next.get(stem).copied().unwrap_or(2);
        let mut name = format!("{stem} {number}");
        while !self.is_free(&name) {
            number += 1;
            name = format!("{stem} {number}");
        }
        self.next.insert(stem.to_owned(), number + 1);
        self.given.insert(name.clone());
        name
    }

    fn is_free(&self, name: &str) -> bool {
        !self.taken.contains(name) && !self.given.contains(name)
    }
}

/// Strips the number from a name: "sun 2" is followed by "sun 3", not by "sun 2 2".
fn stem(name: &str) -> &str {
    match name.rsplit_once(' ') {
        Some((stem, number)) if number.parse::<u32>().is_ok() => stem,
        _ => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_in_use_gets_the_lowest_number_that_is_free() {
        let mut names: Names<'_> = ["sun", "sun 2", "sun 4", "cube 7"].into_iter().collect();
        for (wish, name) in [
            ("moon", "moon"),
            ("sun", "sun 3"),
            ("sun", "sun 5"),
            ("sun 2", "sun 6"),
            ("cube 7", "cube 2"),
            ("moon", "moon 2"),
            ("moon 2", "moon 3"),
            ("sun 9", "sun 9"),
        ] {
            assert_eq!(names.take(wish), name, "for {wish}");
        }
    }

    #[test]
    fn each_number_of_a_name_is_tried_once() {
        let mut names: Names<'_> = ["cube"].into_iter().collect();
        for number in 2..2_000_u64 {
            assert_eq!(names.take("cube"), format!("cube {number}"));
            assert_eq!(names.next.get("cube"), Some(&(number + 1)));
        }
    }
}
