//! `--dataset`: the folders and tables of data sets for training.
//!
//! * `nerf`, for each model: `STEM/{color,depth,mask}/00000.png` and `STEM/transforms.json`.
//! * `bop`, for each model or scene: `000000/{rgb,depth}/000000.png`,
//!   `000000/{mask,mask_visib}/000000_000000.png`, and the tables `scene_camera.json`,
//!   `scene_gt.json` and `scene_gt_info.json`.
//! * `coco`: `images/000000.png`, `panoptic/000000.png`, and the tables
//!   `annotations/{panoptic,instances}.json`.
//!
//! A unit of the model is a metre; BOP has millimetres. Sources of the formats:
//! `bop_datasets_format.md` of bop_toolkit, <https://cocodataset.org/#format-data>, and
//! nerfstudio's page on data conventions.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use glam::{DMat3, DMat4};
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Command, Item, ObjectId, Projection, UpAxis};
use marraztu_io::{self as io, LayerKind, LayerNumbers, LayerPicture, PngNumbers};
use marraztu_render::{AxesConvention, Layer, LayerSet, NormalSpace, PictureCamera, Renderer};
use serde_json::{Value, json};

use super::jobs::Job;
use super::outcome::Fault;
use super::template::{Fields, stem};
use crate::cli::failure::Failure;

/// Millimetres per unit.
const MILLIMETRES: f64 = 1000.0;

/// A kind of data set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dataset {
    Nerf,
    Bop,
    Coco,
}

impl Dataset {
    /// The kinds by name.
    pub(super) const ALL: [(&'static str, Self); 3] =
        [("nerf", Self::Nerf), ("bop", Self::Bop), ("coco", Self::Coco)];

    /// Returns the options that the kind needs, by name.
    pub(super) const fn options(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Nerf => &[("layers", "color,depth,mask")],
            Self::Bop => &[("layers", "color,depth")],
            Self::Coco => &[("layers", "color,object"), ("ids", "rgb")],
        }
    }

    /// Checks that the data set can describe cameras of this projection.
    pub(super) fn check_projection(self, projection: Projection) -> Result<(), Fault> {
        match (self, projection) {
            (Self::Nerf | Self::Bop, Projection::Orthographic) => Err(Fault::Input(
                "NeRF and BOP have cameras in perspective alone: add --projection perspective"
                    .to_owned(),
            )),
            (Self::Coco, _) | (_, Projection::Perspective) => Ok(()),
        }
    }

    /// Returns the file of a layer. `row` is the number of the model or scene.
    pub(super) fn path(self, folder: &Path, fields: &Fields<'_>, row: usize) -> PathBuf {
        let Fields { file, view, index, layer, .. } = *fields;
        match self {
            Self::Nerf => folder.join(format!("{}/{layer}/{view:05}.png", stem(file))),
            Self::Bop => {
                let kind = if layer == "color" { "rgb" } else { layer };
                folder.join(format!("{row:06}/{kind}/{view:06}.png"))
            }
            Self::Coco => {
                let kind = if layer == "color" { "images" } else { "panoptic" };
                folder.join(format!("{kind}/{index:06}.png"))
            }
        }
    }
}

/// The entries of a picture in the tables.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DatasetImage {
    row: usize,
    view: usize,
    index: usize,
    camera: PictureCamera,
    depth_scale: f64,
    objects: Vec<DatasetObject>,
}

/// An object of a picture.
#[derive(Clone, Debug, PartialEq)]
struct DatasetObject {
    /// The id in the layer of objects.
    id: i32,
    /// The model's file, or the name of the object.
    model: PathBuf,
    /// From the model, with the axes of its file, to the camera, with the axes of OpenCV.
    camera_from_model: DMat4,
    /// The visible pixels.
    visible: Region,
    /// The pixels that the object would cover alone.
    whole: Region,
    /// The runs of hidden and visible pixels, column by column.
    runs: Vec<usize>,
}

/// The number of pixels of a mask, and the box around them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Region {
    count: usize,
    /// The left column, the upper row, width and height; -1 without a pixel.
    bounds: [i64; 4],
}

