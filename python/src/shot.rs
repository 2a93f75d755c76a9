//! A snapshot of a scene, which draws and explains one picture.

use std::collections::BTreeMap;

use marraztu_core::accuracy::{self, AXES, Axis, Samples, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{ItemId, ObjectId};
use marraztu_lab::budget::{Goal, Measured, search};
use marraztu_lab::picture_source::Studio;
use marraztu_lab::timing::WallClock;
use marraztu_lab::{cost, pixel};
use marraztu_render::{
    AxesConvention, Cancelled, Layer, LayerNames, LayerSet, LayerValues, Layers, NormalSpace,
    PictureCamera, Renderer, plan_frame, without_ground_while,
};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::Failure;
use crate::pictures;
use crate::text::{self, SceneText};
use crate::threads::{work, work_while};
use crate::values::{self, Rows};

/// Scene, view, settings and size: everything that a picture depends on.
#[pyclass(frozen, module = "marraztu._marraztu")]
pub(crate) struct Shot {
    shot: accuracy::Shot,
    /// The ids of objects in layers.
    ids: BTreeMap<ObjectId, i32>,
}

/// The surface at a pixel.
#[derive(IntoPyObject)]
struct Surface {
    /// The id of the object; 0 for marks of cameras and lights.
    object: i32,
    /// From 1, as in the layer.
    polygon: u32,
    /// From 0: a row of the triangles.
    triangle: u32,
    barycentrics: [f64; 3],
    depth: f64,
    position: [f64; 3],
    normal: [f64; 3],
    is_back: bool,
}

/// The explanation of a pixel.
#[derive(IntoPyObject)]
struct Explanation {
    text: String,
    color: [u8; 3],
    surface: Option<Surface>,
    /// The terms of the colour, in steps of a byte.
    terms: Vec<(String, [f64; 3])>,
}

/// Settings for a budget.
#[derive(IntoPyObject)]
struct Fit {
    /// The choices that differ from the default or the scene, by axis, and the samples.
    accuracy: BTreeMap<String, &'static str>,
    milliseconds: f64,
    error: f64,
    error_interval: [f64; 2],
    is_reached: bool,
}

/// An effect of the renderer on an item, or on the whole frame.
#[derive(IntoPyObject)]
struct EffectRow {
    effect: &'static str,
    name: String,
    on: String,
    is_on: bool,
    why: String,
    pixels: Option<u64>,
}

impl Shot {
    pub(crate) const fn new(shot: accuracy::Shot, ids: BTreeMap<ObjectId, i32>) -> Self {
        Self { shot, ids }
    }

    fn draw(
        &self,
        renderer: &mut Renderer,
        transparent: bool,
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Picture, Cancelled> {
        if transparent {
            return without_ground_while(renderer, &self.shot, wanted);
        }
        renderer.render_while(&plan_frame(&self.shot), wanted)?;
        Ok(renderer.take_picture())
    }

    /// Computes layers. Objects have the ids of their nodes.
    fn layers(
        &self,
        renderer: &mut Renderer,
        (set, normals): (LayerSet, NormalSpace),
        wanted: &(dyn Fn() -> bool + Sync),
    ) -> Result<Layers, Cancelled> {
        let mut layers = renderer.layers_while(&self.shot, set, normals, wanted)?;
        let own = layers.names.objects.iter().map(|named| self.ids.get(&named.object).copied());
        let ids: Vec<i32> =
            [Some(0)].into_iter().chain(own).map(Option::unwrap_or_default).collect();
        if let Some(LayerValues::I32(values)) = layers.values.get_mut(&Layer::Object) {
            for value in values {
                *value = usize::try_from(*value).map_or(0, |number| ids[number]);
            }
        }
        Ok(layers)
    }
}

/// The layer of colours.
const COLOR: &str = "color";

/// Returns whether colours are among the layers, and the other layers.
fn layer_set(names: &[String]) -> Result<(bool, LayerSet), Failure> {
    let layer = |name: &String| {
        Layer::ALL.into_iter().find(|layer| layer.name() == name).ok_or_else(|| {
            let known: Vec<&str> = Layer::ALL.into_iter().map(Layer::name).collect();
            let known = known.join(", ");
            Failure::Value(format!("there is no layer {name:?}; write {COLOR}, {known}"))
        })
    };
    let set: Result<LayerSet, Failure> =
        names.iter().filter(|name| *name != COLOR).map(layer).collect();
    Ok((names.iter().any(|name| name == COLOR), set?))
}

#[pymethods]
impl Shot {
    /// Returns the shot for another process: the scene and the size.
    fn dump(&self, py: Python<'_>) -> PyResult<(SceneText, (usize, usize))> {
        let accuracy::Shot { scene, view, settings, size } = &self.shot;
        let text = work(py, 1, |_| text::write((scene, view, settings), &self.ids))?;
        Ok((text, (size.width, size.height)))
    }

    /// Returns the shot of another process.
    #[staticmethod]
    fn restore(py: Python<'_>, text: SceneText, size: (usize, usize)) -> PyResult<Self> {
        work(py, 0, |_| {
            let (scene, view, settings, ids) = text::read(text)?;
            let size = Size::new(size.0, size.1);
            Ok(Self::new(accuracy::Shot::new(&scene, &view, &settings, size), ids))
        })
    }

    #[getter]
    fn size(&self) -> (usize, usize) {
        let Size { width, height } = self.shot.size;
        (width, height)
    }

    /// The names of all objects by id.
    #[getter]
    fn names(&self) -> BTreeMap<i32, String> {
        let objects = self.shot.scene.objects.iter();
        let named = objects.filter_map(|(id, it)| Some((*self.ids.get(&id)?, it.name.clone())));
        named.collect()
    }

    /// The differences of the settings from the default, in words.
    #[getter]
    fn settings(&self) -> String {
        self.shot.settings.in_words()
    }

    /// The matrix of intrinsics, and the pose with the axes of OpenGL.
    #[getter]
    fn camera(&self) -> ([[f64; 3]; 3], Rows) {
        let camera = PictureCamera::of(&self.shot);
        let pose = values::rows(camera.world_from_camera(AxesConvention::OpenGl));
        (camera.k(), pose)
    }

    /// The names of parts by their number in the layer.
    #[getter]
    fn part_names(&self) -> BTreeMap<i32, String> {
        let parts = LayerNames::of(&self.shot.scene).parts;
        (1..).zip(parts.into_iter().map(|part| part.name)).collect()
    }

    /// The names of materials by their number in the layer.
    #[getter]
    fn material_names(&self) -> BTreeMap<i32, String> {
        (1..).zip(LayerNames::of(&self.shot.scene).materials).collect()
    }

    /// Draws the picture. Returns an array for each layer.
    fn render<'py>(
        &self,
        py: Python<'py>,
        threads: usize,
        layers: Vec<String>,
        normals: &str,
        transparent: bool,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (with_color, set) = layer_set(&layers)?;
        let normals = match normals {
            "camera" => NormalSpace::Camera,
            "world" => NormalSpace::World,
            _ => return Err(Failure::value("normals is camera or world").into()),
        };
        let Size { width, height } = self.shot.size;
        let reason = format!("there is not enough memory for {width} x {height} pixels");
        set.check_memory(self.shot.size).map_err(|_full| Failure::Memory(reason))?;
        pictures::load_numpy(py)?;
        let (picture, layers) = work_while(py, threads, |renderer, interrupt| {
            let wanted = || interrupt.is_wanted();
            let interrupted = |_cancelled| Failure::Interrupted;
            let picture = with_color.then(|| self.draw(renderer, transparent, &wanted));
            let picture = picture.transpose().map_err(interrupted)?;
            let layers = (!set.is_empty()).then(|| self.layers(renderer, (set, normals), &wanted));
            Ok((picture, layers.transpose().map_err(interrupted)?))
        })?;
        let arrays = PyDict::new(py);
        if let Some(picture) = picture {
            arrays.set_item(COLOR, pictures::array(py, picture)?)?;
        }
        for (layer, values) in layers.into_iter().flat_map(|layers| layers.values) {
            let mut shape = vec![height, width];
            shape.extend((layer.channels() > 1).then_some(layer.channels()));
            let array = match values {
                LayerValues::F32(values) => {
                    PyArray1::from_vec(py, values).reshape(shape)?.into_any()
                }
                LayerValues::I32(values) => {
                    PyArray1::from_vec(py, values).reshape(shape)?.into_any()
                }
                LayerValues::U8(values) => {
                    PyArray1::from_vec(py, values).reshape(shape)?.into_any()
                }
            };
            arrays.set_item(layer.name(), array)?;
        }
        Ok(arrays)
    }

    /// Finds settings for a budget: "within" milliseconds, with at most an "error", or "unseen".
    fn fitted(
        &self,
        py: Python<'_>,
        threads: usize,
        kind: &str,
        limit: f64,
    ) -> PyResult<(Self, Fit)> {
        let goal = match kind {
            "within" => Goal::Within(limit),
            "error" => Goal::Error(limit),
            _ => Goal::Unseen,
        };
        work(py, threads, |_| {
            let mut studio = Studio::new(self.shot.clone());
            let answer = search(&mut studio, &mut WallClock::default(), &self.shot, (goal, &[]));
            let Measured { settings, ms, error, .. } = answer.measured;
            let is_stated = |axis: &&Axis| {
                let word = axis.chosen(&settings).word;
                let differs = |other: &Settings| axis.chosen(other).word != word;
                differs(&Settings::default())
                    || differs(&self.shot.settings)
                    || axis.key == "samples"
            };
            let stated = AXES.iter().filter(is_stated);
            let accuracy =
                stated.map(|axis| (axis.key.replace('-', "_"), axis.chosen(&settings).word));
            let fit = Fit {
                accuracy: accuracy.collect(),
                milliseconds: ms.value,
                error: error.value,
                error_interval: error.interval,
                is_reached: answer.is_reached,
            };
            let shot = accuracy::Shot { settings, ..self.shot.clone() };
            Ok((Self::new(shot, self.ids.clone()), fit))
        })
    }

    /// Explains a pixel: its surface and the terms of its colour, at the pixel's centre.
    fn explain(&self, py: Python<'_>, x: i64, y: i64) -> PyResult<Explanation> {
        let Size { width, height } = self.shot.size;
        let inside = |at: i64, side: usize| usize::try_from(at).ok().filter(|at| *at < side);
        let (Some(x), Some(y)) = (inside(x, width), inside(y, height)) else {
            let reason = format!("pixel {x},{y} is outside of {width} x {height}");
            return Err(pyo3::exceptions::PyIndexError::new_err(reason));
        };
        work(py, 0, |renderer| {
            let shot = &self.shot;
            let shot = shot.with(Settings { samples: Samples::One, ..shot.settings });
            renderer.render(&plan_frame(&shot));
            let explained = renderer.explain(x, y).expect("the pixel is inside");
            let surface = explained.surface.map(|point| Surface {
                object: match point.item {
                    ItemId::Object(id) => self.ids.get(&id).copied().unwrap_or_default(),
                    ItemId::Camera(_) | ItemId::Light(_) => 0,
                },
                polygon: point.polygon + 1,
                triangle: point.triangle,
                barycentrics: point.weights.to_array(),
                depth: point.distance,
                position: point.position.to_array(),
                normal: point.normal.to_array(),
                is_back: point.back,
            });
            let rows = pixel::rows(&shot.scene, &explained, 6);
            Ok(Explanation {
                text: pixel::lines(&shot.scene, &explained).join("\n"),
                color: explained.bytes,
                surface,
                terms: rows.into_iter().map(|row| (row.label, row.value)).collect(),
            })
        })
    }

    /// Lists the effects that the picture uses and leaves out, with the reasons.
    fn plan(&self, py: Python<'_>) -> PyResult<Vec<EffectRow>> {
        work(py, 0, |renderer: &mut Renderer| {
            renderer.render(&plan_frame(&self.shot));
            let explained = cost::explain_with(renderer, &self.shot);
            let row = |one: marraztu_render::EffectUse| EffectRow {
                effect: one.effect.label(),
                is_on: one.state.is_on(),
                why: one.state.to_string(),
                name: one.name,
                on: one.on.map_or_else(String::new, |thing| thing.name),
                pixels: one.pixels,
            };
            Ok(explained.uses.into_iter().map(row).collect())
        })
    }
}
