//! Checks the names of all outputs before the first picture is drawn.
//!
//! Two pictures must not be written to one file, in whatever part of the list they are. Comparing
//! the names of millions of pictures takes minutes, so rows are compared. The name of a picture is
//! a text before the fields of its view, a text of the view, and a text after it. If no text of a
//! view, with one character before it and all characters after it, ends with another one
//! (suffix-free, as the code words of an instantaneous code read from the end), the view can be
//! read from the name. Then two pictures have one name only if the rest of the name is the same,
//! which is one text for each row. Names that begin with the view are read from the beginning.
//! Other names are compared one by one.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::hash::{BuildHasher as _, RandomState};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use marraztu_io::{self as io, Sources};

use super::Batch;
use super::dataset::Dataset;
use super::digest::companions;
use super::jobs::Plan;
use super::rows::{Names, Row, RowKind, Rows};
use super::template::{Template, stem};
use crate::cli::failure::{Failure, usage};
use crate::cli::layers::Encoding;

/// The most ends of names that are compared with each other.
const MOST_ENDS: usize = 64;

/// The most texts of views that are compared with each other.
const MOST_TEXTS: usize = 1 << 20;

/// Checks that no two pictures of the whole list would be written to one file, and that no other
/// output has the name of a picture.
pub(super) fn check_outputs(rows: &Rows, arguments: &Batch) -> Result<(), Failure> {
    let mut places = Places::default();
    let suspects = suspects(&rows.rows, &mut places);
    if let Some((first, second, path)) = collision(&suspects, &mut places) {
        let way = match arguments.dataset {
            Some(_) => "a data set tells models apart by the names of their files",
            None => "tell them apart in --out by {dir}, {view} or {index}",
        };
        return Err(Failure::Usage(format!(
            "two pictures would be written to {}: {first} and {second}; {way}",
            path.display(),
        )));
    }
    let [report, times] = [&arguments.report, &arguments.times];
    let sheets =
        arguments.sheet.iter().flat_map(|grid| grid.files(&arguments.sheets, rows.pictures));
    // Only a name with the extension of a picture can be the name of one.
    let others = report.iter().chain(times).cloned().chain(sheets);
    let others = others.filter(|path| Encoding::of(path).is_ok());
    let others: BTreeMap<PathBuf, PathBuf> = others.map(|it| (places.of(&it), it)).collect();
    if !others.is_empty() {
        let mut all = rows.rows.iter().flat_map(|row| paths(row));
        if let Some(other) = all.find_map(|(_, path)| others.get(&places.of(&path))) {
            let name = other.display();
            let reason = format!("{name} is the name of a picture; choose another name");
            return Err(Failure::Usage(reason));
        }
    }
    match (report, times) {
        (Some(report), Some(times)) if places.of(report) == places.of(times) => {
            Err(usage("--report and --times name the same file"))
        }
        _ => Ok(()),
    }
}

/// Iterates over the files of all pictures of a row, with their views.
fn paths(row: &Row) -> impl Iterator<Item = (usize, PathBuf)> {
    let files = move |view: usize| {
        let files = row.files(view).expect("names are checked with the rows");
        files.into_iter().map(move |file| (view, file.path))
    };
    (0..row.kind.views.len()).flat_map(files)
}

/// Returns two pictures of these rows with one file: their places in the list, and the file.
fn collision(rows: &[&Row], places: &mut Places) -> Option<(String, String, PathBuf)> {
    let hasher = RandomState::new();
    let mut hashes = Vec::new();
    for row in rows {
        hashes.extend(paths(row).map(|(_, path)| hasher.hash_one(places.of(&path))));
    }
    hashes.sort_unstable();
    let twice = hashes.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]);
    let twice: HashSet<u64> = twice.collect();
    if twice.is_empty() {
        return None;
    }
    let mut outputs: HashMap<PathBuf, String> = HashMap::new();
    for row in rows {
        for (view, path) in paths(row) {
            let place = places.of(&path);
            if !twice.contains(&hasher.hash_one(&place)) {
                continue;
            }
            let of = format!("{}, view {}", row.place(), row.kind.views[view].name);
            if let Some(other) = outputs.insert(place, of.clone()) {
                return Some((other, of, path));
            }
        }
    }
    None
}

