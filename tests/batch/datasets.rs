//! Data sets for training: their poses, tables and masks.

#![expect(clippy::cast_possible_truncation, reason = "small pictures")]

use super::layers::{json, samples};
use super::*;

/// A box of 0.4 x 0.2 x 0.1 metres.
const BOX: &str = "v -.2 -.1 -.05\nv .2 -.1 -.05\nv .2 .1 -.05\nv -.2 .1 -.05\n\
                   v -.2 -.1 .05\nv .2 -.1 .05\nv .2 .1 .05\nv -.2 .1 .05\n\
                   f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

#[test]
fn the_poses_of_bop_project_the_model_onto_its_mask() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("box.obj"), BOX).unwrap();
    std::fs::write(at("crate.obj"), BOX).unwrap();
    let options = ["--views", "fibonacci:6:3", "--size", "96x64", "--samples", "1"];
    // Poses lead from the file, whatever its up axis.
    for up in ["y", "z", "-x"] {
        let out = format!("bop{up}");
        let bop = ["batch", "box.obj", "crate.obj", "--up", up, "--dataset", "bop", "--out", &out];
        ends_with(0, folder.path(), &[&bop[..], &options].concat());
        let models = serde_json::json!({"1": "box.obj", "2": "crate.obj"});
        assert_eq!(json(&at(&out).join("models.json")), models);
        fits_its_poses(&at(&out).join("000000"));
        has_the_box(&at(&out).join("models"));
    }
}

/// Checks that the models are the box, in millimetres and with the axes of its file.
#[track_caller]
fn has_the_box(models: &Path) {
    let infos = json(&models.join("models_info.json"));
    let diameter = 2.0 * f64::sqrt(200.0 * 200.0 + 100.0 * 100.0 + 50.0 * 50.0);
    for id in ["1", "2"] {
        let info = &infos[id];
        let near = |name: &str, want: f64| (info[name].as_f64().unwrap() - want).abs() < 1e-4;
        for (axis, half) in [("x", 200.0), ("y", 100.0), ("z", 50.0)] {
            assert!(near(&format!("min_{axis}"), -half), "{info}");
            assert!(near(&format!("size_{axis}"), 2.0 * half), "{info}");
        }
        assert!(near("diameter", diameter), "{info}");
        let ply = std::fs::read(models.join(format!("obj_00000{id}.ply"))).unwrap();
        let end = ply.windows(11).position(|it| it == b"end_header\n").unwrap() + 11;
        let head = std::str::from_utf8(&ply[..end]).unwrap();
        assert!(
            head.contains("element vertex 8\n") && head.contains("element face 12\n"),
            "{head}"
        );
        let (points, faces) = ply[end..].split_at(8 * 12);
        for point in points.chunks(12) {
            let place = [0, 4, 8].map(|i| f32::from_le_bytes(point[i..i + 4].try_into().unwrap()));
            let halves = place.map(|x| x.abs().round() as i32);
            assert_eq!(halves, [200, 100, 50]);
        }
        assert_eq!(faces.len(), 12 * 13);
        assert!(faces.chunks(13).all(|face| face[0] == 3 && face[1] < 8));
    }
}

