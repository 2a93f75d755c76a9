//! Transparency: sheets of constant colour against ray casting and alpha blending in f64.

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Settings;
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{
    Lens, Light, LightId, LightKind, List, Material, MaterialChoice, MeshSource, NONE, ObjectId,
    Scene, Sides, SourceCorner, Surface, Texture, View, Wrap,
};

use super::common::{draw, edit, model_of, scene};
use super::figures::Figure;
use super::oracle::{Eye, inside_by, meet};

const SIDE: usize = 64;

/// A quadrilateral of one colour and opacity.
#[derive(Clone, Copy)]
struct Sheet {
    corners: [DVec3; 4],
    color: [f64; 3],
    opacity: f64,
}

const RED: [f64; 3] = [0.85, 0.15, 0.2];
const GREEN: [f64; 3] = [0.15, 0.8, 0.35];
const BLUE: [f64; 3] = [0.2, 0.3, 0.75];

/// A square of 600 units around a position, rotated about Y by an angle in radians.
fn turned(at: DVec3, angle: f64, color: [f64; 3], opacity: f64) -> Sheet {
    let corner = |x: f64, y: f64| {
        at + DVec3::new(300.0 * x * angle.cos(), 300.0 * y, -300.0 * x * angle.sin())
    };
    let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
    Sheet { corners, color, opacity }
}

/// A scene of sheets, in list order, with ages.
fn stage(sheets: &[(u32, Sheet)]) -> (Scene, View) {
    let models: Vec<_> = sheets
        .iter()
        .map(|(_, sheet)| {
            let source = MeshSource {
                positions: sheet.corners.map(|corner| corner.as_vec3().to_array()).to_vec(),
                uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
                ..MeshSource::of_polygons(
                    [0, 1, 2, 0, 2, 3].map(|i| SourceCorner { position: i, uv: i, normal: NONE }),
                    vec![3, 3],
                )
            };
            (model_of("sheet", source), DMat4::IDENTITY)
        })
        .collect();
    let (mut scene, view) = scene(&models);
    scene.lights = List::from_iter([(LightId(1), Light::new("ambient", 0, LightKind::Ambient))]);
    for (id, (_, sheet)) in (10..).zip(sheets) {
        edit(&mut scene, ObjectId(id), |object| {
            object.sides = Sides::Two;
            object.opacity = sheet.opacity;
            object.material = MaterialChoice::Own(Material::matte(sheet.color, [0.0; 3]));
        });
    }
    // Ids give the ages: an object with a smaller id is older.
    let aged = scene.objects.iter().zip(sheets);
    let aged = aged.map(|((_, object), (age, _))| (ObjectId(10 + age), object.clone()));
    scene.objects = List::from_iter(aged.collect::<Vec<_>>());
    (scene, View { marks: false, ..view })
}

fn in_order(sheets: &[Sheet]) -> Vec<(u32, Sheet)> {
    (0..).zip(sheets.iter().copied()).collect()
}

/// Casts a ray through a pixel centre and blends the layers. Returns `None` close to a border (1e-3
/// in barycentric coordinates) or an intersection (0.1 in depth), where the result is uncertain.
fn seen(sheets: &[Sheet], scene: &Scene, [x, y]: [usize; 2], side: usize) -> Option<[f64; 3]> {
    let eye = Eye::first(side);
    let near = Lens::default().near;
    let mut layers = Vec::new();
    for sheet in sheets {
        let [a, b, c, d] = sheet.corners;
        for triangle in [[a, b, c], [a, c, d]] {
            if let Some((t, parts)) = meet(eye.at, eye.ray(x, y), triangle) {
                if inside_by(parts) < 1e-3 || (t - near).abs() < 1e-3 {
                    return None;
                }
                layers.extend((t > near).then_some((t, sheet)));
            }
        }
    }
    layers.sort_by(|a, b| b.0.total_cmp(&a.0));
    if layers.windows(2).any(|pair| pair[0].0 - pair[1].0 < 0.1) {
        return None;
    }
    let behind = scene.background.0.map(f64::from);
    Some(layers.iter().fold(behind, |under, (_, sheet)| over(under, sheet.color, sheet.opacity)))
}