impl Region {
    fn of(size: Size, mask: &[bool]) -> Self {
        let (mut count, mut low, mut high) = (0, [i64::MAX; 2], [i64::MIN; 2]);
        for (i, _) in mask.iter().enumerate().filter(|(_, is_set)| **is_set) {
            let at = [i % size.width, i / size.width].map(|at| i64::try_from(at).unwrap_or(0));
            count += 1;
            for axis in 0..2 {
                low[axis] = low[axis].min(at[axis]);
                high[axis] = high[axis].max(at[axis]);
            }
        }
        if count == 0 {
            return Self { count, bounds: [-1; 4] };
        }
        let [width, height] = [0, 1].map(|axis| high[axis] - low[axis] + 1);
        Self { count, bounds: [low[0], low[1], width, height] }
    }
}

/// Returns the runs of unset and set pixels, column by column, as in COCO.
fn runs(size: Size, mask: &[bool]) -> Vec<usize> {
    let (mut runs, mut last) = (vec![0], false);
    for x in 0..size.width {
        for y in 0..size.height {
            let is_set = mask[y * size.width + x];
            if is_set != last {
                runs.push(0);
                last = is_set;
            }
            if let Some(run) = runs.last_mut() {
                *run += 1;
            }
        }
    }
    runs
}

/// A file of a data set.
type File = (PathBuf, Vec<u8>);

/// Describes a picture, and encodes its masks. Fails if the batch ends, or BOP cannot describe the
/// pose of an object.
pub(super) fn image(
    dataset: Dataset,
    renderer: &mut Renderer,
    (job, shot): (&Job, &Shot),
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<(Vec<File>, DatasetImage), Fault> {
    let mut ids_of = |shot: &Shot| -> Result<Vec<i32>, Fault> {
        let set = LayerSet::default().with(Layer::Object);
        let layers = renderer.layers_while(shot, set, NormalSpace::Camera, wanted);
        let layers = layers.map_err(|_cancelled| Fault::Cancelled)?;
        Ok(layers.ids(Layer::Object).to_vec())
    };
    let (camera, size) = (PictureCamera::of(shot), shot.size);
    let all = ids_of(shot)?;
    let shown: Vec<ObjectId> =
        shot.scene.objects.iter().filter(|it| it.1.visible).map(|it| it.0).collect();
    let (mut objects, mut files) = (Vec::new(), Vec::new());
    for (number, object) in shown.iter().enumerate() {
        let Some(own) = shot.scene.objects.get(*object) else { continue };
        let id = shot.scene.objects.position(*object).map_or(0, |at| at + 1);
        let id = i32::try_from(id).unwrap_or(i32::MAX);
        let is_own = |ids: &[i32]| -> Vec<bool> { ids.iter().map(|other| *other == id).collect() };
        let visible = is_own(&all);
        let whole = match shown.len() {
            1 => visible.clone(),
            _ => is_own(&ids_of(&alone(shot, *object))?),
        };
        let file = own.model.source.as_deref();
        let model = file.map_or_else(|| PathBuf::from(&own.name), Path::to_owned);
        let camera_from_model = camera.camera_from_world(AxesConvention::OpenCv)
            * own.world_from_object(shot.view.time)
            * upright(own.model.options.up);
        if dataset == Dataset::Bop {
            rotation(camera_from_model).ok_or_else(|| {
                Fault::Input(format!("{} is scaled or mirrored: BOP has rotations only", own.name))
            })?;
            for (kind, mask) in [("mask", &whole), ("mask_visib", &visible)] {
                let name = format!("{kind}/{:06}_{number:06}.png", job.view());
                let folder = job.out().parent().and_then(Path::parent).unwrap_or(Path::new(""));
                files.push((folder.join(name), mask_png(size, mask)?));
            }
        }
        objects.push(DatasetObject {
            id,
            model,
            camera_from_model,
            visible: Region::of(size, &visible),
            whole: Region::of(size, &whole),
            runs: runs(size, &visible),
        });
    }
    let (row, view, index) = (job.row.number, job.view(), job.index);
    let depth_scale = job.row.parsed.options.layers.png().depth_scale;
    Ok((files, DatasetImage { row, view, index, camera, depth_scale, objects }))
}

/// Returns the shot of one object, with all others hidden.
fn alone(shot: &Shot, object: ObjectId) -> Shot {
    let mut alone = shot.clone();
    for (id, other) in shot.scene.objects.iter().filter(|(id, _)| *id != object) {
        let hidden = marraztu_core::scene::Object { visible: false, ..other.clone() };
        // The object is there, so it can be replaced.
        let _ = Command::Replace(Item::Object(id, Box::new(hidden))).apply(&mut alone.scene);
    }
    alone
}

fn mask_png(size: Size, mask: &[bool]) -> Result<Vec<u8>, Fault> {
    let bytes: Vec<u8> = mask.iter().map(|is_set| u8::from(*is_set)).collect();
    let (kind, numbers) = (LayerKind::Mask, LayerNumbers::U8(&bytes));
    let layer = LayerPicture { name: "mask", kind, channels: &["mask"], numbers };
    io::layer_png(size, &layer, &PngNumbers::default(), None).map_err(Fault::Output)
}

/// Returns the rotation of a loaded model from its file: data sets name the file, with its axes.
fn upright(up: UpAxis) -> DMat4 {
    let [x, y, z] = DMat3::IDENTITY.to_cols_array_2d().map(|axis| up.upright(axis).into());
    DMat4::from_mat3(DMat3::from_cols(x, y, z))
}

/// Returns the rotation of a pose; `None` if it has a scale or a mirror.
fn rotation(pose: DMat4) -> Option<DMat3> {
    let axes = DMat3::from_mat4(pose);
    let is_rotation = (axes * axes.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-6);
    (is_rotation && axes.determinant() > 0.0).then_some(axes)
}

/// Returns the nine numbers of a matrix, row by row.
fn nine(matrix: DMat3) -> [f64; 9] {
    matrix.transpose().to_cols_array()
}

/// Writes the tables of a data set. Fails if a file cannot be written.
pub(super) fn write_tables(
    dataset: Dataset,
    folder: &Path,
    jobs: &[Job],
    mut images: Vec<DatasetImage>,
) -> Result<(), Failure> {
    images.sort_by_key(|image| image.index);
    let models: BTreeSet<&Path> =
        images.iter().flat_map(|image| &image.objects).map(|object| &*object.model).collect();
    let models = Models::of(&models);
    match dataset {
        // The cameras are the only table: see `write_cameras`.
        Dataset::Nerf => Ok(()),
        Dataset::Bop => write_bop(folder, &images, &models),
        Dataset::Coco => write_coco(folder, jobs, &images, &models),
    }
}

/// The models of a data set, with their numbers from 1 on.
struct Models<'a> {
    names: Vec<String>,
    numbers: BTreeMap<&'a Path, usize>,
}