/// Checks that the poses of BOP project the box onto its masks and depths.
#[track_caller]
fn fits_its_poses(scene: &Path) {
    let tables = ["scene_camera", "scene_gt", "scene_gt_info"];
    let [cameras, poses, infos] = tables.map(|name| json(&scene.join(format!("{name}.json"))));
    let numbers = |json: &serde_json::Value| -> Vec<f64> {
        json.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
    };
    for view in 0..6 {
        let (camera, pose, info) =
            (&cameras[view.to_string()], &poses[view.to_string()][0], &infos[view.to_string()][0]);
        let [k, r, t] = [&camera["cam_K"], &pose["cam_R_m2c"], &pose["cam_t_m2c"]].map(numbers);
        let (mut low, mut high) = ([f64::MAX; 3], [f64::MIN; 3]);
        for corner in 0..8 {
            let sign = |bit: u32, half: f64| if corner >> bit & 1 == 1 { half } else { -half };
            let p = [sign(0, 200.0), sign(1, 100.0), sign(2, 50.0)];
            let row = |i: usize| (0..3).map(|j| r[3 * i + j] * p[j]).sum::<f64>() + t[i];
            let [x, y, z] = [row(0), row(1), row(2)];
            let seen = [k[0] * x / z + k[2], k[4] * y / z + k[5], z];
            for axis in 0..3 {
                low[axis] = low[axis].min(seen[axis]);
                high[axis] = high[axis].max(seen[axis]);
            }
        }
        // Pixel centres are whole numbers, and boxes end there: about half a pixel inside on each
        // side.
        let bounds = numbers(&info["bbox_visib"]);
        let expected = [low[0], low[1], high[0] - low[0] - 1.0, high[1] - low[1] - 1.0];
        for (found, expected) in bounds.iter().zip(expected) {
            assert!((found - expected).abs() < 1.6, "{view}: {bounds:?} {expected:?}");
        }
        assert_eq!(info["bbox_obj"], info["bbox_visib"]);
        let name = |kind: &str, object: &str| scene.join(format!("{kind}/{view:06}{object}.png"));
        let mask = samples(&name("mask_visib", "_000000")).into_luma8();
        let count = mask.pixels().filter(|pixel| pixel[0] == 255).count();
        assert_eq!(info["px_count_visib"], count);
        let depth = samples(&name("depth", "")).into_luma16();
        let scale = camera["depth_scale"].as_f64().unwrap();
        for (depth, mask) in depth.pixels().zip(mask.pixels()) {
            let millimetres = f64::from(depth[0]) * scale;
            assert_eq!(depth[0] > 0, mask[0] > 0);
            let is_right = (low[2] - 1.0..=high[2] + 1.0).contains(&millimetres);
            assert!(depth[0] == 0 || is_right, "{view}: {millimetres} {low:?} {high:?}");
        }
    }
}

/// Cameras that look along -z from a distance of 6, with a lens and a size.
fn cameras(lens: &str) -> String {
    let matrix = "[[1,0,0,0],[0,1,0,0],[0,0,1,6],[0,0,0,1]]";
    format!(r#"{{{lens}, "frames": [{{"file_path": "a.png", "transform_matrix": {matrix}}}]}}"#)
}

#[test]
fn bop_counts_the_part_of_an_object_beyond_the_border() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let crate_of_1 = BOX.replace(".2", ".5").replace(".1", ".5").replace(".05", ".5");
    std::fs::write(at("box.obj"), crate_of_1).unwrap();
    let view = |name: &str, lens: &str| std::fs::write(at(name), cameras(lens)).unwrap();
    view("cams.json", r#""w": 320, "h": 240, "fl_x": 300, "cx": 160, "cy": 120"#);
    // The canvas of 3 x 3 pictures, in one picture.
    view("wide.json", r#""w": 960, "h": 720, "fl_x": 300, "cx": 480, "cy": 360"#);
    let infos = |x: f64, y: f64, z: f64, views: &str| {
        let scene = format!(
            r#"(version: 1, objects: [(id: 1, name: "cut", model: File(path: "box.obj"), placement:
            ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), ({x}, {y}, {z}, 1.0))
            )], cameras: [(id: 2, name: "camera 1", eye: (0.0, 0.0, 6.0))],
            lights: [(id: 3, name: "ambient", slot: 0, kind: Ambient)],
            view: (object: Some(1), camera: 2))"#
        );
        std::fs::write(at("cut.marraztu"), scene).unwrap();
        let bop = ["batch", "cut.marraztu", "--views", views, "--dataset", "bop", "--out", "b"];
        ends_with(0, folder.path(), &[&bop[..], &["--samples", "1"]].concat());
        let info = json(&at("b/000000/scene_gt_info.json"))["0"][0].clone();
        std::fs::remove_dir_all(at("b")).unwrap();
        info
    };
    // The case of bop_toolkit: half of the box is outside on the right.
    let half = infos(3.2, 0.0, 0.0, "cams.json");
    assert_eq!((&half["px_count_all"], &half["px_count_visib"]), (&4078.into(), &1810.into()));
    assert_eq!(half["bbox_obj"], serde_json::json!([285, 93, 76, 53]));
    assert_eq!((&half["px_count_valid"], &half["bbox_visib"][2]), (&1810.into(), &34.into()));
    assert!((half["visib_fract"].as_f64().unwrap() - 1810.0 / 4078.0).abs() < 1e-12);
    // On all sides, in a corner, around the picture, through the near plane, and wholly outside.
    for (x, y, z) in [
        (-3.1, 0.2, 0.3),
        (0.1, 2.4, 0.0),
        (0.0, -2.3, 0.2),
        (2.9, -2.2, 0.1),
        (0.1, 0.1, 5.2),
        (0.3, 0.9, 5.4),
        (0.4, 0.2, 5.8),
        (5.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
    ] {
        let [own, wide] = ["cams.json", "wide.json"].map(|views| infos(x, y, z, views));
        let name = format!("{x} {y} {z}: {own} {wide}");
        assert_eq!(own["px_count_all"], wide["px_count_visib"], "{name}");
        if own["px_count_visib"] == 0 {
            let none = serde_json::json!([-1, -1, -1, -1]);
            assert_eq!((&own["bbox_obj"], &own["visib_fract"]), (&none, &0.0.into()), "{name}");
            continue;
        }
        let side = |i: usize, offset: i64| wide["bbox_visib"][i].as_i64().unwrap() - offset;
        let expected = [side(0, 320), side(1, 240), side(2, 0), side(3, 0)];
        assert_eq!(own["bbox_obj"], serde_json::json!(expected), "{name}");
    }
}

