//! The jobs of a batch: one for each picture.
//!
//! All rows, options, cameras and names are checked here, before the first picture is drawn. Jobs
//! are numbered over the whole list, whatever part of it this process draws.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use marraztu_core::base::image::Size;
use marraztu_io::{self as io, Sources};

use super::Batch;
use super::dataset::Dataset;
use super::digest::companions;
use super::list::{self, Entry, expanded, read_list};
use super::options::{OptionParser, OptionTexts, Parsed, Value, WrongOption};
use super::shard::Shard;
use super::template::{Fields, Template};
use super::views::{CameraView, own_view, parse_views};
use crate::cli::failure::{Failure, usage};
use crate::cli::layers::{Encoding, LayerFile};
use crate::cli::stage::is_scene;
use crate::cli::values::is_standard;

/// The size of pictures without `--size`.
const SIZE: Size = Size::new(800, 800);

/// A row with its options.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// The number in the list, from 0.
    pub(super) number: usize,
    /// The place for messages, such as "list.csv:3".
    place: String,
    pub(super) file: PathBuf,
    pub(super) parsed: Arc<Parsed>,
    views: Arc<Vec<CameraView>>,
    names: Names,
    ext: &'static str,
}

/// The names of files.
#[derive(Clone, Debug)]
enum Names {
    Template(Arc<Template>),
    /// A data set in a folder.
    Dataset(Dataset, PathBuf),
}

/// A picture to draw.
#[derive(Clone, Debug)]
pub(super) struct Job {
    /// The number in the whole list, from 0.
    pub(super) index: usize,
    pub(super) row: Arc<Row>,
    /// The number of the view in its row.
    view: usize,
    /// The files of the picture and its layers: at least one.
    pub(super) files: Vec<LayerFile>,
}

impl Job {
    /// Returns the first file.
    pub(super) fn out(&self) -> &Path {
        &self.files[0].path
    }

    /// Returns the folder of the file of cameras.
    pub(super) fn cameras_folder(&self, dataset: Option<Dataset>) -> &Path {
        let folder = self.out().parent().unwrap_or(Path::new(""));
        match dataset {
            // The layers have folders of their own.
            Some(Dataset::Nerf) => folder.parent().unwrap_or(folder),
            Some(Dataset::Bop | Dataset::Coco) | None => folder,
        }
    }

    /// Names the formats of all files.
    pub(super) fn encodings(&self) -> String {
        let names: Vec<&str> = self.files.iter().map(|file| file.encoding.name()).collect();
        names.join(" ")
    }

    /// Returns the camera.
    pub(super) fn camera(&self) -> &CameraView {
        &self.row.views[self.view]
    }

    /// Returns the number of the view in its row.
    pub(super) const fn view(&self) -> usize {
        self.view
    }

    /// Returns whether its row has no other view.
    pub(super) fn is_only_view(&self) -> bool {
        self.row.views.len() == 1
    }

    /// Returns the size of the picture.
    pub(super) fn size(&self) -> Size {
        self.row.parsed.options.size.or(self.camera().size).unwrap_or(SIZE)
    }
}

/// The jobs of a process.
#[derive(Debug)]
pub(super) struct Jobs {
    /// The jobs to draw, in the order of drawing: all jobs of a model follow each other.
    pub(super) jobs: Vec<Job>,
    /// The number of jobs in the whole list.
    pub(super) all: usize,
    /// The files that are read: the list, models and scenes, and cameras.
    pub(super) inputs: Sources,
}

