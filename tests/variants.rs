//! The effect of each axis of accuracy on pictures, compared with the errors that its table states.

#![expect(clippy::cast_precision_loss, reason = "small numbers")]

mod common;

use common::{at, ball, covered, draw, edit, model_of, scene, square};
use glam::{DMat4, DVec3};
use marraztu_core::accuracy::Shot;
use marraztu_core::accuracy::{
    ACCURACY_PRESETS, AXES, AccuracyPreset, Arithmetic, Axis, Coverage, DepthFormat, Filter,
    Interpolation, NormalMatrix, Points, Rounding, Settings, Subpixels, VertexArithmetic,
};
use marraztu_core::base::Shared;
use marraztu_core::base::image::{Picture, Size};
use marraztu_core::scene::{
    Light, LightId, LightKind, Material, MaterialChoice, MeshSource, Model, NONE, Object, ObjectId,
    Scene, Sides, SourceCorner, Surface, Texture, View, Wrap,
};
use marraztu_io::{lesson_on, lesson_scene};
use marraztu_render::Renderer;
use marraztu_render::plan_frame;

const FIRST: ObjectId = ObjectId(10);
const SECOND: ObjectId = ObjectId(11);

/// A matt material with an ambient colour only.
fn matt(color: [f64; 3]) -> MaterialChoice {
    let [diffuse, specular] = [[0.0; 3]; 2];
    MaterialChoice::Own(Material { specular, ..Material::matte(color, diffuse) })
}

fn unmarked(view: View) -> View {
    View { marks: false, ..view }
}

/// The primitive at each pixel of a picture.
fn primitives(scene: &Scene, view: &View, settings: &Settings, side: usize) -> Vec<u32> {
    let mut renderer = Renderer::default();
    renderer.render(&plan_frame(&Shot::new(scene, view, settings, Size::new(side, side))));
    renderer.primitives()
}

/// The share of covered pixels that show different primitives.
fn differing(a: &[u32], b: &[u32]) -> f64 {
    let covered = b.iter().filter(|seen| **seen != 0).count();
    a.iter().zip(b).filter(|(a, b)| a != b).count() as f64 / covered as f64
}

