//! The tables of data sets: JSON files that describe all pictures.
//!
//! Pictures finish in any order, their models are numbered by all names, and there may be millions
//! of them. The entries of a picture are therefore written to a file at once, with gaps for the
//! numbers, and copied into the tables at the end. Only their places are held in memory.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::{DMat3, DMat4};
use marraztu_io::{NewFile, SaveError, Spool};
use marraztu_render::AxesConvention;
use serde_json::{Value, json};

use super::dataset::{Dataset, DatasetImage, DatasetObject, nine};
use super::jobs::Job;
use super::models::{BopModel, MILLIMETRES};
use crate::cli::failure::Failure;

/// The beginning of a gap in the text of an entry. No other text in an entry has this character.
const GAP: &str = "\u{1}";

/// The beginning of a gap in JSON.
const GAP_IN_JSON: &str = "\"\\u0001";

/// The gap for the number of an entry of the instances.
const INSTANCE: &str = "next";

/// A data set with tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Bop,
    Coco,
}

/// Collects the entries of the pictures of a data set.
#[derive(Debug)]
pub(super) struct Tables {
    kind: Kind,
    folder: PathBuf,
    /// The numbers of the models in the order in which they come.
    models: BTreeMap<PathBuf, usize>,
    pictures: Vec<Entries>,
    /// Three files of entries, after the first picture.
    spools: Option<[Spool; 3]>,
    /// The geometry of the models of BOP, and the entries that describe it.
    geometry: Option<Spool>,
    geometries: Vec<(Range<u64>, Value)>,
}

/// The entries of a picture.
#[derive(Debug)]
struct Entries {
    /// The numbers of the row, the view and the picture.
    row: usize,
    view: usize,
    index: usize,
    places: [Range<u64>; 3],
}

impl Tables {
    /// Begins the tables of a data set in a folder. `None` if its cameras are the only table.
    pub(super) fn of(dataset: Dataset, folder: &Path) -> Option<Self> {
        let kind = match dataset {
            Dataset::Nerf => return None,
            Dataset::Bop => Kind::Bop,
            Dataset::Coco => Kind::Coco,
        };
        let (models, pictures, folder) = (BTreeMap::new(), Vec::new(), folder.to_owned());
        let (geometry, geometries) = (None, Vec::new());
        Some(Self { kind, folder, models, pictures, spools: None, geometry, geometries })
    }

    /// Adds a picture. Fails if it cannot be written.
    pub(super) fn add(&mut self, job: &Job, image: &DatasetImage) -> Result<(), SaveError> {
        if self.kind == Kind::Bop {
            for object in &image.objects {
                if !self.models.contains_key(&object.model) {
                    self.models.insert(object.model.clone(), self.models.len());
                    self.add_geometry(object)?;
                }
            }
        }
        let mut gap = |object: &DatasetObject| {
            let next = self.models.len();
            let number = match self.models.get(&object.model) {
                Some(number) => *number,
                None => *self.models.entry(object.model.clone()).or_insert(next),
            };
            format!("{GAP}{number}")
        };
        let texts = match self.kind {
            Kind::Bop => bop_entries(image, &mut gap),
            Kind::Coco => coco_entries(job, image, &mut gap),
        };
        let begin = || Spool::begin(&self.folder);
        let spools = match self.spools.take() {
            Some(spools) => spools,
            None => [begin()?, begin()?, begin()?],
        };
        let spools = self.spools.insert(spools);
        let mut places = [0..0, 0..0, 0..0];
        for ((place, spool), text) in places.iter_mut().zip(spools).zip(texts) {
            *place = spool.push(text.as_bytes())?;
        }
        let (row, view, index) = (job.row.number, job.view(), job.index);
        self.pictures.push(Entries { row, view, index, places });
        Ok(())
    }

