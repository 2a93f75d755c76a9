//! Shadows after a change: which parts are redrawn, traced again, or kept.

use super::*;

#[test]
fn a_moved_object_takes_the_tiles_of_its_shadow_and_no_others() {
    let lying = DMat4::from_rotation_x(-90_f64.to_radians()) * at(400.0, 0.0, 0.0, 0.0);
    let floor = DMat4::from_translation(DVec3::new(0.0, -60.0, 0.0)) * lying;
    let (mut scene, view) = scene(&[(square(), floor), (ball(6), at(15.0, -60.0, -20.0, 0.0))]);
    let view = View { marks: false, ..view };
    let size = Size::new(640, 640);
    // Sun and bulb cast shadows; spots are removed, because they follow the selection.
    for (id, light) in
        scene.lights.iter().map(|(id, light)| (id, light.clone())).collect::<Vec<_>>()
    {
        let command = match light.kind {
            LightKind::Sun { .. } | LightKind::Bulb { .. } => {
                lights::toggle_shadows(&scene, id).unwrap()
            }
            LightKind::Ambient | LightKind::Sky { .. } => continue,
            LightKind::Spot { .. } => Command::Remove(ItemId::Light(id)),
        };
        command.apply(&mut scene).unwrap();
    }
    let plan = |scene: &Scene| plan_frame(&Shot::new(scene, &view, &Settings::default(), size));
    let mut renderer = Renderer::default();
    let mut last = renderer.render(&plan(&scene)).clone();
    let mut least = usize::MAX;
    // The ball moves twice, then out of view.
    for place in [DVec3::new(-50.0, -20.0, 5.0), DVec3::new(40.0, 10.0, -60.0), DVec3::Y * 300.0] {
        edit(&mut scene, ObjectId(11), |object| {
            let placement = DMat4::from_translation(place) * at(15.0, 0.0, 0.0, 0.0);
            object.placement = object.placement.replaced(placement);
        });
        let changes = renderer.redraw(&plan(&scene), &|| true).unwrap();
        let mut fresh = Renderer::default();
        assert!(fresh.render(&plan(&scene)) == renderer.picture(), "{changes:?}");
        assert!(last != *renderer.picture() && fresh.rays().traced > 1000);
        last = renderer.picture().clone();
        least = least.min(changes.tiles() * 100 / changes.tiles_in_all());
    }
    assert!(least < 50, "at least {least} of 100 tiles are drawn again");
}

/// A floor with two balls above it, under a sun, a bulb and a spot that cast shadows.
fn shaded_stage() -> (Scene, View) {
    let lying = DMat4::from_rotation_x(-90_f64.to_radians()) * at(400.0, 0.0, 0.0, 0.0);
    let floor = DMat4::from_translation(DVec3::new(0.0, -60.0, 0.0)) * lying;
    let (mut scene, view) = scene(&[
        (square(), floor),
        (ball(6), at(15.0, -60.0, -20.0, 0.0)),
        (ball(6), at(25.0, 50.0, 0.0, 0.0)),
    ]);
    for id in scene.lights.ids().collect::<Vec<_>>() {
        if let Ok(command) = lights::toggle_shadows(&scene, id) {
            command.apply(&mut scene).unwrap();
        }
    }
    (scene, View { marks: false, ..view })
}

/// Changes the first light for which `change` returns true.
fn change_light(scene: &mut Scene, mut change: impl FnMut(&mut Light) -> bool) {
    let all: Vec<_> = scene.lights.iter().map(|(id, light)| (id, light.clone())).collect();
    for (id, mut light) in all {
        if change(&mut light) {
            let item = Item::Light(id, Box::new(light));
            Command::Replace(item).apply(scene).unwrap();
            return;
        }
    }
    panic!("no light is changed");
}

/// Redraws a changed scene, and returns the rays it traced in percent of a full picture.
fn rays_again(
    (scene, view): (&mut Scene, &View),
    settings: &Settings,
    change: &mut dyn FnMut(&mut Scene),
) -> u64 {
    let size = Size::new(640, 480);
    let plan = |scene: &Scene| plan_frame(&Shot::new(scene, view, settings, size));
    let mut renderer = Renderer::default();
    renderer.render(&plan(scene));
    change(scene);
    let damage = renderer.redraw(&plan(scene), &|| true).unwrap();
    let mut fresh = Renderer::default();
    assert!(fresh.render(&plan(scene)) == renderer.picture(), "{damage:?}");
    assert!(fresh.rays().traced > 100_000, "{:?}", fresh.rays());
    renderer.rays().traced * 100 / fresh.rays().traced
}

