//! Sharing of computed normals between polygons: creases and smoothing groups.
//!
//! Catches: cubes shaded like pillows, faceted cylinders, groups that are ignored or end with a
//! chunk, faces joined across a corner, work quadratic in the faces at a vertex.

#![expect(clippy::unwrap_used, reason = "a helper of tests that fails is a test that fails")]

use std::fmt::Write as _;

use glam::DVec3;
use marraztu_core::scene::{Crease, LoadOptions, Mesh, Smoothing, Winding, dvec3, newell};
use marraztu_io::{FindingKind, Loaded, Progress, describe, parse};
use marraztu_render::accel::Accelerated as _;
use proptest::prelude::*;

fn read_with(text: &str, options: &LoadOptions) -> Loaded {
    parse(text.as_bytes(), "a.obj", None, options, &Progress::new()).unwrap()
}

fn crease(degrees: f64) -> LoadOptions {
    LoadOptions { crease: Crease::new(degrees).unwrap(), ..LoadOptions::default() }
}

fn mesh(text: &str, degrees: f64) -> Mesh {
    read_with(text, &crease(degrees)).model.mesh
}

/// The computed normals at the corners of a polygon.
fn computed(mesh: &Mesh, polygon: usize) -> Vec<[f32; 3]> {
    let corners = mesh.polygon(u32::try_from(polygon).unwrap()).iter();
    corners.map(|corner| mesh.points()[corner.smooth as usize].normal).collect()
}

/// The polygons with the face normal at every corner.
fn flat(mesh: &Mesh) -> Vec<usize> {
    let own = |polygon: &usize| {
        let normal = dvec3(mesh.polygon_normals()[*polygon]);
        computed(mesh, *polygon).iter().all(|corner| dvec3(*corner).distance(normal) < 1e-6)
    };
    (0..mesh.polygon_count()).filter(own).collect()
}

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/// The same triangulated cube, rotated about an oblique axis, with six decimals.
fn turned_cube() -> String {
    let turn = glam::DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize_or_zero(), 1.0);
    let mut text = String::new();
    for i in 0..8_u8 {
        let p = turn * DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        writeln!(text, "v {:.6} {:.6} {:.6}", p.x, p.y, p.z).unwrap();
    }
    for [a, b, c, d] in
        [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]]
    {
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
    }
    text
}

/// A cylinder around +Y from y = 0 to y = 1: `sides` quads, then the top and the bottom.
fn cylinder(sides: u32) -> String {
    let mut text = String::new();
    for i in 0..sides {
        let (x, z) = libm::sincos(f64::from(i) / f64::from(sides) * std::f64::consts::TAU);
        writeln!(text, "v {x} 0 {z}\nv {x} 1 {z}").unwrap();
    }
    for i in 0..sides {
        let (a, b) = (2 * i + 1, 2 * ((i + 1) % sides) + 1);
        writeln!(text, "f {a} {b} {} {}", b + 1, a + 1).unwrap();
    }
    let list = |numbers: &mut dyn Iterator<Item = u32>| {
        numbers.map(|i| i.to_string()).collect::<Vec<_>>().join(" ")
    };
    writeln!(text, "f {}", list(&mut (0..sides).map(|i| 2 * i + 2))).unwrap();
    writeln!(text, "f {}", list(&mut (0..sides).rev().map(|i| 2 * i + 1))).unwrap();
    text
}

#[test]
fn a_cube_without_normals_has_flat_faces() {
    let loaded = read_with(CUBE, &LoadOptions::default());
    assert_eq!(flat(&loaded.model.mesh), [0, 1, 2, 3, 4, 5]);
    assert_eq!(loaded.model.mesh.points().len(), 24);
    assert!(describe(&loaded).contains("\nsmoothing       crease 60 degrees\n"));
    let triangles = read_with(&turned_cube(), &LoadOptions::default()).model.mesh;
    assert_eq!(flat(&triangles).len(), 12);
    assert_eq!(triangles.points().len(), 24, "both triangles of a side share their points");
}

#[test]
fn at_180_degrees_all_faces_around_a_vertex_are_smooth() {
    let cube = mesh(CUBE, 180.0);
    assert_eq!(cube.points().len(), 8);
    let third = 1.0 / 3.0_f64.sqrt();
    for point in cube.points() {
        let at = dvec3(cube.positions()[point.position as usize]) * 2.0 - DVec3::ONE;
        assert!(dvec3(point.normal).distance(at * third) < 1e-6, "{point:?}");
    }
}