impl<'a> Models<'a> {
    /// Numbers the models in the order of their names: the names of their files, with as many
    /// folders as tell them apart.
    fn of(models: &BTreeSet<&'a Path>) -> Self {
        let name = |path: &Path, parts: usize| {
            let all: Vec<_> = path.iter().map(|part| part.to_string_lossy()).collect();
            all[all.len().saturating_sub(parts)..].join("/")
        };
        let (mut named, mut rest) = (Vec::new(), models.iter().copied().collect::<Vec<_>>());
        let longest = models.iter().map(|path| path.iter().count()).max().unwrap_or(0);
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

fn write(path: &Path, content: &Value) -> Result<(), Failure> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::Write(folder.to_owned(), error))?;
    }
    Ok(io::save_encoded(path, format!("{content}\n").as_bytes())?)
}

fn write_bop(folder: &Path, images: &[DatasetImage], models: &Models<'_>) -> Result<(), Failure> {
    let mut scenes: BTreeMap<usize, [BTreeMap<String, Value>; 3]> = BTreeMap::new();
    for image in images {
        let [cameras, poses, infos] = scenes.entry(image.row).or_default();
        let view = image.view.to_string();
        // The centre of the first pixel is (0, 0) there.
        let mut k = image.camera.intrinsics();
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
        cameras.insert(view.clone(), camera);
        let pose = |object: &DatasetObject| {
            json!({
                "cam_R_m2c": nine(DMat3::from_mat4(object.camera_from_model)),
                "cam_t_m2c": millimetres(object.camera_from_model),
                "obj_id": models.numbers.get(&*object.model),
            })
        };
        poses.insert(view.clone(), image.objects.iter().map(pose).collect());
        #[expect(clippy::cast_precision_loss, reason = "fewer than 2^53 pixels")]
        let info = |object: &DatasetObject| {
            let DatasetObject { visible, whole, .. } = object;
            json!({
                "bbox_obj": whole.bounds,
                "bbox_visib": visible.bounds,
                "px_count_all": whole.count,
                "px_count_valid": whole.count,
                "px_count_visib": visible.count,
                "visib_fract": visible.count as f64 / whole.count.max(1) as f64,
            })
        };
        infos.insert(view, image.objects.iter().map(info).collect());
    }
    for (scene, tables) in scenes {
        let folder = folder.join(format!("{scene:06}"));
        for (name, table) in ["scene_camera", "scene_gt", "scene_gt_info"].iter().zip(tables) {
            write(&folder.join(format!("{name}.json")), &json!(table))?;
        }
    }
    let names: BTreeMap<String, &str> =
        models.iter().map(|(id, name)| (id.to_string(), name)).collect();
    write(&folder.join("models.json"), &json!(names))
}

