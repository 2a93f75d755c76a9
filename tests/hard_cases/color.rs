//! Colours: from light to bytes.

use marraztu_core::accuracy::{Arithmetic, Settings};
use marraztu_core::base::color::{Color, byte};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Light, LightId, LightKind, Material, MaterialChoice, ObjectId, Scene, View,
};

use super::common::{at, draw, edit, scene, square};
use super::figures::Figure;

/// A square that fills the view, reflects ambient light only, and is lit by these lights.
fn glowing(ambient: [f64; 3], lights: &[Color]) -> (Scene, View) {
    let (mut scene, view) = scene(&[(square(), at(300.0, 0.0, 0.0, 0.0))]);
    edit(&mut scene, ObjectId(10), |object| {
        object.material = MaterialChoice::Own(Material::matte(ambient, [0.0; 3]));
    });
    let light = |(color, id): (&Color, u32)| {
        let light = Light::new("ambient", id, LightKind::Ambient);
        (LightId(id), Light { color: *color, ..light })
    };
    scene.lights = lights.iter().zip(1..).map(light).collect();
    (scene, View { marks: false, light: None, ..view })
}

fn shown(ambient: [f64; 3], lights: &[Color], arithmetic: Arithmetic) -> [u8; 3] {
    let (scene, view) = glowing(ambient, lights);
    let settings = Settings { arithmetic, ..Settings::default() };
    let [r, g, b, _] = draw(&scene, &view, &settings, 9).pixel(4, 4);
    [r, g, b]
}

#[test]
fn case_52_light_is_rounded_to_the_nearest_byte() {
    // Light just below and above the midpoint between two bytes, and on a byte. The expected byte
    // follows from integers.
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    let mut bias = 0.0;
    for k in 0..=254_u8 {
        for thousandths in [0, 1, 499, 501, 999] {
            let steps = f64::from(k) + f64::from(thousandths) / 1000.0;
            let want = if thousandths < 500 { k } else { k + 1 };
            let factor = steps / 255.0;
            for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
                let [got, ..] = if k % 16 == 0 {
                    shown([factor; 3], &[Color::WHITE], arithmetic)
                } else {
                    [byte(factor); 3]
                };
                assert_eq!(got, want, "{steps} in {arithmetic:?}");
                ours = ours.max((f64::from(got) - steps).abs());
            }
            // The naive conversion truncates.
            let cut_off = (factor * 255.0) as u8;
            naive = naive.max((f64::from(cut_off) - steps).abs());
            bias += f64::from(cut_off) - steps;
        }
    }
    assert!(bias < -0.3 * 255.0 * 5.0, "cutting off darkens");
    Figure {
        case: 52,
        what: "a byte against the light that it stands for",
        naive: Some(("cut off", naive)),
        ours,
        bound: 0.5,
        unit: "byte steps",
    }
    .hold();
}

#[test]
fn case_53_eight_lights_are_summed_before_they_are_rounded() {
    let mut rng = Rng::new(53);
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    for _ in 0..200 {
        let colors: Vec<Color> =
            (0..8).map(|_| Color([0, 1, 2].map(|_| rng.between(0, 60) as u8))).collect();
        // The ambient factors are thousandths, which makes the exact sum a multiple of 1/255000.
        let thousandths = [0, 1, 2].map(|_| rng.between(0, 500));
        let ambient = thousandths.map(|n| f64::from(n) / 1000.0);
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            let got = shown(ambient, &colors, arithmetic);
            for i in 0..3 {
                let sum: i32 = colors.iter().map(|color| i32::from(color.0[i])).sum();
                let exact = (f64::from(sum * thousandths[i]) / 1000.0).min(255.0);
                ours = ours.max((f64::from(got[i]) - exact).abs());
                // The naive sum truncates each light to a byte.
                let one_by_one: i32 =
                    colors.iter().map(|c| i32::from(c.0[i]) * thousandths[i] / 1000).sum();
                naive = naive.max((f64::from(one_by_one.min(255)) - exact).abs());
            }
        }
    }
    Figure {
        case: 53,
        what: "the sum of 8 lights",
        naive: Some(("each a byte, then summed", naive)),
        ours,
        // Half a step, plus the rounding errors of a sum of eight in f32.
        bound: 0.501,
        unit: "byte steps",
    }
    .hold();
}

#[test]
fn case_54_nan_is_black_and_infinity_is_full() {
    let (none, all) = (f64::NAN, f64::INFINITY);
    let mut wrong = 0;
    for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
        for (light, want) in
            [(none, 0), (all, 255), (-all, 0), (1e39, 255), (f64::MAX, 255), (-1e-46, 0), (-0.0, 0)]
        {
            let got = shown([light, 0.5, 0.0], &[Color::WHITE], arithmetic);
            wrong += usize::from(got != [want, 128, 0]);
        }
    }
    assert_eq!([byte(none), byte(all), byte(-all)], [0, 255, 0]);
    // A cast through int in C: the low byte, or that of the smallest int.
    let cast = |x: f64| (x * 255.0 + 0.5) as i64 as i32 & 255;
    let naive = [(all, 255), (1e39, 255), (1.2, 255), (-0.01, 0), (f64::MAX, 255)]
        .into_iter()
        .filter(|(x, want)| cast(*x) != *want)
        .count();
    Figure {
        case: 54,
        what: "wrong bytes of numbers that are NaN, infinite or huge",
        naive: Some(("cast by way of i32, of 5", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "bytes",
    }
    .hold();
}

#[test]
fn case_55_every_byte_survives_the_way_through_the_renderer() {
    let mut wrong = 0;
    for k in (0..=255_u8).step_by(3) {
        let ambient = Color([k, k.wrapping_add(1), k.wrapping_add(2)]);
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            wrong += usize::from(shown([1.0; 3], &[ambient], arithmetic) != ambient.0);
            wrong +=
                usize::from(shown(ambient.factors(), &[Color::WHITE], arithmetic) != ambient.0);
        }
    }
    let naive = (0..=255_u8).filter(|k| (f32::from(*k) / 256.0 * 255.0) as u8 != *k).count();
    Figure {
        case: 55,
        what: "bytes that do not survive the way to a factor and back",
        naive: Some(("k / 256, times 255, cut off", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "bytes",
    }
    .hold();
}

#[test]
fn case_55_a_pictures_pixels_do_not_depend_on_their_position() {
    // Every pixel has the same byte, at any position in a tile or a group of lanes.
    let (scene, view) = glowing([0.3, 0.6, 0.9], &[Color::WHITE]);
    let picture = draw(&scene, &view, &Settings::default(), 131);
    assert!(picture.pixels().iter().all(|pixel| *pixel == picture.pixel(0, 0)));
}
