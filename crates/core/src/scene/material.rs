//! Materials: Phong's coefficients, and the presets.

use serde::{Deserialize, Serialize};

use super::Optics;

/// The coefficients of Phong's model, as factors from 0 to 1, and the exponent of its highlight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// The fraction of ambient light that is reflected: Ka.
    pub ambient: [f64; 3],
    /// The fraction of a light that is reflected diffusely: Kd.
    pub diffuse: [f64; 3],
    /// The fraction of a light that is reflected specularly: Ks.
    pub specular: [f64; 3],
    /// The exponent of the highlight: Ns, at least 0.
    pub exponent: f64,
    /// The emitted light, which no other light changes: Ke. It may be more than 1.
    #[serde(default, skip_serializing_if = "is_dark")]
    pub emission: [f64; 3],
    /// Mirrors and refraction.
    #[serde(default, skip_serializing_if = "Optics::is_none")]
    pub optics: Optics,
}

impl Material {
    /// Creates a material without highlights and without light of its own.
    pub const fn matte(ambient: [f64; 3], diffuse: [f64; 3]) -> Self {
        Self {
            ambient,
            diffuse,
            specular: [0.0; 3],
            exponent: 1.0,
            emission: [0.0; 3],
            optics: Optics::NONE,
        }
    }
}

fn is_dark(emission: &[f64; 3]) -> bool {
    *emission == [0.0; 3]
}

/// A material with its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// The name in the picker and on the command line.
    pub name: &'static str,
    /// The coefficients.
    pub material: Material,
}

/// The choice of an object's material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum MaterialChoice {
    /// One of [`PRESETS`], by its index.
    Preset(PresetId),
    /// The materials of the model's file, part by part; silver for parts without a material.
    File,
    /// A material that the user has defined.
    Own(Material),
}

/// A row of [`PRESETS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct PresetId(usize);

impl PresetId {
    /// One of the four materials of the first scene.
    pub const EMERALD: Self = Self(11);
    /// See [`Self::EMERALD`].
    pub const RUBY: Self = Self(15);
    /// See [`Self::EMERALD`].
    pub const OBSIDIAN: Self = Self(13);
    /// See [`Self::EMERALD`].
    pub const SILVER: Self = Self(9);

    /// Returns all rows, in order.
    pub fn all() -> impl ExactSizeIterator<Item = Self> {
        (0..PRESETS.len()).map(Self)
    }

    /// Returns the row with this name. Case, blanks, `-` and `_` are ignored.
    pub fn named(name: &str) -> Option<Self> {
        let plain = |text: &str| -> String {
            let letters = text.chars().filter(|c| !matches!(c, ' ' | '-' | '_'));
            letters.flat_map(char::to_lowercase).collect()
        };
        PRESETS.iter().position(|preset| plain(preset.name) == plain(name)).map(Self)
    }

    /// Returns the row.
    pub const fn get(self) -> &'static Preset {
        &PRESETS[self.0]
    }
}

impl From<PresetId> for String {
    fn from(id: PresetId) -> Self {
        id.get().name.to_owned()
    }
}

impl TryFrom<String> for PresetId {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::named(&name).ok_or_else(|| format!("there is no material called \"{name}\""))
    }
}

const fn preset(name: &'static str, rows: [[f64; 3]; 3], exponent: f64) -> Preset {
    let [ambient, diffuse, specular] = rows;
    Preset { name, material: Material { specular, exponent, ..Material::matte(ambient, diffuse) } }
}

