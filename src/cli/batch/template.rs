//! Names of output files: a template with the fields of Python's format strings.

use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};

/// The largest width of a number.
const MOST_WIDTH: usize = 20;

/// A field of a template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Field {
    /// The folder of the model, as given, without a leading slash.
    Dir,
    /// The name of the model without extension.
    Stem,
    /// The name of the model.
    Name,
    /// The number of the picture in the whole list, from 0.
    Index,
    /// The number of the view, from 0.
    View,
    /// The name of the view.
    ViewName,
    /// The name of the layer.
    Layer,
    /// The extension of the format.
    Ext,
}

impl Field {
    const ALL: [(&'static str, Self); 8] = [
        ("dir", Self::Dir),
        ("stem", Self::Stem),
        ("name", Self::Name),
        ("index", Self::Index),
        ("view", Self::View),
        ("view_name", Self::ViewName),
        ("layer", Self::Layer),
        ("ext", Self::Ext),
    ];

    /// Returns whether it is a number, which may have a width.
    const fn is_number(self) -> bool {
        matches!(self, Self::Index | Self::View)
    }
}

/// A part of a template.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(String),
    /// A field; a number has at least `width` digits.
    Field(Field, usize),
}

/// A template of file names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Template(Vec<Piece>);

/// The values of the fields.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fields<'a> {
    pub(super) file: &'a Path,
    pub(super) index: usize,
    pub(super) view: usize,
    pub(super) view_name: &'a str,
    pub(super) layer: &'a str,
    pub(super) ext: &'a str,
}

impl Template {
    /// Parses a template. Fails with the reason if a brace is unmatched or a field does not exist.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut pieces = Vec::new();
        let mut plain = String::new();
        let mut rest = text;
        while let Some(at) = rest.find(['{', '}']) {
            plain += &rest[..at];
            let after = &rest[at + 1..];
            let brace = &rest[at..=at];
            // A doubled brace is a brace.
            if let Some(after) = after.strip_prefix(brace) {
                plain += brace;
                rest = after;
                continue;
            }
            let end = after.find('}').filter(|_| brace == "{");
            let end = end.ok_or("a brace is unmatched; write {{ or }} for a brace")?;
            if !plain.is_empty() {
                pieces.push(Piece::Text(std::mem::take(&mut plain)));
            }
            pieces.push(field(&after[..end])?);
            rest = &after[end + 1..];
        }
        plain += rest;
        if !plain.is_empty() {
            pieces.push(Piece::Text(plain));
        }
        Ok(Self(pieces))
    }

    /// Returns the default template: the name of the model, with the view if there are several, and
    /// the layer if each has its own file.
    pub(super) fn of_views(count: usize, by_layer: bool) -> Self {
        let stem = Piece::Field(Field::Stem, 0);
        let ending = [Piece::Text(".".to_owned()), Piece::Field(Field::Ext, 0)];
        let view = [Piece::Text("-".to_owned()), Piece::Field(Field::View, 3)];
        let view = if count > 1 { &view[..] } else { &[] };
        let layer = [Piece::Text("-".to_owned()), Piece::Field(Field::Layer, 0)];
        let layer = if by_layer { &layer[..] } else { &[] };
        Self([&[stem], view, layer, &ending].concat())
    }

    /// Returns the file of a picture.
    pub(super) fn path(&self, fields: &Fields<'_>) -> PathBuf {
        let mut path = String::new();
        for piece in &self.0 {
            // Writing to a string cannot fail.
            let _ = match piece {
                Piece::Text(text) => write!(path, "{text}"),
                Piece::Field(Field::Dir, _) => write!(path, "{}", dir(fields.file)),
                Piece::Field(Field::Stem, _) => write!(path, "{}", stem(fields.file)),
                Piece::Field(Field::Name, _) => write!(path, "{}", name(fields.file)),
                Piece::Field(Field::Index, width) => write!(path, "{:0width$}", fields.index),
                Piece::Field(Field::View, width) => write!(path, "{:0width$}", fields.view),
                Piece::Field(Field::ViewName, _) => write!(path, "{}", fields.view_name),
                Piece::Field(Field::Layer, _) => write!(path, "{}", fields.layer),
                Piece::Field(Field::Ext, _) => write!(path, "{}", fields.ext),
            };
        }
        // `a//b` and `a/./b` are `a/b`.
        Path::new(&path).components().collect()
    }
}

