//! A scene, with the view that `marraztu render` has of it.
//!
//! Models without a scene file are framed and lit for their size, as on the command line. This
//! takes longer than drawing a small picture, so the result is kept until the scene changes.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{DMat4, DVec2};
use marraztu_core::accuracy::{self, Settings};
use marraztu_core::base::color::Color;
use marraztu_core::base::image::Size;
use marraztu_core::edit::{framing, items, lighting, selection};
use marraztu_core::scene::{
    self as core, Command, Fill, Intrinsics, Item, ItemId, LightId, MaterialChoice, Object,
    ObjectId, Observer, Pose, Projection, Sides, Tracked, View,
};
use marraztu_io as io;
use pyo3::prelude::*;

use crate::errors::Failure;
use crate::mesh::Mesh;
use crate::shot::Shot;
use crate::text::{self, SceneText};
use crate::threads::{check_fork, work, work_while};
use crate::values::{self, LightValue, MaterialValue, Rows, item};

/// The longest side of a picture in pixels.
const LONGEST_SIDE: usize = 16_384;

/// Objects, lights and the view.
#[pyclass(frozen, module = "marraztu._marraztu")]
pub(crate) struct Scene {
    state: Mutex<State>,
}

#[derive(Clone)]
struct State {
    scene: core::Scene,
    view: View,
    settings: Settings,
    /// Whether lights are placed and balanced for the objects.
    is_lit: bool,
    /// Whether the view is that of a file.
    is_file: bool,
    /// The ids of objects in layers.
    ids: BTreeMap<ObjectId, i32>,
    /// The scene in its default view, if it is current.
    presented: Option<core::Scene>,
}

/// The position of the camera.
#[derive(FromPyObject)]
enum Aim {
    /// Everything is framed from these radians to the right of the front, and up.
    From(f64, f64),
    /// A matrix from camera to world, with the axes of OpenGL, and the numbers f_x, f_y, c_x and
    /// c_y of the lens in pixels.
    Pose(Rows, Option<[f64; 4]>),
}

/// The properties of an object to change.
struct Properties {
    name: Option<String>,
    visible: Option<bool>,
    pose: Option<Rows>,
    material: Option<MaterialValue>,
    opacity: Option<f64>,
    sides: Option<String>,
}

impl<'py> FromPyObject<'_, 'py> for Properties {
    type Error = PyErr;

    fn extract(properties: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Ok(Self {
            name: item(properties, "name")?,
            visible: item(properties, "visible")?,
            pose: item(properties, "pose")?,
            material: item(properties, "material")?,
            opacity: item(properties, "opacity")?,
            sides: item(properties, "sides")?,
        })
    }
}

impl Properties {
    fn apply(self, object: &mut Object) -> Result<(), Failure> {
        if let Some(name) = self.name {
            object.name = name;
        }
        object.visible = self.visible.unwrap_or(object.visible);
        if let Some(pose) = self.pose {
            object.placement = Tracked::new(affine(pose)?);
        }
        if let Some(material) = self.material {
            object.material = material.choice()?;
        }
        if let Some(opacity) = self.opacity {
            if !(0.0..=1.0).contains(&opacity) {
                return Err(Failure::value("opacity is from 0 to 1"));
            }
            object.opacity = opacity;
        }
        object.sides = match self.sides.as_deref() {
            None => object.sides,
            Some("auto") => Sides::Auto,
            Some("one") => Sides::One,
            Some("two") => Sides::Two,
            Some(_) => return Err(Failure::value("sides is auto, one or two")),
        };
        Ok(())
    }
}

/// Checks the pose of an object.
fn affine(pose: Rows) -> Result<DMat4, Failure> {
    let matrix = values::matrix(pose);
    let is_affine = matrix.is_finite() && pose[3] == [0.0, 0.0, 0.0, 1.0];
    let reason = "a pose is a finite matrix with the last row 0 0 0 1";
    is_affine.then_some(matrix).ok_or_else(|| Failure::value(reason))
}

/// What Python knows about an object: key, id, name, visibility, pose, opacity.
type ObjectRow = (u32, i32, String, bool, Rows, f64);

impl State {
    fn empty() -> Self {
        let (scene, mut view) = io::empty_scene();
        view.marks = false;
        Self {
            scene,
            view,
            settings: Settings::default(),
            is_lit: true,
            is_file: false,
            ids: BTreeMap::new(),
            presented: None,
        }
    }

