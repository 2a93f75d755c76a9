//! The threads that draw, and their state after a fork.
//!
//! A call of Python borrows a painter: a pool of threads with a renderer. Calls at the same time
//! have different painters, so they never wait for each other. Everything that may use rayon runs
//! in a painter's pool, because a fork copies no threads: a child process that waited for the
//! threads of its parent would hang. The child abandons the painters and makes new ones. If a
//! painter was busy during the fork, locks may stay closed in the child, so all calls fail there.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError, TryLockError};
use std::time::{Duration, Instant};

use marraztu_core::base::threads::{self, Caller};
use marraztu_io::Progress;
use marraztu_render::Renderer;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::Failure;

/// The most threads of a pool.
const MOST_THREADS: usize = 1024;

/// The most painters that wait for the next call.
const MOST_IDLE: usize = 64;

/// The time between two looks for signals.
const PERIOD: Duration = Duration::from_millis(50);

/// A renderer with its threads.
struct Painter {
    threads: Threads,
    renderer: Renderer,
}

/// The threads of a painter.
enum Threads {
    /// The calling thread: waking another one would take longer than parts of a small picture.
    Caller,
    Pool(ThreadPool),
}

impl Threads {
    fn count(&self) -> usize {
        match self {
            Self::Caller => 1,
            Self::Pool(pool) => pool.current_num_threads(),
        }
    }

    /// Runs work, and returns to Python from time to time to look for Ctrl+C.
    fn run<T: Send>(&self, interrupt: &Interrupt, work: impl FnOnce() -> T + Send) -> T {
        match self {
            Self::Pool(pool) => pool
                .in_place_scope(|scope| {
                    let (sender, receiver) = channel();
                    // The receiver waits for the result.
                    scope.spawn(move |_| _ = sender.send(work()));
                    loop {
                        match receiver.recv_timeout(PERIOD) {
                            Ok(result) => return Some(result),
                            Err(RecvTimeoutError::Timeout) => interrupt.look(),
                            Err(RecvTimeoutError::Disconnected) => return None,
                        }
                    }
                })
                .expect("the scope passes on a panic"),
            Self::Caller => OWN_POOL.with(|own| {
                // The calling thread is the pool's only thread, so this does not change threads.
                let own = own.as_ref().expect("a thread joins one pool, and only here");
                own.install(work)
            }),
        }
    }
}

/// Tells work to end after Ctrl+C. Only the main thread of Python hears of signals.
pub(crate) struct Interrupt {
    is_main: bool,
    /// Whether the thread that works has to look by itself.
    is_alone: bool,
    /// Cancelled by a signal.
    pub(crate) progress: Progress,
    error: Mutex<Option<PyErr>>,
    /// The time of the next look.
    next: Mutex<Instant>,
}

impl Interrupt {
    fn new(py: Python<'_>, threads: &Threads) -> PyResult<Self> {
        let threading = py.import("threading")?;
        let main = threading.call_method0("main_thread")?.getattr("ident")?;
        Ok(Self {
            is_main: threading.call_method0("get_ident")?.eq(main)?,
            is_alone: matches!(threads, Threads::Caller),
            progress: Progress::new(),
            error: Mutex::new(None),
            next: Mutex::new(Instant::now() + PERIOD),
        })
    }

    /// Runs the handlers of signals. The error of a handler ends the work.
    fn look(&self) {
        if !self.is_main {
            return;
        }
        if let Err(error) = Python::attach(|py| py.check_signals()) {
            self.error.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
            self.progress.cancel();
        }
    }

    /// Returns whether the work goes on. To be asked often, as between two tiles.
    pub(crate) fn is_wanted(&self) -> bool {
        if self.is_main && self.is_alone {
            let mut next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
            if Instant::now() >= *next {
                *next = Instant::now() + PERIOD;
                drop(next);
                self.look();
            }
        }
        !self.progress.is_cancelled()
    }
}

thread_local! {
    /// A pool of this thread alone. It has no other threads, so it survives a fork.
    static OWN_POOL: Option<ThreadPool> =
        ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().ok();
}

