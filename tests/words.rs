//! The words and the form of sources and pages: no phrase that reads as translated, no name that
//! has been given up, no line over 100 columns, and no file that rustfmt does not see.
//!
//! `docs/glossary.md` and CONTRIBUTING.md say how to write instead. A phrase is searched for as
//! people read it: across line ends, and in the names of tests.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Phrases that nothing may hold, in lower case, with what to write instead.
const PHRASES: &[(&str, &str)] = &[
    ("so many", "N, or \"this number of\""),
    ("nobody", "no one, or the thing itself"),
    ("of which", "a second sentence, or \"whose\""),
    ("what is what", "what each is"),
    ("as one likes", "any number of"),
    ("that is none", "\"NaN\", or \"is not a ...\""),
    ("that are none", "\"are not ...\""),
    ("by chance", "random, at random"),
];

/// The beginning of a sentence that is a condition if a comma follows: "If" is for conditions,
/// "Where" for places.
const CONDITION: &str = "Where ..., ...";

/// Names that have been given up, as whole words of code; `docs/glossary.md` has those in use.
const NAMES: &[&str] = &[
    "Ask",
    "Choosing",
    "Chosen",
    "Dice",
    "Easel",
    "Economy",
    "Lamp",
    "Located",
    "Machine",
    "Matter",
    "Meaning",
    "Placed",
    "Seen",
    "Shine",
    "Shone",
    "Triple",
    "Wealth",
    "arrives",
    "easel",
    "mesh_found",
    "needless",
    "pace",
];

/// How many columns a line of Rust may have.
const COLUMNS: usize = 100;

/// A line of more than [`COLUMNS`] columns.
const LONG: &str = "a long line";

/// A file that no `mod` statement leads to.
const UNSEEN: &str = "a file that rustfmt does not see";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All files below a folder whose names end in one of these.
fn files(folder: &str, endings: &[&str]) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).expect("the folder can be read") {
            let path = entry.expect("the folder can be read").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| endings.iter().any(|e| end == *e)) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Every source and page, by its path in the project.
fn texts() -> Vec<(String, String)> {
    let mut paths = Vec::new();
    for folder in
        ["src", "crates", "python", "tests", "benches", "docs", "tools", "fuzz/fuzz_targets"]
    {
        paths.extend(files(folder, &["rs", "md", "sh", "py"]));
    }
    for page in ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "CHANGELOG.md"] {
        paths.push(root().join(page));
    }
    let text = |path: PathBuf| {
        let name = path.strip_prefix(root()).expect("it is in the project");
        let name = name.to_str().expect("our names are text").replace('\\', "/");
        (name, std::fs::read_to_string(path).expect("sources are UTF-8"))
    };
    // This file has to name what it forbids.
    paths.into_iter().map(text).filter(|(name, _)| name != "tests/words.rs").collect()
}

/// A text as it is read: without marks of comments and line ends, `_` as a blank.
fn as_read(text: &str) -> String {
    let mut read = String::new();
    for line in text.lines() {
        let line = line.trim().trim_start_matches(['/', '!', '#', '>', '*']).trim();
        read.push_str(line);
        read.push(' ');
    }
    read.replace('_', " ")
}

/// Whether a text holds a phrase as whole words.
fn holds(text: &str, phrase: &str) -> bool {
    let is_word = |c: char| c.is_alphanumeric();
    text.match_indices(phrase).any(|(at, _)| {
        !text[..at].ends_with(is_word) && !text[at + phrase.len()..].starts_with(is_word)
    })
}

/// Whether a sentence begins with "Where" and an article or a pronoun, and goes on behind a comma.
fn has_condition(text: &str) -> bool {
    let articles = ["the", "a", "an", "it", "there", "they", "one"];
    text.match_indices("Where ").any(|(at, begin)| {
        let rest = &text[at + begin.len()..];
        let sentence = rest.split_once(". ").map_or(rest, |(sentence, _)| sentence);
        let word = sentence.split(' ').next().unwrap_or_default();
        articles.contains(&word) && sentence.contains(", ")
    })
}

/// The code of a source: without comments and without what stands between quotation marks.
fn code(text: &str) -> String {
    let mut code = String::new();
    for line in text.lines() {
        let line = line.split("//").next().unwrap_or_default();
        code.extend(line.split('"').step_by(2));
        code.push('\n');
    }
    code
}

