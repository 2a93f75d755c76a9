#![expect(clippy::cast_possible_truncation, reason = "small numbers")]

use super::*;

/// Returns a sample of the visibility buffer that shows a triangle.
fn word(number: u32) -> u64 {
    1 << 62 | u64::from(!number)
}

#[test]
fn triangles_of_neighbouring_blocks_keep_their_slots() {
    let mut state = 1_u64;
    let mut fragments = Fragments::default();
    let mut went_on = 0;
    for round in 0..4000 {
        let first = round / 20 * 3;
        // Sometimes triangles replace each other in the table.
        let step = if round % 3 == 0 { 64 } else { 1 };
        // Bands of three columns, some with holes.
        let band = (state >> 40) as u32;
        let visibility: [u64; BLOCK_PIXELS] = std::array::from_fn(|i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            match (state >> 40) as u32 % 8 {
                0 if round % 2 == 0 => 0,
                _ => word(first + step * ((band % 7 + i as u32 % 8 / 3) % 7)),
            }
        });
        let before = fragments.numbers[..fragments.count].to_vec();
        fragments.list(Level::new(), &visibility, [0, 0], 32);
        assert!(fragments.count <= SLOTS);
        went_on += usize::from(fragments.numbers[..fragments.count].starts_with(&before));
        for (k, place) in fragments.pixels[..fragments.len].iter().enumerate() {
            let number = fragments.numbers[fragments.slots[k] as usize];
            assert_eq!(word(number), visibility[usize::from(*place)], "{round}");
        }
        if round % 50 == 0 {
            fragments.list_full_block(9, [0, 0]);
        }
    }
    assert!((500..4000).contains(&went_on), "{went_on}");
}

#[test]
fn other_triangles_are_added_to_a_full_block() {
    let mut fragments = Fragments::default();
    for number in 0..200 {
        let others = [number + 1, number + 2, number, number + 1];
        if number % 3 == 0 {
            // They have other slots in the table now.
            fragments.begin_shared(0, 4);
            others.iter().rev().for_each(|other| fragments.add(*other, [0, 0], 5, 1));
        }
        fragments.list_full_block(number, [8, 16]);
        fragments.share(&[3; BLOCK_PIXELS], 4);
        others.iter().for_each(|other| fragments.add(*other, [8, 16], 9, 1));
        let shown = fragments.slots[..fragments.len].iter();
        let shown: Vec<u32> = shown.map(|slot| fragments.numbers[*slot as usize]).collect();
        assert_eq!(shown[..BLOCK_PIXELS], [number; BLOCK_PIXELS]);
        assert_eq!((&shown[BLOCK_PIXELS..], fragments.count), (&others[..], 3));
    }
}

#[test]
fn blocks_that_are_listed_together_keep_their_pixels_and_triangles() {
    let mut state = 1_u64;
    let mut fragments = Fragments::default();
    let (mut joined, mut full) = (0, 0);
    for round in 0..1000_u32 {
        let first = round * 5;
        let mut want = Vec::new();
        for block in 0..12 {
            // Bands of two columns, some with holes.
            let visibility: [u64; BLOCK_PIXELS] = std::array::from_fn(|i| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                match (state >> 40) as u32 % 4 {
                    0 if block % 3 != 2 => 0,
                    _ => word(first + (block + i as u32 % 8 / 2) % 9),
                }
            });
            let corner = [8 * block.cast_signed(), 16];
            let runs = Runs::of(Level::new(), &visibility);
            if block == 0 {
                fragments.list_runs(Level::new(), &runs, corner, 32);
            } else if fragments.have_room(&runs, 32) {
                fragments.list_more(Level::new(), &runs, corner);
                joined += 1;
            } else {
                full += 1;
                break;
            }
            let shown = (0..BLOCK_PIXELS).filter(|i| visibility[*i] != 0);
            want.extend(shown.map(|i| {
                let (x, y) = (corner[0] + i as i32 % 8, 16 + i as i32 / 8);
                (i as u8, x, y, visibility[i])
            }));
        }
        assert!(fragments.len <= BATCH && !fragments.is_whole());
        let got = (0..fragments.len).map(|k| {
            let number = fragments.numbers[fragments.slots[k] as usize];
            (fragments.pixels[k], fragments.x[k], fragments.y[k], word(number))
        });
        assert_eq!(got.collect::<Vec<_>>(), want, "{round}");
    }
    assert!(joined > 2000 && full > 900, "{joined} {full}");
}

#[test]
fn every_pixel_finds_its_triangle_in_its_slot() {
    let mut state = 1_u64;
    for round in 0..2000 {
        let visibility: [u64; BLOCK_PIXELS] = std::array::from_fn(|i| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let random = (state >> 40) as u32;
            match (round % 4, random % 8) {
                (0, _) => word(7),
                (1, _) => word(random),
                (2, 0) => 0,
                (3, 0) => word(1 << 31 | random),
                _ => word(random % 2 + i as u32 % 8 / 3),
            }
        });
        let mut fragments = Fragments::default();
        let shown = fragments.list(Level::new(), &visibility, [8, 16], 0);
        let is_triangle = |i: &usize| visibility[*i] != 0 && !(visibility[*i] as u32) < 1 << 31;
        let want: Vec<usize> = (0..BLOCK_PIXELS).filter(is_triangle).collect();
        let bits = want.iter().fold(0, |bits, i| bits | 1_u64 << i);
        let lines = (0..BLOCK_PIXELS).filter(|i| visibility[*i] != 0 && !is_triangle(i));
        assert_eq!((shown.triangles, fragments.len), (bits, want.len()));
        assert_eq!(shown.lines, lines.fold(0, |bits, i| bits | 1_u64 << i));
        for (k, i) in want.into_iter().enumerate() {
            let slot = fragments.slots[k] as usize;
            assert!(slot < fragments.count);
            assert_eq!(word(fragments.numbers[slot]), visibility[i] & !(1 << 63));
            let (x, y) = (8 + i as i32 % 8, 16 + i as i32 / 8);
            assert_eq!(
                (usize::from(fragments.pixels[k]), fragments.x[k], fragments.y[k]),
                (i, x, y)
            );
        }
        // Small numbers have separate table entries.
        let mut different = fragments.numbers[..fragments.count].to_vec();
        different.sort_unstable();
        different.dedup();
        assert!(round % 4 == 1 || different.len() == fragments.count, "{:?}", fragments.numbers);
    }
}
