//! Loads the models and textures of a scene file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::box_sizes::BoxSizes;
use super::error::SceneFileError;
use super::format::{FileModel, FileScene, FileTexture};
use super::light::FileLight;
use super::model_key::{ModelKey, key};
use super::save::{file_model, file_path, file_texture};
use super::{open, paths};
use crate::error::LoadError;
use crate::findings::{Finding, FindingKind, Findings};
use crate::load::load_with;
use crate::panorama::{load_panorama, panorama_of};
use crate::progress::Progress;
use crate::texture::Pictures;
use crate::{assets, examples};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{Crease, LoadOptions, Model, Panorama, Scale, Scene, Shape, Texture};

/// The models, textures and panoramas of an open scene, which can be reused.
#[derive(Debug, Default)]
pub struct Known {
    models: Vec<Shared<Model>>,
    textures: Vec<Shared<Texture>>,
    panoramas: Vec<Shared<Panorama>>,
}

impl Known {
    /// Collects the models, textures and panoramas of a scene.
    pub fn of(scene: &Scene) -> Self {
        let objects = || scene.objects.iter().map(|(_, object)| object);
        let cameras = scene.cameras.iter().map(|(_, camera)| camera.model.clone());
        let panoramas = scene.lights.iter().filter_map(|(_, light)| light.kind.panorama());
        Self {
            models: objects().map(|object| object.model.clone()).chain(cameras).collect(),
            textures: objects().filter_map(|object| object.texture.clone()).collect(),
            panoramas: panoramas.map(|sky| sky.panorama.clone()).collect(),
        }
    }
}

/// The loaded models, textures and panoramas of a scene file. A placeholder replaces each one that
/// is missing or cannot be read.
pub(super) struct Files {
    folder: PathBuf,
    models: BTreeMap<ModelKey, Shared<Model>>,
    textures: BTreeMap<String, Shared<Texture>>,
    panoramas: BTreeMap<String, Shared<Panorama>>,
    /// The pictures of models and textures: one file may be used as both.
    pictures: Pictures,
    /// The findings in the files.
    pub(super) findings: Vec<Finding>,
    /// The files that are missing or cannot be read.
    pub(super) lost: Findings,
}

impl Files {
    /// Prepares to load the files of the scene file `name` in `folder`.
    pub(super) fn new(folder: PathBuf, name: &str) -> Self {
        Self {
            folder,
            models: BTreeMap::new(),
            textures: BTreeMap::new(),
            panoramas: BTreeMap::new(),
            pictures: Pictures::default(),
            findings: Vec::new(),
            lost: Findings::new(name),
        }
    }

