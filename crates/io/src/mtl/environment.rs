//! Reflection maps: `refl` with one picture, or with the six of a cube.

use std::path::{Path, PathBuf};

use super::Library;
use super::statements::Statements;
use crate::findings::{FindingKind, Findings};
use crate::panorama::{CUBE, load_panorama, panorama_of_cube};
use marraztu_core::base::Shared;
use marraztu_core::scene::{Environment, Panorama};

impl Library<'_> {
    /// Returns what a material mirrors in place of the background, if it asks for that: `illum` 3
    /// to 9 with `refl`.
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
        let maps: Vec<_> = match is_cube {
            true => CUBE.into_iter().map(named).collect::<Option<_>>().unwrap_or_default(),
            false => vec![first],
        };
        if maps.is_empty() {
            note(FindingKind::MapUnused, "refl");
            return None;
        }
        let mut paths = Vec::new();
        for map in maps {
            match self.located(&map.name, folders) {
                Ok(path) => paths.push(path),
                Err(kind) => {
                    note(kind, &map.name);
                    return None;
                }
            }
        }
        let panorama = match self.environments.get(&paths) {
            Some(known) => known.clone(),
            None => match self.read_environment(&paths) {
                Ok(panorama) => panorama,
                Err(error) => {
                    note(FindingKind::TextureUnreadable, &error.to_string());
                    return None;
                }
            },
        };
        self.environments.insert(paths, panorama.clone());
        Some(Environment { panorama, is_alone: model >= 8.0 })
    }

    fn read_environment(
        &mut self,
        paths: &[PathBuf],
    ) -> Result<Shared<Panorama>, crate::error::LoadError> {
        if let [path] = paths {
            return load_panorama(path).map(Shared::new);
        }
        let most = super::MOST_TEXELS - self.texels;
        let faces =
            paths.iter().map(|path| self.pictures.read(path, most).map(|read| read.picture));
        let faces: Vec<_> = faces.collect::<Result<_, _>>()?;
        Ok(panorama_of_cube(&paths[0], &faces).into())
    }
}
