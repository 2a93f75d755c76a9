//! Recognises files that are no OBJ files, for a helpful message.

use crate::error::LFS_POINTER;
use crate::read;

/// The error for a file without content.
pub(super) const EMPTY: &str = "the file is empty";

/// Returns the reason why a text with these first bytes cannot be an OBJ file. `whole` means that
/// they are the whole text.
pub(super) fn no_obj(bytes: &[u8], whole: bool) -> Option<String> {
    // Signatures of formats that users confuse with OBJ, for a helpful message.
    let known = [
        (&b"glTF"[..], "a glTF file"),
        (b"PK\x03\x04", "a ZIP archive; unpack it first"),
        (b"\x1F\x8B", "a gzip archive; unpack it first"),
        (b"Kaydara FBX", "an FBX file"),
        (b"BLENDER", "a Blender file; export it as OBJ"),
        (b"\x89PNG", "a PNG picture"),
        (b"\xFF\xD8\xFF", "a JPEG picture"),
        (b"ply\n", "a PLY file"),
        (b"ply\r\n", "a PLY file"),
        (b"solid ", "an STL file"),
        (b"OFF\n", "an OFF file"),
    ];
    if whole && bytes.trim_ascii().is_empty() {
        return Some(EMPTY.to_owned());
    }
    if read::is_lfs_pointer(bytes) {
        return Some(LFS_POINTER.to_owned());
    }
    for (begin, what) in known {
        if bytes.starts_with(begin) {
            return Some(format!("this is not an OBJ file but {what}"));
        }
    }
    read::is_binary(&bytes[..bytes.len().min(4096)])
        .then(|| "this is not an OBJ file: it is not text".into())
}
