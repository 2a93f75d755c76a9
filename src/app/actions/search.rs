//! Finds actions, items and settings by typed words.
//!
//! Every word of a query has to match one of the texts of an entry. Matches rank in this order: a
//! label that begins with the word, a synonym, a label that contains the letters of the word in
//! order (`nucleo-matcher`, as in the picker of the Helix editor), and a hint that contains the
//! word.

use nucleo_matcher::pattern::{Atom, AtomKind, CaseMatching, Normalization};
use nucleo_matcher::{Config, Matcher, Utf32Str};

use super::table::Action;
use crate::app::chord::Chord;

/// The texts of an entry that can be found.
#[derive(Clone, Copy, Debug)]
pub struct Texts<'a> {
    /// The label.
    pub label: &'a str,
    /// Synonyms, separated by spaces.
    pub words: &'a str,
    /// The description, one sentence.
    pub hint: &'a str,
}

/// A query, and buffers for matching.
pub struct Search {
    words: Vec<(String, Atom)>,
    matcher: Matcher,
    letters: Vec<char>,
}

impl std::fmt::Debug for Search {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Search").field("words", &self.words).finish_non_exhaustive()
    }
}

/// An exact match scores higher than any fuzzy match.
const LABEL: u32 = 3000;
const WORD: u32 = 2500;
const BEGINS_WORD: u32 = 2000;
const FUZZY: u32 = 1000;
const HINT: u32 = 500;

/// The minimum score per letter of a match by scattered letters.
const CLOSE: u32 = 18;

impl Search {
    /// Creates a search for `query`.
    pub fn new(query: &str) -> Self {
        let atom = |word: &str| {
            let (case, normalize) = (CaseMatching::Ignore, Normalization::Smart);
            Atom::new(word, case, normalize, AtomKind::Fuzzy, false)
        };
        let words = query.split_whitespace().map(|word| (word.to_lowercase(), atom(word)));
        let words = words.collect();
        Self { words, matcher: Matcher::new(Config::DEFAULT), letters: Vec::new() }
    }

    /// Returns whether the query is empty. An empty query matches everything.
    pub const fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Returns the score of an entry; `None` if it does not match.
    pub fn score(&mut self, texts: Texts<'_>) -> Option<u32> {
        let label = texts.label.to_lowercase();
        let hint = texts.hint.to_lowercase();
        let mut sum = 0;
        for (word, atom) in &self.words {
            // Scattered letters match almost anything, so a fuzzy match needs a minimum score per
            // letter.
            let haystack = Utf32Str::new(texts.label, &mut self.letters);
            let fuzzy = atom.score(haystack, &mut self.matcher).map(u32::from);
            let letters = u32::try_from(word.chars().count()).unwrap_or(u32::MAX);
            let fuzzy = fuzzy.filter(|score| *score >= CLOSE.saturating_mul(letters));
            let mut others = texts.words.split_whitespace();
            let best = if label.starts_with(word.as_str()) {
                // Of two labels, the shorter one is closer to the typed word.
                LABEL + 200_u32.saturating_sub(u32::try_from(label.len()).unwrap_or(200))
            } else if others.clone().any(|other| other == word) {
                WORD
            } else if label.split([' ', '(', ':']).any(|part| part.starts_with(word.as_str())) {
                BEGINS_WORD + 300
            } else if others.any(|other| letters > 1 && other.starts_with(word.as_str())) {
                BEGINS_WORD
            } else if let Some(score) = fuzzy {
                FUZZY + score.min(900)
            } else if letters > 2 && hint.contains(word.as_str()) {
                HINT
            } else {
                return None;
            };
            sum += best;
        }
        Some(sum)
    }
}

