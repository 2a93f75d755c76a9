//! Finds out which file of a floor uses which other one, however the use is written.
//!
//! Paths are followed as the compiler follows them: through `super` and `self`, opened braces,
//! renamed imports, re-exports and globs. An arrow therefore ends at the file that defines a name,
//! not at the `mod.rs` that passes it on. Tests inside a file are left out.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A path in the source, from the name it begins with.
type Names = Vec<String>;

/// One file of the sources.
#[derive(Debug, Default)]
struct Source {
    code: String,
    /// The spans of modules that are written inside the file.
    inner: Vec<(usize, usize)>,
    /// Each imported name, with its path from the root.
    imports: BTreeMap<String, Names>,
    /// The modules whose names are all imported.
    globs: Vec<Names>,
}

/// Every file of a tree of sources, by its path of modules, which is empty for the root.
#[derive(Debug, Default)]
pub(crate) struct Sources {
    files: BTreeMap<Names, Source>,
}

/// A path as it is written somewhere.
struct Written {
    at: usize,
    names: Names,
    /// The name that it is imported under, if it stands in a `use`.
    imported: Option<String>,
}

impl Sources {
    /// Reads all files under `root`, the folder that holds `lib.rs`.
    pub(crate) fn read(root: &Path) -> Self {
        let texts = super::rust_files(root).into_iter().map(|file| {
            let text = std::fs::read_to_string(&file).expect("a source can be read");
            let name = file.strip_prefix(root).expect("it lies under the root").to_owned();
            (name.to_string_lossy().into_owned(), text)
        });
        Self::of(texts)
    }

    /// Sources as names of files, such as `app/mod.rs`, and texts.
    pub(crate) fn of(texts: impl IntoIterator<Item = (String, String)>) -> Self {
        let mut files = BTreeMap::new();
        let mut tests = Vec::new();
        for (name, text) in texts {
            let module = module_of(&name);
            let (code, test_files) = without_tests(&without_comments(&text));
            let in_tests = |test: String| module.iter().cloned().chain([test]).collect::<Names>();
            tests.extend(test_files.into_iter().map(in_tests));
            let inner = inner_modules(&code);
            files.insert(module, Source { code, inner, ..Source::default() });
        }
        files.retain(|module: &Names, _| !tests.iter().any(|test| module.starts_with(test)));
        let mut sources = Self { files };
        sources.read_imports();
        sources
    }

    fn read_imports(&mut self) {
        let modules: Vec<Names> = self.files.keys().cloned().collect();
        for module in modules {
            let source = &self.files[&module];
            let (mut imports, mut globs) = (BTreeMap::new(), Vec::new());
            for written in paths(&source.code, &self.children(&module)) {
                let Some(name) = written.imported else { continue };
                let path = from_root(&module, source.depth(written.at), &written.names);
                if name == "*" {
                    globs.push(path);
                } else {
                    imports.insert(name, path);
                }
            }
            let source = self.files.get_mut(&module).expect("it was just read");
            (source.imports, source.globs) = (imports, globs);
        }
    }

    fn children(&self, module: &[String]) -> BTreeSet<String> {
        let own = self.files.keys().filter(|other| other.len() == module.len() + 1);
        own.filter(|other| other.starts_with(module))
            .filter_map(|other| other.last())
            .cloned()
            .collect()
    }

    /// The file that defines what `path` names.
    fn file_of(&self, path: &[String]) -> Names {
        self.follow(path, 0)
    }

    fn follow(&self, path: &[String], steps: usize) -> Names {
        let mut here = Names::new();
        for (i, name) in path.iter().enumerate() {
            let mut child = here.clone();
            child.push(name.clone());
            if self.files.contains_key(&child) {
                here = child;
                continue;
            }
            let Some(source) = self.files.get(&here) else { break };
            let passed_on = match source.imports.get(name) {
                Some(target) => Some(target.clone()),
                None => self.through_globs(source, name),
            };
            // A name that is imported from itself ends here.
            if let Some(mut target) = passed_on
                && steps < 16
                && target != path[..=i]
            {
                target.extend_from_slice(&path[i + 1..]);
                return self.follow(&target, steps + 1);
            }
            break;
        }
        here
    }

    fn through_globs(&self, source: &Source, name: &str) -> Option<Names> {
        source.globs.iter().find_map(|glob| {
            let file = self.files.get(glob)?;
            (defines(&file.code, name) || file.imports.contains_key(name)).then(|| {
                let mut path = glob.clone();
                path.push(name.to_owned());
                path
            })
        })
    }

