//! The statements of the materials in an MTL file.

use std::collections::BTreeMap;

use super::map::{Map, map};
use super::statement;
use crate::findings::{FindingKind, Findings};
use crate::mark::is_signed;
use crate::obj::lines::{Line, Lines, Oddity, decode, excerpt, words};
use marraztu_core::base::Shared;
use marraztu_core::scene::{MapKind, SurfaceMaps, Texture, Undrawn};

/// The statements of a material.
#[derive(Debug, Default)]
pub(super) struct Statements {
    pub(super) name: String,
    pub(super) line: u32,
    /// Whether this program has written the file: its values are meant as they are.
    pub(super) is_own: bool,
    /// Whether Blender has written the file.
    pub(super) is_of_blender: bool,
    /// Whether MeshLab has written the file: Tr is then the opacity.
    pub(super) is_of_meshlab: bool,
    pub(super) ambient: Option<[f64; 3]>,
    pub(super) diffuse: Option<[f64; 3]>,
    pub(super) specular: Option<[f64; 3]>,
    pub(super) exponent: Option<f64>,
    pub(super) emission: Option<[f64; 3]>,
    pub(super) opacity: Option<f64>,
    pub(super) transparency: Option<f64>,
    pub(super) illumination: Option<f64>,
    /// `bsdf pbr`: Ks holds occlusion, roughness and metalness.
    pub(super) is_packed: bool,
    pub(super) map: Option<(u32, Map)>,
    /// The other maps.
    pub(super) maps: BTreeMap<MapKind, (u32, Map)>,
    /// `disp`: heights.
    pub(super) displacement: Option<(u32, Map)>,
    /// The statements `refl`: one picture, or the six of a cube.
    pub(super) reflection_maps: Vec<(u32, Map)>,
    pub(super) undrawn: Undrawn,
    /// The maps that are not drawn, with their keywords.
    pub(super) undrawn_maps: Vec<(String, Map)>,
}

/// The first bytes of a file, which name its program.
const HEAD: usize = 200;

/// Reads the statements of the materials of a file.
pub(super) fn read_statements(bytes: &[u8], findings: &mut Findings) -> Vec<Statements> {
    let mut list: Vec<Statements> = Vec::new();
    let is_own = is_signed(bytes);
    let is_of_blender = bytes.starts_with(b"# Blender");
    let head = &bytes[..bytes.len().min(HEAD)];
    let is_of_meshlab = head.windows(7).any(|word| word == b"Meshlab");
    for line in Lines::new(bytes) {
        let (keyword, _) = line.statement();
        if line.oddity == Some(Oddity::NotContinued) {
            findings.add(FindingKind::NotContinued, &excerpt(keyword), Some(line.number));
        }
        if keyword == b"newmtl" {
            let (name, line) = (line.name(), line.number);
            let own = Statements { name, line, is_own, is_of_blender, ..Statements::default() };
            let own = Statements { is_of_meshlab, ..own };
            list.push(own);
            continue;
        }
        if keyword.starts_with(b"#") {
            continue;
        }
        // Statements belong to the last `newmtl`.
        match list.last_mut() {
            Some(statements) => statements.read(&line, findings),
            None => findings.add(FindingKind::MtlStray, &decode(keyword), Some(line.number)),
        }
    }
    list
}

impl Statements {
    fn read(&mut self, line: &Line<'_>, findings: &mut Findings) {
        let (keyword, rest) = line.statement();
        let plain = keyword.to_ascii_lowercase();
        let mut note = |kind| findings.add(kind, &decode(keyword), Some(line.number));
        let mut is_read = true;
        match &plain[..] {
            b"ka" => is_read = set(&mut self.ambient, statement::color(rest)),
            b"kd" => is_read = set(&mut self.diffuse, statement::color(rest)),
            b"ks" => is_read = set(&mut self.specular, statement::color(rest)),
            b"ke" => is_read = set(&mut self.emission, statement::color(rest)),
            b"ns" => is_read = set(&mut self.exponent, statement::scalar(rest)),
            b"d" => {
                // `d -halo x` fades towards the edges; only x is used.
                let halo = rest.strip_prefix(b"-halo");
                if halo.is_some() {
                    note(FindingKind::HaloEven);
                }
                let rest = halo.unwrap_or(rest);
                is_read = set(&mut self.opacity, statement::scalar(rest));
            }
            b"tr" if self.is_of_meshlab => {
                is_read = set(&mut self.opacity, statement::scalar(rest));
            }
            b"tr" => is_read = set(&mut self.transparency, statement::scalar(rest)),
            b"illum" => {
                is_read = set(&mut self.illumination, statement::scalar(rest));
                self.keep_model();
            }
            b"bsdf" if words(rest).eq([b"pbr"]) => self.is_packed = true,
            b"map_kd" => match map(rest) {
                Some(map) => self.map = Some((line.number, map)),
                None => note(FindingKind::MapUnnamed),
            },
            b"map_aat" => {}
            _ if let Some(kind) = kind_of(&plain) => match map(rest) {
                Some(map) => _ = self.maps.insert(kind, (line.number, map)),
                None => note(FindingKind::MapUnnamed),
            },
            _ if DISPLACEMENTS.contains(&&*plain) => match map(rest) {
                Some(map) => {
                    self.undrawn_maps.push((decode(keyword), map.clone()));
                    self.displacement = Some((line.number, map));
                }
                None => note(FindingKind::MapUnnamed),
            },
            _ if REFLECTIONS.contains(&&*plain) => match map(rest) {
                Some(map) => {
                    self.undrawn_maps.push((decode(keyword), map.clone()));
                    self.reflection_maps.push((line.number, map));
                }
                None => note(FindingKind::MapUnnamed),
            },
            _ if plain.starts_with(b"map_") || plain == b"decal" => {
                note(FindingKind::MapUnused);
                self.undrawn_maps.extend(map(rest).map(|map| (decode(keyword), map)));
            }
            _ if let Some(is_known) = self.keep_undrawn(keyword, rest) => is_read = is_known,
            _ => note(FindingKind::Unknown),
        }
        if !is_read {
            note(FindingKind::MtlNumber);
        }
    }