    /// Registers models and textures that can be reused. A file name that is not UTF-8 is skipped:
    /// scene files cannot contain it.
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
        for panorama in &known.panoramas {
            if let Ok(path) = file_path(&panorama.source, nowhere) {
                self.panoramas.insert(path, panorama.clone());
            }
        }
    }

    /// Resolves a path in the scene file.
    fn place(&self, path: &str) -> PathBuf {
        examples::resolved(&self.folder, path)
            .unwrap_or_else(|| paths::plain(&self.folder.join(path)))
    }

    pub(super) fn load(
        &mut self,
        file: &FileScene,
        name: &str,
        progress: &Progress,
    ) -> Result<(), SceneFileError> {
        // Each distinct model is loaded once, unless it is already known.
        let of_objects = file.objects.iter().map(|object| &object.model);
        let all = of_objects.chain(file.cameras.iter().map(|camera| &camera.model));
        let mut keys = BTreeSet::new();
        let is_new = |model: &&FileModel| !self.models.contains_key(&key(model));
        let models: Vec<&FileModel> =
            all.filter(is_new).filter(|model| keys.insert(key(model))).collect();
        let mut lost = Vec::new();
        for (i, model) in models.iter().enumerate() {
            let (from, to) = (share(i, models.len()), share(i + 1, models.len()));
            match self.load_model(model, name, &progress.part(from, to))? {
                Some(loaded) => drop(self.models.insert(key(model), loaded)),
                None => lost.push(*model),
            }
        }
        // Placeholders come last, since their size depends on the other models.
        let sizes = BoxSizes::new(file, |model| self.models.get(&key(model)).map(|model| &**model));
        for model in lost {
            if let FileModel::File { path, .. } = model {
                let (_, options) = read_options(model, name)?;
                let placeholder =
                    Model::placeholder(complete(&self.place(path)), options, sizes.side(model));
                self.models.insert(key(model), Shared::new(placeholder));
            }
        }
        self.load_textures(file)?;
        self.load_panoramas(file)
    }

    fn load_panoramas(&mut self, file: &FileScene) -> Result<(), SceneFileError> {
        for path in file.lights.iter().filter_map(FileLight::panorama) {
            if self.panoramas.contains_key(path) {
                continue;
            }
            let place = self.place(path);
            let loaded = match examples::content(&place) {
                Some(content) => panorama_of(&place, &content, usize::MAX),
                None => load_panorama(&place),
            };
            let loaded = loaded.map(Shared::new);
            let lost = |source| Panorama::placeholder(source).into();
            let panorama = self.found((path, &place), loaded, lost)?;
            self.panoramas.insert(path.to_owned(), panorama);
        }
        Ok(())
    }

    fn load_textures(&mut self, file: &FileScene) -> Result<(), SceneFileError> {
        let chosen = file.objects.iter().filter_map(|object| object.texture.as_ref());
        let paths: BTreeSet<&str> = chosen
            .map(|texture| texture.path.as_str())
            .filter(|path| !self.textures.contains_key(*path))
            .collect();
        for path in paths {
            let texture = match assets::own_texture(path) {
                Some(own) => own,
                None => self.load_texture(path)?,
            };
            self.textures.insert(path.to_owned(), texture);
        }
        Ok(())
    }

    fn load_texture(&mut self, path: &str) -> Result<Shared<Texture>, SceneFileError> {
        let place = self.place(path);
        // Files of built-in examples come from the program, all others from disk.
        let loaded = match examples::content(&place) {
            Some(content) => examples::texture(&place, &content),
            None => self.pictures.texture(&place, &mut self.findings),
        };
        self.found((path, &place), loaded, |source| Texture::placeholder(source).into())
    }

    /// Returns a picture, or a placeholder with a finding if it was not loaded.
    fn found<T>(
        &mut self,
        (path, place): (&str, &Path),
        loaded: Result<Shared<T>, LoadError>,
        placeholder: fn(PathBuf) -> Shared<T>,
    ) -> Result<Shared<T>, SceneFileError> {
        match loaded {
            Ok(loaded) => Ok(loaded),
            Err(LoadError::Cancelled) => Err(LoadError::Cancelled.into()),
            Err(error) => {
                // A damaged file and a missing one need different remedies.
                if place.exists() {
                    self.lost.add(FindingKind::TextureUnreadable, &error.to_string(), None);
                } else {
                    self.lost.add(FindingKind::TextureMissing, path, None);
                }
                Ok(placeholder(complete(place)))
            }
        }
    }

    /// Finds the same file loaded with another crease angle, to avoid reading it twice.
    fn with_other_crease(&self, model: &FileModel) -> Option<&Shared<Model>> {
        let (path, _, options) = key(model);
        let (up, scale, winding, bumps, _) = options?;
        let with = |crease| (path.clone(), None, Some((up, scale, winding, bumps, crease)));
        let mut others = self.models.range(with(0)..=with(u64::MAX));
        others.next().map(|(_, loaded)| loaded)
    }

    /// Loads a model of the scene; `None` if its file is missing or cannot be read.
    fn load_model(
        &mut self,
        model: &FileModel,
        name: &str,
        progress: &Progress,
    ) -> Result<Option<Shared<Model>>, SceneFileError> {
        let (path, options) = match model {
            FileModel::Own(own) => {
                let own_model = assets::own_model(own);
                return own_model.map(Some).ok_or_else(|| SceneFileError::File {
                    file: name.to_owned(),
                    reason: format!("there is no built-in model \"{own}\""),
                });
            }
            FileModel::Shape { name: own, size } => {
                let shape = Shape::named(own).zip(Scale::new(*size));
                let model = shape.map(|(shape, size)| Some(shape.sized(size)));
                return model.ok_or_else(|| SceneFileError::File {
                    file: name.to_owned(),
                    reason: format!("there is no shape \"{own}\" of size {size}"),
                });
            }
            FileModel::File { .. } => read_options(model, name)?,
        };
        if let Some(other) = self.with_other_crease(model) {
            return Ok(Some(Shared::new(other.with_crease(options.crease))));
        }
        let place = self.place(path);
        let loaded = match examples::content(&place) {
            Some(content) => examples::model(&place, &content, &options, progress),
            None => load_with(&place, &options, &mut self.pictures, progress),
        };
        match loaded {
            Ok(loaded) => {
                // A scene assigns its own pictures, so unused ones do not matter.
                let counts = |finding: &Finding| finding.kind != FindingKind::PictureUnnamed;
                self.findings.extend(loaded.findings.into_iter().filter(counts));
                Ok(Some(Shared::new(loaded.model)))
            }
            Err(LoadError::Cancelled) => Err(LoadError::Cancelled.into()),
            Err(error) => {
                if place.exists() {
                    self.lost.add(FindingKind::ModelUnreadable, &error.to_string(), None);
                } else {
                    self.lost.add(FindingKind::ModelMissing, path, None);
                }
                Ok(None)
            }
        }
    }
}

