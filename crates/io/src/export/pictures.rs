//! The distinct pictures of an export, shared among textures.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::file_bytes::{self, Encoded};
use crate::mark::MARK;
use crate::picture::png_with_comment;
use marraztu_core::base::Shared;
use marraztu_core::base::image::Picture;
use marraztu_core::scene::Texture;

/// The distinct pictures of an export.
#[derive(Debug, Default)]
pub(super) struct Pictures {
    all: Vec<Entry>,
    by_address: HashMap<usize, usize>,
    by_source: HashMap<PathBuf, Vec<usize>>,
}

#[derive(Debug)]
struct Entry {
    source: PathBuf,
    /// The texels; `None` for a file that is not decoded.
    picture: Option<Shared<Picture>>,
}

impl Pictures {
    /// Returns the index of a texture's picture, adding it if it is new. Models that were read
    /// separately share the picture of a file.
    pub(super) fn number(&mut self, texture: &Texture) -> usize {
        let address = Shared::address(&texture.picture);
        if let Some(number) = self.by_address.get(&address) {
            return *number;
        }
        let picture = Some(texture.picture.clone());
        let known = self.by_source.get(&texture.source).into_iter().flatten().copied();
        let mut known = known.filter(|number| {
            let other = &self.all[*number].picture;
            other.is_none() || *other == picture
        });
        let number = match known.next() {
            Some(number) => number,
            None => self.add(&texture.source),
        };
        self.all[number].picture = picture;
        self.by_address.insert(address, number);
        number
    }

    /// Returns the index of a file that is copied without decoding it.
    pub(super) fn number_of_file(&mut self, source: &Path) -> usize {
        let known = self.by_source.get(source).and_then(|numbers| numbers.first());
        known.copied().unwrap_or_else(|| self.add(source))
    }

    fn add(&mut self, source: &Path) -> usize {
        let number = self.all.len();
        self.all.push(Entry { source: source.to_owned(), picture: None });
        self.by_source.entry(source.to_owned()).or_default().push(number);
        number
    }

    /// Encodes the pictures, in the order of their indices. The outer error is a picture that
    /// cannot be encoded; the inner ones are files that cannot be copied, with the reason.
    pub(super) fn encoded(&self) -> Result<Vec<Result<Encoded, String>>, String> {
        let encoded = |Entry { source, picture }: &Entry| {
            let Some(picture) = picture else { return Ok(file_bytes::of_file(source)) };
            let kept = file_bytes::of_picture(source, picture).map(Ok);
            kept.map_or_else(|| encoded_again(picture).map(Ok), Ok)
        };
        self.all.par_iter().map(encoded).collect()
    }
}

fn encoded_again(picture: &Picture) -> Result<Encoded, String> {
    Ok(Encoded { bytes: png_with_comment(picture, MARK)?, ending: "png" })
}
