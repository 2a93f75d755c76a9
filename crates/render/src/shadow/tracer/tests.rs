//! Compares rays with an oracle that shares no code: determinants of 128-bit integers.

use crate::accel::Accelerated as _;
use glam::DMat4;

use super::*;
use crate::frame::shadows::CasterPart;
use marraztu_core::base::Shared;
use marraztu_core::base::rng::Rng;
use marraztu_core::scene::{ItemId, Mesh, MeshSource, Model, ObjectId, SourceCorner};

type Point = [i128; 3];

/// (b - a) x (c - a) . (d - a)
fn volume([a, b, c, d]: [Point; 4]) -> i128 {
    let from = |p: Point| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v, w) = (from(b), from(c), from(d));
    (u[1] * v[2] - u[2] * v[1]) * w[0]
        + (u[2] * v[0] - u[0] * v[2]) * w[1]
        + (u[0] * v[1] - u[1] * v[0]) * w[2]
}

/// Returns whether the open segment from p to l crosses the triangle's plane in one point, inside
/// the triangle or on its border.
fn stands_between([a, b, c]: [Point; 3], p: Point, l: Point) -> bool {
    let (sp, sl) = (volume([a, b, c, p]).signum(), volume([a, b, c, l]).signum());
    let around = [[a, b], [b, c], [c, a]].map(|[u, v]| volume([p, l, u, v]).signum());
    sp * sl < 0 && (around.iter().all(|x| *x >= 0) || around.iter().all(|x| *x <= 0))
}

fn mesh_of(triangles: &[[Point; 3]]) -> Shared<Model> {
    let count = u32::try_from(triangles.len()).unwrap();
    let source = MeshSource {
        positions: triangles.iter().flatten().map(|p| p.map(|x| x as f32)).collect(),
        ..MeshSource::of_polygons((0..3 * count).map(SourceCorner::bare), vec![3; triangles.len()])
    };
    let mesh = Mesh::new(source).expect("a good mesh");
    rayon::scope(|_| _ = mesh.bvh());
    Shared::new(Model::of_mesh("mesh", mesh))
}

fn shadows_of(casters: &[(Vec<[Point; 3]>, Point)], light: Point) -> Shadows {
    let caster = |(i, (triangles, at)): (usize, &(Vec<[Point; 3]>, Point))| Caster {
        item: ItemId::Object(ObjectId(u32::try_from(i).unwrap())),
        model: mesh_of(triangles),
        world_from_object: DMat4::from_translation(float(*at)),
        parts: vec![Some(CasterPart::default())],
        polygons: None,
    };
    Shadows {
        radii: Vec::new(),
        samples: 1,
        sources: vec![Some(ShadowSource::Point(float(light)))],
        casters: casters.iter().enumerate().map(caster).collect(),
    }
}

fn float(p: Point) -> DVec3 {
    DVec3::from_array(p.map(|x| x as f64))
}

fn traced(shadows: &Shadows, points: &[Point]) -> u64 {
    let tracer = Tracer::of(shadows, Filter::Bilinear, ShadowMethod::Exact);
    let mut scratch = RayScratch::default();
    scratch.origins.begin(None, false);
    for (i, point) in points.iter().enumerate() {
        scratch.origins.set(i, float(*point), [0; 2], 0);
    }
    let mask = u64::MAX >> (64 - points.len());
    let light = tracer.light(0).expect("it casts shadows");
    let all = tracer.shaded(crate::simd::levels()[0], light, &mut scratch, mask);
    assert_eq!(all, tracer.shaded(Level::new(), light, &mut scratch, mask), "on another level");
    all
}

/// Returns small coordinates, so rays often meet planes, edges and corners exactly.
fn small(rng: &mut Rng, range: i128) -> Point {
    let side = usize::try_from(2 * range + 1).unwrap();
    [0; 3].map(|_| i128::try_from(rng.index(side)).unwrap() - range)
}

#[test]
fn every_ray_is_decided_as_whole_numbers_decide_it() {
    let mut rng = Rng::new(5);
    let (mut rays, mut stopped) = (0, 0);
    for round in 0..400 {
        let range = [2, 4, 30][round % 3];
        let triangle = |rng: &mut Rng| [0; 3].map(|_| small(rng, range));
        let casters: Vec<(Vec<[Point; 3]>, Point)> = (0..1 + round % 3)
            .map(|_| {
                ((0..1 + rng.index(12)).map(|_| triangle(&mut rng)).collect(), small(&mut rng, 3))
            })
            .collect();
        // Also far away, where f64 still holds every coordinate but the filter decides less.
        let far = if round % 5 == 0 { 1 << 40 } else { 0 };
        let casters: Vec<_> = casters
            .into_iter()
            .map(|(triangles, at)| (triangles, [at[0] + far, at[1], at[2] - far]))
            .collect();
        let moved = |p: Point| [p[0] + far, p[1], p[2] - far];
        let light = moved(small(&mut rng, 2 * range));
        let points: Vec<Point> = (0..64).map(|_| moved(small(&mut rng, 2 * range))).collect();
        let got = traced(&shadows_of(&casters, light), &points);
        for (i, p) in points.iter().enumerate() {
            let between = |at: &Point, corners: &[Point; 3]| {
                let world = corners.map(|c| [c[0] + at[0], c[1] + at[1], c[2] + at[2]]);
                stands_between(world, *p, light)
            };
            let want = casters
                .iter()
                .any(|(triangles, at)| triangles.iter().any(|corners| between(at, corners)));
            assert_eq!(got >> i & 1 == 1, want, "round {round}, point {p:?}, light {light:?}");
            rays += 1;
            stopped += usize::from(want);
        }
    }
    assert!(stopped > rays / 10 && stopped < rays * 9 / 10, "{stopped} of {rays}");
}

