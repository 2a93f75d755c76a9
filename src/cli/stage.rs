//! Builds the scene from files: a scene file or the first scene, with models added to it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use marraztu_core::accuracy::{Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::edit::{items, selection};
use marraztu_core::scene::{
    Command, LoadOptions, MaterialChoice, Model, Object, Scene, Sides, View,
};
use marraztu_io::{self as io, Finding, Input, LoadError, Loaded, Progress, Sources};
use rayon::prelude::*;

use super::arguments::Reading;
use super::bar::Bar;
use super::failure::{Failure, usage};
use super::values::is_standard;

/// Who watches files being read.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Watch<'a> {
    /// The user, by a bar.
    Bar,
    /// The program, which may cancel reading.
    Progress(&'a Progress),
}

impl Watch<'_> {
    /// Begins to read.
    fn begin(self, what: &str) -> (Progress, Option<Bar>) {
        match self {
            Watch::Progress(progress) => (progress.clone(), None),
            Watch::Bar => {
                let progress = Progress::new();
                let bar = Bar::of(what, &progress);
                (progress, Some(bar))
            }
        }
    }
}

/// A scene with its view and settings, and the findings of its files.
#[derive(Clone, Debug)]
pub(crate) struct Stage {
    pub(crate) scene: Scene,
    pub(crate) view: View,
    pub(crate) settings: Settings,
    pub(crate) findings: Vec<Finding>,
    /// Options without an effect on this scene.
    pub(crate) notes: Vec<String>,
    /// Whether there are only models, without a scene file that defines the view.
    pub(crate) models_alone: bool,
}

impl Stage {
    /// Returns a shot of this size.
    pub(crate) fn shot(&self, size: Size) -> Shot {
        Shot::new(&self.scene, &self.view, &self.settings, size)
    }

    /// Returns the files of the scene, which the output must not overwrite.
    pub(crate) fn sources(&self, files: &[PathBuf]) -> Sources {
        Sources::of(&self.scene).with(files.iter().filter(|file| !is_standard(file)))
    }

    /// Loads the files.
    pub(crate) fn of(
        files: &[PathBuf],
        reading: &Reading,
        watch: Watch<'_>,
    ) -> Result<Self, Failure> {
        Self::with_input(files, input(files)?.as_ref(), reading, watch)
    }

    /// Loads the files; "-" is the input.
    pub(super) fn with_input(
        files: &[PathBuf],
        input: Option<&Input>,
        reading: &Reading,
        watch: Watch<'_>,
    ) -> Result<Self, Failure> {
        // Check all files before the first is read, which may take long.
        for file in files.iter().filter(|file| !is_standard(file)) {
            io::check_file(file)?;
        }
        let holds_scene = |file: &&PathBuf| match input {
            Some(input) if is_standard(file) => input.is_scene(),
            _ => is_scene(file),
        };
        let (scenes, models): (Vec<&PathBuf>, Vec<&PathBuf>) = files.iter().partition(holds_scene);
        if scenes.len() > 1 {
            return Err(usage("only one scene can be drawn at a time"));
        }
        if models.is_empty() && reading.is_given() {
            return Err(usage(
                "--up, --scale, --flip-winding, --crease and --bump-maps apply to model files: \
                    name one",
            ));
        }
        let mut stage = match scenes.first() {
            Some(scene) => Self::of_scene(scene, input, watch)?,
            None => Self::first(models.is_empty()),
        };
        stage.add(&models, input, reading, watch)?;
        stage.findings = io::joined(stage.findings);
        Ok(stage)
    }

    /// Returns the first scene, or only its camera and lights.
    fn first(with_objects: bool) -> Self {
        let (scene, mut view) = if with_objects { io::default_scene() } else { io::empty_scene() };
        view.steps.by_size = !with_objects;
        Self {
            scene,
            view,
            settings: Settings::default(),
            findings: Vec::new(),
            notes: Vec::new(),
            models_alone: !with_objects,
        }
    }

