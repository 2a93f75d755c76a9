//! Compares light shaders with numbers from external sources: the two arithmetics cannot check each
//! other's equations.

#![expect(clippy::cast_possible_truncation, reason = "the nearest f32 is meant")]
#![expect(clippy::needless_range_loop, reason = "three rows go side by side")]

use fearless_simd::Level;

use super::*;
use crate::simd::{BATCH, Number, Power};

fn one(position: [f64; 3], normal: [f64; 3]) -> Batch<f64> {
    let mut batch = Batch { len: 1, ..Batch::default() };
    for axis in 0..3 {
        batch.position[axis][0] = position[axis];
        batch.normal[axis][0] = normal[axis];
    }
    batch.to_eye[2][0] = 1.0;
    batch
}

fn material() -> PhongMaterial {
    PhongMaterial {
        ambient: [0.1, 0.2, 0.3],
        diffuse: [0.5; 3],
        specular: [0.25; 3],
        exponent: 2.0,
        ..PhongMaterial::default()
    }
    .with_floor(-24.0)
}

fn light() -> ViewLight {
    ViewLight {
        color: [1.0, 0.5, 0.0],
        direction: [0.0, 0.0, -1.0],
        attenuation: [1.0, 0.0, 0.0],
        cos_half_aperture: 0.9,
        exponent: 5.0,
        ..ViewLight::default()
    }
}

fn term<T: Number>(entry: &LightRow, form: Form, light: &ViewLight) -> LightTerm<T> {
    let material = material();
    let highlight = Power::new(material.exponent, material.floor);
    LightTerm::new(light, &material, highlight, (entry.which, form, false))
}

fn run(entry: &LightRow, batch: &mut Batch<f64>, light: &ViewLight) -> [[f64; 3]; 2] {
    add_light(Level::new(), batch, &term(entry, Form::Reflection, light));
    [batch.diffuse.map(|row| row[0]), batch.specular.map(|row| row[0])]
}

fn near(got: [[f64; 3]; 2], want: [[f64; 3]; 2]) {
    for (got, want) in got.as_flattened().iter().zip(want.as_flattened()) {
        assert!((got - want).abs() < 1e-12, "{got} for {want}");
    }
}

#[test]
fn ambient_light_is_its_colour_times_ka() {
    let got = run(&AMBIENT, &mut one([0.0; 3], [0.0; 3]), &light());
    near(got, [[0.1, 0.1, 0.0], [0.0; 3]]);
}

#[test]
fn the_sun_at_sixty_degrees_gives_half_and_mirrors_by_the_angle_of_reflection() {
    // N is 60 degrees from both L and V, which are equal: R.V = 2 cos^2 60 - 1 = -1/2: none.
    let (s, c) = (0.75_f64.sqrt(), 0.5);
    let got = run(&SUN, &mut one([0.0; 3], [s, 0.0, c]), &light());
    near(got, [[0.25, 0.125, 0.0], [0.0; 3]]);
    // At 30 degrees: N.L = cos 30, R.V = cos 60 = 1/2, squared 1/4.
    let got = run(&SUN, &mut one([0.0; 3], [c, 0.0, s]), &light());
    near(got, [[0.5 * s, 0.25 * s, 0.0], [0.0625, 0.03125, 0.0]]);
}

#[test]
fn a_surface_turned_away_gets_nothing() {
    let got = run(&SUN, &mut one([0.0; 3], [0.0, 0.0, -1.0]), &light());
    near(got, [[0.0; 3]; 2]);
}

#[test]
fn a_lamp_in_the_plane_of_a_face_gives_it_no_highlight_whichever_way_rounding_goes() {
    // N.L is a rounding error above or below 0, seen along the mirrored ray.
    for error in [-1e-7, 1e-7] {
        let mut batch = one([0.0; 3], [error, 1.0, 0.0]);
        batch.to_eye = batch.to_eye.map(|mut row| {
            row[0] = 0.0;
            row
        });
        batch.to_eye[0][0] = -1.0;
        let along = ViewLight { position: [50.0, 0.0, 0.0], ..light() };
        let [diffuse, specular] = run(&BULB, &mut batch, &along);
        assert_eq!(specular, [0.0; 3]);
        assert!(diffuse[0] < 1e-6);
    }
}

