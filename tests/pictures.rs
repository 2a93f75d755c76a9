//! Pictures of scenes small enough that the right result is known.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on may panic")]
#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small numbers")]

mod common;

use std::path::Path;

use common::{at, ball, covered, cube, draw, edit, model, scene, square};
use fearless_simd::Level;
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Arithmetic, LightAt, Samples, Settings, SpecularForm};
use marraztu_core::base::Shared;
use marraztu_core::base::color::Color;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Command, Fill, ItemId, MaterialChoice, Model, Normals, ObjectId, PolygonMode, PresetId,
    Projection, Scene, Sides, View,
};
use marraztu_lab::instructions::levels;
use marraztu_render::accel::Accelerated as _;
use marraztu_render::explain_frame;
use marraztu_render::plan_frame;
use marraztu_render::{EffectUse, Renderer};

const FIRST: ObjectId = ObjectId(10);
const SECOND: ObjectId = ObjectId(11);

/// Hides marks; the bulb's would cover part of the picture.
fn without_marks(view: View) -> View {
    View { marks: false, ..view }
}

fn steps_apart(a: &Picture, b: &Picture) -> u8 {
    let bytes = |picture: &Picture| picture.pixels().as_flattened().to_vec();
    bytes(a).iter().zip(bytes(b)).map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0)
}

#[test]
fn every_way_of_lighting_is_the_same_to_a_step_in_both_arithmetics() {
    let (scene, view) =
        scene(&[(ball(16), at(60.0, -70.0, 10.0, 0.0)), (cube(), at(50.0, 80.0, 0.0, -60.0))]);
    for light in [LightAt::Face, LightAt::Vertex, LightAt::Pixel] {
        for normals in [Normals::Vertex, Normals::Face] {
            for projection in [Projection::Perspective, Projection::Orthographic] {
                for specular in [SpecularForm::Reflection, SpecularForm::HalfVector] {
                    let view = View { normals, projection, ..view.clone() };
                    let settings = Settings { light, specular, ..Settings::default() };
                    let exact = Settings { arithmetic: Arithmetic::F64, ..settings };
                    let (fast, exact) =
                        (draw(&scene, &view, &settings, 160), draw(&scene, &view, &exact, 160));
                    let steps = steps_apart(&fast, &exact);
                    assert!(steps <= 1, "{steps} steps: {settings:?} {normals:?} {projection:?}");
                    assert_eq!(covered(&fast, &scene), covered(&exact, &scene));
                }
            }
        }
    }
}

/// A mesh with corners far away from the rest: the visible part is lit as if they were missing.
#[test]
fn a_stray_corner_takes_no_light_from_the_rest_in_either_arithmetic() {
    let far = [1e15_f32, 1e15, -1e15];
    let near = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    let positions: Vec<[f32; 3]> =
        near.into_iter().chain([far, far.map(|x| x + 1e9), far.map(|x| x * 1.5)]).collect();
    let stray = model("stray", &positions, &[&[0, 1, 2, 3], &[4, 5, 6]]);
    for light in [LightAt::Face, LightAt::Vertex, LightAt::Pixel] {
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            let settings = Settings { light, arithmetic, ..Settings::default() };
            let picture = |model: &Shared<Model>| {
                let (scene, view) = scene(&[(model.clone(), at(60.0, 10.0, 5.0, 0.0))]);
                draw(&scene, &without_marks(view), &settings, 64)
            };
            let (with, without) = (picture(&stray), picture(&square()));
            let middle = |picture: &Picture| picture.pixel(34, 30);
            assert!(middle(&without)[0] > 20, "the square is lit: {:?}", middle(&without));
            let apart =
                middle(&with).iter().zip(middle(&without)).map(|(a, b)| a.abs_diff(b)).max();
            assert!(apart <= Some(1), "{light:?} {arithmetic:?}: {apart:?}");
        }
    }
}

#[test]
fn the_first_scene_is_the_same_to_a_step_in_both_arithmetics_and_everywhere_at_its_borders() {
    let (scene, view) = marraztu_io::default_scene();
    let exact = Settings { arithmetic: Arithmetic::F64, ..Settings::default() };
    let fast = draw(&scene, &view, &Settings::default(), 800);
    let exact = draw(&scene, &view, &exact, 800);
    assert!(steps_apart(&fast, &exact) <= 1);
    assert_eq!(covered(&fast, &scene), covered(&exact, &scene));
    let differing = fast.pixels().iter().zip(exact.pixels()).filter(|(a, b)| a != b).count();
    assert!(differing * 2000 < 800 * 800 * 4, "{differing} pixels differ");
}

