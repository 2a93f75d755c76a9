//! The program's own files: preferences, and unsaved work for recovery after a crash.
//!
//! ```text
//! state folder    work-<process>-<number>.marraztu   the unsaved scene of a running program
//!                 work-<process>-<number>.lock       locked while that program runs
//!                 discarded-<time>-....marraztu      work that was discarded, for 30 days
//!                 lock                               locked while a program looks for others
//! config folder   preferences.ron                    theme, panels, scale, window, recent files
//! ```
//!
//! The system releases a lock when its process ends, for whatever reason. A file with a free lock
//! was therefore left by a program that crashed or was killed.

mod abandoned;
mod discarded;
mod journal;
mod origin;
mod preferences;
mod slots;

pub use abandoned::Abandoned;
pub use discarded::Discarded;
pub use journal::{Journal, JournalNews, Unsaved};
pub use preferences::{Helpers, MOST_RECENT, Preferences, Theme};
pub use slots::OwnFolders;
