//! The scene that files make: a scene file or the first scene, with models put into it.

use std::path::{Path, PathBuf};

use clap::CommandFactory;
use clap::error::ErrorKind;
use marraztu::base::Shared;
use marraztu::edit::{items, selection};
use marraztu::io::{self, Finding, Loaded, Progress};
use marraztu::scene::{Command, LoadOptions, MaterialChoice, Object, Scene, Settings, View};

use super::arguments::{Arguments, Reading};
use super::bar::Bar;
use super::failure::Failure;

/// A scene, how it is looked at, and what was found on the way.
#[derive(Debug)]
pub(crate) struct Stage {
    pub(crate) scene: Scene,
    pub(crate) view: View,
    pub(crate) settings: Settings,
    pub(crate) findings: Vec<Finding>,
    /// Whether there are models and nothing else: no scene says how they are seen.
    pub(crate) models_alone: bool,
}

impl Stage {
    /// Reads the files.
    pub(crate) fn of(files: &[PathBuf], reading: &Reading) -> Result<Self, Failure> {
        let (scenes, models): (Vec<&PathBuf>, Vec<&PathBuf>) =
            files.iter().partition(|file| is_scene(file));
        if scenes.len() > 1 {
            return Err(usage("only one scene can be drawn at a time"));
        }
        if models.is_empty() && reading.is_said() {
            return Err(usage(
                "--up, --scale, --flip-winding and --crease say how models are read: name one",
            ));
        }
        let mut stage = match scenes.first() {
            Some(scene) => Self::of_scene(scene)?,
            None => Self::first(models.is_empty()),
        };
        for model in models {
            stage.add(model, &reading.options())?;
        }
        Ok(stage)
    }

    /// The first scene, or its camera and lights alone.
    fn first(with_objects: bool) -> Self {
        let (scene, view) = if with_objects { io::default_scene() } else { io::empty_scene() };
        Self {
            scene,
            view,
            settings: Settings::default(),
            findings: Vec::new(),
            models_alone: !with_objects,
        }
    }

    fn of_scene(file: &Path) -> Result<Self, Failure> {
        let progress = Progress::new();
        let bar = Bar::of(&format!("reading {}", file.display()), &progress);
        let opened = io::open(file, &progress)?;
        drop(bar);
        Ok(Self {
            scene: opened.scene,
            view: opened.view,
            settings: opened.settings,
            findings: opened.findings,
            models_alone: false,
        })
    }

    /// Puts a model into the scene as the editor does, with its file's own material.
    fn add(&mut self, file: &Path, options: &LoadOptions) -> Result<(), Failure> {
        let Loaded { model, findings } = load(file, options)?;
        self.findings.extend(findings);
        let object = Object::new(Shared::new(model), MaterialChoice::File);
        self.change(items::insert_object(&self.scene, object))
    }

    /// Changes the scene, and makes the view fit it.
    pub(crate) fn change(&mut self, command: Command) -> Result<(), Failure> {
        let before = self.scene.clone();
        command.apply(&mut self.scene)?;
        selection::follow(&before, &self.scene, &mut self.view);
        Ok(())
    }
}

/// Reads a model, with a bar where it takes long.
pub(crate) fn load(file: &Path, options: &LoadOptions) -> Result<Loaded, Failure> {
    let progress = Progress::new();
    let _bar = Bar::of(&format!("reading {}", file.display()), &progress);
    Ok(io::load(file, options, &progress)?)
}

/// Whether a file's name says that it is a scene.
pub(crate) fn is_scene(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(io::SCENE_ENDING))
}

/// Arguments that cannot be meant together.
pub(crate) fn usage(reason: &str) -> Failure {
    Failure::Usage(Box::new(Arguments::command().error(ErrorKind::ArgumentConflict, reason)))
}
