//! Distinguishes normal maps from height maps.
//!
//! A picture of tangent-space normals n stores (n + 1) / 2. All n have length 1 and point away from
//! the surface, so the picture is bluish, with a mean near (128, 128, 255). Heights are grey, and
//! the two greys with length 1 are far from that mean.

use marraztu_core::base::image::Picture;

/// The number of texels that are sampled.
const MOST: usize = 1 << 16;

/// Returns whether a picture contains tangent-space normals.
pub(super) fn shows_normals(picture: &Picture) -> bool {
    let texels = picture.pixels();
    let step = texels.len().div_ceil(MOST).max(1);
    let (mut count, mut units, mut sum) = (0.0, 0.0, [0.0; 3]);
    // An odd step visits every column of a picture with a power-of-two width.
    for [r, g, b, _] in texels.iter().step_by(step | 1) {
        let normal = [*r, *g, *b].map(|byte| f64::from(byte) / 127.5 - 1.0);
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        // The tolerance covers 8-bit rounding and lossy compression.
        let is_unit = (length - 1.0).abs() < 0.15 && normal[2] > -0.05;
        units += if is_unit { 1.0 } else { 0.0 };
        count += 1.0;
        sum = std::array::from_fn(|i| sum[i] + normal[i]);
    }
    let [x, y, z] = sum.map(|sum| sum / count);
    units > 0.9 * count && x.abs() < 0.25 && y.abs() < 0.25 && z > 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use marraztu_core::base::image::Size;

    fn picture(texel: impl Fn(f64, f64) -> [f64; 3]) -> Picture {
        let place = |i: u32| (f64::from(i) + 0.5) / 32.0 - 1.0;
        let texel = |i: u32| {
            let [r, g, b] = texel(place(i % 64), place(i / 64));
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a byte")]
            let byte = |x: f64| ((x + 1.0) * 127.5).round() as u8;
            [byte(r), byte(g), byte(b), 255]
        };
        Picture::from_pixels(Size::new(64, 64), (0..64 * 64).map(texel).collect()).unwrap()
    }

    #[test]
    fn normals_are_told_from_heights_and_colours() {
        let dome = |x: f64, y: f64| {
            let (x, y) = (0.7 * x, 0.7 * y);
            [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()]
        };
        assert!(shows_normals(&picture(dome)));
        assert!(shows_normals(&picture(|_, _| [0.0, 0.0, 1.0])), "flat");
        assert!(!shows_normals(&picture(|x, y| [(x * x + y * y) - 1.0; 3])), "heights");
        for grey in [-1.0, -0.577, 0.0, 0.577, 1.0] {
            assert!(!shows_normals(&picture(|_, _| [grey; 3])), "{grey}");
        }
        assert!(!shows_normals(&picture(|x, y| [x, y, 0.9])), "a blue colour map");
        assert!(!shows_normals(&picture(|_, _| [0.9, 0.1, 0.1])), "red");
    }
}