/// Returns the path of a model and its load options. Fails if one of the options is invalid.
fn read_options<'a>(
    model: &'a FileModel,
    name: &str,
) -> Result<(&'a str, LoadOptions), SceneFileError> {
    let fail = |reason: String| SceneFileError::File { file: name.to_owned(), reason };
    let FileModel::File { path, up, scale, winding, crease, bumps } = model else {
        return Ok(("", LoadOptions::default()));
    };
    let scale =
        Scale::new(*scale).ok_or_else(|| fail(format!("the scale of {path} has to be above 0")))?;
    let crease = Crease::new(*crease).ok_or_else(|| {
        fail(format!("the crease angle of {path} has to be from 0 to 180 degrees"))
    })?;
    Ok((path, LoadOptions { up: *up, scale, winding: *winding, crease, bumps: *bumps }))
}

/// Returns an absolute path, which stays valid if the current folder changes.
fn complete(path: &Path) -> PathBuf {
    if examples::is_example(path) {
        return path.to_owned();
    }
    std::path::absolute(path).unwrap_or_else(|_empty| path.to_owned())
}

#[expect(clippy::cast_precision_loss, reason = "for the eye")]
fn share(i: usize, of: usize) -> f64 {
    i as f64 / of.max(1) as f64
}

impl open::Needs for Files {
    fn model(&self, model: &FileModel) -> Shared<Model> {
        self.models.get(&key(model)).expect("every model of the file was loaded").clone()
    }

    fn panorama(&self, path: &str) -> Shared<Panorama> {
        self.panoramas.get(path).expect("every panorama of the file was loaded").clone()
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

/// Replaces models, textures and panoramas when only the scene file itself is checked.
pub(super) struct StandIns;

impl open::Needs for StandIns {
    fn model(&self, _: &FileModel) -> Shared<Model> {
        assets::cam_model()
    }

    fn panorama(&self, path: &str) -> Shared<Panorama> {
        Panorama::placeholder(path.into()).into()
    }

    fn texture(&self, texture: &FileTexture) -> Shared<Texture> {
        let FileTexture { wrap, offset, scale, .. } = *texture;
        let picture = Picture::filled(Size::new(1, 1), [255; 4]).into();
        Shared::new(Texture { source: PathBuf::new(), picture, wrap, offset, scale })
    }
}
