//! Directions from which models are seen, by name or in degrees.

/// The named directions, in degrees to the right of the front, and up. `iso` shows all three axes
/// of the world equally long: its elevation is atan(1/sqrt(2)).
pub const DIRECTIONS: [(&str, [f64; 2]); 7] = [
    ("front", [0.0, 0.0]),
    ("right", [90.0, 0.0]),
    ("back", [180.0, 0.0]),
    ("left", [-90.0, 0.0]),
    ("top", [0.0, 90.0]),
    ("bottom", [0.0, -90.0]),
    ("iso", [45.0, 35.264_389_682_754_654]),
];

/// Parses a direction: one of the names, or degrees to the right and degrees up, as `30,15`.
///
/// # Errors
/// The reason, if it is neither.
pub fn direction(text: &str) -> Result<[f64; 2], String> {
    if let Some((_, named)) = DIRECTIONS.iter().find(|(name, _)| *name == text) {
        return Ok(*named);
    }
    let (right, up) = text.split_once(',').unwrap_or((text, "0"));
    let degrees = |text: &str| text.trim().parse().ok().filter(|degrees: &f64| degrees.is_finite());
    match (degrees(right), degrees(up)) {
        (Some(right), Some(up)) if up.abs() <= 90.0 => Ok([right, up]),
        _ => {
            let names = DIRECTIONS.map(|(name, _)| name).join(", ");
            Err(format!(
                "write degrees to the right and degrees up, -90 to 90, as 30,15; or one of {names}"
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_names_or_degrees() {
        assert_eq!(direction("right"), Ok([90.0, 0.0]));
        assert_eq!(direction("145, -20"), Ok([145.0, -20.0]));
        assert_eq!(direction("-30"), Ok([-30.0, 0.0]));
        for wrong in ["", "frontal", "a,b", "1,2,3", "0,91", "0,NaN", "inf,0"] {
            assert!(direction(wrong).is_err(), "{wrong}");
        }
    }
}