    /// Adds the geometry of a new model.
    fn add_geometry(&mut self, object: &DatasetObject) -> Result<(), SaveError> {
        let spool = match self.geometry.take() {
            Some(spool) => spool,
            None => Spool::begin(&self.folder)?,
        };
        let (spool, model) = (self.geometry.insert(spool), BopModel::new(&object.loaded));
        self.geometries.push((spool.push(&model.ply())?, model.info()));
        Ok(())
    }

    /// Writes the tables. Fails if a file cannot be written.
    pub(super) fn write(mut self) -> Result<(), Failure> {
        let models = std::mem::take(&mut self.models);
        let named = Models::of(models.keys().map(PathBuf::as_path).collect());
        let mut numbers = vec![0; models.len()];
        for (path, at) in &models {
            numbers[*at] = named.numbers[&**path];
        }
        match self.kind {
            Kind::Bop => self.write_bop(&named, &numbers),
            Kind::Coco => self.write_coco(&named, &numbers),
        }
    }

    fn write_bop(&mut self, models: &Models<'_>, numbers: &[usize]) -> Result<(), Failure> {
        // Views are names, and sorted as such.
        self.pictures.sort_by_cached_key(|picture| (picture.row, picture.view.to_string()));
        for scene in self.pictures.chunk_by(|a, b| a.row == b.row) {
            let folder = self.folder.join(format!("{:06}", scene[0].row));
            let names = ["scene_camera", "scene_gt", "scene_gt_info"];
            let spools = self.spools.iter_mut().flatten();
            for (table, (name, spool)) in names.into_iter().zip(spools).enumerate() {
                let mut file = begin(&folder.join(format!("{name}.json")))?;
                for (i, picture) in scene.iter().enumerate() {
                    let comma = if i == 0 { "{" } else { "," };
                    let text = filled(spool, &picture.places[table], &mut |at| numbers[at], 0)?.0;
                    file.push(format!("{comma}\"{}\":{text}", picture.view).as_bytes())?;
                }
                file.push(b"}\n")?;
                file.finish()?;
            }
        }
        let names: BTreeMap<String, &str> =
            models.iter().map(|(id, name)| (id.to_string(), name)).collect();
        let mut file = begin(&self.folder.join("models.json"))?;
        file.push(format!("{}\n", json!(names)).as_bytes())?;
        file.finish()?;
        let folder = self.folder.join("models");
        let mut infos = BTreeMap::new();
        for (number, (place, info)) in numbers.iter().zip(&self.geometries) {
            let Some(geometry) = &mut self.geometry else { continue };
            let mut file = begin(&folder.join(format!("obj_{number:06}.ply")))?;
            file.push(&geometry.get(place)?)?;
            file.finish()?;
            infos.insert(number.to_string(), info);
        }
        let mut file = begin(&folder.join("models_info.json"))?;
        file.push(format!("{}\n", json!(infos)).as_bytes())?;
        Ok(file.finish()?)
    }

    fn write_coco(&mut self, models: &Models<'_>, numbers: &[usize]) -> Result<(), Failure> {
        self.pictures.sort_unstable_by_key(|picture| picture.index);
        let category = |(id, name): (usize, &str)| {
            let kind = "model";
            json!({"id": id, "name": name, "isthing": 1, "supercategory": kind})
        };
        let categories: Value = models.iter().map(category).collect();
        for (table, name) in [(1, "panoptic"), (2, "instances")] {
            let path = self.folder.join(format!("annotations/{name}.json"));
            let mut file = begin(&path)?;
            file.push(b"{\"annotations\":[")?;
            self.copy(table, numbers, &mut file)?;
            file.push(format!("],\"categories\":{categories},\"images\":[").as_bytes())?;
            self.copy(0, numbers, &mut file)?;
            file.push(b"]}\n")?;
            file.finish()?;
        }
        Ok(())
    }

