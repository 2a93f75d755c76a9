//! Keeps numbers and maps of a material that exports pass on to other programs.

use super::map::Map;
use super::statement;
use super::statements::Statements;

/// Refraction, filters, sharpness, and physically based shading.
const KEYWORDS: [&str; 11] =
    ["Ni", "Tf", "Kt", "sharpness", "Pr", "Pm", "Ps", "Pc", "Pcr", "aniso", "anisor"];

/// The illumination models with reflection, refraction and shadows.
const MODELS: std::ops::RangeInclusive<f64> = 3.0..=10.0;

impl Statements {
    /// Keeps the numbers of a statement. Returns whether it has any; `None` if its keyword is none
    /// of [`KEYWORDS`].
    pub(super) fn keep_undrawn(&mut self, keyword: &[u8], rest: &[u8]) -> Option<bool> {
        let is_same = |known: &&&str| known.as_bytes().eq_ignore_ascii_case(keyword);
        let known = KEYWORDS.iter().find(is_same)?;
        // `Tf` may name a spectrum file, which would be missing in other folders.
        let numbers = statement::numbers(rest);
        let is_read = numbers.is_some();
        self.undrawn.extend(numbers.map(|numbers| (*known, numbers)));
        Some(is_read)
    }

    /// Keeps the number of an illumination model that asks for more than model 2.
    pub(super) fn keep_model(&mut self) {
        self.undrawn.remove("illum");
        if let Some(model) = self.illumination.filter(|model| MODELS.contains(model)) {
            self.undrawn.insert("illum", vec![model]);
        }
    }

    /// Keeps the map of a packed Ks as maps of roughness and metalness.
    pub(super) fn keep_packed_map(&mut self, map: &Map) {
        for (keyword, channel) in [("map_Pr", "g"), ("map_Pm", "b")] {
            let options = format!("{} -imfchan {channel}", map.options);
            let map = Map { options: options.trim().to_owned(), ..map.clone() };
            self.undrawn_maps.push((keyword.to_owned(), map));
        }
    }

    /// Extracts roughness and metalness from a packed Ks as `Pr` and `Pm`.
    pub(super) fn unpack(&mut self) {
        if let Some([_, roughness, metalness]) = self.specular.filter(|_| self.is_packed) {
            for (keyword, number) in [("Pr", roughness), ("Pm", metalness)] {
                self.undrawn.entry(keyword).or_insert_with(|| vec![number.clamp(0.0, 1.0)]);
            }
        }
    }
}
