//! Reads the materials of an MTL file, and repairs common faults of exporters.
//!
//! A faulty file must not prevent the model from being shown: faults are listed, and the rest is
//! used. Statements are therefore passed to tobj one by one ([`statement`]); if it rejects one, the
//! others are unaffected.

mod environment;
mod map;
mod mend;
mod normal_map;
mod statement;
mod statements;
mod tone;
mod undrawn;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use self::map::Map;
use self::mend::scale_bytes;
use self::normal_map::shows_normals;
pub(super) use self::statements::map_names;
use self::statements::{Statements, read_statements};
use self::tone::{Channel, Tone};
use super::error::{LFS_POINTER, LoadError, short_name, shown};
use super::findings::{Finding, FindingKind, Findings, joined};
use super::locate::Locator;
use super::progress::Progress;
use super::read::{MOST_WORDS, is_binary, is_utf_16, read, utf_8};
use super::texture::{Pictures, Read};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Picture;
use marraztu_core::scene::{
    BumpMaps, FileMaterial, MapKind, NONE, Panorama, Reflection, SurfaceMap, SurfaceMaps, Texture,
    Transmission, UndrawnMap, Wrap,
};

/// The most texels of all textures of a model: 2 GB.
const MOST_TEXELS: usize = 1 << 29;

/// The number of different textures that are searched for: each takes several disk accesses.
const MOST_NAMES: usize = 10_000;

/// The materials of all MTL files of a model, in order.
#[derive(Debug)]
pub(super) struct Library<'a> {
    materials: Vec<FileMaterial>,
    /// The origin of each of `materials`.
    origins: Vec<Origin>,
    /// The findings of each file.
    findings: Vec<Findings>,
    pub(super) locator: Locator,
    /// The index of each name in `materials`.
    places: BTreeMap<String, u32>,
    /// The files that were read.
    read: BTreeSet<PathBuf>,
    pictures: &'a mut Pictures,
    /// The interpretation of bump maps.
    bumps: BumpMaps,
    /// The files that `texels` includes.
    counted: BTreeSet<PathBuf>,
    texels: usize,
    /// The reflection maps, by the paths of their pictures.
    environments: BTreeMap<Vec<PathBuf>, Result<Shared<Panorama>, LoadError>>,
    /// The paths of textures, by the folder of the MTL file and the name in it.
    found: BTreeMap<(PathBuf, String), Option<PathBuf>>,
    /// Textures by path and options: equal textures are shared.
    textures: BTreeMap<TextureKey, Shared<Texture>>,
}

/// The path of a texture, its wrapping, the bits of its offset and scale, and its tone.
type TextureKey = (PathBuf, bool, [u64; 4], ([u64; 2], Option<Channel>));

/// The origin of a material.
#[derive(Debug)]
struct Origin {
    /// The index of the file's findings.
    file: usize,
    line: u32,
    /// Whether this program has written the file.
    is_own: bool,
}

impl<'a> Library<'a> {
    /// Creates a library without materials that loads textures through `pictures`.
    pub(super) fn new(pictures: &'a mut Pictures, bumps: BumpMaps) -> Self {
        Self {
            materials: Vec::new(),
            origins: Vec::new(),
            findings: Vec::new(),
            locator: Locator::default(),
            places: BTreeMap::new(),
            read: BTreeSet::new(),
            pictures,
            bumps,
            counted: BTreeSet::new(),
            texels: 0,
            found: BTreeMap::new(),
            textures: BTreeMap::new(),
            environments: BTreeMap::new(),
        }
    }