#[test]
fn data_sets_have_the_calibration_of_their_cameras() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("box.obj"), BOX).unwrap();
    let lens = r#""w": 640, "h": 480, "fl_x": 572.4, "fl_y": 573.6, "cx": 319.1, "cy": 242"#;
    std::fs::write(at("cameras.json"), cameras(lens)).unwrap();
    let draw = |dataset: &str, views: &str| {
        let base = ["batch", "box.obj", "--views", views, "--samples", "1"];
        ends_with(
            0,
            folder.path(),
            &[&base[..], &["--dataset", dataset, "--out", dataset]].concat(),
        );
    };
    let near = |value: &serde_json::Value, expected: f64| {
        assert!((value.as_f64().unwrap() - expected).abs() < 1e-9, "{value} {expected}");
    };
    draw("bop", "cameras.json");
    let k = json(&at("bop/000000/scene_camera.json"))["0"]["cam_K"].clone();
    for (i, expected) in [572.4, 0.0, 318.6, 0.0, 573.6, 241.5, 0.0, 0.0, 1.0].iter().enumerate() {
        near(&k[i], *expected);
    }
    // What is written is read again, and draws the same bytes.
    draw("nerf", "cameras.json");
    let frame = json(&at("nerf/box/transforms.json"))["frames"][0].clone();
    for (name, expected) in [("fl_x", 572.4), ("fl_y", 573.6), ("cx", 319.1), ("cy", 242.0)] {
        near(&frame[name], expected);
    }
    let pixels = || samples(&at("nerf/box/color/00000.png"));
    let first = pixels();
    std::fs::copy(at("nerf/box/transforms.json"), at("again.json")).unwrap();
    std::fs::remove_dir_all(at("nerf")).unwrap();
    draw("nerf", "again.json");
    assert!(pixels() == first);
}

/// Returns the colour at the middle of each side of a cube from -1 to 1, in each picture of a NeRF
/// data set that sees it.
fn colors_of_sides(folder: &Path) -> Vec<Vec<[u8; 3]>> {
    let numbers = |json: &serde_json::Value| -> Vec<f64> {
        json.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
    };
    let mut sides = vec![Vec::new(); 6];
    for frame in json(&folder.join("transforms.json"))["frames"].as_array().unwrap() {
        let picture = samples(&folder.join(frame["file_path"].as_str().unwrap())).into_rgb8();
        let w2c: Vec<Vec<f64>> =
            frame["opencv"]["w2c"].as_array().unwrap().iter().map(numbers).collect();
        for (i, side) in sides.iter_mut().enumerate() {
            let mut middle = [0.0, 0.0, 0.0, 1.0];
            middle[i / 2] = if i % 2 == 0 { 1.0 } else { -1.0 };
            let at = |row: usize| (0..4).map(|j| w2c[row][j] * middle[j]).sum::<f64>();
            let [x, y, z] = [at(0), at(1), at(2)];
            // The normal equals the position of the middle.
            let turn = |row: usize| (0..3).map(|j| w2c[row][j] * middle[j]).sum::<f64>();
            let facing = -(turn(0) * x + turn(1) * y + turn(2) * z) / x.hypot(y).hypot(z);
            if facing > 0.2 {
                let pixel = |name: &str, centre: &str, aside: f64| {
                    let [focal, centre] = [name, centre].map(|name| frame[name].as_f64().unwrap());
                    (focal * aside / z + centre) as u32
                };
                side.push(picture.get_pixel(pixel("fl_x", "cx", x), pixel("fl_y", "cy", y)).0);
            }
        }
    }
    sides
}

