use fearless_simd::{SimdBase as _, i32x16};

use super::*;
use crate::accuracy::Samples;
use crate::base::image::Size;
use crate::render::raster::bins::LargeTriangle;
use crate::render::raster::queue::{ROWS, SMALL};
use crate::render::raster::small;
use crate::render::raster::visibility_buffer::Visible;
use crate::render::screen::clip::ScreenVertex;
use crate::render::screen::coverage::{Snapped, Triangle};
use crate::render::screen::sample_positions::passes;
use crate::render::screen::tiles::TILE;

const SIZE: Size = Size { width: 150, height: 140 };
const PICTURE: PixelBox = PixelBox { left: 0, top: 0, right: 150, bottom: 140 };
const TILE_BOX: PixelBox = PixelBox { left: 0, top: 0, right: TILE, bottom: TILE };

/// The centre, and the samples farthest from it to all sides.
fn middle_and_others() -> [SamplePositions; 3] {
    [passes(Samples::One)[0], passes(Samples::Four)[0], passes(Samples::Sixteen)[3]]
}

/// The offset of sample `i`.
fn shift(sample_positions: &SamplePositions, i: usize) -> [i32; 2] {
    if sample_positions.are_many() { sample_positions.shift::<FOUR>(i) } else { [0; 2] }
}

/// Numbers that look random.
fn numbers(mut state: u64) -> impl FnMut(i32) -> i32 {
    move |below| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((state >> 33) % below.cast_unsigned() as u64) as i32
    }
}

fn bins(sample_positions: SamplePositions) -> Bins {
    let mut bins = Bins::default();
    bins.clear(SIZE, sample_positions);
    bins
}

/// The pixels that a triangle may cover in some of their samples.
fn reached(corners: [Snapped; 3], sample_positions: &SamplePositions) -> PixelBox {
    match sample_positions.are_many() {
        true => PixelBox::reached(corners, sample_positions.reach::<FOUR>()),
        false => PixelBox::of(corners),
    }
}

/// The bins with some small triangles, sixteen at the most.
fn small(triangles: &[[Snapped; 3]], sample_positions: SamplePositions) -> Bins {
    let mut rows = [[0; 16]; ROWS];
    for ((lane, corners), number) in triangles.iter().enumerate().zip(0..) {
        for (i, corner) in corners.iter().enumerate() {
            (rows[2 * i][lane], rows[2 * i + 1][lane]) = (corner.x, corner.y);
            rows[6 + i][lane] = 0.5_f32.to_bits().cast_signed();
        }
        rows[9][lane] = number;
    }
    let mut bins = bins(sample_positions);
    dispatch!(Level::new(), simd => {
        let mut pack = [i32x16::splat(simd, 0); ROWS];
        for (row, values) in rows.iter().zip(&mut pack) {
            *values = i32x16::from_slice(simd, row);
        }
        match sample_positions.are_many() {
            true => small::draw::<_, FOUR>(simd, &pack, &mut bins),
            false => small::draw::<_, 1>(simd, &pack, &mut bins),
        }
    });
    bins
}

/// The samples that show the primitive with the number 0: pixels row by row, in each its samples.
fn seen_in(bins: &Bins) -> Vec<(i32, i32, usize)> {
    let mut visibility = Visibility::default();
    let mut found = Vec::new();
    for tile in 0..9 {
        let (left, top) = (tile % 3 * TILE, tile / 3 * TILE);
        let own = PixelBox { left, top, right: left + TILE, bottom: top + TILE };
        let own = own.intersection(PICTURE);
        visibility.clear(own, bins.sample_positions);
        dispatch!(Level::new(), simd => match bins.sample_positions.are_many() {
            true => {
                visibility.draw_plain::<_, FOUR>(simd, bins, tile as usize);
                visibility.draw_hits::<_, FOUR>(simd, bins, tile as usize);
            }
            false => {
                visibility.draw_plain::<_, 1>(simd, bins, tile as usize);
                visibility.draw_hits::<_, 1>(simd, bins, tile as usize);
            }
        });
        for (x, y) in (top..own.bottom).flat_map(|y| (left..own.right).map(move |x| (x, y))) {
            let (words, count) = visibility.samples(Level::new(), x, y);
            let samples = (0..count).filter(|i| seen(words[*i]) == Visible::Triangle(0));
            found.extend(samples.map(|sample| (y, x, sample)));
        }
    }
    found.sort_unstable();
    found
}