/// The faults of one text, each by its phrase or name.
fn faults(name: &str, text: &str) -> Vec<&'static str> {
    let read = as_read(text);
    let lower = read.to_lowercase();
    let mut faults: Vec<&str> = Vec::new();
    faults.extend(PHRASES.iter().map(|(phrase, _)| *phrase).filter(|phrase| holds(&lower, phrase)));
    if has_condition(&read) {
        faults.push(CONDITION);
    }
    if name.ends_with(".rs") {
        let code = code(text);
        let words: BTreeSet<&str> =
            code.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
        faults.extend(NAMES.iter().filter(|name| words.contains(**name)));
        if text.lines().any(|line| line.chars().count() > COLUMNS) {
            faults.push(LONG);
        }
    }
    faults
}

/// The files that the modules of a crate lead to, by `mod` statements that rustfmt sees: at
/// the beginning of a line, and so in no macro.
fn seen_by_rustfmt(file: &Path, seen: &mut BTreeSet<PathBuf>) {
    seen.insert(file.to_owned());
    let text = std::fs::read_to_string(file).expect("a module has a file");
    let folder = file.parent().expect("it is in a folder");
    let stem = file.file_stem().and_then(|stem| stem.to_str()).expect("our names are text");
    let folder = match stem {
        "lib" | "main" | "mod" => folder.to_owned(),
        stem => folder.join(stem),
    };
    for line in text.lines() {
        let Some(declared) = line.strip_suffix(';') else { continue };
        let mut words = declared.split_whitespace();
        let is_declaration = match words.next() {
            Some("mod") => !line.starts_with(' '),
            Some(word) if word.starts_with("pub") && !line.starts_with(' ') => {
                words.any(|word| word == "mod")
            }
            Some(_) | None => false,
        };
        let Some(name) = declared.split_whitespace().last().filter(|_| is_declaration) else {
            continue;
        };
        let places = [folder.join(format!("{name}.rs")), folder.join(name).join("mod.rs")];
        if let Some(place) = places.iter().find(|place| place.is_file()) {
            seen_by_rustfmt(place, seen);
        }
    }
}

/// Every fault of the project: the file, and what it is.
fn all_faults() -> BTreeSet<(String, &'static str)> {
    let mut all = BTreeSet::new();
    let texts = texts();
    assert!(texts.len() > 200, "the sources are elsewhere");
    for (name, text) in &texts {
        all.extend(faults(name, text).into_iter().map(|fault| (name.clone(), fault)));
    }
    let mut seen = BTreeSet::new();
    let folders = [
        "src",
        "crates/core/src",
        "crates/io/src",
        "crates/render/src",
        "crates/lab/src",
        "python/src",
    ];
    for folder in folders {
        for file in ["lib.rs", "main.rs"] {
            let file = root().join(folder).join(file);
            if file.is_file() {
                seen_by_rustfmt(&file, &mut seen);
            }
        }
    }
    for path in
        folders.iter().flat_map(|folder| files(folder, &["rs"])).filter(|path| !seen.contains(path))
    {
        let name = path.strip_prefix(root()).expect("it is in the project");
        all.insert((name.display().to_string(), UNSEEN));
    }
    all
}

#[test]
fn sources_and_pages_read_as_english_and_use_names_that_are_in_use() {
    let wrong: Vec<String> = all_faults()
        .iter()
        .map(|(name, fault)| {
            let instead = PHRASES.iter().find(|(phrase, _)| phrase == fault);
            let instead =
                instead.map_or(String::new(), |(_, instead)| format!("; write {instead}"));
            format!("{name}: \"{fault}\"{instead}")
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_fault_is_seen_however_it_is_written() {
    let phrase = |i: usize| PHRASES[i].0;
    let split = phrase(0).replace(' ', "\n//! ");
    let faulty = [
        (format!("//! It has {split} of them.\n"), phrase(0)),
        (format!("fn {}_calls_it() {{}}\n", phrase(1)), phrase(1)),
        (format!("/// A number {}\n", phrase(5)), phrase(5)),
        (format!("/// {} the file has none,\n/// silver is used.\n", "Where"), CONDITION),
        (format!("let a = {}::new();\n", NAMES[2]), NAMES[2]),
        (format!("// {}\n", "x".repeat(98)), LONG),
    ];
    for (text, fault) in faulty {
        assert_eq!(faults("src/a.rs", &text), [fault], "{text}");
    }
    let right = [
        format!("// {} is a word like any other in a comment\n", NAMES[2]),
        format!("let text = \"{}\";\n", NAMES[2]),
        format!("let a = {}s;\n", NAMES[2]),
        "// Somewhere, where the rays meet.\n".to_owned(),
        format!("/// {} the rays meet. Here, that is.\n", "Where"),
        format!("// {}\n", "x".repeat(97)),
    ];
    for text in right {
        assert_eq!(faults("src/a.rs", &text), Vec::<&str>::new(), "{text}");
    }
}
