//! Mirrors and refraction: what they show, compared with pictures of the same things without them
//! and with formulas.
//!
//! Catches: rays that start beside their surface or leak through edges, mirrored things in the
//! wrong light, Snell's law the wrong way round, bounces that are counted wrongly, things behind
//! the observer or outside of the view that a mirror does not show, a mirror that keeps an old
//! picture, and scenes without mirrors that pay for them.

#![allow(clippy::cast_possible_truncation, reason = "small numbers")]
#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::f64::consts::{PI, TAU};

mod common;

use common::{at, ball, cube, draw, edit, model_of, scene, square};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{AXES, Arithmetic, Bounces, LightAt, Samples, Settings, Shot};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    Command, Item, Light, LightId, LightKind, List, LoadOptions, Material, MaterialChoice,
    MeshSource, Normals, ObjectId, Optics, Reflection, Scene, Sides, SourceCorner, Tracked,
    Transmission, View,
};
use marraztu_io::{self as io, Progress};
use marraztu_render::{
    Effect, EffectState, Part, Renderer, explain_frame, plan_everything, plan_frame,
};

const SIDE: usize = 96;

/// A material that shows nothing but its surroundings.
fn sees(reflection: Reflection, specular: f64, transmission: Transmission, index: f64) -> Material {
    Material {
        specular: [specular; 3],
        exponent: 1000.0,
        optics: Optics { reflection, transmission, index },
        ..Material::matte([0.0; 3], [0.0; 3])
    }
}

fn mirror(specular: f64) -> Material {
    sees(Reflection::Constant, specular, Transmission::None, 1.0)
}

fn glass(index: f64) -> Material {
    sees(Reflection::None, 0.0, Transmission::Filter([1.0; 3]), index)
}

fn paint(scene: &mut Scene, id: u32, material: Material) {
    edit(scene, ObjectId(id), |object| object.material = MaterialChoice::Own(material));
}

/// Sets the lights of a scene.
fn light(scene: &mut Scene, lights: Vec<Light>) {
    scene.lights = List::from_iter((500..).map(LightId).zip(lights).collect::<Vec<_>>());
}

/// Replaces the camera by one at the origin that looks along -Z.
fn from_origin(scene: &mut Scene) {
    let cameras = scene.cameras.iter().map(|(id, camera)| {
        let mut camera = camera.clone();
        camera.pose = Tracked::new(marraztu_core::scene::Pose::facing_minus_z(DVec3::ZERO));
        (id, camera)
    });
    scene.cameras = List::from_iter(cameras.collect::<Vec<_>>());
}

