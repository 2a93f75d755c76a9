//! The rows of a batch: one for each model or scene of the list.
//!
//! A list may have millions of pictures, but only rows are held: a file, a line number, and options
//! that most rows share. Pictures are computed from their position ([`super::jobs`]).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use marraztu_io::{self as io, Sources};

use super::Batch;
use super::dataset::Dataset;
use super::list::{self, Entry, Line, expanded, read_list};
use super::options::{OptionParser, OptionTexts, Parsed, Value, WrongOption};
use super::tars::TarNames;
use super::template::{Fields, Template};
use super::views::{CameraView, own_view, parse_views};
use crate::cli::failure::{Failure, usage};
use crate::cli::layers::{Encoding, LayerFile};
use crate::cli::sky::Sky;
use crate::cli::stage::is_scene;
use crate::cli::values::is_standard;

/// A model or scene of the list.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// The number in the list, from 0.
    pub(super) number: usize,
    /// The number of its first picture in the whole list.
    pub(super) first: usize,
    line: Option<Line>,
    pub(super) file: PathBuf,
    pub(super) kind: Arc<RowKind>,
}

/// The properties that equal rows share.
#[derive(Debug)]
pub(super) struct RowKind {
    pub(super) parsed: Arc<Parsed>,
    pub(super) views: Arc<Vec<CameraView>>,
    pub(super) names: Names,
    ext: &'static str,
}

/// The names of files.
#[derive(Clone, Debug)]
pub(super) enum Names {
    Template(Arc<Template>),
    /// A data set in a folder.
    Dataset(Dataset, PathBuf),
    /// Archives.
    Tars(Arc<TarNames>),
}

impl Names {
    /// Returns the names of archives.
    pub(super) const fn tars(&self) -> Option<&Arc<TarNames>> {
        match self {
            Self::Tars(tars) => Some(tars),
            Self::Template(_) | Self::Dataset(..) => None,
        }
    }

    /// Returns whether the names have the same form: one template, a data set, or archives.
    pub(super) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Template(a), Self::Template(b)) => Arc::ptr_eq(a, b),
            (Self::Dataset(a, _), Self::Dataset(b, _)) => a == b,
            (Self::Tars(a), Self::Tars(b)) => a == b,
            (Self::Template(_) | Self::Dataset(..) | Self::Tars(_), _) => false,
        }
    }
}

impl Row {
    /// Returns the place for messages, such as "list.csv:3".
    pub(super) fn place(&self) -> String {
        list::place(self.line.as_ref(), &self.file)
    }

    /// Returns the panorama of the options.
    pub(super) fn sky(&self) -> Option<&Path> {
        self.kind.parsed.options.scene.seeing.sky.as_ref().map(Sky::path)
    }

    /// Returns the texture of the options.
    pub(super) fn texture(&self) -> Option<&Path> {
        self.kind.parsed.options.scene.surfaces.texture.as_deref()
    }

    /// Returns the values of the fields in names.
    pub(super) fn fields<'a>(&'a self, view: usize, layer: &'a str) -> Fields<'a> {
        let (file, index) = (&*self.file, self.first + view);
        let view_name = &self.kind.views[view].name;
        Fields { file, index, view, view_name, layer, ext: self.kind.ext }
    }

    /// Returns the files of a picture. Fails with the reason if their formats cannot hold it.
    pub(super) fn files(&self, view: usize) -> Result<Vec<LayerFile>, String> {
        let path = |layer: &str| {
            let fields = self.fields(view, layer);
            match &self.kind.names {
                Names::Template(template) => template.path(&fields),
                Names::Dataset(dataset, folder) => dataset.path(folder, &fields, self.number),
                Names::Tars(tars) => tars.member(fields.index, &self.kind.field(layer)),
            }
        };
        let options = &self.kind.parsed.options;
        let files = options.layers.files(path)?;
        for file in files.iter().filter(|_| options.transparent) {
            if let Encoding::Picture(_) = file.encoding {
                io::check_alpha(&file.path).map_err(|error| error.to_string())?;
            }
        }
        Ok(files)
    }

    /// Returns the file that describes a picture in an archive.
    pub(super) fn description(&self, view: usize) -> Option<PathBuf> {
        self.kind.names.tars().map(|tars| tars.member(self.first + view, "json"))
    }

