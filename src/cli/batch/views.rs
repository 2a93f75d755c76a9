//! The cameras of `--views`: evenly spaced, by name, on a sphere, or from a file.

use std::path::Path;

use glam::{DMat3, DVec3};
use marraztu::directions::DIRECTIONS;
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;
use marraztu_core::edit::framing::MODELS_FROM;
use marraztu_io::read_file;

use super::camera_file::from_json;
use crate::cli::render::Aim;

/// The most views of a model.
pub(super) const MOST_VIEWS: usize = 100_000;

/// A camera, and its name in file names and reports.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CameraView {
    pub(crate) name: String,
    pub(crate) aim: Aim,
    /// The size of the picture that the camera was calibrated for.
    pub(crate) size: Option<Size>,
}

/// Returns the view that the options of the picture describe.
pub(super) fn own_view() -> Vec<CameraView> {
    vec![CameraView { name: "0".to_owned(), aim: Aim::Options, size: None }]
}

/// Parses the value of `--views`. Fails with the reason if it is invalid or its file cannot be
/// used.
pub(crate) fn parse_views(text: &str) -> Result<Vec<CameraView>, String> {
    let text = text.trim();
    if let Ok(count) = text.parse::<usize>() {
        return Ok(evenly_spaced(checked(count)?));
    }
    if let Some(numbers) = text.strip_prefix("fibonacci:") {
        let (count, seed) = numbers.split_once(':').unwrap_or((numbers, "0"));
        let invalid = |_error| "write fibonacci:COUNT or fibonacci:COUNT:SEED".to_owned();
        let seed = seed.parse().map_err(invalid)?;
        return Ok(fibonacci(checked(count.parse().map_err(invalid)?)?, seed));
    }
    let path = Path::new(text);
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json")) {
        let json = read_file(path).map_err(|error| error.to_string())?;
        let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&json);
        return from_json(json).map_err(|reason| format!("{text}: {reason}"));
    }
    text.split(',').map(|name| named(name.trim())).collect()
}

fn checked(count: usize) -> Result<usize, String> {
    let is_right = (1..=MOST_VIEWS).contains(&count);
    is_right.then_some(count).ok_or_else(|| format!("write 1 to {MOST_VIEWS} views"))
}

fn named(name: &str) -> Result<CameraView, String> {
    let found = DIRECTIONS.iter().find(|(other, _)| *other == name);
    let (name, from) = found.ok_or_else(|| {
        let names: Vec<&str> = DIRECTIONS.iter().map(|(name, _)| *name).collect();
        format!(
            "there is no view {name:?}; write a number, fibonacci:COUNT, a file of cameras \
             (.json), or names from {}",
            names.join(", ")
        )
    })?;
    Ok(CameraView { name: (*name).to_owned(), aim: Aim::From(*from), size: None })
}

/// Returns views from around the model. The first one is the default view of models.
#[expect(clippy::cast_precision_loss, reason = "at most 100,000 views")]
fn evenly_spaced(count: usize) -> Vec<CameraView> {
    let [right, up] = MODELS_FROM;
    let view = |i: usize| {
        let right = right + 360.0 * i as f64 / count as f64;
        CameraView { name: i.to_string(), aim: Aim::From([right, up]), size: None }
    };
    (0..count).map(view).collect()
}

/// Returns views from the points of a Fibonacci sphere, rotated at random. Seed 0 does not rotate.
///
/// ```text
/// y = 1 - (2 i + 1) / N        phi = i pi (3 - sqrt 5)
/// ```
///
/// Gonzalez, "Measurement of Areas on a Sphere Using Fibonacci and Latitude-Longitude Lattices",
/// Mathematical Geosciences 2010.
#[expect(clippy::cast_precision_loss, reason = "at most 100,000 views")]
fn fibonacci(count: usize, seed: u64) -> Vec<CameraView> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let rotation = if seed == 0 { DMat3::IDENTITY } else { random_rotation(seed) };
    let view = |i: usize| {
        let y = 1.0 - (2 * i + 1) as f64 / count as f64;
        let (sin, cos) = libm::sincos(golden * i as f64);
        let radius = (1.0 - y * y).max(0.0).sqrt();
        let towards = rotation * DVec3::new(radius * sin, y, radius * cos);
        let right = libm::atan2(towards.x, towards.z).to_degrees();
        let up = libm::asin(towards.y.clamp(-1.0, 1.0)).to_degrees();
        CameraView { name: i.to_string(), aim: Aim::From([right, up]), size: None }
    };
    (0..count).map(view).collect()
}

/// Returns a uniformly distributed rotation: Shoemake, "Uniform Random Rotations", Graphics Gems
/// III, 1992. The numbers are drawn by SplitMix64.
fn random_rotation(seed: u64) -> DMat3 {
    let mut rng = Rng::new(seed);
    let [u, v, w] = [1.0, std::f64::consts::TAU, std::f64::consts::TAU].map(|to| rng.unit() * to);
    let ((sin_v, cos_v), (sin_w, cos_w)) = (libm::sincos(v), libm::sincos(w));
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    DMat3::from_quat(glam::DQuat::from_xyzw(a * sin_v, a * cos_v, b * sin_w, b * cos_w))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from(view: &CameraView) -> [f64; 2] {
        match view.aim {
            Aim::From(from) => from,
            Aim::Options | Aim::Pose(..) => panic!("{view:?}"),
        }
    }

    /// The direction from the model to the camera.
    fn towards(view: &CameraView) -> DVec3 {
        let [right, up] = from(view).map(f64::to_radians);
        DVec3::new(right.sin() * up.cos(), up.sin(), right.cos() * up.cos())
    }

    #[test]
    fn views_are_evenly_spaced_named_or_rejected() {
        let four = parse_views("4").unwrap();
        let rights: Vec<f64> = four.iter().map(|view| from(view)[0]).collect();
        assert_eq!(rights, [30.0, 120.0, 210.0, 300.0]);
        assert!(four.iter().all(|view| from(view)[1] == 20.0));
        let names = parse_views("front, iso,top").unwrap();
        assert_eq!(
            names.iter().map(|view| view.name.as_str()).collect::<Vec<_>>(),
            ["front", "iso", "top"]
        );
        let iso = towards(&names[1]);
        assert!((iso - DVec3::splat(1.0 / 3.0_f64.sqrt())).length() < 1e-12, "{iso}");
        for wrong in [
            "0",
            "100001",
            "-3",
            "frontal",
            "",
            "fibonacci:",
            "fibonacci:0",
            "fibonacci:3:x",
            "no.json",
        ] {
            assert!(parse_views(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_fibonacci_sphere_is_even_and_depends_on_the_seed() {
        let plain = parse_views("fibonacci:200").unwrap();
        let turned = parse_views("fibonacci:200:7").unwrap();
        assert_ne!(plain, turned);
        assert_eq!(turned, parse_views("fibonacci:200:7").unwrap());
        for views in [&plain, &turned] {
            let mean = views.iter().map(towards).sum::<DVec3>() / 200.0;
            assert!(mean.length() < 0.01, "{mean}");
            // 200 even points are about 2 sqrt(pi / 200) = 0.25 apart.
            for (i, a) in views.iter().enumerate() {
                let others = views.iter().enumerate().filter(|(j, _)| *j != i);
                let nearest =
                    others.map(|(_, b)| towards(a).distance(towards(b))).fold(9.0, f64::min);
                assert!((0.15..0.35).contains(&nearest), "{nearest}");
            }
        }
    }
}