/// The largest difference of two pictures, and the share of pixels that differ by more than a step.
fn differ(a: &Picture, b: &Picture) -> (u8, f64) {
    let most = |(a, b): (&[u8; 4], &[u8; 4])| (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap();
    let all: Vec<u8> = a.pixels().iter().zip(b.pixels()).map(most).collect();
    let beyond = all.iter().filter(|most| **most > 1).count();
    (all.iter().copied().max().unwrap(), beyond as f64 / all.len() as f64)
}

#[test]
fn a_plane_mirror_shows_what_the_mirrored_scene_shows() {
    // Behind the observer: a ball, a stretched cube and a lamp, seen in a mirror that fills the
    // view.
    let things = [
        at(9.0, -6.0, 3.0, 40.0),
        DMat4::from_translation(DVec3::new(14.0, -4.0, 30.0))
            * DMat4::from_rotation_y(0.5)
            * DMat4::from_scale(DVec3::new(4.0, 9.0, 5.0)),
    ];
    let over_there =
        DMat4::from_translation(DVec3::Z * -20.0) * DMat4::from_scale(DVec3::new(1.0, 1.0, -1.0));
    let lamp = DVec3::new(-15.0, 20.0, 10.0);
    let bulb = |place: DVec3| {
        let position = Tracked::new(place);
        let kind = LightKind::Bulb { position, orbit: Default::default() };
        Light { shadows: true, ..Light::new("lamp", 1, kind) }
    };
    let shiny = |color: [f64; 3]| Material {
        specular: [0.5; 3],
        exponent: 20.0,
        ..Material::matte([0.2; 3], color)
    };
    let build = |moved: DMat4, has_mirror: bool| {
        let own = |thing: DMat4| moved * thing;
        let mut models = vec![(ball(24), own(things[0])), (cube(), own(things[1]))];
        if has_mirror {
            models.push((square(), at(500.0, 0.0, 0.0, -10.0)));
        }
        let (mut scene, view) = scene(&models);
        from_origin(&mut scene);
        let bulb = bulb(moved.transform_point3(lamp));
        light(&mut scene, vec![Light::new("ambient", 0, LightKind::Ambient), bulb]);
        paint(&mut scene, 10, shiny([0.9, 0.4, 0.2]));
        paint(&mut scene, 11, shiny([0.2, 0.5, 0.9]));
        if has_mirror {
            paint(&mut scene, 12, mirror(1.0));
        }
        (scene, View { marks: false, ..view })
    };
    let (seen, view) = build(DMat4::IDENTITY, true);
    let (there, _) = build(over_there, false);
    for settings in [
        Settings::default(),
        Settings { arithmetic: Arithmetic::F64, ..Settings::default() },
        Settings { samples: Samples::Sixteen, ..Settings::default() },
        Settings { light: LightAt::Sample, samples: Samples::Four, ..Settings::default() },
    ] {
        let mirrored = draw(&seen, &view, &settings, SIDE);
        let direct = draw(&there, &view, &settings, SIDE);
        let background = there.background.opaque();
        let shown = direct.pixels().iter().filter(|it| **it != background).count();
        assert!(shown > 600, "{shown} pixels");
        // Outlines are snapped to 1/256 pixel, and rays are not. With sixteen samples, light at the
        // centre of a pixel is compared with the mean of light at its samples.
        let most = if settings.samples == Samples::Sixteen { 0.06 } else { 0.01 };
        let (_, share) = differ(&mirrored, &direct);
        assert!(share < most, "{share} of the pixels differ with {settings:?}");
    }
}

/// A wall behind the origin's view, from black on the left to white on the right.
fn gradient(half: f32, z: f32) -> marraztu_core::base::Shared<marraztu_core::scene::Model> {
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
    let grey = |x: f32| [(x / half + 1.0) / 2.0; 3];
    model_of(
        "gradient",
        MeshSource {
            positions: corners.map(|[x, y]| [x, y, z]).to_vec(),
            colors: corners.map(|[x, _]| grey(x)).to_vec(),
            ..MeshSource::of_polygons((0..4).map(SourceCorner::bare), vec![4])
        },
    )
}

#[test]
fn a_slab_of_glass_shifts_what_is_behind_it_by_snells_law() {
    const WALL: f64 = 50.0;
    const HALF: f64 = 40.0;
    let ambient = || vec![Light::new("ambient", 0, LightKind::Ambient)];
    for index in [1.0, 1.33, 1.5, 2.4] {
        for degrees in [0.0_f64, 25.0, 50.0] {
            // A cube of 20 x 20 x 6, turned about Y.
            let turn = DMat4::from_rotation_y(degrees.to_radians());
            let slab = DMat4::from_translation(DVec3::Z * -20.0)
                * turn
                * DMat4::from_scale(DVec3::new(10.0, 10.0, 3.0));
            let (mut scene, view) =
                scene(&[(gradient(HALF as f32, -WALL as f32), DMat4::IDENTITY), (cube(), slab)]);
            from_origin(&mut scene);
            light(&mut scene, ambient());
            paint(&mut scene, 10, Material::matte([1.0; 3], [0.0; 3]));
            paint(&mut scene, 11, glass(index));
            edit(&mut scene, ObjectId(11), |object| object.sides = Sides::Auto);
            let view = View { marks: false, normals: Normals::Face, ..view };
            let [grey, ..] = draw(&scene, &view, &Settings::default(), 97).pixel(48, 48);
            // d sin(a) (1 - cos(a) / sqrt(n^2 - sin^2(a))), to the side of the turned slab.
            let (sin, cos) = degrees.to_radians().sin_cos();
            let shift = 6.0 * sin * (1.0 - cos / (index * index - sin * sin).sqrt());
            // The way of a shifted ray is parallel to the view axis.
            let expected = 255.0 * (shift / HALF + 1.0) / 2.0;
            let other = 255.0 * (-shift / HALF + 1.0) / 2.0;
            let off = (f64::from(grey) - expected).abs().min((f64::from(grey) - other).abs());
            assert!(off < 1.0, "{index} at {degrees}: {grey}, not {expected} or {other}");
            assert!(shift < 0.5 || (f64::from(grey) - 127.5).abs() > 1.0, "nothing is shifted");
        }
    }
}

#[test]
fn glass_of_index_1_is_invisible_and_its_filter_colours_twice() {
    let (mut scene, view) =
        scene(&[(cube(), at(60.0, 0.0, 0.0, -200.0)), (ball(16), at(50.0, 20.0, 10.0, 0.0))]);
    let view = View { marks: false, ..view };
    let settings = Settings { arithmetic: Arithmetic::F64, ..Settings::default() };
    paint(&mut scene, 11, glass(1.0));
    let through = draw(&scene, &view, &settings, SIDE);
    let clear = sees(Reflection::None, 0.0, Transmission::Filter([0.5, 1.0, 1.0]), 1.0);
    paint(&mut scene, 11, clear);
    let tinted = draw(&scene, &view, &settings, SIDE);
    edit(&mut scene, ObjectId(11), |object| object.visible = false);
    let without = draw(&scene, &view, &settings, SIDE);
    let (_, share) = differ(&through, &without);
    assert!(share < 0.01, "{share}");
    // In the middle of the ball, light passes two of its surfaces.
    let [red, green, ..] = without.pixel(52, 46);
    let [less, same, ..] = tinted.pixel(52, 46);
    assert!(red > 40 && less.abs_diff(red / 4) <= 1, "{red} {less}");
    assert!(same.abs_diff(green) <= 1);
}

#[test]
fn facing_mirrors_add_up_as_many_terms_of_a_series_as_there_are_bounces() {
    // Each emits 0.1 and mirrors a half.
    let emitting = Material { emission: [0.1; 3], ..mirror(0.5) };
    let behind = DMat4::from_rotation_y(PI);
    let (mut scene, view) = scene(&[
        (square(), at(900.0, 0.0, 0.0, -10.0)),
        (square(), DMat4::from_translation(DVec3::Z * 10.0) * behind * at(900.0, 0.0, 0.0, 0.0)),
    ]);
    from_origin(&mut scene);
    light(&mut scene, Vec::new());
    paint(&mut scene, 10, emitting);
    paint(&mut scene, 11, emitting);
    let view = View { marks: false, ..view };
    for bounces in Bounces::ALL {
        let settings = Settings { bounces, ..Settings::default() };
        let count = i32::from(u16::from(bounces) as u8);
        let sum = 0.1 * (1.0 - 0.5_f64.powi(count + 1)) / 0.5;
        let [r, g, b, _] = draw(&scene, &view, &settings, 33).pixel(16, 16);
        let byte = (255.0 * sum + 0.5) as u8;
        assert_eq!([r, g, b], [byte; 3], "{bounces:?}");
    }
}

#[test]
fn without_bounces_a_mirror_is_drawn_like_any_material() {
    let (mut scene, view) = scene(&[(ball(16), at(60.0, 0.0, 0.0, 0.0))]);
    let plain = Material { specular: [0.6; 3], exponent: 9.0, ..Material::default() };
    let settings = Settings { bounces: Bounces::None, ..Settings::default() };
    paint(&mut scene, 10, plain);
    let expected = draw(&scene, &view, &settings, SIDE);
    for transmission in [Transmission::None, Transmission::Opacity, Transmission::Filter([0.9; 3])]
    {
        for reflection in Reflection::ALL {
            let optics = Optics { reflection, transmission, index: 1.5 };
            paint(&mut scene, 10, Material { optics, ..plain });
            assert_eq!(draw(&scene, &view, &settings, SIDE), expected, "{optics:?}");
        }
    }
}

#[test]
fn opacity_lets_rays_through_and_keeps_the_rest_of_the_colour() {
    let (mut scene, view) =
        scene(&[(gradient(90.0, -300.0), DMat4::IDENTITY), (square(), at(50.0, 0.0, 0.0, 0.0))]);
    light(&mut scene, vec![Light::new("ambient", 0, LightKind::Ambient)]);
    let optics = Optics { transmission: Transmission::Opacity, ..Optics::NONE };
    paint(&mut scene, 10, Material::matte([1.0; 3], [0.0; 3]));
    paint(&mut scene, 11, Material { optics, ..Material::matte([0.8; 3], [0.0; 3]) });
    edit(&mut scene, ObjectId(11), |object| object.opacity = 0.25);
    let view = View { marks: false, ..view };
    let by_rays = draw(&scene, &view, &Settings::default(), SIDE);
    paint(&mut scene, 11, Material::matte([0.8; 3], [0.0; 3]));
    let blended = draw(&scene, &view, &Settings::default(), SIDE);
    let (most, _) = differ(&by_rays, &blended);
    assert!(most <= 1, "an open pane bends nothing, so both are the same: {most}");
}

#[test]
fn what_comes_after_a_change_out_of_view_is_what_a_new_picture_shows() {
    let (mut scene, view) =
        scene(&[(square(), at(80.0, 0.0, 0.0, 0.0)), (cube(), at(60.0, 0.0, 0.0, 900.0))]);
    paint(&mut scene, 10, mirror(0.9));
    let view = View { marks: false, ..view };
    let plan = |scene: &Scene| {
        plan_frame(&Shot::new(scene, &view, &Settings::default(), Size::new(SIDE, SIDE)))
    };
    let mut renderer = Renderer::default();
    let mut last = renderer.render(&plan(&scene)).clone();
    type Edit = fn(&mut Scene);
    let edits: [Edit; 4] = [
        |scene| {
            edit(scene, ObjectId(11), |it| it.placement = Tracked::new(at(60.0, 30.0, 0.0, 900.0)));
        },
        |scene| paint(scene, 11, Material::matte([0.9; 3], [0.0, 0.9, 0.0])),
        |scene| edit(scene, ObjectId(11), |it| it.visible = false),
        |scene| {
            let item = Item::Object(
                ObjectId(12),
                Box::new(scene.objects.get(ObjectId(11)).unwrap().clone()),
            );
            Command::Insert { at: 0, item }.apply(scene).unwrap();
            edit(scene, ObjectId(12), |it| it.visible = true);
        },
    ];
    for (i, change) in edits.into_iter().enumerate() {
        change(&mut scene);
        renderer.redraw(&plan(&scene), &|| true).unwrap();
        let now = renderer.picture().clone();
        assert_ne!(now, last, "change {i} is seen in the mirror");
        assert_eq!(now, *Renderer::default().render(&plan(&scene)), "change {i}");
        last = now;
    }
    // Nothing has changed: nothing is drawn.
    assert_eq!(renderer.redraw(&plan(&scene), &|| true).unwrap().tiles(), 0);
}

#[test]
fn a_pixel_of_glass_is_explained_with_what_is_seen_in_it() {
    let opened = io::lesson_scene("mirrors").unwrap();
    let size = Size::new(160, 120);
    for settings in
        [Settings::default(), Settings { arithmetic: Arithmetic::F64, ..Settings::default() }]
    {
        let mut renderer = Renderer::default();
        let shot = Shot::new(&opened.scene, &opened.view, &settings, size);
        let picture = renderer.render(&plan_frame(&shot)).clone();
        let mut seen = 0;
        for (x, y) in (0..160).step_by(5).flat_map(|x| (0..120).step_by(5).map(move |y| (x, y))) {
            let explained = renderer.explain(x, y).unwrap();
            let [r, g, b, _] = picture.pixel(x, y);
            assert_eq!(explained.bytes, [r, g, b], "{x},{y}");
            let sum = explained.terms.iter().fold(explained.rounding, |sum, term| {
                std::array::from_fn(|i| sum[i] + term.value[i])
            });
            for (i, sum) in sum.into_iter().enumerate() {
                assert!((sum - explained.color[i]).abs() < 1e-12, "{x},{y}");
                let byte = f64::from(explained.bytes[i]);
                let color = (explained.color[i] * 255.0).clamp(0.0, 255.0);
                assert!((color - byte).abs() < 0.502, "{x},{y}: {color} {byte}");
            }
            seen += explained.terms.iter().filter(|term| term.part == Part::Surroundings).count();
        }
        assert!(seen > 50, "{seen}");
    }
}

#[test]
fn every_choice_of_every_axis_and_the_rules_show_the_same_in_a_mirror() {
    let opened = io::lesson_scene("mirrors").unwrap();
    let size = Size::new(80, 60);
    for choice in AXES.iter().flat_map(|axis| axis.choices) {
        let settings = choice.of(&Settings::default());
        if settings.samples == Samples::TwoFiftySix {
            continue;
        }
        let shot = Shot::new(&opened.scene, &opened.view, &settings, size);
        let drawn = Renderer::default().render(&plan_frame(&shot)).clone();
        let all = Renderer::default().render(&plan_everything(&shot)).clone();
        assert_eq!(drawn, all, "{}", choice.label);
        let bands = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        let other = bands.install(|| Renderer::default().render(&plan_frame(&shot)).clone());
        assert_eq!(drawn, other, "{}", choice.label);
    }
}

#[test]
fn ordinary_scenes_cast_no_rays_and_say_why() {
    let (scene, view) = io::default_scene();
    let shot = Shot::new(&scene, &view, &Settings::default(), Size::new(SIDE, SIDE));
    let (_, uses) = explain_frame(&shot);
    let mut rows = 0;
    for (effect, reason) in [
        (Effect::Mirrors, "no material mirrors"),
        (Effect::Refraction, "no material lets light through"),
    ] {
        for row in uses.iter().filter(|row| row.effect == effect) {
            assert_eq!(row.state, EffectState::LeftOut(reason.into()), "{row:?}");
            rows += 1;
        }
    }
    assert!(rows >= 4, "{rows}");
    let mut renderer = Renderer::default();
    renderer.render(&plan_frame(&shot));
    assert_eq!(renderer.rays().bounced, 0);
}

#[test]
fn a_plan_with_mirrors_says_so_and_can_be_drawn_without_them() {
    let opened = io::lesson_scene("mirrors").unwrap();
    let settings = Settings::default();
    let shot = Shot::new(&opened.scene, &opened.view, &settings, Size::new(SIDE, SIDE));
    let (plan, uses) = explain_frame(&shot);
    let on = |effect| uses.iter().filter(|row| row.effect == effect && row.state.is_on()).count();
    // The glass ball mirrors, too.
    assert_eq!((on(Effect::Mirrors), on(Effect::Refraction)), (2, 1));
    let mut renderer = Renderer::default();
    renderer.render(&plan);
    let all = renderer.rays().bounced;
    let without = plan.without(Effect::Mirrors).unwrap().without(Effect::Refraction).unwrap();
    let dark = renderer.render(&without).clone();
    assert!(all > 1000 && renderer.rays().bounced == 0);
    let none = Settings { bounces: Bounces::None, ..settings };
    let expected = plan_frame(&Shot { settings: none, ..shot });
    assert_eq!(dark, *Renderer::default().render(&expected));
}

#[test]
fn materials_of_files_ask_for_rays_by_illum_and_exports_keep_it() {
    let folder = tempfile::tempdir().unwrap();
    let mut mtl = String::new();
    let mut obj = String::from("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    let rows: [(&str, Optics); 9] = [
        ("illum 2\nNi 1.5", Optics::NONE),
        ("illum 3", Optics { reflection: Reflection::Constant, ..Optics::NONE }),
        ("illum 4\nd 0.5", Optics { reflection: Reflection::Constant, ..Optics::NONE }),
        ("illum 5\nNi 2", Optics { reflection: Reflection::Fresnel, index: 2.0, ..Optics::NONE }),
        (
            "illum 6\nTf 0.5",
            Optics {
                reflection: Reflection::Constant,
                transmission: Transmission::Filter([0.5; 3]),
                index: 1.0,
            },
        ),
        (
            "illum 6\nd 0.25\nNi 1.45",
            Optics {
                reflection: Reflection::Constant,
                transmission: Transmission::Opacity,
                index: 1.45,
            },
        ),
        (
            "illum 7\nTf 1 0.5 0.25\nNi 1.5",
            Optics {
                reflection: Reflection::Fresnel,
                transmission: Transmission::Filter([1.0, 0.5, 0.25]),
                index: 1.5,
            },
        ),
        ("illum 8", Optics::NONE),
        (
            "illum 7\nTf 1\nNi 99",
            Optics {
                reflection: Reflection::Fresnel,
                transmission: Transmission::Filter([1.0; 3]),
                index: 1.0,
            },
        ),
    ];
    for (i, (statements, _)) in rows.iter().enumerate() {
        mtl += &format!("newmtl m{i}\nKa 0 0 0\nKd 0.1 0 0\nKs 0.8 0.8 0.8\nNs 90\n{statements}\n");
        obj += &format!("usemtl m{i}\nf 1 2 3\n");
    }
    std::fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    std::fs::write(folder.path().join("a.obj"), obj).unwrap();
    let load = |name: &str| {
        io::load(&folder.path().join(name), &LoadOptions::default(), &Progress::new()).unwrap()
    };
    let optics = |loaded: &io::Loaded| -> Vec<Optics> {
        loaded.model.materials.iter().map(|material| material.material.optics).collect()
    };
    let expected: Vec<Optics> = rows.iter().map(|(_, optics)| *optics).collect();
    let loaded = load("a.obj");
    assert_eq!(optics(&loaded), expected);
    let status = std::process::Command::new(env!("CARGO_BIN_EXE_marraztu"))
        .args(["export", "a.obj", "--out", "b.obj", "--quiet"])
        .current_dir(folder.path())
        .status();
    assert!(status.unwrap().success());
    assert_eq!(optics(&load("b.obj")), expected);
}

#[test]
fn a_reflection_map_takes_the_place_of_the_background_and_with_illum_8_of_everything() {
    let folder = tempfile::tempdir().unwrap();
    let faces = ["right", "left", "top", "bottom", "front", "back"];
    let mut cube = String::new();
    for (i, face) in (0_u8..).zip(faces) {
        // Each face is darker below.
        let picture = image::RgbImage::from_fn(16, 16, |_, y| {
            image::Rgb([40 * i, if y < 8 { 250 } else { 100 }, 255 - 40 * i])
        });
        picture.save(folder.path().join(format!("{face}.png"))).unwrap();
        cube += &format!("refl -type cube_{face} {face}.png\n");
    }
    let sky = image::RgbImage::from_fn(64, 32, |x, _| {
        // The middle third lies along -Z, and the borders along +Z.
        image::Rgb(if (16..48).contains(&x) { [0, 0, 200] } else { [200, 150, 0] })
    });
    sky.save(folder.path().join("sky.png")).unwrap();
    let seen = |statements: &str, tilt: f64, is_hidden: bool| {
        let mtl = format!("newmtl m\nKa 0 0 0\nKd 0 0 0\nKs 1 1 1\nNs 90\n{statements}");
        std::fs::write(folder.path().join("a.mtl"), mtl).unwrap();
        let obj = "mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl m\nf 1 2 3 4\n";
        let path = folder.path().join("a.obj");
        std::fs::write(&path, obj).unwrap();
        let loaded = io::load(&path, &LoadOptions::default(), &Progress::new()).unwrap();
        let place = DMat4::from_rotation_x(tilt) * DMat4::from_scale(DVec3::splat(300.0));
        let behind = DMat4::from_translation(DVec3::new(0.0, 0.0, 900.0))
            * DMat4::from_scale(DVec3::splat(5000.0));
        let mut models = vec![(loaded.model.into(), place)];
        if is_hidden {
            models.push((square(), behind));
        }
        let (mut scene, view) = scene(&models);
        edit(&mut scene, ObjectId(10), |object| object.material = MaterialChoice::File);
        if is_hidden {
            edit(&mut scene, ObjectId(11), |object| object.sides = Sides::Two);
        }
        light(&mut scene, Vec::new());
        let view = View { marks: false, ..view };
        let [r, g, b, _] = draw(&scene, &view, &Settings::default(), 64).pixel(32, 32);
        ([r, g, b], loaded.findings)
    };
    let near = |got: [u8; 3], want: [u8; 3]| got.iter().zip(want).all(|(a, b)| a.abs_diff(b) < 12);
    // The mirror faces +Z: the front of the cube, a little above or below its middle.
    let (above, findings) = seen(&format!("illum 3\n{cube}"), -0.1, false);
    assert!(near(above, [160, 250, 95]), "{above:?} {findings:?}");
    assert!(near(seen(&format!("illum 3\n{cube}"), 0.1, false).0, [160, 100, 95]));
    assert!(near(seen("illum 3\nrefl -type sphere sky.png\n", 0.0, false).0, [200, 150, 0]));
    // An object hides it from rays, and illum 8 casts none.
    let (black, findings) = seen(&format!("illum 3\n{cube}"), -0.1, true);
    assert!(near(black, [0, 0, 0]), "{black:?} {findings:?}");
    assert!(near(seen(&format!("illum 8\n{cube}"), -0.1, true).0, [160, 250, 95]));
    // Without a picture, or with one that is missing, nothing changes.
    let (blue, findings) = seen("illum 3\nrefl gone.png\n", 0.0, false);
    assert!(near(blue, [0, 0, 179]) && findings.len() == 1, "{blue:?} {findings:?}");
    for nothing in
        ["illum 8\n", "illum 9\nrefl gone.png\n", "illum 8\nrefl -type cube_top top.png\n"]
    {
        assert!(near(seen(nothing, 0.0, false).0, [0, 0, 0]), "{nothing}");
    }
    // A mirror that leans back sees the top, the right, the left and the bottom. Faces may differ
    // in size, and words be in capitals.
    image::RgbImage::from_pixel(4, 8, image::Rgb([80, 5, 175]))
        .save(folder.path().join("top.png"))
        .unwrap();
    let capitals = cube.replace("cube_top", "CUBE_TOP");
    let (top, findings) = seen(&format!("illum 8\n{capitals}"), -0.7, false);
    assert!(near(top, [80, 5, 175]), "{top:?} {findings:?}");
    let (bottom, _) = seen(&format!("illum 8\n{cube}"), 0.7, false);
    assert!(bottom[0].abs_diff(120) < 12, "{bottom:?}");
}

/// A ball of glass, as programs write it: the last corner of each ring lies `seam` beside the
/// first. Before these faces, another group begins.
fn glass_ball(seam: f64, groups: &[usize], left_out: usize) -> String {
    let (rings, columns) = (12, 24);
    let mut text = "mtllib a.mtl\nusemtl glass\n".to_owned();
    for (ring, column) in (0..=rings).flat_map(|i| (0..=columns).map(move |j| (i, j))) {
        let (down, height) = libm::sincos(PI * f64::from(ring) / f64::from(rings));
        let (x, z) = libm::sincos(TAU * f64::from(column % columns) / f64::from(columns));
        let x = if column == columns { -seam } else { x };
        text += &format!("v {:e} {height:e} {:e}\n", down * x, down * z);
    }
    let mut faces = Vec::new();
    for (ring, column) in (0..rings).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let a = ring * (columns + 1) + column + 1;
        let (b, c) = (a + 1, a + columns + 1);
        faces.extend((ring > 0).then(|| format!("f {a} {c} {b}\n")));
        faces.extend((ring + 1 < rings).then(|| format!("f {b} {c} {}\n", c + 1)));
    }
    for (i, face) in faces.iter().enumerate().skip(left_out) {
        if groups.contains(&i) {
            text += &format!("g group{i}\n");
        }
        text += face;
    }
    text
}

