//! Generates the suite's scenes. Space is right-handed with Y up; cameras look along -Z.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "coordinates of small scenes"
)]

use glam::{DMat4, DVec3};

use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    Aim, Camera, Light, LightId, LightKind, List, Material, MaterialChoice, Mesh, MeshSource,
    Model, NONE, Object, ObjectId, Optics, Orbit, Part, Pose, Reflection, Scene, Smoothing,
    SourceCorner, SpotOwner, Surface, Texture, Tracked, Transmission, View,
};
use marraztu_io::{default_scene, empty_scene, own_model};

/// A mesh under construction.
#[derive(Default)]
struct Maker {
    source: MeshSource,
}

impl Maker {
    /// Adds a vertex, with texture coordinates if the mesh has them, and returns its index.
    fn vertex(&mut self, at: [f64; 3], uv: Option<[f64; 2]>) -> u32 {
        let number = self.source.positions.len() as u32;
        self.source.positions.push(at.map(|x| x as f32));
        self.source.uvs.extend(uv.map(|uv| uv.map(|x| x as f32)));
        number
    }

    fn polygon(&mut self, vertices: &[u32]) {
        let textured = !self.source.uvs.is_empty();
        let corner = |position: &u32| {
            let uv = if textured { *position } else { NONE };
            SourceCorner { position: *position, uv, normal: NONE }
        };
        self.source.push_polygon(&vertices.iter().map(corner).collect::<Vec<_>>());
    }

    fn model(mut self, name: &str) -> Shared<Model> {
        self.source.parts = vec![Part { name: name.to_owned(), material: None }];
        Shared::new(Model::of_mesh(
            name,
            Mesh::new(self.source).expect("the coordinates are finite"),
        ))
    }
}

/// Builds a smooth ball of radius 1 with `rings` rings.
fn ball(rings: u32) -> Shared<Model> {
    let (rings, segments) = (rings.max(3), 2 * rings.max(3));
    let mut maker = Maker::default();
    maker.source.smoothing = Smoothing::default();
    maker.vertex([0.0, 1.0, 0.0], None);
    maker.vertex([0.0, -1.0, 0.0], None);
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for segment in 0..segments {
            let angle = std::f64::consts::TAU * f64::from(segment) / f64::from(segments);
            let (s, c) = (libm::sin(polar), libm::cos(polar));
            maker.vertex([s * libm::sin(angle), c, s * libm::cos(angle)], None);
        }
    }
    // The poles are vertices 0 and 1; the rings follow from top to bottom.
    let at = |ring: u32, segment: u32| 2 + (ring - 1) * segments + segment % segments;
    for segment in 0..segments {
        maker.polygon(&[0, at(1, segment), at(1, segment + 1)]);
        maker.polygon(&[1, at(rings - 1, segment + 1), at(rings - 1, segment)]);
        for ring in 1..rings - 1 {
            let (a, b) = (at(ring, segment), at(ring + 1, segment));
            maker.polygon(&[a, b, at(ring + 1, segment + 1), at(ring, segment + 1)]);
        }
    }
    maker.model("ball")
}

fn shiny(color: [f64; 3], exponent: f64) -> MaterialChoice {
    let [ambient, diffuse] = [0.15, 0.55].map(|part| color.map(|c| c * part));
    MaterialChoice::Own(Material {
        specular: [0.8; 3],
        exponent,
        ..Material::matte(ambient, diffuse)
    })
}

fn object(model: Shared<Model>, material: MaterialChoice, placement: DMat4) -> Object {
    let mut object = Object::new(model, material);
    object.placement = Tracked::new(placement);
    object
}