/// Returns the rows with pictures that may share a file: none for usual names.
fn suspects<'a>(rows: &'a [Arc<Row>], places: &mut Places) -> Vec<&'a Row> {
    let all = || rows.iter().map(|row| &**row).collect();
    let Some(first) = rows.first() else { return Vec::new() };
    let is_one = rows.iter().all(|row| row.kind.names.is_same(&first.kind.names));
    let mut names = Keys::default();
    match &first.kind.names {
        // Their names have the number of the row or of the picture.
        Names::Dataset(Dataset::Bop | Dataset::Coco, _) | Names::Tars(_) => return Vec::new(),
        Names::Template(template) if is_one && template.shows_index() => return Vec::new(),
        Names::Dataset(Dataset::Nerf, _) => {
            let keys: Vec<u64> = rows.iter().map(|row| names.hash(&stem(&row.file))).collect();
            return twins(&keys).into_iter().map(|i| &*rows[i]).collect();
        }
        Names::Template(_) => {}
    }
    for row in rows {
        if names.add(row, places).is_none() {
            return all();
        }
    }
    let Some(keys) = names.distinct() else { return all() };
    let mut suspects = twins(keys);
    suspects.extend(&names.repeating);
    suspects.into_iter().map(|i| &*rows[i]).collect()
}

/// Returns the numbers that share their key with another one.
fn twins(keys: &[u64]) -> BTreeSet<usize> {
    let mut numbers: Vec<usize> = (0..keys.len()).collect();
    numbers.sort_unstable_by_key(|i| keys[*i]);
    let same = numbers.chunk_by(|a, b| keys[*a] == keys[*b]);
    same.filter(|same| same.len() > 1).flatten().copied().collect()
}

/// The number of the texts, the neighbour on the other side, and the rest on this side.
type Form = (usize, Option<char>, String);

/// One end of the names of pictures: the texts of the views, and what follows them to one side.
#[derive(Debug, Default)]
struct End {
    /// The forms of this end.
    forms: BTreeSet<Form>,
    /// The hash of the rest on the other side, for each row.
    keys: Vec<u64>,
}

/// The keys of rows: names of different keys are different.
#[derive(Debug, Default)]
struct Keys {
    hasher: RandomState,
    /// Sets of texts of views, with their numbers.
    texts: BTreeMap<Vec<String>, usize>,
    /// Names that are read from their end and from their beginning.
    ends: [End; 2],
    /// The kind of the last row, the number of its texts, and whether two views have the same.
    last: Option<(Arc<RowKind>, usize, bool)>,
    /// The rows with two views of one name.
    repeating: BTreeSet<usize>,
}

impl Keys {
    fn hash(&self, text: &str) -> u64 {
        self.hasher.hash_one(text)
    }

    /// Adds the next row. `None` if its names cannot be compared by parts.
    fn add(&mut self, row: &Row, places: &mut Places) -> Option<()> {
        let Names::Template(template) = &row.kind.names else { return None };
        let [before, _, after] = template.split(&row.fields(0, ""))?;
        if is_odd(&after) {
            return None;
        }
        let (texts, repeats) = self.texts(row, template)?;
        let number = self.ends[0].keys.len();
        if repeats {
            self.repeating.insert(number);
        }
        let (folder, name) = before.split_at(before.rfind('/').map_or(0, |at| at + 1));
        let (place, _) = places.folder(Path::new(folder));
        let before = format!("{}/{name}", place.display());
        let (first, last) = (after.chars().next(), before.chars().next_back());
        let rest = |text: &str, edge: Option<char>| text.len() - edge.map_or(0, char::len_utf8);
        let keys = [
            self.hash(&before[..rest(&before, last)]),
            self.hash(&after[after.len() - rest(&after, first)..]),
        ];
        let forms = [(texts, last, after), (texts, first, before)];
        for ((end, key), form) in self.ends.iter_mut().zip(keys).zip(forms) {
            end.keys.push(key);
            if end.forms.len() <= MOST_ENDS {
                end.forms.insert(form);
            }
        }
        Some(())
    }

