//! Materials, lights and matrices as plain values of Python.

use std::collections::BTreeMap;
use std::path::PathBuf;

use glam::{DMat4, DVec3, DVec4};
use marraztu_core::accuracy::{ACCURACY_PRESETS, AXES, AccuracyPreset, Axis, Settings};
use marraztu_core::base::color::Color;
use marraztu_core::base::{Shared, math};
use marraztu_core::scene::{
    Aim, Attenuation, Light, LightKind, LightOrigin, Material, MaterialChoice, Optics, Orbit,
    PRESETS, Panorama, PresetId, Reflection, Scene, SkyPanorama, SpotOwner, Tracked, Transmission,
    View,
};
use marraztu_io::load_panorama;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::errors::Failure;

/// Converts an item of a dictionary. Errors name the item.
pub(crate) fn item<'a, 'py, T>(values: Borrowed<'a, 'py, PyAny>, name: &str) -> PyResult<T>
where
    T: for<'b> FromPyObject<'b, 'py>,
{
    let value = values.get_item(name)?;
    value.extract::<T>().map_err(|error| {
        let error: PyErr = error.into();
        PyTypeError::new_err(format!("{name}: {}", error.value(values.py())))
    })
}

/// A matrix, row by row.
pub(crate) type Rows = [[f64; 4]; 4];

/// Converts the rows of a matrix.
pub(crate) fn matrix(rows: Rows) -> DMat4 {
    let [a, b, c, d] = rows.map(DVec4::from_array);
    DMat4::from_cols(a, b, c, d).transpose()
}

/// Returns the rows of a matrix.
pub(crate) fn rows(matrix: DMat4) -> Rows {
    matrix.transpose().to_cols_array_2d()
}

/// A material by name, or by its coefficients.
#[derive(FromPyObject)]
pub(crate) enum MaterialValue {
    Name(String),
    Values {
        ambient: [f64; 3],
        diffuse: [f64; 3],
        specular: [f64; 3],
        exponent: f64,
        emission: [f64; 3],
        reflection: String,
        transmission: [f64; 3],
        ior: f64,
    },
}

impl MaterialValue {
    /// Returns the choice of a material.
    pub(crate) fn choice(self) -> Result<MaterialChoice, Failure> {
        match self {
            Self::Name(name) if name == "file" => Ok(MaterialChoice::File),
            Self::Name(name) => {
                PresetId::named(&name).map(MaterialChoice::Preset).ok_or_else(|| {
                    let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
                    let names = names.join(", ");
                    Failure::Value(format!("there is no material {name:?}; write file, {names}"))
                })
            }
            Self::Values {
                ambient,
                diffuse,
                specular,
                exponent,
                emission,
                reflection,
                transmission,
                ior,
            } => {
                let factors = [ambient, diffuse, specular, transmission].into_iter().flatten();
                let all_right = factors.into_iter().all(|x| (0.0..=1.0).contains(&x))
                    && emission.into_iter().chain([exponent]).all(|x| x >= 0.0 && x.is_finite())
                    && Optics::INDICES.contains(&ior);
                let optics = Optics {
                    reflection: reflection_of(&reflection)?,
                    transmission: match transmission {
                        [0.0, 0.0, 0.0] => Transmission::None,
                        filter => Transmission::Filter(filter),
                    },
                    index: ior,
                };
                let plain = Material::matte(ambient, diffuse);
                let material = Material { specular, exponent, emission, optics, ..plain };
                let reason = "ambient, diffuse, specular and transmission are factors from 0 to \
                              1; exponent and emission are at least 0; an index of refraction is \
                              from 0.1 to 10";
                all_right
                    .then_some(MaterialChoice::Own(material))
                    .ok_or_else(|| Failure::value(reason))
            }
        }
    }
}

/// Returns the kind of reflection with a name.
fn reflection_of(name: &str) -> Result<Reflection, Failure> {
    match name {
        "none" => Ok(Reflection::None),
        "constant" => Ok(Reflection::Constant),
        "fresnel" => Ok(Reflection::Fresnel),
        _ => Err(Failure::Value(format!("reflection is none, constant or fresnel, not {name:?}"))),
    }
}