/// Builds a scene of these objects, with ambient light, a sun and a bulb, seen from `eye`.
fn stage(objects: Vec<Object>, eye: DVec3) -> (Scene, View) {
    let (mut scene, _) = empty_scene();
    let cameras = scene.cameras.iter().map(|(id, camera)| {
        let pose = Tracked::new(Pose::facing_minus_z(eye));
        (id, Camera { pose, ..camera.clone() })
    });
    scene.cameras = List::from_iter(cameras.collect::<Vec<_>>());
    let direction = DVec3::new(-0.4, -0.7, -0.6).normalize_or(DVec3::NEG_Y);
    let sun = LightKind::Sun { direction: Tracked::new(direction) };
    let position = Tracked::new(eye + DVec3::new(-60.0, 50.0, 0.0));
    let lamp = LightKind::Bulb { position, orbit: Orbit::default() };
    let lights = [
        Light::new("ambient", 0, LightKind::Ambient),
        Light::new("sun", 1, sun),
        Light::new("lamp", 2, lamp),
    ];
    scene.lights = lights.into_iter().zip(1000..).map(|(light, id)| (LightId(id), light)).collect();
    scene.objects =
        List::from_iter(objects.into_iter().zip(1..).map(|(it, id)| (ObjectId(id), it)));
    scene.next_id = 2000;
    let mut view = scene.first_view();
    view.marks = false;
    (scene, view)
}

/// Builds one lit triangle over the whole picture. A bulb is close to it, so the light varies
/// everywhere.
pub(super) fn pixels(_: u32) -> (Scene, View) {
    let mut maker = Maker::default();
    let corners = [[-900.0, -500.0, 40.0], [900.0, -500.0, -60.0], [0.0, 1200.0, 0.0]];
    let corners = corners.map(|at| maker.vertex(at, None));
    maker.polygon(&corners);
    let placed = object(maker.model("triangle"), shiny([0.9, 0.6, 0.3], 40.0), DMat4::IDENTITY);
    stage(vec![placed], DVec3::new(0.0, 0.0, 220.0))
}

/// A place at which f32 has steps of a unit along x. Close to the middle of two steps, it is
/// rounded down, and a place at a fiftieth of a unit from it is rounded up.
const AWAY: DVec3 = DVec3::new(10_000_000.49, 3_000_000.62, -7_000_000.43);

/// Builds a million triangles in a wavy grid, far from the origin.
pub(super) fn vertices(detail: u32) -> (Scene, View) {
    let side = libm::sqrt(500.0 * f64::from(detail)) as u32;
    let mut maker = Maker::default();
    for y in 0..=side {
        for x in 0..=side {
            let [u, v] = [x, y].map(|i| f64::from(i) / f64::from(side) - 0.5);
            // Waves vary the normals, so lighting differs between triangles.
            let wave = libm::sin(u * 40.0) * libm::cos(v * 30.0);
            maker.vertex([u * 560.0, v * 330.0, wave * 6.0], None);
        }
    }
    for y in 0..side {
        for x in 0..side {
            let at = y * (side + 1) + x;
            maker.polygon(&[at, at + 1, at + side + 2, at + side + 1]);
        }
    }
    let placement = DMat4::from_translation(AWAY);
    let placed = object(maker.model("waves"), shiny([0.3, 0.6, 0.8], 20.0), placement);
    stage(vec![placed], AWAY + DVec3::new(0.02, 0.01, 400.0))
}

/// Builds balls with exponents from 5 to 500, coarse enough for vertex lighting to miss highlights;
/// one is flattened.
pub(super) fn highlights(_: u32) -> (Scene, View) {
    let model = ball(12);
    let exponents = [5.0, 16.0, 40.0, 76.8, 150.0, 500.0];
    let balls = exponents.iter().enumerate().map(|(i, exponent)| {
        let at = DVec3::new((i % 3) as f64 * 90.0 - 90.0, 45.0 - (i / 3) as f64 * 90.0, 0.0);
        let scale = if i == 4 { DVec3::new(44.0, 14.0, 44.0) } else { DVec3::splat(42.0) };
        let placement = DMat4::from_translation(at) * DMat4::from_scale(scale);
        let color = [0.3 + 0.1 * i as f64, 0.5, 0.9 - 0.1 * i as f64];
        object(model.clone(), shiny(color, *exponent), placement)
    });
    stage(balls.collect(), DVec3::new(0.0, 0.0, 260.0))
}

