//! The layers of a picture agree with picking, with the explanation of pixels, and with the
//! triangles of the scene.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on may panic")]

mod common;

use std::path::Path;

use common::{at, ball, cube, edit, model_of, scene};
use glam::{DMat3, DMat4, DVec2, DVec3};
use marraztu_core::accuracy::{Arithmetic, Samples, Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::base::math::rotation;
use marraztu_core::edit::items;
use marraztu_core::scene::{
    Command, Intrinsics, Item, ItemId, Lens, MaterialChoice, MeshSource, Model, NONE, Normals,
    ObjectId, Part, PresetId, Projection, Scene, Sides, SourceCorner, View, dvec3,
};
use marraztu_io::{self as io, Progress};
use marraztu_lab::pixel;
use marraztu_render::{
    AxesConvention, Layer, LayerSet, Layers, NormalSpace, PictureCamera, Renderer, plan_frame,
};

const SIZE: Size = Size::new(150, 110);

/// The scenes that are checked: perspective and orthographic, clipped by the near plane, with
/// holes, transparent, mirrored, stretched and far away.
fn shots() -> Vec<(String, Shot)> {
    let mut shots = Vec::new();
    for name in ["fence", "panes", "near", "far", "wheel", "dimples"] {
        let path = Path::new("assets/lessons").join(name).with_extension("marraztu");
        let opened = io::open(&path, &Progress::new()).unwrap();
        let view = View { marks: false, ..opened.view };
        shots.push((name.to_owned(), shot(&opened.scene, &view)));
    }
    let tilted = DMat4::from_mat3(rotation(DVec3::new(0.6, 0.0, 0.8), 0.7));
    let mirrored = DMat4::from_scale(DVec3::new(-60.0, 90.0, 40.0));
    let place = |x: f64, z: f64| DMat4::from_translation(DVec3::new(x, 0.0, z));
    let models = [
        (cube(), place(-90.0, 0.0) * tilted * mirrored),
        (ball(9), at(80.0, 60.0, 10.0, -20.0)),
        (cube(), place(0.0, 340.0) * tilted * DMat4::from_scale(DVec3::splat(45.0))),
        (cube(), at(900.0, 0.0, -1200.0, -300.0)),
    ];
    let (mut own, view) = scene(&models);
    edit(&mut own, ObjectId(12), |object| object.sides = Sides::Two);
    let view = View { marks: false, ..view };
    for projection in [Projection::Perspective, Projection::Orthographic] {
        for normals in [Normals::Vertex, Normals::Face] {
            let view = View { projection, normals, ..view.clone() };
            shots.push((format!("{projection:?} {normals:?}"), shot(&own, &view)));
        }
        let view = View { projection, ..view.clone() };
        let mut scene = own.clone();
        let mut camera = scene.selected_camera(&view).clone();
        camera.lens = Lens { shift: [0.21, -0.34], pixel_aspect: 1.3, ..camera.lens };
        let command = Command::Replace(Item::Camera(view.camera, Box::new(camera)));
        command.apply(&mut scene).unwrap();
        shots.push((format!("{projection:?} shifted"), shot(&scene, &view)));
    }
    shots
}

fn shot(scene: &Scene, view: &View) -> Shot {
    Shot::new(scene, view, &Settings::default(), SIZE)
}

fn all(shot: &Shot, normals: NormalSpace) -> Layers {
    Renderer::default().layers(shot, LayerSet::ALL, normals)
}

fn vectors(layers: &Layers, layer: Layer) -> Vec<DVec3> {
    layers.floats(layer).as_chunks().0.iter().map(|v| dvec3(*v)).collect()
}

/// Returns the centre of a pixel.
#[expect(clippy::cast_precision_loss, reason = "small pictures")]
fn centre(i: usize) -> DVec2 {
    DVec2::new((i % SIZE.width) as f64 + 0.5, (i / SIZE.width) as f64 + 0.5)
}

/// Returns the corners of a polygon in the world.
fn outline(shot: &Shot, object: ObjectId, polygon: u32) -> Vec<DVec3> {
    let object = shot.scene.objects.get(object).unwrap();
    let world_from_mesh = object.world_from_mesh(shot.view.time);
    let mesh = &object.model.mesh;
    let corners = mesh.polygon(polygon).iter();
    let place = |position: u32| dvec3(mesh.positions()[position as usize]);
    corners.map(|corner| world_from_mesh.transform_point3(place(corner.position))).collect()
}

/// Returns the distance of a point from a triangle: Ericson, "Real-Time Collision Detection",
/// section 5.1.5.
fn distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_edge = |a: DVec3, b: DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a + (b - a) * t)
    };
    let n = (b - a).cross(c - a);
    let inside = [(a, b), (b, c), (c, a)]
        .into_iter()
        .all(|(from, to)| (to - from).cross(p - from).dot(n) >= 0.0);
    if inside && n.length_squared() > 0.0 {
        return ((p - a).dot(n) / n.length()).abs();
    }
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}