/// To renew them: `marraztu render assets/examples/NAME.marraztu --size 288x180 --out
/// assets/examples/NAME.jpg`.
#[test]
fn the_thumbnails_of_the_examples_are_their_pictures() {
    for example in marraztu_io::EXAMPLES {
        let opened =
            marraztu_io::open(Path::new(example.path), &marraztu_io::Progress::new()).unwrap();
        let settings = opened.settings.refined_to(Samples::Sixteen);
        let shot = Shot::new(&opened.scene, &opened.view, &settings, Size::new(288, 180));
        let drawn = Renderer::default().render(&plan_frame(&shot)).clone();
        let name = example.path.replace("example:/", "assets/examples/");
        let name = name.replace(".marraztu", ".jpg");
        let jpeg =
            marraztu_io::PictureFormat::of(Path::new(&name)).unwrap().encode(&drawn).unwrap();
        assert!(std::fs::read(&name).unwrap() == jpeg, "{name}");
        assert_eq!(example.thumbnail().unwrap().size(), drawn.size());
    }
}

#[test]
fn threads_and_instructions_do_not_show() {
    let (scene, view) = marraztu_io::default_scene();
    let view = View { edges_over_fill: true, ..view };
    let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(333, 257)));
    let picture = |level: Level, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Renderer::new(level).render(&plan).clone())
    };
    let first = picture(levels()[0], 1);
    for level in levels() {
        for threads in [1, 2, 5] {
            assert!(first == picture(level, threads), "{level:?} with {threads} threads");
        }
    }
}

#[test]
fn a_square_that_faces_the_camera_covers_the_pixels_that_the_lens_says() {
    // At a distance of 400 and 45 degrees, 100 pixels show 2 tan(22.5) 400 = 331.37 units.
    let (scene, view) = scene(&[(square(), at(50.0, 0.0, 0.0, 0.0))]);
    let picture = draw(&scene, &without_marks(view), &Settings::default(), 100);
    let side = (100.0 / (800.0 * 22.5_f64.to_radians().tan()) * 100.0).round() as usize;
    assert_eq!(covered(&picture, &scene).iter().filter(|seen| **seen).count(), side * side);
}

#[test]
fn a_surface_lit_by_the_sun_alone_has_the_colour_of_the_equation() {
    let (mut scene, view) = scene(&[(square(), at(50.0, 0.0, 0.0, 0.0))]);
    // Ground seen obliquely by a camera at (0, 0, 400): the square is turned by 45 degrees, to face
    // up and towards the camera.
    edit(&mut scene, FIRST, |object| {
        let turn =
            DMat4::from_rotation_x(-45_f64.to_radians()) * DMat4::from_scale(DVec3::splat(50.0));
        object.placement = object.placement.replaced(turn);
        object.material = MaterialChoice::Preset(PresetId::named("jade").unwrap());
    });
    for slot in [0, 2, 3, 4] {
        switch(&mut scene, slot, false);
    }
    let picture = draw(&scene, &without_marks(view), &Settings::default(), 99);
    // N.L = cos 45 with L straight up. At the centre V is along +Z, R = 2 (N.L) N - L = (0, 0, 1),
    // and R.V = 1.
    let half = 0.5_f64.sqrt();
    let expected =
        [0.54, 0.89, 0.63].map(|kd: f64| ((kd * half + 0.316_228).min(1.0) * 255.0).round());
    let [r, g, b, _] = picture.pixel(49, 49);
    for (got, want) in [r, g, b].into_iter().zip(expected) {
        assert!((f64::from(got) - want).abs() <= 1.0, "{got} for {want}");
    }
}

fn switch(scene: &mut Scene, slot: u32, on: bool) {
    let (id, light) = scene.lights.iter().find(|(_, light)| light.slot == slot).unwrap();
    let mut light = light.clone();
    light.on = on;
    let item = marraztu_core::scene::Item::Light(id, Box::new(light));
    Command::Replace(item).apply(scene).unwrap();
}

