use fearless_simd::{SimdBase as _, SimdMask as _, i32x16, mask32x16};

use super::*;
use crate::raster::bins::LargeTriangle;
use crate::raster::depth_format::Format;
use crate::raster::edges_in_floats::FloatTriangle;
use crate::raster::large::Large;
use crate::raster::queue::{ROWS, SMALL};
use crate::raster::rule::{Fine, Rule, Unsnapped, Usual};
use crate::raster::scan_lines::ScanLines;
use crate::raster::small;
use crate::raster::tile_queues::packed;
use crate::raster::visibility_buffer::{Visible, seen};
use crate::screen::clip::ScreenVertex;
use crate::screen::coverage::{Grid, Snapped, Triangle};
use crate::screen::sample_positions::passes;
use crate::screen::tiles::TILE;
use marraztu_core::accuracy::Samples;
use marraztu_core::base::image::Size;
use marraztu_core::base::rng::Rng;

const SIZE: Size = Size { width: 150, height: 140 };
const PICTURE: PixelBox = PixelBox { left: 0, top: 0, right: 150, bottom: 140 };
const TILE_BOX: PixelBox = PixelBox { left: 0, top: 0, right: TILE, bottom: TILE };

/// Returns the centre, four samples and sixteen.
fn middle_and_others() -> [SamplePositions; 3] {
    [passes(Samples::One)[0], passes(Samples::Four)[0], passes(Samples::Sixteen)[0]]
}

/// Pseudo-random numbers.
fn numbers(seed: u64) -> impl FnMut(i32) -> i32 {
    let mut rng = Rng::new(seed);
    move |below| rng.between(0, below - 1)
}

fn bins(sample_positions: SamplePositions) -> Bins {
    let mut bins = Bins::default();
    bins.clear(SIZE, sample_positions);
    bins
}

/// Returns the pixels that a triangle may cover in some of their samples.
fn reached(corners: [Snapped; 3], sample_positions: &SamplePositions) -> PixelBox {
    PixelBox::reached(corners, sample_positions.reach::<MANY>())
}

/// Returns the bins with some triangles of a queue, at most sixteen.
fn small(queue: usize, triangles: &[[ScreenVertex; 3]], sample_positions: SamplePositions) -> Bins {
    small_by::<Usual>(queue, &numbers_of(triangles), sample_positions)
}

/// Returns the positions and depths of the corners of triangles.
fn numbers_of(triangles: &[[ScreenVertex; 3]]) -> Vec<[([i32; 2], f32); 3]> {
    let number = |corner: ScreenVertex| ([corner.at().x, corner.at().y], corner.depth);
    triangles.iter().map(|corners| corners.map(number)).collect()
}

/// The same by a rule of coverage, from the numbers that it reads, and depths.
fn small_by<R: Rule>(
    queue: usize,
    triangles: &[[([i32; 2], f32); 3]],
    sample_positions: SamplePositions,
) -> Bins {
    let rows = rows_of(triangles);
    let mut bins = bins(sample_positions);
    dispatch!(Level::new(), simd => {
        let mut pack = [i32x16::splat(simd, 0); ROWS];
        for (row, values) in rows.iter().zip(&mut pack) {
            *values = i32x16::from_slice(simd, row);
        }
        match sample_positions.are_many() {
            true => small::draw_pack::<_, R, MANY>(queue, &pack, &mut bins),
            false => small::draw_pack::<_, R, 1>(queue, &pack, &mut bins),
        }
    });
    bins
}

/// Triangles lane by lane, numbered from 0.
fn rows_of(triangles: &[[([i32; 2], f32); 3]]) -> [[i32; 16]; ROWS] {
    let mut rows = [[0; 16]; ROWS];
    for ((lane, corners), number) in triangles.iter().enumerate().zip(0..) {
        for (i, ([x, y], depth)) in corners.iter().enumerate() {
            (rows[2 * i][lane], rows[2 * i + 1][lane]) = (*x, *y);
            rows[6 + i][lane] = depth.to_bits().cast_signed();
        }
        rows[9][lane] = number;
    }
    rows
}