    /// Opens a scene from a file or from standard input.
    pub(super) fn of_scene(
        file: &Path,
        input: Option<&Input>,
        watch: Watch<'_>,
    ) -> Result<Self, Failure> {
        let (progress, bar) = watch.begin(&format!("reading {}", file.display()));
        let opened = match input.filter(|_| is_standard(file)) {
            Some(input) => input.scene(&progress)?,
            None => io::open(file, &progress)?,
        };
        drop(bar);
        Ok(Self {
            scene: opened.scene,
            view: opened.view,
            settings: opened.settings,
            findings: opened.findings,
            notes: Vec::new(),
            models_alone: false,
        })
    }

    /// Adds models to the scene like the editor, with their own materials. A repeated file is read
    /// once.
    fn add(
        &mut self,
        files: &[&PathBuf],
        input: Option<&Input>,
        reading: &Reading,
        watch: Watch<'_>,
    ) -> Result<(), Failure> {
        let [first, ..] = files else { return Ok(()) };
        let what = match files.len() {
            1 => format!("reading {}", first.display()),
            count => format!("reading {count} models"),
        };
        let (progress, _bar) = watch.begin(&what);
        let place =
            |file: &Path| std::path::absolute(file).unwrap_or_else(|_empty| file.to_owned());
        let places: Vec<PathBuf> = files.iter().map(|file| place(file)).collect();
        // The distinct files, in the order of the arguments.
        let mut numbers: BTreeMap<&Path, usize> = BTreeMap::new();
        let mut once: Vec<&PathBuf> = Vec::new();
        for (file, place) in files.iter().zip(&places) {
            numbers.entry(place).or_insert_with(|| {
                once.push(file);
                once.len() - 1
            });
        }
        // The first error in the order of the arguments is reported, whatever thread met it.
        let mut models: Vec<Shared<Model>> = Vec::with_capacity(once.len());
        for loaded in load_all(&once, input, reading, &progress) {
            let Loaded { model, findings } = loaded?;
            self.findings.extend(findings);
            models.push(Shared::new(model));
        }
        let object = |place: &PathBuf| {
            let model = models[numbers[place.as_path()]].clone();
            // Set explicitly, since a model from standard input has no file name.
            Object { sides: Sides::Auto, ..Object::new(model, MaterialChoice::File) }
        };
        let objects = places.iter().map(object).collect();
        self.change(items::insert_objects(&self.scene, objects))
    }

    /// Changes the scene, and adapts the view to it.
    pub(crate) fn change(&mut self, command: Command) -> Result<(), Failure> {
        let before = self.scene.clone();
        command.apply(&mut self.scene)?;
        selection::follow(&before, &self.scene, &mut self.view);
        Ok(())
    }
}

/// Loads a model, with a progress bar if it takes long.
pub(crate) fn load(file: &Path, options: &LoadOptions) -> Result<Loaded, Failure> {
    let progress = Progress::new();
    let _bar = Bar::of(&format!("reading {}", file.display()), &progress);
    Ok(io::load(file, options, &progress)?)
}

/// Reads standard input, if it is among the files.
pub(crate) fn input(files: &[PathBuf]) -> Result<Option<Input>, Failure> {
    match files.iter().filter(|file| is_standard(file)).count() {
        0 => Ok(None),
        1 => Ok(Some(Input::read(std::io::stdin().lock())?)),
        _ => Err(usage("standard input can be read once: name - once")),
    }
}

/// Loads several models in parallel, since one small file leaves most threads idle.
fn load_all(
    files: &[&PathBuf],
    input: Option<&Input>,
    reading: &Reading,
    progress: &Progress,
) -> Vec<Result<Loaded, LoadError>> {
    let done = AtomicUsize::new(0);
    let load = |file: &&PathBuf| {
        // A single file reports its own progress; several count as one step each.
        let own = if files.len() == 1 { progress.clone() } else { Progress::new() };
        let input = input.filter(|_| is_standard(file));
        let options = reading.options(file, input);
        let loaded = match input {
            Some(input) => input.model(&options, &own),
            None => io::load(file, &options, &own),
        };
        progress.reached(done.fetch_add(1, Ordering::Relaxed) + 1, files.len())?;
        loaded
    };
    files.par_iter().map(load).collect()
}

/// Returns whether a file has the extension of scenes.
pub(crate) fn is_scene(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(io::SCENE_ENDING))
}