    /// Reads one file, unless it was read before. Textures are searched for in its folder, then in
    /// the model's.
    pub(super) fn read(&mut self, path: &Path, model_folder: &Path) {
        if !self.read.insert(path.to_owned()) {
            return;
        }
        let mut findings = Findings::new(&shown(path));
        match read(path, MOST_WORDS, &Progress::new()) {
            Ok(bytes) if !is_utf_16(&bytes) && is_binary(&bytes) => {
                findings.add(FindingKind::MtlUnreadable, "this is not text", None);
            }
            Ok(bytes) => {
                let folders = [path.parent().unwrap_or(Path::new("")), model_folder];
                let mut materials = read_statements(&utf_8(bytes), &mut findings);
                scale_bytes(&mut materials, &mut findings);
                for statements in materials {
                    self.add(statements, folders, &mut findings);
                }
            }
            Err(LoadError::File { reason, .. }) => {
                findings.add(FindingKind::MtlUnreadable, &reason, None);
            }
            Err(error) => findings.add(FindingKind::MtlUnreadable, &error.to_string(), None),
        }
        self.findings.push(findings);
    }

    /// Returns whether a file was read.
    pub(super) fn has_read(&self, path: &Path) -> bool {
        self.read.contains(path)
    }

    /// Returns the number of materials.
    pub(super) fn count(&self) -> usize {
        self.materials.len()
    }

    /// Returns the index of the material with this name.
    pub(super) fn place(&self, name: &str) -> Option<u32> {
        self.places.get(name).copied()
    }

    /// Returns the files that were read: MTL files and their textures.
    pub(super) fn files(&self) -> Vec<PathBuf> {
        let textures: BTreeSet<&PathBuf> = self.found.values().flatten().collect();
        self.read.iter().chain(textures).cloned().collect()
    }

    /// Returns the materials and all findings. `used` are the indices of the materials that the
    /// model uses.
    ///
    /// Some programs write `Tr 1` or `d 0` for opaque materials. Both are ignored if they would
    /// hide every used material.
    pub(super) fn finish(mut self, used: &BTreeSet<u32>) -> (Vec<FileMaterial>, Vec<Finding>) {
        // Glass is seen all the same.
        let is_clear = |it: &FileMaterial| it.material.optics.transmission == Transmission::Opacity;
        let is_hidden = |place: &u32| {
            let place = *place as usize;
            let material = &self.materials[place];
            material.opacity == 0.0 && !is_clear(material) && !self.origins[place].is_own
        };
        let hides_all = !used.is_empty() && used.iter().all(is_hidden);
        for (material, origin) in self.materials.iter_mut().zip(&self.origins) {
            if material.opacity != 0.0 || is_clear(material) {
                continue;
            }
            let kind = if hides_all && !origin.is_own {
                material.opacity = 1.0;
                FindingKind::MendedTransparency
            } else {
                FindingKind::Transparent
            };
            self.findings[origin.file].add(kind, &material.name, Some(origin.line));
        }
        let findings = self.findings.into_iter().flat_map(Findings::into_list).collect();
        (self.materials, joined(findings))
    }

    fn add(&mut self, mut statements: Statements, folders: [&Path; 2], findings: &mut Findings) {
        if self.place(&statements.name).is_some() {
            findings.add(FindingKind::MaterialTwice, &statements.name, Some(statements.line));
            return;
        }
        // A packed Ks holds occlusion, roughness and metalness, so its map is not a specular map.
        if statements.is_packed
            && let Some((line, map)) = statements.maps.remove(&MapKind::Specular)
        {
            statements.keep_packed_map(&map);
            findings.add(FindingKind::MapUnused, "map_Ks", Some(line));
        }
        statements.unpack();
        statements.keep_one_relief();
        statements.settle_displacement(findings);
        let mut read = |(line, map): &(u32, Map), kind: Option<MapKind>| {
            for option in &map.ignored {
                findings.add(FindingKind::MapOption, option, Some(*line));
            }
            let note = &mut |kind, name: &str| findings.add(kind, name, Some(*line));
            self.texture((map, map.tone.of(kind)), folders, note)
        };
        let texture = statements.map.as_ref().and_then(|map| read(map, None));
        let maps = statements.maps.iter().filter_map(|(kind, map)| {
            let (texture, gain) = (read(map, Some(*kind))?, map.1.gain);
            Some((*kind, SurfaceMap { texture, gain }))
        });
        let mut maps: SurfaceMaps = maps.collect();
        self.settle_bumps(&mut maps, &statements, findings);
        statements.settle_opacity(texture.as_deref(), &mut maps, findings);
        let place = u32::try_from(self.materials.len()).unwrap_or(NONE);
        self.places.insert(statements.name.clone(), place);
        self.origins.push(Origin {
            file: self.findings.len(),
            line: statements.line,
            is_own: statements.is_own,
        });
        let environment = self.environment(&statements, folders, findings);
        let undrawn_maps = self.undrawn_maps(&statements.undrawn_maps, folders);
        let mut material = statements.mended((texture, maps), findings);
        // `illum` 8 and 9 mirror nothing but a picture.
        if environment.as_ref().is_some_and(|it| it.is_alone) {
            material.material.optics.reflection = Reflection::Constant;
        }
        self.materials.push(FileMaterial { environment, undrawn_maps, ..material });
    }

