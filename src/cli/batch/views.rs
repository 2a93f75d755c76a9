//! The cameras of `--views`: evenly spaced, by name, on a sphere, or from a file.
//!
//! The file is the `transforms.json` of NeRF and nerfstudio: matrices from camera to world, with
//! the axes of OpenGL (x to the right, y up, the camera looks along -z). The world is the scene of
//! the picture.

use std::path::Path;

use glam::{DMat3, DMat4, DVec3, DVec4};
use marraztu::directions::DIRECTIONS;
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;
use marraztu_core::edit::framing::MODELS_FROM;
use marraztu_core::scene::Pose;
use marraztu_io::read_file;
use serde::Deserialize;

use crate::cli::render::{Aim, PoseLens};

/// The most views of a model.
const MOST_VIEWS: usize = 100_000;

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

/// A file of cameras. All intrinsics may be given per file or per frame.
#[derive(Debug, Deserialize)]
struct Transforms {
    #[serde(flatten)]
    shared: Intrinsics,
    frames: Vec<Frame>,
}

/// A camera of the file.
#[derive(Debug, Deserialize)]
struct Frame {
    file_path: Option<String>,
    transform_matrix: Vec<[f64; 4]>,
    /// "perspective" or "orthographic", as in `cameras.json`.
    projection: Option<String>,
    pixels_per_unit: Option<f64>,
    #[serde(flatten)]
    own: Intrinsics,
}

/// Focal lengths, size and principal point in pixels, or angles of view in radians. Lenses that
/// distort are rejected.
#[derive(Clone, Debug, Default, Deserialize)]
struct Intrinsics {
    camera_model: Option<String>,
    k1: Option<f64>,
    k2: Option<f64>,
    k3: Option<f64>,
    k4: Option<f64>,
    p1: Option<f64>,
    p2: Option<f64>,
    #[serde(default)]
    is_fisheye: bool,
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    w: Option<f64>,
    h: Option<f64>,
    camera_angle_x: Option<f64>,
    camera_angle_y: Option<f64>,
}

impl Intrinsics {
    /// Returns these numbers, completed by shared ones.
    fn or(self, shared: &Self) -> Self {
        // A lens may be stated in several ways, so it is taken from one place.
        let own = [self.fl_x, self.fl_y, self.camera_angle_x, self.camera_angle_y];
        let lens = if own.iter().any(Option::is_some) { &self } else { shared };
        let Self { fl_x, fl_y, camera_angle_x, camera_angle_y, .. } = *lens;
        Self {
            camera_model: self.camera_model.or_else(|| shared.camera_model.clone()),
            k1: self.k1.or(shared.k1),
            k2: self.k2.or(shared.k2),
            k3: self.k3.or(shared.k3),
            k4: self.k4.or(shared.k4),
            p1: self.p1.or(shared.p1),
            p2: self.p2.or(shared.p2),
            is_fisheye: self.is_fisheye || shared.is_fisheye,
            fl_x,
            fl_y,
            cx: self.cx.or(shared.cx),
            cy: self.cy.or(shared.cy),
            w: self.w.or(shared.w),
            h: self.h.or(shared.h),
            camera_angle_x,
            camera_angle_y,
        }
    }

    /// Returns an error for a lens other than that of a pinhole camera.
    fn check_lens(&self) -> Result<(), String> {
        // The names of nerfstudio. Its default is OPENCV, which is a pinhole without distortion.
        let model = self.camera_model.as_deref().unwrap_or("OPENCV");
        if self.is_fisheye || !["OPENCV", "PINHOLE", "SIMPLE_PINHOLE"].contains(&model) {
            let model = if self.is_fisheye { "fisheye" } else { model };
            return Err(format!("cameras of the model {model} are not supported"));
        }
        let Self { k1, k2, k3, k4, p1, p2, .. } = self;
        let is_distorted = |term: &Option<f64>| term.is_some_and(|term| term != 0.0);
        if [k1, k2, k3, k4, p1, p2].into_iter().any(is_distorted) {
            return Err("lenses that distort (k1 to k4, p1, p2) are not supported".to_owned());
        }
        Ok(())
    }

