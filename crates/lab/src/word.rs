//! Texts of the program that come back from another instance of it.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Deserializer};

/// A text of the program.
pub type Word = &'static str;

/// Reads a text of the program. It is kept forever, once.
pub(crate) fn read<'de, D: Deserializer<'de>>(text: D) -> Result<Word, D::Error> {
    static KEPT: Mutex<BTreeSet<Word>> = Mutex::new(BTreeSet::new());
    let text = String::deserialize(text)?;
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(word) = kept.get(&*text) {
        return Ok(word);
    }
    let word: Word = text.leak();
    kept.insert(word);
    Ok(word)
}
