//! Finds a place for a new shape: on the ground, in the picture, next to the objects there.
//!
//! Places lie on a lattice about the middle of the objects in view, with four cells per width of
//! the shape. The nearest place wins that hides nothing and is hidden by nothing; each further
//! attempt drops a condition. A box around the observer is a room, or a sky: it takes no place.

use glam::{DMat3, DVec2, DVec3};

use super::arrange::{is_level_ground, world_box};
use super::steps::rounded;
use crate::scene::{Bounds, Lens, Projection, Scene, View};

/// The part of the view's height that a shape fills.
const PART: f64 = 0.2;

/// The gap between shapes, and the distance of places, as parts of a shape's width.
const GAP: f64 = 0.25;

/// The largest number of places to each side of the middle.
const MOST: i32 = 40;

/// The part of the picture, from its middle, that shapes may fill.
const INSIDE: f64 = 0.95;

/// The surroundings of a new shape.
pub(super) struct Site {
    sight: Sight,
    /// The height of the view at the focus.
    pub(super) height: f64,
    /// The width of a solid, about [`PART`] of the height.
    pub(super) size: f64,
    focus: DVec3,
    /// The level ground and plane shapes.
    floors: Vec<Bounds>,
    /// The height to rest at outside of all floors.
    floor: f64,
    /// The boxes of the other objects, and their rectangles in the picture.
    taken: Vec<(Bounds, Option<[DVec2; 2]>)>,
}

impl Site {
    pub(super) fn new(scene: &Scene, view: &View) -> Self {
        let sight = Sight::new(scene, view);
        let (mut floors, mut rooms, mut taken) = (Vec::new(), Vec::new(), Vec::new());
        for (_, object) in scene.objects.iter().filter(|(_, object)| object.visible) {
            let Some(bounds) = world_box(object, view.time) else { continue };
            if !(bounds.min.is_finite() && bounds.max.is_finite()) {
                continue;
            }
            if is_level_ground(object) {
                floors.push(bounds);
            } else if bounds.nearest_to(sight.eye) == sight.eye {
                rooms.push(bounds);
            } else {
                taken.push((bounds, sight.rectangle(&bounds)));
            }
        }
        let seen = taken.iter().filter(|(_, rectangle)| rectangle.is_some_and(is_partly_inside));
        let seen = seen.map(|(bounds, _)| *bounds).reduce(|all, other| all.around(&other));
        let focus = seen.map(|bounds| bounds.centre()).filter(|at| sight.is_ahead(*at));
        let focus = focus.unwrap_or_else(|| sight.focus_without_objects(&floors, &rooms));
        let height = 2.0 * sight.half_at(sight.depth(focus));
        // A wide lens sees more than the distance to the focus.
        let most = match sight.projection {
            Projection::Perspective => sight.depth(focus) / 2.0,
            Projection::Orthographic => f64::INFINITY,
        };
        let size = rounded((height * PART).min(most)).unwrap_or(1.0);
        let floor = bottom(floors.iter())
            .or_else(|| bottom(taken.iter().map(|(bounds, _)| bounds)))
            .or_else(|| bottom(rooms.iter()))
            .unwrap_or(0.0);
        Self { sight, height, size, focus, floors, floor, taken }
    }

    /// Returns the place of the ground in a scene without objects.
    pub(super) fn floor_at_focus(&self) -> DVec3 {
        // A ground at the height of the eye would be seen edge-on.
        let is_edge_on = self.sight.eye.y.abs() < self.size / 2.0;
        let height = if is_edge_on { self.focus.y - self.size / 2.0 } else { self.floor };
        DVec3::new(self.focus.x, height, self.focus.z)
    }

    /// Returns the centre of a free place for a solid of this height.
    pub(super) fn place(&self, height: f64) -> DVec3 {
        let half = DVec3::new(self.size, height, self.size) / 2.0;
        let cells = self.cells();
        let at = |centre: DVec3| Bounds { min: centre - half, max: centre + half };
        let on_floor = |cell: &DVec3| {
            let floor = self.floor_below(*cell);
            at(DVec3::new(cell.x, floor + half.y, cell.z))
        };
        let is_seen = |place: &Bounds| {
            self.sight.rectangle(place).is_some_and(is_inside) && self.is_as_deep(place)
        };
        let find = |test: &dyn Fn(&Bounds) -> bool| {
            cells.iter().map(on_floor).find(|place| test(place) && self.is_free(place))
        };
        let on_top = || {
            let on_top = |cell: &DVec3| at(self.top_at(&on_floor(cell), half.y));
            cells.iter().map(on_top).find(is_seen)
        };
        // The picture may show neither the ground nor the top of anything.
        let in_air = || {
            let in_air = |cell: &DVec3| at(cell.with_y(self.focus.y));
            cells.iter().map(in_air).find(|place| is_seen(place) && self.is_free(place))
        };
        let found = find(&|place| is_seen(place) && self.is_apart(place))
            .or_else(|| find(&|place| is_seen(place) && self.is_uncovered(place)))
            .or_else(|| find(&is_seen))
            .or_else(on_top)
            .or_else(in_air)
            .or_else(|| find(&|place| self.sight.rectangle(place).is_some()));
        found.map_or(self.focus, |place| place.centre())
    }

