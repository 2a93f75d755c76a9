//! The materials of an exported OBJ file: MTL and textures.

use std::collections::BTreeSet;
use std::fmt::Write;

use crate::error::short_name;
use crate::export::Content;
use crate::export::file_bytes::Encoded;
use crate::export::look::Looks;
use crate::export::part_look::Look;
use crate::export::pictures::Pictures;
use crate::mark::SIGNATURE;
use marraztu_core::scene::{MapKind, Texture, Transmission, Wrap};

/// Writes the textures and the MTL file. Their names begin with `stem`.
pub(super) fn written(stem: &str, looks: &Looks) -> Result<Content, String> {
    // The extension of a picture is known when it is encoded, so all pictures come first.
    let mut pictures = Pictures::default();
    for look in &looks.all {
        statements(look, &mut pictures, &mut |_, _| {});
    }
    let mut content = Content::default();
    let (mut names, mut reasons) = (Vec::new(), Vec::new());
    for (i, encoded) in pictures.encoded()?.into_iter().enumerate() {
        let (name, reason) = match encoded {
            Ok(Encoded { bytes, ending }) => {
                let name = format!("{stem}-texture-{}.{ending}", i + 1);
                content.files.push((name.clone(), bytes));
                (Some(name), None)
            }
            Err(reason) => (None, Some(reason)),
        };
        names.push(name);
        reasons.push(reason);
    }
    let mut mtl = String::from(SIGNATURE);
    for look in &looks.all {
        coefficients(&mut mtl, look);
        statements(look, &mut pictures, &mut |statement, number| {
            if let Some(name) = &names[number] {
                let _ = writeln!(mtl, "{statement} {name}");
            }
        });
    }
    content.notes = left_out(looks, &mut pictures, &reasons);
    content.files.push((format!("{stem}.mtl"), mtl.into_bytes()));
    Ok(content)
}

/// Passes on each map statement of a look, without its file, and the index of its picture.
fn statements(look: &Look, pictures: &mut Pictures, pass: &mut dyn FnMut(&str, usize)) {
    let mut map = |keyword: &str, texture: &Texture| {
        let number = pictures.number(texture);
        pass(&format!("{keyword}{}", options(texture)), number);
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
    // Statements that this program does not draw keep their options.
    for map in &look.undrawn_maps {
        let number = pictures.number_of_file(&map.source);
        let [keyword, options] = map.words();
        pass(format!("{keyword} {options}").trim_end(), number);
    }
}

/// Notes the maps with files that cannot be copied, by the reasons of each picture.
fn left_out(looks: &Looks, pictures: &mut Pictures, reasons: &[Option<String>]) -> Vec<String> {
    let mut notes = BTreeSet::new();
    for map in looks.all.iter().flat_map(|look| &look.undrawn_maps) {
        if let Some(reason) = &reasons[pictures.number_of_file(&map.source)] {
            let name = short_name(&map.source);
            notes.insert(format!("{} {name} is left out: {reason}", map.keyword));
        }
    }
    notes.into_iter().collect()
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
    let optics = &material.optics;
    if !optics.is_none() {
        let _ = writeln!(mtl, "Ni {}", optics.index);
        if let Transmission::Filter([r, g, b]) = optics.transmission {
            let _ = writeln!(mtl, "Tf {r} {g} {b}");
        }
    }
    // Statements that this program does not draw pass through unchanged.
    let is_written = |word: &str| match word {
        "illum" => true,
        "Ni" | "Tf" | "Kt" => !optics.is_none(),
        _ => false,
    };
    for (word, numbers) in look.undrawn.iter().filter(|(word, _)| !is_written(word)) {
        mtl.push_str(word);
        for number in numbers {
            let _ = write!(mtl, " {number}");
        }
        mtl.push('\n');
    }
    let illumination = match look.undrawn("illum") {
        _ if look.unlit => 0.0,
        Some(given) => given,
        None => optics.illumination(),
    };
    let _ = writeln!(mtl, "illum {illumination}");
}

/// Returns the options of a map statement, each after a blank.
fn options(texture: &Texture) -> String {
    let mut options = String::new();
    if texture.wrap == Wrap::Clamp {
        options.push_str(" -clamp on");
    }
    if texture.offset != [0.0; 2] {
        let _ = write!(options, " -o {} {} 0", texture.offset[0], texture.offset[1]);
    }
    if texture.scale != [1.0; 2] {
        let _ = write!(options, " -s {} {} 1", texture.scale[0], texture.scale[1]);
    }
    options
}
