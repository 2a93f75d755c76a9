//! Roughness and metalness of glTF: one texture with roughness in green and metalness in blue.
//!
//! `map_Pr` and `map_Pm` are not drawn here, so they are read only for the export. Without
//! `map_Pr`, roughness follows from the exponent map `map_Ns`, which multiplies Ns. A picture that
//! has the layout of glTF already is used as it is, so its file can be copied.

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

use super::gltf_opacity::{Merging, byte, with_pixels};
use super::part_look::{Look, RoughMetal};
use crate::error::short_name;
use crate::texture::load_picture;
use marraztu_core::base::Shared;
use marraztu_core::base::image::Picture;
use marraztu_core::scene::{MapKind, Texture, UndrawnMap, Wrap};

const ROUGHNESS: &str = "map_Pr";
const METALNESS: &str = "map_Pm";

/// The maps of roughness and metalness read so far.
#[derive(Debug, Default)]
pub(super) struct Scalars {
    /// The pictures, or why they cannot be read.
    pictures: HashMap<PathBuf, Result<Shared<Picture>, String>>,
    merged: HashMap<[Option<ScalarKey>; 2], Shared<Texture>>,
    notes: BTreeSet<String>,
}

/// A map of one number per texel.
struct Scalar {
    texture: Shared<Texture>,
    channel: Channel,
    /// The exponent that the map multiplies; the number is then the roughness that follows.
    exponent: Option<f64>,
}

/// The part of a texel that is the number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Channel {
    Red,
    Green,
    Blue,
    Alpha,
    Brightness,
}

/// The picture, wrapping, layout and meaning of a scalar map.
type ScalarKey = (usize, Wrap, [u64; 5], Channel);

/// Returns whether a map is part of the roughness and metalness of glTF.
pub(super) fn is_rough_metal(map: &UndrawnMap) -> bool {
    [ROUGHNESS, METALNESS].iter().any(|word| map.keyword.eq_ignore_ascii_case(word))
}

impl Scalars {
    /// Returns the roughness and metalness of a look. Numbers of the file take precedence over
    /// derived ones.
    pub(super) fn of(&mut self, look: &Look) -> RoughMetal {
        let rough = self.undrawn(look, ROUGHNESS).or_else(|| exponents(look));
        let metal = self.undrawn(look, METALNESS);
        // As with Kd and d, a factor of 0 next to a map would hide it.
        let stated = |word: &str| look.undrawn(word);
        let with_map = |word: &str| stated(word).filter(|factor| *factor > 0.0).unwrap_or(1.0);
        let roughness = match &rough {
            Some(Scalar { exponent: Some(_), .. }) => 1.0,
            Some(_) => with_map("Pr"),
            None => stated("Pr").unwrap_or_else(|| roughness(look.material.exponent)),
        };
        let metalness = if metal.is_some() { with_map("Pm") } else { stated("Pm").unwrap_or(0.0) };
        let texture = self.texture(rough.as_ref(), metal.as_ref(), metalness);
        RoughMetal { texture, roughness, metalness }
    }

    /// Returns the sentences about maps that are left out or approximated.
    pub(super) fn notes(&self) -> impl Iterator<Item = &String> {
        self.notes.iter()
    }

    /// Reads a map that is not drawn.
    fn undrawn(&mut self, look: &Look, keyword: &str) -> Option<Scalar> {
        let is_it = |map: &&UndrawnMap| map.keyword.eq_ignore_ascii_case(keyword);
        let map = look.undrawn_maps.iter().rfind(is_it).filter(|_| !look.unlit)?;
        let read = || load_picture(&map.source).map(Shared::new).map_err(|error| error.reason());
        let read = self.pictures.entry(map.source.clone()).or_insert_with(read);
        let &UndrawnMap { wrap, offset, scale, .. } = map;
        match read {
            Ok(picture) => {
                let (source, picture) = (map.source.clone(), picture.clone());
                let texture = Shared::new(Texture { source, picture, wrap, offset, scale });
                Some(Scalar { texture, channel: Channel::of(map), exponent: None })
            }
            Err(why) => {
                let name = short_name(&map.source);
                self.notes.insert(format!("{keyword} {name} is left out: {why}"));
                None
            }
        }
    }