/// Returns the bins with some triangles of a queue that wait for their tiles, at most sixteen.
fn waiting(
    queue: usize,
    triangles: &[[ScreenVertex; 3]],
    sample_positions: SamplePositions,
) -> Bins {
    let rows = rows_of(&numbers_of(triangles));
    let mut boxes = [[0; 16]; 4];
    for (lane, corners) in triangles.iter().enumerate() {
        let PixelBox { left, top, right, bottom } =
            reached(corners.map(|corner| corner.at()), &sample_positions);
        for (row, side) in boxes.iter_mut().zip([left, top, right, bottom]) {
            row[lane] = side;
        }
    }
    let mut bins = bins(sample_positions);
    dispatch!(Level::new(), simd => {
        let pack = rows.map(|row| i32x16::from_slice(simd, &row));
        let boxes = bins.tile_queues.boxes(boxes.map(|row| i32x16::from_slice(simd, &row)));
        let some = mask32x16::from_bitmask(simd, (1 << triangles.len()) - 1);
        bins.tile_queues.add(queue, (&packed(&pack), &boxes), some);
    });
    bins
}

/// Draws one tile of some bins.
fn draw_bins(visibility: &mut Visibility, bins: &Bins, (tile, bounds): (usize, PixelBox)) {
    visibility.clear(bounds, bins.sample_positions);
    dispatch!(Level::new(), simd => match bins.sample_positions.are_many() {
        true => {
            visibility.draw_plain::<_, MANY>(simd, bins, tile);
            visibility.draw_hits::<_, MANY>(simd, bins, tile);
            let bins = std::slice::from_ref(bins);
            match bins[0].sample_positions.count() {
                4 => visibility.draw_small::<_, 4>(simd, bins, tile),
                _ => visibility.draw_small::<_, MANY>(simd, bins, tile),
            }
        }
        false => {
            visibility.draw_plain::<_, 1>(simd, bins, tile);
            visibility.draw_hits::<_, 1>(simd, bins, tile);
        }
    });
}

/// Draws a large triangle.
fn draw_large(visibility: &mut Visibility, large: &LargeTriangle) {
    dispatch!(Level::new(), simd => match visibility.sample_positions.are_many() {
        true => visibility.draw_large::<_, MANY>(simd, large),
        false => visibility.draw_large::<_, 1>(simd, large),
    });
}

/// The columns and rows of a tile's pixels.
fn pixels() -> impl Iterator<Item = (i32, i32)> {
    (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y)))
}

/// Returns the samples that show primitive 0: pixels row by row, then the samples of each pixel.
fn seen_in(bins: &Bins) -> Vec<(i32, i32, usize)> {
    let mut visibility = Visibility::default();
    let mut found = Vec::new();
    for tile in 0..9 {
        let (left, top) = (tile % 3 * TILE, tile / 3 * TILE);
        let own = PixelBox { left, top, right: left + TILE, bottom: top + TILE };
        let own = own.intersection(PICTURE);
        draw_bins(&mut visibility, bins, (tile as usize, own));
        for (x, y) in (top..own.bottom).flat_map(|y| (left..own.right).map(move |x| (x, y))) {
            let (words, count) = visibility.samples(Level::new(), x, y);
            let samples = (0..count).filter(|i| seen(words[*i]) == Visible::Triangle(0));
            found.extend(samples.map(|sample| (y, x, sample)));
        }
    }
    found.sort_unstable();
    found
}

/// Finds covered samples: the pixel's centre is covered after moving the corners the opposite way.
fn covered(corners: [Snapped; 3], sample_positions: &SamplePositions) -> Vec<(i32, i32, usize)> {
    covered_on(Grid::Usual, corners, sample_positions)
}

fn covered_on(
    grid: Grid,
    corners: [Snapped; 3],
    sample_positions: &SamplePositions,
) -> Vec<(i32, i32, usize)> {
    let mut samples = Vec::new();
    for sample in 0..sample_positions.count() {
        let shift = grid.offset(sample_positions.shift::<MANY>(sample));
        let seen_from = corners.map(|corner| corner.seen_from(shift));
        if let Some(triangle) = Triangle::on(grid, seen_from) {
            triangle.covered(PICTURE, |pixel| samples.push((pixel.y, pixel.x, sample)));
        }
    }
    samples.sort_unstable();
    samples
}

#[test]
fn every_way_covers_the_samples_that_the_rule_says() {
    let mut random = numbers(7);
    for sample_positions in middle_and_others() {
        for extent in [1, 2, 4, 8, 15, 30, 100] {
            for _ in 0..400 {
                // Every second coordinate is on a pixel's centre or border, or on that of a sample.
                let (left, top) = (random(158) - 8, random(148) - 8);
                let mut coordinate = |from: i32| {
                    let place = from * 256 + random(extent * 256);
                    let grid = if sample_positions.are_many() { 16 } else { 128 };
                    if random(2) == 0 { place } else { place / grid * grid }
                };
                let corners =
                    [0, 1, 2].map(|_| Snapped { x: coordinate(left), y: coordinate(top) });
                look_at(corners, sample_positions);
            }
        }
    }
}

