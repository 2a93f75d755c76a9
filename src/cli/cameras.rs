//! `cameras.json`: the cameras of pictures with layers, and the meaning of their ids.
//!
//! The file has the fields of nerfstudio's `transforms.json`, so `--views` reads it again. Further
//! fields have the matrices with the axes of OpenGL and of OpenCV. A run replaces the entries of
//! its pictures and keeps the others, except in data sets. Entries are never all in memory.

use std::collections::btree_map::Entry::Vacant;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};

use marraztu_core::accuracy::Shot;
use marraztu_core::scene::{Intrinsics, Projection};
use marraztu_io::{NewFile, SaveError, Spool};
use marraztu_render::{AxesConvention, LayerNames, PictureCamera};
use serde::Deserializer;
use serde::de::{DeserializeSeed, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value, json};

use super::failure::Failure;
use super::layers::{LayerFile, LayerOptions, OutputLayer};
use super::page::parts_between;
use super::split::{self, Split};
use super::talk::note;

/// The usual name of the file.
pub(crate) const CAMERAS: &str = "cameras.json";

/// The camera of a picture, as an entry of the file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CameraFrame {
    /// The folder of the description.
    folder: PathBuf,
    /// The scene, as named in the entry.
    scene: String,
    entry: Map<String, Value>,
    /// The meaning of the ids, if the picture has any.
    ids: Option<Value>,
}

/// Returns the rows of a matrix.
fn rows(matrix: glam::DMat4) -> Value {
    json!(matrix.transpose().to_cols_array_2d())
}

impl CameraFrame {
    /// Describes the camera of a picture. `folder` gets the description, `files` has the layers,
    /// and `names` is given if ids are among them.
    pub(crate) fn new(
        shot: &Shot,
        (folder, files): (&Path, &[LayerFile]),
        (scene, view): (String, &str),
        (options, names): (&LayerOptions, Option<&LayerNames>),
    ) -> Self {
        let camera = PictureCamera::of(shot);
        let shown = |file: &LayerFile| {
            let parts = parts_between(&folder.join(CAMERAS), &file.path);
            parts.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
        };
        let layers = files.iter().flat_map(|file| {
            let path = shown(file);
            file.layers.iter().map(move |layer| (*layer, path.clone()))
        });
        let layers: Vec<(OutputLayer, String)> = layers.collect();
        let path_of = |name: &str| {
            let found = layers.iter().find(|(layer, _)| layer.name() == name);
            found.map(|(_, path)| path.clone())
        };
        let poses = |axes: AxesConvention| {
            json!({
                "c2w": rows(camera.world_from_camera(axes)),
                "w2c": rows(camera.camera_from_world(axes)),
            })
        };
        let Intrinsics { focal, principal_point, size } = camera.intrinsics;
        let angle = |side: usize, focal: f64| {
            #[expect(clippy::cast_precision_loss, reason = "at most 16,384 pixels")]
            let half = side as f64 / 2.0;
            json!(2.0 * libm::atan(half / focal))
        };
        let mut entry = Map::new();
        let mut add = |name: &str, value: Value| entry.insert(name.to_owned(), value);
        add("file_path", json!(path_of("color").or_else(|| files.first().map(shown))));
        add("depth_scale", json!(options.png().depth_scale));
        add("normal_space", json!(options.space_name()));
        for (name, layer) in [("depth_file_path", "depth"), ("mask_path", "mask")] {
            if let Some(path) = path_of(layer) {
                add(name, json!(path));
            }
        }
        let by_name = layers.iter().map(|(layer, path)| (layer.name().to_owned(), json!(path)));
        add("layers", Value::Object(by_name.collect()));
        add("scene", json!(scene));
        add("view", json!(view));
        add("w", json!(size.width));
        add("h", json!(size.height));
        match camera.projection {
            Projection::Perspective => {
                add("projection", json!("perspective"));
                add("fl_x", json!(focal.x));
                add("fl_y", json!(focal.y));
                add("camera_angle_x", angle(size.width, focal.x));
                add("camera_angle_y", angle(size.height, focal.y));
            }
            Projection::Orthographic => {
                add("projection", json!("orthographic"));
                add("pixels_per_unit", json!(focal.y));
                if focal.x != focal.y {
                    add("pixel_aspect", json!(focal.y / focal.x));
                }
            }
        }
        add("cx", json!(principal_point.x));
        add("cy", json!(principal_point.y));
        add("near", json!(camera.near));
        add("far", json!(camera.far));
        add("K", json!(camera.k()));
        add("transform_matrix", rows(camera.world_from_camera(AxesConvention::OpenGl)));
        add("opengl", poses(AxesConvention::OpenGl));
        add("opencv", poses(AxesConvention::OpenCv));
        Self { folder: folder.to_owned(), scene, entry, ids: names.map(ids) }
    }

    /// Formats the camera of one picture with the meaning of its ids, as a JSON object.
    pub(crate) fn json(&self) -> Vec<u8> {
        let mut entry = self.entry.clone();
        entry.extend(self.ids.clone().map(|ids| ("ids".to_owned(), ids)));
        Value::Object(entry).to_string().into_bytes()
    }

