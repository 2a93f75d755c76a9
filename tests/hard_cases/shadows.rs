//! Shadows, compared with f64 rays against every triangle.

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{Samples, Settings};
use marraztu_core::base::Shared;
use marraztu_core::base::image::Picture;
use marraztu_core::scene::{
    Attenuation, CameraId, Light, LightId, LightKind, Material, MaterialChoice, Model, ObjectId,
    Orbit, Scene, Sides, Tracked, View,
};

use super::common::{at, ball, cube, draw, edit, model, scene, square};
use super::figures::Figure;
use super::oracle::{Eye, inside_by, meet, unit};

pub(crate) const SIDE: usize = 96;

/// Objects under one light that casts shadows.
pub(crate) struct Shade {
    pub(crate) models: Vec<(Shared<Model>, DMat4)>,
    pub(crate) light: LightKind,
    /// The position of the eye, which looks along -Z.
    pub(crate) eye: DVec3,
}

pub(crate) fn sun(towards: DVec3) -> LightKind {
    LightKind::Sun { direction: Tracked::new(-unit(towards)) }
}

pub(crate) fn bulb(at: DVec3) -> LightKind {
    LightKind::Bulb { position: Tracked::new(at), orbit: Orbit::default() }
}

/// The shadows of a picture.
pub(crate) struct Shaded {
    /// Whether the light reaches each pixel if shadows are off.
    pub(crate) lit: Vec<bool>,
    /// Whether each pixel is in shadow.
    pub(crate) shaded: Vec<bool>,
    pub(crate) picture: Picture,
}

impl Shade {
    pub(crate) fn scene(&self, on: bool, shadows: bool) -> (Scene, View) {
        let (mut scene, mut view) = scene(&self.models);
        let attenuation = Attenuation { constant: 1.0, linear: 0.0, quadratic: 0.0 };
        let light =
            Light { on, shadows, attenuation, ..Light::new("light", 1, self.light.clone()) };
        scene.lights = [(LightId(1), light)].into_iter().collect();
        let white = Material::matte([0.0; 3], [1.0; 3]);
        for id in 0..self.models.len() as u32 {
            edit(&mut scene, ObjectId(10 + id), |object| {
                object.material = MaterialChoice::Own(white);
                object.sides = Sides::One;
            });
        }
        let mut camera = scene.cameras.get(CameraId(0)).unwrap().clone();
        let mut pose = *camera.pose.now();
        pose.eye = self.eye;
        camera.pose = Tracked::new(pose);
        // A scene scaled by a power of two gets planes scaled alike.
        let scale = self.eye.z.abs() / 400.0;
        camera.lens.near *= if scale.log2().fract() == 0.0 { scale } else { 1.0 };
        camera.lens.far *= if scale.log2().fract() == 0.0 { scale } else { 1.0 };
        scene.cameras = [(CameraId(0), camera)].into_iter().collect();
        view.marks = false;
        (scene, view)
    }

    fn draw(&self) -> Shaded {
        self.draw_by(&Settings::default())
    }

    pub(crate) fn draw_by(&self, settings: &Settings) -> Shaded {
        let picture = |on, shadows| {
            let (scene, view) = self.scene(on, shadows);
            draw(&scene, &view, settings, SIDE)
        };
        let [dark, bright, own] =
            [picture(false, false), picture(true, false), picture(true, true)];
        let unlike = |a: &Picture, b: &Picture| -> Vec<bool> {
            a.pixels().iter().zip(b.pixels()).map(|(a, b)| a != b).collect()
        };
        Shaded { lit: unlike(&bright, &dark), shaded: unlike(&bright, &own), picture: own }
    }

    /// The triangles of all objects, in world space.
    pub(crate) fn triangles(&self) -> Vec<[DVec3; 3]> {
        let mut all = Vec::new();
        for (model, placement) in &self.models {
            let mesh = &model.mesh;
            for triangle in mesh.triangles() {
                all.push(triangle.corners.map(|corner| {
                    let vertex = mesh.corners()[corner as usize].position as usize;
                    let p = mesh.positions()[vertex].map(f64::from);
                    placement.transform_point3(DVec3::from_array(p))
                }));
            }
        }
        all
    }

    /// The vector from a point to the light.
    fn to_light(&self, from: DVec3) -> DVec3 {
        match &self.light {
            LightKind::Sun { direction } => -*direction.now() * 1e9,
            LightKind::Bulb { position, .. } => *position.now() - from,
            LightKind::Ambient | LightKind::Sky { .. } | LightKind::Spot { .. } => {
                unreachable!("no such case")
            }
        }
    }

