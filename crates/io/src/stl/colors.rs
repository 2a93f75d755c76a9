//! The colours of facets in binary STL files.
//!
//! STL has no colours, but two programs store them in the last two bytes of a facet, with five bits
//! per channel:
//!
//! - Materialise Magics writes `COLOR=` and the colour of the body, red first, in the header. A
//!   facet with bit 15 clear has its own colour, with red in the lowest bits.
//! - VisCAM and SolidView write no header. A facet with bit 15 set has a colour, with blue in the
//!   lowest bits.

/// Red, green and blue.
pub(super) type Rgb = [u8; 3];

/// The statement before the colour of the body.
const BODY: &[u8] = b"COLOR=";

/// Returns the colour of each facet, from the header and the last two bytes of all facets; an empty
/// list if no facet has a colour.
pub(super) fn colors(header: &[u8], facets: &[u16]) -> Vec<Option<Rgb>> {
    let colors: Vec<Option<Rgb>> = match body_color(header) {
        // Programs that know only the header leave the facets 0, which is not meant as black.
        Some(body) if facets.iter().all(|facet| *facet == 0) => vec![Some(body); facets.len()],
        Some(body) => {
            let own = |facet: &u16| if facet >> 15 == 0 { channels(*facet) } else { body };
            facets.iter().map(|facet| Some(own(facet))).collect()
        }
        None => facets.iter().map(|facet| (facet >> 15 == 1).then(|| reversed(*facet))).collect(),
    };
    if colors.iter().any(Option::is_some) { colors } else { Vec::new() }
}

/// Returns the colour of the body that a header of Magics states.
fn body_color(header: &[u8]) -> Option<Rgb> {
    let at = header.windows(BODY.len()).position(|window| window == BODY)?;
    header.get(at + BODY.len()..)?.first_chunk().copied()
}

/// Returns the channels of a facet, from the lowest bits on.
fn channels(facet: u16) -> Rgb {
    [0, 5, 10].map(|shift| {
        let level = facet >> shift & 31;
        // 31 levels to 255, rounded.
        u8::try_from((level * 255 + 15) / 31).unwrap_or(u8::MAX)
    })
}

/// Returns the channels of a facet, from the highest bits on.
fn reversed(facet: u16) -> Rgb {
    let [blue, green, red] = channels(facet);
    [red, green, blue]
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: Rgb = [255, 0, 0];
    const BLUE: Rgb = [0, 0, 255];

    fn header(text: &[u8]) -> [u8; 80] {
        let mut header = [b' '; 80];
        header[..text.len()].copy_from_slice(text);
        header
    }

    #[test]
    fn facets_of_magics_have_red_lowest_or_the_colour_of_the_body() {
        let header = header(b"part COLOR=\xFF\x80\x00\xFF,MATERIAL=");
        let body = Some([255, 128, 0]);
        assert_eq!(
            colors(&header, &[31, 0x7C00, 0x8000, 0]),
            [Some(RED), Some(BLUE), body, Some([0; 3])]
        );
        assert_eq!(colors(&header, &[0, 0]), [body; 2], "no facet has a colour of its own");
    }

    #[test]
    fn facets_of_viscam_have_blue_lowest_and_others_have_no_colour() {
        let plain = header(b"");
        assert_eq!(colors(&plain, &[0x801F, 0xFC00, 0x1F]), [Some(BLUE), Some(RED), None]);
        assert_eq!(colors(&plain, &[0x1F, 0]), []);
        assert_eq!(colors(&header(b"COLOR"), &[0x1F]), []);
    }

    #[test]
    fn five_bits_become_eight() {
        let level = |level: u16| channels(level)[0];
        assert_eq!([0, 1, 16, 30, 31].map(level), [0, 8, 132, 247, 255]);
    }
}