/// The coefficients of a material.
#[derive(IntoPyObject)]
pub(crate) struct Coefficients {
    ambient: [f64; 3],
    diffuse: [f64; 3],
    specular: [f64; 3],
    exponent: f64,
    emission: [f64; 3],
}

/// Returns the materials that have a name.
#[pyfunction]
pub(crate) fn materials() -> Vec<(&'static str, Coefficients)> {
    let values = |material: Material| {
        let Material { ambient, diffuse, specular, exponent, emission, optics: _ } = material;
        Coefficients { ambient, diffuse, specular, exponent, emission }
    };
    PRESETS.iter().map(|preset| (preset.name, values(preset.material))).collect()
}

/// A light. Angles are in radians.
#[derive(FromPyObject, IntoPyObject)]
pub(crate) struct LightValue {
    kind: String,
    name: String,
    color: [u8; 3],
    shadows: bool,
    size: f64,
    ground: [u8; 3],
    panorama: Option<PathBuf>,
    turn: f64,
    shown: bool,
    position: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
    angle: f64,
    exponent: f64,
    attenuation: [f64; 3],
}

impl LightValue {
    /// Returns the light for a slot of the scene. A panorama that is not among `known` is loaded.
    pub(crate) fn light(self, slot: u32, known: &[Shared<Panorama>]) -> Result<Light, Failure> {
        let invalid = |what: &str| Failure::Value(format!("{} light: {what}", self.kind));
        let direction = match self.direction.map(|v| math::unit(DVec3::from_array(v))) {
            Some(None) => return Err(invalid("direction is a finite vector other than 0")),
            direction => direction.flatten(),
        };
        let position = self.position.map(DVec3::from_array);
        let kind = match (&*self.kind, position, direction) {
            ("ambient", None, None) => LightKind::Ambient,
            ("sky", None, None) => {
                LightKind::Sky { ground: Color(self.ground), panorama: self.panorama(known)? }
            }
            ("sun", None, Some(direction)) => LightKind::Sun { direction: Tracked::new(direction) },
            ("bulb", Some(position), None) => {
                LightKind::Bulb { position: Tracked::new(position), orbit: Orbit::default() }
            }
            ("spot", position, direction) => {
                let owner = match (position, direction) {
                    (None, None) => SpotOwner::SelectedCamera,
                    (Some(position), Some(direction)) => {
                        SpotOwner::Fixed(Tracked::new(Aim { position, direction }))
                    }
                    _ => return Err(invalid("give position and direction, or neither")),
                };
                let half_aperture = self.angle.to_degrees();
                LightKind::Spot { owner, half_aperture, exponent: self.exponent }
            }
            ("ambient" | "sky" | "sun" | "bulb", _, _) => {
                return Err(invalid("a sun has a direction, a bulb a position"));
            }
            _ => return Err(invalid("the kinds are ambient, sky, sun, bulb and spot")),
        };
        let [constant, linear, quadratic] = self.attenuation;
        let attenuation = Attenuation { constant, linear, quadratic };
        if !kind.is_valid() || !attenuation.is_valid() {
            return Err(invalid(
                "positions are finite, angles from 0 to pi / 2, exponents at least 0, and the \
                 terms of the attenuation at least 0, one of them above 0",
            ));
        }
        let light = Light::new(&self.name, slot, kind);
        let size = if self.kind == "sun" { self.size.to_degrees() } else { self.size };
        if !(0.0..=light.largest_size()).contains(&size) {
            return Err(invalid("a size is at least 0, and at most pi / 2 for a sun"));
        }
        let color = Color(self.color);
        let shadows = self.shadows && light.can_cast_shadows();
        Ok(Light { color, attenuation, shadows, size, ..light })
    }

