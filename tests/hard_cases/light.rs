//! Light, compared with the lighting equation of the oracle along rays.

use glam::{DMat4, DQuat, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{Arithmetic, LightAt, Settings};
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::edit::{GesturePhase, placement};
use marraztu_core::scene::{
    Aim, Command, ItemId, Light, LightId, LightKind, Material, MaterialChoice, MeshSource, NONE,
    ObjectId, Orbit, Scene, SourceCorner, SpotOwner, Tracked, View,
};
use marraztu_lab::instructions::levels;
use marraztu_render::Renderer;
use marraztu_render::plan_frame;
use marraztu_render::simd::{Power, Real as _};

use super::common::{at, ball, draw, edit, model_of, scene, square};
use super::figures::Figure;
use super::oracle::{self, Eye, OracleLight, OracleMaterial, meet, unit};

const SIDE: usize = 96;

/// Replaces the lights of a scene by white lights of these kinds.
fn with_lamps(scene: &mut Scene, lamps: &[OracleLight]) {
    let kind = |lamp: &OracleLight| match *lamp {
        OracleLight::Ambient => LightKind::Ambient,
        OracleLight::Sun(direction) => LightKind::Sun { direction: Tracked::new(direction) },
        OracleLight::Bulb(at) => {
            LightKind::Bulb { position: Tracked::new(at), orbit: Orbit::default() }
        }
        OracleLight::Spot(position, direction, half_aperture, exponent) => {
            let aim = Tracked::new(Aim { position, direction });
            LightKind::Spot { owner: SpotOwner::Fixed(aim), half_aperture, exponent }
        }
    };
    let light = |(lamp, id)| (LightId(id), Light::new("light", id, kind(lamp)));
    scene.lights = lamps.iter().zip(1..).map(light).collect();
}

/// A grey material.
fn stuff(matter: &OracleMaterial) -> MaterialChoice {
    MaterialChoice::Own(Material {
        specular: [matter.specular; 3],
        exponent: matter.exponent,
        ..Material::matte([matter.ambient; 3], [matter.diffuse; 3])
    })
}

/// A curved mirror: a triangle that fills the view, with a different normal at each corner.
struct Bent {
    corners: [DVec3; 3],
    normals: [DVec3; 3],
    matter: OracleMaterial,
    lamps: Vec<OracleLight>,
}

impl Bent {
    fn random(rng: &mut Rng) -> Self {
        // In front of the eye at (0, 0, 400). All numbers are exact in f32.
        let mut leaning = || rng.real(-60.0, 60.0);
        let corners = [
            DVec3::new(-600.0, -500.0, leaning()),
            DVec3::new(700.0, -400.0, leaning()),
            DVec3::new(10.0, 800.0, leaning()),
        ]
        .map(|c| c.as_vec3().as_dvec3());
        let normals = [0, 1, 2]
            .map(|_| unit(DVec3::Z + rng.vector(0.7)).as_vec3().as_dvec3())
            .map(|n| unit(n).as_vec3().as_dvec3());
        let mut about = |size: f64| DVec3::Z * 150.0 + rng.vector(size);
        let spot = about(140.0);
        let lamps = vec![
            OracleLight::Ambient,
            OracleLight::Sun(unit(DVec3::new(0.3, -0.5, -1.0))),
            OracleLight::Bulb(about(140.0)),
            OracleLight::Spot(spot, unit(DVec3::new(10.0, 5.0, 0.0) - spot), 60.0, 5.0),
        ];
        let exponent = rng.one_of(&[1.0, 9.846_15, 27.8974, 76.8, 89.6, 128.0]);
        let matter = OracleMaterial { ambient: 0.05, diffuse: 0.25, specular: 0.2, exponent };
        Self { corners, normals, matter, lamps }
    }

    fn scene(&self, matter: &OracleMaterial) -> (Scene, View) {
        let source = MeshSource {
            positions: self.corners.map(|c| c.as_vec3().to_array()).to_vec(),
            normals: self.normals.map(|n| n.as_vec3().to_array()).to_vec(),
            ..MeshSource::of_polygons(
                [0, 1, 2].map(|i| SourceCorner { position: i, uv: NONE, normal: i }),
                vec![3],
            )
        };
        let (mut scene, view) = scene(&[(model_of("bent", source), DMat4::IDENTITY)]);
        edit(&mut scene, ObjectId(10), |object| object.material = stuff(matter));
        with_lamps(&mut scene, &self.lamps);
        (scene, View { marks: false, light: None, ..view })
    }

    /// The exact light at a pixel centre, along its ray.
    fn exact(&self, x: usize, y: usize, power: &dyn Fn(f64, f64) -> f64) -> f64 {
        let eye = Eye::first(SIDE);
        let ray = eye.ray(x, y);
        let (t, parts) = meet(eye.at, ray, self.corners).expect("it is everywhere");
        let n = (0..3).fold(DVec3::ZERO, |n, i| n + self.normals[i] * parts[i]);
        oracle::light(&self.lamps, &self.matter, [eye.at + ray * t, unit(n), unit(-ray)], power)
    }

    fn draw(&self, matter: &OracleMaterial, arithmetic: Arithmetic) -> Picture {
        let (scene, view) = self.scene(matter);
        draw(&scene, &view, &Settings { arithmetic, ..Settings::default() }, SIDE)
    }

    /// Measures the light at each pixel before rounding, in byte steps, to 1/64. The ambient light
    /// rises in 64 parts of a step; where the byte changes, the light has reached the next
    /// midpoint.
    fn before_rounding(&self, arithmetic: Arithmetic) -> Vec<f64> {
        const PARTS: u32 = 64;
        let picture = |part: u32| {
            let more = f64::from(part) / f64::from(PARTS) / 255.0;
            let matter = OracleMaterial { ambient: self.matter.ambient + more, ..self.matter };
            let picture = self.draw(&matter, arithmetic);
            picture.pixels().iter().map(|pixel| pixel[0]).collect::<Vec<u8>>()
        };
        let first = picture(0);
        let mut turned: Vec<Option<u32>> = vec![None; first.len()];
        for part in 1..=PARTS {
            for (turned, (before, now)) in turned.iter_mut().zip(first.iter().zip(picture(part))) {
                if now > *before {
                    turned.get_or_insert(part);
                }
            }
        }
        let light = |(byte, turned): (&u8, Option<u32>)| {
            // The change happened between the previous part and this one.
            let part = f64::from(turned.unwrap_or(PARTS)) - 0.5;
            f64::from(*byte) + 0.5 - part / f64::from(PARTS)
        };
        first.iter().zip(turned).map(light).collect()
    }
}

#[test]
fn case_42_highlights_lack_the_error_of_a_reciprocal_root_of_twelve_bits() {
    // Compares three results before rounding: the renderer's, a table of 256 powers, and normals
    // normalised by a reciprocal square root of 12 bits.
    let mut rng = Rng::new(42);
    let table = |x: f64, n: f64| ((x * 255.0).floor() / 255.0).powf(n);
    // rsqrtps has a relative error of up to 1.5 2^-12, which enters R.V twice, by N.L and N.V.
    let rough = |x: f64, n: f64| (x * (1.0 - 2.0 * 1.5 / 4096.0)).powf(n);
    let exact = |x: f64, n: f64| x.powf(n);
    let (mut ours, mut reference, mut by_table, mut by_root) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    let (mut bytes, mut differing, mut fast_differing, mut steps) = (0_u32, 0_u32, 0_u32, 0_u8);
    for i in 0..6 {
        let bent = Bent::random(&mut rng);
        let light = bent.before_rounding(Arithmetic::F32);
        let fast = bent.draw(&bent.matter, Arithmetic::F32);
        let slow = bent.draw(&bent.matter, Arithmetic::F64);
        let in_f64 = (i < 2).then(|| bent.before_rounding(Arithmetic::F64));
        for (j, light) in light.iter().enumerate() {
            let (x, y) = (j % SIDE, j / SIDE);
            let right = bent.exact(x, y, &exact) * 255.0;
            // Half of a 64th is below the resolution.
            let off = |light: f64| ((light - right).abs() - 0.5 / 64.0).max(0.0);
            ours = ours.max(off(*light));
            if let Some(light) = &in_f64 {
                reference = reference.max(off(light[j]));
            }
            by_table = by_table.max((bent.exact(x, y, &table) * 255.0 - right).abs());
            by_root = by_root.max((bent.exact(x, y, &rough) * 255.0 - right).abs());
            let byte = (right + 0.5).floor().clamp(0.0, 255.0) as u8;
            bytes += 1;
            steps = steps.max(slow.pixel(x, y)[0].abs_diff(byte));
            differing += u32::from(slow.pixel(x, y)[0] != byte);
            fast_differing += u32::from(fast.pixel(x, y)[0] != byte);
        }
    }
    let percent = |count: u32| 100.0 * f64::from(count) / f64::from(bytes);
    println!("bytes that differ: f64 {}%, f32 {}%", percent(differing), percent(fast_differing));
    for (what, how, naive) in [
        ("light of the editor before rounding, against a table", "a table of 256 powers", by_table),
        ("light of the editor before rounding, against rsqrt", "rsqrt alone, by number", by_root),
    ] {
        Figure { case: 42, what, naive: Some((how, naive)), ours, bound: 0.25, unit: "byte steps" }
            .hold();
    }
    for (what, ours, bound, unit) in [
        ("light in f64 before rounding", reference, 0.02, "byte steps"),
        ("largest difference of a byte in f64", f64::from(steps), 1.0, "byte steps"),
        ("bytes in f64 that are not those of the equation", percent(differing), 0.05, "percent"),
    ] {
        Figure { case: 42, what, naive: None, ours, bound, unit }.hold();
    }
}

#[test]
fn case_43_a_cosine_above_one_does_no_harm() {
    let mut rng = Rng::new(43);
    let above = (0..10_000).filter(|_| {
        let v = rng.vector(1.0).as_vec3();
        let v = v / v.dot(v).sqrt();
        v.dot(v).acos().is_nan()
    });
    let naive = above.count();
    // A spot light at the eye that shines along a pixel's ray, perpendicular to a square. The
    // cosines of cone and highlight are 1 there, or slightly above 1 by rounding.
    const PICTURE: usize = 33;
    let eye = Eye::first(PICTURE);
    let mut dark = 0;
    let mut pixels = 0;
    let mut bright = 0;
    for _ in 0..40 {
        let (x, y) = (rng.index(PICTURE), rng.index(PICTURE));
        let ray = unit(eye.ray(x, y));
        let turn = DMat4::from_quat(DQuat::from_rotation_arc(DVec3::Z, -ray));
        let place = DMat4::from_translation(eye.at + ray * 300.0) * turn * at(90.0, 0.0, 0.0, 0.0);
        let (mut scene, view) = scene(&[(square(), place)]);
        let matter = OracleMaterial { ambient: 0.0, diffuse: 0.0, specular: 1.0, exponent: 1.0 };
        edit(&mut scene, ObjectId(10), |object| object.material = stuff(&matter));
        with_lamps(&mut scene, &[OracleLight::Spot(eye.at, ray, 1.0, 1000.0)]);
        let view = View { marks: false, light: None, ..view };
        // With an exponent of 10^7, a cosine one ulp above 1 would make the highlight three times
        // as bright.
        let mut piercing = scene.clone();
        let sharp = stuff(&OracleMaterial { exponent: 1e7, ..matter });
        edit(&mut piercing, ObjectId(10), |object| object.material = sharp.clone());
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            let settings = Settings { arithmetic, ..Settings::default() };
            let middle = draw(&scene, &view, &settings, PICTURE).pixel(x, y)[0];
            // Attenuation: 1 / (1 + 5e-6 300 + 5e-6 300^2) = 0.689, and 0.689 of 255 is 175.7.
            dark += usize::from(!(170..=178).contains(&middle));
            pixels += 1;
            let shown = draw(&piercing, &view, &settings, PICTURE);
            bright += shown.pixels().iter().filter(|pixel| pixel[0] > 178).count();
        }
    }
    assert_eq!(pixels, 80);
    Figure {
        case: 43,
        what: "pixels where a lamp shines straight at them that are wrongly lit, of 80",
        naive: Some(("acos(v.v) in f32: no number, of 10,000", naive as f64)),
        ours: dark as f64,
        bound: 0.0,
        unit: "times",
    }
    .hold();
    Figure {
        case: 43,
        what: "pixels brighter than the lamp, with an exponent of 10^7",
        naive: None,
        ours: bright as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_44_small_angles_are_shown_as_they_were_typed() {
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    for exponent in 1..=9 {
        let degrees = 1.234_567_8 * 10.0_f64.powi(-exponent);
        let (scene, view) = marraztu_io::default_scene();
        let id = view.object.unwrap();
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let mut scene = scene.clone();
            let typed = axis * degrees;
            let command =
                placement::object_turn(&scene, &view, id, typed, GesturePhase::First).unwrap();
            command.apply(&mut scene).unwrap();
            let m = *scene.objects.get(id).unwrap().placement.now();
            // The placement's matrix gives the angle back.
            let shown = placement::turn_degrees(&m).dot(axis);
            ours = ours.max((shown - degrees).abs() / (degrees * f64::EPSILON));
            // From the trace: the cosine of the angle is (trace - 1) / 2.
            let by_trace = ((m.x_axis.x + m.y_axis.y + m.z_axis.z - 1.0) / 2.0).acos().to_degrees();
            naive = naive.max((by_trace - degrees).abs() / (degrees * f64::EPSILON));
        }
    }
    Figure {
        case: 44,
        what: "angles of 0.1 to 1e-9 degrees, typed and shown",
        naive: Some(("acos of the trace", naive)),
        ours,
        bound: 4.0,
        unit: "ulp",
    }
    .hold();
}

#[test]
fn case_45_undefined_powers_are_zero() {
    let mut wrong = 0;
    for exponent in [0.0, 0.5, 5.0, 76.8, 1000.0] {
        for x in [0.0_f32, -0.0, -1e-45, -0.5, -1.0, f32::NAN, f32::NEG_INFINITY] {
            wrong += usize::from(x.power(&Power::new(exponent, -24.0)) != 0.0);
            // The f64 kernel clamps afterwards, which turns NaN into 0.
            wrong += usize::from(f64::from(x).power(&Power::new(exponent, -24.0)).max(0.0) != 0.0);
        }
    }
    // In a picture: Ns 0 makes a highlight of constant strength wherever R.V is positive, and no
    // highlight if the light is behind the surface.
    let (mut scene, view) = scene(&[(square(), at(90.0, 0.0, 0.0, 0.0))]);
    let matter = OracleMaterial { ambient: 0.0, diffuse: 0.0, specular: 0.5, exponent: 0.0 };
    edit(&mut scene, ObjectId(10), |object| object.material = stuff(&matter));
    let view = View { marks: false, light: None, ..view };
    for (direction, want) in
        [(DVec3::NEG_Z, 128), (unit(DVec3::new(0.3, 0.0, -1.0)), 128), (DVec3::Z, 0)]
    {
        with_lamps(&mut scene, &[OracleLight::Sun(direction)]);
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            let settings = Settings { arithmetic, ..Settings::default() };
            let middle = draw(&scene, &view, &settings, 33).pixel(16, 16)[0];
            wrong += usize::from(middle != want);
        }
    }
    Figure {
        case: 45,
        what: "wrong powers of 0, negative numbers and NaN, with exponents from 0",
        naive: Some(("powf(-0.5, 0.5)", f64::from((-0.5_f32).powf(0.5)))),
        ours: wrong as f64,
        bound: 0.0,
        unit: "times",
    }
    .hold();
}

