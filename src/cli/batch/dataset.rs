//! `--dataset`: the folders and masks of data sets for training ([`super::tables`] has the tables).
//!
//! * `nerf`, for each model: `STEM/{color,depth,mask}/00000.png` and `STEM/transforms.json`.
//! * `bop`, for each model or scene: `000000/{rgb,depth}/000000.png`,
//!   `000000/{mask,mask_visib}/000000_000000.png`, and the tables `scene_camera.json`,
//!   `scene_gt.json` and `scene_gt_info.json`; and the [models](super::models).
//! * `coco`: `images/000000.png`, `panoptic/000000.png`, and the tables
//!   `annotations/{panoptic,instances}.json`.
//!
//! A unit of the model is a metre; BOP has millimetres. BOP counts the part of an object beyond the
//! border of the picture ([`masks`](super::masks)). Sources of the formats:
//! `bop_datasets_format.md` of bop_toolkit, <https://cocodataset.org/#format-data>, and
//! nerfstudio's page on data conventions.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::{DMat3, DMat4};
use marraztu_core::accuracy::Shot;
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Command, Item, Model, Object, ObjectId, Projection, UpAxis};
use marraztu_io::{self as io, LayerKind, LayerNumbers, LayerPicture, PngNumbers};
use marraztu_render::{AxesConvention, PictureCamera, Renderer};

use super::jobs::Job;
use super::masks::{Masks, Region, runs};
use super::outcome::Fault;
use super::rows::Rows;
use super::template::{Fields, stem};
use crate::cli::failure::Failure;

/// The masks of an object of BOP: alone, and behind the others.
const MASKS: [&str; 2] = ["mask", "mask_visib"];

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
    pub(super) camera: PictureCamera,
    pub(super) depth_scale: f64,
    pub(super) objects: Vec<DatasetObject>,
}

/// An object of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DatasetObject {
    /// The id in the layer of objects.
    pub(super) id: i32,
    /// The model's file, or the name of the object.
    pub(super) model: PathBuf,
    /// The loaded model.
    pub(super) loaded: Shared<Model>,
    /// From the model, with the axes of its file, to the camera, with the axes of OpenCV.
    pub(super) camera_from_model: DMat4,
    /// The visible pixels.
    pub(super) visible: Region,
    /// The number of pixels that the object would cover alone.
    pub(super) alone: usize,
    /// These pixels, and the ones beyond the border of the picture.
    pub(super) whole: Region,
    /// The runs of hidden and visible pixels, column by column.
    pub(super) runs: Vec<usize>,
}

/// A file of a data set.
pub(super) type File = (PathBuf, Vec<u8>);

/// Describes a picture, and encodes its masks. Fails if the batch ends, or BOP cannot describe the
/// pose of an object.
pub(super) fn image(
    dataset: Dataset,
    renderer: &mut Renderer,
    (job, shot): (&Job, &Shot),
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<(Vec<File>, DatasetImage), Fault> {
    let mut masks = Masks { renderer, wanted };
    let camera = PictureCamera::of(shot);
    let all = masks.ids(shot)?;
    let shown = || shot.scene.objects.iter().filter(|(_, object)| object.visible);
    let is_only = shown().count() == 1;
    let (mut objects, mut files) = (Vec::new(), Vec::new());
    for (number, (object, own)) in shown().enumerate() {
        let id = shot.scene.objects.position(object).map_or(0, |at| at + 1);
        let id = i32::try_from(id).unwrap_or(i32::MAX);
        let visible: Vec<bool> = all.iter().map(|other| *other == id).collect();
        let mut described = DatasetObject::new(shot, &camera, (id, own), &visible);
        if dataset == Dataset::Bop {
            rotation(described.camera_from_model).ok_or_else(|| {
                Fault::Input(format!("{} is scaled or mirrored: BOP has rotations only", own.name))
            })?;
            let alone = if is_only { shot.clone() } else { alone(shot, object) };
            let whole = if is_only { visible.clone() } else { masks.of(&alone, id)? };
            described.alone = whole.iter().filter(|is_set| **is_set).count();
            described.whole = masks.beyond_the_border(&alone, &camera, (own, id), &whole)?;
            for (kind, mask) in MASKS.into_iter().zip([&whole, &visible]) {
                files.push((mask_path(job, kind, number), mask_png(shot.size, mask)?));
            }
        }
        objects.push(described);
    }
    let depth_scale = job.options().layers.png().depth_scale;
    Ok((files, DatasetImage { camera, depth_scale, objects }))
}

/// Checks that a folder holds no pictures of another data set that this one would leave. Fails with
/// their number and the first name.
pub(super) fn check_used_folder(
    dataset: Dataset,
    folder: &Path,
    rows: &Rows,
) -> Result<(), Failure> {
    // The folders of pictures, with the number of pictures that are written there.
    let mut folders = Vec::new();
    let mut add = |folder: PathBuf, kinds: &[&str], count: usize| {
        folders.extend(kinds.iter().map(|kind| (folder.join(kind), count)));
    };
    match dataset {
        Dataset::Coco => add(folder.to_owned(), &["images", "panoptic"], rows.pictures),
        Dataset::Nerf => rows.rows.iter().for_each(|row| {
            add(folder.join(stem(&row.file)), &["color", "depth", "mask"], row.kind.views.len());
        }),
        Dataset::Bop => {
            let scenes = numbered(folder, "").map(|(number, _)| number);
            for scene in scenes.collect::<BTreeSet<_>>() {
                let count = rows.rows.get(scene).map_or(0, |row| row.kind.views.len());
                let kinds = ["rgb", "depth", "mask", "mask_visib"];
                add(folder.join(format!("{scene:06}")), &kinds, count);
            }
        }
    }
    let stale = folders.into_iter().flat_map(|(folder, count)| {
        let later = numbered(&folder, ".png").filter(move |(number, _)| *number >= count);
        later.map(|(_, path)| path)
    });
    let stale: BTreeSet<PathBuf> = stale.chain(of_other_kind(dataset, folder)).collect();
    let Some(first) = stale.first() else { return Ok(()) };
    let (shown, first) = (folder.display(), first.display());
    Err(Failure::Usage(format!(
        "{shown} holds {} files of another data set that would stay, such as {first}; remove them, \
         or choose another folder with --out",
        stale.len(),
    )))
}

/// Returns the pictures in a folder that belong to data sets of other kinds.
fn of_other_kind(dataset: Dataset, folder: &Path) -> impl Iterator<Item = PathBuf> {
    let coco = || vec![folder.join("images")];
    let bop = || numbered(folder, "").map(|(_, scene)| scene.join("rgb")).collect();
    let nerf = || {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path().join("color")).collect()
    };
    let folders: [Vec<PathBuf>; 2] = match dataset {
        Dataset::Coco => [bop(), nerf()],
        Dataset::Bop => [coco(), nerf()],
        Dataset::Nerf => [coco(), bop()],
    };
    let pictures = |folder: PathBuf| numbered(&folder, ".png").map(|(_, path)| path);
    folders.into_iter().flatten().flat_map(pictures)
}

