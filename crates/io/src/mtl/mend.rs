//! Completes materials with missing or invalid statements.
//!
//! Exporters write Ka as a copy of Kd or as white, which lights everything uniformly; Ks for dull
//! surfaces; or no Kd next to a texture. Each rule has its own finding.

use super::statements::Statements;
use crate::findings::{BYTES_ABOVE, FindingKind, Findings};
use marraztu_core::base::Shared;
use marraztu_core::scene::{
    FileMaterial, MapKind, Material, Optics, Reflection, SurfaceMaps, Texture, Transmission,
};

/// The largest exponent derived from roughness: files rarely exceed 1000.
const NARROWEST: f64 = 1000.0;

/// In files with other colours, whole colours are bytes only if one exceeds this number. Lamps have
/// 5 to 50.
const BYTES_AMONG_OTHERS_ABOVE: f64 = 100.0;

impl Statements {
    /// Returns the material, with missing and invalid values replaced.
    pub(super) fn mended(
        self,
        (texture, maps): (Option<Shared<Texture>>, SurfaceMaps),
        findings: &mut Findings,
    ) -> FileMaterial {
        let mut note = |kind| findings.add(kind, &self.name, Some(self.line));
        let diffuse = self.mended_diffuse(&mut note);
        let ambient = self.mended_ambient(diffuse, &mut note);
        // A packed Ks is not a colour: the highlight follows from roughness and metalness.
        let (specular, exponent) = match (self.packed(), self.roughness()) {
            (Some(packed), _) => {
                note(FindingKind::MendedPacked);
                highlight(packed, diffuse, self.exponent.filter(|exponent| *exponent >= 1.0))
            }
            (None, Some(rough)) => {
                note(FindingKind::MendedRough);
                highlight(rough, diffuse, None)
            }
            (None, None) => {
                let specular = self.mended_specular(&mut note);
                self.mended_highlight(specular, &mut note)
            }
        };
        let specular = match self.metalness() {
            Some(metalness) => {
                note(FindingKind::MendedMetal);
                let mixed = |i| specular[i] * (1.0 - metalness) + diffuse[i] * metalness;
                std::array::from_fn(mixed)
            }
            None => specular,
        };
        let opacity = self.mended_opacity(&mut note);
        let optics = self.optics();
        // Kd multiplies the texture, so black hides it.
        if texture.is_some() && self.diffuse == Some([0.0; 3]) {
            note(FindingKind::DiffuseBlack);
        }
        let emission = self.mended_emission(&mut note);
        let is_known = |model: f64| (0.0..=9.0).contains(&model) && model.fract() == 0.0;
        if self.illumination.is_some_and(|model| !is_known(model)) {
            note(FindingKind::Illumination);
        }
        // Exporters write `illum 0` for textures that include light, but some for all materials.
        let is_constant = self.illumination == Some(0.0);
        let unlit = is_constant && (texture.is_some() || self.is_own);
        if is_constant && !unlit {
            note(FindingKind::MendedConstant);
        }
        // Scans have vertex colours and a texture made from the same photographs.
        let multiplies_colors = texture.is_none();
        let material = Material { ambient, diffuse, specular, exponent, emission, optics };
        let (name, undrawn, undrawn_maps) = (self.name, self.undrawn, Vec::new());
        FileMaterial {
            name,
            material,
            opacity,
            texture,
            maps,
            unlit,
            multiplies_colors,
            undrawn,
            environment: None,
            undrawn_maps,
        }
    }

    /// Returns what the surface shows of its surroundings.
    fn optics(&self) -> Optics {
        let (reflection, transmits) = match self.illumination {
            Some(3.0 | 4.0) => (Reflection::Constant, false),
            Some(5.0) => (Reflection::Fresnel, false),
            Some(6.0) => (Reflection::Constant, true),
            Some(7.0) => (Reflection::Fresnel, true),
            _ => return Optics::NONE,
        };
        let index = self.undrawn.get("Ni").and_then(|numbers| numbers.first());
        let filter = |color: [f64; 3]| Transmission::Filter(color.map(|x| x.clamp(0.0, 1.0)));
        let transmission = match self.filter() {
            _ if !transmits => Transmission::None,
            Some(&[grey]) => filter([grey; 3]),
            Some(&[r, g, b, ..]) => filter([r, g, b]),
            _ => Transmission::Opacity,
        };
        let index = index.copied().filter(|index| Optics::INDICES.contains(index)).unwrap_or(1.0);
        Optics { reflection, transmission, index }
    }

    fn is_mirror(&self) -> bool {
        self.optics().reflection != Reflection::None
    }