    /// Copies the entries of a table, with commas between.
    fn copy(&mut self, table: usize, numbers: &[usize], to: &mut NewFile) -> Result<(), SaveError> {
        let Some(spools) = &mut self.spools else { return Ok(()) };
        let (mut comma, mut instances) = ("", 0);
        for picture in &self.pictures {
            let place = &picture.places[table];
            let (text, after) =
                filled(&mut spools[table], place, &mut |at| numbers[at], instances)?;
            instances = after;
            if !text.is_empty() {
                to.push(comma.as_bytes())?;
                to.push(text.as_bytes())?;
                comma = ",";
            }
        }
        Ok(())
    }
}

/// Begins a table, and creates its folder.
fn begin(path: &Path) -> Result<NewFile, Failure> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::Write(folder.to_owned(), error))?;
    }
    Ok(NewFile::begin(path)?)
}

/// Reads an entry and fills its gaps. `instances` is the number of earlier instances; returns it
/// with the ones of this entry.
fn filled(
    spool: &mut Spool,
    place: &Range<u64>,
    number: &mut dyn FnMut(usize) -> usize,
    mut instances: usize,
) -> Result<(String, usize), SaveError> {
    let record = spool.get(place)?;
    let text = String::from_utf8_lossy(&record);
    let mut parts = text.split(GAP_IN_JSON);
    let mut whole = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (gap, rest) = part.split_once('"').unwrap_or((part, ""));
        let filled = if gap == INSTANCE {
            instances += 1;
            instances
        } else {
            number(gap.parse().unwrap_or_default())
        };
        whole += &filled.to_string();
        whole += rest;
    }
    Ok((whole, instances))
}

/// Returns the entries of a picture of BOP: camera, poses, and facts of the objects.
fn bop_entries(image: &DatasetImage, gap: &mut dyn FnMut(&DatasetObject) -> String) -> [String; 3] {
    // The centre of the first pixel is (0, 0) there.
    let mut k = image.camera.k();
    k[0][2] -= 0.5;
    k[1][2] -= 0.5;
    let w2c = image.camera.camera_from_world(AxesConvention::OpenCv);
    let millimetres = |pose: DMat4| (pose.w_axis.truncate() * MILLIMETRES).to_array();
    let camera = json!({
        "cam_K": k.as_flattened(),
        "cam_R_w2c": nine(DMat3::from_mat4(w2c)),
        "cam_t_w2c": millimetres(w2c),
        "depth_scale": MILLIMETRES / image.depth_scale,
    });
    let pose = |object: &DatasetObject| {
        json!({
            "cam_R_m2c": nine(DMat3::from_mat4(object.camera_from_model)),
            "cam_t_m2c": millimetres(object.camera_from_model),
            "obj_id": gap(object),
        })
    };
    let poses: Value = image.objects.iter().map(pose).collect();
    #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 pixels")]
    let info = |object: &DatasetObject| {
        let DatasetObject { visible, alone, whole, .. } = object;
        // An invisible object has no box, and boxes end in the middle of their last pixels:
        // calc_gt_info.py and calc_2d_bbox of bop_toolkit.
        let box_of = |[x, y, width, height]: [i64; 4]| match visible.count {
            0 => [-1; 4],
            _ => [x, y, width - 1, height - 1],
        };
        json!({
            "bbox_obj": box_of(whole.bounds),
            "bbox_visib": box_of(visible.bounds),
            "px_count_all": whole.count,
            "px_count_valid": alone,
            "px_count_visib": visible.count,
            "visib_fract": visible.count as f64 / whole.count.max(1) as f64,
        })
    };
    let infos: Value = image.objects.iter().map(info).collect();
    [camera, poses, infos].map(|entry| entry.to_string())
}

