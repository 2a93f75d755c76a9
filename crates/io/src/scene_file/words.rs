//! Words errors in a scene file for the user.
//!
//! The parser's errors refer to its own types and to Rust. Here each becomes a sentence about the
//! file.

use ron::Error;

/// The most names that are listed.
const MOST_NAMES: usize = 12;

/// The most characters of an external message.
const MOST_SIGNS: usize = 200;

/// Words a parser error as a sentence.
pub(super) fn sentence(error: &Error) -> String {
    if let Some(sign) = missing_sign(error) {
        return format!("{sign} is missing here");
    }
    if let Some(thing) = missing_value(error) {
        return format!("{thing} is missing here");
    }
    if let Some(sentence) = about_a_name(error) {
        return sentence;
    }
    match error {
        Error::Eof => "the file ends too early: a bracket is not closed".to_owned(),
        Error::InvalidEscape(_) => "this text has an invalid escape after \"\\\"".to_owned(),
        Error::IntegerOutOfBounds => "this number is too large or too small here".to_owned(),
        Error::InvalidIntegerDigit { digit, .. } => {
            format!("'{}' cannot be part of a number", digit.escape_default())
        }
        Error::FloatUnderscore | Error::UnderscoreAtBeginning => {
            "a number cannot have a \"_\" here".to_owned()
        }
        Error::UnclosedBlockComment | Error::UnclosedLineComment => {
            "a comment is not closed".to_owned()
        }
        Error::UnexpectedChar(sign) => format!("'{}' cannot be here", sign.escape_default()),
        Error::TrailingCharacters => "there is more text after the scene".to_owned(),
        Error::ExceededRecursionLimit => "brackets are nested too deeply".to_owned(),
        Error::Utf8Error(_) => "this is not UTF-8".to_owned(),
        Error::NoSuchExtension(name) => format!("there is no extension \"{}\"", short(name)),
        Error::InvalidValueForType { expected, found } => {
            format!("{} is expected here, but {} was found", plain(expected), plain(found))
        }
        Error::ExpectedDifferentLength { expected, found } => {
            format!("{} is expected here, but {found} were found", plain(expected))
        }
        Error::Message(text) | Error::Io(text) => text.chars().take(MOST_SIGNS).collect(),
        // Scene files cannot cause the other errors.
        _ => "this cannot be parsed".to_owned(),
    }
}

/// Returns the token that was expected, if the error is about one.
const fn missing_sign(error: &Error) -> Option<&'static str> {
    Some(match error {
        Error::ExpectedArray => "\"[\"",
        Error::ExpectedArrayEnd => "\"]\" or \",\"",
        Error::ExpectedMap => "\"{\"",
        Error::ExpectedMapColon => "\":\"",
        Error::ExpectedMapEnd => "\"}\"",
        Error::ExpectedComma => "\",\"",
        Error::ExpectedStructLike | Error::ExpectedNamedStructLike(_) => "\"(\"",
        Error::ExpectedStructLikeEnd | Error::ExpectedOptionEnd => "\")\" or \",\"",
        Error::ExpectedAttribute => "\"#![enable(...)]\"",
        Error::ExpectedAttributeEnd => "\")]\"",
        Error::ExpectedStringEnd => "the quotation mark after a text",
        Error::ExpectedRangeSyntax => "\"..\"",
        _ => return None,
    })
}

/// Returns the kind of value that was expected, if the error is about one.
const fn missing_value(error: &Error) -> Option<&'static str> {
    Some(match error {
        Error::ExpectedBoolean => "true or false",
        Error::ExpectedFloat => "a number",
        Error::ExpectedInteger => "a whole number",
        Error::ExpectedOption => "Some(...) or None",
        Error::ExpectedString => "a text in quotation marks",
        Error::ExpectedChar => "a character in single quotation marks",
        Error::ExpectedByteLiteral | Error::ExpectedByteString => "a text of bytes",
        Error::ExpectedIdentifier | Error::ExpectedStructName(_) => "a name",
        Error::ExpectedUnit => "()",
        Error::ExpectedRawValue => "a value",
        _ => return None,
    })
}

/// Describes an error about a name.
fn about_a_name(error: &Error) -> Option<String> {
    Some(match error {
        Error::MissingStructField { field: "version", outer } if is(outer.as_deref(), "Head") => {
            "this is not a scene file: it has no version".to_owned()
        }
        Error::MissingStructField { field, outer } => {
            format!("{} has no \"{field}\"", thing(outer.as_deref()))
        }
        Error::DuplicateStructField { field, outer } => {
            format!("{} has \"{field}\" twice", thing(outer.as_deref()))
        }
        Error::NoSuchStructField { expected, found, outer } => {
            let thing = thing(outer.as_deref());
            format!("{thing} cannot have \"{}\"{}", short(found), listed("; it has", expected))
        }
        Error::NoSuchEnumVariant { expected, found, .. } => {
            format!("\"{}\" cannot be here{}", short(found), listed("; use", expected))
        }
        Error::ExpectedDifferentStructName { found, .. } => {
            format!("\"{}\" cannot be here", short(found))
        }
        Error::InvalidIdentifier(name) | Error::SuggestRawIdentifier(name) => {
            format!("\"{}\" is not a name", short(name))
        }
        _ => return None,
    })
}

fn is(outer: Option<&str>, name: &str) -> bool {
    outer == Some(name)
}

/// Returns the item that a type of the file represents.
fn thing(outer: Option<&str>) -> &str {
    match outer.unwrap_or_default() {
        "Head" | "FileScene" => "the scene",
        "FileObject" => "the object",
        "FileCamera" => "the camera",
        "FileLight" => "the light",
        "FileView" => "the view",
        "FileTexture" => "the texture",
        "Spin" => "the spin",
        "Orbit" | "Bulb" => "the bulb",
        "FileLocked" => "the list of locked items",
        "FilePolygons" => "the list of polygons",
        "File" => "the model's file",
        "Sun" => "the sun",
        "Spot" | "Fixed" => "the spot",
        "Settings" => "the list of settings",
        "Lens" => "the lens",
        "Attenuation" => "the attenuation",
        "Steps" => "the list of steps",
        "Panels" => "the list of panels",
        "Material" => "the material",
        _ => "this part",
    }
}

/// Formats choices as "; use A, B or C"; nothing if there are too many.
fn listed(lead: &str, names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [only] => format!("{lead} {only}"),
        [first @ .., last] if names.len() <= MOST_NAMES => {
            format!("{lead} {} or {last}", first.join(", "))
        }
        _ => String::new(),
    }
}

/// Converts a description of a Rust value to the terms of the file.
fn plain(value: &str) -> String {
    let is_rust = |name: &str| value.split(' ').any(|word| word == name);
    let known = match value {
        "u8" => "a whole number from 0 to 255",
        "u16" | "u32" | "u64" | "usize" | "i8" | "i16" | "i32" | "i64" => "a whole number",
        "f32" | "f64" => "a number",
        "a boolean" => "true or false",
        "a string" | "a borrowed string" => "a text in quotation marks",
        "option" => "Some(...) or None",
        "unit" | "the unit value" => "()",
        _ if is_rust("struct") || is_rust("tuple") || is_rust("sequence") => "a list in brackets",
        _ if is_rust("array") => "a list with the right number of values",
        _ if is_rust("enum") || is_rust("variant") || is_rust("identifier") => "a name",
        _ => return short(&value.replace("floating point", "number").replace("integer", "number")),
    };
    known.to_owned()
}

/// Shortens a text from the file.
fn short(text: &str) -> String {
    crate::obj::lines::excerpt(text.as_bytes())
}