/// Catches: shadows kept for a picture of another size.
#[test]
fn shadows_are_not_kept_for_a_picture_of_another_size() {
    let (mut scene, view) = shaded_stage();
    let settings = Settings::default();
    let mut renderer = Renderer::default();
    for (i, [width, height]) in [[640, 480], [64, 64], [700, 300], [640, 480]].iter().enumerate() {
        edit(&mut scene, ObjectId(11), |object| {
            let step = DMat4::from_translation(DVec3::X * i as f64);
            object.placement = object.placement.replaced(step * *object.placement.now());
        });
        let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(*width, *height)));
        renderer.redraw(&plan, &|| true).unwrap();
        let mut fresh = Renderer::default();
        assert!(fresh.render(&plan) == renderer.picture(), "{width} x {height}");
    }
}

/// Catches: a light traced again because another one moved or its own colour changed; rays for the
/// whole picture when one object moves; shadows kept after their caster, their light or the visible
/// surface has changed.
#[test]
fn only_changed_shadows_are_traced_again() {
    let settings = Settings::default();
    let again = |change: &mut dyn FnMut(&mut Scene)| {
        let (mut scene, view) = shaded_stage();
        rays_again((&mut scene, &view), &settings, change)
    };
    // A colour, a light switched off and a material need no rays.
    let recoloured = again(&mut |scene| {
        change_light(scene, |light| {
            light.color = Color([90, 200, 30]);
            matches!(light.kind, LightKind::Bulb { .. })
        });
    });
    assert_eq!(recoloured, 0, "a colour");
    let off = again(&mut |scene| {
        change_light(scene, |light| {
            light.on = false;
            matches!(light.kind, LightKind::Bulb { .. })
        });
    });
    assert_eq!(off, 0, "a light that is off");
    let dressed = again(&mut |scene| {
        edit(scene, ObjectId(11), |object| {
            object.material = MaterialChoice::Preset(PresetId::named("jade").unwrap());
        });
    });
    assert_eq!(dressed, 0, "a material");
    // A moved light is traced again alone; a moved object, where its shadow was or is.
    let bulb = again(&mut |scene| {
        change_light(scene, |light| match &mut light.kind {
            LightKind::Bulb { position, .. } => {
                *position = position.replaced(*position.now() + DVec3::new(9.0, 5.0, 1.0));
                true
            }
            LightKind::Ambient
            | LightKind::Sky { .. }
            | LightKind::Sun { .. }
            | LightKind::Spot { .. } => false,
        });
    });
    assert!((5..60).contains(&bulb), "{bulb}% for a bulb that moves");
    let ball = again(&mut |scene| {
        edit(scene, ObjectId(11), |object| {
            let placement = DMat4::from_translation(DVec3::X * 9.0) * *object.placement.now();
            object.placement = object.placement.replaced(placement);
        });
    });
    assert!((1..70).contains(&ball), "{ball}% for an object that moves");
    let hidden = again(&mut |scene| {
        edit(scene, ObjectId(12), |object| object.hidden_parts.extend([0]));
    });
    assert!((1..70).contains(&hidden), "{hidden}% for an object that goes");
}

/// The shadow casters stay the same, but other surfaces become visible.
#[test]
fn a_back_face_that_becomes_visible_gets_shadows() {
    let (mut scene, view) = shaded_stage();
    let mut wall = scene.objects.get(ObjectId(10)).unwrap().clone();
    let turned = DMat4::from_rotation_y(std::f64::consts::PI);
    wall.placement = wall.placement.replaced(at(60.0, 0.0, -30.0, 60.0) * turned);
    wall.sides = Sides::One;
    let item = Item::Object(ObjectId(13), Box::new(wall));
    Command::Insert { at: usize::MAX, item }.apply(&mut scene).unwrap();
    let again = rays_again((&mut scene, &view), &Settings::default(), &mut |scene| {
        edit(scene, ObjectId(13), |wall| wall.sides = Sides::Two);
    });
    assert!((1..70).contains(&again), "{again}%");
}