#[test]
fn case_46_no_power_is_subnormal() {
    let (mut small, mut naive) = (0, 0);
    for exponent in [5.0, 76.8, 128.0, 1000.0] {
        for i in 0..=20_000_u16 {
            let x = f32::from(i) / 20_000.0;
            let power = x.power(&Power::new(exponent, -10.0));
            // 0, or above the floor, apart from rounding.
            small += usize::from(power != 0.0 && power < 0.999 * 2.0_f32.powi(-10));
            naive += usize::from(x.powf(exponent as f32).is_subnormal());
        }
    }
    Figure {
        case: 46,
        what: "powers below the floor of 2^-10, of 80,000",
        naive: Some(("powf in f32: subnormal numbers", naive as f64)),
        ours: small as f64,
        bound: 0.0,
        unit: "times",
    }
    .hold();
}

/// A square that fills the view, lit by these lights.
fn lit_square(lamps: &[OracleLight]) -> (Scene, View) {
    let (mut scene, view) = scene(&[(square(), at(170.0, 0.0, 0.0, 0.0))]);
    let matter = OracleMaterial { ambient: 0.1, diffuse: 0.6, specular: 0.5, exponent: 20.0 };
    edit(&mut scene, ObjectId(10), |object| object.material = stuff(&matter));
    with_lamps(&mut scene, lamps);
    (scene, View { marks: false, light: None, ..view })
}

