//! Thread pools on systems that limit the number of threads.
//!
//! Containers, clusters and web hosts limit the processes and threads of a user (`ulimit -u`, the
//! `pids` controller of Linux). Rayon refuses a whole pool if one of its threads cannot be started.
//! Here, threads are started first and wait, and then become the members of a pool of that size.
//! If the limit is reached, the pool takes half of the threads, because the rest of the program
//! needs some, too.

use std::io::{Error, Result};
use std::sync::mpsc::{Sender, channel};
use std::thread::Builder;

use rayon::{ThreadBuilder, ThreadPool, ThreadPoolBuilder};

/// The part that the calling thread takes in a pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Caller {
    /// It is one of the members.
    Joins,
    /// It waits for the members.
    Waits,
}

/// A thread that waits for a pool. It ends if this is dropped before.
type Recruit = Sender<ThreadBuilder>;

/// Builds a pool of this number of threads, or of fewer if the system limits them. A caller that
/// joins stays a member until it ends.
///
/// # Errors
/// If the system provides no thread, or the caller cannot join because it is in another pool.
pub fn pool(threads: usize, caller: Caller, name: &str) -> Result<ThreadPool> {
    let mut recruits = recruited(threads, caller, name)?.into_iter();
    let builder = builder(caller, recruits.len());
    let builder = builder.spawn_handler(|member| assign(recruits.next(), member));
    builder.build().map_err(Error::other)
}

/// Starts the pool of the process with this number of threads, or with fewer if the system limits
/// them. `None` is one thread per core. Without this, the first parallel work starts the pool, and
/// panics at a limit.
///
/// # Errors
/// If the system provides no thread, or the pool exists already.
pub fn start(threads: Option<usize>, caller: Caller) -> Result<()> {
    let threads = threads.unwrap_or_else(default_count);
    let mut recruits = recruited(threads, caller, "pool")?.into_iter();
    let builder = builder(caller, recruits.len());
    let builder = builder.spawn_handler(|member| assign(recruits.next(), member));
    builder.build_global().map_err(Error::other)
}

fn builder(caller: Caller, recruits: usize) -> ThreadPoolBuilder {
    match caller {
        Caller::Joins => ThreadPoolBuilder::new().num_threads(recruits + 1).use_current_thread(),
        Caller::Waits => ThreadPoolBuilder::new().num_threads(recruits),
    }
}

/// Returns whether the calling thread is the only member of its pool, so other threads must not
/// leave work to the pool while this one waits for them.
pub fn is_alone() -> bool {
    rayon::current_thread_index().is_some() && rayon::current_num_threads() == 1
}

/// Returns whether the system provides this number of further threads.
pub fn are_available(threads: usize) -> bool {
    waiting(threads, "trial").1.is_none()
}

/// Returns the number of threads of a pool by default: as in rayon, `RAYON_NUM_THREADS` replaces
/// the number of cores.
fn default_count() -> usize {
    let wanted = std::env::var("RAYON_NUM_THREADS").ok();
    let wanted = wanted.and_then(|text| text.parse().ok()).filter(|count| *count > 0);
    wanted.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// Starts the threads of a pool: all of them, or half of those that the system provides.
fn recruited(threads: usize, caller: Caller, name: &str) -> Result<Vec<Recruit>> {
    let (wanted, least) = match caller {
        Caller::Joins => (threads.saturating_sub(1), 0),
        Caller::Waits => (threads.max(1), 1),
    };
    let (mut recruits, error) = waiting(wanted, name);
    match error {
        None => Ok(recruits),
        Some(error) if recruits.len() < least => Err(error),
        Some(_) => {
            recruits.truncate((recruits.len() / 2).max(least));
            Ok(recruits)
        }
    }
}

/// Starts threads until the system refuses one, and returns its reason.
fn waiting(count: usize, name: &str) -> (Vec<Recruit>, Option<Error>) {
    let mut recruits = Vec::new();
    for i in 0..count {
        let (sender, receiver) = channel::<ThreadBuilder>();
        let member = move || {
            if let Ok(member) = receiver.recv() {
                member.run();
            }
        };
        match Builder::new().name(format!("{name} {i}")).spawn(member) {
            Ok(_) => recruits.push(sender),
            Err(error) => return (recruits, Some(error)),
        }
    }
    (recruits, None)
}

fn assign(recruit: Option<Recruit>, member: ThreadBuilder) -> Result<()> {
    let recruit = recruit.ok_or_else(|| Error::other("the pool has more members than threads"))?;
    recruit.send(member).map_err(|_ended| Error::other("a thread of the pool has ended"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pool_has_the_wanted_number_of_threads_and_works_on_all_of_them() {
        for threads in [1, 3] {
            let pool = pool(threads, Caller::Waits, "test").unwrap();
            assert_eq!(pool.current_num_threads(), threads);
            let mut seen = pool.broadcast(|context| context.index());
            seen.sort_unstable();
            assert_eq!(seen, (0..threads).collect::<Vec<_>>());
            assert!(!is_alone(), "this thread is in no pool");
        }
    }
}