#[test]
fn an_edge_of_exactly_the_crease_angle_is_sharp() {
    for text in [CUBE, &turned_cube()] {
        assert!(flat(&mesh(text, 91.0)).is_empty());
        assert_eq!(mesh(text, 91.0).points().len(), 8);
        for degrees in [90.0, 89.999, 0.0] {
            let cube = mesh(text, degrees);
            assert_eq!(flat(&cube).len(), cube.polygon_count(), "{degrees}");
        }
    }
}

/// A prism around +Y with coordinates of `decimals` decimals, turned about an oblique axis.
fn prism(sides: u32, radius: f64, degrees: f64, decimals: usize) -> String {
    let axis = DVec3::new(1.0, 2.0, 3.0).normalize_or_zero();
    let turn = glam::DMat3::from_axis_angle(axis, degrees.to_radians());
    let place = |line: &str| {
        let Some(rest) = line.strip_prefix("v ") else { return format!("{line}\n") };
        let numbers: Vec<f64> = rest.split(' ').map(|word| word.parse().unwrap()).collect();
        let p = turn * (radius * DVec3::from_slice(&numbers));
        format!("v {:.decimals$} {:.decimals$} {:.decimals$}\n", p.x, p.y, p.z)
    };
    cylinder(sides).lines().map(place).collect()
}

#[test]
fn hexagonal_prisms_have_sharp_edges_however_their_numbers_are_rounded() {
    for (radius, decimals) in [(1.0, 17), (1.0, 6), (1.0, 3), (8.66, 3), (1000.0, 0), (0.01, 5)] {
        for degrees in [0.0, 7.0, 30.0, 61.0, 90.0, 123.0] {
            let hexagon = mesh(&prism(6, radius, degrees, decimals), 60.0);
            let text = format!("radius {radius}, {decimals} decimals, {degrees} degrees");
            assert_eq!(hexagon.points().len(), 36, "{text}");
            let heptagon = mesh(&prism(7, radius, degrees, decimals), 60.0);
            assert_eq!(heptagon.points().len(), 28, "{text}");
        }
    }
}

#[test]
fn a_cylinder_is_smooth_around_and_sharp_at_its_caps() {
    let cylinder = mesh(&cylinder(16), 60.0);
    assert_eq!(flat(&cylinder), [16, 17]);
    for side in 0..16 {
        for (corner, normal) in
            cylinder.polygon(side).iter().zip(computed(&cylinder, side as usize))
        {
            let [x, _, z] = cylinder.positions()[corner.position as usize];
            assert!(dvec3(normal).distance(dvec3([x, 0.0, z])) < 1e-6, "{normal:?}");
        }
    }
}

#[test]
fn a_fine_mesh_has_the_same_points_at_any_crease_above_its_angles() {
    let ball = {
        // A torus: closed and smooth everywhere, with faces in mixed order.
        let (rings, sides) = (60_u32, 40_u32);
        let mut text = String::new();
        for i in 0..rings {
            for j in 0..sides {
                let turn = |i: u32, of: u32| f64::from(i) / f64::from(of) * std::f64::consts::TAU;
                let ((s, c), (t, d)) = (libm::sincos(turn(i, rings)), libm::sincos(turn(j, sides)));
                let r = 3.0 + d;
                writeln!(text, "v {:.6} {:.6} {:.6}", r * c, t, -r * s).unwrap();
            }
        }
        for k in 0..rings * sides {
            let k = k * 1117 % (rings * sides);
            let (i, j) = (k / sides, k % sides);
            let at = |i: u32, j: u32| i % rings * sides + j % sides + 1;
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            writeln!(text, "f {a} {c} {b}\nf {a} {d} {c}").unwrap();
        }
        text
    };
    let smooth = mesh(&ball, 180.0);
    for degrees in [20.0, 60.0, 179.0] {
        let other = mesh(&ball, degrees);
        assert_eq!(other.points(), smooth.points(), "{degrees}");
        assert_eq!(other.corners(), smooth.corners(), "{degrees}");
    }
    let groups = mesh(&format!("s 7\n{ball}"), 60.0);
    assert_eq!(groups.points(), smooth.points());
}

#[test]
fn faces_that_touch_in_a_vertex_alone_are_not_smooth_with_each_other() {
    let tents = "v 0 0 0\nv 1 0 0.1\nv 0 1 0.1\nv -1 0 0.1\nv 0 -1 0.1\nf 1 2 3\nf 1 4 5\n";
    assert_eq!(flat(&mesh(tents, 60.0)), [0, 1]);
    assert!(flat(&mesh(tents, 180.0)).is_empty());
}

