//! The view: what is selected, which switches are on. It is saved with the scene, but is no step of
//! undo.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::{CameraId, LightId, ObjectId};

/// What is selected and what is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// What the keys act on.
    pub subject: Subject,
    /// The selected object; `None` only in a scene without objects.
    pub object: Option<ObjectId>,
    /// The selected camera.
    pub camera: CameraId,
    /// The selected light; `None` only in a scene without lights.
    pub light: Option<LightId>,
    /// What the keys x, y and z do.
    pub transformation: Transformation,
    /// In which frame objects are transformed.
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
    /// The mode in which the selected object is drawn polygon by polygon, if it is on.
    pub polygons: Option<PolygonMode>,
    /// Whether earlier polygons stay drawn in that mode.
    pub polygons_stay: bool,
    /// Whether only the selected object is shown.
    pub only_selected: bool,
    /// Which normals are lit.
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
    /// Whether the markers of cameras and bulbs are drawn.
    pub marks: bool,
    /// How much brighter the lit surfaces are drawn, in stops: each doubles the light. 0 leaves it
    /// as it is.
    pub exposure: f64,
    /// Seconds of the scene's clock.
    pub time: f64,
}

impl View {
    /// The largest exposure, up and down.
    pub const MOST_EXPOSURE: f64 = 10.0;

    /// The factor of all light.
    #[must_use]
    pub fn light_factor(&self) -> f64 {
        self.exposure.exp2()
    }

    /// The first view of a scene.
    #[must_use]
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
            marks: true,
            exposure: 0.0,
            time: 0.0,
        }
    }
}

/// What the keys act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Subject {
    /// The selected camera.
    Camera,
    /// The selected object.
    Object,
    /// The selected light.
    Light,
}

/// What the keys x, y and z do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Transformation {
    /// Move.
    Translation,
    /// Turn.
    Rotation,
    /// Scale; objects only.
    Scaling,
}

/// In which frame objects are transformed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Frame {
    /// The object's own: M := M T.
    Local,
    /// The world's: M := T M.
    Global,
}

/// The sizes of the steps of x, y and z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Steps {
    /// Units of the world.
    pub translation: f64,
    /// Whether a translation is a hundredth of the scene's extent instead, rounded to 1, 2 or 5
    /// times a power of 10.
    pub by_size: bool,
    /// Degrees.
    pub rotation: f64,
    /// The factor of a step up; a step down divides by it. More than 1.
    pub scaling: f64,
}

impl Steps {
    /// 10 units, 10 degrees, a factor of 1.2.
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

/// How the view is projected onto the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Projection {
    /// In perspective.
    Perspective,
    /// Orthographic.
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

/// Which normals are lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Normals {
    /// Those of vertices: smooth shading.
    Vertex,
    /// Those of faces: flat shading.
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

/// The mode in which the selected object is drawn polygon by polygon.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PolygonMode {
    /// The selected polygon.
    pub current: u32,
    /// The polygons shown since the mode began, the selected one among them.
    pub shown: BTreeSet<u32>,
}

impl PolygonMode {
    /// Begins at polygon 0.
    #[must_use]
    pub fn begin() -> Self {
        Self { current: 0, shown: BTreeSet::from([0]) }
    }

    /// Goes to another polygon.
    pub fn go_to(&mut self, polygon: u32) {
        self.current = polygon;
        self.shown.insert(polygon);
    }
}