    /// Checks that the formats of all pictures can hold them.
    fn check_files(&self, is_first_of_kind: bool) -> Result<(), Failure> {
        // An empty name would turn an extension into a name.
        let is_fixed = self.file.file_name().is_some() && self.kind.fixes_extension();
        let views = match (is_fixed, is_first_of_kind) {
            (true, true) => 0..1,
            (true, false) => 0..0,
            (false, _) => 0..self.kind.views.len(),
        };
        for view in views {
            let checked = self.files(view);
            checked.map_err(|reason| Failure::Usage(format!("{}: {reason}", self.place())))?;
        }
        Ok(())
    }
}

impl RowKind {
    fn fixes_extension(&self) -> bool {
        match &self.names {
            Names::Template(template) => template.fixes_extension(),
            Names::Dataset(..) | Names::Tars(_) => true,
        }
    }

    /// Returns whether each layer has its own file, if `--out` does not say so.
    fn is_by_layer(&self) -> bool {
        self.parsed.options.layers.are_given() && self.ext != "exr"
    }

    /// Returns the end of the name of a layer in an archive: "depth.npy", or "png".
    fn field(&self, layer: &str) -> String {
        if self.is_by_layer() { format!("{layer}.{}", self.ext) } else { self.ext.to_owned() }
    }
}

/// The rows of the whole list.
#[derive(Debug)]
pub(super) struct Rows {
    pub(super) rows: Vec<Arc<Row>>,
    /// The number of pictures.
    pub(super) pictures: usize,
    list: Option<PathBuf>,
    /// The files of cameras.
    cameras: Vec<PathBuf>,
}

impl Rows {
    /// Reads the rows that the arguments describe, and checks each.
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
        let cameras = reader.views.into_keys().map(PathBuf::from).collect();
        Ok(Self { rows, pictures: reader.pictures, list: arguments.list.clone(), cameras })
    }

    /// Returns the files that are read: the list, models and scenes, and cameras.
    pub(super) fn inputs(&self) -> Sources {
        let files = self.rows.iter().map(|row| &row.file);
        let skies = self.rows.iter().filter_map(|row| row.sky());
        Sources::default().with(&self.list).with(files).with(&self.cameras).with(skies)
    }
}

/// Completes rows with the options of the command line. Equal values are parsed once.
struct RowReader {
    parser: OptionParser,
    base: OptionTexts,
    views: BTreeMap<String, Arc<Vec<CameraView>>>,
    templates: BTreeMap<String, Arc<Template>>,
    /// The view of the options, without `--views`.
    own_view: Arc<Vec<CameraView>>,
    base_views: Option<String>,
    base_out: Option<String>,
    /// The names of archives, if `--out` names some.
    tars: Option<Arc<TarNames>>,
    dataset: Option<Dataset>,
    /// The numbers of rows and pictures so far.
    rows: usize,
    pictures: usize,
    format: &'static str,
    /// The values of the last row, and its kind: most rows are of the kind of the one before.
    last: Option<(Values, Arc<RowKind>)>,
}