    /// Removes an opacity map with the picture of the texture, if that has no alpha. Its alpha is
    /// meant, not the brightness of its colours.
    pub(super) fn settle_opacity(
        &self,
        texture: Option<&Texture>,
        maps: &mut SurfaceMaps,
        findings: &mut Findings,
    ) {
        let (Some(texture), Some(map)) = (texture, maps.get(&MapKind::Opacity)) else { return };
        let is_same = Shared::same(&texture.picture, &map.texture.picture);
        if is_same && texture.picture.least_alpha() == 255 && !self.is_own {
            maps.remove(&MapKind::Opacity);
            findings.add(FindingKind::MapOpaque, &self.name, Some(self.line));
        }
    }

    /// Takes heights that would move vertices as a bump map, if there is no other relief.
    pub(super) fn settle_displacement(&mut self, findings: &mut Findings) {
        let Some((line, map)) = &self.displacement else { return };
        let has = |kind| self.maps.get(&kind);
        if has(MapKind::Bump).is_some_and(|(_, bump)| bump.name == map.name) {
            // Our exports name it twice.
        } else if has(MapKind::Bump).is_some() || has(MapKind::Normal).is_some() {
            findings.add(FindingKind::MapUnused, "disp", Some(*line));
        } else {
            findings.add(FindingKind::DisplacementIsBump, &self.name, Some(self.line));
            self.maps.insert(MapKind::Bump, (*line, map.clone()));
        }
    }

    /// Removes the bump map if it is also the normal map. Some files, including our exports, name
    /// it twice for readers that know only one of the statements.
    pub(super) fn keep_one_relief(&mut self) {
        let name = |kind| self.maps.get(&kind).map(|(_, map): &(u32, Map)| &map.name);
        if name(MapKind::Bump).is_some() && name(MapKind::Bump) == name(MapKind::Normal) {
            self.maps.remove(&MapKind::Bump);
        }
    }
}

/// Returns the file names of all maps in an MTL file.
pub(crate) fn map_names(bytes: &[u8]) -> Vec<String> {
    let of_line = |line: Line<'_>| {
        let (keyword, rest) = line.statement();
        let keyword = keyword.to_ascii_lowercase();
        let is_map = keyword == b"map_kd"
            || kind_of(&keyword).is_some()
            || [DISPLACEMENTS, REFLECTIONS].concat().contains(&&*keyword);
        if is_map { map(rest).map(|map| map.name) } else { None }
    };
    Lines::new(bytes).filter_map(of_line).collect()
}

/// The keywords of heights that would move vertices, and of reflection maps.
const DISPLACEMENTS: [&[u8]; 2] = [b"disp", b"map_disp"];
const REFLECTIONS: [&[u8]; 2] = [b"refl", b"map_refl"];

/// Returns the kind of a map, by its keyword in lower case.
fn kind_of(keyword: &[u8]) -> Option<MapKind> {
    match keyword {
        b"map_ka" => Some(MapKind::Ambient),
        b"map_ks" => Some(MapKind::Specular),
        b"map_ns" => Some(MapKind::Exponent),
        b"map_d" => Some(MapKind::Opacity),
        b"map_ke" => Some(MapKind::Emission),
        b"bump" | b"map_bump" => Some(MapKind::Bump),
        b"norm" | b"map_norm" | b"map_kn" => Some(MapKind::Normal),
        _ => None,
    }
}

/// Sets a value if it was parsed; returns whether it was.
fn set<T>(target: &mut Option<T>, value: Option<T>) -> bool {
    let read = value.is_some();
    if read {
        *target = value;
    }
    read
}
