//! Temporary files for new content, and the removal of leftovers.
//!
//! A temporary file is named `.NAME.HOST-PID-RANDOM.part`. Processes on several hosts and in
//! several containers may write to one folder. Their process numbers repeat, so the host is part of
//! the name, and each process draws a random number. On Linux, the host includes the number of the
//! process namespace.
//!
//! A killed process leaves its file behind. The first write to a folder removes the files of
//! processes that have ended. Later writes do not list the folder, so the N-th picture in a folder
//! costs as much as the first.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU16, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::Duration;

use marraztu_core::base::once::get_or_compute;

/// The ending of temporary files.
const ENDING: &str = ".part";

/// The most bytes of the target's name in the name of its temporary file. Most systems allow names
/// of 255 bytes.
const MOST_NAME: usize = 160;

/// The most bytes of the host's name.
const MOST_HOST: usize = 32;

/// The most attempts at an unused name.
const MOST_ATTEMPTS: usize = 100;

/// On systems that cannot tell whether a process runs, temporary files of this age are leftovers.
const LONG_AGO: Duration = Duration::from_hours(24);

/// Returns the name of this machine, and on Linux the namespace of its process numbers.
fn host() -> &'static str {
    static HOST: OnceLock<String> = OnceLock::new();
    let host: &String = get_or_compute(&HOST, || {
        #[cfg(target_family = "wasm")]
        let name = std::ffi::OsString::from("wasm");
        #[cfg(not(target_family = "wasm"))]
        let name = gethostname::gethostname();
        let plain = |c: &char| c.is_ascii_alphanumeric();
        let name: String = name.to_string_lossy().chars().filter(plain).take(MOST_HOST).collect();
        let namespace = fs::read_link("/proc/self/ns/pid").unwrap_or_default();
        let digits = |c: &char| c.is_ascii_digit();
        let number: String = namespace.to_string_lossy().chars().filter(digits).collect();
        format!("{name}_{number}")
    });
    host
}

/// Returns the number of this process; WebAssembly has no processes.
pub(super) fn own_process() -> u32 {
    if cfg!(target_family = "wasm") { 1 } else { std::process::id() }
}

/// Returns the random number of this process.
fn random() -> u32 {
    static RANDOM: OnceLock<u32> = OnceLock::new();
    *get_or_compute(&RANDOM, || {
        let bits = RandomState::new().hash_one(own_process());
        u32::try_from(bits >> 32).unwrap_or_default()
    })
}

/// Returns the folder of a file.
pub(super) fn folder(target: &Path) -> &Path {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Creates a temporary file next to its target. Fails if it cannot be created.
pub(super) fn create_part(target: &Path) -> std::io::Result<(File, PathBuf)> {
    static COUNT: AtomicU16 = AtomicU16::new(0);
    let mut attempts = 0;
    loop {
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = part_name(target, host(), own_process(), (random(), number));
        let part = folder(target).join(name);
        attempts += 1;
        match OpenOptions::new().read(true).write(true).create_new(true).open(&part) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && attempts < MOST_ATTEMPTS => {}
            opened => return opened.map(|file| (file, part)),
        }
    }
}

fn part_name(target: &Path, host: &str, process: u32, (random, number): (u32, u16)) -> String {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let name = &name[..name.floor_char_boundary(MOST_NAME)];
    format!(".{name}.{host}-{process}-{random:08x}{number:04x}{ENDING}")
}

/// Removes the temporary files of ended processes in a folder, at the first call for the folder.
/// Each write to a folder does so, too.
pub fn sweep_once(folder: &Path) {
    static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    let mut swept = SWEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if !swept.insert(folder.to_owned()) {
        return;
    }
    drop(swept);
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries.filter(is_left_over) {
        // If this fails, the file stays.
        let _ = fs::remove_file(entry.path());
    }
}

/// Returns whether an entry of a folder is a temporary file of an ended process of this host.
fn is_left_over(entry: &fs::DirEntry) -> bool {
    let name = entry.file_name();
    let Some((process, number)) = name.to_str().and_then(owner) else { return false };
    if process == own_process() {
        return number != random();
    }
    if Path::new("/proc/self").exists() {
        return !Path::new("/proc").join(process.to_string()).exists();
    }
    let age = entry.metadata().and_then(|metadata| metadata.modified());
    age.ok().and_then(|written| written.elapsed().ok()).is_some_and(|age| age > LONG_AGO)
}

/// Returns the process of this host that wrote a temporary file, and its random number.
fn owner(name: &str) -> Option<(u32, u32)> {
    let owner = name.strip_prefix('.')?.strip_suffix(ENDING)?;
    let mut parts = owner.rsplitn(3, '-');
    let (number, process, rest) = (parts.next()?, parts.next()?, parts.next()?);
    rest.strip_suffix(host())?.strip_suffix('.')?;
    let number = number.split_at_checked(8).filter(|(_, count)| count.len() == 4)?.0;
    Some((process.parse().ok()?, u32::from_str_radix(number, 16).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replace::{Worth, replace};

    /// Returns the id of a process that has ended.
    #[cfg(target_os = "linux")]
    fn ended() -> u32 {
        let mut child = std::process::Command::new("true").spawn().unwrap();
        child.wait().unwrap();
        child.id()
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_first_write_to_a_folder_removes_leftovers_and_later_writes_do_not_list_it() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.png");
        let leave = |host: &str, process, random| {
            let part = folder.path().join(part_name(&target, host, process, (random, 7)));
            fs::write(&part, "half").unwrap();
            part
        };
        let (own, parent) = (std::process::id(), std::os::unix::process::parent_id());
        let gone = [leave(host(), ended(), 1), leave(host(), own, !random())];
        let kept = [
            leave(host(), parent, 1),
            leave(host(), own, random()),
            leave("other_1", ended(), 1),
            folder.path().join(format!("a.png.{}.new", ended())),
            folder.path().join(".mine.part"),
        ];
        for path in &kept {
            fs::write(path, "theirs").unwrap();
        }
        replace(&target, b"whole", Worth::Product).unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"whole");
        assert!(gone.iter().all(|part| !part.exists()), "their processes have ended");
        assert!(kept.iter().all(|part| part.exists()), "they may be in use, or are not ours");
        // A second leftover would disappear if the folder was read again.
        let later = leave(host(), ended(), 2);
        for _ in 0..10 {
            replace(&target, b"whole", Worth::Product).unwrap();
        }
        assert!(later.exists(), "the folder was listed again");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), kept.len() + 2);
    }

    #[test]
    fn names_near_the_limit_of_the_system_have_a_temporary_file() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["x".repeat(240), "\u{e9}".repeat(120)] {
            let target = folder.path().join(name + ".png");
            replace(&target, b"whole", Worth::Product).unwrap();
            assert_eq!(fs::read(&target).unwrap(), b"whole");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn threads_that_write_one_file_at_once_leave_one_of_their_contents() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.ppm");
        std::thread::scope(|scope| {
            for i in 0..8_u8 {
                let target = &target;
                scope.spawn(move || replace(target, &[i; 4096], Worth::Product).unwrap());
            }
        });
        let content = fs::read(&target).unwrap();
        assert!(content.len() == 4096 && content.iter().all(|byte| *byte == content[0]));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
