//! The list of a frame's effects agrees with the frame.

use glam::{DMat4, DQuat, DVec3};
use marraztu_core::accuracy::{LightAt, Settings, Shot};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Size;
use marraztu_core::edit::{framing, items};
use marraztu_core::scene::{
    Command, Fill, Item, ItemId, LightKind, LoadOptions, MaterialChoice, Object, Scene, Sides,
    Tracked, View,
};
use marraztu_io as io;
use marraztu_lab::cost;
use marraztu_render::explain_frame;
use marraztu_render::plan_frame;
use marraztu_render::{Effect, EffectUse, Renderer};

use crate::random_scenes::random_scene;

const SIZE: Size = Size::new(160, 120);

fn first() -> (Scene, View) {
    let (scene, view) = io::default_scene();
    (scene, View { marks: false, ..view })
}

#[test]
fn every_pixel_that_shows_something_is_counted_once_under_surfaces() {
    for seed in 0..300 {
        let it = random_scene(seed);
        // Lines are counted by other tests, and black objects would be invisible on a black
        // background.
        let view = View { marks: true, fill: Fill::Filled, ..it.view.clone() };
        let explained = cost::explain(&Shot::new(&it.scene, &view, &it.settings, it.size));
        let present = |effect: Effect| matches!(effect, Effect::Surfaces | Effect::Marks);
        let uses = explained.uses.iter().filter(|one| present(one.effect));
        let counted: u64 = uses.filter_map(|one| one.pixels).sum();
        let plan = plan_frame(&Shot::new(&it.scene, &view, &it.settings, it.size));
        let mut renderer = Renderer::default();
        renderer.render(&plan);
        let lines = view.edges_over_fill || view.face_normals || view.vertex_normals;
        let items = it.scene.objects.ids().map(ItemId::Object);
        let items = items.chain(it.scene.cameras.ids().map(ItemId::Camera));
        let items = items.chain(it.scene.lights.ids().map(ItemId::Light));
        let seen: usize =
            items.map(|item| renderer.pixels_of(item).into_iter().filter(|own| *own).count()).sum();
        if lines {
            assert!(counted <= seen as u64, "scene {seed}");
        } else {
            assert_eq!(counted, seen as u64, "scene {seed}");
        }
    }
}

#[test]
fn a_plan_is_the_same_whether_its_decisions_are_explained_or_not() {
    for seed in 0..2_000 {
        let it = random_scene(seed);
        let shot = Shot::new(&it.scene, &it.view, &it.settings, it.size);
        assert!(plan_frame(&shot) == explain_frame(&shot).0, "scene {seed}");
    }
}

#[test]
fn exactly_the_objects_in_view_are_planned() {
    let (mut scene, view) = first();
    let original = scene.objects.iter().next().expect("there is one").1.clone();
    let around = (0..400_u32).map(|i| {
        let direction = DQuat::from_rotation_y(f64::from(i) * 2.399_963) * DVec3::Z;
        let place =
            DVec3::new(0.0, f64::from(i) - 200.0, 400.0) + direction * f64::from(i % 40) * 50.0;
        let mut object = original.clone();
        object.placement = Tracked::new(DMat4::from_translation(place));
        object
    });
    items::insert_objects(&scene, around.collect()).apply(&mut scene).expect("they fit");
    let settings = Settings::default();
    let drawn = |scene: &Scene| {
        let shot = Shot::new(scene, &view, &settings, SIZE);
        let (explained, plan) = (explain_frame(&shot).0, plan_frame(&shot));
        assert!(plan == explained);
        let shown = explain_frame(&shot).1;
        shown.iter().filter(|one| one.effect == Effect::Surfaces && one.state.is_on()).count()
    };
    let before = drawn(&scene);
    assert!((20..200).contains(&before), "{before}");
    // An object that was outside the view moves into it: the kept data has no entry for it.
    let id = scene.objects.ids().last().expect("there is one");
    let mut moved = scene.objects.get(id).expect("it is there").clone();
    let far = DVec3::new(0.0, 5_000.0, 0.0);
    moved.placement = Tracked::new(DMat4::from_translation(far));
    Command::Replace(Item::Object(id, Box::new(moved.clone())))
        .apply(&mut scene)
        .expect("it is there");
    let without = drawn(&scene);
    moved.placement = Tracked::new(DMat4::IDENTITY);
    Command::Replace(Item::Object(id, Box::new(moved))).apply(&mut scene).expect("it is there");
    assert_eq!(drawn(&scene), without + 1);
}