    /// The files that each file under `folder` uses, itself left out.
    pub(crate) fn arrows(&self, folder: &[&str]) -> BTreeMap<Names, BTreeSet<Names>> {
        let folder: Names = folder.iter().map(|name| (*name).to_owned()).collect();
        let inside = |module: &Names| module.starts_with(&folder);
        let mut arrows = BTreeMap::new();
        for (module, source) in self.files.iter().filter(|(module, _)| inside(module)) {
            let mut used = self.used_by(module, source);
            used.retain(|other| inside(other) && other != module);
            arrows.insert(module.clone(), used);
        }
        arrows
    }

    fn used_by(&self, module: &Names, source: &Source) -> BTreeSet<Names> {
        let mut used = BTreeSet::new();
        let is_module = |path: &Names| self.files.contains_key(path);
        let modules = source.imports.iter().filter(|(_, path)| is_module(path));
        let mut beginnings = self.children(module);
        beginnings.extend(modules.map(|(name, _)| name.clone()));
        for written in paths(&source.code, &beginnings) {
            let depth = source.depth(written.at);
            let path = match source.imports.get(&written.names[0]) {
                Some(start) => [&start[..], &written.names[1..]].concat(),
                None => from_root(module, depth, &written.names),
            };
            used.insert(self.file_of(&path));
            // A glob uses what it brings in and the file then names.
            if written.imported.as_deref() == Some("*")
                && let Some(all) = self.files.get(&path).filter(|_| &path != module)
            {
                let named = all.imports.iter().filter(|(name, _)| has_word(&source.code, name));
                used.extend(named.map(|(_, path)| self.file_of(path)));
            }
        }
        used
    }
}

impl Source {
    /// In how many modules inside the file a place stands.
    fn depth(&self, at: usize) -> usize {
        self.inner.iter().filter(|(start, end)| (*start..*end).contains(&at)).count()
    }
}

/// The files of each cycle that is longer than one file and its own parts.
pub(crate) fn cycles(arrows: &BTreeMap<Names, BTreeSet<Names>>) -> Vec<Vec<Names>> {
    let mut found = Vec::new();
    for mut knot in knots(arrows) {
        let first =
            knot.iter().min_by_key(|module| module.len()).expect("a knot has files").clone();
        if knot.iter().all(|module| module.starts_with(&first)) {
            // The rest must have no cycle once the parts no longer use the whole.
            let mut without: BTreeMap<_, _> =
                arrows.iter().filter(|(module, _)| knot.contains(module)).map(copy).collect();
            for used in without.values_mut() {
                used.remove(&first);
            }
            let rest = cycles(&without);
            found.extend(rest);
        } else {
            knot.sort();
            found.push(knot);
        }
    }
    found
}

fn copy((module, used): (&Names, &BTreeSet<Names>)) -> (Names, BTreeSet<Names>) {
    (module.clone(), used.clone())
}

/// The files that reach each other, two or more together.
fn knots(arrows: &BTreeMap<Names, BTreeSet<Names>>) -> Vec<Vec<Names>> {
    let reached: BTreeMap<&Names, BTreeSet<&Names>> =
        arrows.keys().map(|module| (module, reach(module, arrows))).collect();
    let mut knots: Vec<Vec<Names>> = Vec::new();
    for module in arrows.keys() {
        if knots.iter().flatten().any(|other| other == module) {
            continue;
        }
        let back = |other: &&&Names| reached.get(**other).is_some_and(|all| all.contains(module));
        let knot: Vec<Names> =
            reached[module].iter().filter(back).map(|other| (*other).clone()).collect();
        if knot.len() > 1 {
            knots.push(knot);
        }
    }
    knots
}

fn reach<'a>(
    start: &'a Names,
    arrows: &'a BTreeMap<Names, BTreeSet<Names>>,
) -> BTreeSet<&'a Names> {
    let (mut reached, mut left) = (BTreeSet::new(), vec![start]);
    while let Some(module) = left.pop() {
        for other in arrows.get(module).into_iter().flatten() {
            if reached.insert(other) {
                left.push(other);
            }
        }
    }
    reached
}

/// The path of modules of a file.
fn module_of(file: &str) -> Names {
    let mut names: Names = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
    if matches!(names.last().map(String::as_str), Some("mod" | "lib" | "main")) {
        names.pop();
    }
    names
}