    /// Combines both maps. Without one of them, its channel is white.
    fn texture(
        &mut self,
        rough: Option<&Scalar>,
        metal: Option<&Scalar>,
        metalness: f64,
    ) -> Option<Shared<Texture>> {
        if let Some(unchanged) = unchanged(rough, metal, metalness) {
            return Some(unchanged.clone());
        }
        let keys = [rough, metal].map(|scalar| scalar.map(Scalar::key));
        if let Some(known) = self.merged.get(&keys) {
            return Some(known.clone());
        }
        let merged = match (rough, metal) {
            (None, None) => return None,
            (Some(rough), None) => rough.alone(|number| [255.0, number, 255.0, 255.0]),
            (None, Some(metal)) => metal.alone(|number| [255.0, 255.0, number, 255.0]),
            (Some(rough), Some(metal)) => {
                let merging = Merging::of(&rough.texture, &metal.texture);
                if !merging.is_exact {
                    let text = "glTF has one texture for roughness and metalness: maps that \
                                repeat differently are approximated";
                    self.notes.insert(text.to_owned());
                }
                merging.combined(&rough.texture, &metal.texture, |a, b| {
                    [255.0, rough.number(a), metal.number(b), 255.0]
                })
            }
        };
        let merged = Shared::new(merged);
        self.merged.insert(keys, merged.clone());
        Some(merged)
    }
}

/// Returns the texture of the maps if its green is the roughness and its blue the metalness.
fn unchanged<'a>(
    rough: Option<&'a Scalar>,
    metal: Option<&Scalar>,
    metalness: f64,
) -> Option<&'a Shared<Texture>> {
    let rough = rough?;
    let Some(metal) = metal else {
        return (metalness == 0.0 && rough.reads(Channel::Green)).then_some(&rough.texture);
    };
    // Coordinates and picture are the same.
    let [of_rough, of_metal] = [rough, metal].map(|it| {
        let (address, wrap, bits, _) = it.key();
        (address, wrap, bits)
    });
    // A coloured picture for both without channels is packed as in glTF.
    let is_packed = [rough, metal].iter().all(|it| it.channel == Channel::Brightness);
    let is_laid_out = is_packed || (rough.reads(Channel::Green) && metal.reads(Channel::Blue));
    (of_rough == of_metal && is_laid_out).then_some(&rough.texture)
}

/// Returns the exponent map of a look as a map of roughness.
fn exponents(look: &Look) -> Option<Scalar> {
    let map = look.map(MapKind::Exponent).filter(|_| !look.unlit)?;
    let exponent = Some(look.material.exponent);
    Some(Scalar { texture: map.texture.clone(), channel: Channel::Brightness, exponent })
}

/// Returns the roughness that matches a Phong exponent.
fn roughness(exponent: f64) -> f64 {
    libm::pow(2.0 / (4.0 * exponent.max(0.0) + 2.0), 0.25)
}

impl Scalar {
    fn key(&self) -> ScalarKey {
        let Texture { picture, wrap, offset, scale, .. } = &*self.texture;
        let exponent = self.exponent.unwrap_or(-1.0);
        let bits = [offset[0], offset[1], scale[0], scale[1], exponent].map(f64::to_bits);
        (Shared::address(picture), *wrap, bits, self.channel)
    }

    /// Returns whether this channel of the picture has the number in every texel.
    fn reads(&self, channel: Channel) -> bool {
        let is_grey = || {
            let texels = self.texture.picture.pixels();
            texels.iter().all(|[r, g, b, _]| r == g && g == b)
        };
        self.exponent.is_none()
            && (self.channel == channel || (self.channel != Channel::Alpha && is_grey()))
    }

    /// Returns the number of a texel, from 0 to 255.
    fn number(&self, [r, g, b, alpha]: [f64; 4]) -> f64 {
        let number = match self.channel {
            Channel::Red => r,
            Channel::Green => g,
            Channel::Blue => b,
            Channel::Alpha => alpha,
            Channel::Brightness => 0.2126 * r + 0.7152 * g + 0.0722 * b,
        };
        self.exponent.map_or(number, |exponent| 255.0 * roughness(exponent * number / 255.0))
    }

    /// Returns a texture with texels computed from the number.
    fn alone(&self, texel: impl Fn(f64) -> [f64; 4]) -> Texture {
        let picture = &self.texture.picture;
        let of = |from: &[u8; 4]| texel(self.number(from.map(f64::from))).map(byte);
        with_pixels(&self.texture, picture.size(), picture.pixels().iter().map(of).collect())
    }
}

impl Channel {
    /// Returns the channel that the options of a map choose. Scalar maps are read by their
    /// brightness otherwise.
    fn of(map: &UndrawnMap) -> Self {
        match map.channel() {
            Some('r') => Self::Red,
            Some('g') => Self::Green,
            Some('b') => Self::Blue,
            Some('m') => Self::Alpha,
            Some(_) | None => Self::Brightness,
        }
    }
}