    /// Returns the size of the picture, if the file states one.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked before")]
    fn size(&self) -> Result<Option<Size>, String> {
        let side = |side: f64| {
            let is_right = (1.0..=16_384.0).contains(&side) && side.fract() == 0.0;
            is_right.then_some(side as usize).ok_or("w and h are whole numbers from 1 to 16384")
        };
        let (Some(w), Some(h)) = (self.w, self.h) else { return Ok(None) };
        Ok(Some(Size::new(side(w)?, side(h)?)))
    }

    /// Returns the lens of a perspective camera; `otherwise`, if the file states no angle.
    #[expect(clippy::cast_precision_loss, reason = "at most 16,384 pixels")]
    fn lens(&self, size: Option<Size>, otherwise: PoseLens) -> Result<PoseLens, String> {
        let half = |tangent: f64| {
            let degrees = libm::atan(tangent).to_degrees();
            let is_right = degrees > 0.0 && degrees < 90.0;
            is_right.then_some(degrees).ok_or_else(|| "the lens has no angle".to_owned())
        };
        let sides = size.map(|size| [size.width as f64, size.height as f64]);
        let off = |centre: Option<f64>, side: f64| {
            centre.is_some_and(|centre| (centre - side / 2.0).abs() > 1.0)
        };
        if sides.is_some_and(|[w, h]| off(self.cx, w) || off(self.cy, h)) {
            let reason = "cx, cy is not the centre of the picture, which is not supported";
            return Err(reason.to_owned());
        }
        // Pixels are square: one focal length, or one angle, states the lens.
        if let Some(fl_x) = self.fl_x.or(self.fl_y) {
            let fl_y = self.fl_y.unwrap_or(fl_x);
            if (fl_x - fl_y).abs() > fl_x.abs() / 1000.0 {
                return Err("fl_x and fl_y differ: pixels are square here".to_owned());
            }
            let Some([w, h]) = sides else {
                return Err("fl_x and fl_y are in pixels: w and h are needed".to_owned());
            };
            return half(w.min(h) / 2.0 / if w < h { fl_x } else { fl_y }).map(PoseLens::Shorter);
        }
        let tangent = |angle: Option<f64>| angle.map(|angle| libm::tan(angle / 2.0));
        let [across, up] = [self.camera_angle_x, self.camera_angle_y].map(tangent);
        if let (Some(across), Some(up), Some([w, h])) = (across, up, sides)
            && (across * h - up * w).abs() > (across * h).abs() / 100.0
        {
            let reason = "camera_angle_x and camera_angle_y do not fit w and h: pixels are square";
            return Err(reason.to_owned());
        }
        match (across, up, sides) {
            (Some(across), _, Some([w, h])) => {
                half(across * (h / w).min(1.0)).map(PoseLens::Shorter)
            }
            (Some(across), _, None) => half(across).map(PoseLens::Across),
            (None, Some(up), Some([w, h])) => half(up * (w / h).min(1.0)).map(PoseLens::Shorter),
            (None, Some(up), None) => half(up).map(PoseLens::Upwards),
            (None, None, _) => Ok(otherwise),
        }
    }
}

/// Returns the lens of an orthographic camera.
#[expect(clippy::cast_precision_loss, reason = "at most 16,384 pixels")]
fn parallel(pixels_per_unit: Option<f64>, size: Option<Size>) -> Result<PoseLens, String> {
    match (pixels_per_unit, size) {
        (Some(pixels), Some(Size { width, height })) if pixels > 0.0 => {
            Ok(PoseLens::Parallel(width.min(height) as f64 / 2.0 / pixels))
        }
        _ => Err("orthographic cameras need w, h and pixels_per_unit".to_owned()),
    }
}