/// A path that is written in `module`, in `depth` modules inside its file, from the root.
fn from_root(module: &[String], depth: usize, names: &[String]) -> Names {
    let mut path = module.to_vec();
    let mut rest = names;
    match names[0].as_str() {
        "crate" | "marraztu" => {
            path.clear();
            rest = &names[1..];
        }
        "self" => rest = &names[1..],
        "super" => {
            let ups = names.iter().take_while(|name| *name == "super").count();
            path.truncate(module.len() - ups.saturating_sub(depth).min(module.len()));
            rest = &names[ups..];
        }
        _ => {}
    }
    path.extend(rest.iter().filter(|name| *name != "*" && *name != "self").cloned());
    path
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Every path in `code` that begins within the crate or with one of `beginnings`.
fn paths(code: &str, beginnings: &BTreeSet<String>) -> Vec<Written> {
    let mut found = Vec::new();
    for (colons, _) in code.match_indices("::") {
        let start = code[..colons].rfind(|c| !is_name(c)).map_or(0, |i| i + 1);
        let (before, name) = (&code[..start], &code[start..colons]);
        let own = matches!(name, "crate" | "marraztu" | "self" | "super");
        if before.ends_with("::") || before.ends_with("(in ") || !(own || beginnings.contains(name))
        {
            continue;
        }
        let in_use = before.trim_end().ends_with("use");
        let mut leaves = Vec::new();
        tree(&code[start..], &mut Vec::new(), &mut leaves);
        for (names, alias) in leaves {
            let imported = in_use.then(|| {
                let end = names.iter().rev().find(|name| *name != "self");
                alias.unwrap_or_else(|| end.cloned().unwrap_or_default())
            });
            found.push(Written { at: start, names, imported });
        }
    }
    found
}

/// Reads one tree of a `use`, or a plain path; gives back how long it is.
fn tree(text: &str, prefix: &mut Names, leaves: &mut Vec<(Names, Option<String>)>) -> usize {
    let depth = prefix.len();
    let mut at = 0;
    let end = loop {
        at += text[at..].len() - text[at..].trim_start().len();
        let rest = &text[at..];
        if rest.starts_with('{') {
            at += 1;
            loop {
                at += tree(&text[at..], prefix, leaves);
                at += text[at..].find([',', '}']).unwrap_or(text.len() - at);
                let closed = text[at..].starts_with('}') || at >= text.len();
                at += usize::from(at < text.len());
                if closed {
                    break;
                }
            }
            break at;
        }
        let length = if rest.starts_with('*') { 1 } else { name_length(rest) };
        if length == 0 {
            break at;
        }
        prefix.push(rest[..length].to_owned());
        at += length;
        if text[at..].starts_with("::") {
            at += 2;
            // What follows may be types in angle brackets.
            if !text[at..].trim_start().starts_with('<') {
                continue;
            }
        }
        let rest = text[at..].trim_start();
        let alias = rest.strip_prefix("as ").map(|name| name[..name_length(name)].to_owned());
        leaves.push((prefix.clone(), alias));
        break at;
    };
    prefix.truncate(depth);
    end
}

fn name_length(text: &str) -> usize {
    text.find(|c| !is_name(c)).unwrap_or(text.len())
}

fn has_word(code: &str, word: &str) -> bool {
    code.match_indices(word).any(|(at, _)| {
        !code[..at].ends_with(is_name) && !code[at + word.len()..].starts_with(is_name)
    })
}

fn defines(code: &str, name: &str) -> bool {
    let kinds = ["fn ", "struct ", "enum ", "trait ", "type ", "const ", "static ", "mod "];
    kinds.iter().any(|kind| {
        code.match_indices(&format!("{kind}{name}"))
            .any(|(at, found)| !code[at + found.len()..].starts_with(is_name))
    })
}

fn without_comments(text: &str) -> String {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or(""));
    code.collect::<Vec<_>>().join("\n")
}

/// The code without its tests, and the modules of tests that stand in files of their own.
fn without_tests(code: &str) -> (String, Vec<String>) {
    let (mut kept, mut rest, mut files) = (String::new(), code, Vec::new());
    while let Some(at) = rest.find("#[cfg(test)]") {
        kept.push_str(&rest[..at]);
        rest = &rest[at + "#[cfg(test)]".len()..];
        let end = rest.find(['{', ';']).unwrap_or(rest.len());
        let head = rest[..end].trim();
        let Some((_, name)) = head.rsplit_once("mod ") else { continue };
        if rest[end..].starts_with(';') {
            files.push(name.trim().to_owned());
            rest = &rest[end..];
        } else {
            rest = &rest[end + block(&rest[end..])..];
        }
    }
    kept.push_str(rest);
    (kept, files)
}

/// How long the block is that `text` opens with.
fn block(text: &str) -> usize {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => return at + 1,
            '}' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

fn inner_modules(code: &str) -> Vec<(usize, usize)> {
    let starts = code.match_indices("mod ").filter(|(at, _)| !code[..*at].ends_with(is_name));
    starts
        .filter_map(|(at, word)| {
            let name = at + word.len();
            let open = name + name_length(&code[name..]);
            let space = code[open..].len() - code[open..].trim_start().len();
            let open = open + space;
            code[open..].starts_with('{').then(|| (open, open + block(&code[open..])))
        })
        .collect()
}
