//! The arguments of a map statement: a file name, with options before or after it.

use super::statement;
use super::tone::{Channel, Tone};
use crate::obj::lines::decode;
use marraztu_core::scene::Wrap;

/// The file of a texture and its options.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// The name in the MTL file.
    pub(super) name: String,
    pub(super) wrap: Wrap,
    pub(super) offset: [f64; 2],
    pub(super) scale: [f64; 2],
    /// The factor of `-bm`.
    pub(super) gain: f64,
    pub(super) tone: Tone,
    /// The shape of a reflection map: `-type`.
    pub(super) shape: Option<String>,
    /// Options that would change the picture but are ignored.
    pub(super) ignored: Vec<&'static str>,
    /// All options as in the file.
    pub(super) options: String,
}

/// Options that would change the picture but are ignored, with their numbers of arguments:
/// turbulence, and boosted sharpness.
const IGNORED: [(&str, usize); 2] = [("-t", 3), ("-boost", 1)];

/// Parses the arguments; `None` without a name.
pub(super) fn map(rest: &[u8]) -> Option<Map> {
    let mut map = Map {
        name: String::new(),
        wrap: Wrap::Repeat,
        offset: [0.0; 2],
        scale: [1.0; 2],
        gain: 1.0,
        tone: Tone::default(),
        shape: None,
        ignored: Vec::new(),
        options: String::new(),
    };
    let mut options = Vec::new();
    let text = decode(rest);
    let words = words_with_places(&text);
    // The range of the name in the text, which keeps blanks inside it.
    let mut name: Option<(usize, usize)> = None;
    let mut at = 0;
    while let Some(&(begin, word)) = words.get(at) {
        if word == "#" {
            break;
        }
        match map.option(word, &words[at + 1..]) {
            Some(arguments) => {
                let end = words.len().min(at + 1 + arguments);
                options.extend(words[at..end].iter().map(|(_, word)| *word));
                at += arguments;
            }
            None => name = Some((name.map_or(begin, |(first, _)| first), begin + word.len())),
        }
        at += 1;
    }
    let (begin, end) = name?;
    map.name = statement::texture(&text[begin..end])?;
    map.options = options.join(" ");
    Some(map)
}

impl Map {
    /// Returns whether its options move, scale or change texels.
    pub(super) fn changes_texels(&self) -> bool {
        let is_placed = self.offset != [0.0; 2] || self.scale != [1.0; 2];
        is_placed || self.tone != Tone::default() || !self.ignored.is_empty()
    }

    /// Applies an option and returns the number of words that are its arguments, or `None` if the
    /// word is not an option.
    fn option(&mut self, word: &str, following: &[(usize, &str)]) -> Option<usize> {
        let numbers = |most: usize| -> Vec<f64> {
            let words = following.iter().take(most);
            words.map_while(|(_, word)| statement::single(word.as_bytes())).collect()
        };
        let set = |target: &mut [f64; 2], given: &[f64]| {
            for (target, given) in target.iter_mut().zip(given) {
                *target = *given;
            }
            given.len()
        };
        // Ignored options must still consume their arguments, or these would join the name.
        let word = word.to_ascii_lowercase();
        if let Some((option, most)) = IGNORED.iter().find(|(option, _)| *option == word) {
            self.ignored.push(option);
            return Some(numbers(*most).len());
        }
        Some(match word.as_str() {
            "-clamp" => {
                let on = following.first().is_some_and(|(_, word)| word.eq_ignore_ascii_case("on"));
                self.wrap = if on { Wrap::Clamp } else { Wrap::Repeat };
                1
            }
            "-o" => set(&mut self.offset, &numbers(3)),
            "-s" => set(&mut self.scale, &numbers(3)),
            "-bm" => {
                let given = numbers(1);
                self.gain = given.first().copied().unwrap_or(self.gain);
                given.len()
            }
            "-mm" => {
                let given = numbers(2);
                let [base, gain] = [(0, 0.0), (1, 1.0)].map(|(i, or)| *given.get(i).unwrap_or(&or));
                self.tone = Tone { base, gain, ..self.tone };
                given.len()
            }
            "-imfchan" => {
                self.tone.channel = following.first().and_then(|(_, word)| Channel::named(word));
                if self.tone.channel.is_none() {
                    self.ignored.push("-imfchan");
                }
                1
            }
            "-texres" => numbers(1).len(),
            "-type" => {
                self.shape = following.first().map(|(_, word)| word.to_ascii_lowercase());
                1
            }
            "-blendu" | "-blendv" | "-cc" | "-colorspace" => 1,
            _ => return None,
        })
    }
}

/// Splits a text into words with their offsets.
fn words_with_places(text: &str) -> Vec<(usize, &str)> {
    // Pointer arithmetic gives the offset of a word in the text.
    let place = |word: &str| word.as_ptr().addr() - text.as_ptr().addr();
    text.split_whitespace().map(|word| (place(word), word)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_of_a_map_may_precede_or_follow_a_name_with_blanks() {
        let map = |text: &str| map(text.as_bytes());
        let plain = Map {
            name: "a  b.png".into(),
            wrap: Wrap::Repeat,
            offset: [0.0; 2],
            scale: [1.0; 2],
            gain: 1.0,
            tone: Tone::default(),
            shape: None,
            ignored: Vec::new(),
            options: String::new(),
        };
        assert_eq!(map("a  b.png"), Some(plain.clone()));
        assert_eq!(
            map("-clamp on -o 0.1 -s 2 3 0 -mm 0 1 -imfchan r a  b.png -bm 1.5 # x"),
            Some(Map {
                wrap: Wrap::Clamp,
                offset: [0.1, 0.0],
                scale: [2.0, 3.0],
                gain: 1.5,
                tone: Tone { channel: Some(Channel::Red), ..Tone::default() },
                options: "-clamp on -o 0.1 -s 2 3 0 -mm 0 1 -imfchan r -bm 1.5".into(),
                ..plain
            })
        );
        let toned = map("-mm 0.5 2 -imfchan z -t 1 2 3 a  b.png").unwrap();
        assert_eq!(toned.tone, Tone { base: 0.5, gain: 2.0, channel: None });
        assert_eq!(toned.ignored, ["-imfchan", "-t"]);
        assert_eq!(map("-s 1 1 1"), None);
    }
}