/// Builds a floor with a texture of fine lines, from below the camera to the horizon. It is rolled:
/// along the rows of a level floor, distances are constant, and every interpolation is exact.
pub(super) fn textures(_: u32) -> (Scene, View) {
    let mut maker = Maker::default();
    let (near, far) = (10.0, -1900.0);
    let corners = [[-900.0, near], [900.0, near], [900.0, far], [-900.0, far]];
    let corners = corners.map(|[x, z]| maker.vertex([x, -20.0, z], Some([x / 24.0, -z / 24.0])));
    maker.polygon(&corners);
    let roll = DMat4::from_rotation_z(0.35);
    let mut floor = object(maker.model("floor"), shiny([0.8; 3], 10.0), roll);
    let side = 64;
    let mut picture = Picture::filled(Size::new(side, side), [225, 220, 205, 255]);
    for (i, pixel) in picture.pixels_mut().iter_mut().enumerate() {
        let (x, y) = (i % side, i / side);
        // Thin joints between tiles alias strongly without filtering.
        if x % 32 < 3 || y % 32 < 3 {
            *pixel = [60, 50, 70, 255];
        } else if (x / 32 + y / 32) % 2 == 0 {
            *pixel = [190, 90, 60, 255];
        }
    }
    floor.texture = Some(Shared::new(Texture::new("tiles", picture)));
    floor.surface = Surface::default();
    stage(vec![floor], DVec3::ZERO)
}

/// Builds a fence of thin slats, all slightly off the vertical.
pub(super) fn edges(_: u32) -> (Scene, View) {
    let mut maker = Maker::default();
    let mut slat = |from: [f64; 2], to: [f64; 2], width: f64, z: f64| {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        // A slat is a quad around its axis, as wide as `width`.
        let length = libm::hypot(dx, dy);
        let side = [-dy / length * width / 2.0, dx / length * width / 2.0];
        let corner = |[x, y]: [f64; 2], sign: f64| [x + sign * side[0], y + sign * side[1], z];
        let corners = [corner(from, 1.0), corner(from, -1.0), corner(to, -1.0), corner(to, 1.0)];
        let corners = corners.map(|at| maker.vertex(at, None));
        maker.polygon(&corners);
    };
    for i in 0..70 {
        let x = f64::from(i) * 8.0 - 276.0;
        slat([x, 120.0], [x + 9.0, -120.0], 2.2, f64::from(i % 3));
    }
    for y in [-80.0, -10.0, 60.0] {
        slat([-290.0, y], [290.0, y + 23.0], 3.1, 6.0);
    }
    let mut fence = object(maker.model("fence"), shiny([0.9, 0.8, 0.6], 8.0), DMat4::IDENTITY);
    fence.sides = marraztu_core::scene::Sides::Two;
    stage(vec![fence], DVec3::new(0.0, 0.0, 300.0))
}

/// Places a ship of the first scene, with a camera next to it, far from the origin.
pub(super) fn far(_: u32) -> (Scene, View) {
    let (first, _) = default_scene();
    let ship = first.objects.first().and_then(|id| first.objects.get(id)).cloned();
    let ship = ship.map(|mut ship| {
        ship.placement = Tracked::new(DMat4::from_translation(AWAY));
        ship
    });
    stage(ship.into_iter().collect(), AWAY + DVec3::new(0.02, 15.01, 120.0))
}