fn write_coco(
    folder: &Path,
    jobs: &[Job],
    images: &[DatasetImage],
    models: &Models<'_>,
) -> Result<(), Failure> {
    let paths: BTreeMap<usize, String> = jobs
        .iter()
        .filter_map(|job| {
            let name = job.out().file_name()?.to_string_lossy().into_owned();
            Some((job.index, name))
        })
        .collect();
    let category = |(id, name): (usize, &str)| {
        let kind = "model";
        json!({"id": id, "name": name, "isthing": 1, "supercategory": kind})
    };
    let categories: Vec<Value> = models.iter().map(category).collect();
    let (mut pictures, mut panoptic, mut instances) = (Vec::new(), Vec::new(), Vec::new());
    for image in images {
        let (id, size) = (image.index + 1, image.camera.size);
        let name = paths.get(&image.index);
        pictures.push(json!({
            "id": id, "file_name": name, "width": size.width, "height": size.height,
        }));
        let mut segments = Vec::new();
        for object in image.objects.iter().filter(|object| object.visible.count > 0) {
            let DatasetObject { visible, model, .. } = object;
            let category = models.numbers.get(&**model);
            segments.push(json!({
                "id": object.id, "category_id": category, "area": visible.count,
                "bbox": visible.bounds, "iscrowd": 0,
            }));
            instances.push(json!({
                "id": instances.len() + 1, "image_id": id, "category_id": category,
                "segmentation": {"size": [size.height, size.width], "counts": object.runs},
                "area": visible.count, "bbox": visible.bounds, "iscrowd": 0,
            }));
        }
        panoptic.push(json!({"image_id": id, "file_name": name, "segments_info": segments}));
    }
    for (name, annotations) in [("panoptic", panoptic), ("instances", instances)] {
        let table =
            json!({"images": pictures, "annotations": annotations, "categories": categories});
        write(&folder.join(format!("annotations/{name}.json")), &table)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_of_one_name_are_told_apart_by_their_folders() {
        let paths = ["/x/a/model.obj", "/x/b/model.obj", "/x/cow.obj", "/y/b/model.obj", "tin"];
        let models = Models::of(&paths.iter().map(Path::new).collect());
        let names = ["a/model.obj", "cow.obj", "tin", "x/b/model.obj", "y/b/model.obj"];
        assert_eq!(models.iter().map(|(_, name)| name).collect::<Vec<_>>(), names);
        assert_eq!(models.iter().map(|(id, _)| id).collect::<Vec<_>>(), [1, 2, 3, 4, 5]);
        assert_eq!(models.numbers[Path::new("/y/b/model.obj")], 5);
    }

    #[test]
    fn a_mask_has_a_box_and_runs_of_columns() {
        let size = Size::new(4, 3);
        #[rustfmt::skip]
        let mask = [
            0, 0, 0, 0,
            0, 1, 1, 0,
            0, 0, 1, 1,
        ].map(|bit| bit == 1);
        assert_eq!(Region::of(size, &mask), Region { count: 4, bounds: [1, 1, 3, 2] });
        assert_eq!(runs(size, &mask), [4, 1, 2, 2, 2, 1]);
        assert_eq!(runs(size, &[true; 12]), [0, 12]);
        assert_eq!(Region::of(size, &[false; 12]).bounds, [-1; 4]);
    }

    #[test]
    fn only_rotations_are_poses_of_bop() {
        let turn = DMat4::from_rotation_y(0.7);
        assert!(rotation(turn).is_some());
        assert!(rotation(turn * DMat4::from_scale(glam::DVec3::splat(2.0))).is_none());
        assert!(rotation(turn * DMat4::from_scale(glam::DVec3::new(-1.0, 1.0, 1.0))).is_none());
    }
}
