//! Reports in the format of JUnit, which servers for continuous integration show as tests.
//!
//! The elements and attributes are the ones that Jenkins and GitLab read:
//! <https://github.com/testmoapp/junitxml>. Times are left out, so a report depends on the pictures
//! alone.

use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;

use marraztu_io::{SaveError, Sources};

use super::pairs::Inputs;
use super::report::{Compared, Counts, Word};
use crate::cli::failure::{Failure, usage};

/// The first letters of a report.
const BEGIN: &str = "<?xml";

/// Checks that a report may be written to `path`: an existing file is in XML, or empty, and not an
/// input. Fails if it is another file.
pub(super) fn check(path: &Path, sources: &Sources) -> Result<(), Failure> {
    sources.spare(path)?;
    let mut begin = Vec::new();
    let Ok(file) = std::fs::File::open(path) else { return Ok(()) };
    let read = file.take(BEGIN.len() as u64).read_to_end(&mut begin);
    if read.is_ok() && (begin.is_empty() || begin == BEGIN.as_bytes()) {
        return Ok(());
    }
    let path = path.display();
    Err(usage(&format!(
        "{path}: a file with this name exists and is not a JUnit report; choose another name"
    )))
}

/// Writes a report. Fails if it cannot be written; an existing file is unchanged.
pub(super) fn write(
    path: &Path,
    results: &[Compared],
    inputs: &Inputs<'_>,
) -> Result<(), SaveError> {
    let mut file = crate::cli::batch::report::begin(path)?;
    file.push(text(results, inputs).as_bytes())?;
    file.finish()
}

/// Formats a report: a test for each pair. Pairs that cannot be compared are errors, all others
/// that are not the same are failures.
fn text(results: &[Compared], inputs: &Inputs<'_>) -> String {
    let Counts { pairs, differs, missing, extra, errors, .. } = Counts::of(results);
    let failures = differs + missing + extra;
    let counts = format!("tests=\"{pairs}\" failures=\"{failures}\" errors=\"{errors}\"");
    let suite = escaped(&format!("{} and {}", inputs.a.display(), inputs.b.display()));
    let mut text = format!(
        "{BEGIN} version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <testsuites name=\"marraztu compare\" {counts}>\n  \
         <testsuite name=\"{suite}\" {counts}>\n"
    );
    for result in results {
        let (folder, name) = result.pair.name.rsplit_once('/').unwrap_or((".", &result.pair.name));
        let [folder, name] = [folder, name].map(escaped);
        let element = match result.verdict.word() {
            Word::Same => None,
            Word::Differs | Word::Missing | Word::Extra => Some("failure"),
            Word::Error => Some("error"),
        };
        // Writing to a string cannot fail.
        let _ = write!(text, "    <testcase classname=\"{folder}\" name=\"{name}\"");
        let _ = match element {
            None => writeln!(text, "/>"),
            Some(element) => {
                let message = escaped(&result.verdict.sentence(inputs));
                writeln!(text, ">\n      <{element} message=\"{message}\"/>\n    </testcase>")
            }
        };
    }
    text + "  </testsuite>\n</testsuites>\n"
}

/// Escapes a text for an attribute. Characters that XML 1.0 cannot hold are replaced.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            // A reader turns unescaped ones into spaces.
            '\t' | '\n' | '\r' => _ = write!(escaped, "&#{};", u32::from(letter)),
            '\0'..' ' | '\u{FFFE}' | '\u{FFFF}' => escaped.push('\u{FFFD}'),
            _ => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::super::pairs::Pair;
    use super::super::report::Verdict;
    use super::*;

    #[test]
    fn names_are_escaped_so_that_any_of_them_is_an_attribute() {
        assert_eq!(escaped("a<b>&\"c'\u{e9}"), "a&lt;b&gt;&amp;&quot;c'\u{e9}");
        assert_eq!(escaped("\u{1b}[2J\n\t\u{FFFF}"), "\u{FFFD}[2J&#10;&#9;\u{FFFD}");
    }

    #[test]
    fn a_report_has_a_test_for_each_pair_and_counts_its_failures_and_errors() {
        let result = |name: &str, verdict| Compared {
            pair: Pair { name: name.to_owned(), files: [None, None], mask: None },
            verdict,
            picture: None,
        };
        let results = [
            result("cam.png", Verdict::Missing),
            result("deep/\"x\".png", Verdict::Error("damaged".to_owned())),
        ];
        let inputs = Inputs { a: Path::new("a"), b: Path::new("b"), mask: None };
        let expected = "\
<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<testsuites name=\"marraztu compare\" tests=\"2\" failures=\"1\" errors=\"1\">
  <testsuite name=\"a and b\" tests=\"2\" failures=\"1\" errors=\"1\">
    <testcase classname=\".\" name=\"cam.png\">
      <failure message=\"not in b\"/>
    </testcase>
    <testcase classname=\"deep\" name=\"&quot;x&quot;.png\">
      <error message=\"damaged\"/>
    </testcase>
  </testsuite>
</testsuites>
";
        assert_eq!(text(&results, &inputs), expected);
    }
}
