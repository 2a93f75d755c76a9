//! The models and textures that a scene file names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::format::{FileModel, FileScene, FileTexture};
use super::save::{file_model, file_texture};
use super::{SceneFileError, open, paths};
use crate::base::Shared;
use crate::base::image::{Picture, Size};
use crate::io::examples;
use crate::io::findings::Finding;
use crate::io::obj::load_with;
use crate::io::progress::Progress;
use crate::io::texture::Pictures;
use crate::scene::{BumpMaps, Crease, LoadOptions, Model, Scale, Scene, Texture, UpAxis, Winding};

/// The identity of a model in a scene file: its name or path, and how it is read. The crease angle
/// comes last, so that files that differ only in it are neighbours.
type ModelKey = (String, Option<(UpAxis, u64, Winding, BumpMaps, u64)>);

fn key(model: &FileModel) -> ModelKey {
    match model {
        FileModel::Own(name) => (name.clone(), None),
        FileModel::File { path, up, scale, winding, crease, bumps } => {
            (path.clone(), Some((*up, scale.to_bits(), *winding, *bumps, crease.to_bits())))
        }
    }
}

/// The models and textures of a scene, which need not be read again.
#[derive(Debug, Default)]
pub struct Known {
    models: Vec<Shared<Model>>,
    textures: Vec<Shared<Texture>>,
}

impl Known {
    /// Those of this scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        let objects = || scene.objects.iter().map(|(_, object)| object);
        let cameras = scene.cameras.iter().map(|(_, camera)| camera.model.clone());
        Self {
            models: objects().map(|object| object.model.clone()).chain(cameras).collect(),
            textures: objects().filter_map(|object| object.texture.clone()).collect(),
        }
    }
}

/// The models and textures that a scene file names, loaded.
pub(super) struct Files<'a> {
    folder: PathBuf,
    relocated: &'a BTreeMap<PathBuf, PathBuf>,
    models: BTreeMap<ModelKey, Shared<Model>>,
    textures: BTreeMap<String, Shared<Texture>>,
    /// Those of models and of textures: one file may be both.
    pictures: Pictures,
    pub(super) findings: Vec<Finding>,
}

impl<'a> Files<'a> {
    pub(super) fn new(folder: PathBuf, relocated: &'a BTreeMap<PathBuf, PathBuf>) -> Self {
        let (models, textures) = (BTreeMap::new(), BTreeMap::new());
        let pictures = Pictures::default();
        Self { folder, relocated, models, textures, pictures, findings: Vec::new() }
    }

    /// Takes models and textures that need not be read. A file name that is not text is skipped: no
    /// scene file can contain it.
    pub(super) fn know(&mut self, known: &Known) {
        let nowhere = Path::new("");
        for model in &known.models {
            if let Ok(named) = file_model(model, nowhere) {
                self.models.insert(key(&named), model.clone());
            }
        }
        for texture in &known.textures {
            if let Ok(named) = file_texture(texture, nowhere) {
                self.textures.insert(named.path, texture.clone());
            }
        }
    }

    /// The path of a file that the scene file names.
    fn place(&self, path: &str) -> PathBuf {
        if examples::is_example(Path::new(path)) {
            return PathBuf::from(path);
        }
        let place = paths::plain(&self.folder.join(path));
        self.relocated.get(&place).cloned().unwrap_or(place)
    }

    pub(super) fn load(
        &mut self,
        file: &FileScene,
        name: &str,
        progress: &Progress,
    ) -> Result<(), SceneFileError> {
        let of_objects = file.objects.iter().map(|object| &object.model);
        let all = of_objects.chain(file.cameras.iter().map(|camera| &camera.model));
        let mut keys = BTreeSet::new();
        let is_new = |model: &&FileModel| !self.models.contains_key(&key(model));
        let models: Vec<&FileModel> =
            all.filter(is_new).filter(|model| keys.insert(key(model))).collect();
        let textures: BTreeSet<&str> = file
            .objects
            .iter()
            .filter_map(|object| object.texture.as_ref())
            .map(|texture| texture.path.as_str())
            .filter(|path| !self.textures.contains_key(*path))
            .collect();
        self.refuse_missing(&models, &textures, name)?;
        for (i, model) in models.iter().enumerate() {
            let (from, to) = (share(i, models.len()), share(i + 1, models.len()));
            let loaded = self.load_model(model, name, &progress.part(from, to))?;
            self.models.insert(key(model), loaded);
        }
        for path in textures {
            let texture = match crate::io::own_texture(path) {
                Some(own) => own,
                None => {
                    let place = self.place(path);
                    match examples::content(&place) {
                        Some(content) => examples::texture(&place, content)?,
                        None => self.pictures.texture(&place, &mut self.findings)?,
                    }
                }
            };
            self.textures.insert(path.to_owned(), texture);
        }
        Ok(())
    }

