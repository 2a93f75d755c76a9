//! The Pareto front: the points that no other point beats in both time and error.
//!
//! Tiny differences do not earn a place on the front: a slower point must reduce the error by a
//! given fraction.

/// A choice as time and error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// In any unit.
    pub time: f64,
    /// In any unit; 0 is exact.
    pub error: f64,
}

/// Returns the indices of the points on the front, from the fastest to the most exact. Each reduces
/// the error of its predecessor by at least the fraction `least`.
pub fn front(points: &[Point], least: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let by = |a: &Point, b: &Point| a.time.total_cmp(&b.time).then(a.error.total_cmp(&b.error));
    order.sort_by(|a, b| by(&points[*a], &points[*b]).then(a.cmp(b)));
    let mut best = f64::INFINITY;
    order.retain(|i| {
        let error = points[*i].error;
        let cuts = error < best && error <= best * (1.0 - least);
        best = if cuts { error } else { best };
        cuts
    });
    order
}

/// Returns the fastest point with an error of at most `most`.
pub fn fastest_within(points: &[Point], most: f64) -> Option<usize> {
    let within = (0..points.len()).filter(|i| points[*i].error <= most);
    within.min_by(|a, b| {
        let (a, b) = (points[*a], points[*b]);
        a.time.total_cmp(&b.time).then(a.error.total_cmp(&b.error))
    })
}

/// Returns the most exact point with a time of at most `most`.
pub fn most_exact_within(points: &[Point], most: f64) -> Option<usize> {
    let within = (0..points.len()).filter(|i| points[*i].time <= most);
    within.min_by(|a, b| {
        let (a, b) = (points[*a], points[*b]);
        a.error.total_cmp(&b.error).then(a.time.total_cmp(&b.time))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(all: &[(f64, f64)]) -> Vec<Point> {
        all.iter().map(|(time, error)| Point { time: *time, error: *error }).collect()
    }

    #[test]
    fn the_front_omits_points_that_another_beats_in_both() {
        let all = points(&[(1.0, 9.0), (2.0, 4.0), (3.0, 4.0), (2.5, 5.0), (9.0, 0.0), (1.0, 9.5)]);
        assert_eq!(front(&all, 0.0), [0, 1, 4]);
        assert_eq!(front(&points(&[(1.0, 1.0), (1.0, 1.0)]), 0.0), [0]);
        assert_eq!(front(&[], 0.0), [0; 0]);
    }

    #[test]
    fn a_slower_point_has_to_cut_the_error_by_a_stated_part() {
        let all = points(&[(1.0, 1.0), (2.0, 0.96), (3.0, 0.94), (4.0, 0.0), (5.0, 0.0)]);
        assert_eq!(front(&all, 0.05), [0, 2, 3]);
        assert_eq!(front(&all, 0.5), [0, 3]);
    }

    #[test]
    fn budgets_are_kept_from_both_sides_and_refused_where_nothing_keeps_them() {
        let all = points(&[(1.0, 9.0), (2.0, 4.0), (5.0, 4.0), (9.0, 0.0)]);
        assert_eq!(fastest_within(&all, 4.0), Some(1));
        assert_eq!(fastest_within(&all, 3.9), Some(3));
        assert_eq!(fastest_within(&all, -1.0), None);
        assert_eq!(most_exact_within(&all, 8.9), Some(1));
        assert_eq!(most_exact_within(&all, 9.0), Some(3));
        assert_eq!(most_exact_within(&all, 0.5), None);
    }
}
