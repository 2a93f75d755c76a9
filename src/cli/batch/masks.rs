//! The masks of objects, also beyond the border of the picture.
//!
//! BOP counts the pixels of an object in a canvas of 3 x 3 pictures, with the picture in the
//! middle: `scripts/calc_gt_info.py` of bop_toolkit. The eight pictures around have the same camera
//! with a shifted principal point. They are drawn one by one, and only if the object may be there.

use glam::DVec2;
use marraztu_core::accuracy::Shot;
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Camera, Command, Item, Lens, Object};
use marraztu_render::{Layer, LayerSet, NormalSpace, PictureCamera, Renderer};

use super::outcome::Fault;

/// Draws masks, unless they are no longer wanted.
pub(super) struct Masks<'a> {
    pub(super) renderer: &'a mut Renderer,
    pub(super) wanted: &'a (dyn Fn() -> bool + Sync),
}

impl Masks<'_> {
    /// Returns the ids of the objects that the pixels show.
    pub(super) fn ids(&mut self, shot: &Shot) -> Result<Vec<i32>, Fault> {
        let set = LayerSet::default().with(Layer::Object);
        let layers = self.renderer.layers_while(shot, set, NormalSpace::Camera, self.wanted);
        let layers = layers.map_err(|_cancelled| Fault::Cancelled)?;
        Ok(layers.ids(Layer::Object).to_vec())
    }

    /// Returns the pixels that show the object with an id.
    pub(super) fn of(&mut self, shot: &Shot, id: i32) -> Result<Vec<bool>, Fault> {
        Ok(self.ids(shot)?.iter().map(|other| *other == id).collect())
    }

    /// Returns the region of an object in the canvas of 3 x 3 pictures, from its mask in the
    /// picture in the middle.
    pub(super) fn beyond_the_border(
        &mut self,
        shot: &Shot,
        camera: &PictureCamera,
        (object, id): (&Object, i32),
        mask: &[bool],
    ) -> Result<Region, Fault> {
        let size = shot.size;
        let mut region = Region::of(size, mask);
        for [right, down] in pictures_around(camera, object, shot.view.time) {
            let beside = self.of(&shifted(shot, [right, down])?, id)?;
            let [width, height] =
                [size.width, size.height].map(|side| i64::try_from(side).unwrap_or(0));
            let by = [i64::from(right) * width, i64::from(down) * height];
            region = region.with(Region::of(size, &beside).moved(by));
        }
        Ok(region)
    }
}

/// Returns the pictures around a picture that may show a part of an object: their columns and rows,
/// from -1 to 1.
fn pictures_around(camera: &PictureCamera, object: &Object, time: f64) -> Vec<[i32; 2]> {
    let Some(bounds) = object.model.mesh.bounds() else { return Vec::new() };
    let world_from_mesh = object.world_from_mesh(time);
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for corner in bounds.corners() {
        let (at, depth) = camera.project(world_from_mesh.transform_point3(corner));
        // A part that reaches the camera may be anywhere.
        if !(depth > camera.near && at.is_finite()) {
            (low, high) = (DVec2::NEG_INFINITY, DVec2::INFINITY);
            break;
        }
        (low, high) = (low.min(at), high.max(at));
    }
    let Size { width, height } = camera.intrinsics.size;
    #[expect(clippy::cast_precision_loss, reason = "at most 16,384 pixels")]
    let sides = DVec2::new(width as f64, height as f64);
    // A pixel of margin for rounding.
    let (low, high) = ((low - 1.0) / sides, (high + 1.0) / sides);
    let reaches = |[right, down]: &[i32; 2]| {
        let corner = DVec2::new(f64::from(*right), f64::from(*down));
        low.cmplt(corner + 1.0).all() && high.cmpgt(corner).all()
    };
    let all = (-1..=1).flat_map(|down| (-1..=1).map(move |right| [right, down]));
    all.filter(|place| *place != [0, 0] && reaches(place)).collect()
}

/// Returns the shot of a picture next to a picture, in columns to the right and rows down.
fn shifted(shot: &Shot, [right, down]: [i32; 2]) -> Result<Shot, Fault> {
    let camera = shot.scene.selected_camera(&shot.view);
    let Size { width, height } = shot.size;
    #[expect(clippy::cast_precision_loss, reason = "at most 16,384 pixels")]
    let [width, height, shorter] = [width, height, width.min(height)].map(|side| side as f64);
    let [x, y] = camera.lens.shift;
    let shift = [x - f64::from(right) * width / shorter, y - f64::from(down) * height / shorter];
    let camera = Camera { lens: Lens { shift, ..camera.lens }, ..camera.clone() };
    let mut shot = shot.clone();
    let command = Command::Replace(Item::Camera(shot.view.camera, Box::new(camera)));
    command.apply(&mut shot.scene).map_err(|error| Fault::Input(error.to_string()))?;
    Ok(shot)
}

/// The number of pixels of a mask, and the box around them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub(super) count: usize,
    /// The left column, the upper row, width and height; -1 without a pixel.
    pub(super) bounds: [i64; 4],
}

impl Region {
    pub(super) fn of(size: Size, mask: &[bool]) -> Self {
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

    /// Returns this region, `right` columns to the right and `down` rows down.
    fn moved(self, [right, down]: [i64; 2]) -> Self {
        let [x, y, width, height] = self.bounds;
        match self.count {
            0 => self,
            count => Self { count, bounds: [x + right, y + down, width, height] },
        }
    }

    /// Returns the pixels of two regions that share none.
    fn with(self, other: Self) -> Self {
        if self.count == 0 || other.count == 0 {
            return if self.count == 0 { other } else { self };
        }
        let corners = |[x, y, width, height]: [i64; 4]| [x, y, x + width, y + height];
        let [a, b] = [self, other].map(|region| corners(region.bounds));
        let [x, y] = [0, 1].map(|axis| a[axis].min(b[axis]));
        let [right, bottom] = [2, 3].map(|axis| a[axis].max(b[axis]));
        Self { count: self.count + other.count, bounds: [x, y, right - x, bottom - y] }
    }
}

/// Returns the runs of unset and set pixels, column by column, as in COCO.
pub(super) fn runs(size: Size, mask: &[bool]) -> Vec<usize> {
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
    fn regions_next_to_each_other_have_a_common_box() {
        let none = Region { count: 0, bounds: [-1; 4] };
        let some = Region { count: 3, bounds: [2, 4, 3, 1] };
        assert_eq!(some.with(none), some);
        assert_eq!(none.with(some), some);
        assert_eq!(none.moved([8, 8]), none);
        let other = some.moved([-10, 20]);
        assert_eq!(other, Region { count: 3, bounds: [-8, 24, 3, 1] });
        assert_eq!(some.with(other), Region { count: 6, bounds: [-8, 4, 13, 21] });
    }
}