    /// Changes the scene, and adapts the view to it.
    fn change(&mut self, command: Command) -> Result<(), Failure> {
        let before = self.scene.clone();
        command.apply(&mut self.scene).map_err(Failure::value)?;
        selection::follow(&before, &self.scene, &mut self.view);
        self.presented = None;
        Ok(())
    }

    /// Frames everything from a direction, in radians. Models without a scene are lit for that
    /// view. An empty scene stays as it is.
    fn frame(&self, view: &View, from: [f64; 2]) -> Result<core::Scene, Failure> {
        let mut scene = self.scene.clone();
        let from = from.map(f64::to_degrees);
        if let Ok(command) = framing::models(&scene, view, from) {
            command.apply(&mut scene).map_err(Failure::value)?;
        }
        self.light(&mut scene, view)?;
        Ok(scene)
    }

    /// Places automatic lights for a view.
    fn light(&self, scene: &mut core::Scene, view: &View) -> Result<(), Failure> {
        if self.is_lit
            && let Ok(command) = lighting::models(scene, view)
        {
            command.apply(scene).map_err(Failure::value)?;
        }
        Ok(())
    }

    /// Returns the scene in its default view.
    fn presented(&mut self) -> Result<core::Scene, Failure> {
        if self.is_file {
            let mut scene = self.scene.clone();
            self.light(&mut scene, &self.view)?;
            return Ok(scene);
        }
        if let Some(scene) = &self.presented {
            return Ok(scene.clone());
        }
        let scene = self.frame(&self.view, framing::MODELS_FROM.map(f64::to_radians))?;
        self.presented = Some(scene.clone());
        Ok(scene)
    }

    /// Returns the scene with this camera, and the view through it. A camera that is given is the
    /// observer, and has its own lens, whatever the view of a file.
    fn aimed(&mut self, aim: Option<&Aim>, size: Size) -> Result<(core::Scene, View), Failure> {
        let mut view = self.view.clone();
        match aim {
            None => Ok((self.presented()?, view)),
            Some(Aim::From(right, up)) => {
                view.observer = Observer::Camera;
                Ok((self.frame(&view, [*right, *up])?, view))
            }
            Some(Aim::Pose(rows, lens)) => {
                view.observer = Observer::Camera;
                if lens.is_some() {
                    view.projection = Projection::Perspective;
                }
                let mut scene = self.presented()?;
                let pose = Pose::from_matrix(values::matrix(*rows));
                let invalid =
                    || Failure::value("the pose of a camera is a rotation and a position");
                let pose = pose.ok_or_else(invalid)?;
                let intrinsics = lens.map(|[fx, fy, cx, cy]| {
                    let (focal, principal_point) = (DVec2::new(fx, fy), DVec2::new(cx, cy));
                    (Projection::Perspective, Intrinsics { focal, principal_point, size })
                });
                let command = framing::from_pose(&scene, &view, pose, intrinsics);
                command.apply(&mut scene).map_err(Failure::value)?;
                Ok((scene, view))
            }
        }
    }

    fn object(&self, key: u32) -> Result<(ObjectId, &Object), Failure> {
        let id = ObjectId(key);
        let object = self.scene.objects.get(id);
        object.map(|object| (id, object)).ok_or_else(|| Failure::value("the node has been removed"))
    }

    /// Replaces all lights.
    fn set_lights(&mut self, lights: Vec<LightValue>) -> Result<(), Failure> {
        let mut changed = self.clone();
        let panoramas = self.scene.lights.iter().filter_map(|(_, light)| light.kind.panorama());
        let known: Vec<_> = panoramas.map(|sky| sky.panorama.clone()).collect();
        for id in self.scene.lights.ids() {
            changed.change(Command::Remove(ItemId::Light(id)))?;
        }
        let mut next = changed.scene.next_id;
        for (slot, light) in (0..).zip(lights) {
            let item = Item::Light(LightId(next), Box::new(light.light(slot, &known)?));
            next += 1;
            changed.change(Command::NextId(next))?;
            changed.change(Command::Insert { at: usize::MAX, item })?;
        }
        changed.is_lit = false;
        *self = changed;
        Ok(())
    }
}

impl Scene {
    /// Locks the scene. No thread holds the lock while it waits for Python.
    fn lock(&self) -> Result<MutexGuard<'_, State>, Failure> {
        check_fork()?;
        Ok(self.state.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Changes the view.
    fn set_view(&self, change: impl FnOnce(&mut View)) -> PyResult<()> {
        let mut state = self.lock()?;
        change(&mut state.view);
        state.presented = None;
        Ok(())
    }
}

#[pymethods]
impl Scene {
    /// Creates a scene without objects.
    #[new]
    fn new() -> Self {
        Self { state: Mutex::new(State::empty()) }
    }