impl Action {
    /// Returns the score of the action: by one of its keys, spelled exactly, by its label, or by
    /// synonyms.
    pub(crate) fn score(self, keys: &[Chord], search: &mut Search, query: &str) -> Option<u32> {
        let info = self.info();
        let query = query.trim();
        let mut keys = keys.iter().flat_map(|key| key.names());
        let is_key = |key: String| match query.chars().count() {
            0 => false,
            1 => key == query,
            _ => key.eq_ignore_ascii_case(query),
        };
        if keys.any(is_key) {
            return Some(10 * LABEL);
        }
        let hint = &format!("{} {}", info.hint, info.group.label());
        search.score(Texts { label: info.label, words: info.words, hint })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::panels::Panel;

    /// Lists the actions that match, best first; in the order of the table for an empty query.
    fn actions_for(query: &str) -> Vec<Action> {
        let mut search = Search::new(query);
        let mut found: Vec<(u32, Action)> = Action::ALL
            .iter()
            .filter_map(|action| {
                Some((action.score(action.info().keys, &mut search, query)?, *action))
            })
            .collect();
        found.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
        found.into_iter().map(|(_, action)| action).collect()
    }

    /// Words that users type, separated by commas, with the actions that they mean.
    const WORDS: [(&str, Action); 41] = [
        ("flat, smooth, faceted", Action::ToggleLightNormals),
        ("wireframe, wire, wirefrm", Action::ToggleEdges),
        ("screenshot, render, png, export image", Action::SavePicture),
        ("zoom, focus", Action::FrameSelection),
        ("fit, home", Action::FrameAll),
        ("orbit, fly, local", Action::ToggleFrame),
        ("theme, dark mode, night", Action::ThemeDark),
        ("white", Action::ThemeLight),
        ("shortcuts, hotkeys, help, mouse", Action::Panel(Panel::CheatSheet)),
        ("import, load obj, insert", Action::Load),
        ("exit, close", Action::Quit),
        ("copy, clone", Action::Duplicate),
        ("remove, erase", Action::Delete),
        ("hide, show", Action::ToggleVisible),
        ("solo, isolate", Action::ToggleOthers),
        ("translate, grab", Action::Translate),
        ("turn", Action::Rotate),
        ("resize", Action::Scale),
        ("ortho, parallel, perspective, isometric", Action::ToggleProjection),
        ("culling, backface", Action::ToggleBackFaces),
        ("spotlight", Action::AddSpot),
        ("point light", Action::AddBulb),
        ("directional", Action::AddSun),
        ("fps", Action::Panel(Panel::Statistics)),
        ("hierarchy", Action::Panel(Panel::Outline)),
        ("inspector", Action::Panel(Panel::Properties)),
        ("revert", Action::Undo),
        ("again", Action::Redo),
        ("above", Action::LookTop),
        ("side view", Action::LookRight),
        ("explode", Action::Split),
        ("gizmo, manipulator", Action::ToggleGizmo),
        ("inspect", Action::ExplainPixel),
        ("deselect", Action::SelectNone),
        ("numeric", Action::TypeAmount),
        ("target", Action::AimAtSelection),
        ("font size", Action::LargerText),
        ("brightness", Action::SubjectLight),
        ("texture", Action::ChooseTexture),
        ("hdri, environment", Action::ChoosePanorama),
        ("benchmark", Action::Panel(Panel::Laboratory)),
    ];

    #[test]
    fn common_words_find_the_intended_action_among_the_first_five() {
        let mut missed = Vec::new();
        for (words, action) in WORDS {
            for word in words.split(", ") {
                let found = actions_for(word);
                let first = &found[..found.len().min(5)];
                if !first.contains(&action) {
                    missed.push(format!("{word:?} finds {first:?}, not {action:?}"));
                }
            }
        }
        assert!(missed.is_empty(), "{}", missed.join("\n"));
    }

    #[test]
    fn an_action_is_found_by_its_key_and_by_its_words() {
        assert_eq!(actions_for("l")[0], Action::ToggleEdges);
        assert_eq!(actions_for("ctrl+z")[0], Action::Undo);
        assert_eq!(actions_for("F6")[0], Action::ToPanels);
        assert_eq!(actions_for("vertex normals draws"), [Action::ToggleVertexNormals]);
        assert_eq!(actions_for(""), Action::ALL);
        assert!(actions_for("no such words").is_empty());
    }

    #[test]
    fn every_action_has_synonyms_without_duplicates() {
        for action in Action::ALL {
            let words: Vec<&str> = action.info().words.split_whitespace().collect();
            assert!(!words.is_empty(), "{action:?}");
            for (i, word) in words.iter().enumerate() {
                assert!(!words[i + 1..].contains(word), "{action:?} has {word} twice");
                assert_eq!(*word, word.to_lowercase(), "{action:?}");
            }
        }
    }
}