#[test]
fn a_matte_side_has_one_colour_in_all_views_of_a_data_set() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let cube = BOX.replace(".2", "1").replace(".1", "1").replace(".05", "1");
    std::fs::write(at("cube.obj"), format!("mtllib cube.mtl\nusemtl matte\n{cube}")).unwrap();
    let matte = "newmtl matte\nKa 0.1 0.1 0.1\nKd 0.8 0.8 0.8\nKs 0 0 0\nillum 1\n";
    std::fs::write(at("cube.mtl"), matte).unwrap();
    // A scene with a lamp on its camera.
    let scene = r#"(version: 1, objects: [(id: 1, name: "cube", model: File(path: "cube.obj"))],
        cameras: [(id: 2, name: "camera 1", eye: (0.0, 0.0, 9.0))],
        lights: [(id: 3, name: "ambient", slot: 0, kind: Ambient, color: (40, 40, 40)),
            (id: 4, name: "lamp", slot: 1, kind: Spot(owner: SelectedCamera, half_aperture: 60.0,
                exponent: 0.0), attenuation: (constant: 1.0, linear: 0.0, quadratic: 0.0))],
        view: (object: Some(1), camera: 2))"#;
    std::fs::write(at("lamp.marraztu"), scene).unwrap();
    // The largest range of a side's colours over all views.
    let range = |model: &str, more: &[&str]| {
        let base = ["batch", model, "--views", "fibonacci:12:5", "--size", "96"];
        let dataset = ["--samples", "1", "--dataset", "nerf", "--out", "nerf"];
        let (_, notes) = ends_with(0, folder.path(), &[&base[..], &dataset, more].concat());
        let stem = Path::new(model).file_stem().unwrap();
        let sides = colors_of_sides(&at("nerf").join(stem));
        std::fs::remove_dir_all(at("nerf")).unwrap();
        assert!(sides.iter().all(|side| side.len() >= 2), "{sides:?}");
        let ranges = sides.iter().map(|side| {
            let greens = side.iter().map(|color| color[1]);
            greens.clone().max().unwrap() - greens.min().unwrap()
        });
        (ranges.max().unwrap(), notes)
    };
    for model in ["cube.obj", "lamp.marraztu"] {
        let (fixed, notes) = range(model, &[]);
        // The light of a lamp differs a little between the pixels of a side.
        assert!(fixed <= 5, "{model}: {fixed}");
        assert!(notes.contains("the lights are the same in all views"), "{notes}");
        let (following, notes) = range(model, &["--lights-follow-camera"]);
        assert!(following > 20, "{model}: {following}");
        assert!(!notes.contains("the lights are"), "{notes}");
        // The exposure stays, too.
        assert!(range(model, &["--exposure", "fit"]).0 <= 5, "{model}");
    }
}

#[test]
fn the_segments_of_coco_are_those_of_the_pixels() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let coco = ["batch", "models/wheel.obj", "models/cam.obj", "--views", "2", "--dataset", "coco"];
    ends_with(0, folder.path(), &[&coco[..], &["--out", "coco"], &SMALL].concat());
    let [panoptic, instances] =
        ["panoptic", "instances"].map(|name| json(&at(&format!("coco/annotations/{name}.json"))));
    assert_eq!(panoptic["images"].as_array().unwrap().len(), 4);
    let names: Vec<&str> = panoptic["categories"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["cam.obj", "wheel.obj"]);
    for (annotation, instance) in panoptic["annotations"]
        .as_array()
        .unwrap()
        .iter()
        .zip(instances["annotations"].as_array().unwrap())
    {
        let file = annotation["file_name"].as_str().unwrap();
        assert!(at(&format!("coco/images/{file}")).exists());
        let ids = samples(&at(&format!("coco/panoptic/{file}"))).into_rgb8();
        let area = ids.pixels().filter(|pixel| pixel.0 == [1, 0, 0]).count();
        let segment = &annotation["segments_info"][0];
        assert_eq!((&segment["id"], &segment["area"]), (&1.into(), &area.into()));
        assert_eq!(instance["area"], area);
        assert_eq!(instance["category_id"], segment["category_id"]);
        let runs = instance["segmentation"]["counts"].as_array().unwrap();
        let runs: Vec<usize> = runs.iter().map(|run| run.as_u64().unwrap() as usize).collect();
        assert_eq!(runs.iter().sum::<usize>(), 64 * 64);
        assert_eq!(runs.iter().skip(1).step_by(2).sum::<usize>(), area);
        // Runs go down the columns.
        let mut at = 0;
        for (run, length) in runs.iter().enumerate() {
            for i in at..at + length {
                let pixel = ids.get_pixel((i / 64) as u32, (i % 64) as u32);
                assert_eq!(pixel[0] == 1, run % 2 == 1);
            }
            at += length;
        }
    }
    // Each model has its data set.
    let nerf = ["batch", "models/wheel.obj", "--views", "3", "--dataset", "nerf", "--out", "nerf"];
    ends_with(0, folder.path(), &[&nerf[..], &["--depth-scale", "10"], &SMALL].concat());
    let cameras = json(&at("nerf/wheel/transforms.json"));
    let frames = cameras["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 3);
    for name in ["file_path", "depth_file_path", "mask_path"] {
        let path = frames[2][name].as_str().unwrap();
        assert!(at("nerf/wheel").join(path).exists(), "{path}");
    }
}

