//! The ground: a disc that fades out towards its rim, so its edge is invisible.
//!
//! With the distance r from the centre and the radius R, the opacity is 1 up to R/2; beyond that it
//! is
//!
//! ```text
//! 1 - s^2 (3 - 2 s)   with s = 2 r / R - 1
//! ```
//!
//! The inner half is opaque and costs no more than any opaque surface. The rest has an opacity map
//! with [`SIDE`] texels a side. It follows the formula to 1/255: rounding adds half a step of a
//! byte, and interpolation 0.05 steps, since the second derivative is at most 6 / (R/2)^2.

use glam::DVec3;

use super::solids::{AROUND, Builder, turn};
use crate::base::Shared;
use crate::base::color::byte;
use crate::base::image::{Picture, Size};
use crate::scene::{FileMaterial, MapKind, Material, Part, SurfaceMap, SurfaceMaps, Texture, Wrap};

/// The number of texels in a row of the map.
const SIDE: usize = 256;

/// Returns the opacity at a distance from the centre, relative to the radius.
fn opacity(r: f64) -> f64 {
    let s = (2.0 * r - 1.0).clamp(0.0, 1.0);
    1.0 - s * s * (3.0 - 2.0 * s)
}

/// Builds the inner disc and the ring that fades out.
pub(super) fn build(builder: &mut Builder) {
    let normal = builder.normal(DVec3::Y);
    let mut corner = |i: u32, radius: f64| {
        let [sine, cosine] = turn(i % AROUND, AROUND);
        let [x, z] = [sine, cosine].map(|x| x * radius);
        [builder.position(DVec3::new(x, 0.0, z)), builder.uv(0.5 + x, 0.5 - z), normal]
    };
    let [inner, outer] = [0.25, 0.5].map(|radius| {
        let corners: Vec<[u32; 3]> = (0..AROUND).map(|i| corner(i, radius)).collect();
        corners
    });
    builder.polygon(&inner);
    let at = |i: u32| (i % AROUND) as usize;
    for i in 0..AROUND {
        let (this, next) = (at(i), at(i + 1));
        builder.polygon(&[inner[this], outer[this], outer[next], inner[next]]);
    }
    builder.source.polygon_parts[1..].fill(1);
    let part = |name: &str, material| Part { name: name.to_owned(), material: Some(material) };
    builder.source.parts = vec![part("ground", 0), part("rim", 1)];
}

/// Returns the ground's materials: the same grey, once opaque and once fading.
pub(super) fn materials() -> Vec<FileMaterial> {
    let mut picture = Picture::filled(Size::new(SIDE, SIDE), [0, 0, 0, 255]);
    #[expect(clippy::cast_precision_loss, reason = "few texels")]
    let place = |i: usize| (i as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0;
    for (i, pixel) in picture.pixels_mut().iter_mut().enumerate() {
        let grey = byte(opacity(libm::hypot(place(i % SIDE), place(i / SIDE))));
        *pixel = [grey, grey, grey, 255];
    }
    let texture = Texture { wrap: Wrap::Clamp, ..Texture::new("own:ground", picture) };
    let texture = Shared::new(texture);
    let fading = SurfaceMaps::from([(MapKind::Opacity, SurfaceMap { texture, gain: 1.0 })]);
    // Under the five lights of the first scene, this is a medium grey.
    let material = Material::matte([0.1; 3], [0.25; 3]);
    let rim = FileMaterial { maps: fading, ..FileMaterial::new("rim", material) };
    vec![FileMaterial::new("ground", material), rim]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ground_is_opaque_up_to_half_of_its_radius_and_gone_at_its_rim() {
        assert_eq!([0.0, 0.5, 0.75, 1.0, 2.0].map(opacity), [1.0, 1.0, 0.5, 0.0, 0.0]);
        let materials = materials();
        let map = &materials[1].maps[&MapKind::Opacity].texture;
        // Between texels the error is at most half a step of a byte and a twentieth, too.
        for (i, j) in [(140, 131), (200, 131), (230, 60), (250, 128)] {
            let at = |i: usize| (i as f64 + 1.0) / SIDE as f64 * 2.0 - 1.0;
            let texels = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)];
            let mean: f64 =
                texels.iter().map(|(i, j)| f64::from(map.picture.pixel(*i, *j)[0])).sum::<f64>()
                    / 4.0;
            let exact = 255.0 * opacity(libm::hypot(at(i), at(j)));
            assert!((mean - exact).abs() < 0.55, "{mean} instead of {exact}");
        }
    }
}