    /// Lists the places of the lattice, the nearest to the middle first. Of equal ones, the place
    /// to the right comes first, and the place in front.
    fn cells(&self) -> Vec<DVec3> {
        let pitch = self.size * GAP;
        let middle = (self.focus / pitch).round() * pitch;
        let [right, back] = self.sight.level_axes();
        let mut steps: Vec<(i32, i32)> =
            (-MOST..=MOST).flat_map(|a| (-MOST..=MOST).map(move |b| (a, b))).collect();
        steps.sort_by_key(|(a, b)| (a * a + 2 * b * b, -a, -b));
        let cell = |(a, b)| middle + (right * f64::from(a) + back * f64::from(b)) * pitch;
        steps.into_iter().map(cell).collect()
    }

    /// Returns the height of the highest floor at a place; outside of all floors, the lowest
    /// height.
    fn floor_below(&self, at: DVec3) -> f64 {
        let is_above = |floor: &&Bounds| {
            let nearest = floor.nearest_to(at);
            nearest.x == at.x && nearest.z == at.z
        };
        let heights = self.floors.iter().filter(is_above).map(|floor| floor.max.y);
        heights.reduce(f64::max).unwrap_or(self.floor)
    }

    /// Returns the centre of a place on top of all boxes there.
    fn top_at(&self, place: &Bounds, half_height: f64) -> DVec3 {
        let column = Bounds {
            min: place.min.with_y(f64::NEG_INFINITY),
            max: place.max.with_y(f64::INFINITY),
        };
        let boxes = self.taken.iter().map(|(bounds, _)| bounds);
        let under = boxes.filter(|bounds| overlap(bounds, &column));
        let top = under.map(|bounds| bounds.max.y).fold(place.min.y, f64::max);
        place.centre().with_y(top + half_height)
    }

    /// Returns whether a shape looks about as large at a place as in the middle.
    fn is_as_deep(&self, place: &Bounds) -> bool {
        let part = self.sight.depth(place.centre()) / self.sight.depth(self.focus);
        match self.sight.projection {
            Projection::Perspective => (0.6..=1.6).contains(&part),
            Projection::Orthographic => true,
        }
    }

    /// Returns whether a place is at least a gap away from all boxes.
    fn is_free(&self, place: &Bounds) -> bool {
        // The gap to a shape of the same size is a whole number of cells: rounding must not count.
        let gap = DVec3::new(1.0, 0.0, 1.0) * (self.size * GAP * (1.0 - 1e-6));
        let grown = Bounds { min: place.min - gap, max: place.max + gap };
        !self.taken.iter().any(|(bounds, _)| overlap(bounds, &grown))
    }

    /// Returns whether a place overlaps no other object in the picture.
    fn is_apart(&self, place: &Bounds) -> bool {
        let Some([low, high]) = self.sight.rectangle(place) else { return false };
        let overlaps = |[min, max]: [DVec2; 2]| min.cmplt(high).all() && low.cmplt(max).all();
        !self.taken.iter().filter_map(|(_, rectangle)| *rectangle).any(overlaps)
    }

    /// Returns whether no nearer object covers the middle of a place in the picture.
    fn is_uncovered(&self, place: &Bounds) -> bool {
        let depth = self.sight.depth(place.centre());
        let Some(middle) = self.sight.in_picture(place.centre()) else { return false };
        !self.taken.iter().any(|(bounds, rectangle)| {
            let covers =
                |[min, max]: [DVec2; 2]| min.cmple(middle).all() && middle.cmple(max).all();
            self.sight.depth(bounds.centre()) < depth && rectangle.is_some_and(covers)
        })
    }
}