#[test]
fn depths_lead_through_the_camera_to_the_polygon_that_the_ids_name() {
    let mut pixels = 0;
    for (name, shot) in shots() {
        let layers = all(&shot, NormalSpace::Camera);
        let camera = PictureCamera::of(&shot);
        let positions = vectors(&layers, Layer::Position);
        let normals = vectors(&layers, Layer::Normal);
        let eye = camera.world_from_camera(AxesConvention::OpenGl).w_axis.truncate();
        for (i, depth) in layers.floats(Layer::Depth).iter().enumerate() {
            let id = layers.ids(Layer::Object)[i];
            let distant = layers.floats(Layer::Distance)[i];
            assert_eq!(u8::from(id != 0), layers.mask()[i], "{name} {i}");
            if id == 0 {
                let floats = [positions[i], normals[i]];
                assert_eq!((*depth, distant), (f32::INFINITY, f32::INFINITY), "{name} {i}");
                assert_eq!((floats, layers.ids(Layer::Polygon)[i]), ([DVec3::ZERO; 2], 0));
                continue;
            }
            pixels += 1;
            // 1/256 pixel, and units in the last place of the f32.
            let depth = f64::from(*depth);
            let pixel = match camera.projection {
                Projection::Perspective => depth.abs() / camera.intrinsics.focal.min_element(),
                Projection::Orthographic => 1.0 / camera.intrinsics.focal.min_element(),
            };
            let point = camera.point(centre(i), depth);
            let reach = point.length().max(depth.abs());
            let bound = pixel / 256.0 + 3.0 * f64::from(f32::EPSILON) * reach;
            assert!(point.distance(positions[i]) <= bound, "{name} {i}: {point} {bound}");
            // The polygon of the ids, as a fan: those of these scenes are convex.
            let object = layers.names.objects[usize::try_from(id).unwrap() - 1].object;
            let polygon = u32::try_from(layers.ids(Layer::Polygon)[i]).unwrap() - 1;
            let corners = outline(&shot, object, polygon);
            let fan = corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]);
            let off = fan.map(|triangle| distance(point, triangle)).fold(f64::INFINITY, f64::min);
            assert!(off <= bound, "{name} {i}: {off} of {bound}");
            let from_eye = match camera.projection {
                Projection::Perspective => positions[i].distance(eye),
                Projection::Orthographic => depth,
            };
            assert!((f64::from(distant) - from_eye).abs() <= bound, "{name} {i}");
        }
    }
    assert!(pixels > 50_000, "{pixels}");
}

