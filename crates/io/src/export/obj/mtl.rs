//! The materials of an exported OBJ file: MTL and textures.

use std::fmt::Write;

use crate::export::SIGNATURE;
use crate::export::look::{Look, Looks, Pictures};
use marraztu_core::scene::{MapKind, Texture, Wrap};

/// Writes the textures and the MTL file. Their names begin with `stem`.
pub(super) fn written(stem: &str, looks: &Looks) -> Result<Vec<(String, Vec<u8>)>, String> {
    let mut mtl = String::from(SIGNATURE);
    let mut pictures = Pictures::default();
    for look in &looks.all {
        coefficients(&mut mtl, look);
        let mut map = |statement: &str, texture: &Texture| {
            let file = texture_name(stem, pictures.number(&texture.picture));
            map_to(&mut mtl, statement, texture, &file);
        };
        if let Some(texture) = &look.texture {
            map("map_Kd", texture);
        }
        for (kind, of) in &look.maps {
            match kind {
                MapKind::Bump if of.gain != 1.0 => {
                    map(&format!("bump -bm {}", of.gain), &of.texture);
                }
                kind => map(kind.statement(), &of.texture),
            }
            // Blender and others read normal maps only from this statement.
            if *kind == MapKind::Normal && look.map(MapKind::Bump).is_none() {
                map("map_Bump -bm 1", &of.texture);
            }
        }
    }
    let mut files = Vec::new();
    for (i, bytes) in pictures.encoded()?.into_iter().enumerate() {
        files.push((texture_name(stem, i), bytes));
    }
    files.push((format!("{stem}.mtl"), mtl.into_bytes()));
    Ok(files)
}

/// Returns the file name of a picture by its index.
fn texture_name(stem: &str, number: usize) -> String {
    format!("{stem}-texture-{}.png", number + 1)
}

fn coefficients(mtl: &mut String, look: &Look) {
    let material = &look.material;
    let _ = match &*look.name {
        "" => writeln!(mtl, "\nnewmtl"),
        name => writeln!(mtl, "\nnewmtl {name}"),
    };
    let colors = [("Ka", material.ambient), ("Kd", material.diffuse), ("Ks", material.specular)];
    for (word, [r, g, b]) in colors {
        let _ = writeln!(mtl, "{word} {r} {g} {b}");
    }
    let _ = writeln!(mtl, "Ns {}\nd {}", material.exponent, look.opacity);
    // Readers take a map without a colour for full light.
    if material.emission != [0.0; 3] || look.map(MapKind::Emission).is_some() {
        let [r, g, b] = material.emission;
        let _ = writeln!(mtl, "Ke {r} {g} {b}");
    }
    // Statements that this program does not draw pass through unchanged.
    for (word, numbers) in look.undrawn.iter().filter(|(word, _)| **word != "illum") {
        mtl.push_str(word);
        for number in numbers {
            let _ = write!(mtl, " {number}");
        }
        mtl.push('\n');
    }
    let illumination = if look.unlit { 0.0 } else { look.undrawn("illum").unwrap_or(2.0) };
    let _ = writeln!(mtl, "illum {illumination}");
}

/// Writes a map statement with the layout and the file of its picture.
fn map_to(mtl: &mut String, statement: &str, texture: &Texture, file: &str) {
    mtl.push_str(statement);
    if texture.wrap == Wrap::Clamp {
        mtl.push_str(" -clamp on");
    }
    if texture.offset != [0.0; 2] {
        let _ = write!(mtl, " -o {} {} 0", texture.offset[0], texture.offset[1]);
    }
    if texture.scale != [1.0; 2] {
        let _ = write!(mtl, " -s {} {} 1", texture.scale[0], texture.scale[1]);
    }
    let _ = writeln!(mtl, " {file}");
}