    /// Returns the name that tells entries apart.
    fn file_path(entry: &Map<String, Value>) -> &str {
        entry.get("file_path").and_then(Value::as_str).unwrap_or_default()
    }
}

/// Lists ids with their names.
pub(super) fn ids(names: &LayerNames) -> Value {
    let objects = (1..).zip(&names.objects);
    let objects = objects.map(|(id, object): (i32, _)| json!({"id": id, "name": object.name}));
    let parts = (1..)
        .zip(&names.parts)
        .map(|(id, part): (i32, _)| json!({"id": id, "object": part.object, "name": part.name}));
    let materials = (1..).zip(&names.materials);
    let materials = materials.map(|(id, name): (i32, _)| json!({"id": id, "name": name}));
    json!({
        "objects": objects.collect::<Vec<_>>(),
        "parts": parts.collect::<Vec<_>>(),
        "materials": materials.collect::<Vec<_>>(),
    })
}

/// The cameras of a folder: the places of entries by the path of their picture, and of the meaning
/// of ids by scene.
#[derive(Debug, Default)]
struct FolderCameras {
    entries: BTreeMap<String, Range<u64>>,
    ids: BTreeMap<String, Range<u64>>,
}

/// The cameras of all pictures of a run. They wait in a file, because there may be millions.
#[derive(Debug)]
pub(crate) struct Cameras {
    name: String,
    earlier: Earlier,
    split: Option<Split>,
    /// The file of seed points, if there is one.
    ply: Option<&'static str>,
    folders: BTreeMap<PathBuf, FolderCameras>,
    spool: Option<Spool>,
}

/// What happens to the entries of earlier runs for other pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Earlier {
    Kept,
    Dropped,
}

impl Cameras {
    /// Begins to collect cameras for files of this name, in the folders of the pictures, and for
    /// the parts of a data set, if it has any, with its file of seed points.
    pub(crate) fn new(
        name: String,
        earlier: Earlier,
        (split, ply): (Option<Split>, Option<&'static str>),
    ) -> Self {
        Self { name, earlier, split, ply, folders: BTreeMap::new(), spool: None }
    }

    /// Adds the camera of a picture. Fails if it cannot be written.
    pub(crate) fn add(&mut self, frame: CameraFrame) -> Result<(), SaveError> {
        let CameraFrame { folder, scene, entry, ids } = frame;
        let spool = spool_in(&mut self.spool, &folder)?;
        let cameras = self.folders.entry(folder).or_default();
        let path = CameraFrame::file_path(&entry).to_owned();
        cameras.entries.insert(path, pushed(spool, &Value::Object(entry))?);
        if let (Some(ids), Vacant(vacant)) = (ids, cameras.ids.entry(scene)) {
            vacant.insert(pushed(spool, &ids)?);
        }
        Ok(())
    }

    /// Writes the files. Fails if one cannot be written, or a file of another program has its name.
    pub(crate) fn write(mut self) -> Result<(), Failure> {
        for (folder, mut cameras) in std::mem::take(&mut self.folders) {
            let path = folder.join(&self.name);
            let spool = spool_in(&mut self.spool, &folder)?;
            if self.earlier == Earlier::Kept {
                cameras.add_earlier(&path, spool)?;
            }
            let mut file = NewFile::begin(&path)?;
            let program = json!(env!("CARGO_PKG_VERSION"));
            let ply = self.ply.map(|ply| format!("\"ply_file_path\": \"{ply}\",\n"));
            let ply = ply.unwrap_or_default();
            let head =
                format!("{{\"marraztu\": {program}, \"pixel_center\": 0.5,\n{ply}\"ids\": {{\n");
            file.push(head.as_bytes())?;
            for (i, (scene, place)) in cameras.ids.iter().enumerate() {
                let begin = if i == 0 { "" } else { ",\n" };
                file.push(format!("{begin}{}: ", json!(scene)).as_bytes())?;
                file.push(&spool.get(place)?)?;
            }
            file.push(b"\n},\n\"frames\": [\n")?;
            for (i, place) in cameras.entries.values().enumerate() {
                let comma: &[u8] = if i == 0 { b"" } else { b",\n" };
                file.push(comma)?;
                file.push(&spool.get(place)?)?;
            }
            file.push(b"\n]}\n")?;
            file.finish()?;
            if let Some(split) = self.split {
                cameras.write_parts(&folder, spool, split)?;
            }
        }
        Ok(())
    }
}

/// Returns the name of the file of a part of a data set.
pub(crate) fn part_name(part: &str) -> String {
    format!("transforms_{part}.json")
}

impl FolderCameras {
    /// Writes the files of the parts of a data set.
    fn write_parts(&self, folder: &Path, spool: &mut Spool, split: Split) -> Result<(), Failure> {
        let mut angles = BTreeSet::new();
        let head = format!("{{\"marraztu\": {}", json!(env!("CARGO_PKG_VERSION")));
        for part in split.parts() {
            let path = folder.join(part_name(part));
            let mut file = NewFile::begin(&path)?;
            let mut begin = String::new();
            let own = self.entries.values().zip(split.of_pictures()).filter(|(_, it)| *it == part);
            for (place, _) in own {
                let full: Map<String, Value> =
                    serde_json::from_slice(&spool.get(place)?).unwrap_or_default();
                let angle = full.get("camera_angle_x").map(Value::to_string).unwrap_or_default();
                if begin.is_empty() {
                    begin = format!("{head}, \"camera_angle_x\": {angle},\n\"frames\": [\n");
                }
                angles.insert(angle);
                file.push(format!("{begin}{}", split::entry(&full)).as_bytes())?;
                ",\n".clone_into(&mut begin);
            }
            if begin.is_empty() {
                file.push(format!("{head}, \"frames\": [").as_bytes())?;
            }
            file.push(b"\n]}\n")?;
            file.finish()?;
        }
        if angles.len() > 1 {
            note(&format_args!(
                "{}: the pictures have different angles of view, and a file of a part has one: use \
                 transforms.json",
                folder.display()
            ));
        }
        Ok(())
    }