fn from_json(json: &[u8]) -> Result<Vec<CameraView>, String> {
    let Transforms { shared, frames } =
        serde_json::from_slice(json).map_err(|error| error.to_string())?;
    if !(1..=MOST_VIEWS).contains(&frames.len()) {
        return Err(format!("it has {} frames; 1 to {MOST_VIEWS} are possible", frames.len()));
    }
    let view = |(i, frame): (usize, Frame)| {
        let named = |reason: String| format!("frame {i}: {reason}");
        let intrinsics = frame.own.or(&shared);
        intrinsics.check_lens().map_err(named)?;
        let size = intrinsics.size().map_err(named)?;
        let lens = match frame.projection.as_deref() {
            None => intrinsics.lens(size, PoseLens::Selected),
            Some("perspective") => intrinsics.lens(size, PoseLens::Perspective),
            Some("orthographic") => parallel(frame.pixels_per_unit, size),
            Some(other) => Err(format!("there is no projection {other:?}")),
        };
        let lens = lens.map_err(named)?;
        let pose = pose(&frame.transform_matrix).map_err(named)?;
        let stem = frame.file_path.as_deref().map(|path| path.replace('\\', "/"));
        let stem = stem.as_deref().and_then(|path| Path::new(path).file_stem()?.to_str());
        let name = stem.map_or_else(|| i.to_string(), str::to_owned);
        Ok(CameraView { name, aim: Aim::Pose(pose, lens), size })
    };
    frames.into_iter().enumerate().map(view).collect()
}