/// Compares all rasterisers with the rule of coverage.
fn look_at(corners: [Snapped; 3], sample_positions: SamplePositions) {
    let want = covered(corners, &sample_positions);
    let bounds = reached(corners, &sample_positions);
    let side = bounds.width().max(bounds.height());
    let flat = |corners: [Snapped; 3]| corners.map(|corner| ScreenVertex::new(corner, 0.5));
    let queue = SMALL.iter().position(|limit| side <= *limit).filter(|_| !bounds.is_empty());
    if let Some(queue) = queue {
        let got = seen_in(&small(queue, &[flat(corners)], sample_positions));
        assert_eq!(got, want, "{corners:?} alone");
        // Packed with distant triangles, it is drawn pixel by pixel, regardless of tiles.
        let far = [(2, 2), (140, 3), (4, 130), (141, 135)].map(|(x, y)| {
            [(0, 0), (200, 0), (0, 200)]
                .map(|(dx, dy)| Snapped { x: x * 256 + dx, y: y * 256 + dy })
        });
        let all = [corners, far[0], far[1], far[2], far[3]].map(flat);
        let got = seen_in(&small(queue, &all, sample_positions));
        let nearer = |pixel: &(i32, i32, usize)| !got.contains(pixel);
        assert!(!want.iter().any(nearer), "{corners:?} among others");
        assert_eq!(got.len(), want.len(), "{corners:?} among others");
        if sample_positions.are_many() {
            for some in [&all[..1], &all] {
                let got = seen_in(&waiting(queue, some, sample_positions));
                assert_eq!(got, want, "{corners:?} waits with {} others", some.len() - 1);
            }
        }
    }
    let mut bins = bins(sample_positions);
    bins.add_large(LargeTriangle { corners: flat(corners), number: 0, cutout: false }, bounds);
    assert_eq!(seen_in(&bins), want, "{corners:?} alone in 64 bits");
}

/// Returns the entries of the first tile.
fn entries(bins: &Bins) -> Vec<u64> {
    let mut visibility = Visibility::default();
    draw_bins(&mut visibility, bins, (0, TILE_BOX));
    pixels()
        .flat_map(|(x, y)| {
            let (samples, count) = visibility.samples(Level::new(), x, y);
            samples.into_iter().take(count)
        })
        .collect()
}

#[test]
fn triangles_of_sixteen_pixels_have_the_same_depths_as_larger_ones() {
    let mut random = numbers(17);
    for sample_positions in middle_and_others() {
        for _ in 0..400 {
            let (left, top) = (random(46) * 256, random(46) * 256);
            let corners = [0, 1, 2].map(|_| {
                let (x, y) = (left + random(15 * 256), top + random(15 * 256));
                ScreenVertex::new(Snapped { x, y }, random(1 << 20) as f32 / 1_048_583.0)
            });
            let mut alone = bins(sample_positions);
            let bounds = reached(corners.map(|corner| corner.at()), &sample_positions);
            alone.add_large(LargeTriangle { corners, number: 0, cutout: false }, bounds);
            let last = small(SMALL.len() - 1, &[corners], sample_positions);
            assert_eq!(entries(&last), entries(&alone), "{corners:?}");
            if sample_positions.are_many() {
                let waits = waiting(SMALL.len() - 1, &[corners], sample_positions);
                assert_eq!(entries(&waits), entries(&alone), "{corners:?}");
            }
        }
    }
}