#[test]
fn faces_without_area_join_nothing_and_a_vertex_named_twice_counts_once() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv -1 0 0.1\nv 0 -1 0.1\nf 1 2 3\nf 1 3 4\nf 1 2 2\n\
                f 1 4 1 3 4\n";
    let mesh = mesh(text, 60.0);
    let sum = [0, 1, 3].map(|polygon| dvec3(mesh.polygon_normals()[polygon]));
    let mean = (sum[0] + sum[1] + sum[2]).normalize_or_zero();
    assert!(dvec3(computed(&mesh, 0)[0]).distance(mean) < 1e-6);
}

#[test]
fn turned_polygons_have_the_opposite_normals() {
    let turned = LoadOptions { winding: Winding::Turned, ..LoadOptions::default() };
    let text = cylinder(9);
    let [kept, turned] =
        [LoadOptions::default(), turned].map(|options| read_with(&text, &options).model.mesh);
    for polygon in 0..kept.polygon_count() {
        let mut opposite = computed(&turned, polygon);
        opposite.reverse();
        let opposite: Vec<[f32; 3]> = opposite.iter().map(|n| n.map(|x| 0.0 - x)).collect();
        let own: Vec<[f32; 3]> =
            computed(&kept, polygon).iter().map(|n| n.map(|x| 0.0 + x)).collect();
        assert_eq!(own, opposite);
    }
}

/// A staircase of squares: square i is in the group `groups[i]`.
fn stairs(groups: &[&str]) -> String {
    let mut text = String::from("v 0 0 0\nv 0 0 1\n");
    for (i, group) in (1..).zip(groups) {
        let (x, y) = (i / 2 + i % 2, i / 2);
        writeln!(text, "v {x} {y} 0\nv {x} {y} 1").unwrap();
        if !group.is_empty() {
            writeln!(text, "{group}").unwrap();
        }
        writeln!(text, "f -4 -3 -1 -2").unwrap();
    }
    text
}

#[test]
fn faces_of_one_group_are_smooth_and_faces_without_one_are_flat() {
    let loaded = read_with(
        &stairs(&["", "s 1", "", "s 2", "", "s off", "", "s 1", "s 0", ""]),
        &crease(1.0),
    );
    assert_eq!(loaded.findings, []);
    let mesh = &loaded.model.mesh;
    let right = vec![0, 1, 1, 2, 2, 0, 0, 1, 0, 0];
    assert_eq!(mesh.smoothing(), &Smoothing::Groups(right));
    // The first square comes before any group, the eighth has neighbours without a group.
    assert_eq!(flat(mesh), [0, 5, 6, 7, 8, 9]);
    // Squares 1 and 2 share vertices 4 and 5, at a right angle.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let shared: Vec<[f32; 3]> = computed(mesh, 1)[2..].to_vec();
    assert!(
        shared.iter().all(|n| n[0].abs() > half - 1e-6 && n[1].abs() > half - 1e-6),
        "{shared:?}"
    );
    assert!(describe(&loaded).contains("\nsmoothing       2 groups\n"));
    let off = read_with(&stairs(&["s off", "", ""]), &LoadOptions::default());
    assert_eq!(flat(&off.model.mesh), [0, 1, 2]);
    assert!(describe(&off).contains("\nsmoothing       off\n"));
}

#[test]
fn on_is_a_group_and_capital_letters_do_not_matter() {
    let loaded = read_with(&stairs(&["s on", "s OFF", "s On"]), &LoadOptions::default());
    assert_eq!(loaded.model.mesh.smoothing(), &Smoothing::Groups(vec![1, 0, 1]));
    // Sets of 32 bits, with or without a sign: the highest bit, and all of them.
    let sets = ["s -2147483648", "s 2147483648", "s 4294967295"];
    let loaded = read_with(&stairs(&sets), &LoadOptions::default());
    let right = vec![1 << 31, 1 << 31, u32::MAX - 1];
    assert_eq!(loaded.model.mesh.smoothing(), &Smoothing::Groups(right));
    assert!(loaded.findings.is_empty(), "{:?}", loaded.findings);
}

#[test]
fn a_group_joins_faces_that_share_a_vertex_alone() {
    let tents = "v 0 0 0\nv 1 0 1\nv 0 1 1\nv -1 0 1\nv 0 -1 1\ns 3\nf 1 2 3\nf 1 4 5\n\
                 s 4\nf 1 3 4\n";
    let mesh = mesh(tents, 60.0);
    assert_eq!(computed(&mesh, 0)[0], computed(&mesh, 1)[0]);
    assert_eq!(flat(&mesh), [2]);
}