    /// Adds the entries of an earlier run, if there is one, for other pictures and scenes.
    fn add_earlier(&mut self, path: &Path, spool: &mut Spool) -> Result<(), Failure> {
        let mut failed = None;
        let mut add = |piece: Piece| {
            let (places, name, value) = match piece {
                Piece::Ids(scene, ids) => (&mut self.ids, scene, ids),
                Piece::Entry(entry) => {
                    let name = CameraFrame::file_path(&entry).to_owned();
                    (&mut self.entries, name, Value::Object(entry))
                }
            };
            let Vacant(vacant) = places.entry(name) else { return };
            match pushed(spool, &value) {
                Ok(place) => _ = vacant.insert(place),
                Err(error) => failed = Some(error),
            }
        };
        read(path, &mut add)?;
        failed.map_or(Ok(()), |error| Err(error.into()))
    }
}

/// Returns the file of waiting records, which is created in the folder of the first one.
fn spool_in<'a>(spool: &'a mut Option<Spool>, folder: &Path) -> Result<&'a mut Spool, SaveError> {
    let begun = match spool.take() {
        Some(spool) => spool,
        None => Spool::begin(folder)?,
    };
    Ok(spool.insert(begun))
}

fn pushed(spool: &mut Spool, value: &Value) -> Result<Range<u64>, SaveError> {
    spool.push(value.to_string().as_bytes())
}

/// Checks, before anything is drawn, that the file at `path` is missing or one of an earlier run,
/// also of a part of a data set. Fails if it has other content.
pub(crate) fn check_cameras(path: &Path) -> Result<(), Failure> {
    read(path, &mut |_piece| {})
}

/// A part of the file.
enum Piece {
    /// The meaning of ids in a scene.
    Ids(String, Value),
    Entry(Map<String, Value>),
}

/// A function that takes the parts of a file.
type Take<'a> = &'a mut dyn FnMut(Piece);

/// Reads a file of an earlier run, if there is one, entry by entry.
fn read(path: &Path, take: Take<'_>) -> Result<(), Failure> {
    let file = match File::open(path) {
        Ok(file) => BufReader::new(file),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(()),
        Err(error) => return Err(Failure::Write(path.to_owned(), error)),
    };
    let mut json = serde_json::Deserializer::from_reader(file);
    let whole = json.deserialize_map(FileReader(take)).and_then(|()| json.end());
    whole.map_err(|_other_content| {
        let reason = "a file with this name exists and has other content";
        Failure::Write(path.to_owned(), std::io::Error::other(reason))
    })
}

/// Reads the fields of the file.
struct FileReader<'a>(Take<'a>);

impl<'de> Visitor<'de> for FileReader<'_> {
    type Value = ();

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("cameras")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let mut missing = ["marraztu", "frames"].map(Some);
        while let Some(name) = map.next_key::<String>()? {
            for field in &mut missing {
                field.take_if(|field| **field == *name);
            }
            match &*name {
                "marraztu" => drop(map.next_value::<String>()?),
                "pixel_center" | "camera_angle_x" => _ = map.next_value::<f64>()?,
                "ids" => {
                    let ids: BTreeMap<String, Value> = map.next_value()?;
                    ids.into_iter().for_each(|(scene, ids)| (self.0)(Piece::Ids(scene, ids)));
                }
                "frames" => map.next_value_seed(EntryReader(&mut *self.0))?,
                _ => _ = map.next_value::<IgnoredAny>()?,
            }
        }
        let missing = missing.into_iter().flatten().next();
        missing.map_or(Ok(()), |field| Err(A::Error::missing_field(field)))
    }
}

/// Reads the list of entries.
struct EntryReader<'a>(Take<'a>);

impl<'de> DeserializeSeed<'de> for EntryReader<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, list: D) -> Result<(), D::Error> {
        list.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for EntryReader<'_> {
    type Value = ();

    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("a list of cameras")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        while let Some(entry) = list.next_element()? {
            (self.0)(Piece::Entry(entry));
        }
        Ok(())
    }
}