/// Builds pairs of plates 0.001 apart, the nearer one smaller, from 2 to 2000 units away.
pub(super) fn depth(_: u32) -> (Scene, View) {
    let mut maker = Maker::default();
    for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        maker.vertex([x, y, 0.0], None);
    }
    maker.polygon(&[0, 1, 2, 3]);
    let model = maker.model("plate");
    let mut plates = Vec::new();
    for i in 0..12 {
        // Distances from 2 to 1990 units, in equal ratios.
        let z = 2.0 * libm::pow(995.0, f64::from(i) / 11.0);
        let at = [f64::from(i % 4) - 1.5, 1.0 - f64::from(i / 4)].map(|k| k * 0.2 * z);
        for (size, lift, color) in [(0.09, 0.0, [0.9, 0.3, 0.2]), (0.06, 0.001, [0.2, 0.4, 0.9])] {
            let place = DMat4::from_translation(DVec3::new(at[0], at[1], lift - z));
            let placement = place * DMat4::from_scale(DVec3::splat(size * z));
            plates.push(object(model.clone(), shiny(color, 8.0), placement));
        }
    }
    stage(plates, DVec3::ZERO)
}

/// Builds eight groups of four nested glass balls; neighbouring groups intersect.
pub(super) fn layers(detail: u32) -> (Scene, View) {
    let model = ball((detail / 25).clamp(8, 40));
    let balls = (0..32_u32).map(|i| {
        let (group, within) = (i / 4, i % 4);
        let [column, row] = [group % 4, group / 4].map(f64::from);
        let at = DVec3::new(column * 70.0 - 105.0, 45.0 - row * 90.0, row * 20.0);
        let scale = DVec3::splat(52.0 - 11.0 * f64::from(within));
        let placement = DMat4::from_translation(at) * DMat4::from_scale(scale);
        let color = [0.9, 0.6, 0.3].map(|part| part - 0.1 * f64::from(within));
        let turned = [color[group as usize % 3], color[1], color[(group as usize + 2) % 3]];
        let mut ball = object(model.clone(), shiny(turned, 60.0), placement);
        ball.opacity = 0.25 + 0.1 * f64::from(within);
        ball
    });
    stage(balls.collect(), DVec3::new(0.0, 0.0, 280.0))
}

/// Builds balls with bump maps; far balls have many texels per pixel.
pub(super) fn bumps(_: u32) -> (Scene, View) {
    let model = own_model("dimples").expect("the program has it");
    let balls = (0..9).map(|i| {
        let far = f64::from(i / 3);
        let at = DVec3::new(f64::from(i % 3) - 1.0, 0.6 - 0.6 * far, 0.0) * (90.0 + 60.0 * far);
        let placement = DMat4::from_translation(at - DVec3::Z * (200.0 * far));
        object(model.clone(), MaterialChoice::File, placement)
    });
    stage(balls.collect(), DVec3::new(0.0, 0.0, 260.0))
}

/// Builds balls of three sizes on a floor, under a sun, a bulb and a spot with shadows.
pub(super) fn shadows(detail: u32) -> (Scene, View) {
    let model = ball((detail / 25).clamp(8, 40));
    let mut maker = Maker::default();
    let corners = [[-900.0, 300.0], [900.0, 300.0], [900.0, -900.0], [-900.0, -900.0]];
    let corners = corners.map(|[x, z]| maker.vertex([x, -60.0, z], None));
    maker.polygon(&corners);
    let floor = object(maker.model("floor"), shiny([0.8; 3], 10.0), DMat4::IDENTITY);
    let balls = (0..24_u32).map(|i| {
        let [column, row] = [i % 6, i / 6].map(f64::from);
        let radius = 10.0 + 4.0 * f64::from(i % 3);
        let across = column * 52.0 - 130.0 + row * 9.0;
        let at = DVec3::new(across, radius - 60.0, 40.0 - row * 55.0);
        let placement = DMat4::from_translation(at) * DMat4::from_scale(DVec3::splat(radius));
        let color = [0.9 - 0.1 * row, 0.5, 0.3 + 0.1 * column];
        object(model.clone(), shiny(color, 30.0), placement)
    });
    let (mut scene, view) =
        stage(std::iter::once(floor).chain(balls).collect(), DVec3::new(0.0, 40.0, 230.0));
    // The stage has a sun and a bulb; a spot adds the third kind of shadow.
    let aim = Aim { position: DVec3::new(150.0, 120.0, 120.0), direction: aimed_down() };
    let owner = SpotOwner::Fixed(Tracked::new(aim));
    let spot = LightKind::Spot { owner, half_aperture: 30.0, exponent: 3.0 };
    let spot = (LightId(1003), Light::new("spot", 3, spot));
    let lights = scene.lights.iter().map(|(id, light)| (id, light.clone())).chain([spot]);
    let cast = |(id, light): (LightId, Light)| {
        let shadows = light.can_cast_shadows();
        (id, Light { shadows, ..light })
    };
    scene.lights = lights.map(cast).collect::<Vec<_>>().into_iter().collect();
    (scene, view)
}