struct Painters {
    idle: Vec<Painter>,
    busy: usize,
}

static PAINTERS: Mutex<Painters> = Mutex::new(Painters { idle: Vec::new(), busy: 0 });

/// Whether this process was forked while a painter was busy.
static IS_LOST: AtomicBool = AtomicBool::new(false);

/// Returns an error in processes that cannot draw.
pub(crate) fn check_fork() -> Result<(), Failure> {
    if IS_LOST.load(Ordering::Acquire) { Err(Failure::Forked) } else { Ok(()) }
}

/// Runs short work in a pool of this number of threads (0: one per core), without Python's lock.
pub(crate) fn work<T: Send>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce(&mut Renderer) -> Result<T, Failure> + Send,
) -> PyResult<T> {
    work_while(py, threads, |renderer, _| work(renderer))
}

/// Works like [`work`]. The work ends early if it is interrupted, and its result does not count.
pub(crate) fn work_while<T: Send>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce(&mut Renderer, &Interrupt) -> Result<T, Failure> + Send,
) -> PyResult<T> {
    check_fork()?;
    if threads > MOST_THREADS {
        return Err(Failure::value(format!("threads is at most {MOST_THREADS}")).into());
    }
    let mut painter = py.detach(|| borrow(threads));
    let interrupt = match Interrupt::new(py, &painter.threads) {
        Ok(interrupt) => interrupt,
        Err(error) => {
            give_back(Some(painter));
            return Err(error);
        }
    };
    let done = py.detach(|| {
        let Painter { threads, renderer } = &mut painter;
        let work = || threads.run(&interrupt, || work(renderer, &interrupt));
        let done = catch_unwind(AssertUnwindSafe(work));
        // After a panic, the renderer may be in any state.
        give_back(done.is_ok().then_some(painter));
        done.unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
            let text = text.or_else(|| panic.downcast_ref::<String>().cloned());
            Err(Failure::Panic(text.unwrap_or_else(|| "a panic without a message".to_owned())))
        })
    });
    match interrupt.error.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => Ok(done?),
    }
}

/// Returns the number of threads that the process may run at the same time.
#[pyfunction]
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn borrow(threads: usize) -> Painter {
    let threads = if threads == 0 { cores() } else { threads };
    let mut painters = PAINTERS.lock().unwrap_or_else(PoisonError::into_inner);
    let has = |painter: &Painter| painter.threads.count() == threads;
    if let Some(at) = painters.idle.iter().rposition(has) {
        painters.busy += 1;
        return painters.idle.remove(at);
    }
    let threads = if threads == 1 {
        Threads::Caller
    } else {
        // A system that limits threads may provide fewer, or none.
        let pool = threads::pool(threads, Caller::Waits, "marraztu");
        pool.map_or(Threads::Caller, Threads::Pool)
    };
    painters.busy += 1;
    Painter { threads, renderer: Renderer::default() }
}

fn give_back(painter: Option<Painter>) {
    let mut painters = PAINTERS.lock().unwrap_or_else(PoisonError::into_inner);
    painters.busy -= 1;
    let mut oldest = None;
    if let Some(painter) = painter {
        if painters.idle.len() >= MOST_IDLE {
            oldest = Some(painters.idle.remove(0));
        }
        painters.idle.push(painter);
    }
    // Ending threads needs no lock.
    drop(painters);
    drop(oldest);
}

/// Python calls this in a child process after each fork, before all other code.
#[pyfunction]
pub(crate) fn after_fork() {
    let painters = match PAINTERS.try_lock() {
        Ok(painters) => Some(painters),
        Err(TryLockError::Poisoned(painters)) => Some(painters.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    };
    match painters {
        Some(mut painters) if painters.busy == 0 => {
            // Dropping a pool would wait for threads that do not exist here.
            std::mem::forget(std::mem::take(&mut painters.idle));
        }
        _ => IS_LOST.store(true, Ordering::Release),
    }
}
