//! Lights in scene files: their format, and conversions in both directions.

use std::path::Path;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::fields::{finite, white, yes};
use super::format::written_bare;
use super::open::Needs;
use super::save::file_path;
use marraztu_core::base::color::Color;
use marraztu_core::base::math;
use marraztu_core::scene::{
    Aim, Attenuation, CameraId, Light, LightKind, ObjectId, Orbit, SkyPanorama, SpotOwner, Tracked,
};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FileLight {
    pub(super) id: u32,
    pub(super) name: String,
    pub(super) slot: u32,
    #[serde(default = "yes")]
    pub(super) on: bool,
    #[serde(default = "white")]
    pub(super) color: [u8; 3],
    #[serde(default)]
    pub(super) attenuation: Attenuation,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub(super) shadows: bool,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub(super) size: f64,
    pub(super) kind: FileLightKind,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) enum FileLightKind {
    Ambient,
    Sky {
        ground: [u8; 3],
        #[serde(default, with = "written_bare", skip_serializing_if = "Option::is_none")]
        panorama: Option<FilePanorama>,
    },
    Sun {
        direction: [f64; 3],
    },
    Bulb {
        position: [f64; 3],
        #[serde(default)]
        orbit: Orbit,
    },
    Spot {
        owner: FileOwner,
        half_aperture: f64,
        exponent: f64,
    },
}

#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FilePanorama {
    pub(super) path: String,
    #[serde(default, skip_serializing_if = "is_zero")]
    turn: f64,
    #[serde(default = "yes")]
    shown: bool,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) enum FileOwner {
    SelectedObject,
    SelectedCamera,
    Object(u32),
    Camera(u32),
    Fixed { position: [f64; 3], direction: [f64; 3] },
}

fn is_zero(size: &f64) -> bool {
    *size == 0.0
}

impl FileLight {
    /// Returns the path of its panorama.
    pub(super) fn panorama(&self) -> Option<&str> {
        match &self.kind {
            FileLightKind::Sky { panorama, .. } => panorama.as_ref().map(|it| it.path.as_str()),
            _ => None,
        }
    }
}

/// Converts a light. Fails with the reason if the path of its panorama cannot be written.
pub(super) fn file_light(id: u32, light: &Light, folder: &Path) -> Result<FileLight, String> {
    let kind = match &light.kind {
        LightKind::Ambient => FileLightKind::Ambient,
        LightKind::Sky { ground: Color(ground), panorama } => {
            let panorama = panorama.as_ref().map(|SkyPanorama { panorama, turn, is_shown }| {
                let path = file_path(&panorama.source, folder)?;
                Ok::<_, String>(FilePanorama { path, turn: *turn, shown: *is_shown })
            });
            FileLightKind::Sky { ground: *ground, panorama: panorama.transpose()? }
        }
        LightKind::Sun { direction } => {
            FileLightKind::Sun { direction: direction.now().to_array() }
        }
        LightKind::Bulb { position, orbit } => {
            FileLightKind::Bulb { position: position.now().to_array(), orbit: *orbit }
        }
        LightKind::Spot { owner, half_aperture, exponent } => FileLightKind::Spot {
            owner: file_owner(owner),
            half_aperture: *half_aperture,
            exponent: *exponent,
        },
    };
    let (name, Color(color)) = (light.name.clone(), light.color);
    let Light { slot, on, attenuation, shadows, size, .. } = *light;
    Ok(FileLight { id, name, slot, on, color, attenuation, shadows, size, kind })
}

pub(super) fn file_owner(owner: &SpotOwner) -> FileOwner {
    match owner {
        SpotOwner::SelectedObject => FileOwner::SelectedObject,
        SpotOwner::SelectedCamera => FileOwner::SelectedCamera,
        SpotOwner::Object(id) => FileOwner::Object(id.0),
        SpotOwner::Camera(id) => FileOwner::Camera(id.0),
        SpotOwner::Fixed(aim) => {
            let Aim { position, direction } = *aim.now();
            let [position, direction] = [position, direction].map(|v| v.to_array());
            FileOwner::Fixed { position, direction }
        }
    }
}

pub(super) fn read_light(light: &FileLight, needs: &dyn Needs) -> Result<Light, String> {
    let kind = match light.kind {
        FileLightKind::Ambient => LightKind::Ambient,
        FileLightKind::Sky { ground, ref panorama } => {
            if let Some(panorama) = panorama {
                finite("its panorama's turn", &[panorama.turn])?;
            }
            let panorama = panorama.as_ref().map(|it| {
                let panorama = needs.panorama(&it.path);
                SkyPanorama { panorama, turn: it.turn, is_shown: it.shown }
            });
            LightKind::Sky { ground: Color(ground), panorama }
        }
        FileLightKind::Sun { direction } => {
            LightKind::Sun { direction: Tracked::new(read_direction(direction)?) }
        }
        FileLightKind::Bulb { position, orbit } => {
            finite("its position", &position)?;
            finite("its orbit", &[orbit.speed, orbit.since])?;
            LightKind::Bulb { position: Tracked::new(DVec3::from_array(position)), orbit }
        }
        FileLightKind::Spot { ref owner, half_aperture, exponent } => {
            // Also false for NaN.
            let right =
                (0.0..=90.0).contains(&half_aperture) && (0.0..f64::INFINITY).contains(&exponent);
            if !right {
                return Err(
                    "its half-aperture must be from 0 to 90, and its exponent at least 0".into()
                );
            }
            LightKind::Spot { owner: read_owner(owner)?, half_aperture, exponent }
        }
    };
    let read = Light {
        name: light.name.clone(),
        slot: light.slot,
        on: light.on,
        color: Color(light.color),
        attenuation: light.attenuation,
        shadows: light.shadows,
        size: light.size,
        kind,
    };
    // Also false for NaN.
    if !(0.0..=read.largest_size()).contains(&read.size) {
        return Err("its size must be at least 0, and at most 90 degrees for a sun".into());
    }
    Ok(read)
}

pub(super) fn read_owner(owner: &FileOwner) -> Result<SpotOwner, String> {
    Ok(match *owner {
        FileOwner::SelectedObject => SpotOwner::SelectedObject,
        FileOwner::SelectedCamera => SpotOwner::SelectedCamera,
        FileOwner::Object(id) => SpotOwner::Object(ObjectId(id)),
        FileOwner::Camera(id) => SpotOwner::Camera(CameraId(id)),
        FileOwner::Fixed { position, direction } => {
            finite("its position", &position)?;
            let position = DVec3::from_array(position);
            SpotOwner::Fixed(Tracked::new(Aim { position, direction: read_direction(direction)? }))
        }
    })
}

/// Checks a direction and normalizes it. A unit vector is kept bit for bit.
pub(super) fn read_direction(direction: [f64; 3]) -> Result<DVec3, String> {
    finite("its direction", &direction)?;
    let direction = DVec3::from_array(direction);
    if (direction.length() - 1.0).abs() < 1e-9 {
        return Ok(direction);
    }
    math::unit(direction).ok_or_else(|| "its direction has no length".to_owned())
}