#[test]
fn case_47_a_lamp_on_a_surface_is_the_same_on_all_instructions_and_spoils_nothing() {
    // On the surface at a pixel centre, and slightly above and below it.
    let eye = Eye::first(65);
    let ray = eye.ray(32, 32);
    let touching = eye.at + ray * 400.0;
    let (mut differ, mut black) = (0, 0);
    for above in [0.0, 1e-300, 1e-30, 1e-12, -1e-12, 1e-5, -1e-5] {
        let at = touching + DVec3::Z * above;
        for lamp in [OracleLight::Bulb(at), OracleLight::Spot(at, DVec3::NEG_Z, 90.0, 5.0)] {
            let (scene, view) = lit_square(&[OracleLight::Ambient, lamp]);
            for light in [LightAt::Pixel, LightAt::Vertex, LightAt::Face] {
                let settings = Settings { light, ..Settings::default() };
                let plan = plan_frame(&Shot::new(&scene, &view, &settings, Size::new(65, 65)));
                // Every instruction set draws the same bytes.
                let pictures: Vec<Picture> = levels()
                    .into_iter()
                    .map(|level| Renderer::new(level).render(&plan).clone())
                    .collect();
                differ += pictures.windows(2).filter(|pair| pair[0] != pair[1]).count();
                // Ambient light of 0.1, or 26 steps, reaches every pixel.
                let dark = |pixel: &&[u8; 4]| pixel[0] < 25 && **pixel != [0, 0, 179, 255];
                black += pictures[0].pixels().iter().filter(dark).count();
            }
        }
    }
    Figure {
        case: 47,
        what: "pictures that differ and pixels that are dark with a lamp on a surface",
        naive: Some(("the way to the lamp by its length", (DVec3::ZERO / DVec3::ZERO.length()).x)),
        ours: (differ + black) as f64,
        bound: 0.0,
        unit: "times",
    }
    .hold();
}

