//! Fuzzes OBJ files: any bytes are read or refused, and a mesh that is read is consistent. The
//! first byte selects the options of reading.

#![no_main]

use libfuzzer_sys::fuzz_target;
use marraztu_io::{Progress, describe, parse};
use marraztu_core::scene::{Crease, LoadOptions, Scale, UpAxis, Winding};

fuzz_target!(|data: &[u8]| {
    let Some((options, text)) = data.split_first() else { return };
    let options = LoadOptions {
        up: if options & 1 == 0 { UpAxis::Y } else { UpAxis::Z },
        winding: if options & 2 == 0 { Winding::Kept } else { Winding::Turned },
        scale: Scale::new(if options & 4 == 0 { 1.0 } else { 1e30 }).expect("above 0"),
        crease: Crease::new(if options & 8 == 0 { 60.0 } else { 180.0 }).expect("within range"),
    };
    let Ok(loaded) = parse(text, "a.obj", None, &options, &Progress::new()) else { return };
    assert!(describe(&loaded).starts_with("name"));
    let mesh = &loaded.model.mesh;
    let corners = mesh.corners().len();
    assert_eq!(mesh.triangles().len() + 2 * mesh.polygon_count(), corners);
    for edge in mesh.edges() {
        assert!(!mesh.edge_polygons(edge).is_empty());
    }
});