/// Points close together among many small casters: most casters are skipped by the shaft in world
/// space, and none that stops a ray.
#[test]
fn no_caster_that_stops_a_ray_is_skipped_among_many() {
    let mut rng = Rng::new(6);
    let (mut rays, mut stopped) = (0, 0);
    for round in 0..600 {
        let far = if round % 5 == 0 { 1 << 40 } else { 0 };
        let moved = |[x, y, z]: Point| [x + far, y, z - far];
        let add = |a: Point, b: Point| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        let (centre, light) = (small(&mut rng, 40), moved(small(&mut rng, 40)));
        let points: Vec<Point> =
            (0..64).map(|_| moved(add(centre, small(&mut rng, 1 + round % 4)))).collect();
        let casters: Vec<(Vec<[Point; 3]>, Point)> = (0..5 * FEW)
            .map(|_| {
                let triangle = [0; 3].map(|_| small(&mut rng, 12));
                (vec![triangle], moved(small(&mut rng, 40)))
            })
            .collect();
        let got = traced(&shadows_of(&casters, light), &points);
        for (i, p) in points.iter().enumerate() {
            let want = casters.iter().any(|(triangles, at)| {
                stands_between(triangles[0].map(|corner| add(corner, *at)), *p, light)
            });
            assert_eq!(got >> i & 1 == 1, want, "round {round}, point {p:?}, light {light:?}");
            rays += 1;
            stopped += usize::from(want);
        }
    }
    assert!(stopped > rays / 10 && stopped < rays * 9 / 10, "{stopped} of {rays}");
}

/// Returns an octahedron, each face divided into n^2 triangles: closed, with whole coordinates.
fn octahedron(n: i128) -> Vec<[Point; 3]> {
    let mut triangles = Vec::new();
    for signs in 0..8 {
        let place = |i: i128, j: i128| {
            let own = [i, j, n - i - j];
            [0, 1, 2].map(|axis| if signs >> axis & 1 == 1 { -own[axis] } else { own[axis] })
        };
        for i in 0..n {
            for j in 0..n - i {
                triangles.push([place(i, j), place(i + 1, j), place(i, j + 1)]);
                if i + j + 1 < n {
                    triangles.push([place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)]);
                }
            }
        }
    }
    triangles
}

#[test]
fn no_ray_passes_through_an_edge_or_a_corner_of_a_closed_body() {
    let n = 12;
    let triangles = octahedron(n);
    let mut aims: Vec<Point> = triangles.iter().flatten().map(|p| p.map(|x| 2 * x)).collect();
    // The middles of edges, with all coordinates doubled.
    for [a, b, c] in &triangles {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            aims.push([p[0] + q[0], p[1] + q[1], p[2] + q[2]]);
        }
    }
    let body: Vec<_> = triangles.iter().map(|t| t.map(|p| p.map(|x| 2 * x))).collect();
    for light in [[0, 0, 0], [1, -2, 3], [5, 7, 1]] {
        let shadows = shadows_of(&[(body.clone(), [0; 3])], light);
        // Behind each target, on the line from the light through it.
        let beyond = |p: &Point| [0, 1, 2].map(|i| p[i] + 3 * (p[i] - light[i]));
        let points: Vec<Point> = aims.iter().map(beyond).collect();
        for points in points.chunks(64) {
            let all = u64::MAX >> (64 - points.len());
            assert_eq!(traced(&shadows, points), all, "a ray passed");
        }
    }
}

#[test]
fn twenty_thousand_triangles_in_one_place_are_one_and_take_no_longer() {
    let mut triangles = vec![[[0, 0, 0], [4, 0, 0], [0, 4, 0]]; 20_000];
    triangles.push([[9, 9, 9], [9, 9, 8], [9, 8, 9]]);
    let model = mesh_of(&triangles);
    let tree = model.mesh.bvh();
    assert_eq!(tree.leaf(tree.root).count(), 2);
    let shadows = shadows_of(&[(triangles, [0; 3])], [1, 1, 5]);
    assert_eq!(traced(&shadows, &[[1, 1, -1], [5, 5, -1], [1, 1, 0]]), 0b001);
}

#[test]
fn a_tree_holds_every_triangle_once_inside_its_boxes() {
    let mut rng = Rng::new(3);
    let triangles: Vec<[Point; 3]> = (0..700)
        .map(|_| {
            let at = small(&mut rng, 500);
            [0; 3].map(|_| small(&mut rng, 9)).map(|p| [p[0] + at[0], p[1] + at[1], p[2] + at[2]])
        })
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    let model = mesh_of(&triangles);
    let tree = model.mesh.bvh();
    let mut seen = vec![0; triangles.len()];
    let mut open = vec![(tree.root, [[f32::NEG_INFINITY; 3], [f32::INFINITY; 3]])];
    while let Some((child, [low, high])) = open.pop() {
        if child.count == 0 {
            for (child, around) in tree.nodes[child.first as usize].children() {
                let inside = (0..3)
                    .all(|axis| around[0][axis] >= low[axis] && around[1][axis] <= high[axis]);
                assert!(inside, "a child's box sticks out");
                open.push((child, around));
            }
            continue;
        }
        for triangle in tree.leaf(child) {
            seen[triangle.number as usize] += 1;
            let inside = |p: &[f32; 3]| (0..3).all(|i| (low[i]..=high[i]).contains(&p[i]));
            assert!(triangle.corners.iter().all(inside), "a corner is outside of its box");
        }
    }
    assert!(seen.iter().all(|times| *times == 1));
}
