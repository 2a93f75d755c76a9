//! Names of output files: a template with the fields of Python's format strings.

use std::path::{Component, Path, PathBuf};

use crate::cli::values;

/// The largest width of a number.
const MOST_WIDTH: usize = 20;

/// What the value of a field depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scope {
    /// The format alone.
    Batch,
    /// The model.
    Model,
    /// The view and the layer.
    Picture,
    /// The number of the picture in the whole list.
    List,
}

/// A field of a template. A number may have a width.
struct Field {
    name: &'static str,
    scope: Scope,
    is_number: bool,
    /// Returns its value with at least this number of digits.
    value: fn(&Fields<'_>, usize) -> String,
}

impl Field {
    const fn text(
        name: &'static str,
        scope: Scope,
        value: fn(&Fields<'_>, usize) -> String,
    ) -> Self {
        Self { name, scope, is_number: false, value }
    }

    const fn number(
        name: &'static str,
        scope: Scope,
        value: fn(&Fields<'_>, usize) -> String,
    ) -> Self {
        Self { name, scope, is_number: true, value }
    }
}

/// The fields: the folder of the model, as given, without a leading slash; its name without and
/// with its extension; the number of the picture in the whole list and of the view, from 0; the
/// names of the view and the layer; the extension of the format.
const FIELDS: [Field; 8] = [
    Field::text("dir", Scope::Model, |fields, _| dir(fields.file)),
    Field::text("stem", Scope::Model, |fields, _| stem(fields.file)),
    Field::text("name", Scope::Model, |fields, _| name(fields.file)),
    Field::number("index", Scope::List, |fields, width| format!("{:0width$}", fields.index)),
    Field::number("view", Scope::Picture, |fields, width| format!("{:0width$}", fields.view)),
    Field::text("view_name", Scope::Picture, |fields, _| fields.view_name.to_owned()),
    Field::text("layer", Scope::Picture, |fields, _| fields.layer.to_owned()),
    Field::text("ext", Scope::Batch, |fields, _| fields.ext.to_owned()),
];

/// A part of a template.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(String),
    /// One of [`FIELDS`] by its index, and the least number of digits.
    Field(usize, usize),
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
        let view = if count > 1 { "-{view:03}" } else { "" };
        let layer = if by_layer { "-{layer}" } else { "" };
        let template = Self::parse(&format!("{{stem}}{view}{layer}.{{ext}}"));
        template.expect("the default template is valid")
    }

    /// Returns the file of a picture.
    pub(super) fn path(&self, fields: &Fields<'_>) -> PathBuf {
        // `a//b` and `a/./b` are `a/b`.
        Path::new(&text(&self.0, fields)).components().collect()
    }

    /// Returns whether the files of all pictures have the same extension.
    pub(super) fn fixes_extension(&self) -> bool {
        let fixed = self.0.iter().rposition(|piece| piece.scope() != Scope::Batch);
        let end = &self.0[fixed.map_or(0, |last| last + 1)..];
        let is_dotted = |piece: &Piece| matches!(piece, Piece::Text(text) if text.contains('.'));
        end.iter().any(is_dotted)
    }

    /// Returns whether the number of a picture can be read from the name of its file: the number
    /// is between a part that all names share and a character that is not a digit.
    pub(super) fn shows_index(&self) -> bool {
        let is_fixed = |pieces: &[Piece]| pieces.iter().all(|it| it.scope() == Scope::Batch);
        let edge = |piece: Option<&Piece>, sign: fn(&str) -> Option<char>| match piece {
            None => true,
            Some(Piece::Text(text)) => sign(text).is_some_and(|sign| !sign.is_ascii_digit()),
            Some(Piece::Field(..)) => false,
        };
        let is_read = |at: usize| {
            let (before, after) = (&self.0[..at], &self.0[at + 1..]);
            let from_left = is_fixed(before) && edge(after.first(), |text| text.chars().next());
            let from_right = is_fixed(after) && edge(before.last(), |text| text.chars().last());
            from_left || from_right
        };
        (0..self.0.len()).any(|at| self.0[at].scope() == Scope::List && is_read(at))
    }

    /// Splits the file of a picture into the texts before, inside and after the fields that depend
    /// on the view and the layer. `None` if one depends on the list, or one between on the model.
    pub(super) fn split(&self, fields: &Fields<'_>) -> Option<[String; 3]> {
        let is_picture = |piece: &Piece| piece.scope() == Scope::Picture;
        if self.0.iter().any(|piece| piece.scope() == Scope::List) {
            return None;
        }
        let end = self.0.len();
        let first = self.0.iter().position(is_picture).unwrap_or(end);
        let last = self.0.iter().rposition(is_picture).map_or(end, |last| last + 1);
        let parts = [&self.0[..first], &self.0[first..last], &self.0[last..]];
        if parts[1].iter().any(|piece| piece.scope() == Scope::Model) {
            return None;
        }
        Some(parts.map(|pieces| text(pieces, fields)))
    }
}

impl Piece {
    fn scope(&self) -> Scope {
        match self {
            Self::Text(_) => Scope::Batch,
            Self::Field(field, _) => FIELDS[*field].scope,
        }
    }
}

/// Returns the text of pieces.
fn text(pieces: &[Piece], fields: &Fields<'_>) -> String {
    let value = |piece: &Piece| match piece {
        Piece::Text(text) => text.clone(),
        Piece::Field(field, width) => (FIELDS[*field].value)(fields, *width),
    };
    pieces.iter().map(value).collect()
}

fn field(text: &str) -> Result<Piece, String> {
    let (name, format) = text.split_once(':').map_or((text, None), |(a, b)| (a, Some(b)));
    let Some(place) = FIELDS.iter().position(|field| field.name == name) else {
        let names: Vec<String> = FIELDS.iter().map(|field| format!("{{{}}}", field.name)).collect();
        return Err(format!("there is no field {{{name}}}; the fields are {}", names.join(", ")));
    };
    let Some(format) = format else { return Ok(Piece::Field(place, 0)) };
    let is_number = FIELDS[place].is_number;
    let width = format.parse().ok().filter(|width| *width <= MOST_WIDTH && is_number);
    let width = width.ok_or_else(|| {
        format!("{{{text}}}: only index and view have a width, such as {{index:06}}")
    })?;
    Ok(Piece::Field(place, width))
}

/// Returns the name of a model without folders.
fn name(file: &Path) -> String {
    file.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Returns the name of a model without extension; `.obj.gz` is one extension.
pub(super) fn stem(file: &Path) -> String {
    values::stem(file).to_string_lossy().into_owned()
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
    fn a_template_shows_the_number_of_a_picture_only_between_marks() {
        for (template, shows) in [
            ("{index:06}.png", true),
            ("out/{stem}/{index}.{ext}", true),
            ("{index}-{stem}-{view}.png", true),
            ("out/{stem}-{index}.png", true),
            ("{stem}{index}.png", false),
            ("{index}{view}.png", false),
            ("{index}1.png", true),
            ("{stem}1{index}.png", false),
            ("{stem}-{index}-{view}.png", false),
            ("{stem}-{view:03}.png", false),
        ] {
            assert_eq!(Template::parse(template).unwrap().shows_index(), shows, "{template}");
        }
        for (template, fixes) in
            [("{stem}.png", true), ("{stem}.{ext}", true), ("{stem}", false), ("a.b/{name}", false)]
        {
            assert_eq!(Template::parse(template).unwrap().fixes_extension(), fixes, "{template}");
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
