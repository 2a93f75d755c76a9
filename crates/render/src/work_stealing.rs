//! Distributes work among threads by work stealing.
//!
//! Each thread has a range of the work and takes pieces from its front. A thread with an empty
//! range steals pieces from the back of another one. Most pieces therefore stay on one thread from
//! stage to stage and from frame to frame, and their data often is still in that core's cache.
//!
//! Blumofe and Leiserson, "Scheduling Multithreaded Computations by Work Stealing", JACM 1999.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::prelude::*;

use marraztu_core::base::once::without_computing;

/// Numbered pieces of work, in one range per thread.
#[derive(Debug)]
pub(crate) struct WorkStealing {
    /// The rest of each range: its start in the upper half, its end in the lower half.
    left: Vec<AtomicU64>,
}

impl WorkStealing {
    /// Divides `count` pieces into equal ranges, one per thread.
    pub(crate) fn new(count: usize, threads: usize) -> Self {
        Self::beginning_at(count, (0..threads).map(|i| i * count / threads))
    }

    /// Divides `count` pieces into ranges with these starts, in ascending order. The first range
    /// also holds the pieces before its start.
    pub(crate) fn beginning_at(
        count: usize,
        begins: impl DoubleEndedIterator<Item = usize> + ExactSizeIterator,
    ) -> Self {
        let mut end = count;
        let mut left: Vec<AtomicU64> = Vec::with_capacity(begins.len());
        // From the last range to the first: each ends at the start of the next one.
        for (i, begin) in begins.enumerate().rev() {
            let begin = if i == 0 { 0 } else { begin.min(end) };
            left.push(AtomicU64::new((begin as u64) << 32 | end as u64));
            end = begin;
        }
        left.reverse();
        Self { left }
    }

    /// Takes the next piece that no thread has taken yet, if there is one.
    pub(crate) fn next(&self) -> Option<usize> {
        let count = self.left.len();
        let own = rayon::current_thread_index().unwrap_or(0) % count;
        // Each thread begins to steal from its neighbour, so thieves spread over the ranges.
        let others = (1..count).map(|i| (own + i) % count);
        self.take(own, false).or_else(|| others.into_iter().find_map(|i| self.take(i, true)))
    }

    /// Takes the last piece of a range, or the first.
    fn take(&self, stretch: usize, last: bool) -> Option<usize> {
        let mut taken = None;
        let update = |left| {
            // Both ends share one atomic word, so owner and thieves never take the same piece.
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

/// Runs the same work on each of a number of threads.
///
/// The work holds locks on its outputs, so it must not call anything that waits for other threads:
/// a waiting thread picks up other work, which may need the same locks. All lazily computed parts
/// of a mesh are therefore computed beforehand (`FramePlan::prepare`).
pub(crate) fn together(threads: usize, work: impl Fn() + Sync) {
    if threads == 1 {
        without_computing(work);
    } else {
        // Split down to single jobs, so that every thread can take one.
        let threads = (0..threads).into_par_iter().with_max_len(1);
        threads.for_each(|_| without_computing(&work));
    }
}

/// Locks one of several values, one per thread. This thread's value is likely in this core's cache,
/// so it is tried first, then the others.
pub(crate) fn own<T>(all: &[Mutex<T>]) -> MutexGuard<'_, T> {
    let own = rayon::current_thread_index().unwrap_or(0);
    let free = (0..all.len()).find_map(|i| all[(own + i) % all.len()].try_lock().ok());
    // If all are locked at the moment, this waits for its first choice.
    free.unwrap_or_else(|| all[own % all.len()].lock().unwrap_or_else(PoisonError::into_inner))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_piece_is_handed_out_once_whichever_thread_takes_it() {
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
    fn a_thread_pops_from_its_front_and_steals_from_the_back_of_others() {
        // This thread is in no pool, and counts as the first.
        let shares = WorkStealing::new(6, 2);
        let order: Vec<usize> = std::iter::from_fn(|| shares.next()).collect();
        assert_eq!(order, [0, 1, 2, 5, 4, 3]);
    }

    #[test]
    fn a_thread_gets_another_value_if_its_first_is_locked() {
        let all = [Mutex::new('a'), Mutex::new('b')];
        let first = own(&all);
        assert_eq!((*first, *own(&all)), ('a', 'b'));
    }
}