/// A sample is covered if the centre of its pixel is, once the corners are moved the other way.
fn covered(corners: [Snapped; 3], sample_positions: &SamplePositions) -> Vec<(i32, i32, usize)> {
    let mut samples = Vec::new();
    for sample in 0..sample_positions.count() {
        let seen_from = corners.map(|corner| corner.seen_from(shift(sample_positions, sample)));
        if let Some(triangle) = Triangle::new(seen_from) {
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
        for extent in [1, 2, 4, 8, 30, 100] {
            for _ in 0..400 {
                // Every second coordinate on a pixel's centre or border, or on that of a sample.
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

/// Compares all rasterizers with the rule of coverage.
fn look_at(corners: [Snapped; 3], sample_positions: SamplePositions) {
    let want = covered(corners, &sample_positions);
    let bounds = reached(corners, &sample_positions);
    let side = bounds.width().max(bounds.height());
    if side <= SMALL[3] && !bounds.is_empty() {
        let got = seen_in(&small(&[corners], sample_positions));
        assert_eq!(got, want, "{corners:?} alone");
        // With others far away it is drawn pixel by pixel, whatever the tile.
        let far = [(2, 2), (140, 3), (4, 130), (141, 135)].map(|(x, y)| {
            [(0, 0), (200, 0), (0, 200)]
                .map(|(dx, dy)| Snapped { x: x * 256 + dx, y: y * 256 + dy })
        });
        let got = seen_in(&small(&[corners, far[0], far[1], far[2], far[3]], sample_positions));
        let nearer = |pixel: &(i32, i32, usize)| !got.contains(pixel);
        assert!(!want.iter().any(nearer), "{corners:?} among others");
        assert_eq!(got.len(), want.len(), "{corners:?} among others");
    }
    let mut bins = bins(sample_positions);
    let corners = corners.map(|corner| ScreenVertex::new(corner, 0.5));
    bins.add_large(LargeTriangle { corners, number: 0, cutout: false }, bounds);
    assert_eq!(seen_in(&bins), want, "{corners:?} alone in 64 bits");
}

/// Squares that cover whole blocks, in few depths, some of them tilted.
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
            dispatch!(Level::new(), simd => match sample_positions.are_many() {
                true => visibility.draw_large::<_, FOUR>(simd, large),
                false => visibility.draw_large::<_, 1>(simd, large),
            });
        }
        let want = one_by_one(&triangles, &sample_positions);
        let pixels = || (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y)));
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

/// The visibility of each pixel's samples, found triangle by triangle and sample by sample.
#[expect(clippy::needless_range_loop, reason = "a sample is one of each pixel's")]
fn one_by_one(triangles: &[LargeTriangle], sample_positions: &SamplePositions) -> Vec<[u64; FOUR]> {
    let mut words = vec![[0; FOUR]; PIXELS];
    for large in triangles {
        for sample in 0..sample_positions.count() {
            let ends =
                large.corners.map(|corner| corner.seen_from(shift(sample_positions, sample)));
            let moved = LargeTriangle { corners: ends, ..*large };
            let Some(triangle) = Triangle::new(ends.map(|corner| corner.at())) else { continue };
            let seen = Large::new(&moved, &triangle, [0, 0]);
            triangle.covered(TILE_BOX, |pixel| {
                let word = word(seen.depth(pixel.edges), large.number);
                let old = &mut words[(pixel.y * TILE + pixel.x) as usize][sample];
                *old = word.max(*old);
            });
        }
    }
    words
}

#[test]
fn a_pixel_is_said_to_show_what_most_of_its_samples_show() {
    let mut visibility = Visibility::default();
    visibility.clear(TILE_BOX, passes(Samples::Four)[0]);
    let [a, b, c] = [7, 8, 9].map(|number| word(0.5, number));
    let cases = [
        ([a, a, a, a], a),
        ([a, b, b, c], b),
        ([b, a, a, b], b),
        ([0, a, b, c], 0),
        ([0, a, word(0.6, 7), c], a),
    ];
    for (samples, want) in cases {
        visibility.written = 1;
        for (sample, word) in samples.into_iter().enumerate() {
            visibility.plane::<FOUR>(0, sample)[0] = word;
        }
        assert_eq!(visibility.word(Level::new(), 0, 0), want, "{samples:?}");
    }
}