fn over(under: [f64; 3], color: [f64; 3], opacity: f64) -> [f64; 3] {
    [0, 1, 2].map(|i: usize| opacity * color[i] * 255.0 + (1.0 - opacity) * under[i])
}

/// The largest difference of a channel, in byte steps, without rounding the expected value.
fn off(pixel: [u8; 4], want: [f64; 3]) -> f64 {
    let channels = pixel.iter().zip(want).map(|(byte, want)| (f64::from(*byte) - want).abs());
    channels.fold(0.0, f64::max)
}

/// Counts the pixels with an error beyond rounding, and the pixels that were compared.
fn wrong(picture: &Picture, sheets: &[Sheet], scene: &Scene) -> (usize, usize) {
    let (mut wrong, mut judged) = (0, 0);
    for y in 0..SIDE {
        for x in 0..SIDE {
            if let Some(want) = seen(sheets, scene, [x, y], SIDE) {
                judged += 1;
                wrong += usize::from(off(picture.pixel(x, y), want) > 0.51);
            }
        }
    }
    (wrong, judged)
}

#[test]
fn case_80_the_older_of_two_sheets_in_one_plane_is_in_front() {
    let sheets = [turned(DVec3::ZERO, 0.0, RED, 0.5), turned(DVec3::ZERO, 0.0, BLUE, 0.5)];
    let picture = |order: [usize; 2]| {
        let (scene, view) = stage(&order.map(|i| (i as u32, sheets[i])));
        (draw(&scene, &view, &Settings::default(), SIDE), scene)
    };
    let ((one, scene), (other, _)) = (picture([0, 1]), picture([1, 0]));
    let behind = scene.background.0.map(f64::from);
    let blend = |order: [[f64; 3]; 2]| {
        order.into_iter().fold(behind, |under, color| over(under, color, 0.5))
    };
    let want = blend([BLUE, RED]);
    let all = one.pixels().iter().chain(other.pixels());
    let ours = all.filter(|pixel| off(**pixel, want) > 0.51).count();
    // If the list order decided, one of the two pictures would show the younger in front.
    let last = blend([RED, BLUE]);
    let differs = last.iter().zip(want).any(|(a, b)| (a - b).abs() > 1.0);
    Figure {
        case: 80,
        what: "pixels of sheets in one plane whose older is not in front, in both orders",
        naive: Some(("the last of the list in front", if differs { 4096.0 } else { 0.0 })),
        ours: ours as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_81_sheets_that_cut_through_each_other_change_places_where_they_meet() {
    let sheets = [
        turned(DVec3::new(0.0, 0.0, -20.0), 0.6, RED, 0.5),
        turned(DVec3::new(25.0, 0.0, 0.0), -0.5, BLUE, 0.4),
        turned(DVec3::new(-30.0, 0.0, -50.0), 0.1, GREEN, 0.6),
    ];
    let (scene, view) = stage(&in_order(&sheets));
    let picture = draw(&scene, &view, &Settings::default(), SIDE);
    let (ours, judged) = wrong(&picture, &sheets, &scene);
    assert!(judged > 3000, "{judged}");
    // The naive renderer sorts whole objects.
    let by_object = Settings {
        transparency: marraztu_core::accuracy::Transparency::Objects,
        ..Settings::default()
    };
    let (naive, _) = wrong(&draw(&scene, &view, &by_object, SIDE), &sheets, &scene);
    Figure {
        case: 81,
        what: "wrong pixels of three sheets that cut through each other, of 4096",
        naive: Some(("object by object, the farthest first", naive as f64)),
        ours: ours as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_82_opacity_0_is_nothing_and_1_is_all() {
    let nearly = 1.0 - 2.0_f64.powi(-24);
    let back = turned(DVec3::new(0.0, 0.0, -80.0), 0.3, GREEN, 1.0);
    let front = |opacity| turned(DVec3::ZERO, -0.2, RED, opacity);
    let drawn = |sheets: &[Sheet]| {
        let (scene, view) = stage(&in_order(sheets));
        draw(&scene, &view, &Settings::default(), SIDE)
    };
    let differ = |a: &Picture, b: &Picture| {
        a.pixels().iter().zip(b.pixels()).filter(|(a, b)| a != b).count()
    };
    let (without, whole) = (drawn(&[back]), drawn(&[back, front(1.0)]));
    assert!(differ(&without, &whole) > 1000);
    let ours = differ(&drawn(&[back, front(0.0)]), &without)
        + differ(&drawn(&[back, front(nearly)]), &whole)
        + differ(&drawn(&[back, front(2.0_f64.powi(-24))]), &without);
    // Opacity as byte / 256 lets 1/256 of the background through.
    let opacity = 255.0 / 256.0;
    let naive = off([217, 38, 51, 0], over([38.0, 204.0, 89.0], RED, opacity));
    Figure {
        case: 82,
        what: "pixels at which opacity 0, 2^-24, 1 - 2^-24 are not as nothing and as opaque",
        naive: Some(("opacity in bytes, of 256: off by steps", naive * 4096.0)),
        ours: ours as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_83_a_thousand_layers_are_as_right_as_one() {
    let sheets: Vec<Sheet> = (0..1000)
        .map(|i| {
            let at = DVec3::new(0.0, 0.0, f64::from(i) * 0.25 - 250.0);
            let color = [RED, GREEN, BLUE][i as usize % 3];
            turned(at, 0.0, color, 0.002 + 0.001 * f64::from(i % 9))
        })
        .collect();
    let (scene, view) = stage(&in_order(&sheets));
    let picture = draw(&scene, &view, &Settings::default(), 16);
    let want = seen(&sheets, &scene, [3, 9], 16).unwrap();
    // The naive blend rounds to bytes after each layer.
    let bytes = sheets.iter().fold(scene.background.0, |under, sheet| {
        over(under.map(f64::from), sheet.color, sheet.opacity).map(|x| x.round() as u8)
    });
    let [r, g, b] = bytes;
    Figure {
        case: 83,
        what: "a pixel of a thousand layers against their sum in f64",
        naive: Some(("each layer rounded to a byte", off([r, g, b, 0], want))),
        ours: off(picture.pixel(3, 9), want),
        bound: 0.52,
        unit: "byte steps",
    }
    .hold();
}

#[test]
fn case_84_the_order_of_the_list_does_not_show() {
    let mut rng = Rng::new(84);
    let sheets: Vec<Sheet> = (0..12)
        .map(|i| {
            let mut far = |size: f64| rng.real(-size, size);
            let at = DVec3::new(far(60.0), far(60.0), far(60.0));
            let angle = far(1.0);
            turned(at, angle, [RED, GREEN, BLUE][i % 3], 0.2 + 0.05 * i as f64)
        })
        .collect();
    let mut order = in_order(&sheets);
    let (scene, view) = stage(&order);
    let first = draw(&scene, &view, &Settings::default(), SIDE);
    let (mut ours, mut naive) = (0, 0);
    for _ in 0..5 {
        for i in (1..order.len()).rev() {
            order.swap(i, rng.index(i + 1));
        }
        let (scene, view) = stage(&order);
        let picture = draw(&scene, &view, &Settings::default(), SIDE);
        ours += first.pixels().iter().zip(picture.pixels()).filter(|(a, b)| a != b).count();
        let behind = scene.background.0.map(f64::from);
        // The naive blend follows the order of the list.
        let blend = |all: &mut dyn Iterator<Item = &Sheet>| {
            all.fold(behind, |under, sheet| over(under, sheet.color, sheet.opacity))
        };
        let (a, b) = (blend(&mut sheets.iter()), blend(&mut order.iter().map(|(_, sheet)| sheet)));
        naive += usize::from(a.iter().zip(b).any(|(a, b)| (a - b).abs() > 1.0));
    }
    Figure {
        case: 84,
        what: "pixels that change in 5 shuffles of 12 sheets",
        naive: Some(("drawn in the order of the list: pictures that change", naive as f64)),
        ours: ours as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_85_glass_that_reaches_behind_the_eye_is_cut_at_the_near_plane() {
    let floor = |y: f64, color, opacity| Sheet {
        corners: [
            DVec3::new(-500.0, y, 900.0),
            DVec3::new(500.0, y, 900.0),
            DVec3::new(500.0, y, -900.0),
            DVec3::new(-500.0, y, -900.0),
        ],
        color,
        opacity,
    };
    let sheets = [floor(-40.0, RED, 0.5), floor(-55.0, BLUE, 0.4), floor(35.0, GREEN, 0.3)];
    let (scene, view) = stage(&in_order(&sheets));
    let picture = draw(&scene, &view, &Settings::default(), SIDE);
    let (ours, judged) = wrong(&picture, &sheets, &scene);
    assert!(judged > 3000, "{judged}");
    let blank = Picture::filled(Size::new(SIDE, SIDE), scene.background.opaque());
    Figure {
        case: 85,
        what: "wrong pixels of glass floors and a ceiling that reach behind the eye, of 4096",
        naive: Some(("left out", wrong(&blank, &sheets, &scene).0 as f64)),
        ours: ours as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_86_a_texture_fades_evenly() {
    let texels = (0..16).map(|i| [200, 100, 50, (i * 17) as u8]).collect();
    let picture = Picture::from_pixels(Size::new(16, 1), texels).unwrap();
    let texture = Texture { wrap: Wrap::Clamp, ..Texture::new("", picture) };
    let sheet = turned(DVec3::ZERO, 0.4, [1.0; 3], 0.9);
    let (mut scene, view) = stage(&in_order(&[sheet]));
    let texture = Shared::new(texture);
    edit(&mut scene, ObjectId(10), |object| {
        object.texture = Some(texture);
        object.surface = Surface::Texture;
    });
    let picture = draw(&scene, &view, &Settings::default(), SIDE);
    let eye = Eye::first(SIDE);
    let (mut ours, mut naive) = (0.0_f64, 0.0_f64);
    for y in 0..SIDE {
        for x in 0..SIDE {
            let [a, b, _, d] = sheet.corners;
            // Intersects the sheet's plane, as a triangle that contains the sheet; u follows its
            // first side.
            let Some((t, _)) =
                meet(eye.at, eye.ray(x, y), [a, a + (b - a) * 3.0, a + (d - a) * 3.0])
            else {
                continue;
            };
            let at = eye.at + eye.ray(x, y) * t;
            let u = (at - a).dot(b - a) / (b - a).length_squared();
            let column = (u * 16.0 - 0.5).clamp(0.0, 15.0);
            let (left, part) = (column.floor(), column.fract());
            let alpha = |i: f64| i.min(15.0) * 17.0 / 255.0;
            let alpha = 0.9 * (alpha(left) * (1.0 - part) + alpha(left + 1.0) * part);
            let behind = scene.background.0.map(f64::from);
            let color = [200.0, 100.0, 50.0].map(|byte: f64| byte / 255.0);
            let want = over(behind, color, alpha);
            ours = ours.max(off(picture.pixel(x, y), want));
            let cut = if alpha < 0.5 { behind } else { color.map(|part| part * 255.0) };
            let differences = cut.iter().zip(want).map(|(a, b)| (a - b).abs());
            naive = naive.max(differences.fold(0.0, f64::max));
        }
    }
    Figure {
        case: 86,
        what: "a texture that fades from nothing, against f64",
        naive: Some(("cut off at one half", naive)),
        ours,
        bound: 0.75,
        unit: "byte steps",
    }
    .hold();
}
