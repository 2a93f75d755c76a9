//! Pictures of a data set for training, validation and testing.

use serde_json::{Map, Value, json};

/// The parts of a data set, by the names of their files: `transforms_train.json` and so on.
pub(super) const PARTS: [&str; 3] = ["train", "val", "test"];

/// How many pictures the parts get, in proportion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Split([u32; 3]);

impl Split {
    /// Returns the parts that get pictures.
    pub(crate) fn parts(self) -> impl Iterator<Item = &'static str> {
        PARTS.into_iter().zip(self.0).filter(|(_, weight)| *weight > 0).map(|(name, _)| name)
    }

    /// Iterates over the parts of all pictures in their order. The parts of any number of first
    /// pictures differ from their proportions by less than one picture, so each part has pictures
    /// from everywhere.
    pub(super) fn of_pictures(self) -> impl Iterator<Item = &'static str> {
        let weights = self.0.map(i64::from);
        let all: i64 = weights.iter().sum();
        let mut owed = [0; 3];
        std::iter::repeat_with(move || {
            for (owed, weight) in owed.iter_mut().zip(weights) {
                *owed += weight;
            }
            // The earlier part of those that are owed most.
            let next = (0..PARTS.len()).rev().max_by_key(|i| owed[*i]).unwrap_or(0);
            owed[next] -= all;
            PARTS[next]
        })
    }
}

/// Parses shares: "80,10,10", or "0.8,0.1,0.1".
pub(crate) fn split(text: &str) -> Result<Split, String> {
    let wrong = || "three shares of at least 0, for train, val and test: \"80,10,10\"".to_owned();
    let shares: Option<Vec<f64>> = text.split(',').map(|share| share.trim().parse().ok()).collect();
    let shares =
        <[f64; 3]>::try_from(shares.unwrap_or_default()).map_err(|_other_count| wrong())?;
    let sum: f64 = shares.iter().sum();
    let is_right = shares.iter().all(|share| *share >= 0.0) && sum > 0.0 && sum.is_finite();
    if !is_right {
        return Err(wrong());
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to a million")]
    let weight = |share: f64| (share / sum * 1e6).round() as u32;
    Ok(Split(shares.map(weight)))
}

/// Returns the entry of a picture in the files of the parts, which have the layout of NeRF's
/// synthetic scenes: the path has no extension, and all pictures share `camera_angle_x`.
pub(super) fn entry(full: &Map<String, Value>) -> Value {
    let path = full.get("file_path").and_then(Value::as_str).unwrap_or_default();
    let path = path.rsplit_once('.').map_or(path, |(stem, _)| stem);
    json!({ "file_path": path, "transform_matrix": full.get("transform_matrix") })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(text: &str, pictures: usize) -> [usize; 3] {
        let parts: Vec<_> = split(text).unwrap().of_pictures().take(pictures).collect();
        PARTS.map(|part| parts.iter().filter(|own| **own == part).count())
    }

    #[test]
    fn parts_have_their_shares_from_the_first_pictures_on() {
        assert_eq!(counts("80,10,10", 100), [80, 10, 10]);
        assert_eq!(counts("0.8, 0.1, 0.1", 10), [8, 1, 1]);
        assert_eq!(counts("1,1,1", 3), [1; 3]);
        assert_eq!(counts("7,0,1", 8), [7, 0, 1]);
        assert_eq!(counts("1,0,0", 5), [5, 0, 0]);
        for pictures in 0..200 {
            let got = counts("70,20,10", pictures);
            for (count, share) in got.into_iter().zip([0.7, 0.2, 0.1]) {
                assert!(
                    (count as f64 - share * pictures as f64).abs() < 1.0,
                    "{pictures}: {got:?}"
                );
            }
        }
    }

    #[test]
    fn shares_are_three_numbers_of_at_least_0() {
        for wrong in ["", "80,10", "80,10,10,0", "a,b,c", "0,0,0", "-1,1,1", "nan,1,1", "inf,1,1"] {
            assert!(split(wrong).is_err(), "{wrong}");
        }
        let parts: Vec<_> = split("9,0,1").unwrap().parts().collect();
        assert_eq!(parts, ["train", "test"]);
    }
}