    /// Reads a bump map that contains normals as a normal map, since Blender and others write it
    /// so. A map that the file declares as a normal map has precedence.
    fn settle_bumps(
        &self,
        maps: &mut SurfaceMaps,
        statements: &Statements,
        findings: &mut Findings,
    ) {
        let Some(bump) = maps.get(&MapKind::Bump) else { return };
        // The option overrides the detection.
        let has_normals = match self.bumps {
            BumpMaps::Auto => shows_normals(&bump.texture.picture),
            BumpMaps::Heights => false,
            BumpMaps::Normals => true,
        };
        if !has_normals {
            return;
        }
        if self.bumps == BumpMaps::Auto && !maps.contains_key(&MapKind::Normal) {
            let line = statements.maps.get(&MapKind::Bump).map(|(line, _)| *line);
            findings.add(FindingKind::BumpIsNormals, &short_name(&bump.texture.source), line);
        }
        if let Some(bump) = maps.remove(&MapKind::Bump) {
            maps.entry(MapKind::Normal).or_insert(bump);
        }
    }

    fn texture(
        &mut self,
        (map, tone): (&Map, Tone),
        folders: [&Path; 2],
        note: &mut dyn FnMut(FindingKind, &str),
    ) -> Option<Shared<Texture>> {
        let path = match self.located(&map.name, folders) {
            Ok(path) => path,
            Err(kind) => {
                note(kind, if kind == FindingKind::TextureMissing { &map.name } else { "" });
                return None;
            }
        };
        // Maps with equal files and layouts share a texture.
        let bits = [map.offset, map.scale].concat();
        let bits = std::array::from_fn(|i| bits[i].to_bits());
        let key = (path.clone(), map.wrap == Wrap::Clamp, bits, tone.key());
        if let Some(texture) = self.textures.get(&key) {
            return Some(texture.clone());
        }
        let picture = self.picture(&path, note)?;
        let picture = tone.applied(&picture).map_or(picture, Shared::new);
        let &Map { wrap, offset, scale, .. } = map;
        let texture = Shared::new(Texture { source: path, picture, wrap, offset, scale });
        self.textures.insert(key, texture.clone());
        Some(texture)
    }

    /// Searches for the file of a map; fails with the finding about it. Searches are cached and
    /// limited, because each takes several disk accesses.
    fn located(&mut self, name: &str, folders: [&Path; 2]) -> Result<PathBuf, FindingKind> {
        let key = (folders[0].to_owned(), name.to_owned());
        if self.found.len() >= MOST_NAMES && !self.found.contains_key(&key) {
            return Err(FindingKind::TextureMany);
        }
        let mut locate = |folder| self.locator.locate(folder, name);
        let path =
            self.found.entry(key).or_insert_with(|| folders.into_iter().find_map(&mut locate));
        path.clone().ok_or(FindingKind::TextureMissing)
    }

    /// Finds the files of maps that are not drawn. A missing file keeps its name.
    fn undrawn_maps(&mut self, maps: &[(String, Map)], folders: [&Path; 2]) -> Vec<UndrawnMap> {
        let found = |(keyword, map): &(String, Map)| {
            let missing = |_| folders[0].join(&map.name);
            let source = self.located(&map.name, folders).unwrap_or_else(missing);
            let Map { wrap, offset, scale, .. } = *map;
            UndrawnMap {
                keyword: keyword.clone(),
                options: map.options.clone(),
                source,
                wrap,
                offset,
                scale,
            }
        };
        maps.iter().map(found).collect()
    }

