//! Work that threads share out among themselves, so that each does mostly what it did before.
//!
//! Each thread has a stretch of the work and takes from its front; who has nothing left takes from the back
//! of another's. So a thread meets what its core's cache still holds, of the last stage and of the last
//! frame. What another core has written has to come from there first.
//!
//! Blumofe and Leiserson, "Scheduling Multithreaded Computations by Work Stealing", JACM 1999.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use crate::base::once::without_computing;

/// Pieces of work, by their numbers, in stretches.
#[derive(Debug)]
pub(crate) struct WorkStealing {
    /// Where what is left of each stretch begins, in the upper half, and ends, in the lower.
    left: Vec<AtomicU64>,
}

impl WorkStealing {
    /// So many pieces for so many threads, as many for each.
    pub(crate) fn new(count: usize, threads: usize) -> Self {
        Self::beginning_at(count, (0..threads).map(|i| i * count / threads))
    }

    /// So many pieces, in stretches that begin here, in ascending order. The first also has what is before.
    pub(crate) fn beginning_at(
        count: usize,
        begins: impl DoubleEndedIterator<Item = usize> + ExactSizeIterator,
    ) -> Self {
        let mut end = count;
        let mut left: Vec<AtomicU64> = Vec::with_capacity(begins.len());
        for (i, begin) in begins.enumerate().rev() {
            let begin = if i == 0 { 0 } else { begin.min(end) };
            left.push(AtomicU64::new((begin as u64) << 32 | end as u64));
            end = begin;
        }
        left.reverse();
        Self { left }
    }

    /// A piece that nobody has taken yet; none when there are no more.
    pub(crate) fn next(&self) -> Option<usize> {
        let count = self.left.len();
        let own = rayon::current_thread_index().unwrap_or(0) % count;
        let others = (1..count).map(|i| (own + i) % count);
        self.take(own, false).or_else(|| others.into_iter().find_map(|i| self.take(i, true)))
    }

    /// The last piece of a stretch, or the first.
    fn take(&self, stretch: usize, last: bool) -> Option<usize> {
        let mut taken = None;
        let update = |left| {
            let (begin, end) = (left >> 32, left & u64::from(u32::MAX));
            if begin >= end {
                return None;
            }
            let (piece, begin, end) =
                if last { (end - 1, begin, end - 1) } else { (begin, begin + 1, end) };
            taken = usize::try_from(piece).ok();
            Some(begin << 32 | end)
        };
        self.left[stretch].fetch_update(Ordering::Relaxed, Ordering::Relaxed, update).ok()?;
        taken
    }
}

/// Runs the same work on each of a number of threads; each does as much of it as it finds.
///
/// The work holds locks on what it draws, so it calls nothing that waits for other threads: a thread
/// that waits takes up other work, which may want the same locks. What the work reads of a mesh is
/// computed before ([`FramePlan::prepare`](crate::render::frame::FramePlan::prepare)).
pub(crate) fn together(threads: usize, work: impl Fn() + Sync) {
    if threads == 1 {
        without_computing(work);
    } else {
        let threads = (0..threads).into_par_iter().with_max_len(1);
        threads.for_each(|_| without_computing(&work));
    }
}

/// One of some things, one of which each thread has: the own one of this thread, if nobody has it, so that
/// it is in this core's cache. Another where somebody has.
pub(crate) fn own<T>(all: &[Mutex<T>]) -> MutexGuard<'_, T> {
    let own = rayon::current_thread_index().unwrap_or(0);
    let free = (0..all.len()).find_map(|i| all[(own + i) % all.len()].try_lock().ok());
    free.unwrap_or_else(|| all[own % all.len()].lock().unwrap_or_else(PoisonError::into_inner))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_piece_is_handed_out_once_whoever_takes_it() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        for (count, begins) in [(0, vec![0, 0]), (1, vec![0, 5, 9]), (1000, vec![3, 3, 700])] {
            let taken: Vec<Mutex<u32>> = (0..count).map(|_| Mutex::new(0)).collect();
            let shares = WorkStealing::beginning_at(count, begins.into_iter());
            pool.install(|| {
                together(3, || {
                    while let Some(piece) = shares.next() {
                        *taken[piece].lock().unwrap() += 1;
                    }
                });
            });
            assert!(taken.iter().all(|taken| *taken.lock().unwrap() == 1));
            assert_eq!(shares.next(), None);
        }
    }

    #[test]
    fn a_thread_takes_its_own_from_the_front_and_that_of_others_from_the_back() {
        // This thread is in no pool, and counts as the first.
        let shares = WorkStealing::new(6, 2);
        let order: Vec<usize> = std::iter::from_fn(|| shares.next()).collect();
        assert_eq!(order, [0, 1, 2, 5, 4, 3]);
    }

    #[test]
    fn who_finds_its_own_taken_has_another() {
        let all = [Mutex::new('a'), Mutex::new('b')];
        let first = own(&all);
        assert_eq!((*first, *own(&all)), ('a', 'b'));
    }
}
