//! Reflection maps: `refl` with one picture, or with the six of a cube.

use std::path::{Path, PathBuf};

use super::statements::Statements;
use super::{Library, MOST_TEXELS};
use crate::error::LoadError;
use crate::findings::{FindingKind, Findings};
use crate::panorama::{CUBE, load_panorama_within, panorama_of_cube};
use marraztu_core::base::Shared;
use marraztu_core::scene::{Environment, Panorama};

impl Library<'_> {
    /// Returns the surroundings of a material with `refl`, if it mirrors: `illum` 3 to 9.
    pub(super) fn environment(
        &mut self,
        statements: &Statements,
        folders: [&Path; 2],
        findings: &mut Findings,
    ) -> Option<Environment> {
        let (line, first) = statements.reflection_maps.first()?;
        let mut note = |kind, text: &str| findings.add(kind, text, Some(*line));
        let model = statements.illumination.filter(|model| (3.0..=9.0).contains(model));
        let Some(model) = model else {
            note(FindingKind::MapUnused, "refl");
            return None;
        };
        let named = |shape: &str| {
            let mut all = statements.reflection_maps.iter().map(|(_, map)| map);
            all.rfind(|map| map.shape.as_deref() == Some(shape))
        };
        let is_cube = first.shape.as_deref().is_some_and(|shape| CUBE.contains(&shape));
        let maps: Option<Vec<_>> =
            if is_cube { CUBE.into_iter().map(named).collect() } else { Some(vec![first]) };
        let Some(maps) = maps else {
            note(FindingKind::MapUnused, "refl: a cube needs six pictures");
            return None;
        };
        if maps.iter().any(|map| map.changes_texels()) {
            note(FindingKind::MapOption, "refl");
        }
        let mut paths = Vec::new();
        for map in maps {
            match self.located(&map.name, folders) {
                Ok(path) => paths.push(path),
                Err(kind) => {
                    note(kind, if kind == FindingKind::TextureMissing { &map.name } else { "" });
                    return None;
                }
            }
        }
        let known = self.environments.get(&paths).cloned();
        let panorama = known.unwrap_or_else(|| self.read_environment(&paths));
        self.environments.insert(paths, panorama.clone());
        match panorama {
            Ok(panorama) => Some(Environment { panorama, is_alone: model >= 8.0 }),
            Err(error) => {
                note(FindingKind::TextureUnreadable, &error.to_string());
                None
            }
        }
    }

    /// Reads the picture or the cube of a reflection map, within the limit of all textures.
    fn read_environment(&mut self, paths: &[PathBuf]) -> Result<Shared<Panorama>, LoadError> {
        let most = MOST_TEXELS - self.texels;
        let panorama = match paths {
            // Light takes three times the memory of a texel.
            [path] => load_panorama_within(path, most / 3)?,
            _ => {
                let faces = paths.iter().map(|path| self.pictures.read(path, most));
                let faces: Vec<_> = faces.collect::<Result<_, _>>()?;
                let faces: Vec<_> = faces.into_iter().map(|read| read.picture).collect();
                panorama_of_cube(&paths[0], &faces)
            }
        };
        self.texels = (self.texels + 3 * panorama.size().area()).min(MOST_TEXELS);
        Ok(panorama.into())
    }
}