/// The values of a row, by their columns.
type Values = Vec<(String, Value)>;

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
            own_view: Arc::new(own_view()),
            base_views: arguments.views.clone(),
            base_out: arguments.out.clone(),
            tars: None,
            dataset: arguments.dataset,
            rows: 0,
            pictures: 0,
            format: arguments.format,
            last: None,
        };
        // Errors of the command line are not errors of the first row.
        let check = |result: Result<(), String>, option: &str| {
            result.map_err(|reason| Failure::Usage(format!("--{option}: {reason}")))
        };
        if let Some(text) = &arguments.views {
            check(once(&mut reader.views, text, parse_views).map(drop), "views")?;
        }
        if let Some(text) = &arguments.out {
            check(check_scheme(text), "out")?;
        }
        if let Some(text) = arguments.tar_template() {
            let tars = TarNames::parse(text, arguments.per_tar);
            reader.tars =
                Some(Arc::new(tars.map_err(|reason| usage(&format!("--out: {reason}")))?));
        } else if let (Some(text), None) = (&arguments.out, arguments.dataset) {
            check(once(&mut reader.templates, text, Template::parse).map(drop), "out")?;
        }
        Ok(reader)
    }

    /// Returns whether there is such a column, in addition to the file.
    fn has(&self, column: &str) -> bool {
        matches!(column, "views" | "out") || self.parser.has(column)
    }

    fn row(&mut self, entry: Entry) -> Result<Row, Failure> {
        let Entry { line, file, values } = entry;
        let wrong = |reason: &str| {
            Failure::Usage(format!("{}: {reason}", list::place(line.as_ref(), &file)))
        };
        if is_standard(&file) {
            return Err(wrong("a batch does not read a model from standard input"));
        }
        let known = self.last.take_if(|(last, _)| *last == values).map(|(_, kind)| kind);
        let is_new = known.is_none();
        let kind = match known {
            Some(kind) => kind,
            None => Arc::new(self.kind(&values).map_err(|(column, reason)| {
                // An option of the command line that conflicts is not a column, but named as well.
                let column = column.map_or_else(String::new, |it| format!("column {it}: "));
                wrong(&format!("{column}{reason}"))
            })?),
        };
        if is_scene(&file) && kind.parsed.options.scene.reading.is_given() {
            return Err(wrong(
                "--up, --scale, --flip-winding, --crease and --bump-maps apply to models, and this \
                 is a scene",
            ));
        }
        self.last = Some((values, Arc::clone(&kind)));
        let (number, first) = (self.rows, self.pictures);
        self.rows += 1;
        self.pictures += kind.views.len();
        let row = Row { number, first, line, file, kind };
        row.check_files(is_new)?;
        Ok(row)
    }

    /// Returns the kind of rows with these values. Fails with a column, if one is wrong, and the
    /// reason.
    fn kind(&mut self, values: &[(String, Value)]) -> Result<RowKind, (Option<String>, String)> {
        let of_option = |WrongOption { option, reason }| (option, reason);
        let mut texts = self.base.clone();
        let (mut views, mut out) = (self.base_views.clone(), self.base_out.clone());
        for (name, value) in values {
            match (name.as_str(), value) {
                ("out", _) if self.tars.is_some() => {
                    let reason = "--out names archives for all pictures".to_owned();
                    return Err((Some("out".to_owned()), reason));
                }
                (name @ ("out" | "layers" | "ids"), _) if self.dataset.is_some() => {
                    let reason = "a data set has its own folder and layers".to_owned();
                    return Err((Some(name.to_owned()), reason));
                }
                ("views", Value::Text(text)) => views = Some(text.clone()),
                ("out", Value::Text(text)) => out = Some(text.clone()),
                (name, value) if self.parser.has(name) => {
                    texts = self.parser.with(&texts, name, value.clone()).map_err(of_option)?;
                }
                (name, _) => return Err((Some(name.to_owned()), list::NO_COLUMN.to_owned())),
            }
        }
        let parsed = self.parser.parse(&texts).map_err(of_option)?;
        let scene = &parsed.options.scene;
        let sky = scene.seeing.sky.as_ref().map(|sky| ("sky", sky.path()));
        let texture = scene.surfaces.texture.as_deref().map(|path| ("texture", path));
        for (name, path) in sky.into_iter().chain(texture) {
            let found = io::check_file(path).map_err(|error| error.to_string());
            found.map_err(column(name))?;
        }
        let seeing = &parsed.options.scene.seeing;
        let has_camera = seeing.camera.is_some() || seeing.from.is_some();
        let views = match views {
            Some(_) if has_camera => {
                let reason = "it replaces --camera and --from: give one";
                return Err((Some("views".to_owned()), reason.to_owned()));
            }
            Some(text) => once(&mut self.views, &text, parse_views).map_err(column("views"))?,
            None => Arc::clone(&self.own_view),
        };
        let names = match (&self.tars, self.dataset, out) {
            (Some(tars), ..) => Names::Tars(Arc::clone(tars)),
            (None, Some(dataset), out) => Names::Dataset(dataset, out.unwrap_or_default().into()),
            (None, None, Some(text)) => {
                check_scheme(&text).map_err(column("out"))?;
                let template = once(&mut self.templates, &text, Template::parse);
                Names::Template(template.map_err(column("out"))?)
            }
            (None, None, None) => {
                let by_layer = parsed.options.layers.are_given() && self.format != "exr";
                Names::Template(Arc::new(Template::of_views(views.len(), by_layer)))
            }
        };
        Ok(RowKind { parsed, views, names, ext: self.format })
    }
}

/// Returns a function that adds the column to the reason of an error.
fn column(name: &'static str) -> impl FnOnce(String) -> (Option<String>, String) {
    move |reason| (Some(name.to_owned()), reason)
}

/// Checks that a template or folder is not an address.
fn check_scheme(text: &str) -> Result<(), String> {
    io::check_scheme(Path::new(text)).map_err(|error| error.to_string())
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
