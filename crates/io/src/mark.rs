//! The marks of this program in files that it exports: it may replace them, and takes their values
//! as they are.

use super::obj::lines::unmarked;

/// The first line of exported text files. A companion file that begins with it was written by this
/// program and may be replaced.
pub(crate) const SIGNATURE: &str = "# exported by Marraztu\n";

/// Returns whether a text begins with the signature. Editors and Git may have changed its line ends
/// and added a byte-order mark.
pub(crate) fn is_signed(text: &[u8]) -> bool {
    let first = unmarked(text).split(|byte| matches!(byte, b'\n' | b'\r')).next();
    first == Some(SIGNATURE.trim_end().as_bytes())
}

/// The comment of exported textures, which may be replaced likewise.
pub(crate) const MARK: &str = "exported by Marraztu";

/// Percent-encodes a name for a URI: all but letters, digits, `-`, `_` and `.`.
pub(crate) fn escaped(name: &str) -> String {
    let byte = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => {
            char::from(byte).to_string()
        }
        _ => format!("%{byte:02X}"),
    };
    name.bytes().map(byte).collect()
}