#[test]
fn back_faces_are_left_out_or_red_or_lit() {
    let turned = at(50.0, 0.0, 0.0, 0.0) * DMat4::from_rotation_y(std::f64::consts::PI);
    let (mut scene, view) = scene(&[(square(), turned)]);
    let view = without_marks(view);
    let settings = Settings::default();
    let empty = draw(&scene, &view, &settings, 50);
    assert!(covered(&empty, &scene).iter().all(|seen| !seen));
    let red = View { back_faces: true, ..view.clone() };
    assert_eq!(draw(&scene, &red, &settings, 50).pixel(25, 25), [255, 0, 0, 255]);
    edit(&mut scene, FIRST, |object| object.sides = Sides::Two);
    let lit = draw(&scene, &view, &settings, 50).pixel(25, 25);
    edit(&mut scene, FIRST, |object| {
        object.sides = Sides::One;
        object.placement = object.placement.replaced(at(50.0, 0.0, 0.0, 0.0));
    });
    // The object's own spot turned with it. Without the spot, front and turned back look alike.
    switch(&mut scene, 3, false);
    let front = draw(&scene, &view, &settings, 50).pixel(25, 25);
    edit(&mut scene, FIRST, |object| {
        object.sides = Sides::Two;
        object.placement = object.placement.replaced(turned);
    });
    let back = draw(&scene, &view, &settings, 50).pixel(25, 25);
    assert_eq!(front, back);
    assert_ne!(lit, scene.background.opaque());
}

/// A wavy sheet of 80,000 triangles that faces +Z, optionally with one more triangle.
fn fine_sheet(another: Option<[[f32; 3]; 3]>) -> Shared<Model> {
    const SIDE: u32 = 200;
    let mut positions = Vec::new();
    for (row, column) in (0..=SIDE).flat_map(|row| (0..=SIDE).map(move |column| (row, column))) {
        let [x, y] = [column, row].map(|at| at as f32 / 100.0 - 1.0);
        positions.push([x, y, 0.03 * (9.0 * x).sin() * (7.0 * y).cos()]);
    }
    let mut polygons: Vec<Vec<u32>> = Vec::new();
    for (row, column) in (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (row, column))) {
        let at = |row: u32, column: u32| row * (SIDE + 1) + column;
        let [a, b] = [at(row, column), at(row, column + 1)];
        polygons.push(vec![a, b, at(row + 1, column + 1)]);
        polygons.push(vec![a, at(row + 1, column + 1), at(row + 1, column)]);
    }
    let first = positions.len() as u32;
    polygons.extend(another.map(|_| vec![first, first + 1, first + 2]));
    positions.extend(another.into_iter().flatten());
    let polygons: Vec<&[u32]> = polygons.iter().map(Vec::as_slice).collect();
    model("sheet", &positions, &polygons)
}

#[test]
fn pixels_that_show_a_triangle_each_have_the_colors_of_triangles_on_many_pixels() {
    let place = at(60.0, 0.0, 0.0, 0.0);
    // A floor that reaches behind the camera makes the renderer light vertices while drawing.
    let floor = [[-90.0, -0.9, 30.0], [90.0, -0.9, 30.0], [0.0, -0.9, -5.0]];
    for (light, floor) in [(LightAt::Pixel, Some(floor)), (LightAt::Vertex, None)] {
        let (mut scene, view) = scene(&[(fine_sheet(floor), place)]);
        let view = without_marks(view);
        for normals in [Normals::Vertex, Normals::Face] {
            let view = View { normals, ..view.clone() };
            let settings = Settings { light, ..Settings::default() };
            edit(&mut scene, FIRST, |object| {
                object.sides = Sides::One;
                object.placement = object.placement.replaced(place);
            });
            let front = draw(&scene, &view, &settings, 200);
            // With red back faces, triangles are listed with slots.
            let red = View { back_faces: true, ..view.clone() };
            assert!(front == draw(&scene, &red, &settings, 200), "{light:?} {normals:?}");
            edit(&mut scene, FIRST, |object| object.sides = Sides::Two);
            assert!(front == draw(&scene, &view, &settings, 200), "{light:?} {normals:?}: lit");
            edit(&mut scene, FIRST, |object| {
                let turned = place * DMat4::from_rotation_y(std::f64::consts::PI);
                object.placement = object.placement.replaced(turned);
            });
            let back = draw(&scene, &view, &settings, 200);
            let exact = Settings { arithmetic: Arithmetic::F64, ..settings };
            let steps = steps_apart(&back, &draw(&scene, &view, &exact, 200));
            assert!(steps <= 1, "{steps} steps: {light:?} {normals:?}");
        }
    }
}