#[test]
fn an_effect_can_be_removed_from_a_plan_exactly_if_it_is_on() {
    let (scene, view) = first();
    let settings = Settings::default();
    let (plan, uses) = explain_frame(&Shot::new(&scene, &view, &settings, SIZE));
    let on = |effect: Effect| uses.iter().any(|one| one.effect == effect && one.state.is_on());
    for one in &uses {
        let without = plan.without(one.effect);
        match one.effect {
            Effect::Normals => assert!(without.is_none()),
            effect => assert_eq!(without.is_some(), on(effect), "{effect:?}"),
        }
    }
}

#[test]
fn a_light_that_reaches_one_object_of_three_is_on_there_and_nowhere_else() {
    let (scene, view) = first();
    // The spot of the selected object shines along -Z, past the object next to it.
    let uses = cost::explain(&Shot::new(&scene, &view, &Settings::default(), SIZE)).uses;
    let spot = scene.lights.iter().find_map(|(id, light)| {
        (light.name == "object spot" && matches!(light.kind, LightKind::Spot { .. })).then_some(id)
    });
    let spot = spot.unwrap();
    let of_spot: Vec<_> = uses.iter().filter(|one| one.effect == Effect::Light(spot)).collect();
    assert_eq!(of_spot.len(), 3);
    let reasons: Vec<&str> =
        of_spot.iter().filter(|one| !one.state.is_on()).map(|one| one.state.why()).collect();
    assert!(reasons.contains(&"nothing is within its cone"), "{of_spot:?}");
}

#[test]
fn maps_of_ns_need_light_at_pixels() {
    let opened =
        io::open("assets/effects/everything.marraztu".as_ref(), &io::Progress::new()).unwrap();
    for (light, why) in [
        (LightAt::Pixel, "map_Ks, map_Ns"),
        (LightAt::Vertex, "map_Ks; map_Ns needs light at pixels"),
        (LightAt::Face, "map_Ks; map_Ns needs light at pixels"),
    ] {
        let settings = Settings { light, ..opened.settings };
        let shot = Shot::new(&opened.scene, &opened.view, &settings, SIZE);
        let uses = explain_frame(&shot).1;
        let is_on = |one: &&EffectUse| one.effect == Effect::Maps && one.state.is_on();
        let maps = uses.iter().find(is_on).unwrap();
        assert_eq!(maps.state.why(), why, "{light:?}");
    }
}

#[test]
fn an_open_surface_seen_from_the_front_is_not_called_closed() {
    let text = b"v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
    let loaded = io::parse(text, "a", None, &LoadOptions::default(), &io::Progress::new());
    let model = Shared::new(loaded.unwrap().model);
    for (degrees, why) in [(0.0_f64, "no back is visible"), (180.0, "lit: the surface is open")] {
        let mut object = Object::new(model.clone(), MaterialChoice::File);
        object.sides = Sides::Auto;
        object.placement = Tracked::new(DMat4::from_rotation_y(degrees.to_radians()));
        let (mut scene, view) = io::empty_scene();
        items::insert_object(&scene, object).apply(&mut scene).unwrap();
        framing::all(&scene, &view).unwrap().apply(&mut scene).unwrap();
        let uses = explain_frame(&Shot::new(&scene, &view, &Settings::default(), SIZE)).1;
        let backs = uses.iter().find(|one| one.effect == Effect::BackFaces).unwrap();
        assert_eq!(backs.state.why(), why);
    }
}

#[test]
fn in_edges_alone_no_surface_is_lit() {
    let (scene, view) = first();
    let view = View { fill: Fill::Edges, ..view };
    let (plan, uses) = explain_frame(&Shot::new(&scene, &view, &Settings::default(), SIZE));
    assert_eq!(plan.keys(), ["flat"]);
    assert!(uses.iter().all(|one| one.effect != Effect::Highlights));
    let surfaces: Vec<_> = uses.iter().filter(|one| one.effect == Effect::Surfaces).collect();
    assert!(surfaces.iter().all(|one| one.state.why() == "edges only"));
}
