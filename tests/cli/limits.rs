//! Systems that limit the number of threads: containers, clusters, web hosts.

#![cfg(target_os = "linux")]
#![expect(clippy::print_stderr, reason = "a test that is left out says so")]

use super::*;

use std::os::unix::fs::PermissionsExt as _;

/// The user without other processes that the limit applies to. It does not apply to root.
const USER: &str = "64983";

/// Runs the program as a user who may have this number of threads. `None` if this user cannot
/// become another one.
fn limited(threads: usize, folder: &Path, arguments: &[&str]) -> Option<Output> {
    let program = folder.join("marraztu");
    let command = format!("ulimit -u {threads}; HOME=/ exec \"$0\" \"$@\"");
    let become_it = ["--reuid", USER, "--regid", USER, "--clear-groups", "bash", "-c", &command];
    let mut timeout = Command::new("timeout");
    timeout.arg("300").arg("setpriv").args(become_it).arg(program).args(arguments);
    let output = timeout.current_dir(folder).stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8_lossy(&output.stderr);
    let has_begun = !text.contains("setpriv: ") && output.status.code() != Some(127);
    has_begun.then_some(output)
}

#[test]
fn a_limit_of_threads_leaves_fewer_threads_or_one_sentence_and_never_a_panic() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(0o777)).unwrap();
    let program = env!("CARGO_BIN_EXE_marraztu");
    if std::fs::hard_link(program, at("marraztu")).is_err() {
        std::fs::copy(program, at("marraztu")).unwrap();
    }
    std::fs::write(at("a.obj"), SQUARE).unwrap();
    let draw = ["render", "a.obj", "--size", "200", "--out"];
    ends_with(0, folder.path(), &[&draw[..], &["expected.png"]].concat());
    let expected = std::fs::read(at("expected.png")).unwrap();
    if limited(9, folder.path(), &["--version"]).is_none() {
        eprintln!("LEFT OUT: this user cannot become another one");
        return;
    }
    let small = ["--size", "200", "--samples", "1"];
    for threads in [1, 2, 3, 5, 9] {
        for options in [&[][..], &["--threads", "1"], &["--threads", "2"], &["--threads", "64"]] {
            let arguments = [&draw[..], &["x.png"], options].concat();
            let output = limited(threads, folder.path(), &arguments).unwrap();
            let err = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{threads} {arguments:?}\n{err}");
            assert!(std::fs::read(at("x.png")).unwrap() == expected, "{threads} {arguments:?}");
            std::fs::remove_file(at("x.png")).unwrap();
        }
        for arguments in [
            &["info", "a.obj", "a.obj"][..],
            &["thumbnail", "a.obj", "thumbnail.png"],
            &["views", "a.obj", "--out", "views.png", "--size", "64"],
            &["turntable", "a.obj", "--out", "turn.gif", "--size", "32", "--frames", "2"],
            &["compare", "expected.png", "expected.png"],
            &["plan", "a.obj", "--size", "64"],
            &["export", "a.obj", "--out", "export.glb"],
        ] {
            let output = limited(threads, folder.path(), arguments).unwrap();
            let err = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{threads} {arguments:?}\n{err}");
        }
        // A batch collects the results of other threads, so it needs one.
        let batch = ["batch", "a.obj", "--views", "3", "--report", "r.jsonl"];
        for options in [&small[..], &["--size", "1100", "--threads", "4"]] {
            let output = limited(threads, folder.path(), &[&batch[..], options].concat()).unwrap();
            let err = String::from_utf8_lossy(&output.stderr);
            match output.status.code() {
                Some(0) => {}
                Some(1) => {
                    assert!(threads == 1 && err.starts_with("error: a thread to draw"), "{err}");
                    assert_eq!(err.lines().count(), 1, "{err}");
                }
                other => panic!("{threads}: {other:?}\n{err}"),
            }
            assert!(!err.contains("panicked"), "{err}");
        }
    }
}