/// Returns the entries of a picture of COCO: the picture, its segments, and its instances.
fn coco_entries(
    job: &Job,
    image: &DatasetImage,
    gap: &mut dyn FnMut(&DatasetObject) -> String,
) -> [String; 3] {
    let (id, size) = (job.index + 1, image.camera.intrinsics.size);
    let name = job.out().file_name().map(|name| name.to_string_lossy());
    let picture = json!({
        "id": id, "file_name": name, "width": size.width, "height": size.height,
    });
    let (mut segments, mut instances) = (Vec::new(), Vec::new());
    for object in &image.objects {
        let (visible, category) = (object.visible, gap(object));
        if visible.count == 0 {
            continue;
        }
        segments.push(json!({
            "id": object.id, "category_id": category, "area": visible.count,
            "bbox": visible.bounds, "iscrowd": 0,
        }));
        let instance = json!({
            "id": format!("{GAP}{INSTANCE}"), "image_id": id, "category_id": category,
            "segmentation": {"size": [size.height, size.width], "counts": object.runs},
            "area": visible.count, "bbox": visible.bounds, "iscrowd": 0,
        });
        instances.push(instance.to_string());
    }
    let panoptic = json!({"image_id": id, "file_name": name, "segments_info": segments});
    [picture.to_string(), panoptic.to_string(), instances.join(",")]
}

/// The models of a data set, with their numbers from 1 on.
struct Models<'a> {
    names: Vec<String>,
    numbers: BTreeMap<&'a Path, usize>,
}

impl<'a> Models<'a> {
    /// Numbers the models in the order of their names: the names of their files, with as many
    /// folders as tell them apart.
    fn of(models: Vec<&'a Path>) -> Self {
        let name = |path: &Path, parts: usize| {
            let all: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
            all[all.len().saturating_sub(parts)..].join("/")
        };
        let longest = models.iter().map(|path| path.iter().count()).max().unwrap_or(0);
        let (mut named, mut rest) = (Vec::new(), models);
        for parts in 1..=longest {
            let mut by_name: BTreeMap<String, Vec<&Path>> = BTreeMap::new();
            for path in std::mem::take(&mut rest) {
                by_name.entry(name(path, parts)).or_default().push(path);
            }
            for (name, paths) in by_name {
                match paths[..] {
                    [path] => named.push((name, path)),
                    // Names that are not UTF-8 may look the same in their whole length.
                    _ if parts == longest => {
                        named.extend(paths.into_iter().map(|path| (name.clone(), path)));
                    }
                    _ => rest.extend(paths),
                }
            }
        }
        named.sort();
        let numbers = named.iter().zip(1..).map(|((_, path), number)| (*path, number)).collect();
        Self { names: named.into_iter().map(|(name, _)| name).collect(), numbers }
    }

    /// Iterates over numbers and names.
    fn iter(&self) -> impl Iterator<Item = (usize, &str)> {
        (1..).zip(self.names.iter().map(String::as_str))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_of_one_name_are_told_apart_by_their_folders() {
        let paths = ["/x/a/model.obj", "/x/b/model.obj", "/x/cow.obj", "/y/b/model.obj", "tin"];
        let models = Models::of(paths.iter().map(Path::new).collect());
        let names = ["a/model.obj", "cow.obj", "tin", "x/b/model.obj", "y/b/model.obj"];
        assert_eq!(models.iter().map(|(_, name)| name).collect::<Vec<_>>(), names);
        assert_eq!(models.iter().map(|(id, _)| id).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
        assert_eq!(models.numbers[Path::new("/y/b/model.obj")], 5);
    }

    #[test]
    fn gaps_are_filled_with_numbers_and_nothing_else_changes() {
        let folder = tempfile::tempdir().unwrap();
        let mut spool = Spool::begin(folder.path()).unwrap();
        let entry = json!({
            "a": format!("{GAP}1"), "b": "\"quoted\" \\u0001", "c": format!("{GAP}{INSTANCE}"),
            "d": [format!("{GAP}{INSTANCE}"), 0.1 + 0.2],
        });
        let place = spool.push(entry.to_string().as_bytes()).unwrap();
        let (text, instances) = filled(&mut spool, &place, &mut |at| [7, 9][at], 4).unwrap();
        let expected = r#"{"a":9,"b":"\"quoted\" \\u0001","c":5,"d":[6,0.30000000000000004]}"#;
        assert_eq!((&*text, instances), (expected, 6));
    }
}
