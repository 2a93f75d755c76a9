//! Records that wait in a file, because all of them together may not fit in memory.
//!
//! A table that is written in another order than its rows arrive keeps the rows here. The file is a
//! temporary one in the folder of the table, so the leftovers of killed processes are removed like
//! those of other files ([`super::part`]).

use std::fs::{self, File};
use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::error::reason;
use super::part::{self, create_part, sweep_once};
use super::replace::SaveError;

/// The name that temporary files are derived from.
const NAME: &str = "records";

/// A file of records, which is removed when this is dropped.
#[derive(Debug)]
pub struct Spool {
    path: PathBuf,
    file: BufWriter<File>,
    /// The number of bytes so far.
    end: u64,
}

impl Spool {
    /// Creates a file in a folder.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn begin(folder: &Path) -> Result<Self, SaveError> {
        let target = folder.join(NAME);
        sweep_once(part::folder(&target));
        let created = create_part(&target);
        let (file, path) = created.map_err(|error| SaveError::new(&target, reason(&error)))?;
        Ok(Self { path, file: BufWriter::new(file), end: 0 })
    }

    /// Appends a record, and returns its place.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn push(&mut self, record: &[u8]) -> Result<Range<u64>, SaveError> {
        let written = self.file.write_all(record);
        written.map_err(|error| SaveError::new(&self.path, reason(&error)))?;
        let begin = self.end;
        self.end += record.len() as u64;
        Ok(begin..self.end)
    }

    /// Reads a record again.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn get(&mut self, place: &Range<u64>) -> Result<Vec<u8>, SaveError> {
        let mut record = Vec::new();
        let read = self.read(place, &mut record);
        read.map_err(|error| SaveError::new(&self.path, reason(&error)))?;
        Ok(record)
    }

    fn read(&mut self, place: &Range<u64>, record: &mut Vec<u8>) -> std::io::Result<()> {
        self.file.flush()?;
        let file = self.file.get_mut();
        file.seek(SeekFrom::Start(place.start))?;
        Read::by_ref(file).take(place.end - place.start).read_to_end(record)?;
        file.seek(SeekFrom::Start(self.end))?;
        Ok(())
    }
}

impl Drop for Spool {
    fn drop(&mut self) {
        // If this fails, a later run removes the file.
        let _ = fs::remove_file(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_are_read_in_any_order_between_writes_and_leave_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let mut spool = Spool::begin(folder.path()).unwrap();
        let first = spool.push(b"first").unwrap();
        let empty = spool.push(b"").unwrap();
        assert_eq!(spool.get(&first).unwrap(), b"first");
        let last = spool.push(b"last").unwrap();
        assert_eq!(spool.get(&last).unwrap(), b"last");
        assert_eq!(spool.get(&empty).unwrap(), b"");
        assert_eq!(spool.get(&first).unwrap(), b"first");
        drop(spool);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