/// The nineteen preset materials, in the order of the picker.
///
/// The numbers come from the well-known table of OpenGL materials, which goes back to the plate of
/// teapots in the "OpenGL Programming Guide" (Neider, Davis, Woo).
#[rustfmt::skip]
pub const PRESETS: &[Preset] = &[
    preset("brass", [[0.329412, 0.223529, 0.027451], [0.780392, 0.568627, 0.113725],
        [0.992157, 0.941176, 0.807843]], 27.8974),
    preset("bronze", [[0.2125, 0.1275, 0.054], [0.714, 0.4284, 0.18144],
        [0.393548, 0.271906, 0.166721]], 25.6),
    preset("polished bronze", [[0.25, 0.148, 0.06475], [0.4, 0.2368, 0.1036],
        [0.774597, 0.458561, 0.200621]], 76.8),
    preset("chrome", [[0.25, 0.25, 0.25], [0.4, 0.4, 0.4], [0.774597, 0.774597, 0.774597]], 76.8),
    preset("copper", [[0.19125, 0.0735, 0.0225], [0.7038, 0.27048, 0.0828],
        [0.256777, 0.137622, 0.086014]], 12.8),
    preset("polished copper", [[0.2295, 0.08825, 0.0275], [0.5508, 0.2118, 0.066],
        [0.580594, 0.223257, 0.0695701]], 51.2),
    preset("gold", [[0.24725, 0.1995, 0.0745], [0.75164, 0.60648, 0.22648],
        [0.628281, 0.555802, 0.366065]], 51.2),
    preset("polished gold", [[0.24725, 0.2245, 0.0645], [0.34615, 0.3143, 0.0903],
        [0.797357, 0.723991, 0.208006]], 83.2),
    preset("pewter", [[0.105882, 0.058824, 0.113725], [0.427451, 0.470588, 0.541176],
        [0.333333, 0.333333, 0.521569]], 9.84615),
    preset("silver", [[0.19225, 0.19225, 0.19225], [0.50754, 0.50754, 0.50754],
        [0.508273, 0.508273, 0.508273]], 51.2),
    preset("polished silver", [[0.23125, 0.23125, 0.23125], [0.2775, 0.2775, 0.2775],
        [0.773911, 0.773911, 0.773911]], 89.6),
    preset("emerald", [[0.0215, 0.1745, 0.0215], [0.07568, 0.61424, 0.07568],
        [0.633, 0.727811, 0.633]], 76.8),
    preset("jade", [[0.135, 0.2225, 0.1575], [0.54, 0.89, 0.63],
        [0.316228, 0.316228, 0.316228]], 12.8),
    preset("obsidian", [[0.05375, 0.05, 0.06625], [0.18275, 0.17, 0.22525],
        [0.332741, 0.328634, 0.346435]], 38.4),
    preset("pearl", [[0.25, 0.20725, 0.20725], [1.0, 0.829, 0.829],
        [0.296648, 0.296648, 0.296648]], 11.264),
    preset("ruby", [[0.1745, 0.01175, 0.01175], [0.61424, 0.04136, 0.04136],
        [0.727811, 0.626959, 0.626959]], 76.8),
    preset("turquoise", [[0.1, 0.18725, 0.1745], [0.396, 0.74151, 0.69102],
        [0.297254, 0.30829, 0.306678]], 12.8),
    preset("black plastic", [[0.0, 0.0, 0.0], [0.01, 0.01, 0.01], [0.5, 0.5, 0.5]], 32.0),
    preset("black rubber", [[0.02, 0.02, 0.02], [0.01, 0.01, 0.01], [0.4, 0.4, 0.4]], 10.0),
];

impl Default for Material {
    /// Returns silver, the material for files without materials.
    fn default() -> Self {
        PresetId::SILVER.get().material
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_constants_name_the_rows_they_say() {
        let named = |id: PresetId| id.get().name;
        assert_eq!(PRESETS.len(), 19);
        assert_eq!(named(PresetId::EMERALD), "emerald");
        assert_eq!(named(PresetId::RUBY), "ruby");
        assert_eq!(named(PresetId::OBSIDIAN), "obsidian");
        assert_eq!(named(PresetId::SILVER), "silver");
        assert_eq!(PresetId::named("Polished_Gold").map(named), Some("polished gold"));
        assert_eq!(PresetId::named("unobtainium"), None);
    }
}