    fn refuse_missing(
        &self,
        models: &[&FileModel],
        textures: &BTreeSet<&str>,
        name: &str,
    ) -> Result<(), SceneFileError> {
        let of_models = models.iter().filter_map(|model| match model {
            FileModel::File { path, .. } => Some(path.as_str()),
            FileModel::Own(_) => None,
        });
        let mut missing: Vec<PathBuf> = of_models
            .chain(textures.iter().copied().filter(|path| crate::io::own_texture(path).is_none()))
            .map(|path| self.place(path))
            .filter(|place| examples::content(place).is_none() && !place.exists())
            .collect();
        missing.sort();
        missing.dedup();
        if missing.is_empty() {
            return Ok(());
        }
        Err(SceneFileError::Missing { file: name.to_owned(), missing })
    }

    /// The same file, loaded with another crease angle: it is not read twice.
    fn with_other_crease(&self, model: &FileModel) -> Option<&Shared<Model>> {
        let (path, options) = key(model);
        let (up, scale, winding, bumps, _) = options?;
        let with = |crease| (path.clone(), Some((up, scale, winding, bumps, crease)));
        let mut others = self.models.range(with(0)..=with(u64::MAX));
        others.next().map(|(_, loaded)| loaded)
    }

    fn load_model(
        &mut self,
        model: &FileModel,
        name: &str,
        progress: &Progress,
    ) -> Result<Shared<Model>, SceneFileError> {
        let fail = |reason: String| SceneFileError::File { file: name.to_owned(), reason };
        match model {
            FileModel::Own(own) => crate::io::own_model(own)
                .ok_or_else(|| fail(format!("there is no built-in model \"{own}\""))),
            FileModel::File { path, up, scale, winding, crease, bumps } => {
                let scale = Scale::new(*scale)
                    .ok_or_else(|| fail(format!("the scale of {path} has to be above 0")))?;
                let crease = Crease::new(*crease).ok_or_else(|| {
                    fail(format!("the crease angle of {path} has to be from 0 to 180 degrees"))
                })?;
                if let Some(other) = self.with_other_crease(model) {
                    return Ok(Shared::new(other.with_crease(crease)));
                }
                let options =
                    LoadOptions { up: *up, scale, winding: *winding, crease, bumps: *bumps };
                let place = self.place(path);
                let loaded = match examples::content(&place) {
                    Some(content) => examples::model(&place, content, &options, progress)?,
                    None => load_with(&place, &options, &mut self.pictures, progress)?,
                };
                self.findings.extend(loaded.findings);
                Ok(Shared::new(loaded.model))
            }
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "for the eye")]
fn share(i: usize, of: usize) -> f64 {
    i as f64 / of.max(1) as f64
}

impl open::Needs for Files<'_> {
    fn model(&self, model: &FileModel) -> Shared<Model> {
        self.models.get(&key(model)).expect("every model of the file was loaded").clone()
    }

    fn texture(&self, texture: &FileTexture) -> Shared<Texture> {
        let plain = self.textures.get(&texture.path).expect("every texture of the file was loaded");
        let FileTexture { wrap, offset, scale, .. } = *texture;
        if (plain.wrap, plain.offset, plain.scale) == (wrap, offset, scale) {
            return plain.clone();
        }
        Shared::new(Texture { wrap, offset, scale, ..Texture::clone(plain) })
    }
}

/// Replaces models and textures if only the scene file itself is checked.
pub(super) struct StandIns;

impl open::Needs for StandIns {
    fn model(&self, _: &FileModel) -> Shared<Model> {
        crate::io::cam_model()
    }

    fn texture(&self, texture: &FileTexture) -> Shared<Texture> {
        let FileTexture { wrap, offset, scale, .. } = *texture;
        let picture = Picture::filled(Size::new(1, 1), [255; 4]).into();
        Shared::new(Texture { source: PathBuf::new(), picture, wrap, offset, scale })
    }
}