impl Jobs {
    /// Collects the jobs that the arguments describe.
    pub(super) fn of(arguments: &Batch) -> Result<Self, Failure> {
        let mut reader = RowReader::new(arguments)?;
        let mut entries = expanded(&arguments.files)?;
        if let Some(list) = &arguments.list {
            entries.extend(read_list(list, &|name| reader.has(name))?);
        }
        let rows = entries.into_iter().map(|entry| reader.row(entry).map(Arc::new));
        let rows: Vec<Arc<Row>> = rows.collect::<Result<_, _>>()?;
        if rows.is_empty() {
            return Err(usage("the list has no rows"));
        }
        let jobs = jobs_of(&rows)?;
        check_outputs(&jobs, arguments)?;
        check_inputs(&jobs, &rows)?;
        let all = jobs.len();
        let cameras = reader.views.keys().map(PathBuf::from);
        let files: BTreeSet<&PathBuf> = rows.iter().map(|row| &row.file).collect();
        let inputs = Sources::default().with(&arguments.list).with(files).with(cameras);
        let shard = arguments.shard.unwrap_or(Shard::WHOLE);
        Ok(Self { jobs: ordered(&jobs, shard), all, inputs })
    }
}

/// Completes rows with the options of the command line. Equal values are parsed once.
struct RowReader {
    parser: OptionParser,
    base: OptionTexts,
    views: BTreeMap<String, Arc<Vec<CameraView>>>,
    templates: BTreeMap<String, Arc<Template>>,
    base_views: Option<String>,
    base_out: Option<String>,
    dataset: Option<Dataset>,
    /// The number of rows so far.
    rows: usize,
    format: &'static str,
}

impl RowReader {
    fn new(arguments: &Batch) -> Result<Self, Failure> {
        let needed = arguments.dataset.into_iter().flat_map(Dataset::options);
        let base = arguments.options.clone();
        let base = needed.fold(base, |base, (name, value)| base.and(name, value));
        let mut reader = Self {
            parser: OptionParser::new(),
            base,
            views: BTreeMap::new(),
            templates: BTreeMap::new(),
            base_views: arguments.views.clone(),
            base_out: arguments.out.clone(),
            dataset: arguments.dataset,
            rows: 0,
            format: arguments.format,
        };
        // Errors of the command line are not errors of the first row.
        let check = |result: Result<(), String>, option: &str| {
            result.map_err(|reason| Failure::Usage(format!("--{option}: {reason}")))
        };
        if let Some(text) = &arguments.views {
            check(once(&mut reader.views, text, parse_views).map(drop), "views")?;
        }
        if let (Some(text), None) = (&arguments.out, arguments.dataset) {
            check(once(&mut reader.templates, text, Template::parse).map(drop), "out")?;
        }
        Ok(reader)
    }

    /// Returns whether there is such a column, in addition to the file.
    fn has(&self, column: &str) -> bool {
        matches!(column, "views" | "out") || self.parser.has(column)
    }

    fn row(&mut self, entry: Entry) -> Result<Row, Failure> {
        let Entry { place, file, values } = entry;
        let wrong = |column: Option<&str>, reason: &str| {
            let column = column.map_or_else(String::new, |column| format!("column {column}: "));
            Failure::Usage(format!("{place}: {column}{reason}"))
        };
        if is_standard(&file) {
            return Err(wrong(None, "a batch does not read a model from standard input"));
        }
        let mut texts = self.base.clone();
        let (mut views, mut out) = (self.base_views.clone(), self.base_out.clone());
        for (name, value) in values {
            match (name.as_str(), value) {
                (name @ ("out" | "layers" | "ids"), _) if self.dataset.is_some() => {
                    return Err(wrong(Some(name), "a data set has its own folder and layers"));
                }
                ("views", Value::Text(text)) => views = Some(text),
                ("out", Value::Text(text)) => out = Some(text),
                (name, value) if self.parser.has(name) => {
                    let with = self.parser.with(&texts, name, value);
                    texts = with.map_err(|error| wrong(error.option.as_deref(), &error.reason))?;
                }
                (name, _) => return Err(wrong(Some(name), list::NO_COLUMN)),
            }
        }
        let parsed = self.parser.parse(&texts);
        let parsed = parsed.map_err(|WrongOption { option, reason }| {
            // An option of the command line that conflicts is not a column, but named as well.
            wrong(option.as_deref(), &reason)
        })?;
        if let Some(texture) = &parsed.options.scene.surfaces.texture {
            let found = io::check_file(texture);
            found.map_err(|error| wrong(Some("texture"), &error.to_string()))?;
        }
        if is_scene(&file) && parsed.options.scene.reading.is_given() {
            return Err(wrong(
                None,
                "--up, --scale, --flip-winding, --crease and --bump-maps apply to models, and this \
                 is a scene",
            ));
        }
        let seeing = &parsed.options.scene.seeing;
        let has_camera = seeing.camera.is_some() || seeing.from.is_some();
        let views = match views {
            Some(_) if has_camera => {
                return Err(wrong(Some("views"), "it replaces --camera and --from: give one"));
            }
            Some(text) => once(&mut self.views, &text, parse_views)
                .map_err(|reason| wrong(Some("views"), &reason))?,
            None => Arc::new(own_view()),
        };
        let names = match (self.dataset, out) {
            (Some(dataset), out) => Names::Dataset(dataset, out.unwrap_or_default().into()),
            (None, Some(text)) => {
                let template = once(&mut self.templates, &text, Template::parse);
                Names::Template(template.map_err(|reason| wrong(Some("out"), &reason))?)
            }
            (None, None) => {
                let by_layer = parsed.options.layers.are_given() && self.format != "exr";
                Names::Template(Arc::new(Template::of_views(views.len(), by_layer)))
            }
        };
        let number = self.rows;
        self.rows += 1;
        Ok(Row { number, place, file, parsed, views, names, ext: self.format })
    }
}