#[test]
fn ids_name_what_the_editor_picks_and_normals_are_those_that_light_uses() {
    let mut normals = 0;
    for (name, shot) in shots() {
        let exact = Settings { arithmetic: Arithmetic::F64, ..Settings::default() };
        let shot = shot.with(exact);
        let mut renderer = Renderer::default();
        renderer.render(&plan_frame(&shot));
        let layers = renderer.layers(&shot, LayerSet::ALL, NormalSpace::World);
        let camera = all(&shot, NormalSpace::Camera);
        let rotation =
            DMat3::from_mat4(PictureCamera::of(&shot).world_from_camera(AxesConvention::OpenGl));
        let (worlds, cameras) = (vectors(&layers, Layer::Normal), vectors(&camera, Layer::Normal));
        for i in 0..SIZE.area() {
            let [x, y] = [i % SIZE.width, i / SIZE.width];
            let picked = renderer.hit(x, y).and_then(|hit| Some((hit.item, hit.polygon?)));
            let id = usize::try_from(layers.ids(Layer::Object)[i]).unwrap();
            let polygon = u32::try_from(layers.ids(Layer::Polygon)[i]).unwrap();
            let shown = id
                .checked_sub(1)
                .map(|at| (ItemId::Object(layers.names.objects[at].object), polygon - 1));
            assert_eq!(shown, picked, "{name} {x},{y}");
            let Some((ItemId::Object(object), polygon)) = picked else { continue };
            // The polygon has this part, and the part this material.
            let object = shot.scene.objects.get(object).unwrap();
            let part = object.model.mesh.polygon_parts()[polygon as usize];
            let named = usize::try_from(layers.ids(Layer::Part)[i]).unwrap() - 1;
            let named = &layers.names.parts[named];
            assert_eq!(usize::try_from(named.object).unwrap(), id, "{name} {x},{y}");
            assert_eq!(named.name, object.model.mesh.parts()[part as usize].name);
            assert!((worlds[i].length() - 1.0).abs() < 1e-6, "{name} {x},{y}: {}", worlds[i]);
            assert!((rotation * cameras[i]).distance(worlds[i]) < 1e-6, "{name} {x},{y}");
            // Every seventh pixel is enough. Bump maps tilt the explained normal only.
            if i % 7 == 0 && name != "dimples" {
                let explained = renderer.explain(x, y).unwrap();
                let lines = pixel::lines(&shot.scene, &explained);
                let own = format!(" {}, triangle", layers.ids(Layer::Polygon)[i]);
                assert!(lines[2].contains(&own), "{name} {x},{y}: {lines:?}");
                let point = explained.surface.unwrap();
                let normal = worlds[i];
                assert!(normal.distance(point.normal) < 1e-6, "{name} {x},{y}: {normal} {point:?}");
                // Light is computed on the ray through the centre, at the depth of the triangle.
                let position = vectors_at(&layers, Layer::Position, i);
                let pixel = point.distance.max(1.0)
                    / PictureCamera::of(&shot).intrinsics.focal.min_element();
                let reach = pixel / 256.0 + f64::from(f32::EPSILON) * position.length();
                let off = position.distance(point.position);
                assert!(off <= reach, "{name} {x},{y}: {off} of {reach}");
                normals += 1;
            }
        }
    }
    assert!(normals > 8000, "{normals}");
}

fn vectors_at(layers: &Layers, layer: Layer, i: usize) -> DVec3 {
    dvec3(layers.floats(layer).as_chunks().0[i])
}

#[test]
fn layers_are_the_same_for_any_settings_and_number_of_threads_and_keep_the_last_picture() {
    for (name, shot) in shots() {
        let once = all(&shot, NormalSpace::Camera);
        let other = Settings {
            samples: Samples::Sixteen,
            resolution: marraztu_core::accuracy::Resolution::Half,
            transparency: marraztu_core::accuracy::Transparency::Threshold,
            ..Settings::default()
        };
        assert!(once == all(&shot.with(other), NormalSpace::Camera), "{name}: other settings");
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(once == pool.install(|| all(&shot, NormalSpace::Camera)), "{name}: {threads}");
        }
        // A layer does not depend on the other layers.
        for layer in Layer::ALL {
            let alone = Renderer::default().layers(
                &shot,
                LayerSet::default().with(layer),
                NormalSpace::Camera,
            );
            assert_eq!(alone.values.len(), 1);
            assert!(alone.values.get(&layer) == once.values.get(&layer), "{name}: {layer:?}");
        }
        // The picture and its damage are as before.
        let mut renderer = Renderer::default();
        let plan = plan_frame(&shot);
        let picture = renderer.render(&plan).clone();
        let mut view = shot.view.clone();
        view.projection = Projection::Orthographic;
        let _layers = renderer.layers(&Shot { view, ..shot }, LayerSet::ALL, NormalSpace::World);
        assert!(renderer.damage(&plan).is_nothing(), "{name}");
        assert!(*renderer.picture() == picture, "{name}");
        let hit = |renderer: &mut Renderer| renderer.hit(SIZE.width / 2, SIZE.height / 2);
        let mut fresh = Renderer::default();
        fresh.render(&plan);
        assert_eq!(hit(&mut renderer), hit(&mut fresh), "{name}");
        renderer.redraw(&plan, &|| true).unwrap();
        assert!(*renderer.picture() == picture, "{name}");
    }
}