    /// Returns the number of the texts of a row's views, and whether two views have the same text.
    /// `None` if a text is not a plain part of a path.
    fn texts(&mut self, row: &Row, template: &Template) -> Option<(usize, bool)> {
        if let Some((kind, number, repeats)) = &self.last
            && Arc::ptr_eq(kind, &row.kind)
        {
            return Some((*number, *repeats));
        }
        let (mut texts, mut count) = (BTreeSet::new(), 0);
        for view in 0..row.kind.views.len() {
            let layers = row.kind.parsed.options.layers.list();
            let text = |layer| Some(template.split(&row.fields(view, layer))?[1].clone());
            // Layers of one name share a file.
            let own: BTreeSet<String> =
                layers.iter().map(|layer| text(layer.name())).collect::<Option<_>>()?;
            count += own.len();
            texts.extend(own);
        }
        if texts.iter().any(|text| is_odd(text) || text.starts_with(['.', '/'])) {
            return None;
        }
        let (repeats, next) = (texts.len() < count, self.texts.len());
        let number = *self.texts.entry(texts.into_iter().collect()).or_insert(next);
        self.last = Some((Arc::clone(&row.kind), number, repeats));
        Some((number, repeats))
    }

    /// Returns keys, if views can be read from one end of the names.
    fn distinct(&self) -> Option<&[u64]> {
        let texts: HashMap<usize, &Vec<String>> =
            self.texts.iter().map(|(texts, number)| (*number, texts)).collect();
        let [from_end, from_begin] = &self.ends;
        let reversed = |form: &Form, text: &str| -> String {
            form.2.chars().rev().chain(text.chars().rev()).chain(form.1).collect()
        };
        let forward = |form: &Form, text: &str| -> String {
            form.2.chars().chain(text.chars()).chain(form.1).collect()
        };
        if is_prefix_free(from_end, &texts, &reversed) {
            return Some(&from_end.keys);
        }
        is_prefix_free(from_begin, &texts, &forward).then_some(&from_begin.keys)
    }
}

/// Returns whether a part of a path is left out of it, or leads to another folder.
fn is_odd(text: &str) -> bool {
    ["//", "/.", "\\"].iter().any(|part| text.contains(part))
}

/// Returns whether no name with one of its characters on the other side begins another one.
fn is_prefix_free(
    end: &End,
    texts: &HashMap<usize, &Vec<String>>,
    name: &dyn Fn(&Form, &str) -> String,
) -> bool {
    let count: usize = end.forms.iter().map(|form| texts[&form.0].len()).sum();
    if end.forms.len() > MOST_ENDS || count > MOST_TEXTS {
        return false;
    }
    let names = end.forms.iter().flat_map(|form| {
        let texts = texts[&form.0].iter();
        texts.map(move |text| name(form, text))
    });
    let names: BTreeSet<String> = names.collect();
    // If a name begins another one, it begins the next one in the order of texts.
    names.iter().zip(names.iter().skip(1)).all(|(name, next)| !next.starts_with(&**name))
}

/// Absolute paths of files that may not exist yet, without links. Two paths of one file are equal.
#[derive(Debug, Default)]
struct Places {
    /// The places of folders, and whether they exist.
    folders: HashMap<PathBuf, (PathBuf, bool)>,
}

impl Places {
    fn of(&mut self, file: &Path) -> PathBuf {
        let (folder, name) = (file.parent().unwrap_or(file), file.file_name().unwrap_or_default());
        self.folder(folder).0.join(name)
    }