/// Returns the value of a text, which is parsed once.
fn once<T>(
    known: &mut BTreeMap<String, Arc<T>>,
    text: &str,
    parse: fn(&str) -> Result<T, String>,
) -> Result<Arc<T>, String> {
    if let Some(value) = known.get(text) {
        return Ok(Arc::clone(value));
    }
    let value = Arc::new(parse(text)?);
    known.insert(text.to_owned(), Arc::clone(&value));
    Ok(value)
}

/// Numbers the pictures of all rows and names their files.
fn jobs_of(rows: &[Arc<Row>]) -> Result<Vec<Job>, Failure> {
    let mut jobs = Vec::new();
    for row in rows {
        for (view, camera) in row.views.iter().enumerate() {
            let index = jobs.len();
            let (file, ext) = (&*row.file, row.ext);
            let view_name = &camera.name;
            let path = |layer: &str| {
                let fields = Fields { file, index, view, view_name, layer, ext };
                match &row.names {
                    Names::Template(template) => template.path(&fields),
                    Names::Dataset(dataset, folder) => dataset.path(folder, &fields, row.number),
                }
            };
            let options = &row.parsed.options;
            let wrong = |reason: String| Failure::Usage(format!("{}: {reason}", row.place));
            let files = options.layers.files(path).map_err(wrong)?;
            for file in files.iter().filter(|_| options.transparent) {
                if let Encoding::Picture(_) = file.encoding {
                    io::check_alpha(&file.path).map_err(|error| wrong(error.to_string()))?;
                }
            }
            jobs.push(Job { index, row: Arc::clone(row), view, files });
        }
    }
    Ok(jobs)
}

/// Rejects pictures that would overwrite each other.
fn check_outputs(jobs: &[Job], arguments: &Batch) -> Result<(), Failure> {
    let (mut places, mut outputs) = (Places::default(), BTreeMap::new());
    let all = jobs.iter().flat_map(|job| job.files.iter().map(move |file| (file, job)));
    for (file, job) in all {
        let Some(other) = outputs.insert(places.of(&file.path), job) else { continue };
        let of = |job: &Job| format!("{}, view {}", job.row.place, job.camera().name);
        let way = match arguments.dataset {
            Some(_) => "a data set tells models apart by the names of their files",
            None => "tell them apart in --out by {dir}, {view} or {index}",
        };
        return Err(Failure::Usage(format!(
            "two pictures would be written to {}: {} and {}; {way}",
            file.path.display(),
            of(other),
            of(job),
        )));
    }
    let sheets = arguments.sheet.iter().flat_map(|grid| grid.files(&arguments.sheets, jobs.len()));
    let [report, times] = [&arguments.report, &arguments.times];
    let mut others = report.iter().chain(times).cloned().chain(sheets);
    if let Some(other) = others.find(|other| outputs.contains_key(&places.of(other))) {
        let reason = format!("{} is the name of a picture; choose another name", other.display());
        return Err(Failure::Usage(reason));
    }
    match (report, times) {
        (Some(report), Some(times)) if places.of(report) == places.of(times) => {
            Err(usage("--report and --times name the same file"))
        }
        _ => Ok(()),
    }
}