fn bottom<'a>(boxes: impl Iterator<Item = &'a Bounds>) -> Option<f64> {
    boxes.map(|bounds| bounds.min.y).reduce(f64::min)
}

/// Returns whether two boxes have a volume in common. Flat boxes count as thin.
fn overlap(a: &Bounds, b: &Bounds) -> bool {
    a.min.cmplt(b.max).all() && b.min.cmplt(a.max).all()
}

/// Returns whether a rectangle lies in the square of the picture's shorter side.
fn is_inside([min, max]: [DVec2; 2]) -> bool {
    min.min_element() >= -INSIDE && max.max_element() <= INSIDE
}

/// Returns whether a rectangle reaches into the square of the picture's shorter side.
fn is_partly_inside([min, max]: [DVec2; 2]) -> bool {
    min.max_element() < 1.0 && max.min_element() > -1.0
}

/// The observer and the lens. Places in the picture count from its middle; 1 is half of its shorter
/// side.
struct Sight {
    eye: DVec3,
    axes: DMat3,
    lens: Lens,
    projection: Projection,
}

impl Sight {
    fn new(scene: &Scene, view: &View) -> Self {
        let frame = scene.observer_frame(view);
        let lens = scene.selected_camera(view).lens;
        let (eye, axes) = (frame.w_axis.truncate(), DMat3::from_mat4(frame));
        Self { eye, axes, lens, projection: view.projection }
    }

    fn depth(&self, at: DVec3) -> f64 {
        (self.eye - at).dot(self.axes.z_axis)
    }

    fn near(&self) -> f64 {
        match self.projection {
            Projection::Perspective => self.lens.near,
            Projection::Orthographic => self.lens.parallel_near.max(0.0),
        }
    }

    fn is_ahead(&self, at: DVec3) -> bool {
        self.depth(at) > self.near()
    }

    /// Returns half of the height of the view at a depth.
    fn half_at(&self, depth: f64) -> f64 {
        match self.projection {
            Projection::Perspective => depth * libm::tan(self.lens.half_angle.to_radians()),
            Projection::Orthographic => self.lens.half_size,
        }
    }

    fn in_picture(&self, at: DVec3) -> Option<DVec2> {
        let aside = self.axes.transpose() * (at - self.eye);
        self.is_ahead(at).then(|| aside.truncate() / self.half_at(-aside.z))
    }

    /// Returns the rectangle of a box in the picture; `None` unless all of it is ahead.
    fn rectangle(&self, bounds: &Bounds) -> Option<[DVec2; 2]> {
        let empty = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        bounds.corners().into_iter().try_fold(empty, |[min, max], corner| {
            let at = self.in_picture(corner)?;
            Some([min.min(at), max.max(at)])
        })
    }

    /// Returns the level axes of the world that point most to the right and to the observer.
    fn level_axes(&self) -> [DVec3; 2] {
        let right = self.axes.x_axis;
        if right.x.abs() >= right.z.abs() {
            let sign = 1.0_f64.copysign(right.x);
            [DVec3::X * sign, DVec3::Z * sign]
        } else {
            let sign = 1.0_f64.copysign(right.z);
            [DVec3::Z * sign, DVec3::NEG_X * sign]
        }
    }

    /// Returns the point to look at if no object is in the picture: on the floor, in the middle of
    /// the free part of a room, or as far away as the origin.
    fn focus_without_objects(&self, floors: &[Bounds], rooms: &[Bounds]) -> DVec3 {
        let along = -self.axes.z_axis;
        // Each room is left where the line of sight meets the first of its far sides.
        let to_wall = |room: &Bounds| {
            let far = DVec3::select(along.cmpgt(DVec3::ZERO), room.max, room.min);
            let way = (far - self.eye) / along;
            way.to_array().into_iter().filter(|way| *way > 0.0).fold(f64::INFINITY, f64::min)
        };
        let wall = rooms.iter().map(to_wall).fold(f64::INFINITY, f64::min);
        let origin = self.depth(DVec3::ZERO);
        let near = self.near();
        let distance = if wall.is_finite() {
            wall / 2.0
        } else if origin > near {
            origin
        } else {
            self.eye.length()
        };
        let distance = distance.max(2.0 * near).max(f64::MIN_POSITIVE);
        let floor = floors.iter().map(|floor| (floor.max.y - self.eye.y) / along.y);
        let floor = floor.filter(|way| *way > near && *way < 2.0 * distance).reduce(f64::min);
        self.eye + along * floor.unwrap_or(distance)
    }
}