#[test]
fn a_mirrored_object_is_not_inside_out() {
    let (mut scene, view) = scene(&[(ball(8), at(80.0, 0.0, 0.0, 0.0))]);
    let view = without_marks(view);
    let plain = draw(&scene, &view, &Settings::default(), 64);
    edit(&mut scene, FIRST, |object| {
        let mirror = DMat4::from_scale(DVec3::new(-80.0, 80.0, 80.0));
        object.placement = object.placement.replaced(mirror);
    });
    let mirrored = draw(&scene, &view, &Settings::default(), 64);
    let seen = |picture: &Picture| covered(picture, &scene).iter().filter(|seen| **seen).count();
    assert_eq!(seen(&plain), seen(&mirrored));
    assert!(steps_apart(&plain, &mirrored) <= 2, "a ball is its own mirror image");
}

#[test]
fn nearer_surfaces_hide_farther_ones_in_any_order() {
    let near = (square(), at(20.0, 0.0, 0.0, 50.0));
    let far = (square(), at(60.0, 0.0, 0.0, -50.0));
    for models in [[near.clone(), far.clone()], [far, near]] {
        let (mut scene, view) = scene(&models);
        let nearer = if models[0].1.w_axis.z > 0.0 { FIRST } else { SECOND };
        edit(&mut scene, nearer, |object| {
            object.material = MaterialChoice::Preset(PresetId::EMERALD);
        });
        let [r, g, ..] = draw(&scene, &without_marks(view), &Settings::default(), 64).pixel(32, 32);
        assert!(g > r, "emerald is in front of ruby: {r} {g}");
    }
}

#[test]
fn a_wall_looks_the_same_whether_or_not_there_is_something_behind_it() {
    // A triangle that fills a block alone is recorded as a whole, without an entry per pixel.
    let wall = (square(), at(400.0, 3.0, -7.0, 0.0));
    let (alone, view) = scene(std::slice::from_ref(&wall));
    let (both, _) = scene(&[wall, (ball(6), at(100.0, 0.0, 0.0, -300.0))]);
    let without_lamps_of_objects = |mut scene: Scene| {
        switch(&mut scene, 3, false);
        scene
    };
    let (alone, both) = (without_lamps_of_objects(alone), without_lamps_of_objects(both));
    let view = without_marks(view);
    for light in [LightAt::Face, LightAt::Vertex, LightAt::Pixel] {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
                let settings = Settings { light, arithmetic, ..Settings::default() };
                let view = View { projection, ..view.clone() };
                let pictures = [&alone, &both].map(|scene| draw(scene, &view, &settings, 150));
                assert!(pictures[0] == pictures[1], "{light:?} {projection:?} {arithmetic:?}");
            }
        }
    }
}

#[test]
fn a_renderer_that_has_drawn_other_pictures_draws_the_same() {
    let mut renderer = Renderer::default();
    for round in 0..12_u32 {
        let aside = f64::from(round % 5) * 60.0 - 120.0;
        let (mut scene, view) = scene(&[(ball(8), at(40.0, aside, 20.0, 0.0))]);
        scene.background = if round % 4 == 3 { Color::WHITE } else { scene.background };
        let light = [LightAt::Pixel, LightAt::Vertex, LightAt::Face][round as usize % 3];
        let settings = Settings { light, ..Settings::default() };
        let size = if round < 6 { Size::new(200, 150) } else { Size::new(150, 200) };
        let plan = plan_frame(&Shot::new(&scene, &without_marks(view), &settings, size));
        assert!(*renderer.render(&plan) == *Renderer::default().render(&plan), "{round}");
    }
}

/// Random triangles and quads between the points of a small grid, with many intersections and
/// coincident faces.
fn heap() -> Shared<Model> {
    let mut rng = Rng::new(1);
    let mut next = |bound: u64| rng.below(bound) as u32;
    let positions: Vec<[f32; 3]> =
        (0..90).map(|_| [0; 3].map(|_: i32| next(4) as f32 / 1.5 - 1.0)).collect();
    let polygons: Vec<Vec<u32>> =
        (0..120).map(|i| (0..3 + i % 2).map(|_| next(90)).collect()).collect();
    model("heap", &positions, &polygons.iter().map(|own| &own[..]).collect::<Vec<_>>())
}