#[test]
fn a_bulb_fades_by_its_coefficients_and_adds_nothing_at_its_own_place() {
    let bulb = ViewLight { position: [0.0, 0.0, 3.0], attenuation: [1.0, 2.0, 3.0], ..light() };
    // d = 3: 1 / (1 + 6 + 27).
    let got = run(&BULB, &mut one([0.0; 3], [0.0, 0.0, 1.0]), &bulb);
    near(got, [[0.5 / 34.0, 0.25 / 34.0, 0.0], [0.25 / 34.0, 0.125 / 34.0, 0.0]]);
    let got = run(&BULB, &mut one([0.0, 0.0, 3.0], [0.0, 0.0, 1.0]), &bulb);
    near(got, [[0.0; 3]; 2]);
}

#[test]
fn a_spot_gives_the_fifth_power_of_the_cosine_inside_its_cone_and_nothing_outside() {
    // The axis runs along -Z from (0, 0, 1). The position is aside so the cosine is 0.8 or 0.95.
    for (cosine, border, part) in [(0.8_f64, 0.9, 0.0), (0.8, 0.79, 0.8_f64.powi(5))] {
        let aside = (1.0 / (cosine * cosine) - 1.0).sqrt();
        let spot = ViewLight { position: [aside, 0.0, 1.0], cos_half_aperture: border, ..light() };
        let got = run(&SPOT, &mut one([0.0; 3], [0.0, 0.0, 1.0]), &spot);
        assert!((got[0][0] - 0.5 * cosine * part).abs() < 1e-12, "{cosine}: {got:?}");
    }
}

#[test]
fn fast_light_is_near_the_reference_and_the_same_on_every_level() {
    let levels = crate::simd::levels();
    for entry in [&AMBIENT, &SUN, &BULB, &SPOT] {
        for form in [Form::Plain, Form::Reflection, Form::HalfVector] {
            let (mut exact, light) =
                (scattered(), ViewLight { position: [1.0, 2.0, 3.0], ..light() });
            add_light::<f64>(Level::new(), &mut exact, &term(entry, form, &light));
            let pictures = levels.iter().map(|level| {
                let mut fast = narrow(&scattered());
                add_light::<f32>(*level, &mut fast, &term(entry, form, &light));
                [fast.diffuse, fast.specular]
            });
            let pictures: Vec<_> = pictures.collect();
            assert!(pictures.windows(2).all(|pair| pair[0] == pair[1]), "{}", entry.name);
            let exact = [exact.diffuse, exact.specular];
            for (fast, exact) in flat(&pictures[0]).zip(flat(&exact)) {
                assert!((f64::from(*fast) - exact).abs() < 1e-5, "{}: {fast} {exact}", entry.name);
            }
        }
    }
}

fn flat<T>(rows: &[[[T; BATCH]; 3]; 2]) -> impl Iterator<Item = &T> {
    rows.as_flattened().as_flattened().iter()
}

/// Scattered positions and normals, none of them at the border of a cone.
fn scattered() -> Batch<f64> {
    let mut batch = Batch { len: BATCH, ..Batch::default() };
    for i in 0..BATCH {
        let t = i as f64;
        let unit = |x: f64, y: f64, z: f64| {
            let length = (x * x + y * y + z * z).sqrt();
            [x / length, y / length, z / length]
        };
        let rows = [
            [(t * 0.7).sin() * 3.0, (t * 0.3).cos() * 3.0, -t * 0.1],
            unit((t * 1.1).sin(), (t * 0.9).cos(), 0.4 + (t * 0.2).sin()),
            unit((t * 0.5).sin() * 0.3, (t * 0.4).cos() * 0.3, 1.0),
        ];
        for axis in 0..3 {
            batch.position[axis][i] = rows[0][axis];
            batch.normal[axis][i] = rows[1][axis];
            batch.to_eye[axis][i] = rows[2][axis];
        }
    }
    batch
}

fn narrow(batch: &Batch<f64>) -> Batch<f32> {
    let rows = |rows: &[[f64; BATCH]; 3]| rows.map(|row| row.map(|x| x as f32));
    Batch {
        len: batch.len,
        position: rows(&batch.position),
        normal: rows(&batch.normal),
        to_eye: rows(&batch.to_eye),
        ..Batch::default()
    }
}
