//! `--dataset`: the folders and masks of data sets for training ([`super::tables`] has the tables).
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

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use glam::{DMat3, DMat4};
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Command, Item, ObjectId, Projection, UpAxis};
use marraztu_io::{self as io, LayerKind, LayerNumbers, LayerPicture, PngNumbers};
use marraztu_render::{AxesConvention, Layer, LayerSet, NormalSpace, PictureCamera, Renderer};

use super::jobs::Job;
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
    /// From the model, with the axes of its file, to the camera, with the axes of OpenCV.
    pub(super) camera_from_model: DMat4,
    /// The visible pixels.
    pub(super) visible: Region,
    /// The pixels that the object would cover alone.
    pub(super) whole: Region,
    /// The runs of hidden and visible pixels, column by column.
    pub(super) runs: Vec<usize>,
}

/// The number of pixels of a mask, and the box around them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub(super) count: usize,
    /// The left column, the upper row, width and height; -1 without a pixel.
    pub(super) bounds: [i64; 4],
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
            for (kind, mask) in MASKS.into_iter().zip([&whole, &visible]) {
                files.push((mask_path(job, kind, number), mask_png(size, mask)?));
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
    let stale: BTreeSet<PathBuf> = stale.collect();
    let Some(first) = stale.first() else { return Ok(()) };
    let (shown, first) = (folder.display(), first.display());
    Err(Failure::Usage(format!(
        "{shown} holds {} files of another data set that would stay, such as {first}; remove them, \
         or choose another folder with --out",
        stale.len(),
    )))
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
pub(super) fn nine(matrix: DMat3) -> [f64; 9] {
    matrix.transpose().to_cols_array()
}

#[cfg(test)]
mod tests {
    use super::*;

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