#[test]
fn the_order_in_which_a_mesh_is_drawn_does_not_show() {
    for light in [LightAt::Face, LightAt::Vertex, LightAt::Pixel] {
        let settings = Settings { light, ..Settings::default() };
        let [quickest, as_filed] = [heap(), heap()].map(|model| (model, at(60.0, 0.0, 0.0, 0.0)));
        as_filed.0.mesh.draw_as_filed();
        assert!(as_filed.0.mesh.draw_order() != quickest.0.mesh.draw_order());
        let pictures = [quickest, as_filed].map(|placed| {
            let (scene, view) = scene(&[placed]);
            draw(&scene, &View { edges_over_fill: true, back_faces: true, ..view }, &settings, 200)
        });
        assert!(pictures[0] == pictures[1], "{light:?}");
    }
}

#[test]
fn among_equal_depths_the_older_object_wins() {
    let (mut scene, view) =
        scene(&[(square(), at(50.0, 0.0, 0.0, 0.0)), (square(), at(50.0, 0.0, 0.0, 0.0))]);
    edit(&mut scene, SECOND, |object| {
        object.material = MaterialChoice::Preset(PresetId::EMERALD);
    });
    let before = draw(&scene, &view, &Settings::default(), 64);
    let [r, g, ..] = before.pixel(32, 34);
    assert!(r > g, "ruby is older than emerald: {r} {g}");
    let reorder = Command::Reorder { id: ItemId::Object(SECOND), to: 0 };
    reorder.apply(&mut scene).unwrap();
    assert_eq!(
        before,
        draw(&scene, &view, &Settings::default(), 64),
        "the list's order does not show"
    );
}

#[test]
fn a_ground_that_runs_through_the_camera_is_cut_at_the_near_plane() {
    // A floor of 1000 units, 10 below the camera. Without clipping its rear corners would fold
    // over.
    let floor = at(1000.0, 0.0, -10.0, 400.0) * DMat4::from_rotation_x(-90_f64.to_radians());
    let (scene, view) = scene(&[(square(), floor)]);
    let picture = draw(&scene, &without_marks(view), &Settings::default(), 101);
    let seen = covered(&picture, &scene);
    let rows: Vec<usize> =
        (0..101).map(|y| seen[y * 101..][..101].iter().filter(|seen| **seen).count()).collect();
    assert!(rows[..50].iter().all(|row| *row == 0), "nothing of the floor is above the horizon");
    assert!(rows[54..].iter().all(|row| *row == 101), "below it there is floor from side to side");
}

#[test]
fn edges_are_the_outlines_of_polygons_that_face_the_camera() {
    let (mut scene, view) = scene(&[(cube(), at(50.0, 0.0, 0.0, 0.0))]);
    edit(&mut scene, FIRST, |object| object.edge_color = Color([1, 200, 3]));
    let view = View { fill: Fill::Edges, ..without_marks(view) };
    let picture = draw(&scene, &view, &Settings::default(), 101);
    let colored = |color: [u8; 4]| picture.pixels().iter().filter(|pixel| **pixel == color).count();
    let front = colored([1, 200, 3, 255]);
    // Only the front square faces a camera in front of its centre: four sides of about 34 pixels.
    let side = 100.0 / (700.0 * 22.5_f64.to_radians().tan()) * 101.0;
    assert!((front as f64 - 4.0 * side).abs() <= 6.0, "{front} for {}", 4.0 * side);
    assert_eq!(colored(Color::BACK_FACE.opaque()), 0);
    let red = View { back_faces: true, ..view };
    let picture = draw(&scene, &red, &Settings::default(), 101);
    assert!(picture.pixels().contains(&Color::BACK_FACE.opaque()));
}

#[test]
fn one_polygon_is_shown_alone_or_with_the_earlier_ones() {
    let (scene, view) = scene(&[(cube(), at(50.0, 0.0, 0.0, 0.0))]);
    let count = |polygon: u32, stay: bool| {
        let mut mode = PolygonMode::begin();
        mode.go_to(polygon);
        let view = View {
            polygons: Some(mode),
            polygons_stay: stay,
            back_faces: true,
            ..without_marks(view.clone())
        };
        let picture = draw(&scene, &view, &Settings::default(), 64);
        covered(&picture, &scene).iter().filter(|seen| **seen).count()
    };
    // Polygon 0 is the cube's back, 1 its front, and 2 the bottom, seen from inside.
    assert!(count(1, false) > count(0, false));
    assert_eq!(count(1, true), count(1, false), "the front hides the back");
    assert!(count(2, true) > count(2, false));
}