/// Absolute paths of files that may not exist yet, without links. Two paths of one file are equal.
#[derive(Debug, Default)]
struct Places {
    /// The places of folders.
    folders: BTreeMap<PathBuf, PathBuf>,
}

impl Places {
    fn of(&mut self, file: &Path) -> PathBuf {
        let (folder, name) = (file.parent().unwrap_or(file), file.file_name().unwrap_or_default());
        if let Some(place) = self.folders.get(folder) {
            return place.join(name);
        }
        let start = std::env::current_dir().unwrap_or_default();
        let place = folder.components().fold(start, |at, part| {
            let next = match part {
                Component::ParentDir => at.parent().unwrap_or(&at).to_owned(),
                Component::CurDir => at,
                other => at.join(other),
            };
            // Folders that do not exist are created as they are named.
            next.canonicalize().unwrap_or(next)
        });
        self.folders.insert(folder.to_owned(), place.clone());
        place.join(name)
    }
}

/// Rejects pictures that would replace a file that the model of any row refers to. Pictures of
/// earlier runs carry stamps; only other files take the time to look for all that is read.
fn check_inputs(jobs: &[Job], rows: &[Arc<Row>]) -> Result<(), Failure> {
    let outputs = jobs.iter().flat_map(|job| &job.files).map(|file| &*file.path);
    let is_foreign = |path: &&Path| path.exists() && io::read_stamp(path).is_none();
    let foreign: Vec<&Path> = outputs.filter(is_foreign).collect();
    if foreign.is_empty() {
        return Ok(());
    }
    let files: BTreeSet<&PathBuf> = rows.iter().map(|row| &row.file).collect();
    let referred = files.iter().filter_map(|file| companions(file)).flatten();
    let textures = rows.iter().filter_map(|row| row.parsed.options.scene.surfaces.texture.as_ref());
    let read = Sources::default().with(&files).with(referred.filter_map(|(_, path)| path));
    let read = read.with(textures);
    foreign.into_iter().try_for_each(|path| read.spare(path)).map_err(Failure::from)
}

/// Returns the jobs of a shard. The jobs of a model follow each other, in the order in which models
/// first occur in the list.
fn ordered(jobs: &[Job], shard: Shard) -> Vec<Job> {
    let shards = Shard::of_files(shard.count, jobs.iter().map(|job| &*job.row.file));
    let mut groups: BTreeMap<PathBuf, usize> = BTreeMap::new();
    let mut keyed = Vec::new();
    for job in jobs {
        if shards[&*job.row.file] == shard.index {
            let group = groups.entry(job.row.file.clone()).or_insert(job.index);
            keyed.push((*group, job.index));
        }
    }
    keyed.sort_unstable();
    keyed.into_iter().map(|(_, index)| jobs[index].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::jobs_of;
    use super::*;

    #[test]
    fn the_jobs_of_a_model_follow_each_other_and_keep_their_numbers() {
        let arguments = ["a.obj", "b.obj", "a.obj", "--out", "{index}.png", "--views", "2"];
        let jobs = jobs_of(&arguments).unwrap();
        let order: Vec<usize> = jobs.iter().map(|job| job.index).collect();
        assert_eq!(order, [0, 1, 4, 5, 2, 3]);
        let size = |arguments: &[&str]| jobs_of(arguments).unwrap()[0].size();
        assert_eq!(size(&["a.obj"]), SIZE);
        assert_eq!(size(&["a.obj", "--size", "32x16"]), Size::new(32, 16));
    }
}