    /// Opens a scene file. Returns the scene and the findings.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<(Self, Vec<String>)> {
        let opened = work_while(py, 0, |_, interrupt| Ok(io::open(&path, &interrupt.progress)?))?;
        let io::Opened { scene, view, settings, findings, .. } = opened;
        let ids = (1..).zip(scene.objects.ids()).map(|(id, object)| (object, id)).collect();
        let state =
            State { scene, view, settings, is_lit: false, is_file: true, ids, ..State::empty() };
        let findings = findings.iter().map(ToString::to_string).collect();
        Ok((Self { state: Mutex::new(state) }, findings))
    }

    /// Adds an object. Returns its key and its id.
    fn add(&self, mesh: &Mesh, id: Option<i32>, properties: Properties) -> PyResult<(u32, i32)> {
        let mut state = self.lock()?;
        let taken = |id: &i32| state.ids.values().any(|other| other == id);
        let id = match id {
            Some(id) if id < 1 => {
                return Err(Failure::value("ids start at 1: 0 is the background").into());
            }
            Some(id) if taken(&id) => {
                return Err(Failure::Value(format!("another node has the id {id}")).into());
            }
            Some(id) => id,
            None => (1..).find(|id| !taken(id)).unwrap_or(i32::MAX),
        };
        let mut object = Object::new(mesh.model.clone(), MaterialChoice::File);
        object.sides = Sides::Auto;
        properties.apply(&mut object)?;
        let key = state.scene.next_id;
        let command = items::insert_object(&state.scene, object);
        state.change(command)?;
        state.ids.insert(ObjectId(key), id);
        Ok((key, id))
    }

    /// Removes an object.
    fn remove(&self, key: u32) -> PyResult<()> {
        let mut state = self.lock()?;
        let (id, _) = state.object(key)?;
        let command = items::remove(&state.scene, ItemId::Object(id)).map_err(Failure::value)?;
        state.change(command)?;
        state.ids.remove(&id);
        Ok(())
    }

    /// Changes properties of an object.
    fn change(&self, key: u32, properties: Properties) -> PyResult<()> {
        let mut state = self.lock()?;
        let (id, object) = state.object(key)?;
        let mut object = object.clone();
        properties.apply(&mut object)?;
        Ok(state.change(Command::Replace(Item::Object(id, Box::new(object))))?)
    }

    /// Lists the objects in the order of the scene.
    fn objects(&self) -> PyResult<Vec<ObjectRow>> {
        let state = self.lock()?;
        let row = |(id, object): (ObjectId, &Object)| {
            let pose = values::rows(*object.placement.now());
            let own = state.ids.get(&id).copied().unwrap_or_default();
            (id.0, own, object.name.clone(), object.visible, pose, object.opacity)
        };
        Ok(state.scene.objects.iter().map(row).collect())
    }

    /// The mesh of an object.
    fn mesh(&self, key: u32) -> PyResult<Mesh> {
        let state = self.lock()?;
        let (_, object) = state.object(key)?;
        Ok(Mesh::of(object.model.clone()))
    }

    /// The lights that are on, as the default view shows them.
    fn lights(&self, py: Python<'_>) -> PyResult<Vec<LightValue>> {
        work(py, 0, |_| {
            let mut state = self.lock()?;
            let scene = state.presented()?;
            let lights = scene.lights.iter().filter(|(_, light)| light.on);
            Ok(lights.map(|(_, light)| LightValue::of(&scene, &state.view, light)).collect())
        })
    }

    /// Replaces all lights; `None` restores the lights that are placed and balanced for the
    /// objects.
    fn set_lights(&self, lights: Option<Vec<LightValue>>) -> PyResult<()> {
        let mut state = self.lock()?;
        let Some(lights) = lights else {
            let (empty, _) = io::empty_scene();
            state.scene.lights = empty.lights;
            state.is_lit = true;
            state.presented = None;
            return Ok(());
        };
        Ok(state.set_lights(lights)?)
    }

    /// Switches the shadows of all lights that can cast shadows.
    fn set_shadows(&self, on: bool) -> PyResult<()> {
        let mut state = self.lock()?;
        let lights: Vec<_> = state.scene.lights.iter().map(|(id, it)| (id, it.clone())).collect();
        for (id, mut light) in lights {
            light.shadows = on && light.can_cast_shadows();
            state.change(Command::Replace(Item::Light(id, Box::new(light))))?;
        }
        Ok(())
    }