#[test]
fn a_body_of_glass_that_a_file_splits_refracts_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.obj");
    let glass = "newmtl glass\nKd 0 0 0\nKs 0 0 0\nTf 1 1 1\nNi 1.5\nillum 7\n";
    std::fs::write(folder.path().join("a.mtl"), glass).unwrap();
    let seen = |text: String| {
        std::fs::write(&path, text).unwrap();
        let loaded = io::load(&path, &LoadOptions::default(), &Progress::new()).unwrap();
        let ball = (loaded.model.into(), at(60.0, 0.0, 0.0, 60.0));
        let (mut scene, view) = scene(&[ball, (cube(), at(70.0, 90.0, 20.0, -120.0))]);
        edit(&mut scene, ObjectId(10), |ball| ball.material = MaterialChoice::File);
        paint(&mut scene, 11, Material::matte([0.2; 3], [0.8, 0.4, 0.1]));
        draw(&scene, &View { marks: false, ..view }, &Settings::default(), SIDE)
    };
    let whole = seen(glass_ball(0.0, &[], 0));
    assert_eq!(seen(glass_ball(0.0, &[100], 0)), whole, "two groups");
    assert_eq!(seen(glass_ball(0.0, &[1, 2, 77, 200], 0)), whole, "five groups");
    assert_eq!(seen(glass_ball(2.5e-16, &[150], 0)), whole, "a seam that is computed in two ways");
    let open = seen(glass_ball(0.0, &[100], 1));
    assert!(differ(&open, &whole).1 > 0.05, "an open surface does not bend light");
}
