//! Formats numbers and file names.

use std::path::Path;

/// Formats a number with commas between thousands.
pub(crate) fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Counts things: "1 face", "1,202 vertices".
pub(crate) fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{} {}", grouped(count), if count == 1 { one } else { many })
}

/// Returns the last part of a path.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Names one thing, or counts several: "cow.obj", "3 models".
pub(crate) fn one_or_count<T>(all: &[T], kind: &str, name: impl Fn(&T) -> String) -> String {
    match all {
        [one] => name(one),
        _ => format!("{} {kind}", all.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thing_is_counted_in_the_singular() {
        let text = [0, 1, 2, 1_202].map(|count| counted(count, "vertex", "vertices"));
        assert_eq!(text, ["0 vertices", "1 vertex", "2 vertices", "1,202 vertices"]);
    }

    #[test]
    fn thousands_are_told_apart() {
        let text = [0, 12, 999, 1_000, 1_234_567].map(grouped);
        assert_eq!(text, ["0", "12", "999", "1,000", "1,234,567"]);
    }
}