/// The reader of 3D Gaussian Splatting joins the folder, `file_path` and ".png", and takes one
/// `camera_angle_x` for all frames.
#[test]
fn a_split_names_each_picture_once_in_the_layout_of_nerfs_synthetic_scenes() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let draw = ["batch", "models/wheel.obj", "--views", "fibonacci:10", "--out", "set"];
    let split = ["--dataset", "nerf", "--split", "8,1,1", "--depth-scale", "10"];
    ends_with(0, folder.path(), &[&draw[..], &split, &SMALL].concat());
    let all = json(&at("set/wheel/transforms.json"));
    let all = all["frames"].as_array().unwrap();
    let mut seen = Vec::new();
    for (part, count) in [("train", 8), ("val", 1), ("test", 1)] {
        let file = json(&at(&format!("set/wheel/transforms_{part}.json")));
        let frames = file["frames"].as_array().unwrap();
        assert_eq!(frames.len(), count, "{part}");
        for frame in frames {
            let path = format!("{}.png", frame["file_path"].as_str().unwrap());
            assert!(at("set/wheel").join(&path).is_file(), "{path}");
            let own = all.iter().find(|own| own["file_path"] == path.as_str()).unwrap();
            assert_eq!(own["transform_matrix"], frame["transform_matrix"]);
            assert_eq!(own["camera_angle_x"], file["camera_angle_x"]);
            seen.push(path);
        }
    }
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), 10);
    // A killed run is resumed, with the same files.
    let names = ["transforms.json", "transforms_train.json", "transforms_test.json"];
    let before = names.map(|name| std::fs::read(at("set/wheel").join(name)).unwrap());
    for lost in ["color/00003.png", "transforms.json", "transforms_train.json"] {
        std::fs::remove_file(at("set/wheel").join(lost)).unwrap();
    }
    let again = [&draw[..], &split, &["--resume"], &SMALL].concat();
    let (_, err) = ends_with(0, folder.path(), &again);
    assert!(err.contains("1 drawn, 9 unchanged"), "{err}");
    assert!(before == names.map(|name| std::fs::read(at("set/wheel").join(name)).unwrap()));
    // A file of another program is never replaced.
    std::fs::write(at("set/wheel/transforms_val.json"), "mine").unwrap();
    ends_with(1, folder.path(), &again);
    let bop = ["--dataset", "bop", "--split", "8,1,1"];
    ends_with(2, folder.path(), &[&draw[..], &bop, &SMALL].concat());
}