/// Iterates over the entries of a folder with names such as 000012.png or 000012_000003.png, with
/// their first number.
fn numbered(folder: &Path, ending: &'static str) -> impl Iterator<Item = (usize, PathBuf)> + use<> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(move |entry| {
        let name = entry.file_name();
        let name = name.to_str()?.strip_suffix(ending)?;
        let is_number = |text: &str| text.len() >= 5 && text.bytes().all(|it| it.is_ascii_digit());
        let (first, second) = name.split_once('_').unwrap_or((name, "00000"));
        let is_named = is_number(first) && is_number(second);
        Some((first.parse().ok().filter(|_| is_named)?, entry.path()))
    })
}

/// Returns the file of the mask of an object of BOP.
fn mask_path(job: &Job, kind: &str, object: usize) -> PathBuf {
    let folder = job.out().parent().and_then(Path::parent).unwrap_or(Path::new(""));
    folder.join(format!("{kind}/{:06}_{object:06}.png", job.view()))
}

/// Removes the masks of an earlier run for objects that the scene no longer has.
pub(super) fn remove_masks(job: &Job, objects: usize) {
    for kind in MASKS {
        let masks = (objects..).map(|object| mask_path(job, kind, object));
        let is_mask = |path: &PathBuf| path.is_file() && io::check_replaced(path).is_ok();
        masks.take_while(is_mask).for_each(|path| _ = std::fs::remove_file(path));
    }
}

impl DatasetObject {
    /// Describes an object by its visible pixels.
    fn new(
        shot: &Shot,
        camera: &PictureCamera,
        (id, object): (i32, &Object),
        mask: &[bool],
    ) -> Self {
        let file = object.model.source.as_deref();
        let visible = Region::of(shot.size, mask);
        Self {
            id,
            model: file.map_or_else(|| PathBuf::from(&object.name), Path::to_owned),
            loaded: object.model.clone(),
            camera_from_model: camera.camera_from_world(AxesConvention::OpenCv)
                * object.world_from_object(shot.view.time)
                * upright(object.model.options.up),
            visible,
            alone: visible.count,
            whole: visible,
            runs: runs(shot.size, mask),
        }
    }
}

/// Returns the shot of one object, with all others hidden.
fn alone(shot: &Shot, object: ObjectId) -> Shot {
    let mut alone = shot.clone();
    for (id, other) in shot.scene.objects.iter().filter(|(id, _)| *id != object) {
        let hidden = Object { visible: false, ..other.clone() };
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
pub(super) fn upright(up: UpAxis) -> DMat4 {
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
pub(super) fn nine(matrix: DMat3) -> [f64; 9] {
    matrix.transpose().to_cols_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_rotations_are_poses_of_bop() {
        let turn = DMat4::from_rotation_y(0.7);
        assert!(rotation(turn).is_some());
        assert!(rotation(turn * DMat4::from_scale(glam::DVec3::splat(2.0))).is_none());
        assert!(rotation(turn * DMat4::from_scale(glam::DVec3::new(-1.0, 1.0, 1.0))).is_none());
    }
}