    /// Returns the numbers of Tf, or of its other name Kt.
    fn filter(&self) -> Option<&[f64]> {
        let named = ["Tf", "Kt"].into_iter().find_map(|word| self.undrawn.get(word));
        named.map(Vec::as_slice)
    }

    /// Emission may exceed 1, but not fall below 0.
    fn mended_emission(&self, note: &mut dyn FnMut(FindingKind)) -> [f64; 3] {
        let Some(given) = self.emission else {
            // A map counts even if its file is missing.
            let is_mapped = self.maps.contains_key(&MapKind::Emission);
            if is_mapped {
                note(FindingKind::MendedEmission);
            }
            return [if is_mapped { 1.0 } else { 0.0 }; 3];
        };
        let within = given.map(|x| x.max(0.0));
        if within != given {
            note(FindingKind::MendedRange);
        }
        within
    }

    fn mended_diffuse(&self, note: &mut dyn FnMut(FindingKind)) -> [f64; 3] {
        if let Some(color) = self.diffuse {
            return clamped(color, note);
        }
        note(FindingKind::MendedDiffuse);
        // A texture counts even if its file is missing.
        [if self.map.is_some() { 1.0 } else { 0.8 }; 3]
    }

    fn mended_ambient(&self, diffuse: [f64; 3], note: &mut dyn FnMut(FindingKind)) -> [f64; 3] {
        let shade = diffuse.map(|x| 0.2 * x);
        let nonsense = |ambient: [f64; 3]| {
            Some(ambient) == self.diffuse
                || ambient.iter().all(|x| *x >= 1.0)
                || ambient.iter().any(|x| *x > 1.0)
        };
        if self.metalness().is_some() {
            return shade;
        }
        match self.ambient {
            Some(ambient) if self.is_own || !nonsense(ambient) => clamped(ambient, note),
            given => {
                if given != Some(shade) {
                    note(FindingKind::MendedAmbient);
                }
                shade
            }
        }
    }

    fn mended_specular(&self, note: &mut dyn FnMut(FindingKind)) -> [f64; 3] {
        let unlit = self.illumination.is_some_and(|model| model == 0.0 || model == 1.0);
        match self.specular {
            Some(specular) if !unlit => clamped(specular, note),
            None if !unlit && self.maps.contains_key(&MapKind::Specular) => {
                note(FindingKind::MendedMapped);
                [1.0; 3]
            }
            given => {
                if given != Some([0.0; 3]) {
                    note(FindingKind::MendedSpecular);
                }
                [0.0; 3]
            }
        }
    }

    /// Returns the colour and exponent of the highlight. Without an exponent there is no highlight:
    /// Ns 0 would spread it over half the body, but exporters mean a matt surface.
    fn mended_highlight(
        &self,
        specular: [f64; 3],
        note: &mut dyn FnMut(FindingKind),
    ) -> ([f64; 3], f64) {
        match self.exponent {
            Some(exponent) if self.is_own || exponent >= 1.0 => (specular, exponent.max(0.0)),
            Some(exponent) if exponent > 0.0 => {
                note(FindingKind::MendedExponent);
                (specular, 1.0)
            }
            _ if specular == [0.0; 3] => (specular, 1.0),
            // The highlight of a mirror is as narrow as its picture of the lamp.
            _ if self.is_mirror() => (specular, NARROWEST),
            Some(_) | None => {
                note(FindingKind::MendedMatt);
                ([0.0; 3], 1.0)
            }
        }
    }

    /// Returns occlusion, roughness and metalness, if Ks holds them.
    fn packed(&self) -> Option<[f64; 3]> {
        self.specular.filter(|_| self.is_packed)
    }

    /// Returns occlusion, roughness and metalness of `Pr` and `Pm`, if nothing else describes the
    /// highlight.
    fn roughness(&self) -> Option<[f64; 3]> {
        let is_lit = self.illumination.is_none_or(|model| model > 1.0);
        let is_free = self.specular.is_none() && self.exponent.is_none() && is_lit;
        let number = |word| self.undrawn.get(word).and_then(|numbers| numbers.first()).copied();
        let roughness = number("Pr").filter(|_| is_free)?;
        Some([1.0, roughness, number("Pm").unwrap_or(0.0)])
    }

    /// Returns the metalness of a metal of Blender, which writes it as Ka with `illum` 3 or 6.
    fn metalness(&self) -> Option<f64> {
        let is_metal = self.is_of_blender && matches!(self.illumination, Some(3.0 | 6.0));
        let [r, g, b] = self.ambient.filter(|_| is_metal)?;
        (r == g && g == b && (0.0..=1.0).contains(&r)).then_some(r)
    }