/// Builds the same scene with a large sun.
pub(super) fn soft(detail: u32) -> (Scene, View) {
    let (mut scene, view) = shadows(detail);
    let lights = scene.lights.iter().map(|(id, light)| {
        let size = match light.kind {
            LightKind::Sun { .. } => 6.0,
            _ => 0.0,
        };
        (id, Light { size, ..light.clone() })
    });
    scene.lights = lights.collect::<Vec<_>>().into_iter().collect();
    (scene, view)
}

/// Builds balls of glass and metal on a floor, between two mirrors that face each other.
pub(super) fn mirrors(detail: u32) -> (Scene, View) {
    let model = ball((detail / 25).clamp(8, 40));
    let mut maker = Maker::default();
    let corners = [[-300.0, 250.0], [300.0, 250.0], [300.0, -120.0], [-300.0, -120.0]];
    let corners = corners.map(|[x, z]| maker.vertex([x, -60.0, z], None));
    maker.polygon(&corners);
    let floor = object(maker.model("floor"), shiny([0.8, 0.7, 0.5], 10.0), DMat4::IDENTITY);
    let with_rays = |specular: [f64; 3], optics: Optics| {
        let dark = Material::matte([0.02; 3], [0.05; 3]);
        MaterialChoice::Own(Material { specular, exponent: 200.0, optics, ..dark })
    };
    let metal = Optics { reflection: Reflection::Constant, ..Optics::NONE };
    let glass = Optics {
        reflection: Reflection::Fresnel,
        transmission: Transmission::Filter([0.95, 0.97, 1.0]),
        index: 1.5,
    };
    let mirror = |z: f64, towards: f64| {
        let mut maker = Maker::default();
        let corners = [[-170.0, -55.0], [170.0, -55.0], [170.0, 90.0], [-170.0, 90.0]];
        let corners = corners.map(|[x, y]| maker.vertex([x * towards, y, z], None));
        maker.polygon(&corners);
        object(maker.model("mirror"), with_rays([0.85, 0.9, 0.86], metal), DMat4::IDENTITY)
    };
    let balls = (0..10_u32).map(|i| {
        let [column, row] = [i % 5, i / 5].map(f64::from);
        let radius = 17.0 + 3.0 * f64::from(i % 3);
        let at = DVec3::new(column * 56.0 - 105.0 - row * 20.0, radius - 60.0, 50.0 - row * 70.0);
        let placement = DMat4::from_translation(at) * DMat4::from_scale(DVec3::splat(radius));
        let material = match i % 3 {
            0 => with_rays([0.04; 3], glass),
            1 => with_rays([0.9, 0.75, 0.5], metal),
            _ => shiny([0.8, 0.3, 0.2 + 0.1 * column], 30.0),
        };
        object(model.clone(), material, placement)
    });
    let walls = [floor, mirror(-110.0, 1.0), mirror(260.0, -1.0)];
    stage(walls.into_iter().chain(balls).collect(), DVec3::new(0.0, 20.0, 230.0))
}

/// Returns a direction down and to the left.
fn aimed_down() -> DVec3 {
    DVec3::new(-0.62, -0.62, -0.48).normalize_or(DVec3::NEG_Y)
}
