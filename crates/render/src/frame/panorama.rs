//! The panoramas around a frame: their light on surfaces, and along rays that meet nothing.

use glam::{DMat3, DMat4, DVec3};

use super::FramePlan;
use crate::lights::Irradiance;
use marraztu_core::base::Shared;
use marraztu_core::base::color::linear;
use marraztu_core::base::math::unit;
use marraztu_core::scene::{Moments, Panorama, PanoramaLight, SkyPanorama};

/// The panorama of a sky that shines.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PlacedPanorama {
    /// The number of the light; `None` for the environment of a material.
    pub(crate) light: Option<u32>,
    panorama: Shared<Panorama>,
    /// The rotation from world space to the picture.
    picture_from_world: DMat3,
    /// The rotation from view space to the picture.
    picture_from_view: DMat3,
    /// The factors of its light.
    factor: [f64; 3],
    /// Whether light is computed in linear values.
    is_linear: bool,
    /// Whether it is the background.
    pub(crate) is_shown: bool,
}

impl PlacedPanorama {
    pub(crate) fn new(
        sky: &SkyPanorama,
        (light, factor): (Option<u32>, [f64; 3]),
        view_from_world: DMat4,
        is_linear: bool,
    ) -> Self {
        // The view transform turns and scales evenly.
        let turned = DMat3::from_mat4(view_from_world).transpose();
        let scale = turned.x_axis.length();
        let picture_from_world = sky.picture_from_world();
        // Prepared here, because drawing runs in parallel.
        sky.panorama.light(is_linear);
        Self {
            light,
            panorama: sky.panorama.clone(),
            picture_from_world,
            picture_from_view: picture_from_world * (turned * (1.0 / scale)),
            factor,
            is_linear,
            is_shown: sky.is_shown,
        }
    }

    /// Returns the address of the picture, which tells it from others that are alive.
    pub(crate) fn address(&self) -> usize {
        Shared::address(&self.panorama)
    }

    fn light(&self) -> &PanoramaLight {
        self.panorama.light(self.is_linear)
    }

    fn scaled(&self, light: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| light[i] * self.factor[i])
    }

    /// Returns the light from a direction in view space, over an angle in radians.
    pub(crate) fn seen(&self, towards: DVec3, width: f64) -> [f64; 3] {
        let direction = unit(self.picture_from_view * towards).unwrap_or(DVec3::NEG_Z);
        self.scaled(self.light().seen(direction, width))
    }

    /// Returns whether a considerable part of the light comes from lamps.
    pub(crate) fn has_lamps(&self) -> bool {
        self.light().has_lamps()
    }

    /// Returns the light around a direction in world space, over the solid angle of one of some
    /// samples.
    pub(crate) fn spread(&self, towards: DVec3, samples: u32) -> [f64; 3] {
        self.scaled(self.light().spread(self.picture_from_world * towards, samples))
    }

    /// Returns the light around a direction in world space, and the density per solid angle of
    /// [`Self::towards_lamp`] there.
    pub(crate) fn around(&self, towards: DVec3) -> ([f64; 3], f64) {
        let (light, density) = self.light().around(self.picture_from_world * towards);
        (self.scaled(light), density)
    }

    /// Returns a direction to a lamp in world space for two numbers from 0 to 1: the more frequent,
    /// the brighter it is.
    pub(crate) fn towards_lamp(&self, at: [f64; 2]) -> DVec3 {
        self.picture_from_world.transpose() * self.light().towards_lamp(at)
    }

    /// Returns the light that reaches a surface with the normal n, in view space, from the half of
    /// all directions in front of it, weighted by the cosine of incidence and divided by pi.
    ///
    /// The weight is replaced by its first three bands of spherical harmonics: the error is 9% in
    /// theory, and about 3% for real panoramas (Ramamoorthi and Hanrahan, "An Efficient
    /// Representation for Irradiance Environment Maps", SIGGRAPH 2001). In the integrals of L, L d
    /// and L d d^T over all directions d, that is
    ///
    ///   (3/32 M0 + 1/2 M1 . n + 15/32 n^T M2 n) / pi
    pub(crate) fn irradiance(&self) -> Irradiance<f64> {
        let view_from_picture = self.picture_from_view.transpose();
        let mut channels = self.light().moments().iter().zip(self.factor);
        std::array::from_fn(|_| {
            let Some((Moments { all, along, square }, factor)) = channels.next() else {
                return [0.0; 10];
            };
            let along = view_from_picture * *along;
            let square = view_from_picture * *square * view_from_picture.transpose();
            let [x, y, z] = [square.x_axis, square.y_axis, square.z_axis];
            let [flat, line, bent] = [3.0 / 32.0, 0.5, 15.0 / 32.0];
            [
                flat * all,
                line * along.x,
                line * along.y,
                line * along.z,
                bent * x.x,
                bent * y.y,
                bent * z.z,
                2.0 * bent * x.y,
                2.0 * bent * x.z,
                2.0 * bent * y.z,
            ]
            .map(|it| it * factor / std::f64::consts::PI)
        })
    }
}

impl FramePlan {
    /// Returns the panorama of a light that has one and shines.
    pub(crate) fn panorama_of(&self, light: u32) -> Option<&PlacedPanorama> {
        self.panoramas.iter().find(|panorama| panorama.light == Some(light))
    }

    /// Returns the light that arrives along a ray that meets nothing, as values to be summed.
    pub(crate) fn light_behind(&self, towards: DVec3, width: f64) -> [f64; 3] {
        if self.panoramas.is_empty() {
            let background = self.background.factors();
            let is_linear = self.shading_mode().is_linear();
            return if is_linear { background.map(linear) } else { background };
        }
        light_of(self.panoramas.iter(), towards, width)
    }

    /// Returns the size of a pixel in view space at the distance 1, or anywhere without
    /// perspective.
    pub(crate) fn pixel_size(&self) -> f64 {
        2.0 / (self.viewport.height * self.clip_from_view.y_axis.y)
    }
}

/// Returns the light of several panoramas from a direction in view space, over an angle in radians.
pub(crate) fn light_of<'a>(
    panoramas: impl Iterator<Item = &'a PlacedPanorama>,
    towards: DVec3,
    width: f64,
) -> [f64; 3] {
    panoramas.fold([0.0; 3], |sum, panorama| {
        let light = panorama.seen(towards, width);
        std::array::from_fn(|i| sum[i] + light[i])
    })
}
