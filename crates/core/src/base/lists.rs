//! Joins long lists on all threads, and sorts numbers by keys.

use rayon::prelude::*;

/// Joins lists; all threads copy.
pub fn concatenated<T: Copy + Send + Sync>(mut lists: Vec<Vec<T>>) -> Vec<T> {
    if lists.len() == 1 {
        return lists.pop().unwrap_or_default();
    }
    let ends: Vec<usize> = lists
        .iter()
        .scan(0, |end, list| {
            *end += list.len();
            Some(*end)
        })
        .collect();
    let all = ends.last().copied().unwrap_or(0);
    // Each thread copies a run of elements, so it searches for the next list only if one ends.
    let at = |place: &mut usize, i: usize| {
        let begin = ends[*place] - lists[*place].len();
        if i < begin || i >= ends[*place] {
            *place = ends.partition_point(|end| *end <= i);
        }
        lists[*place][i + lists[*place].len() - ends[*place]]
    };
    (0..all).into_par_iter().map_with(0, at).collect()
}

/// Sorts the numbers 0 to n - 1 by ascending keys; numbers with equal keys keep their order.
///
/// This is an LSD radix sort with digits of eleven bits: Knuth, "The Art of Computer Programming"
/// 3, 5.2.5. `keys[i]` belongs to number i; only the low `bits` bits of the keys are compared.
pub fn sorted_by_keys(keys: Vec<u32>, bits: u32) -> Vec<u32> {
    const DIGIT: u32 = 11;
    let count = u32::try_from(keys.len()).expect("fewer than 2^32 keys");
    let mut from: Vec<(u32, u32)> = keys.into_iter().zip(0..count).collect();
    let mut to = vec![(0, 0); from.len()];
    for shift in (0..bits).step_by(DIGIT as usize) {
        let digit = |key: u32| (key >> shift) as usize & ((1 << DIGIT) - 1);
        // Count each digit, then turn the counts into the place of each digit's first item.
        let mut places = vec![0; 1 << DIGIT];
        for (key, _) in &from {
            places[digit(*key)] += 1;
        }
        let mut sum = 0;
        for place in &mut places {
            sum += std::mem::replace(place, sum);
        }
        // Items move in order, so the sort by earlier digits survives.
        for item in &from {
            let place = &mut places[digit(item.0)];
            to[*place] = *item;
            *place += 1;
        }
        std::mem::swap(&mut from, &mut to);
    }
    from.into_iter().map(|(_, number)| number).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_joined_in_order() {
        let lists = vec![vec![], vec![1, 2, 3], vec![], vec![4], (5..9000).collect(), vec![]];
        assert_eq!(concatenated(lists), (1..9000).collect::<Vec<_>>());
        assert!(concatenated::<u8>(Vec::new()).is_empty());
        assert!(concatenated(vec![Vec::<u8>::new(); 2]).is_empty());
    }

    #[test]
    fn numbers_are_sorted_by_keys_and_keep_their_order_if_keys_are_equal() {
        // A generator with a period of 2^16: every key occurs four times.
        let keys: Vec<u32> =
            (0..1 << 18_u32).map(|i: u32| ((i.wrapping_mul(40_503) & 0xffff) << 14) | 5).collect();
        let sorted = sorted_by_keys(keys.clone(), 30);
        let mut right: Vec<u32> = (0..1 << 18).collect();
        right.sort_by_key(|i| keys[*i as usize]);
        assert_eq!(sorted, right);
    }
}
