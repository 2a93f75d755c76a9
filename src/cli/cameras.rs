//! `cameras.json`: the cameras of pictures with layers, and the meaning of their ids.
//!
//! The file has the fields of nerfstudio's `transforms.json`, so `--views` reads it again. Further
//! fields have the matrices with the axes of OpenGL and of OpenCV. A run replaces the entries of
//! its pictures and keeps the others.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use marraztu_core::accuracy::Shot;
use marraztu_core::scene::Projection;
use marraztu_io as io;
use marraztu_render::{AxesConvention, LayerNames, PictureCamera};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::failure::Failure;
use super::layers::{LayerFile, LayerOptions, OutputLayer};
use super::page::parts_between;

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

/// The content of the file.
#[derive(Debug, Serialize, Deserialize)]
struct CameraFile {
    /// The program's version.
    marraztu: String,
    /// The position of the first pixel's centre.
    pixel_center: f64,
    /// The meaning of ids, by scene.
    #[serde(default)]
    ids: BTreeMap<String, Value>,
    frames: Vec<Map<String, Value>>,
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
        let centre = camera.centre();
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
        add("w", json!(shot.size.width));
        add("h", json!(shot.size.height));
        match camera.projection {
            Projection::Perspective => {
                add("projection", json!("perspective"));
                add("fl_x", json!(camera.focal));
                add("fl_y", json!(camera.focal));
                add("camera_angle_x", json!(2.0 * libm::atan(centre.x / camera.focal)));
            }
            Projection::Orthographic => {
                add("projection", json!("orthographic"));
                add("pixels_per_unit", json!(camera.focal));
            }
        }
        add("cx", json!(centre.x));
        add("cy", json!(centre.y));
        add("near", json!(camera.near));
        add("far", json!(camera.far));
        add("K", json!(camera.intrinsics()));
        add("transform_matrix", rows(camera.world_from_camera(AxesConvention::OpenGl)));
        add("opengl", poses(AxesConvention::OpenGl));
        add("opencv", poses(AxesConvention::OpenCv));
        Self { folder: folder.to_owned(), scene, entry, ids: names.map(ids) }
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

/// Writes the cameras of pictures to files of this name, in the folders of the pictures. Fails if a
/// file cannot be written, or a file of another program has the name.
pub(crate) fn write_cameras(name: &str, frames: Vec<CameraFrame>) -> Result<(), Failure> {
    let mut folders: BTreeMap<PathBuf, Vec<CameraFrame>> = BTreeMap::new();
    for frame in frames {
        folders.entry(frame.folder.clone()).or_default().push(frame);
    }
    for (folder, frames) in folders {
        let path = folder.join(name);
        let (mut ids, mut all) = match read(&path)? {
            Some(file) => (file.ids, entries(file.frames)),
            None => (BTreeMap::new(), BTreeMap::new()),
        };
        for CameraFrame { scene, entry, ids: own, .. } in frames {
            ids.extend(own.map(|own| (scene, own)));
            all.extend(entries(vec![entry]));
        }
        io::save_encoded(&path, &written(&ids, all.into_values()))?;
    }
    Ok(())
}

/// Checks, before anything is drawn, that the file at `path` is missing or one of an earlier run.
/// Fails if it has other content.
pub(crate) fn check_cameras(path: &Path) -> Result<(), Failure> {
    read(path).map(drop)
}

fn entries(frames: Vec<Map<String, Value>>) -> BTreeMap<String, Map<String, Value>> {
    let named = |entry: Map<String, Value>| (CameraFrame::file_path(&entry).to_owned(), entry);
    frames.into_iter().map(named).collect()
}

/// Reads a file of an earlier run, if there is one.
fn read(path: &Path) -> Result<Option<CameraFile>, Failure> {
    let content = match std::fs::read(path) {
        Ok(content) => content,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(Failure::Write(path.to_owned(), error)),
    };
    serde_json::from_slice(&content).map(Some).map_err(|_other_content| {
        let reason = "a file with this name exists and has other content";
        Failure::Write(path.to_owned(), std::io::Error::other(reason))
    })
}

/// Formats the file, with a line for each entry.
fn written(
    ids: &BTreeMap<String, Value>,
    frames: impl Iterator<Item = Map<String, Value>>,
) -> Vec<u8> {
    let lines: Vec<String> = frames.map(|entry| Value::Object(entry).to_string()).collect();
    let ids: Vec<String> =
        ids.iter().map(|(scene, ids)| format!("{}: {ids}", json!(scene))).collect();
    format!(
        "{{\"marraztu\": {}, \"pixel_center\": 0.5,\n\"ids\": {{\n{}\n}},\n\
         \"frames\": [\n{}\n]}}\n",
        json!(env!("CARGO_PKG_VERSION")),
        ids.join(",\n"),
        lines.join(",\n"),
    )
    .into_bytes()
}