/// Converts a matrix from camera to world, given as rows.
fn pose(rows: &[[f64; 4]]) -> Result<Pose, String> {
    let rows = match *rows {
        [a, b, c] => [a, b, c, [0.0, 0.0, 0.0, 1.0]],
        [a, b, c, d] => [a, b, c, d],
        _ => return Err(format!("transform_matrix needs 3 or 4 rows, not {}", rows.len())),
    };
    let [a, b, c, d] = rows.map(DVec4::from_array);
    Pose::from_matrix(DMat4::from_cols(a, b, c, d).transpose())
        .ok_or_else(|| "transform_matrix is not a rotation with a position".to_owned())
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

    #[test]
    fn cameras_of_a_file_have_its_poses_lenses_and_names() {
        let json = br#"{"fl_x": 100, "fl_y": 100, "w": 200, "h": 100, "cx": 100, "cy": 50,
            "frames": [
                {"file_path": "./train/r_0.png",
                 "transform_matrix": [[0,0,1,5],[0,1,0,6],[-1,0,0,7],[0,0,0,1]]},
                {"transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4]], "w": 100, "h": 200,
                 "cx": 50, "cy": 100}
            ]}"#;
        let views = from_json(json).unwrap();
        assert_eq!([&*views[0].name, &*views[1].name], ["r_0", "1"]);
        assert_eq!(views[0].size, Some(Size::new(200, 100)));
        // The shorter side is 100 pixels: atan(50 / 100).
        for view in &views {
            let Aim::Pose(_, PoseLens::Shorter(half_angle)) = view.aim else { panic!("{view:?}") };
            assert!((half_angle - 26.565_051_177_077_99).abs() < 1e-9, "{half_angle}");
        }
        let Aim::Pose(pose, _) = views[0].aim else { panic!() };
        assert_eq!((pose.eye, pose.axes.z_axis), (DVec3::new(5.0, 6.0, 7.0), DVec3::X));
        let angle = br#"{"camera_angle_x": 1.5707963267948966,
            "frames": [{"transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4]]}]}"#;
        let Aim::Pose(_, PoseLens::Across(half_angle)) = from_json(angle).unwrap()[0].aim else {
            panic!()
        };
        assert!((half_angle - 45.0).abs() < 1e-9);
    }

    #[test]
    fn the_lens_of_a_file_is_vertical_too_and_that_of_a_frame_comes_first() {
        let lens = |shared: &str, own: &str| {
            let json = format!(
                r#"{{{shared} "frames": [{{{own}
                    "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4]]}}]}}"#
            );
            match from_json(json.as_bytes()).unwrap()[0].aim.at(Size::new(40, 30)) {
                Aim::Pose(_, PoseLens::Shorter(half_angle)) => half_angle,
                aim => panic!("{aim:?}"),
            }
        };
        let (wide, tall) = (r#""w": 40, "h": 30,"#, r#""w": 30, "h": 40,"#);
        // Half of the shorter side is 15 pixels in all of them.
        for (shared, own, tangent) in [
            (wide, r#""fl_y": 30,"#, 0.5),
            (tall, r#""fl_y": 30,"#, 0.5),
            (wide, r#""camera_angle_y": 0.8,"#, libm::tan(0.4)),
            (tall, r#""camera_angle_y": 0.8,"#, 0.75 * libm::tan(0.4)),
            ("", r#""camera_angle_y": 0.8,"#, libm::tan(0.4)),
            (
                r#""w": 40, "h": 30, "fl_x": 60,"#,
                r#""camera_angle_x": 0.8,"#,
                0.75 * libm::tan(0.4),
            ),
            (r#""w": 40, "h": 30, "fl_x": 60,"#, r#""fl_y": 30,"#, 0.5),
            (r#""w": 40, "h": 30, "fl_y": 60,"#, "", 0.25),
        ] {
            let half_angle = libm::atan(tangent).to_degrees();
            assert!((lens(shared, own) - half_angle).abs() < 1e-9, "{shared} {own}");
        }
    }

    #[test]
    fn cameras_that_cannot_be_drawn_are_rejected_with_their_frame() {
        let frame = |lens: &str, matrix: &str| {
            let json = format!(r#"{{{lens} "frames": [{{"transform_matrix": {matrix}}}]}}"#);
            from_json(json.as_bytes()).unwrap_err()
        };
        let whole = "[[1,0,0,0],[0,1,0,0],[0,0,1,4]]";
        for (lens, matrix, reason) in [
            ("", "[[1,0,0,0],[0,1,0,0]]", "3 or 4 rows"),
            ("", "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,4,1]]", "not a rotation"),
            ("", "[[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,2]]", "not a rotation"),
            ("", "[[2,0,0,0],[0,2,0,0],[0,0,2,4]]", "not a rotation"),
            ("", "[[-1,0,0,0],[0,1,0,0],[0,0,1,4]]", "not a rotation"),
            (r#""fl_x": 100, "fl_y": 90, "w": 64, "h": 64,"#, whole, "differ"),
            (r#""fl_x": 100, "cx": 10, "w": 64, "h": 64,"#, whole, "centre"),
            (r#""fl_x": 100,"#, whole, "w and h are needed"),
            (r#""fl_y": 100,"#, whole, "w and h are needed"),
            (r#""camera_angle_x": 1, "cy": 10, "w": 64, "h": 64,"#, whole, "centre"),
            (r#""camera_angle_x": 1, "camera_angle_y": 0.9, "w": 64, "h": 64,"#, whole, "square"),
            (r#""w": 0.5, "h": 64,"#, whole, "whole numbers"),
            (r#""k1": 0.1, "p2": 0,"#, whole, "lenses that distort"),
            (r#""p1": -0.01,"#, whole, "lenses that distort"),
            (r#""camera_model": "OPENCV_FISHEYE","#, whole, "model OPENCV_FISHEYE"),
            (r#""is_fisheye": true,"#, whole, "model fisheye"),
        ] {
            let error = frame(lens, matrix);
            assert!(error.starts_with("frame 0: ") && error.contains(reason), "{error}");
        }
        assert!(from_json(br#"{"frames": []}"#).unwrap_err().starts_with("it has 0 frames"));
        let plain = format!(
            r#"{{"camera_model": "OPENCV", "k1": 0, "frames": [{{"transform_matrix": {whole}}}]}}"#
        );
        assert!(from_json(plain.as_bytes()).is_ok());
    }
}