#[test]
fn on_the_fine_grid_small_and_large_triangles_follow_the_fill_rule() {
    let mut random = numbers(11);
    for sample_positions in middle_and_others() {
        for extent in [1, 4, 40] {
            for _ in 0..300 {
                let (left, top) = (random(140), random(130));
                let mut coordinate = |from: i32| {
                    let place = from * 4096 + random(extent * 4096);
                    let on_edge = if sample_positions.are_many() { 256 } else { 2048 };
                    if random(2) == 0 { place } else { place / on_edge * on_edge }
                };
                let corners =
                    [0, 1, 2].map(|_| Snapped { x: coordinate(left), y: coordinate(top) });
                let want = covered_on(Grid::Fine, corners, &sample_positions);
                if extent <= 4 {
                    let numbers = corners.map(|corner| ([corner.x, corner.y], 0.5));
                    let got = seen_in(&small_by::<Fine>(0, &[numbers], sample_positions));
                    assert_eq!(got, want, "{corners:?} alone");
                }
                let mut visibility = Visibility::default();
                visibility.clear(TILE_BOX, sample_positions);
                visibility.grid = Grid::Fine;
                let corners = corners.map(|corner| ScreenVertex::new(corner, 0.5));
                let large = LargeTriangle { corners, number: 0, cutout: false };
                draw_large(&mut visibility, &large);
                for (x, y) in pixels() {
                    let (words, count) = visibility.samples(Level::new(), x, y);
                    for (sample, word) in words[..count].iter().enumerate() {
                        let got = seen(*word) == Visible::Triangle(0);
                        let wanted = want.contains(&(y, x, sample));
                        assert_eq!(got, wanted, "{x}, {y}: {corners:?}");
                    }
                }
            }
        }
    }
}

/// Returns the pixels of a tile that a triangle covers by f32 edge functions: a x + b y + c.
fn by_floats([p, q, r]: [[f32; 2]; 3]) -> Vec<(i32, i32)> {
    let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let inside = |p: [f32; 2], q: [f32; 2], x: f32, y: f32| {
        let e = (p[1] - q[1]) * x + (q[0] - p[0]) * y + (p[0] * q[1] - p[1] * q[0]);
        e * area.signum() >= 0.0
    };
    let covered = pixels().filter(|(x, y)| {
        let (x, y) = (*x as f32 + 0.5, *y as f32 + 0.5);
        inside(q, r, x, y) && inside(r, p, x, y) && inside(p, q, x, y)
    });
    covered.map(|(x, y)| (y, x)).collect()
}

/// Returns the pixels drawn block by block.
fn drawn(mut draw: impl FnMut(usize, &mut [u64; BLOCK_PIXELS])) -> Vec<(i32, i32)> {
    let mut found = Vec::new();
    for (block, at) in (0..64_usize).zip(0_i32..) {
        let mut plane = [0; BLOCK_PIXELS];
        draw(block, &mut plane);
        let (left, top) = (at % 8 * 8, at / 8 * 8);
        let shown = (0..64).zip(plane).filter(|(_, word)| *word != 0);
        found.extend(shown.map(|(i, _)| (top + i / 8, left + i % 8)));
    }
    found.sort_unstable();
    found
}

#[test]
fn edges_in_floats_decide_by_their_formula_alone_however_large_a_triangle_is() {
    let mut random = numbers(13);
    let one = passes(Samples::One)[0];
    for extent in [1, 3, 7, 50, 300] {
        for _ in 0..300 {
            let (left, top) = (random(60), random(60));
            let mut coordinate = |from: i32| {
                let place = from * 256 + random(extent * 256);
                let place = if random(2) == 0 { place } else { place / 128 * 128 };
                place as f32 / 256.0 + random(3) as f32 * 1e-4
            };
            let corners = [0, 1, 2].map(|_| [coordinate(left), coordinate(top)]);
            let [p, q, r] = corners;
            if (q[0] - p[0]) * (r[1] - p[1]) == (q[1] - p[1]) * (r[0] - p[0]) {
                continue;
            }
            let want = by_floats(corners);
            let triangle = FloatTriangle::new(corners, [0.5; 3], 0, [0, 0]);
            let (mut some, mut whole) = (0, 0);
            let got = dispatch!(Level::new(), simd => {
                let touched = triangle.blocks::<_, 1>(simd, TILE_BOX, &one);
                (some, whole) = (touched.some, touched.whole);
                drawn(|block, plane| {
                    let at = (block, [0; 2]);
                    triangle.draw(Format(DepthFormat::default()), simd, at, false, None, plane);
                })
            });
            assert_eq!(got, want, "{corners:?}");
            for (y, x) in &want {
                assert!(some >> block_at(*x, *y) & 1 == 1, "{corners:?}");
            }
            for block in (0..64).filter(|block| whole >> block & 1 == 1) {
                let own = want.iter().filter(|(y, x)| block_at(*x, *y) == block).count();
                assert_eq!(own, BLOCK_PIXELS, "{corners:?}");
            }
            if extent <= 7 {
                let bits = corners.map(|corner| (corner.map(|x| x.to_bits().cast_signed()), 0.5));
                let seen = seen_in(&small_by::<Unsnapped>(0, &[bits], one));
                let got: Vec<_> = seen.iter().map(|(y, x, _)| (*y, *x)).collect();
                let want: Vec<_> = want.into_iter().filter(|(y, x)| *y < 64 && *x < 64).collect();
                let got: Vec<_> = got.into_iter().filter(|(y, x)| *y < 64 && *x < 64).collect();
                assert_eq!(got, want, "{corners:?} as a small one");
            }
        }
    }
}

