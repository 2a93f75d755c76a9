//! Completes materials with missing or invalid statements.
//!
//! Exporters write Ka as a copy of Kd or as white, which lights everything uniformly; Ks for dull
//! surfaces; or no Kd next to a texture. Each rule has its own finding.

use super::Statements;
use crate::findings::{BYTES_ABOVE, FindingKind, Findings};
use marraztu_core::base::Shared;
use marraztu_core::scene::{FileMaterial, MapKind, Material, SurfaceMaps, Texture};

/// The largest exponent derived from roughness: files rarely exceed 1000.
const NARROWEST: f64 = 1000.0;

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
        let (specular, exponent) = match self.packed() {
            Some(packed) => {
                note(FindingKind::MendedPacked);
                highlight(packed, diffuse, self.exponent.filter(|exponent| *exponent >= 1.0))
            }
            None => {
                let specular = self.mended_specular(&mut note);
                self.mended_highlight(specular, &mut note)
            }
        };
        let opacity = self.mended_opacity(&mut note);
        // Kd multiplies the texture, so black hides it.
        if texture.is_some() && self.diffuse == Some([0.0; 3]) {
            note(FindingKind::DiffuseBlack);
        }
        let emission = self.mended_emission(&mut note);
        if self.illumination.is_some_and(|model| ![0.0, 1.0, 2.0].contains(&model)) {
            note(FindingKind::Illumination);
        }
        let unlit = self.illumination == Some(0.0);
        // Exporters write it for surfaces with baked light, but some for all surfaces.
        if unlit && self.map.is_none() && !self.is_own {
            note(FindingKind::Unlit);
        }
        let material = Material { ambient, diffuse, specular, exponent, emission };
        let (name, undrawn) = (self.name, self.undrawn);
        FileMaterial { name, material, opacity, texture, maps, unlit, undrawn }
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
            Some(_) | None => {
                note(FindingKind::MendedMatt);
                ([0.0; 3], 1.0)
            }
        }
    }

    /// Returns the numbers of Ka, Kd and Ks.
    fn numbers_of_colors(&mut self) -> impl Iterator<Item = &mut f64> {
        let Self { ambient, diffuse, specular, .. } = self;
        [ambient, diffuse, specular].into_iter().flatten().flatten()
    }

    /// Returns occlusion, roughness and metalness, if Ks holds them.
    fn packed(&self) -> Option<[f64; 3]> {
        self.specular.filter(|_| self.is_packed)
    }

    fn mended_opacity(&self, note: &mut dyn FnMut(FindingKind)) -> f64 {
        let given = self.opacity.or_else(|| self.transparency.map(|x| 1.0 - x)).unwrap_or(1.0);
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

/// Divides the colours of all materials by 255 if they are bytes: if all are whole numbers, and one
/// of a Kd or Ks exceeds [`BYTES_ABOVE`]. A large Ka alone is a lamp.
pub(super) fn scale_bytes(materials: &mut [Statements], findings: &mut Findings) {
    let is_large = |x: &f64| *x > BYTES_ABOVE;
    let reflects =
        |it: &Statements| [it.diffuse, it.specular].iter().flatten().flatten().any(is_large);
    let is_whole = |x: &mut f64| x.fract() == 0.0;
    if !materials.iter().any(reflects)
        || !materials.iter_mut().flat_map(Statements::numbers_of_colors).all(is_whole)
    {
        return;
    }
    findings.add(FindingKind::MendedBytes, "", None);
    materials.iter_mut().flat_map(Statements::numbers_of_colors).for_each(|x| *x /= 255.0);
}