/// The largest difference between two pictures in byte steps.
fn steps_apart(a: &Picture, b: &Picture) -> u8 {
    let pairs = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

/// A square from -1 to 1 of `side` x `side` quads, covered by one texture.
fn chart(side: u32) -> Shared<Model> {
    let row = side + 1;
    let at = |i: u32| [i % row, i / row].map(|i| i as f32 / side as f32);
    let corner = |i| SourceCorner { position: i, uv: i, normal: NONE };
    let square = |i: u32| {
        let first = i / side * row + i % side;
        [first, first + 1, first + row + 1, first + row]
    };
    let count = (side * side) as usize;
    model_of(
        "chart",
        MeshSource {
            positions: (0..row * row)
                .map(at)
                .map(|[x, y]| [2.0 * x - 1.0, 2.0 * y - 1.0, 0.0])
                .collect(),
            uvs: (0..row * row).map(at).collect(),
            ..MeshSource::of_polygons((0..side * side).flat_map(square).map(corner), vec![4; count])
        },
    )
}

/// A checkerboard with fields of this many texels, alternately opaque and holes.
fn fields(texels: usize, wrap: Wrap) -> Shared<Texture> {
    let size = Size::new(200, 136);
    let texel = |i: usize| {
        let open = (i % size.width / texels + i / size.width / texels).is_multiple_of(2);
        [200, 90, 40, if open { 0 } else { 255 }]
    };
    let texels = (0..size.area()).map(texel).collect();
    let picture = Picture::from_pixels(size, texels).expect("as many as it has");
    let (offset, scale) = ([0.3, -0.1], [1.5, -1.0]);
    Texture { wrap, offset, scale, ..Texture::new("fields", picture) }.into()
}

/// Catches: holes of a block or a triangle judged by only a part of it; texels outside the range
/// that is examined. The other kind of coverage tests each pixel of two triangles separately.
#[test]
fn holes_classified_by_block_and_triangle_equal_holes_by_pixel() {
    let turn = DMat4::from_rotation_y(0.5) * DMat4::from_rotation_x(0.3);
    let holes_of = |object: &mut Object, texels, wrap| {
        object.surface = Surface::Texture;
        object.sides = Sides::Two;
        object.texture = Some(fields(texels, wrap));
    };
    for (texels, wrap) in [(7, Wrap::Repeat), (40, Wrap::Repeat), (40, Wrap::Clamp)] {
        for filter in [Filter::Nearest, Filter::Bilinear] {
            let shown = |side, coverage| {
                let place = DMat4::from_scale(DVec3::splat(150.0)) * turn;
                let (mut scene, view) = scene(&[(chart(side), place)]);
                edit(&mut scene, FIRST, |object| holes_of(object, texels, wrap));
                let settings = Settings { filter, coverage, ..Settings::default() };
                primitives(&scene, &unmarked(view), &settings, 500)
            };
            let each = shown(1, Coverage::F32Edges);
            let count = each.iter().filter(|seen| **seen != 0).count();
            assert!((20_000..180_000).contains(&count), "{count} pixels are seen");
            for side in [1, 9, 60] {
                let own = shown(side, Coverage::Exact);
                let apart = own.iter().zip(&each).filter(|(a, b)| (**a == 0) != (**b == 0)).count();
                // Corners are snapped to 1/256 pixel, which moves the borders of texels by less
                // than that.
                assert!(
                    apart * 1000 <= count,
                    "{side}, {texels}, {wrap:?}, {filter:?}: {apart} of {count}"
                );
            }
        }
    }
}

#[test]
fn every_choice_of_every_axis_changes_its_lesson_or_says_why_not() {
    // At the size of a lesson, the coarsest choice is visible.
    for axis in AXES {
        let opened = lesson_scene(&lesson_on(axis).scene).unwrap();
        let picture = |settings: &Settings| draw(&opened.scene, &opened.view, settings, 300);
        let usual = Settings::default();
        let coarse = &axis.choices[0];
        assert!(
            picture(&coarse.of(&usual)) != picture(&axis.most_exact(&usual).of(&usual))
                || axis.key == "arithmetic"
                || axis.default_choice().word == coarse.word,
            "{} {} is not seen in {}",
            axis.key,
            coarse.word,
            lesson_on(axis).scene
        );
    }
}

/// A floor that leans by 45 degrees, flattened to a tenth: almost horizontal under an overhead sun.
#[test]
fn normals_transformed_by_the_objects_own_matrix_lean_by_79_degrees() {
    let press = DMat4::from_scale(DVec3::new(1.0, 0.1, 1.0))
        * DMat4::from_rotation_x(-0.25 * std::f64::consts::PI);
    let (mut scene, view) = scene(&[(square(), at(50.0, 0.0, 0.0, 0.0) * press)]);
    edit(&mut scene, FIRST, |object| {
        object.material = MaterialChoice::Own(Material::matte([0.0; 3], [1.0; 3]));
    });
    let lit: Vec<LightId> = scene.lights.iter().map(|(id, _)| id).collect();
    for id in lit {
        let mut light: Light = scene.lights.get(id).unwrap().clone();
        light.on = matches!(light.kind, LightKind::Sun { .. });
        let item = marraztu_core::scene::Item::Light(id, Box::new(light));
        marraztu_core::scene::Command::Replace(item).apply(&mut scene).unwrap();
    }
    let angle = |stretched| {
        let settings = Settings { stretched, ..Settings::default() };
        let picture = draw(&scene, &unmarked(view.clone()), &settings, 100);
        f64::from(picture.pixel(50, 50)[1]) / 255.0
    };
    let (right, wrong) = (angle(NormalMatrix::Cofactor), angle(NormalMatrix::AsItIs));
    let apart = wrong.acos().to_degrees() - right.acos().to_degrees();
    assert!((right - 100.0_f64 / 101.0_f64.sqrt() / 10.0).abs() < 0.004, "{right}");
    assert!((apart - 78.58).abs() < 1.0, "{apart}");
}

/// A two-sided sheet is seen from behind, while its normal, transformed like the surface, points to
/// the observer.
#[test]
fn normals_of_light_do_not_decide_which_side_is_seen() {
    let turn = DMat4::from_rotation_y(0.25 * std::f64::consts::PI);
    let stretch = DMat4::from_scale(DVec3::new(1.0, 1.0, 10.0));
    let placed = at(20.0, 0.0, 0.0, 0.0) * turn * stretch * turn;
    let (mut scene, view) = scene(&[(square(), placed)]);
    edit(&mut scene, FIRST, |object| object.sides = Sides::Two);
    let seen = |stretched| {
        let settings = Settings { stretched, ..Settings::default() };
        primitives(&scene, &unmarked(view.clone()), &settings, 100)
    };
    let right = seen(NormalMatrix::Cofactor);
    assert!(right.iter().any(|primitive| *primitive != 0));
    assert!(seen(NormalMatrix::AsItIs) == right);
}

#[test]
fn cut_off_colours_are_half_a_step_too_dark_and_a_pattern_keeps_the_mean() {
    let opened = lesson_scene("dusk").unwrap();
    let sum = |settings: &Settings| {
        let picture = draw(&opened.scene, &opened.view, settings, 256);
        let shown = picture.pixels().iter().filter(|pixel| pixel[0] > 0);
        let bytes = shown.map(|[r, g, b, _]| f64::from(*r) + f64::from(*g) + f64::from(*b));
        bytes.sum::<f64>() / (3.0 * 256.0 * 256.0)
    };
    let usual = Settings::default();
    let nearest = sum(&usual);
    let truncated = sum(&Settings { rounding: Rounding::Truncated, ..usual }) - nearest;
    let dithered = sum(&Settings { rounding: Rounding::Dithered, ..usual }) - nearest;
    assert!((-0.55..-0.4).contains(&truncated), "{truncated}");
    assert!(dithered.abs() < 0.01, "{dithered}");
}

#[test]
fn rounding_is_the_same_wherever_light_is_evaluated_and_in_both_arithmetics() {
    use marraztu_core::accuracy::LightAt;
    let (scene, view) = scene(&[(ball(8), at(60.0, 0.0, 0.0, 0.0))]);
    for light in [LightAt::Face, LightAt::Vertex, LightAt::Pixel] {
        for arithmetic in [Arithmetic::F32, Arithmetic::F64] {
            let of = |rounding| {
                let settings = Settings { light, arithmetic, rounding, ..Settings::default() };
                draw(&scene, &unmarked(view.clone()), &settings, 96)
            };
            let nearest = of(Rounding::Nearest);
            for rounding in [Rounding::Truncated, Rounding::Dithered] {
                let other = of(rounding);
                assert_eq!(steps_apart(&other, &nearest), 1, "{light:?} {arithmetic:?}");
                let lower = nearest.pixels().iter().zip(other.pixels());
                let is_lower = lower.filter(|(a, b)| a[0] < b[0]).count();
                assert_eq!(is_lower > 0, rounding == Rounding::Dithered, "{light:?}");
            }
        }
    }
}

#[test]
fn each_four_bits_of_the_subpixel_grid_leave_fewer_wrong_pixels() {
    let turn = at(110.0, 1.23, -4.56, 0.0) * DMat4::from_rotation_y(0.321);
    let (scene, view) = scene(&[(ball(48), turn)]);
    let view = unmarked(view);
    let seen = |subpixels| {
        let settings = Settings { subpixels, ..Settings::default() };
        primitives(&scene, &view, &settings, 512)
    };
    let fine = seen(Subpixels::Bits12);
    for (subpixels, least, most) in [
        (Subpixels::Bits0, 0.06, 0.2),
        (Subpixels::Bits4, 0.004, 0.015),
        (Subpixels::Bits8, 0.0002, 0.002),
    ] {
        let wrong = differing(&seen(subpixels), &fine);
        assert!((least..most).contains(&wrong), "{subpixels:?}: {wrong}");
    }
}

#[test]
fn no_grid_hides_edges_behind_their_own_face() {
    let mut shown = [0; 2];
    for i in 0..20 {
        // A floor: its depth changes steeply from row to row.
        let turned = DMat4::from_rotation_x(-1.0 - 0.025 * f64::from(i))
            * DMat4::from_rotation_z(0.17 * f64::from(i));
        let (scene, view) = scene(&[(square(), at(100.0, 3.7, -40.3, 0.0) * turned)]);
        for (shown, subpixels) in shown.iter_mut().zip([Subpixels::Bits8, Subpixels::Bits12]) {
            let settings = Settings { subpixels, ..Settings::default() };
            let [with, without] = [true, false].map(|edges_over_fill| {
                let view = View { edges_over_fill, ..unmarked(view.clone()) };
                draw(&scene, &view, &settings, 200)
            });
            let pairs = with.pixels().iter().zip(without.pixels());
            *shown += pairs.filter(|(a, b)| a != b).count();
        }
    }
    let [usual, fine] = shown;
    assert!(usual > 2000 && usual.abs_diff(fine) * 100 < usual, "{usual} and {fine} pixels");
}

#[test]
fn far_from_the_origin_32_bits_lose_the_shape_of_things() {
    let opened = lesson_scene("far").unwrap();
    let seen = |vertices| {
        let settings = Settings { vertices, ..Settings::default() };
        primitives(&opened.scene, &opened.view, &settings, 400)
    };
    let exact = seen(VertexArithmetic::F64);
    let throughout = differing(&seen(VertexArithmetic::F32), &exact);
    assert!(throughout > 0.02, "{throughout}");
}

/// Hard case 29, in a picture.
#[test]
fn points_every_tenth_of_a_unit_leave_holes_nearer_than_97_units_and_none_beyond() {
    let pixel = |distance: f64| 2.0 * (2.0_f64.sqrt() - 1.0) * distance / 800.0;
    let holes = |distance: f64| {
        let place = at(10.0 * pixel(distance), 0.0, 0.0, 400.0 - distance);
        let (scene, view) = scene(&[(square(), place)]);
        let settings = Settings { coverage: Coverage::Points, ..Settings::default() };
        let picture = draw(&scene, &unmarked(view), &settings, 800);
        let seen = covered(&picture, &scene);
        let inner = (391..409).flat_map(|y| (391..409).map(move |x| y * 800 + x));
        inner.filter(|i| !seen[*i]).count()
    };
    for distance in [98.0, 400.0, 966.0] {
        assert_eq!(holes(distance), 0, "at {distance}");
    }
    for distance in [60.0, 80.0] {
        assert!(holes(distance) > 20, "at {distance}: {}", holes(distance));
    }
}

#[test]
fn rounded_rows_and_32_bit_edges_cover_every_covered_pixel_and_a_few_more() {
    let (scene, view) = scene(&[(ball(12), at(90.0, 3.3, -7.7, 0.0))]);
    let view = unmarked(view);
    let seen = |coverage| {
        let settings = Settings { coverage, ..Settings::default() };
        covered(&draw(&scene, &view, &settings, 300), &scene)
    };
    let exact = seen(Coverage::Exact);
    let count = |seen: &[bool]| seen.iter().filter(|seen| **seen).count() as f64;
    for (coverage, most) in [(Coverage::ScanLines, 1.06), (Coverage::F32Edges, 1.0005)] {
        let other = seen(coverage);
        let lost = exact.iter().zip(&other).filter(|(exact, other)| **exact && !**other).count();
        // Rounding removes on one side what it adds on the other.
        assert!(lost as f64 <= 0.01 * count(&exact), "{coverage:?}: {lost}");
        let ratio = count(&other) / count(&exact);
        assert!((0.9995..most).contains(&ratio), "{coverage:?}: {ratio}");
    }
}

#[test]
fn if_surfaces_are_far_apart_every_depth_format_shows_the_same() {
    let (scene, view) = marraztu_io::default_scene();
    let seen = |depth| {
        let settings = Settings { depth, ..Settings::default() };
        primitives(&scene, &view, &settings, 400)
    };
    let usual = seen(DepthFormat::F32Reversed);
    for depth in [DepthFormat::F32, DepthFormat::Bits24] {
        let other = differing(&seen(depth), &usual);
        assert!(other < 0.001, "{depth:?}: {other}");
    }
}

/// Two squares that face the eye at about 1000, the newer one slightly nearer.
#[test]
fn a_format_tells_surfaces_apart_that_are_farther_apart_than_its_step() {
    let is_right = |apart: f64, depth| {
        let far = (square(), at(100.0, 0.0, 0.0, -600.0));
        let near = (square(), at(100.0, 0.0, 0.0, apart - 600.0));
        let (mut scene, view) = scene(&[far, near]);
        edit(&mut scene, FIRST, |object| object.material = matt([0.0, 0.0, 1.0]));
        edit(&mut scene, SECOND, |object| object.material = matt([1.0, 0.0, 0.0]));
        let settings = Settings { depth, ..Settings::default() };
        let [r, _, b, _] = draw(&scene, &unmarked(view), &settings, 64).pixel(32, 32);
        r > b
    };
    for (depth, step) in [
        (DepthFormat::Bits16, 15.3),
        (DepthFormat::Bits24, 0.060),
        (DepthFormat::F32, 0.060),
        (DepthFormat::F32Reversed, 5.8e-5),
    ] {
        assert!(is_right(1.2 * step, depth), "{depth:?}");
        let finer = (1..20).map(|i| is_right(step * f64::from(i) / 40.0, depth));
        assert!(finer.filter(|right| !right).count() > 5, "{depth:?}");
    }
}

#[test]
fn a_floor_bends_without_perspective() {
    let opened = lesson_scene("floor").unwrap();
    let picture = |interpolation| {
        let settings = Settings { interpolation, ..Settings::default() };
        draw(&opened.scene, &opened.view, &settings, 300)
    };
    let exact = picture(Interpolation::Perspective);
    let wrong = |picture: &Picture| {
        let pairs = picture.pixels().iter().zip(exact.pixels());
        pairs.filter(|(a, b)| (0..3).any(|i| a[i].abs_diff(b[i]) > 20)).count()
    };
    let shown = covered(&exact, &opened.scene).iter().filter(|seen| **seen).count();
    let affine = wrong(&picture(Interpolation::Affine));
    assert!(affine * 5 > shown, "{affine} of {shown}");
}

#[test]
fn seen_from_afar_a_texture_is_its_mean() {
    let opened = lesson_scene("floor").unwrap();
    let row = |filter| {
        let settings = Settings { filter, ..Settings::default() };
        let picture = draw(&opened.scene, &opened.view, &settings, 200);
        // Two rows below the floor's far end, where a pixel covers many texels.
        let first = (0..200).find(|y| picture.pixel(100, *y) != opened.scene.background.opaque());
        let y = first.unwrap() + 1;
        let spread: Vec<u8> = (95..105).map(|x| picture.pixel(x, y)[0]).collect();
        spread.iter().max().unwrap() - spread.iter().min().unwrap()
    };
    let mean = row(Filter::Trilinear);
    assert!(mean * 3 < row(Filter::Nearest).max(3), "{mean}");
}

#[test]
fn presets_of_history_show_their_faults_and_list_them() {
    let history = ACCURACY_PRESETS.iter().filter(|preset| !preset.faults.is_empty());
    let words: Vec<&str> = history.clone().map(|preset| preset.word).collect();
    assert_eq!(words, ["ancestor-a", "ancestor-b"]);
    let opened = lesson_scene("near").unwrap();
    let usual =
        covered(&draw(&opened.scene, &opened.view, &Settings::default(), 800), &opened.scene);
    for preset in history {
        let settings = preset.of(&Settings::default());
        let Points::Listed(points) = preset.points else { panic!("an ancestor lists its points") };
        for (key, word) in points {
            assert_eq!(Axis::named(key).unwrap().chosen(&settings).word, *word);
        }
        let picture = draw(&opened.scene, &opened.view, &settings, 800);
        let seen = covered(&picture, &opened.scene);
        let holes = usual.iter().zip(&seen).filter(|(usual, seen)| **usual && !**seen).count();
        assert_eq!(holes > 1000, settings.coverage == Coverage::Points, "{}", preset.word);
    }
}

/// A floor and walls along the direction of view, which ancestor A's lattice of points misses. The
/// preset lists this as a fault.
#[test]
fn points_leave_out_surfaces_along_the_direction_of_view_and_the_preset_says_so() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let floor = DMat4::from_translation(DVec3::new(0.0, -40.0, 0.0))
        * DMat4::from_rotation_x(-quarter)
        * DMat4::from_scale(DVec3::splat(300.0));
    // The floor, a wall on the left, and the same in a roll of 30 degrees.
    for roll in [0.0, -quarter, 0.5] {
        let (mut scene, view) = scene(&[(square(), DMat4::from_rotation_z(roll) * floor)]);
        edit(&mut scene, FIRST, |object| object.sides = Sides::Two);
        let view = unmarked(view);
        let seen = |coverage| {
            let settings = Settings { coverage, ..Settings::default() };
            let seen = covered(&draw(&scene, &view, &settings, 200), &scene);
            seen.iter().filter(|seen| **seen).count()
        };
        let [exact, points] = [seen(Coverage::Exact), seen(Coverage::Points)];
        assert!(exact > 5000 && points * 20 < exact, "{points} of {exact} at {roll}");
    }
    let says_so = |fault: &&str| fault.contains("along the direction of view");
    let lists = |word| AccuracyPreset::named(word).unwrap().faults.iter().any(says_so);
    assert!(lists("ancestor-a") && !lists("ancestor-b"));
}