#[test]
fn a_square_of_two_halves_is_covered_twice_on_an_edge_and_at_every_seam() {
    let count = |[x, y]: [f32; 2], cover: &dyn Fn([[f32; 2]; 3]) -> Vec<(i32, i32)>| {
        let at = |u: f32, v: f32| [x + 20.0 * u, y + 20.0 * v];
        let mut all = cover([at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)]);
        all.extend(cover([at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]));
        let twice = all.len();
        all.sort_unstable();
        all.dedup();
        (all.len(), twice)
    };
    // Both ends of 20 pixels, and the centres on the seam by both triangles.
    assert_eq!(count([5.5, 5.5], &by_floats), (441, 441 + 21));
    let scan_lines = |corners: [[f32; 2]; 3]| {
        let rows = ScanLines::new(corners, [0.5; 3], 0, TILE_BOX).unwrap();
        dispatch!(Level::new(), simd => drawn(|block, plane| {
            rows.draw(Format(DepthFormat::default()), simd, block, None, plane);
        }))
    };
    assert_eq!(count([5.2, 5.2], &scan_lines), (441, 441 + 21));
}

/// Squares that cover whole blocks, at few depths, some of them tilted.
#[test]
fn of_large_triangles_the_nearest_is_seen_and_of_equally_near_ones_the_older() {
    let mut random = numbers(5);
    for round in 0..300 {
        let sample_positions = middle_and_others()[round % 3];
        let triangles: Vec<LargeTriangle> = (0..6)
            .map(|number| {
                let depth = random(4) as f32 / 4.0;
                let tilt = random(2) as f32 / 8.0;
                let mut corner = |depth: f32| {
                    let [x, y] = [0, 0].map(|_| random(120) * 256 - 20 * 256);
                    ScreenVertex::new(Snapped { x, y }, depth)
                };
                let corners = [corner(depth), corner(depth), corner(depth + tilt)];
                LargeTriangle { corners, number, cutout: false }
            })
            .collect();
        let mut visibility = Visibility::default();
        visibility.clear(TILE_BOX, sample_positions);
        for large in &triangles {
            draw_large(&mut visibility, large);
        }
        let want = one_by_one(&triangles, &sample_positions);
        for (x, y) in pixels() {
            if let Some(number) = visibility.whole(block_at(x, y)) {
                let want = want[(y * TILE + x) as usize];
                let alike = |word: &u64| seen(*word) == Visible::Triangle(number);
                assert!(
                    want[..sample_positions.count()].iter().all(alike),
                    "{x}, {y}: {triangles:?}"
                );
            }
        }
        for (x, y) in pixels() {
            let (got, count) = visibility.samples(Level::new(), x, y);
            let want = &want[(y * TILE + x) as usize][..count];
            assert_eq!(&got[..count], want, "{x}, {y}: {triangles:?}");
        }
    }
}

/// Returns the visibility of each pixel's samples, found triangle by triangle and sample by sample.
#[expect(clippy::needless_range_loop, reason = "a sample is one of each pixel's")]
fn one_by_one(triangles: &[LargeTriangle], sample_positions: &SamplePositions) -> Vec<[u64; MANY]> {
    let mut words = vec![[0; MANY]; PIXELS];
    for large in triangles {
        for sample in 0..sample_positions.count() {
            let shift = sample_positions.shift::<MANY>(sample);
            let ends = large.corners.map(|corner| corner.seen_from(shift));
            let moved = LargeTriangle { corners: ends, ..*large };
            let Some(triangle) = Triangle::new(ends.map(|corner| corner.at())) else { continue };
            let seen = Large::new(&moved, &triangle, [0, 0]);
            triangle.covered(TILE_BOX, |pixel| {
                let word = word(seen.depth(pixel.edges).to_bits(), large.number);
                let old = &mut words[(pixel.y * TILE + pixel.x) as usize][sample];
                *old = word.max(*old);
            });
        }
    }
    words
}