/// Widens the highlight, which then reaches where a narrow one ends.
fn soften(scene: &mut Scene) {
    let matter = OracleMaterial { ambient: 0.1, diffuse: 0.6, specular: 0.5, exponent: 2.0 };
    edit(scene, ObjectId(10), |object| object.material = stuff(&matter));
}

#[test]
fn case_48_a_highlight_ends_where_a_round_surface_turns_away() {
    const RADIUS: f64 = 100.0;
    let ball = ball(48);
    let picture = |lamps: &[OracleLight]| {
        let (mut scene, view) = scene(&[(ball.clone(), at(RADIUS, 0.0, 0.0, 0.0))]);
        soften(&mut scene);
        with_lamps(&mut scene, lamps);
        draw(&scene, &View { marks: false, light: None, ..view }, &Settings::default(), SIDE)
    };
    let dark = picture(&[OracleLight::Ambient]);
    let eye = Eye::first(SIDE);
    // The normal where a pixel's ray meets the ball.
    let normal = |i: usize| {
        let ray = unit(eye.ray(i % SIDE, i / SIDE));
        let along = -eye.at.dot(ray);
        let half = RADIUS * RADIUS - (eye.at + ray * along).length_squared();
        (half > 0.0).then(|| (eye.at + ray * (along - half.sqrt())) / RADIUS)
    };
    let mut rng = Rng::new(148);
    let (mut differ, mut naive) = (0, 0);
    for _ in 0..20 {
        let to_light =
            unit(DVec3::new(rng.real(-1.0, 1.0), rng.real(-1.0, 1.0), rng.real(-0.9, 0.3)));
        let lit = picture(&[OracleLight::Ambient, OracleLight::Sun(-to_light)]);
        for i in 0..SIDE * SIDE {
            // The polygons of the ball differ from its surface by at most 0.03 in N.L.
            let Some(n) = normal(i).filter(|n| n.dot(to_light) < -0.05) else { continue };
            differ += usize::from(lit.pixels()[i] != dark.pixels()[i]);
            // The naive highlight ignores the sign of N.L.
            let mirrored = n * (2.0 * n.dot(to_light)) - to_light;
            let v = unit(-eye.ray(i % SIDE, i / SIDE));
            naive += usize::from(0.5 * mirrored.dot(v).max(0.0).powi(2) > 1.0 / 255.0);
        }
    }
    Figure {
        case: 48,
        what: "pixels of a ball's dark side that a lamp changes",
        naive: Some(("a highlight wherever R.V is above 0", naive as f64)),
        ours: differ as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_48_a_lamp_behind_a_surface_leaves_it_as_it_is() {
    let dark = {
        let (mut scene, view) = lit_square(&[OracleLight::Ambient]);
        soften(&mut scene);
        draw(&scene, &view, &Settings::default(), SIDE)
    };
    let mut rng = Rng::new(48);
    let (mut differ, mut naive) = (0, 0);
    for _ in 0..60 {
        let behind =
            DVec3::new(rng.real(-90.0, 90.0), rng.real(-90.0, 90.0), rng.real(-200.0, -1.0));
        let direction =
            unit(DVec3::new(rng.real(-1.0, 1.0), rng.real(-1.0, 1.0), rng.real(0.01, 1.0)));
        let lamps = [
            OracleLight::Ambient,
            OracleLight::Bulb(behind),
            OracleLight::Sun(direction),
            OracleLight::Spot(behind, DVec3::Z, 80.0, 1.0),
        ];
        let (mut scene, view) = lit_square(&lamps);
        soften(&mut scene);
        let picture = draw(&scene, &view, &Settings::default(), SIDE);
        differ += picture.pixels().iter().zip(dark.pixels()).filter(|(a, b)| a != b).count();
        // Without the condition on N.L: R.V can be positive even if the light is behind.
        let eye = Eye::first(SIDE);
        for i in 0..SIDE * SIDE {
            let v = unit(-eye.ray(i % SIDE, i / SIDE));
            let to_light = -direction;
            let mirrored = DVec3::Z * (2.0 * to_light.z) - to_light;
            naive += usize::from(
                to_light.z < 0.0 && 0.5 * mirrored.dot(v).max(0.0).powi(2) > 1.0 / 255.0,
            );
        }
    }
    Figure {
        case: 48,
        what: "pixels that lamps behind a surface change",
        naive: Some(("a highlight wherever R.V is above 0", naive as f64)),
        ours: differ as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_49_a_wider_cone_lights_no_pixel_less() {
    let from = DVec3::new(30.0, 40.0, 120.0);
    let axis = unit(DVec3::new(-0.2, -0.1, -1.0));
    let mut before: Option<Picture> = None;
    let (mut less, mut lit_by_none, mut wrong) = (0, 0, 0);
    for half_aperture in (0..=90).map(f64::from) {
        let lamps = [OracleLight::Spot(from, axis, half_aperture, 5.0)];
        let (scene, view) = lit_square(&lamps);
        let picture = draw(&scene, &view, &Settings::default(), SIDE);
        // A wider cone may only add light.
        if let Some(before) = &before {
            let pairs = before.pixels().iter().zip(picture.pixels());
            less += pairs.filter(|(a, b)| b[0] < a[0]).count();
        } else {
            lit_by_none =
                picture.pixels().iter().filter(|pixel| pixel[0] > 0 && pixel[2] != 179).count();
        }
        // The border of the cone is where the equation has it, to 0.01 degrees.
        let eye = Eye::first(SIDE);
        for i in 0..SIDE * SIDE {
            let ray = eye.ray(i % SIDE, i / SIDE);
            let place = eye.at + ray * 400.0;
            if place.x.abs().max(place.y.abs()) > 169.0 {
                continue;
            }
            let angle = oracle::angle(place - from, axis).to_degrees();
            let lit = picture.pixels()[i][0] > 0;
            wrong += usize::from(angle < half_aperture - 0.01 && angle < 60.0 && !lit);
            wrong += usize::from(angle > half_aperture + 0.01 && lit);
        }
        before = Some(picture);
    }
    assert_eq!((less, lit_by_none), (0, 0), "a wider cone darkens, or one of 0 degrees lights");
    Figure {
        case: 49,
        what: "pixels on the wrong side of a cone's border, for 0 to 90 degrees",
        naive: None,
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_50_the_order_of_lights_does_not_show() {
    let mut rng = Rng::new(50);
    let mut lamps = vec![OracleLight::Ambient];
    for _ in 0..9 {
        lamps.push(OracleLight::Bulb(DVec3::Z * 150.0 + rng.vector(120.0)));
    }
    let (mut scene, view) = scene(&[(ball(16), at(120.0, 0.0, 0.0, 0.0))]);
    // Three channels with different digits: about one byte in 100,000 is so close to a rounding
    // border that the last bit of a sum decides.
    let material = Material {
        specular: [0.07, 0.05, 0.09],
        exponent: 9.0,
        ..Material::matte([0.03, 0.041, 0.023], [0.11, 0.13, 0.17])
    };
    edit(&mut scene, ObjectId(10), |object| object.material = MaterialChoice::Own(material));
    with_lamps(&mut scene, &lamps);
    let view = View { marks: false, light: None, ..view };
    let first = draw(&scene, &view, &Settings::default(), 512);
    let mut differ = 0;
    for _ in 0..30 {
        let id = ItemId::Light(LightId(1 + rng.below(10) as u32));
        Command::Reorder { id, to: rng.index(10) }.apply(&mut scene).unwrap();
        let now = draw(&scene, &view, &Settings::default(), 512);
        differ += first.pixels().iter().zip(now.pixels()).filter(|(a, b)| a != b).count();
    }
    // Sums of ten f32 numbers in two orders.
    let sums = (0..10_000).filter(|_| {
        let parts: Vec<f32> = (0..10).map(|_| rng.unit() as f32).collect();
        parts.iter().sum::<f32>() != parts.iter().rev().sum::<f32>()
    });
    Figure {
        case: 50,
        what: "pixels that change in 30 shuffles of ten lights",
        naive: Some((
            "sums of ten in f32 that their order changes, of 10,000",
            sums.count() as f64,
        )),
        ours: differ as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_51_light_is_held_to_full_once_and_after_the_texture() {
    // Two suns of 1 each on a surface of 1, times a texel of 1/2: the product 2 x 1/2 is full
    // light.
    let (mut scene, view) =
        lit_square(&[OracleLight::Sun(DVec3::NEG_Z), OracleLight::Sun(DVec3::NEG_Z)]);
    let matter = OracleMaterial { ambient: 0.0, diffuse: 1.0, specular: 0.0, exponent: 1.0 };
    let texture = super::clipping::ruler(1.0);
    let source = MeshSource {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]],
        uvs: vec![[0.502, 0.5]],
        ..MeshSource::of_polygons(
            [0, 1, 2].map(|i| SourceCorner { position: i, uv: 0, normal: NONE }),
            vec![3],
        )
    };
    edit(&mut scene, ObjectId(10), |object| {
        object.material = stuff(&matter);
        object.model = model_of("half", source);
        object.texture = Some(texture);
    });
    let mut off = 0.0_f64;
    for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
        for light in [LightAt::Pixel, LightAt::Vertex, LightAt::Face] {
            let settings = Settings {
                arithmetic,
                light,
                filter: marraztu_core::accuracy::Filter::Nearest,
                ..Settings::default()
            };
            let middle = draw(&scene, &view, &settings, 33).pixel(16, 18)[0];
            // The texel is 128.
            off = off.max((f64::from(middle) - 2.0 * 128.0_f64.min(127.5)).abs());
        }
    }
    Figure {
        case: 51,
        what: "twice full light on a texture of a half",
        naive: Some(("light held to full before the texture", 127.0)),
        ours: off,
        bound: 0.5,
        unit: "byte steps",
    }
    .hold();
}