#[test]
fn the_matrices_of_a_camera_agree_with_each_other() {
    for (name, shot) in shots() {
        let camera = PictureCamera::of(&shot);
        for axes in [AxesConvention::OpenGl, AxesConvention::OpenCv] {
            let product = camera.world_from_camera(axes) * camera.camera_from_world(axes);
            assert!(product.abs_diff_eq(DMat4::IDENTITY, 1e-9), "{name}: {product}");
        }
        let world_from_cv = camera.world_from_camera(AxesConvention::OpenCv);
        let depth = 0.3 * camera.near + 0.7 * camera.far;
        for position in [DVec2::ZERO, DVec2::new(31.5, 70.25), DVec2::new(150.0, 110.0)] {
            let point = camera.point(position, depth);
            let (back, found) = camera.project(point);
            assert!(back.distance(position) < 1e-7, "{name}: {back}");
            assert!((found - depth).abs() < 1e-9 * depth, "{name}: {found}");
            // K, by its definition.
            let p = world_from_cv.inverse().transform_point3(point);
            let p = match camera.projection {
                Projection::Perspective => p / p.z,
                Projection::Orthographic => DVec3::new(p.x, p.y, 1.0),
            };
            let rows = camera.k().map(|row| DVec3::from_array(row).dot(p));
            assert!(DVec2::new(rows[0], rows[1]).distance(position) < 1e-7, "{name}: {rows:?}");
            // Normalised device coordinates, from -1 to 1.
            let clip = camera.ndc_from_world() * point.extend(1.0);
            let ndc = clip.truncate() / clip.w;
            let pixel = DVec2::new(75.0 * (1.0 + ndc.x), 55.0 * (1.0 - ndc.y));
            assert!(pixel.distance(position) < 1e-7, "{name}: {ndc}");
            assert!((0.0..=1.0).contains(&ndc.z), "{name}: {ndc}");
        }
    }
    // A half-angle of 22.5 degrees across 110 rows: 55 / tan 22.5 = 55 (1 + sqrt 2).
    let (scene, view) = scene(&[]);
    let camera = PictureCamera::of(&shot(&scene, &view));
    let focal = camera.intrinsics.focal;
    assert!((focal - 55.0 * (1.0 + 2.0_f64.sqrt())).length() < 1e-9, "{focal}");
}

/// Returns a shot of the pixels from a corner on of a larger picture.
fn crop(shot: &Shot, corner: DVec2, size: Size) -> Shot {
    let (mut crop, projection) = (shot.clone(), shot.view.projection);
    let mut camera = crop.scene.selected_camera(&crop.view).clone();
    let whole = camera.lens.intrinsics(projection, shot.size);
    let principal_point = whole.principal_point - corner;
    let intrinsics = Intrinsics { principal_point, size, ..whole };
    camera.lens = camera.lens.with_intrinsics(projection, &intrinsics);
    let command = Command::Replace(Item::Camera(crop.view.camera, Box::new(camera)));
    command.apply(&mut crop.scene).unwrap();
    crop.size = size;
    crop
}

#[test]
fn a_picture_off_the_axis_is_a_part_of_a_larger_one() {
    let (corner, size) = ([97, 31], Size::new(48, 64));
    let mut renderer = Renderer::default();
    for (name, mut shot) in shots() {
        let scene = &shot.scene;
        let lights = scene.lights.ids().map(|id| {
            items::change_light(scene, id, |light| light.shadows = light.can_cast_shadows())
        });
        for command in lights.collect::<Vec<_>>() {
            command.unwrap().apply(&mut shot.scene).unwrap();
        }
        for samples in [Samples::One, Samples::Four] {
            shot.settings.samples = samples;
            #[expect(clippy::cast_precision_loss, reason = "a small picture")]
            let crop = crop(&shot, DVec2::new(corner[0] as f64, corner[1] as f64), size);
            let whole = renderer.render(&plan_frame(&shot)).clone();
            let part = renderer.render(&plan_frame(&crop));
            let (mut differing, mut most) = (0, 0);
            for (y, x) in (0..size.height).flat_map(|y| (0..size.width).map(move |x| (y, x))) {
                let [a, b] = [part.pixel(x, y), whole.pixel(x + corner[0], y + corner[1])];
                let by = (0..4).map(|i| a[i].abs_diff(b[i])).max().unwrap();
                // Arithmetic in f32 differs by a step or two.
                differing += usize::from(by > 2);
                most = most.max(by);
            }
            assert!(differing <= 3, "{name} {samples:?}: {differing} pixels, {most}");
        }
    }
}

/// A polygon of four corners with these normals.
fn plate(positions: [[f32; 3]; 4], normals: [[f32; 3]; 4]) -> Shared<Model> {
    let corner = |i: u32| SourceCorner { position: i, uv: NONE, normal: i };
    let source = MeshSource::of_polygons((0..4).map(corner), vec![4]);
    let (positions, normals) = (positions.to_vec(), normals.to_vec());
    model_of("plate", MeshSource { positions, normals, ..source })
}