    /// Returns the panorama of a sky.
    fn panorama(&self, known: &[Shared<Panorama>]) -> Result<Option<SkyPanorama>, Failure> {
        let Some(path) = &self.panorama else { return Ok(None) };
        let source = std::path::absolute(path).unwrap_or_else(|_empty| path.clone());
        let panorama = match known.iter().find(|panorama| panorama.source == source) {
            Some(panorama) => panorama.clone(),
            None => load_panorama(&source).map_err(Failure::from)?.into(),
        };
        let turn = self.turn.to_degrees();
        Ok(Some(SkyPanorama { panorama, turn, is_shown: self.shown }))
    }

    /// Describes a light of a scene. Spots of objects are fixed at their current place.
    pub(crate) fn of(scene: &Scene, view: &View, light: &Light) -> Self {
        let follows_camera = light.kind.owner() == Some(&SpotOwner::SelectedCamera);
        let origin = scene.light_origin(view, &light.kind).filter(|_| !follows_camera);
        let nowhere = LightOrigin { position: None, direction: None };
        let LightOrigin { position, direction } = origin.unwrap_or(nowhere);
        let Attenuation { constant, linear, quadratic } = light.attenuation;
        let (angle, exponent) = match light.kind {
            LightKind::Spot { half_aperture, exponent, .. } => {
                (half_aperture.to_radians(), exponent)
            }
            LightKind::Ambient
            | LightKind::Sky { .. }
            | LightKind::Sun { .. }
            | LightKind::Bulb { .. } => (0.0, 0.0),
        };
        let panorama = light.kind.panorama();
        Self {
            kind: light.kind.info().name.to_owned(),
            name: light.name.clone(),
            color: light.color.0,
            shadows: light.shadows,
            size: match light.kind {
                LightKind::Sun { .. } => light.size.to_radians(),
                _ => light.size,
            },
            ground: match light.kind {
                LightKind::Sky { ground: Color(ground), .. } => ground,
                _ => [0; 3],
            },
            panorama: panorama.map(|sky| sky.panorama.source.clone()),
            turn: panorama.map_or(0.0, |sky| sky.turn.to_radians()),
            shown: panorama.is_none_or(|sky| sky.is_shown),
            position: position.map(|v| v.to_array()),
            direction: direction.map(|v| v.to_array()),
            angle,
            exponent,
            attenuation: [constant, linear, quadratic],
        }
    }
}

/// Returns the key, the purpose and the choices of each axis of accuracy.
#[pyfunction]
pub(crate) fn axes() -> Vec<(&'static str, &'static str, Vec<&'static str>)> {
    let words = |axis: &Axis| axis.choices.iter().map(|choice| choice.word).collect();
    AXES.iter().map(|axis| (axis.key, axis.what, words(axis))).collect()
}

/// Returns settings with a preset and with choices of single axes. Like in files of `marraztu
/// render`, pictures have at least 16 samples per pixel unless the samples are chosen.
pub(crate) fn settings(
    base: &Settings,
    preset: Option<&str>,
    choices: &BTreeMap<String, String>,
) -> Result<Settings, Failure> {
    let mut settings = *base;
    if let Some(word) = preset {
        let words: Vec<&str> = ACCURACY_PRESETS.iter().map(|preset| preset.word).collect();
        let preset = AccuracyPreset::named(word);
        let unknown = || format!("there is no preset {word:?}; write {}", words.join(", "));
        settings = preset.ok_or_else(|| Failure::Value(unknown()))?.of(&settings);
    }
    for (key, word) in choices {
        let Some(axis) = Axis::named(key) else {
            let keys: Vec<&str> = AXES.iter().map(|axis| axis.key).collect();
            let keys = keys.join(", ").replace('-', "_");
            return Err(Failure::Value(format!("there is no axis {key:?}; write {keys}")));
        };
        let Some(choice) = axis.choice(word) else {
            let words: Vec<&str> = axis.choices.iter().map(|choice| choice.word).collect();
            let words = words.join(", ");
            return Err(Failure::Value(format!("{key} is not {word:?}; write {words}")));
        };
        settings = choice.of(&settings);
    }
    Ok(if choices.contains_key("samples") { settings } else { settings.refined() })
}