    fn mended_opacity(&self, note: &mut dyn FnMut(FindingKind)) -> f64 {
        let given = self.opacity.or_else(|| self.transparency.map(|x| 1.0 - x)).unwrap_or(1.0);
        // An invisible material would have `Tr 1`.
        if given == 0.0 && self.transparency == Some(0.0) && !self.is_own {
            note(FindingKind::MendedContradiction);
            return 1.0;
        }
        // Some exporters write the opacity to the map alone.
        if given == 0.0 && self.maps.contains_key(&MapKind::Opacity) && !self.is_own {
            note(FindingKind::MendedDissolve);
            return 1.0;
        }
        let [opacity, ..] = clamped([given; 3], note);
        opacity
    }
}

/// Returns the colour and exponent of a highlight that matches roughness and metalness.
///
/// Roughness r is that of a lobe with slope r^2 (Burley, Physically Based Shading at Disney, 2012).
/// Its Blinn exponent is n = 2 / r^4 - 2 (Karis, Real Shading in Unreal Engine 4, 2013). The peak
/// of the lobe is (n + 8) / 8 times its share of the light (Akenine-Möller, Haines and Hoffman,
/// Real-Time Rendering, 3rd edition, 7.6), and Phong's exponent is a quarter of Blinn's. The share
/// is 0.04 for dielectrics and the base colour for metals.
fn highlight(packed: [f64; 3], diffuse: [f64; 3], given: Option<f64>) -> ([f64; 3], f64) {
    let [_, roughness, metalness] = packed.map(|x| x.clamp(0.0, 1.0));
    let blinn = (2.0 / roughness.powi(4) - 2.0).min(4.0 * NARROWEST);
    let specular = diffuse.map(|color| {
        let share = 0.04 * (1.0 - metalness) + color * metalness;
        (share * (blinn + 8.0) / 8.0).min(1.0)
    });
    (specular, given.unwrap_or((blinn / 4.0).max(1.0)))
}

/// Clamps three numbers to 0..=1.
fn clamped(color: [f64; 3], note: &mut dyn FnMut(FindingKind)) -> [f64; 3] {
    let within = color.map(|x| x.clamp(0.0, 1.0));
    if within != color {
        note(FindingKind::MendedRange);
    }
    within
}

/// Divides colours that are bytes by 255. Colours up to 1 are kept: white is `1 1 1` in many files
/// of bytes, too.
///
/// Kd decides whether a file has bytes. Ks may have bytes alone, but a large Ka alone is a lamp.
pub(super) fn scale_bytes(materials: &mut [Statements], findings: &mut Findings) {
    let are_bytes =
        |color: fn(&Statements) -> Option<[f64; 3]>| has_bytes(materials.iter().filter_map(color));
    let diffuse = are_bytes(|it| it.diffuse);
    let specular = diffuse || are_bytes(|it| it.specular);
    let emission = diffuse && are_bytes(|it| it.emission);
    for it in materials {
        let colors = [
            (&mut it.ambient, diffuse),
            (&mut it.diffuse, diffuse),
            (&mut it.specular, specular),
            (&mut it.emission, emission),
        ];
        let bytes = colors.into_iter().filter(|(_, are_bytes)| *are_bytes);
        let bytes: Vec<_> =
            bytes.filter_map(|(color, _)| color.as_mut()).filter(|it| is_bytes(it)).collect();
        if !bytes.is_empty() {
            findings.add(FindingKind::MendedBytes, &it.name, Some(it.line));
        }
        bytes.into_iter().for_each(|color| *color = color.map(|x| x / 255.0));
    }
}

/// Returns whether the colours of a file include bytes. Next to other colours, small whole numbers
/// are lamps.
fn has_bytes(colors: impl Iterator<Item = [f64; 3]>) -> bool {
    let (mut most, mut has_others) = (0.0, false);
    for color in colors {
        if is_bytes(&color) {
            most = color.into_iter().fold(most, f64::max);
        } else {
            has_others |= color != [0.0; 3];
        }
    }
    most > if has_others { BYTES_AMONG_OTHERS_ABOVE } else { BYTES_ABOVE }
}

/// Returns whether a colour above 1 has whole numbers from 0 to 255.
fn is_bytes(color: &[f64; 3]) -> bool {
    let is_byte = |x: &f64| x.fract() == 0.0 && (0.0..=255.0).contains(x);
    color.iter().all(is_byte) && color.iter().any(|x| *x > 1.0)
}
