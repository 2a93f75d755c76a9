//! Shadow maps against exact shadows, holes of opacity maps, and the shadow terminator.

use glam::{DMat4, DVec3};
use marraztu_core::accuracy::{AXES, Filter, Settings, ShadowMethod, Terminator};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    FileMaterial, MapKind, Material, MaterialChoice, Mesh, MeshSource, Model, NONE, ObjectId, Part,
    SourceCorner, SurfaceMap, SurfaceMaps, Texture,
};

use super::common::{at, ball, cube, draw, edit, square};
use super::figures::Figure;
use super::oracle::{Eye, meet, unit};
use super::shadows::{SIDE, Shade, bulb, floor, sun, tilted};

/// The default settings with each kind of shadow map.
fn maps() -> impl Iterator<Item = Settings> {
    let axis = AXES.iter().find(|axis| axis.key == "shadow-method").expect("the axis of shadows");
    let all = axis.choices.iter().filter(|choice| choice.word != "exact");
    all.map(|choice| choice.of(&Settings::default()))
}

/// Whether a shadow map without bias shades the point, by the depth at the centre of its texel.
fn has_acne(p: DVec3, normal: DVec3, travels: DVec3, texel: f64) -> bool {
    let right = travels.any_orthonormal_vector();
    let up = right.cross(travels);
    let centre = |axis: DVec3| ((p.dot(axis) / texel).floor() + 0.5) * texel - p.dot(axis);
    let aside = right * centre(right) + up * centre(up);
    // Depth of the plane at the texel centre, relative to that of the point.
    -normal.dot(aside) / normal.dot(travels) < -1e-9
}