#[test]
fn a_group_that_cannot_be_read_is_off_and_a_finding() {
    let loaded =
        read_with(&stairs(&["s 1 # one", "s abc", "s", "s 1 2", "s -1", "s 1"]), &crease(60.0));
    let [finding] = &loaded.findings[..] else { panic!("{:?}", loaded.findings) };
    assert_eq!((finding.kind, finding.line), (FindingKind::SmoothingUnreadable, Some(9)));
    assert_eq!(
        finding.text,
        "3 smoothing groups are neither numbers nor \"on\" or \"off\" (such as \"abc\") and are \
         taken as off (first: line 9)"
    );
    assert_eq!(
        loaded.model.mesh.smoothing(),
        &Smoothing::Groups(vec![1, 0, 0, 0, u32::MAX - 1, 1])
    );
}

#[test]
fn normals_of_the_file_are_used_where_they_are_and_the_others_are_computed() {
    let text = CUBE.replace("f 4 3 2 1", "vn 0 1 1\nf 4//1 3//1 2//1 1//1");
    let mesh = mesh(&text, 60.0);
    let filed = |polygon: u32| {
        let corner = mesh.polygon(polygon)[0];
        mesh.points()[corner.filed as usize].normal
    };
    let half = std::f32::consts::FRAC_1_SQRT_2;
    assert_eq!(filed(0), [0.0, half, half]);
    assert_eq!(filed(1), [0.0, 0.0, 1.0]);
    assert_eq!(flat(&mesh).len(), 6);
    assert!(mesh.has_file_normals() && !mesh.has_file_normals_only());
}

/// Bumpy ground of squares, optionally with smoothing groups that last for hundreds of lines.
fn ground(side: u32, groups: bool) -> String {
    let mut text = String::new();
    for i in 0..side * side {
        let height = (i % side * 7919 + i / side * 104_729) % 13;
        writeln!(text, "v {} {}.{height:02} {}", i % side, height / 4, i / side).unwrap();
    }
    for i in 0..side * (side - 1) {
        if groups && i % 701 == 350 {
            let group = i / 701 % 5;
            writeln!(text, "s {}", if group == 0 { "off".to_owned() } else { group.to_string() })
                .unwrap();
        }
        if i % side != side - 1 {
            let [a, b, c, d] = [i, i + side, i + side + 1, i + 1].map(|i| i + 1);
            if i % 3 == 0 {
                writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
            } else {
                writeln!(text, "f {a} {b} {c} {d}").unwrap();
            }
        }
    }
    text
}

#[test]
fn normals_are_the_same_however_many_threads_compute_them() {
    for text in [ground(120, false), ground(120, true)] {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| mesh(&text, 45.0))
        };
        let one = with(1);
        let flat = flat(&one).len();
        assert!(flat > 100 && flat < one.polygon_count() - 100, "{flat}");
        for threads in [2, 3, 8] {
            assert!(with(threads) == one, "{threads}");
        }
    }
}

#[test]
fn a_smoothing_group_continues_in_the_next_chunk() {
    let text = ground(120, true);
    let mesh = mesh(&text, 45.0);
    let mut right = Vec::new();
    let mut group = 0;
    for line in text.lines() {
        match line.split_once(' ') {
            Some(("s", name)) => group = name.parse().unwrap_or(0),
            Some(("f", _)) => right.push(group),
            _ => {}
        }
    }
    assert_eq!(mesh.smoothing(), &Smoothing::Groups(right));
}

#[test]
fn a_hundred_thousand_faces_around_one_vertex_or_edge_take_no_longer_than_separate_ones() {
    let count = 100_000_u32;
    let mut fan = String::from("v 0 1 0\n");
    let mut book = String::from("v 0 0 0\nv 0 1 0\n");
    for i in 0..count {
        let (x, z) = libm::sincos(f64::from(i) / f64::from(count) * std::f64::consts::TAU);
        writeln!(fan, "v {x} 0 {z}").unwrap();
        writeln!(fan, "f 1 {} {}", i + 2, (i + 1) % count + 2).unwrap();
        writeln!(book, "v {x} 0 {z}\nf 1 2 {}", i + 3).unwrap();
    }
    let fan = mesh(&fan, 60.0);
    assert_eq!(fan.points().len(), count as usize + 1);
    let tip = dvec3(fan.points()[0].normal);
    assert!(tip.distance(DVec3::Y) < 1e-4, "{tip}");
    // All pages are joined, so their normals cancel, and the face normals remain.
    let pages = mesh(&book, 1.0);
    assert_eq!(flat(&pages).len(), count as usize);
    assert_eq!(pages.points().len(), 3 * count as usize);
    let same = mesh(&format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}", "f 1 2 3\n".repeat(100_000)), 60.0);
    assert_eq!(same.points().len(), 3);
}