    /// Compares the drawn shadows with rays, at pixels where the rays are reliable. Counts the
    /// wrong pixels, and the wrong ones of `naive`.
    fn judge(&self, naive: &Naive<'_>) -> Judged {
        let (drawn, all) = (self.draw(), self.triangles());
        let eye = Eye { side: SIDE, at: self.eye, tangent: 2.0_f64.sqrt() - 1.0 };
        let mut judged = Judged::default();
        for i in (0..SIDE * SIDE).filter(|i| drawn.lit[*i]) {
            // The visible point, by the nearest front face along the pixel's ray.
            let ray = eye.ray(i % SIDE, i / SIDE);
            let hits = all.iter().enumerate().filter_map(|(n, triangle)| {
                let (t, parts) = meet(eye.at, ray, *triangle)?;
                let [a, b, c] = *triangle;
                let front = (b - a).cross(c - a).dot(ray) < 0.0;
                front.then_some((n, t, inside_by(parts)))
            });
            let Some((own, t, inside)) = hits.min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
            // Near a side, snapping may show the neighbour.
            if inside < 1e-2 {
                continue;
            }
            let p = eye.at + ray * t;
            // A shadow is certain if the ray passes well inside a triangle, and unreliable if it
            // only grazes one or meets one at either end.
            let way = self.to_light(p);
            let (mut shaded, mut sure) = (false, true);
            for (n, triangle) in all.iter().enumerate().filter(|(n, _)| *n != own) {
                // A triangle in the light's plane casts no shadow.
                let normal = unit((triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]));
                if normal.dot(p + way - triangle[0]).abs() < 1e-9 {
                    continue;
                }
                let around = widened(*triangle);
                let Some((t, _)) = meet(p, way, around) else { continue };
                let inner =
                    meet(p, way, *triangle).is_some_and(|(_, parts)| inside_by(parts) > 1e-5);
                let ends = t * way.length() < 1e-7 || (t - 1.0).abs() < 1e-7;
                if t < 1.0 && inner && !ends {
                    shaded = true;
                } else if t < 1.0 + 1e-7 && all[own] != all[n] && !coplanar(&all[own], triangle) {
                    sure = false;
                }
            }
            if !sure && !shaded {
                continue;
            }
            judged.sure += 1;
            judged.shaded += usize::from(shaded);
            judged.wrong += usize::from(drawn.shaded[i] != shaded);
            judged.naive_wrong += usize::from(naive(p, way, &all) != shaded);
        }
        judged
    }
}

/// Enlarges a triangle slightly, so grazing rays are found.
fn widened([a, b, c]: [DVec3; 3]) -> [DVec3; 3] {
    let middle = (a + b + c) / 3.0;
    [a, b, c].map(|p| middle + (p - middle) * 1.0001)
}

fn coplanar(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    let n = unit((a[1] - a[0]).cross(a[2] - a[0]));
    b.iter().all(|p| n.dot(*p - a[0]).abs() < 1e-9 * (1.0 + p.length()))
}

/// A shadow test under comparison: point, vector to the light, all triangles.
type Naive<'a> = dyn Fn(DVec3, DVec3, &[[DVec3; 3]]) -> bool + 'a;

#[derive(Default)]
struct Judged {
    sure: usize,
    shaded: usize,
    wrong: usize,
    naive_wrong: usize,
}

/// Casts a ray in f32 from the point itself, against every triangle.
fn in_single(p: DVec3, way: DVec3, all: &[[DVec3; 3]]) -> bool {
    all.iter().any(|triangle| meets_in_single(p, way, *triangle))
}

fn meets_in_single(p: DVec3, way: DVec3, triangle: [DVec3; 3]) -> bool {
    let [a, b, c] = triangle.map(|p| p.as_vec3());
    let (origin, ray) = (p.as_vec3(), way.as_vec3());
    let (e, f) = (b - a, c - a);
    let across = ray.cross(f);
    let determinant = e.dot(across);
    let from = origin - a;
    let q = from.cross(e);
    let (v, w) = (from.dot(across) / determinant, ray.dot(q) / determinant);
    let t = f.dot(q) / determinant;
    v >= 0.0 && w >= 0.0 && v + w <= 1.0 && t > 0.0 && t < 1.0
}

/// A rotation that tilts the floor y = 0 towards the eye, which then sees it from above.
pub(crate) fn tilted(degrees: f64) -> DMat4 {
    DMat4::from_rotation_x(degrees.to_radians())
}