    fn folder(&mut self, folder: &Path) -> (PathBuf, bool) {
        if let Some(known) = self.folders.get(folder) {
            return known.clone();
        }
        let Some(last) = folder.components().next_back() else {
            return (std::env::current_dir().unwrap_or_default(), true);
        };
        let (above, exists) = match folder.parent() {
            Some(above) => self.folder(above),
            None => (PathBuf::new(), true),
        };
        let next = match last {
            Component::ParentDir => above.parent().unwrap_or(&above).to_owned(),
            Component::CurDir => above,
            other => above.join(other),
        };
        // Folders that do not exist are created as they are named, and so are those inside.
        let found = if exists { next.canonicalize().ok() } else { None };
        let place = (found.clone().unwrap_or(next), found.is_some());
        self.folders.insert(folder.to_owned(), place.clone());
        place
    }
}

/// Rejects pictures that would replace a file that the model of any row refers to. Pictures of
/// earlier runs carry stamps; only other files take the time to look for all that is read.
pub(super) fn check_inputs(plan: &Plan, rows: &Rows) -> Result<(), Failure> {
    // No model and no texture is an archive.
    if let Some(tars) = plan.tars() {
        return tars.check(plan.indexes());
    }
    let is_foreign = |path: &PathBuf| path.exists() && io::read_stamp(path).is_none();
    let outputs = plan.rows().iter().flat_map(|row| paths(row)).map(|(_, path)| path);
    let foreign: Vec<PathBuf> = outputs.filter(is_foreign).collect();
    if foreign.is_empty() {
        return Ok(());
    }
    let files: BTreeSet<&PathBuf> = rows.rows.iter().map(|row| &row.file).collect();
    let referred = files.iter().filter_map(|file| companions(file)).flatten();
    let textures = rows.rows.iter().filter_map(|row| row.texture());
    let read = Sources::default().with(&files).with(referred.filter_map(|(_, path)| path));
    let skies = rows.rows.iter().filter_map(|row| row.sky());
    let read = read.with(textures).with(skies);
    foreign.iter().try_for_each(|path| read.spare(path)).map_err(Failure::from)
}

#[cfg(test)]
mod tests {
    use super::super::tests::jobs_of;

    /// Returns whether two jobs of these arguments have one file, by comparing all.
    fn has_twins(arguments: &[&str]) -> bool {
        let mut parts = std::collections::BTreeSet::new();
        // Numbers in the names keep the pictures apart, whatever the template.
        let at = arguments.iter().position(|it| *it == "--out").unwrap() + 1;
        let mut apart = arguments.to_vec();
        apart[at] = "{index}.png";
        let template = super::super::template::Template::parse(arguments[at]).unwrap();
        jobs_of(&apart).unwrap().iter().any(|job| {
            let fields = job.row.fields(job.view(), "color");
            !parts.insert(template.path(&fields))
        })
    }

    #[test]
    fn names_are_compared_by_rows_as_if_all_were_compared() {
        let models = ["a.obj", "a1.obj", "x/a.obj", "b/a1.obj", "1a.obj", "a-1.obj", "11.obj"];
        let templates = [
            "{stem}-{view:03}.png",
            "{stem}-{view}.png",
            "{stem}{view}.png",
            "{view}{stem}.png",
            "{view}-{stem}.png",
            "{dir}/{stem}-{view}.png",
            "{dir}/{view}/{stem}.png",
            "{view:03}/{dir}/{stem}.png",
            "{stem}/{view_name}.png",
            "{name}{view_name}.png",
            "{stem}.png",
            "{dir}-{stem}-1{view}.png",
            "{stem}-{index}.png",
            "{stem}{index}.png",
            "{index}{view}.png",
            "{view}.png",
            "x/./{view}//{dir}/{stem}.png",
        ];
        let mut found = [0, 0];
        for template in templates {
            for views in ["1", "2", "12", "front,top"] {
                for (i, first) in models.iter().enumerate() {
                    for second in &models[i..] {
                        let end = ["--views", views, "--out", template];
                        let arguments = [&[*first, *second][..], &end].concat();
                        let twins = has_twins(&arguments);
                        let rejected = jobs_of(&arguments).is_err();
                        assert_eq!(rejected, twins, "{arguments:?}");
                        found[usize::from(twins)] += 1;
                    }
                }
            }
        }
        assert!(found.iter().all(|count| *count > 200), "{found:?}");
    }
}