#[test]
fn case_78_a_plane_does_not_shade_itself_in_a_shadow_map_with_a_bias() {
    let (mut shaded, mut naive, mut wrong) = (0, 0, [0; 2]);
    for (tilt, elevation, around) in [(35.0, 30.0, 40.0_f64), (20.0, 4.0, 100.0), (50.0, 60.0, 9.0)]
    {
        let turn = tilted(tilt);
        let (sine, cosine) = f64::to_radians(elevation).sin_cos();
        let (s, c) = around.to_radians().sin_cos();
        let towards = turn.transform_vector3(DVec3::new(c * cosine, sine, s * cosine));
        let plane = turn * floor().1;
        let eye = DVec3::Z * 400.0;
        let bare = Shade { models: vec![(square(), plane)], light: sun(towards), eye };
        for settings in maps() {
            // The bare plane must not be shaded by any map.
            shaded += bare.draw_by(&settings).shaded.iter().filter(|s| **s).count();
        }
        let normal = unit(plane.transform_vector3(DVec3::Z));
        let lit = bare.draw_by(&Settings::default()).lit;
        let seen = Eye { side: SIDE, at: eye, tangent: 2.0_f64.sqrt() - 1.0 };
        let points = (0..SIDE * SIDE).filter(|i| lit[*i]).map(|i| {
            let ray = seen.ray(i % SIDE, i / SIDE);
            eye - ray * normal.dot(eye - plane.w_axis.truncate()) / normal.dot(ray)
        });
        naive += points.filter(|p| has_acne(*p, normal, -unit(towards), 2.0)).count();
        // With objects on the plane, the maps agree with exact shadows except for stairs at the
        // borders.
        let things = [
            (ball(16), turn * at(50.0, 50.0, 50.0, -20.0)),
            (cube(), turn * at(30.0, -60.0, 30.0, 40.0)),
        ];
        let models = std::iter::once((square(), plane)).chain(things).collect();
        let full = Shade { models, light: sun(towards), eye };
        let exact = full.draw_by(&Settings::default()).shaded;
        for (shadow_method, wrong) in
            [ShadowMethod::Map512, ShadowMethod::Map2048].into_iter().zip(&mut wrong)
        {
            let settings = Settings { shadow_method, ..Settings::default() };
            let own = full.draw_by(&settings).shaded;
            *wrong += own.iter().zip(&exact).filter(|(a, b)| a != b).count();
        }
    }
    Figure {
        case: 78,
        what: "pixels of a plane that its own shadow maps shade",
        naive: Some(("no bias: half of the plane", naive as f64)),
        ours: shaded as f64,
        bound: 0.0,
        unit: "pixels",
    }
    .hold();
    Figure {
        case: 78,
        what: "pixels that a map of 2048 decides otherwise than rays",
        naive: Some(("a map of 512", wrong[0] as f64)),
        ours: wrong[1] as f64,
        bound: 24.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_78_a_convex_edge_shades_few_pixels_of_its_steep_side() {
    // A texel across the edge has the depth of the lit side. A point on the other side that is
    // compared with it is deeper by more than the bias for that texel's slope. With that bias
    // alone, 43 pixels are shaded.
    let (eye, turn) = (DVec3::Z * 400.0, tilted(30.0));
    let mut shaded = 0;
    for elevation in [60.0, 70.0, 80.0] {
        let (sine, cosine) = f64::to_radians(elevation).sin_cos();
        let towards = turn.transform_vector3(DVec3::new(0.3 * cosine, sine, cosine));
        let models = vec![(cube(), turn * at(90.0, 0.0, 0.0, 0.0))];
        let alone = Shade { models, light: sun(towards), eye };
        let exact = alone.draw_by(&Settings::default()).shaded;
        for settings in maps() {
            let own = alone.draw_by(&settings).shaded;
            shaded += own.iter().zip(&exact).filter(|(own, exact)| **own && !**exact).count();
        }
    }
    Figure {
        case: 78,
        what: "pixels of a lone cube that its shadow maps shade, in three lights",
        naive: None,
        ours: shaded as f64,
        bound: 8.0,
        unit: "pixels",
    }
    .hold();
}

#[test]
fn case_78_a_lamp_sees_casters_in_the_corners_of_its_cube_map() {
    // The wall is nearest to the lamp. Along the axis of the map, the cubes in its corners are
    // nearer than the wall, although their distance from the lamp is larger.
    let wall = (square(), at(150.0, 0.0, 0.0, 0.0));
    let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    let cubes = corners.map(|[x, y]| (cube(), at(4.0, 25.0 * x, 25.0 * y, 15.0)));
    let lamp = bulb(DVec3::new(0.0, 0.0, 40.0));
    let models = std::iter::once(wall).chain(cubes).collect();
    let room = Shade { models, light: lamp, eye: DVec3::Z * 400.0 };
    let exact = room.draw_by(&Settings::default()).shaded;
    let settings = Settings { shadow_method: ShadowMethod::Map2048, ..Settings::default() };
    let own = room.draw_by(&settings).shaded;
    Figure {
        case: 78,
        what: "pixels that a cube map of 2048 decides otherwise than rays",
        naive: Some((
            "a near plane just before the wall",
            exact.iter().filter(|shaded| **shaded).count() as f64,
        )),
        ours: own.iter().zip(&exact).filter(|(a, b)| a != b).count() as f64,
        bound: 24.0,
        unit: "pixels",
    }
    .hold();
}

/// A sheet from -1 to 1 with a black-and-white opacity map of 8 x 8 fields.
fn stencil() -> Shared<Model> {
    let field = |i: usize| if (i % 8 + i / 8).is_multiple_of(2) { 255 } else { 0 };
    let texels = (0..64).map(|i| [field(i), field(i), field(i), 255]).collect();
    let picture = Picture::from_pixels(Size::new(8, 8), texels).expect("all its texels");
    let texture = Shared::new(Texture::new("", picture));
    let maps = SurfaceMaps::from([(MapKind::Opacity, SurfaceMap { texture, gain: 1.0 })]);
    let corner = |position| SourceCorner { position, uv: position, normal: NONE };
    let source = MeshSource {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        uvs: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        parts: vec![Part { name: "sheet".to_owned(), material: Some(0) }],
        ..MeshSource::of_polygons((0..4).map(corner), vec![4])
    };
    let material = Material::matte([0.0; 3], [1.0; 3]);
    let material = FileMaterial { maps, ..FileMaterial::new("sheet", material) };
    let mesh = Mesh::new(source).expect("a good mesh");
    Shared::new(Model { materials: vec![material], ..Model::of_mesh("sheet", mesh) })
}

#[test]
fn case_79_light_comes_through_the_holes_of_a_map_of_opacity() {
    // The sheet is behind the eye, and only its shadow is visible.
    let sheet = at(60.0, 0.0, 0.0, 450.0);
    let eye = DVec3::Z * 400.0;
    let towards = DVec3::new(0.1, 0.07, 1.0);
    let wall = at(300.0, 0.0, 0.0, 0.0);
    let models = vec![(square(), wall), (stencil(), sheet)];
    let stage = Shade { models, light: sun(towards), eye };
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let [a, b, c, d] = corners.map(|[x, y]| sheet.transform_point3(DVec3::new(x, y, 0.0)));
    let seen = Eye { side: SIDE, at: eye, tangent: 2.0_f64.sqrt() - 1.0 };
    for method in [ShadowMethod::Exact, ShadowMethod::Map2048] {
        let settings =
            Settings { shadow_method: method, filter: Filter::Nearest, ..Settings::default() };
        let picture = |shadows: bool| {
            let (mut scene, view) = stage.scene(true, shadows);
            edit(&mut scene, ObjectId(11), |object| object.material = MaterialChoice::File);
            draw(&scene, &view, &settings, SIDE)
        };
        let (own, bright) = (picture(true), picture(false));
        let (mut wrong, mut whole, mut shaded, mut open) = (0, 0, 0, 0);
        for i in 0..SIDE * SIDE {
            // The oracle: a ray from the wall to the light meets a field of the sheet. Rays within
            // 0.04 of a field's border are skipped.
            let ray = seen.ray(i % SIDE, i / SIDE);
            let p = eye + ray * (400.0 / -ray.z);
            let hit =
                meet(p, towards * 1e4, [a, b, c]).or_else(|| meet(p, towards * 1e4, [a, c, d]));
            let place = hit.map(|(t, _)| {
                let local = sheet.inverse().transform_point3(p + towards * (1e4 * t));
                [local.x, local.y].map(|x| (x + 1.0) * 4.0)
            });
            let is_sure = |[u, v]: [f64; 2]| [u, v].iter().all(|x| (x - x.round()).abs() > 0.04);
            if place.is_some_and(|place| !is_sure(place)) {
                continue;
            }
            let covers = |[u, v]: [f64; 2]| {
                // Rows of a picture run down, v runs up.
                let (column, row) = (u as usize, 7 - v as usize);
                (column + row).is_multiple_of(2)
            };
            let want = place.is_some_and(covers);
            let got = own.pixels()[i] != bright.pixels()[i];
            wrong += usize::from(want != got);
            whole += usize::from(place.is_some() != got);
            shaded += usize::from(want);
            open += usize::from(place.is_some() && !want);
        }
        assert!(shaded > 200 && open > 200, "{shaded} in shadow, {open} in holes");
        Figure {
            case: 79,
            what: match method {
                ShadowMethod::Exact => "pixels of the shadow of a stencil, by rays",
                _ => "pixels of the shadow of a stencil, by a map of 2048",
            },
            naive: Some(("the whole sheet casts a shadow", whole as f64)),
            ours: wrong as f64,
            bound: 0.0,
            unit: "pixels",
        }
        .hold();
    }
}

#[test]
fn case_87_rays_that_begin_on_the_curved_surface_leave_the_light_of_normals() {
    let stage = Shade {
        models: vec![(ball(8), DMat4::from_scale(DVec3::splat(120.0)))],
        light: sun(DVec3::new(1.0, 0.3, 0.2)),
        eye: DVec3::Z * 400.0,
    };
    let shaded = |terminator| {
        let settings = Settings { terminator, ..Settings::default() };
        stage.draw_by(&settings).shaded.iter().filter(|s| **s).count()
    };
    // A ball is convex: a pixel that its normals light must not be in its own shadow.
    Figure {
        case: 87,
        what: "pixels of a smooth ball that its own triangles shade",
        naive: Some(("rays that begin on the triangles", shaded(Terminator::Triangles) as f64)),
        ours: shaded(Terminator::Smooth) as f64,
        bound: 40.0,
        unit: "pixels",
    }
    .hold();
}
