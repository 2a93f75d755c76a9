//! The cameras of a file, with their poses and lenses.
//!
//! The file is the `transforms.json` of NeRF, nerfstudio and instant-ngp: matrices from camera to
//! world, with the axes of OpenGL (x to the right, y up, the camera looks along -z). The world is
//! the scene of the picture. The centre of the first pixel is (0.5, 0.5), as in COLMAP, unless the
//! file states another `pixel_center`.

use std::path::Path;

use glam::{DMat4, DVec2, DVec4};
use marraztu_core::base::image::Size;
use marraztu_core::scene::{Intrinsics, Lens, Pose, Projection};
use serde::Deserialize;

use super::views::{CameraView, MOST_VIEWS};
use crate::cli::render::{Aim, PoseLens};

/// A file of cameras. All intrinsics may be given per file or per frame.
#[derive(Debug, Deserialize)]
struct Transforms {
    #[serde(flatten)]
    shared: Numbers,
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
    pixel_aspect: Option<f64>,
    #[serde(flatten)]
    own: Numbers,
}

/// Focal lengths, size and principal point in pixels, or angles of view in radians. Lenses that
/// distort are rejected.
#[derive(Clone, Debug, Default, Deserialize)]
struct Numbers {
    camera_model: Option<String>,
    k1: Option<f64>,
    k2: Option<f64>,
    k3: Option<f64>,
    k4: Option<f64>,
    k5: Option<f64>,
    k6: Option<f64>,
    p1: Option<f64>,
    p2: Option<f64>,
    distortion_params: Option<Vec<f64>>,
    #[serde(default)]
    is_fisheye: bool,
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    /// The position of the first pixel's centre.
    pixel_center: Option<f64>,
    w: Option<f64>,
    h: Option<f64>,
    camera_angle_x: Option<f64>,
    camera_angle_y: Option<f64>,
}

/// The models of nerfstudio and COLMAP that are a pinhole if all their terms of distortion are 0.
const MODELS: [&str; 7] = [
    "OPENCV",
    "PINHOLE",
    "SIMPLE_PINHOLE",
    "SIMPLE_RADIAL",
    "RADIAL",
    "FULL_OPENCV",
    "PERSPECTIVE",
];

/// The step that makes pictures of a pinhole.
const UNDISTORT: &str = "only pinholes are drawn: undistort the pictures first, with COLMAP's \
     image_undistorter or OpenCV's undistort, and use the cameras that result";