pub(crate) fn floor() -> (Shared<Model>, DMat4) {
    let lying = DMat4::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    (square(), lying * DMat4::from_scale(DVec3::splat(400.0)))
}

#[test]
fn case_68_a_cube_on_a_plane_leaks_no_light_and_speckles_nothing() {
    let (mut wrong, mut naive, mut shaded) = (0, 0, 0);
    for (tilt, elevation, around) in
        [(35.0, 30.0, 40.0), (20.0, 2.0, 100.0), (50.0, 0.5, 200.0), (25.0, 70.0, 310.0_f64)]
    {
        let turn = tilted(tilt);
        let (sine, cosine) = f64::to_radians(elevation).sin_cos();
        let (s, c) = around.to_radians().sin_cos();
        let stage = Shade {
            models: vec![
                (floor().0, turn * floor().1),
                (cube(), turn * at(40.0, 10.0, 40.0, -20.0)),
            ],
            light: sun(turn.transform_vector3(DVec3::new(c * cosine, sine, s * cosine))),
            eye: DVec3::Z * 400.0,
        };
        let judged = stage.judge(&in_single);
        assert!(judged.sure > 1000, "{} pixels", judged.sure);
        (wrong, naive) = (wrong + judged.wrong, naive + judged.naive_wrong);
        shaded += judged.shaded;
    }
    assert!(shaded > 500, "{shaded} in shadow");
    Figure {
        case: 68,
        what: "pixels whose shadow rays decide otherwise",
        naive: Some(("rays in f32 that begin at the point", naive as f64)),
        ours: wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

/// A closed body around a bulb, in front of a wall.
fn lamp_inside(body: Shared<Model>, scale: f64) -> Shade {
    Shade {
        models: vec![(square(), at(300.0, 0.0, 0.0, -120.0)), (body, at(scale, 0.0, 0.0, 0.0))],
        light: bulb(DVec3::ZERO),
        eye: DVec3::Z * 400.0,
    }
}

#[test]
fn case_69_no_light_comes_through_the_edges_and_corners_of_a_ball() {
    let body = ball(24);
    let stage = lamp_inside(body.clone(), 60.0);
    let drawn = stage.draw();
    let lit = drawn.lit.iter().zip(&drawn.shaded).filter(|(lit, shaded)| **lit && !**shaded);
    let through = lit.count();
    assert!(drawn.lit.iter().filter(|lit| **lit).count() > 1000);
    // Rays through the vertices and the midpoints of edges.
    let all = stage.triangles();
    let own = &all[2..];
    let aims = own.iter().flat_map(|t| [t[0], (t[0] + t[1]) / 2.0]);
    let missed = aims.filter(|aim| !in_single(*aim * 3.0, -*aim * 3.0, own)).count();
    Figure {
        case: 69,
        what: "pixels that a closed ball lets light through to",
        naive: Some(("rays at edges and corners that f32 lets through", missed as f64)),
        ours: through as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_70_a_lamp_on_a_surface_is_not_shaded_by_it() {
    // Exactly on the face towards the wall.
    let lamp = DVec3::new(3.0, 5.0, -30.0);
    let stage = Shade {
        models: vec![(square(), at(300.0, 0.0, 0.0, -120.0)), (cube(), at(30.0, 0.0, 0.0, 0.0))],
        light: bulb(lamp),
        eye: DVec3::Z * 400.0,
    };
    let drawn = stage.draw();
    let lit = drawn.lit.iter().filter(|lit| **lit).count();
    let shaded = drawn.lit.iter().zip(&drawn.shaded).filter(|(lit, s)| **lit && **s).count();
    assert!(lit > 3000, "{lit} pixels");
    let to_the_end = |p: DVec3, way: DVec3, all: &[[DVec3; 3]]| in_single(p, way * 1.000_001, all);
    let naive = stage.judge(&to_the_end).naive_wrong;
    Figure {
        case: 70,
        what: "pixels of a wall that the surface under a lamp shades",
        naive: Some(("rays that end a millionth beyond the lamp", naive as f64)),
        ours: shaded as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_71_a_gap_of_a_thousandth_far_from_the_origin_casts_its_shadow() {
    let far = DVec3::new(1e5, -1e5, 1e5);
    let moved = |m: DMat4| DMat4::from_translation(far) * tilted(40.0) * m;
    let sheet = DMat4::from_translation(DVec3::new(0.0, 1e-3, 0.0))
        * floor().1
        * DMat4::from_scale(DVec3::splat(0.2));
    // A grazing light, almost parallel to the sheet.
    let light = tilted(40.0).transform_vector3(DVec3::new(0.7, 0.01, 0.2));
    let stage = Shade {
        models: vec![(square(), moved(floor().1)), (square(), moved(sheet))],
        light: sun(light),
        eye: far + DVec3::Z * 400.0,
    };
    let judged = stage.judge(&in_single);
    assert!(judged.sure > 3000, "{} pixels", judged.sure);
    Figure {
        case: 71,
        what: "pixels of a sheet and the floor a thousandth below it",
        naive: Some(("rays in f32", judged.naive_wrong as f64)),
        ours: judged.wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_72_thin_leaves_shade_the_leaves_below_but_not_themselves() {
    let turn = tilted(50.0);
    let leaf = |i: u32| {
        let up = DMat4::from_translation(DVec3::new(0.0, f64::from(i) * 1e-2, 0.0));
        (
            square(),
            turn * up * floor().1 * DMat4::from_scale(DVec3::splat(0.9 - 0.04 * f64::from(i))),
        )
    };
    let stage = Shade {
        models: (0..20).map(leaf).collect(),
        light: sun(turn.transform_vector3(DVec3::new(0.3, 1.0, 0.1))),
        eye: DVec3::Z * 400.0,
    };
    let judged = stage.judge(&in_single);
    assert!(judged.sure > 2000, "{} pixels", judged.sure);
    Figure {
        case: 72,
        what: "pixels of twenty leaves, a hundredth apart",
        naive: Some(("rays in f32", judged.naive_wrong as f64)),
        ours: judged.wrong as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_73_a_mirrored_scene_has_mirrored_shadows() {
    let turn = tilted(35.0);
    let stage = |mirror: DMat4| Shade {
        models: vec![
            (floor().0, mirror * turn * floor().1),
            (ball(12), mirror * turn * at(50.0, 31.0, 80.0, -20.0)),
        ],
        light: sun(mirror.transform_vector3(turn.transform_vector3(DVec3::new(0.5, 1.0, 0.3)))),
        eye: DVec3::Z * 400.0,
    };
    let mirror = DMat4::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let (own, mirrored) = (stage(DMat4::IDENTITY).draw(), stage(mirror).draw());
    let unlike = (0..SIDE * SIDE).filter(|i| {
        let other = i / SIDE * SIDE + (SIDE - 1 - i % SIDE);
        own.shaded[*i] != mirrored.shaded[other]
    });
    let unlike = unlike.count();
    let shaded = own.shaded.iter().filter(|s| **s).count();
    assert!(shaded > 200, "{shaded} in shadow");
    // A program that takes a mirrored body for inside out finds no faces that cast a shadow.
    Figure {
        case: 73,
        what: "pixels in shadow in one of a scene and its mirror image",
        naive: Some(("only faces that turn to the light cast", shaded as f64)),
        ours: unlike as f64,
        bound: 4.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_74_a_light_inside_of_a_closed_body_lights_nothing_outside() {
    let stage = lamp_inside(cube(), 40.0);
    let drawn = stage.draw();
    let lit = drawn.lit.iter().filter(|lit| **lit).count();
    let through = drawn.lit.iter().zip(&drawn.shaded).filter(|(lit, s)| **lit && !**s).count();
    Figure {
        case: 74,
        what: "pixels outside that are lit",
        naive: Some(("back faces cast no shadows", lit as f64)),
        ours: through as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_75_shadows_of_a_scene_2_to_the_k_times_as_large_are_the_same() {
    let stage = |k: i32| {
        let scale = DMat4::from_scale(DVec3::splat(2.0_f64.powi(k)));
        let turn = scale * tilted(35.0);
        Shade {
            models: vec![
                (floor().0, turn * floor().1),
                (ball(12), turn * at(50.0, 31.0, 50.0, -20.0)),
                (cube(), turn * at(20.0, -60.0, 20.0, 10.0)),
            ],
            light: bulb(turn.transform_point3(DVec3::new(100.0, 150.0, 90.0))),
            eye: DVec3::Z * 400.0 * 2.0_f64.powi(k),
        }
    };
    // Powers of two change no mantissa, so the pictures must be equal.
    let own = stage(0).draw();
    assert!(own.shaded.iter().filter(|s| **s).count() > 200);
    let mut unlike = 0;
    for k in [-20, -3, 4, 20] {
        let other = stage(k).draw();
        let pairs = own.picture.pixels().iter().zip(other.picture.pixels());
        unlike += pairs.filter(|(a, b)| a != b).count();
    }
    Figure {
        case: 75,
        what: "pixels that change with the unit of length",
        naive: Some(("a bias of a fixed length: all of a shadow", own.shaded.len() as f64)),
        ours: unlike as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

/// Counts the pixels in shadow on sheets that have nothing above them, in many placements: faces
/// that exporters wrote twice, once for each side, and a small sheet in the plane of a large one.
fn double_faces_and_decals() -> usize {
    let turns = (0..24_u32).map(|i| {
        let turn = DMat4::from_rotation_z(0.37 * f64::from(i)) * tilted(5.0 + 3.0 * f64::from(i));
        let away = DVec3::new(f64::from(i % 5), f64::from(i % 3), f64::from(i % 7));
        DMat4::from_translation(7.3 * away) * turn
    });
    turns
        .flat_map(|turn| {
            // Turned by the placement, or in a file with six decimals.
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
            let filed = corners.map(|[x, y]| {
                let corner = (turn * floor().1).transform_point3(DVec3::new(x, y, 0.0));
                corner.to_array().map(|x| ((x * 1e6).round() / 1e6) as f32)
            });
            let flat = corners.map(|[x, y]| [x as f32, y as f32, 0.0]);
            let double = |name, corners: [[f32; 3]; 4]| {
                model(name, &corners, &[&[0, 1, 2, 3], &[3, 2, 1, 0]])
            };
            let small = DMat4::from_scale(DVec3::splat(0.3)) * DMat4::from_rotation_z(0.5);
            let placed = turn * floor().1;
            [
                vec![(double("placed", flat), placed)],
                vec![(double("filed", filed), DMat4::IDENTITY)],
                vec![(square(), placed), (square(), placed * small)],
            ]
            .map(|models| Shade {
                models,
                light: sun(turn.transform_vector3(DVec3::new(0.3, 1.0, 0.2))),
                eye: DVec3::Z * 400.0,
            })
        })
        .map(|stage| stage.draw().shaded.iter().filter(|shaded| **shaded).count())
        .sum()
}

#[test]
fn case_76_coplanar_triangles_do_not_shade_each_other() {
    // Thin strips, rotated so that their corners share no grid.
    let mut positions = Vec::new();
    let mut polygons: Vec<[u32; 4]> = Vec::new();
    for i in 0..40_u32 {
        let (x, next) = (i as f32 / 20.0 - 1.0, (i + 1) as f32 / 20.0 - 1.0);
        polygons.push([0, 1, 2, 3].map(|corner| 4 * i + corner));
        positions.extend([[x, -1.0, 0.0], [next, -1.0, 0.0], [next, 1.0, 0.0], [x, 1.0, 0.0]]);
    }
    let polygons: Vec<&[u32]> = polygons.iter().map(|p| &p[..]).collect();
    let strips = model("strips", &positions, &polygons);
    let (mut shaded, mut naive) = (0, 0);
    for (i, elevation) in [1e-1, 1e-3, 1e-2, 0.5].into_iter().enumerate() {
        let turn = DMat4::from_rotation_z(0.1 + i as f64) * tilted(40.0 + 3.0 * i as f64);
        let stage = Shade {
            models: vec![(strips.clone(), turn * floor().1)],
            light: sun(turn.transform_vector3(DVec3::new(0.9, elevation, 0.2))),
            eye: DVec3::Z * 400.0,
        };
        shaded += stage.draw().shaded.iter().filter(|s| **s).count();
        naive += stage.judge(&in_single).naive_wrong;
    }
    shaded += double_faces_and_decals();
    Figure {
        case: 76,
        what: "pixels of a plane that the plane itself shades",
        naive: Some(("rays in f32", naive as f64)),
        ours: shaded as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_77_points_seen_from_a_lamp_are_lit_with_several_samples_too() {
    let eye = DVec3::Z * 400.0;
    let stage = Shade { models: vec![(ball(12), at(100.0, 0.0, 0.0, 0.0))], light: bulb(eye), eye };
    let mut speckles = 0;
    for samples in [Samples::One, Samples::Four, Samples::Sixteen] {
        let settings = Settings { samples, ..Settings::default() };
        let [own, bright] = [true, false].map(|shadows| {
            let (scene, view) = stage.scene(true, shadows);
            draw(&scene, &view, &settings, SIDE)
        });
        assert!(bright.pixels().iter().filter(|pixel| pixel[0] > 100).count() > 1_000);
        speckles += own.pixels().iter().zip(bright.pixels()).filter(|(a, b)| a != b).count();
    }
    Figure {
        case: 77,
        what: "pixels of a ball, seen from the lamp, that are in shadow",
        naive: None,
        ours: speckles as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
}