/// The properties and their order are those that the reader of 3D Gaussian Splatting expects.
#[test]
fn seed_points_lie_on_the_surfaces_in_proportion_to_their_area() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("box.obj"), format!("mtllib box.mtl\nusemtl red\n{BOX}")).unwrap();
    std::fs::write(at("box.mtl"), "newmtl red\nKd 1 0.5 0\n").unwrap();
    let draw = ["batch", "box.obj", "--views", "2", "--dataset", "nerf", "--out", "set"];
    let draw = [&draw[..], &SMALL, &["--seed-points", "7000"]].concat();
    ends_with(0, folder.path(), &draw);
    assert_eq!(json(&at("set/box/transforms.json"))["ply_file_path"], "points3d.ply");
    let path = at("set/box/points3d.ply");
    let ply = std::fs::read(&path).unwrap();
    let end = ply.windows(11).position(|it| it == b"end_header\n").unwrap() + 11;
    let head = std::str::from_utf8(&ply[..end]).unwrap();
    let names = head.lines().filter_map(|line| line.strip_prefix("property "));
    let names: Vec<&str> = names.filter_map(|line| line.split(' ').nth(1)).collect();
    assert_eq!(names, ["x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"]);
    assert!(head.contains("element vertex 7000\n"), "{head}");
    let points = ply[end..].as_chunks::<27>();
    assert_eq!((points.0.len(), points.1.len()), (7000, 0));
    let mut counts = [0; 3];
    for point in points.0 {
        let number = |i: usize| f32::from_le_bytes(point[4 * i..4 * i + 4].try_into().unwrap());
        let axis = (0..3).find(|axis| number(3 + axis).abs() == 1.0).unwrap();
        let halves = [0.2, 0.1, 0.05_f32];
        assert!((number(axis) - number(3 + axis) * halves[axis]).abs() < 1e-6);
        assert!((0..3).all(|i| number(i).abs() <= halves[i] + 1e-6));
        assert_eq!(point[24..], [255, 128, 0]);
        counts[axis] += 1;
    }
    // Faces of 0.2 x 0.1, 0.4 x 0.1 and 0.4 x 0.2.
    for (count, want) in counts.into_iter().zip([1000, 2000, 4000_i32]) {
        assert!((count - want).abs() <= 2, "{counts:?}");
    }
    // A lost file is written again, and one of another program never replaced.
    let again = [&draw[..], &["--resume"]].concat();
    std::fs::remove_file(&path).unwrap();
    ends_with(0, folder.path(), &again);
    assert!(std::fs::read(&path).unwrap() == ply);
    std::fs::write(&path, "mine").unwrap();
    let (_, err) = ends_with(1, folder.path(), &draw);
    assert!(err.contains("is of another program"), "{err}");
    assert_eq!(std::fs::read(&path).unwrap(), b"mine");
    ends_with(2, folder.path(), &["batch", "box.obj", "--out", "x.png", "--seed-points", "9"]);
}

/// Parts draw pictures and masks, and a last run writes the tables.
#[test]
fn a_data_set_drawn_in_parts_equals_one_drawn_at_once() {
    let folder = folder();
    for kind in ["nerf", "bop", "coco"] {
        let draw = |out: &str, more: &[&str]| {
            let models = ["batch", "models/wheel.obj", "models/cam.obj", "--views", "3"];
            let dataset = ["--dataset", kind, "--depth-scale", "10", "--out", out];
            let dataset = if kind == "coco" {
                [&dataset[..2], &dataset[4..]].concat()
            } else {
                dataset.to_vec()
            };
            ends_with(0, folder.path(), &[&models[..], &dataset, &SMALL, more].concat());
        };
        draw("whole", &[]);
        draw("parts", &["--shard", "1/2"]);
        draw("parts", &["--shard", "0/2"]);
        if kind != "nerf" {
            draw("parts", &["--resume"]);
        }
        let [whole, parts] = ["whole", "parts"].map(|name| contents(&folder.path().join(name)));
        assert!(whole.len() > 10, "{kind}");
        assert_eq!(whole.keys().collect::<Vec<_>>(), parts.keys().collect::<Vec<_>>(), "{kind}");
        for (name, content) in &whole {
            assert!(parts[name] == *content, "{kind}: {name:?}");
        }
        for name in ["whole", "parts"] {
            std::fs::remove_dir_all(folder.path().join(name)).unwrap();
        }
    }
}

#[test]
fn a_list_cannot_change_the_layers_and_the_folder_of_a_data_set() {
    let folder = folder();
    for (column, value) in [("out", "elsewhere"), ("layers", "color"), ("ids", "grey")] {
        let list = format!("file,{column}\nmodels/cam.obj,{value}\n");
        std::fs::write(folder.path().join("list.csv"), list).unwrap();
        let before = contents(folder.path());
        let arguments = ["batch", "--list", "list.csv", "--dataset", "coco", "--out", "set"];
        let (_, err) = ends_with(2, folder.path(), &arguments);
        assert!(err.contains(&format!("list.csv:2: column {column}: ")), "{err}");
        assert!(contents(folder.path()) == before);
    }
}