#[test]
fn normals_of_a_stretched_object_are_those_of_its_file() {
    // A tilt of 0.006 degrees becomes 45 degrees, but the normals of the file stay along z.
    let corners = [[-1.0, -1.0, -1e-4], [1.0, -1.0, 1e-4], [1.0, 1.0, 1e-4], [-1.0, 1.0, -1e-4]];
    let stretched = DMat4::from_scale(DVec3::new(100.0, 100.0, 1e6));
    let (scene, view) = scene(&[(plate(corners, [[0.0, 0.0, 1.0]; 4]), stretched)]);
    let layers = all(&shot(&scene, &view), NormalSpace::World);
    let normal = vectors_at(&layers, Layer::Normal, SIZE.width * 55 + 75);
    assert!(normal.distance(DVec3::Z) < 1e-6, "{normal}");
}

#[test]
fn where_normals_cancel_out_the_triangles_own_faces_the_parallel_rays() {
    // The ray from the eye to the plate meets its other side.
    let corners =
        [[300.0, -50.0, 0.0], [340.0, -50.0, -100.0], [340.0, 50.0, -100.0], [300.0, 50.0, 0.0]];
    let [up, down] = [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]];
    let (scene, view) = scene(&[(plate(corners, [up, up, down, down]), DMat4::IDENTITY)]);
    let view = View { projection: Projection::Orthographic, ..view };
    // The middle row lies at y = 0, where the normals cancel out.
    let size = Size::new(151, 111);
    let shot = Shot::new(&scene, &view, &Settings::default(), size);
    let layers = all(&shot, NormalSpace::World);
    let normal = vectors_at(&layers, Layer::Normal, size.width * 55 + 110);
    let own = DVec3::new(10.0, 0.0, 4.0).normalize_or_zero();
    assert!(normal.distance(own) < 1e-6, "{normal}");
}

/// Two squares with texture coordinates and a part each.
fn board() -> Shared<Model> {
    let corner = |i: u32| SourceCorner { position: i, uv: i % 4, normal: NONE };
    let part = |name: &str| Part { name: name.to_owned(), material: None };
    let square =
        |x: f32| [[x, -1.0, 0.0], [x + 1.0, -1.0, 0.0], [x + 1.0, 1.0, 0.0], [x, 1.0, 0.0]];
    model_of(
        "board",
        MeshSource {
            positions: [square(-1.0), square(0.0)].concat(),
            uvs: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]],
            corners: (0..8).map(corner).collect(),
            arities: vec![4, 4],
            polygon_parts: vec![0, 1],
            parts: vec![part("left"), part("right")],
            ..Default::default()
        },
    )
}

#[test]
fn texture_coordinates_parts_and_materials_are_those_of_the_file() {
    // The boards fill the picture: one behind, hidden by the two of the test.
    let (mut scene, view) =
        scene(&[(board(), at(1000.0, 0.0, 0.0, -100.0)), (board(), at(100.0, 0.0, 0.0, 0.0))]);
    edit(&mut scene, ObjectId(10), |object| object.material = MaterialChoice::File);
    let own = MaterialChoice::Own(PresetId::RUBY.get().material);
    edit(&mut scene, ObjectId(11), |object| object.material = own);
    let size = Size::new(100, 100);
    let shot = Shot::new(&scene, &view, &Settings::default(), size);
    let layers = all(&shot, NormalSpace::Camera);
    let names: Vec<(i32, &str)> =
        layers.names.parts.iter().map(|part| (part.object, &*part.name)).collect();
    assert_eq!(names, [(1, "left"), (1, "right"), (2, "left"), (2, "right")]);
    assert_eq!(layers.names.materials, [PresetId::SILVER.get().name, "board"]);
    let camera = PictureCamera::of(&shot);
    for (x, part, material, polygon) in
        [(10_usize, 1, 1, 1), (90, 2, 1, 2), (35, 3, 2, 1), (65, 4, 2, 2)]
    {
        let i = 50 * size.width + x;
        let found = [Layer::Part, Layer::Material, Layer::Polygon].map(|it| layers.ids(it)[i]);
        assert_eq!(found, [part, material, polygon], "{x}");
        // u runs from 0 to 2 across each square, and v from 0 to 1 upwards.
        let (scale, depth) = if part <= 2 { (1000.0, 500.0) } else { (100.0, 400.0) };
        #[expect(clippy::cast_precision_loss, reason = "a small picture")]
        let point = camera.point(DVec2::new(x as f64 + 0.5, 50.5), depth) / scale;
        let u = 2.0 * (point.x + if point.x < 0.0 { 1.0 } else { 0.0 });
        let v = (point.y + 1.0) / 2.0;
        let uv = &layers.floats(Layer::Uv)[2 * i..][..2];
        let off = [u - f64::from(uv[0]), v - f64::from(uv[1])];
        assert!(off.iter().all(|off| off.abs() < 1e-4), "{x}: {uv:?} for {u} {v}");
    }
}
