//! The view: the selection and the display switches. It is saved with the scene, but its changes
//! are not undo steps.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::{CameraId, LightId, Object, ObjectId};

/// The selection and the display switches.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The kind of item that the keys act on.
    pub subject: Subject,
    /// The selected object; `None` only in a scene without objects.
    pub object: Option<ObjectId>,
    /// The selected camera.
    pub camera: CameraId,
    /// The selected light; `None` only in a scene without lights.
    pub light: Option<LightId>,
    /// The transformation that the keys x, y and z apply.
    pub transformation: Transformation,
    /// The frame for transforming objects.
    pub frame: Frame,
    /// The sizes of steps.
    pub steps: Steps,
    /// Whether a camera or an object is the observer.
    pub observer: Observer,
    /// The projection.
    pub projection: Projection,
    /// Whether polygons are filled or drawn as a wireframe.
    pub fill: Fill,
    /// Whether edges are drawn over filled polygons.
    pub edges_over_fill: bool,
    /// Polygon mode, which draws the selected object polygon by polygon, if it is on.
    pub polygons: Option<PolygonMode>,
    /// Whether earlier polygons stay drawn in that mode.
    pub polygons_stay: bool,
    /// Whether only the selected object is shown.
    pub only_selected: bool,
    /// The normals used for lighting.
    pub normals: Normals,
    /// Whether back faces are drawn, in red.
    pub back_faces: bool,
    /// Whether the normals of faces are drawn.
    pub face_normals: bool,
    /// Whether the normals of vertices are drawn.
    pub vertex_normals: bool,
    /// The length of drawn normals.
    pub normal_length: NormalLength,
    /// Whether lines are two pixels wide, for screens of high density.
    pub wide_lines: bool,
    /// The width in pixels of the lines of models, and the diameter of their points. Where
    /// `wide_lines` is set, they are twice as wide.
    pub line_width: f64,
    /// Whether the markers of cameras and bulbs are drawn.
    pub marks: bool,
    /// The exposure of lit surfaces in stops: each stop doubles the light, and 0 changes nothing.
    pub exposure: f64,
    /// The time of the scene's clock, in seconds.
    pub time: f64,
}

impl View {
    /// The largest exposure in both directions.
    pub const MOST_EXPOSURE: f64 = 10.0;

    /// The first width of the lines of models, in pixels.
    pub const LINE_WIDTH: f64 = 1.5;

    /// The smallest and the largest width of the lines of models, in pixels.
    pub const LINE_WIDTHS: std::ops::RangeInclusive<f64> = 1.0..=64.0;

    /// Returns the factor that the exposure gives to all light.
    pub fn light_factor(&self) -> f64 {
        self.exposure.exp2()
    }

    /// Returns whether an object is drawn: it is visible, and selected if only the selected object
    /// is drawn.
    pub fn shows(&self, id: ObjectId, object: &Object) -> bool {
        let alone = self.only_selected || self.polygons.is_some();
        object.visible && (!alone || self.object == Some(id))
    }

    /// Returns the first view of a scene.
    pub const fn new(object: Option<ObjectId>, camera: CameraId, light: Option<LightId>) -> Self {
        Self {
            subject: Subject::Camera,
            object,
            camera,
            light,
            transformation: Transformation::Translation,
            frame: Frame::Local,
            steps: Steps::DEFAULT,
            observer: Observer::Camera,
            projection: Projection::Perspective,
            fill: Fill::Filled,
            edges_over_fill: false,
            polygons: None,
            polygons_stay: true,
            only_selected: false,
            normals: Normals::Vertex,
            back_faces: false,
            face_normals: false,
            vertex_normals: false,
            normal_length: NormalLength::Units,
            wide_lines: false,
            line_width: Self::LINE_WIDTH,
            marks: true,
            exposure: 0.0,
            time: 0.0,
        }
    }
}

/// The kind of item that the keys act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Subject {
    /// The selected camera.
    Camera,
    /// The selected object.
    Object,
    /// The selected light.
    Light,
}

/// The transformation that the keys x, y and z apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Transformation {
    /// Translation.
    Translation,
    /// Rotation.
    Rotation,
    /// Scaling; objects only.
    Scaling,
}

/// The frame for transforming objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Frame {
    /// The object's frame: M := M T.
    Local,
    /// The world's frame: M := T M.
    Global,
}

/// The step sizes of the keys x, y and z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Steps {
    /// The translation, in units of the world.
    pub translation: f64,
    /// Whether a translation is a hundredth of the scene's extent instead, rounded to 1, 2 or 5
    /// times a power of 10.
    pub by_size: bool,
    /// The rotation, in degrees.
    pub rotation: f64,
    /// The factor of a step up, more than 1; a step down divides by it.
    pub scaling: f64,
}

impl Steps {
    /// Steps of 10 units, 10 degrees and a factor of 1.2.
    pub const DEFAULT: Self =
        Self { translation: 10.0, by_size: false, rotation: 10.0, scaling: 1.2 };
}

impl Default for Steps {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Whether a camera or an object is the observer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Observer {
    /// The selected camera.
    Camera,
    /// The selected object, with the selected camera's lens.
    Object,
}

/// The projection of the view onto the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Projection {
    /// Perspective projection.
    Perspective,
    /// Orthographic projection.
    Orthographic,
}

/// Whether polygons are filled or drawn as a wireframe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Fill {
    /// Filled.
    Filled,
    /// Wireframe.
    Edges,
}

/// The normals used for lighting.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Normals {
    /// Vertex normals: smooth shading.
    Vertex,
    /// Face normals: flat shading.
    Face,
}

/// The length of drawn normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum NormalLength {
    /// 5 units of the object's own space.
    Units,
    /// 1/20 of the object's largest extent.
    BySize,
}

/// Polygon mode, which draws the selected object polygon by polygon.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PolygonMode {
    /// The selected polygon.
    pub current: u32,
    /// The polygons shown since the mode began, including the selected one.
    pub shown: BTreeSet<u32>,
}

impl PolygonMode {
    /// Starts the mode at polygon 0.
    pub fn begin() -> Self {
        Self { current: 0, shown: BTreeSet::from([0]) }
    }

    /// Selects another polygon and shows it.
    pub fn go_to(&mut self, polygon: u32) {
        self.current = polygon;
        self.shown.insert(polygon);
    }
}
