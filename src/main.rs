//! Arguments: the editor, or a headless command.

fn main() {}
