//! How a surface covers what is behind it: wholly, with holes, as a transparent one, or not at all.

use marraztu_core::accuracy::Transparency;
use marraztu_core::scene::{MapKind, Object, PartLook};

/// How a part of an object covers what is behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cover {
    /// Not at all: it is not drawn, for this reason.
    Nothing(&'static str),
    /// Wherever its texture, multiplied by this opacity, is at least one half.
    Threshold(f64),
    /// By this opacity, multiplied by the texture's alpha and the map of opacity.
    Transparent(f64),
}

impl Cover {
    /// The cover of a part.
    ///
    /// If all texels of a texture, or of a map of opacity, are wholly opaque or wholly transparent,
    /// it is a stencil: it cuts holes, as with [`Transparency::Threshold`], however its edges are
    /// filtered.
    pub(super) fn of(look: &PartLook<'_>, textured: bool, transparency: Transparency) -> Self {
        // NaN counts as opaque.
        let opacity = if look.opacity < 1.0 { look.opacity.max(0.0) } else { 1.0 };
        let texture = look.texture.filter(|_| textured);
        let map = look.map(MapKind::Opacity).filter(|_| textured);
        let fades = texture.is_some_and(|texture| texture.picture.has_partial_alpha())
            || map.is_some_and(|map| map.texture.picture.fades());
        match transparency {
            Transparency::Threshold if opacity < 0.5 => {
                Self::Nothing("its opacity is below one half")
            }
            Transparency::Threshold => Self::Threshold(opacity),
            Transparency::Weighted | Transparency::Objects | Transparency::Exact => {
                if opacity == 0.0 {
                    Self::Nothing("its opacity is 0")
                } else if opacity < 1.0 || fades {
                    Self::Transparent(opacity)
                } else {
                    Self::Threshold(opacity)
                }
            }
        }
    }

    /// Whether a part of an object that is shown is transparent.
    pub(super) fn is_any_transparent(object: &Object, transparency: Transparency) -> bool {
        let mesh = &object.model.mesh;
        let parts = u32::try_from(mesh.parts().len()).unwrap_or(u32::MAX);
        let textured = !mesh.uvs().is_empty();
        (0..parts).filter(|part| object.shows_part(*part)).any(|part| {
            let cover = Self::of(&object.part_look(part), textured, transparency);
            matches!(cover, Self::Transparent(_))
        })
    }
}