fn field(text: &str) -> Result<Piece, String> {
    let (name, format) = text.split_once(':').map_or((text, None), |(a, b)| (a, Some(b)));
    let Some((_, field)) = Field::ALL.iter().find(|(other, _)| *other == name) else {
        let names: Vec<String> = Field::ALL.iter().map(|(name, _)| format!("{{{name}}}")).collect();
        return Err(format!("there is no field {{{name}}}; the fields are {}", names.join(", ")));
    };
    let Some(format) = format else { return Ok(Piece::Field(*field, 0)) };
    let width = format.parse().ok().filter(|width| *width <= MOST_WIDTH && field.is_number());
    let width = width.ok_or_else(|| {
        format!("{{{text}}}: only index and view have a width, such as {{index:06}}")
    })?;
    Ok(Piece::Field(*field, width))
}

/// Returns the name of a model without folders.
fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Returns the name of a model without extension; `.obj.gz` is one extension.
pub(super) fn stem(file: &Path) -> String {
    let name = Path::new(file.file_name().unwrap_or_default());
    let inner = match name.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("gz") => name.with_extension(""),
        _ => name.to_owned(),
    };
    inner.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Returns the folder of a model within the folder of the output: without a root, and without
/// parts that would leave it.
fn dir(file: &Path) -> String {
    let parts = file.parent().into_iter().flat_map(Path::components);
    let parts = parts.filter_map(|part| match part {
        Component::Normal(name) => Some(name.to_string_lossy().into_owned()),
        Component::Prefix(_) | Component::RootDir | Component::CurDir | Component::ParentDir => {
            None
        }
    });
    let dir = parts.collect::<Vec<_>>().join("/");
    if dir.is_empty() { ".".to_owned() } else { dir }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(template: &str, file: &str) -> PathBuf {
        let (file, view_name, layer) = (Path::new(file), "front", "depth");
        let fields = Fields { file, index: 42, view: 7, view_name, layer, ext: "png" };
        Template::parse(template).unwrap().path(&fields)
    }

    #[test]
    fn fields_are_replaced_and_doubled_braces_are_braces() {
        for (template, file, expected) in [
            ("out/{dir}/{stem}/{view:03}.{ext}", "models/a.b.obj", "out/models/a.b/007.png"),
            ("{index:06}-{view_name}.{ext}", "a.obj", "000042-front.png"),
            ("{stem}-{layer}.{ext}", "a.obj", "a-depth.png"),
            ("{name}.{ext}", "models/a.obj.gz", "a.obj.gz.png"),
            ("{stem}.jpg", "models/a.OBJ.GZ", "a.jpg"),
            ("{{{stem}}}-{index}.png", "a.obj", "{a}-42.png"),
            ("out/{dir}/{stem}.png", "a.obj", "out/a.png"),
            ("out/{dir}/{stem}.png", "/data/x/a.obj", "out/data/x/a.png"),
            ("out/{dir}/{stem}.png", "../../x/./a.obj", "out/x/a.png"),
        ] {
            assert_eq!(path(template, file), Path::new(expected), "{template} {file}");
        }
        for (count, by_layer, template) in [
            (1, false, "{stem}.{ext}"),
            (2, false, "{stem}-{view:03}.{ext}"),
            (1, true, "{stem}-{layer}.{ext}"),
            (2, true, "{stem}-{view:03}-{layer}.{ext}"),
        ] {
            let named = Template::of_views(count, by_layer);
            assert_eq!(named, Template::parse(template).unwrap());
        }
    }

    #[test]
    fn wrong_templates_are_rejected_with_the_reason() {
        for (template, reason) in [
            ("{", "unmatched"),
            ("}", "unmatched"),
            ("{stem", "unmatched"),
            ("{stem}}", "unmatched"),
            ("{shape}", "there is no field {shape}"),
            ("{}", "there is no field {}"),
            ("{stem:03}", "only index and view"),
            ("{index:x}", "only index and view"),
            ("{index:99}", "only index and view"),
        ] {
            let error = Template::parse(template).unwrap_err();
            assert!(error.contains(reason), "{template}: {error}");
        }
    }
}