impl Numbers {
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
            k5: self.k5.or(shared.k5),
            k6: self.k6.or(shared.k6),
            p1: self.p1.or(shared.p1),
            p2: self.p2.or(shared.p2),
            distortion_params: self.distortion_params.or_else(|| shared.distortion_params.clone()),
            is_fisheye: self.is_fisheye || shared.is_fisheye,
            fl_x,
            fl_y,
            cx: self.cx.or(shared.cx),
            cy: self.cy.or(shared.cy),
            pixel_center: self.pixel_center.or(shared.pixel_center),
            w: self.w.or(shared.w),
            h: self.h.or(shared.h),
            camera_angle_x,
            camera_angle_y,
        }
    }

    /// Returns an error for a lens other than that of a pinhole camera.
    fn check_lens(&self) -> Result<(), String> {
        // The default of nerfstudio is OPENCV.
        let model = self.camera_model.as_deref().unwrap_or("OPENCV");
        if self.is_fisheye || !MODELS.contains(&model) {
            let model = if self.is_fisheye { "fisheye" } else { model };
            return Err(format!("cameras of the model {model} are not supported; {UNDISTORT}"));
        }
        let Self { k1, k2, k3, k4, k5, k6, p1, p2, .. } = *self;
        let terms = [
            ("k1", k1),
            ("k2", k2),
            ("k3", k3),
            ("k4", k4),
            ("k5", k5),
            ("k6", k6),
            ("p1", p1),
            ("p2", p2),
        ];
        let listed = self.distortion_params.iter().flatten();
        let listed = listed.map(|term| ("distortion_params", Some(*term)));
        let mut all = terms.into_iter().chain(listed);
        match all.find(|(_, term)| term.is_some_and(|term| term != 0.0)) {
            Some((name, term)) => {
                let term = term.unwrap_or_default();
                Err(format!("the lens distorts ({name} is {term}), and {UNDISTORT}"))
            }
            None => Ok(()),
        }
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

    /// Returns the principal point from the upper left corner of a picture.
    fn principal_point(&self, sides: DVec2) -> Result<DVec2, String> {
        // The corner of the first pixel is half a pixel before its centre.
        let corner = 0.5 - self.pixel_center.unwrap_or(0.5);
        if !(-0.5..=0.5).contains(&corner) {
            return Err("pixel_center is from 0 to 1, and 0.5 by default".to_owned());
        }
        let [x, y] = [self.cx, self.cy].map(|centre| centre.map(|centre| centre + corner));
        Ok(DVec2::new(x.unwrap_or(sides.x / 2.0), y.unwrap_or(sides.y / 2.0)))
    }

    /// Returns the lens of a perspective camera; `otherwise`, if the file states no angle.
    fn lens(&self, size: Option<Size>, otherwise: PoseLens) -> Result<PoseLens, String> {
        let Self { fl_x, fl_y, cx, cy, camera_angle_x, camera_angle_y, .. } = *self;
        let tangent = |angle: Option<f64>| angle.map(|angle| libm::tan(angle / 2.0));
        let [across, up] = [camera_angle_x, camera_angle_y].map(tangent);
        if [across, up].into_iter().flatten().any(|tangent| tangent <= 0.0) {
            return Err(NOT_POSITIVE.to_owned());
        }
        let Some(size) = size else {
            return match (fl_x.or(fl_y), cx.or(cy), across.or(up)) {
                (Some(_), _, _) => {
                    Err("fl_x and fl_y are in pixels: w and h are needed".to_owned())
                }
                (None, Some(_), _) => Err("cx and cy are in pixels: w and h are needed".to_owned()),
                (None, None, Some(_)) => Ok(PoseLens::Angles([across, up])),
                (None, None, None) => Ok(otherwise),
            };
        };
        let sides = sides(size);
        let principal_point = self.principal_point(sides)?;
        // Pixels are square if one focal length, or one angle, states the lens.
        let focal = match [fl_x, fl_y] {
            [None, None] => [across.map(|x| sides.x / 2.0 / x), up.map(|y| sides.y / 2.0 / y)],
            lengths => lengths,
        };
        let focal = match focal {
            [None, None] if principal_point == sides / 2.0 => return Ok(otherwise),
            [None, None] => {
                let reason = "cx and cy need a focal length: fl_x and fl_y, or camera_angle_x";
                return Err(reason.to_owned());
            }
            [Some(both), None] | [None, Some(both)] => DVec2::splat(both),
            [Some(x), Some(y)] => DVec2::new(x, y),
        };
        calibrated(Projection::Perspective, Intrinsics { focal, principal_point, size })
    }

    /// Returns the lens of an orthographic camera.
    fn parallel(&self, frame: &Frame, size: Option<Size>) -> Result<PoseLens, String> {
        match (frame.pixels_per_unit, size) {
            (Some(y), Some(size)) => {
                let focal = DVec2::new(y / frame.pixel_aspect.unwrap_or(1.0), y);
                let principal_point = self.principal_point(sides(size))?;
                calibrated(Projection::Orthographic, Intrinsics { focal, principal_point, size })
            }
            _ => Err("orthographic cameras need w, h and pixels_per_unit".to_owned()),
        }
    }
}

/// The error of a lens without an extent.
const NOT_POSITIVE: &str = "focal lengths, angles of view and pixels_per_unit are above 0";

/// Returns a lens with these intrinsics, if there is one.
fn calibrated(projection: Projection, intrinsics: Intrinsics) -> Result<PoseLens, String> {
    if intrinsics.focal.min_element() <= 0.0 {
        return Err(NOT_POSITIVE.to_owned());
    }
    if !Lens::default().with_intrinsics(projection, &intrinsics).is_valid() {
        let Intrinsics { focal, principal_point: at, .. } = intrinsics;
        return Err(format!(
            "no lens has the focal lengths {} and {} and the principal point ({}, {})",
            focal.x, focal.y, at.x, at.y
        ));
    }
    Ok(PoseLens::Calibrated(projection, intrinsics))
}

#[expect(clippy::cast_precision_loss, reason = "at most 16,384 pixels")]
fn sides(size: Size) -> DVec2 {
    DVec2::new(size.width as f64, size.height as f64)
}