#[test]
fn another_crease_gives_the_mesh_that_loading_with_it_gives() {
    let text = CUBE.replace("f 4 3 2 1", "vn 0 1 1\nf 4//1 3//1 2//1 1//1");
    for text in [text, cylinder(16), ground(20, false)] {
        let models =
            [0.0, 45.0, 60.0, 180.0].map(|degrees| read_with(&text, &crease(degrees)).model);
        for from in &models {
            for to in &models {
                let other = from.with_crease(to.options.crease);
                assert_eq!(&other, to);
                assert_eq!(other.mesh.draw_order(), to.mesh.draw_order());
                assert!(
                    other.shares_file_with(from) && !other.shares_file_with(to)
                        || std::ptr::eq(from, to)
                );
            }
        }
    }
    let groups = read_with(&stairs(&["s 1", "", "s 2"]), &crease(60.0)).model;
    assert_eq!(groups.with_crease(Crease::SMOOTH).mesh, groups.mesh);
}

/// The normal of each corner straight from the definition, at any cost in time.
fn by_definition(mesh: &Mesh, crease: f64) -> Vec<Vec<DVec3>> {
    let count = mesh.polygon_count();
    let vertices: Vec<Vec<u32>> = (0..u32::try_from(count).unwrap())
        .map(|polygon| mesh.polygon(polygon).iter().map(|corner| corner.position).collect())
        .collect();
    let normal = |polygon: &Vec<u32>| {
        let sum = newell(polygon.iter().map(|i| dvec3(mesh.positions()[*i as usize])));
        sum.try_normalize()
    };
    let normals: Vec<Option<DVec3>> = vertices.iter().map(normal).collect();
    // The neighbours of a vertex along a polygon's outline.
    let beside = |polygon: usize, vertex: u32| -> Vec<u32> {
        let own = &vertices[polygon];
        let n = own.len();
        let at = (0..n).filter(|i| own[*i] == vertex);
        at.flat_map(|i| [own[(i + 1) % n], own[(i + n - 1) % n]])
            .filter(|other| *other != vertex)
            .collect()
    };
    let joined = |a: usize, b: usize, vertex: u32| {
        let (Some(m), Some(n)) = (normals[a], normals[b]) else { return false };
        let angle = 2.0 * libm::atan2((m - n).length(), (m + n).length()).to_degrees();
        let ends = beside(b, vertex);
        angle <= (crease - 0.25).max(1e-4) && beside(a, vertex).iter().any(|end| ends.contains(end))
    };
    let of_corner = |polygon: usize, vertex: u32| {
        let mut fan = vec![polygon];
        let mut next = 0;
        while next < fan.len() {
            for other in 0..count {
                if !fan.contains(&other) && joined(fan[next], other, vertex) {
                    fan.push(other);
                }
            }
            next += 1;
        }
        let sum: DVec3 = fan.iter().filter_map(|face| normals[*face]).sum();
        if sum.length() > 1e-9 {
            sum.normalize_or_zero()
        } else {
            normals[polygon].unwrap_or(DVec3::ZERO)
        }
    };
    (0..count)
        .map(|polygon| vertices[polygon].iter().map(|vertex| of_corner(polygon, *vertex)).collect())
        .collect()
}

proptest! {
    /// Faces of any shape over a few vertices: many per vertex, many per edge, some without area.
    #[test]
    fn normals_are_as_defined(
        places in prop::collection::vec([0..4_i32, 0..4_i32, 0..4_i32], 4..9),
        faces in prop::collection::vec(prop::collection::vec(0..4_usize, 3..5), 1..30),
        sheet in 0..3_usize,
        crease in prop::sample::select(vec![0.0, 11.3, 33.7, 60.0, 90.0, 131.1, 179.0]),
    ) {
        let mut text = String::new();
        for [x, y, z] in &places {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        for (i, face) in faces.iter().enumerate() {
            text += "f";
            for corner in face {
                write!(text, " {}", (corner + i * sheet) % places.len() + 1).unwrap();
            }
            text += "\n";
        }
        let mesh = mesh(&text, crease);
        for (polygon, right) in by_definition(&mesh, crease).into_iter().enumerate() {
            for (normal, right) in computed(&mesh, polygon).into_iter().zip(right) {
                // A face without area has no normal.
                prop_assert!(
                    right == DVec3::ZERO || dvec3(normal).distance(right) < 1e-6,
                    "polygon {polygon}: {normal:?} is not {right}\n{text}"
                );
            }
        }
    }
}
