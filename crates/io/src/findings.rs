//! Findings: everything that was repaired, left out or odd in a loaded file.
//!
//! Findings of one kind are joined into one sentence with their count and first line. A report on a
//! million faults is then as short as one on two.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

pub use super::finding_kinds::FindingKind;
use marraztu_core::scene::{ClosedBodies, Mesh};

/// A repair, an omission or an oddity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The path of the file, or of the first one if several are affected.
    pub file: String,
    /// The first affected line of that file, counted from 1.
    pub line: Option<u32>,
    /// Its kind.
    pub kind: FindingKind,
    /// The number of cases.
    pub count: usize,
    /// The name in the first case.
    name: String,
    /// The number of files.
    files: usize,
    /// The finding as a sentence.
    pub text: String,
}

impl Finding {
    /// Adds the cases of the same kind in another file.
    fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.files += other.files;
        self.text = self.kind.text(self.count, &self.name, self.line, self.files);
    }
}

/// Joins findings of one kind from several files, at the position of the first.
pub fn joined(findings: Vec<Finding>) -> Vec<Finding> {
    let mut places = BTreeMap::new();
    let mut list: Vec<Finding> = Vec::new();
    for finding in findings {
        let name = if finding.kind.joins_names() { "" } else { &finding.name };
        match places.entry((finding.kind, name.to_owned())) {
            Entry::Occupied(place) => {
                let first: &mut Finding = &mut list[*place.get()];
                first.join(&finding);
            }
            Entry::Vacant(place) => {
                place.insert(list.len());
                list.push(finding);
            }
        }
    }
    list
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.file, self.text)
    }
}

/// Whole colours count from 0 to 255 if one exceeds this number. Other colours above 1 are too
/// bright, as from baked light.
pub(super) const BYTES_ABOVE: f64 = 16.0;

/// The number of names that are distinguished per kind.
const MOST_NAMES: usize = 100;

/// A string that sorts after every name.
const LAST: &str = "\u{10FFFF}";

/// The findings of one file, collected while it is read.
#[derive(Debug, Default)]
pub(super) struct Findings {
    file: String,
    /// Cases by kind and, if names are distinguished, by name.
    cases: BTreeMap<(FindingKind, String), Cases>,
    /// The number of distinguished names per kind.
    names: BTreeMap<FindingKind, usize>,
    /// Cases with names beyond [`MOST_NAMES`].
    others: BTreeMap<FindingKind, Cases>,
}

#[derive(Debug)]
struct Cases {
    count: usize,
    name: String,
    line: Option<u32>,
}

impl Findings {
    pub(super) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), ..Self::default() }
    }

    /// Notes one case at a line.
    pub(super) fn note(&mut self, kind: FindingKind, line: u32) {
        self.add(kind, "", Some(line));
    }

    /// Notes one case with a name, and its line if it has one.
    pub(super) fn add(&mut self, kind: FindingKind, name: &str, line: Option<u32>) {
        self.add_cases(kind, Cases { count: 1, name: name.to_owned(), line });
    }

    /// Notes `count` cases, the first of them at `line`. Zero cases add nothing.
    pub(super) fn note_all(&mut self, kind: FindingKind, count: usize, line: Option<u32>) {
        if count > 0 {
            self.add_cases(kind, Cases { count, name: String::new(), line });
        }
    }

    /// Returns the number of cases of a kind without names.
    pub(super) fn count(&self, kind: FindingKind) -> usize {
        self.cases.get(&(kind, String::new())).map_or(0, |cases| cases.count)
    }

    /// Notes the closed bodies of a mesh that are inside out.
    pub(super) fn note_inside_out(&mut self, mesh: &Mesh) {
        let ClosedBodies { all, inside_out } = mesh.closed_bodies();
        let is_all = inside_out == all;
        let kind = if is_all { FindingKind::InsideOut } else { FindingKind::InsideOutPartly };
        self.note_all(kind, inside_out, None);
    }

    /// Appends the findings of the text that follows the first `lines` lines.
    pub(super) fn append(&mut self, following: Self, lines: u32) {
        let placed = |cases: Cases| {
            let line = cases.line.map(|line| line.saturating_add(lines));
            Cases { line, ..cases }
        };
        for ((kind, _), cases) in following.cases {
            self.add_cases(kind, placed(cases));
        }
        for (kind, cases) in following.others {
            self.add_others(kind, &placed(cases));
        }
    }

    fn add_cases(&mut self, kind: FindingKind, cases: Cases) {
        let name = if kind.joins_names() { "" } else { &*cases.name };
        let key = (kind, name.to_owned());
        if let Some(first) = self.cases.get_mut(&key) {
            first.count += cases.count;
            return;
        }
        self.cases.insert(key, cases);
        let names = self.names.entry(kind).or_default();
        *names += 1;
        if *names <= MOST_NAMES {
            return;
        }
        *names -= 1;
        // The name that sorts last is dropped, so the result does not depend on the order of
        // insertion.
        let last = self.cases.range(..(kind, LAST.to_owned())).next_back();
        if let Some(cases) =
            last.map(|(key, _)| key.clone()).and_then(|key| self.cases.remove(&key))
        {
            self.add_others(kind, &cases);
        }
    }

    /// Adds cases without their names.
    fn add_others(&mut self, kind: FindingKind, cases: &Cases) {
        let Cases { count, line, .. } = *cases;
        let none = Cases { count: 0, name: "... and others".to_owned(), line };
        let others = self.others.entry(kind).or_insert(none);
        others.count += count;
        others.line = others.line.min(line);
    }

    pub(super) fn into_list(self) -> Vec<Finding> {
        let Self { file, mut cases, others, .. } = self;
        cases.extend(others.into_iter().map(|(kind, cases)| ((kind, LAST.to_owned()), cases)));
        let finding = |((kind, _), cases): ((FindingKind, String), Cases)| {
            let Cases { count, name, line } = cases;
            let text = kind.text(count, &name, line, 1);
            Finding { file: file.clone(), line, kind, count, name, files: 1, text }
        };
        cases.into_iter().map(finding).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_endless_names_a_hundred_are_told_apart_whatever_order_they_come_in() {
        let found = |names: &mut dyn Iterator<Item = u32>, share: usize| {
            let names: Vec<u32> = names.collect();
            let mut all = Findings::new("a.obj");
            for names in names.chunks(share) {
                let mut findings = Findings::default();
                for name in names {
                    findings.add(FindingKind::Unknown, &format!("{name:04}"), Some(name + 1));
                }
                all.append(findings, 0);
            }
            all.into_list()
        };
        let forth = found(&mut (0..1000), 1000);
        assert_eq!(forth.len(), 101);
        let text = "900 unknown statements \"... and others\" are ignored (first: line 101)";
        assert_eq!(forth[100].text, text);
        assert_eq!(forth, found(&mut (0..1000), 7));
        assert_eq!(forth, found(&mut (0..1000).rev(), 130));
        let long = FindingKind::TextureMissing.text(1, &"x".repeat(1 << 20), None, 1);
        assert!(long.len() < 300, "{} signs", long.len());
    }
}