    #[getter]
    fn background(&self) -> PyResult<(u8, u8, u8)> {
        Ok(self.lock()?.scene.background.0.into())
    }

    #[setter]
    fn set_background(&self, color: [u8; 3]) -> PyResult<()> {
        Ok(self.lock()?.change(Command::Background(Color(color)))?)
    }

    #[getter]
    fn line_width(&self) -> PyResult<f64> {
        Ok(self.lock()?.view.line_width)
    }

    #[setter]
    fn set_line_width(&self, pixels: f64) -> PyResult<()> {
        let widths = View::LINE_WIDTHS;
        if !widths.contains(&pixels) {
            let [least, most] = [widths.start(), widths.end()];
            let text = format!("line_width is from {least} to {most} pixels");
            return Err(Failure::Value(text).into());
        }
        self.set_view(|view| view.line_width = pixels)
    }

    #[getter]
    fn exposure(&self) -> PyResult<f64> {
        Ok(self.lock()?.view.exposure)
    }

    #[setter]
    fn set_exposure(&self, stops: f64) -> PyResult<()> {
        let most = View::MOST_EXPOSURE;
        if !(-most..=most).contains(&stops) {
            return Err(Failure::Value(format!("exposure is from -{most} to {most} stops")).into());
        }
        self.set_view(|view| view.exposure = stops)
    }

    #[getter]
    fn edges(&self) -> PyResult<&'static str> {
        let state = self.lock()?;
        Ok(match (state.view.fill, state.view.edges_over_fill) {
            (Fill::Edges, _) => "only",
            (Fill::Filled, true) => "over",
            (Fill::Filled, false) => "none",
        })
    }

    #[setter]
    fn set_edges(&self, edges: &str) -> PyResult<()> {
        let (fill, over) = match edges {
            "none" => (Fill::Filled, false),
            "over" => (Fill::Filled, true),
            "only" => (Fill::Edges, false),
            _ => return Err(Failure::value("edges is none, over or only").into()),
        };
        self.set_view(|view| (view.fill, view.edges_over_fill) = (fill, over))
    }

    /// Saves the scene in its default view.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        work(py, 0, |_| {
            let (scene, view, settings) = {
                let mut state = self.lock()?;
                (state.presented()?, state.view.clone(), state.settings)
            };
            text::check_files(&scene).map_err(Failure::Save)?;
            Ok(io::save(&path, &scene, &view, &settings)?)
        })
    }

    /// Returns the scene for another process, and whether its lights are automatic, and its view
    /// that of a file.
    fn dump(&self, py: Python<'_>) -> PyResult<(SceneText, bool, bool)> {
        work(py, 1, |_| {
            let State { scene, view, settings, is_lit, is_file, ids, .. } = self.lock()?.clone();
            Ok((text::write((&scene, &view, &settings), &ids)?, is_lit, is_file))
        })
    }

    /// Returns the scene of another process.
    #[staticmethod]
    fn restore(py: Python<'_>, text: SceneText, is_lit: bool, is_file: bool) -> PyResult<Self> {
        work(py, 0, |_| {
            let (scene, view, settings, ids) = text::read(text)?;
            let state = State { scene, view, settings, is_lit, is_file, ids, ..State::empty() };
            Ok(Self { state: Mutex::new(state) })
        })
    }

    /// Returns a snapshot of the scene with everything that a picture depends on.
    fn shot(
        &self,
        py: Python<'_>,
        width: i64,
        height: i64,
        aim: Option<Aim>,
        preset: Option<&str>,
        choices: BTreeMap<String, String>,
    ) -> PyResult<Shot> {
        let side = |side: i64| {
            let side = usize::try_from(side).ok().filter(|side| (1..=LONGEST_SIDE).contains(side));
            let reason = format!("width and height are from 1 to {LONGEST_SIDE} pixels");
            side.ok_or(Failure::Value(reason))
        };
        let size = Size::new(side(width)?, side(height)?);
        work(py, 0, |_| {
            let mut state = self.lock()?;
            let (scene, view) = state.aimed(aim.as_ref(), size)?;
            let settings = values::settings(&state.settings, preset, &choices)?;
            let shot = accuracy::Shot::new(&scene, &view, &settings, size);
            Ok(Shot::new(shot, state.ids.clone()))
        })
    }
}