/// Reads the cameras of a file. Fails with the reason, and the number of the frame.
pub(super) fn from_json(json: &[u8]) -> Result<Vec<CameraView>, String> {
    let Transforms { shared, frames } =
        serde_json::from_slice(json).map_err(|error| error.to_string())?;
    if !(1..=MOST_VIEWS).contains(&frames.len()) {
        return Err(format!("it has {} frames; 1 to {MOST_VIEWS} are possible", frames.len()));
    }
    let view = |(i, frame): (usize, Frame)| {
        let named = |reason: String| format!("frame {i}: {reason}");
        let numbers = frame.own.clone().or(&shared);
        numbers.check_lens().map_err(named)?;
        let size = numbers.size().map_err(named)?;
        let lens = match frame.projection.as_deref() {
            None => numbers.lens(size, PoseLens::Selected),
            Some("perspective") => numbers.lens(size, PoseLens::Perspective),
            Some("orthographic") => numbers.parallel(&frame, size),
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
    use glam::DVec3;

    use super::*;

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
            let half_angle = half_angle(view.aim);
            assert!((half_angle - 26.565_051_177_077_99).abs() < 1e-9, "{half_angle}");
        }
        let Aim::Pose(pose, _) = views[0].aim else { panic!() };
        assert_eq!((pose.eye, pose.axes.z_axis), (DVec3::new(5.0, 6.0, 7.0), DVec3::X));
        let angle = br#"{"camera_angle_x": 1.5707963267948966,
            "frames": [{"transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4]]}]}"#;
        let upright = from_json(angle).unwrap()[0].aim.at(Size::new(30, 40));
        assert!((half_angle(upright) - 45.0).abs() < 1e-9);
    }

    /// Returns the intrinsics of an aim.
    fn intrinsics(aim: Aim) -> Intrinsics {
        let Aim::Pose(_, PoseLens::Calibrated(_, intrinsics)) = aim else { panic!("{aim:?}") };
        intrinsics
    }

    /// Returns the half-angle of an aim in perspective.
    fn half_angle(aim: Aim) -> f64 {
        Lens::default().with_intrinsics(Projection::Perspective, &intrinsics(aim)).half_angle
    }

    #[test]
    fn calibrated_cameras_keep_both_focal_lengths_and_the_principal_point() {
        let file = |shared: &str, own: &str| {
            let json = format!(
                r#"{{{shared} "frames": [{{{own}
                    "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4]]}}]}}"#
            );
            intrinsics(from_json(json.as_bytes()).unwrap()[0].aim.at(Size::new(640, 480)))
        };
        // The camera of LineMOD, which counts from the centre of the first pixel.
        let all = r#""fl_x": 572.4, "fl_y": 573.6, "cx": 325.3, "cy": 242.0, "w": 640, "h": 480,"#;
        let size = Size::new(640, 480);
        let focal = DVec2::new(572.4, 573.6);
        let principal_point = DVec2::new(325.3, 242.0);
        assert_eq!(file(all, ""), Intrinsics { focal, principal_point, size });
        assert_eq!(file("", all), Intrinsics { focal, principal_point, size });
        let opencv = file(&format!(r#"{all} "pixel_center": 0,"#), "");
        assert_eq!(opencv.principal_point, DVec2::new(325.8, 242.5));
        assert_eq!(file(all, r#""cx": 319.1,"#).principal_point, DVec2::new(319.1, 242.0));
        let angles = r#""camera_angle_x": 1.0, "camera_angle_y": 0.9,"#;
        let expected = DVec2::new(320.0 / libm::tan(0.5), 240.0 / libm::tan(0.45));
        for shared in [r#""w": 640, "h": 480,"#, ""] {
            assert!(file(shared, angles).focal.distance(expected) < 1e-9, "{shared}");
        }
    }

    #[test]
    fn the_lens_of_a_file_is_vertical_too_and_that_of_a_frame_comes_first() {
        let lens = |shared: &str, own: &str| {
            let json = format!(
                r#"{{{shared} "frames": [{{{own}
                    "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4]]}}]}}"#
            );
            half_angle(from_json(json.as_bytes()).unwrap()[0].aim.at(Size::new(40, 30)))
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
            (r#""fl_x": 100,"#, whole, "w and h are needed"),
            (r#""fl_y": 100,"#, whole, "w and h are needed"),
            (r#""camera_angle_x": 1, "cx": 10,"#, whole, "cx and cy are in pixels"),
            (r#""cx": 10, "w": 64, "h": 64,"#, whole, "need a focal length"),
            (r#""fl_x": 9, "cx": 1e9, "w": 64, "h": 64,"#, whole, "the principal point (1000000"),
            (r#""fl_x": 1, "fl_y": 1e9, "w": 64, "h": 64,"#, whole, "no lens has the focal"),
            (r#""fl_x": -9, "w": 64, "h": 64,"#, whole, "are above 0"),
            (r#""fl_x": 9, "fl_y": 0, "w": 64, "h": 64,"#, whole, "are above 0"),
            (r#""camera_angle_x": 0,"#, whole, "are above 0"),
            (r#""fl_x": 9, "pixel_center": 2, "w": 64, "h": 64,"#, whole, "pixel_center is from"),
            (r#""w": 0.5, "h": 64,"#, whole, "whole numbers"),
            (r#""k1": 0.1, "p2": 0,"#, whole, "distorts (k1 is 0.1), and only pinholes are drawn"),
            (r#""p1": -0.01,"#, whole, "undistort the pictures first"),
            (r#""distortion_params": [0, -0.2],"#, whole, "(distortion_params is -0.2)"),
            (r#""camera_model": "OPENCV_FISHEYE","#, whole, "model OPENCV_FISHEYE"),
            (r#""is_fisheye": true,"#, whole, "model fisheye"),
        ] {
            let error = frame(lens, matrix);
            assert!(error.starts_with("frame 0: ") && error.contains(reason), "{error}");
        }
        assert!(from_json(br#"{"frames": []}"#).unwrap_err().starts_with("it has 0 frames"));
        let plain = format!(
            r#"{{"camera_model": "OPENCV", "k1": 0, "distortion_params": [0, 0],
               "frames": [{{"transform_matrix": {whole}}}]}}"#
        );
        assert!(from_json(plain.as_bytes()).is_ok());
    }
}