#[test]
fn a_pixel_maps_to_its_item_and_polygon() {
    let (scene, view) =
        scene(&[(cube(), at(40.0, -80.0, 0.0, 0.0)), (cube(), at(40.0, 80.0, 0.0, 0.0))]);
    let plan = plan_frame(&Shot::new(&scene, &view, &Settings::default(), Size::new(200, 200)));
    let mut renderer = Renderer::default();
    renderer.render(&plan);
    let mut item = |x: usize, y: usize| renderer.hit(x, y).map(|hit| (hit.item, hit.polygon));
    assert_eq!(item(52, 100), Some((ItemId::Object(FIRST), Some(1))));
    assert_eq!(item(148, 100), Some((ItemId::Object(SECOND), Some(1))));
    assert_eq!(item(100, 20), None);
    assert_eq!(item(1000, 20), None);
    let bulb = scene.lights.iter().find(|(_, light)| light.slot == 2).unwrap().0;
    assert_eq!(
        item(100, 100),
        Some((ItemId::Light(bulb), Some(0))),
        "the diamond stands in the middle"
    );
}

#[test]
fn the_diamond_is_nine_pixels_across_however_far() {
    let (scene, view) = scene(&[]);
    let picture = draw(&scene, &view, &Settings::default(), 800);
    let yellow: Vec<(usize, usize)> = (0..800 * 800)
        .filter(|i| picture.pixels()[*i] == [255, 255, 0, 255])
        .map(|i| (i % 800, i / 800))
        .collect();
    let extent = |pick: fn(&(usize, usize)) -> usize| {
        let (low, high) =
            (yellow.iter().map(pick).min().unwrap(), yellow.iter().map(pick).max().unwrap());
        high - low + 1
    };
    assert!((8..=9).contains(&extent(|p| p.0)) && (8..=9).contains(&extent(|p| p.1)), "{yellow:?}");
}

#[test]
fn scenes_without_anything_in_them_are_background() {
    let (scene, view) = scene(&[]);
    for side in [1, 7, 64, 65] {
        let picture = draw(&scene, &without_marks(view.clone()), &Settings::default(), side);
        assert!(picture.pixels().iter().all(|pixel| *pixel == scene.background.opaque()));
    }
}

#[test]
fn everything_that_is_left_out_is_listed_with_its_reason() {
    let (mut scene, view) = scene(&[(cube(), at(40.0, 0.0, 0.0, 900.0))]);
    switch(&mut scene, 4, false);
    edit(&mut scene, FIRST, |object| {
        let rubber = PresetId::named("black plastic").unwrap();
        object.material = MaterialChoice::Preset(rubber);
    });
    let explained = |scene: &Scene| {
        explain_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(64, 64))).1
    };
    let reason = |uses: &[EffectUse], name: &str, on: Option<&str>| {
        let is_it = |one: &&EffectUse| {
            one.name == name && one.on.as_ref().map(|thing| thing.name.as_str()) == on
        };
        let found = uses.iter().find(is_it).unwrap();
        assert!(!found.state.is_on(), "{name}");
        found.state.why().to_owned()
    };
    let uses = explained(&scene);
    assert_eq!(reason(&uses, "Surfaces", Some("cube")), "outside the view");
    assert_eq!(reason(&uses, "camera spot", None), "switched off");
    edit(&mut scene, FIRST, |object| {
        object.placement = object.placement.replaced(at(40.0, 0.0, 0.0, 0.0));
    });
    let uses = explained(&scene);
    assert_eq!(reason(&uses, "ambient", Some("cube")), "Ka of the material is 0");
    assert_eq!(reason(&uses, "Textures", Some("cube")), "the model has no texture coordinates");
}

#[test]
fn triangles_that_face_away_or_lie_outside_are_not_counted_as_drawn() {
    let (scene, view) =
        scene(&[(cube(), at(40.0, 0.0, 0.0, 0.0)), (cube(), at(9.0, 9e3, 0.0, 0.0))]);
    let plan = plan_frame(&Shot::new(
        &scene,
        &without_marks(view),
        &Settings::default(),
        Size::new(64, 64),
    ));
    let mut renderer = Renderer::default();
    renderer.render(&plan);
    assert_eq!(renderer.triangles_drawn(), 2, "the front square of the near cube");
}
