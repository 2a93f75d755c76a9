//! Batches for a budget: settings are found once, and all pictures have them.
//!
//! Catches: a picture with other settings than the options that are printed, an axis that is given
//! and changed all the same, parts of a list with different settings.

use super::*;

/// The pictures of a batch, and the options that it prints.
fn drawn(folder: &Path, more: &[&str]) -> (BTreeMap<PathBuf, Vec<u8>>, Vec<String>) {
    let draw = ["batch", "models/*.obj", "--views", "2", "--out", "out/{stem}-{view}.png"];
    let (_, err) = ends_with(0, folder, &[&draw[..], &["--size", "48"], more].concat());
    let found = err.lines().find(|line| line.contains("against the ideal"));
    let options = found.map(|line| line.rsplit_once(": ").unwrap().1.to_owned());
    let pictures = contents(&folder.join("out"));
    std::fs::remove_dir_all(folder.join("out")).unwrap();
    let options = options.map(|it| it.split(' ').map(str::to_owned).collect());
    (pictures, options.unwrap_or_default())
}

#[test]
fn a_batch_for_an_error_has_the_settings_that_it_prints() {
    let folder = folder();
    let (pictures, options) = drawn(folder.path(), &["--error", "4", "--depth", "bits-24"]);
    assert!(options.iter().any(|word| word == "--samples"), "{options:?}");
    assert!(!options.iter().any(|word| word == "--depth"), "it is given: {options:?}");
    let mut pinned: Vec<&str> = options.iter().map(String::as_str).collect();
    pinned.extend(["--depth", "bits-24"]);
    let (again, none) = drawn(folder.path(), &pinned);
    assert_eq!(none, Vec::<String>::new());
    assert!(pictures == again, "{options:?}");
    for more in [&["--shard", "0/2"][..], &["--resume"]] {
        let draw = ["batch", "models/*.obj", "--out", "out/{stem}.png", "--error", "4"];
        let (_, err) = ends_with(2, folder.path(), &[&draw[..], more].concat());
        assert!(err.contains("parts would differ"), "{err}");
    }
}