    /// Decodes the picture of a file, unless it exceeds [`MOST_TEXELS`] together with earlier ones.
    fn picture(
        &mut self,
        path: &Path,
        note: &mut dyn FnMut(FindingKind, &str),
    ) -> Option<Shared<Picture>> {
        let counted = self.counted.contains(path);
        // A picture counts once, in whatever number of textures it appears.
        let most = if counted { MOST_TEXELS } else { MOST_TEXELS - self.texels };
        match self.pictures.read(path, most) {
            Ok(Read { picture, cut_off }) => {
                if !counted {
                    self.counted.insert(path.to_owned());
                    self.texels += picture.size().area();
                }
                if cut_off {
                    note(FindingKind::TextureCutOff, &shown(path));
                }
                Some(picture)
            }
            Err(LoadError::File { file, reason }) if reason == LFS_POINTER => {
                note(FindingKind::TexturePointer, &file);
                None
            }
            Err(error) => {
                note(FindingKind::TextureUnreadable, &error.to_string());
                None
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mark::SIGNATURE;
    use marraztu_core::scene::Material;

    fn read(text: &str) -> (FileMaterial, Vec<FindingKind>) {
        let mut findings = Findings::new("a.mtl");
        let mut pictures = Pictures::default();
        let mut library = Library::new(&mut pictures, BumpMaps::Auto);
        for statements in read_statements(text.as_bytes(), &mut findings) {
            library.add(statements, [Path::new("nowhere"); 2], &mut findings);
        }
        library.findings.push(findings);
        let (mut materials, findings) = library.finish(&BTreeSet::from([0]));
        (materials.remove(0), findings.into_iter().map(|finding| finding.kind).collect())
    }

    #[test]
    fn values_of_our_own_exports_are_kept_where_those_of_others_are_mended() {
        let text = "newmtl a\nKa 1 1 1\nKd 0 0 0\nKs .4 .4 .4\nNs 0.5\n";
        let (other, findings) = read(text);
        assert_ne!((other.material.ambient, other.material.exponent), ([1.0; 3], 0.5));
        assert!(!findings.is_empty());
        let (own, findings) = read(&format!("{SIGNATURE}{text}"));
        assert_eq!((own.material.ambient, own.material.exponent), ([1.0; 3], 0.5));
        assert_eq!(findings, []);
    }

    #[test]
    fn a_sound_material_is_taken_as_it_is() {
        let (red, findings) =
            read("newmtl red\nKa .1 0 0\nKd 0.5 0 0\nKs 1 1 1\nNs 20\nd 1\nillum 2\n");
        assert_eq!(findings, []);
        assert_eq!(red.name, "red");
        let Material { ambient, diffuse, specular, exponent, .. } = red.material;
        assert_eq!([ambient, diffuse, specular], [[0.1, 0.0, 0.0], [0.5, 0.0, 0.0], [1.0; 3]]);
        assert_eq!((exponent, red.opacity), (20.0, 1.0));
    }

    #[test]
    fn each_nonsense_is_mended_by_its_rule_and_listed() {
        use FindingKind::*;
        type Row = (&'static str, FindingKind, fn(&FileMaterial) -> bool);
        let rows: [Row; 16] = [
            ("Ka 0 0 0\nKd 1 1 1\nPr 0.5\nPm 1", MendedRough, |m| {
                // Blinn's exponent is 2 / 0.5^4 - 2 = 30.
                (m.material.specular, m.material.exponent) == ([1.0; 3], 7.5)
            }),
            ("Kd .5 .5 .5\nKs 0 0 0", MendedAmbient, |m| m.material.ambient == [0.1; 3]),
            ("Ka 1 1 1\nKd .5 .5 .5\nKs 0 0 0", MendedAmbient, |m| m.material.ambient == [0.1; 3]),
            ("Ka .5 0 0\nKd .5 0 0\nKs 0 0 0", MendedAmbient, |m| {
                m.material.ambient == [0.1, 0.0, 0.0]
            }),
            ("Ka 0 0 7\nKd .5 .5 .5\nKs 0 0 0", MendedAmbient, |m| m.material.ambient == [0.1; 3]),
            ("Ka 0 0 0\nKs 0 0 0", MendedDiffuse, |m| m.material.diffuse == [0.8; 3]),
            ("Ka 0 0 0\nKd 1 1 1", MendedSpecular, |m| m.material.specular == [0.0; 3]),
            ("Ka 0 0 0\nKd 1 1 1\nKs 1 1 1\nillum 1\nNs 9", MendedSpecular, |m| {
                m.material.specular == [0.0; 3]
            }),
            ("Ka 0 0 0\nKd 1 1 1\nKs 1 1 1\nNs .5", MendedExponent, |m| m.material.exponent == 1.0),
            ("Ka 0 0 0\nKd 1 1 1\nKs 1 1 1\nNs 0", MendedMatt, |m| m.material.specular == [0.0; 3]),
            ("Ka 0 0 0\nKd 1 1 1\nKs 1 1 1", MendedMatt, |m| m.material.specular == [0.0; 3]),
            ("Ka 0 0 0\nKd 1 -1 9\nKs 0 0 0", MendedRange, |m| {
                m.material.diffuse == [1.0, 0.0, 1.0]
            }),
            ("Ka 0 0 0\nKd 1 1 1\nKs 0 0 0\nd 0", MendedTransparency, |m| m.opacity == 1.0),
            ("Ka 0 0 0\nKd 1 1 1\nKs 0 0 0\nd 0\nTr 0", MendedContradiction, |m| m.opacity == 1.0),
            ("Ka 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 0.0", MendedConstant, |m| !m.unlit),
            ("Ka 0 0 0\nKd 1 1 1\nKs 0 0 0\nmap_Kd -o 1 1 1", MapUnnamed, |m| m.texture.is_none()),
        ];
        for (text, opacity) in [("Tr 0.75", 0.25), ("d 0.75", 0.75), ("d 0.01\nTr 0.5", 0.01)] {
            let (material, findings) =
                read(&format!("newmtl m\nKa 0 0 0\nKd 0.5\nKs 0 0 0\n{text}"));
            assert_eq!((material.opacity, findings), (opacity, Vec::new()), "{text}");
            assert_eq!(material.material.diffuse, [0.5; 3]);
        }
        for (text, kind, right) in rows {
            let (material, findings) = read(&format!("newmtl m\n{text}\n"));
            assert_eq!(findings, [kind], "{text}");
            assert!(right(&material), "{text}: {material:?}");
        }
    }

    #[test]
    fn a_metal_of_blender_mirrors_in_its_own_colour() {
        let text = "newmtl gold\nNs 250\nKa 0.75 0.75 0.75\nKd 1 0.75 0.25\nKs 0.5 0.5 0.5\n\
                    Ke 0 0 0\nNi 1.45\nd 1\nillum 3\n";
        let (gold, findings) = read(&format!("# Blender 3.6.2 MTL File: 'a.blend'\n{text}"));
        assert_eq!(findings, [FindingKind::MendedMetal]);
        assert_eq!(gold.material.specular, [0.875, 0.6875, 0.3125]);
        assert_eq!(gold.material.ambient, gold.material.diffuse.map(|x| 0.2 * x));
        // Elsewhere, Ka and Ks are what they say.
        let (other, _) = read(text);
        assert_eq!(other.material.specular, [0.5; 3]);
    }

    /// Kd and Ks of all materials after bytes are scaled, and the number of materials with bytes.
    fn scaled(text: &str) -> (Vec<[f64; 3]>, usize) {
        let mut findings = Findings::new("a.mtl");
        let mut materials = read_statements(text.as_bytes(), &mut findings);
        scale_bytes(&mut materials, &mut findings);
        let colors = materials.iter().flat_map(|it| [it.diffuse, it.specular]).flatten();
        (colors.collect(), findings.into_list().iter().map(|finding| finding.count).sum())
    }

    #[test]
    fn whole_numbers_above_16_are_bytes_and_other_colors_above_1_are_clamped() {
        let bytes = "newmtl a\nKd 255 51 0\nKs 0 51 0\nnewmtl b\nKd 3 0 0\n";
        assert_eq!(
            scaled(bytes),
            (vec![[1.0, 0.2, 0.0], [0.0, 0.2, 0.0], [3.0 / 255.0, 0.0, 0.0]], 2)
        );
        assert_eq!(scaled("newmtl a\nKd 51 51 51\nnewmtl b\nKd 0 0 0\n").0[0], [0.2; 3]);
        for bright in [
            "newmtl a\nKd 2 1 0\n",
            "newmtl a\nKd 40.5 0 0\n",
            "newmtl a\nKd 16 16 16\n",
            "newmtl a\nKd 780 780 780\n",
            "newmtl light\nKa 20 20 20\nKd 1 1 1\nnewmtl red\nKd 1 0 0\n",
        ] {
            assert_eq!(scaled(bright).1, 0, "{bright}");
        }
    }

    #[test]
    fn a_lamp_changes_no_other_material_and_bytes_leave_colours_up_to_1() {
        for lamp in ["30 27 11", "50 50 50", "17 12 4", "400 400 400"] {
            for other in ["1 1 1", "1 0 0", "0.8 0.8 0.8"] {
                let text = format!("newmtl a\nKd {other}\nnewmtl l\nKd {lamp}\n");
                assert_eq!(scaled(&text).1, 0, "{text}");
            }
        }
        let white = scaled("newmtl a\nKd 255 102 0\nnewmtl b\nKd 1 1 1\nKs 1 0 0\n");
        assert_eq!(white, (vec![[1.0, 0.4, 0.0], [1.0; 3], [1.0, 0.0, 0.0]], 1));
        let dull = scaled("newmtl a\nKd 51 51 51\nKs 0.5 0.5 0.5\n");
        assert_eq!(dull, (vec![[0.2; 3], [0.5; 3]], 1));
        // One lamp above 255 does not turn the other colours white.
        let lit = scaled("newmtl a\nKd 204 102 51\nnewmtl l\nKd 500 500 500\n");
        assert_eq!(lit, (vec![[0.8, 0.4, 0.2], [500.0; 3]], 1));
    }

    #[test]
    fn an_opacity_of_0_next_to_a_map_of_opacity_is_1() {
        let (material, findings) = read("newmtl m\nKa 0 0 0\nKd 1\nKs 0 0 0\nd 0\nmap_d a.png\n");
        assert_eq!(material.opacity, 1.0);
        assert_eq!(findings, [FindingKind::MendedDissolve, FindingKind::TextureMissing]);
        let (material, _) = read("newmtl m\nKa 0 0 0\nKd 1\nKs 0 0 0\nd 0.5\nmap_d a.png\n");
        assert_eq!(material.opacity, 0.5);
    }

    #[test]
    fn tr_of_meshlab_is_the_opacity_and_a_halo_is_told() {
        let text = "newmtl m\nKa 0 0 0\nKd 1\nKs 0 0 0\nTr 0.75\n";
        assert_eq!(read(text).0.opacity, 0.25);
        let head = "#\n# Wavefront material file\n# Converted by Meshlab Group\n#\n\n";
        assert_eq!(read(&format!("{head}{text}")).0.opacity, 0.75);
        let (material, findings) = read("newmtl m\nKa 0 0 0\nKd 1\nKs 0 0 0\nd -halo 0.5\n");
        assert_eq!((material.opacity, findings), (0.5, vec![FindingKind::HaloEven]));
    }

    #[test]
    fn glass_with_d_0_is_seen_and_a_spectrum_is_told() {
        let glass = "newmtl m\nKa 0 0 0\nKd 0\nKs 0 0 0\nillum 7\nNi 1.5\n";
        let (material, findings) = read(&format!("{glass}d 0\n"));
        assert_eq!(material.material.optics.transmission, Transmission::Opacity);
        assert!(!findings.contains(&FindingKind::Transparent), "{findings:?}");
        assert!(!findings.contains(&FindingKind::MendedTransparency), "{findings:?}");
        let (_, findings) = read(&format!("{glass}Tf xyz 0.5 0.2 0.1\n"));
        assert!(findings.contains(&FindingKind::MtlNumber), "{findings:?}");
    }

    #[test]
    fn packed_roughness_and_metalness_do_not_colour_highlights() {
        let packed = |ks| {
            let text = format!("newmtl m\nbsdf pbr\nKa 0 0 0\nKd .5 .25 1\nKs {ks}\n");
            let (material, findings) = read(&text);
            assert_eq!(findings, [FindingKind::MendedPacked], "{ks}");
            let Material { diffuse, specular, exponent, .. } = material.material;
            assert_eq!(diffuse, [0.5, 0.25, 1.0]);
            (specular, exponent)
        };
        assert_eq!(packed("0 1 0"), ([0.04; 3], 1.0), "rough");
        assert_eq!(packed("0 1 1"), ([0.5, 0.25, 1.0], 1.0), "rough metal");
        assert_eq!(packed("0 .5 0"), ([0.04 * 38.0 / 8.0; 3], 7.5), "2 / 0.25^2 - 2 = 30");
        assert_eq!(packed("0 .25 0"), ([1.0; 3], 127.5), "smooth");
        assert_eq!(packed("0 0 0"), ([1.0; 3], 1000.0), "a mirror has some width");
        let (material, findings) =
            read("newmtl m\nbsdf pbr\nKa 0 0 0\nKd 1 1 1\nKs 0 1 0\nNs 9\nmap_Ks t.png\n");
        assert_eq!(material.material.exponent, 9.0, "as the file says");
        assert_eq!(findings, [FindingKind::MendedPacked, FindingKind::MapUnused]);
        let (material, _) = read("newmtl m\nbsdf pbr\nKa 0 0 0\nKd 1 1 1\n");
        assert_eq!(material.material.specular, [0.0; 3], "nothing is packed");
    }

    #[test]
    fn numbers_keep_more_digits_than_an_f32_has() {
        let (material, _) = read(
            "newmtl m\nKd 0.5882352941176471 0.1 1e-50\nKs 1 1 1\n\
             Ns 96.078431\nd 0.3333333333333333\n",
        );
        assert_eq!(material.material.diffuse, [150.0 / 255.0, 0.1, 1e-50]);
        assert_eq!((material.material.exponent, material.opacity), (96.078431, 1.0 / 3.0));
    }

    #[test]
    fn statements_that_stop_tobj_cost_no_other() {
        // It panics on one or two numbers, and rejects fractions for illum and numbers followed by
        // comments.
        let (material, findings) = read(
            "newmtl m\nKa 0 0 0\nkd 0.5\nKd 0.1 0.2\nKs 1 1 1#x\n\
             illum 1.0\nillum 2.5\nNs\nns 9 # x\nD -halo 1\n",
        );
        let Material { diffuse, specular, exponent, .. } = material.material;
        assert_eq!((diffuse, specular, exponent), ([0.5; 3], [1.0; 3], 9.0));
        assert_eq!(
            findings,
            [FindingKind::MtlNumber, FindingKind::Illumination, FindingKind::HaloEven]
        );
    }

    #[test]
    fn a_texture_without_a_diffuse_colour_is_shown_in_its_own() {
        let (material, findings) = read("newmtl m\nKa 0 0 0\nKs 0 0 0\nmap_Kd t.png\n");
        assert_eq!(material.material.diffuse, [1.0; 3]);
        assert_eq!(findings, [FindingKind::MendedDiffuse, FindingKind::TextureMissing]);
    }

    #[test]
    fn numbers_that_cannot_be_read_and_stray_statements_are_listed() {
        let (_, findings) =
            read("Kd 1 1 1\nnewmtl m\nKa 0 0 0\nKd 1 1 1\nKs 0..5 0 0\nKs 0 0 0\nbsdf new\n");
        assert_eq!(findings, [FindingKind::Unknown, FindingKind::MtlStray, FindingKind::MtlNumber]);
    }
}
