//! Archives of pictures for WebDataset: `--out "shards/{shard:06}.tar"`.
//!
//! Archive k has the pictures k N to (k + 1) N - 1 of the whole list, in its order, so its bytes do
//! not depend on threads, on the processes that share the archives, or on resuming. Pictures finish
//! in any order and wait until their archive is complete.
//!
//! A picture and its description are neighbours with one key: `000000012.color.png`,
//! `000000012.depth.npy`, `000000012.json`. WebDataset takes the name up to the first dot as the
//! key: <https://github.com/webdataset/webdataset>. Headers are those of POSIX.1-1988 (ustar),
//! without times and owners.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use marraztu_io::{self as io, SaveError, Spool};

use super::jobs::Job;
use super::report::begin;
use crate::cli::failure::Failure;

/// The unit of an archive, in bytes.
const BLOCK: usize = 512;

/// The place of the format's name in a header, and the name.
const MAGIC: (usize, &[u8]) = (257, b"ustar");

/// The most bytes of pictures that wait in memory; more of them wait in a file.
const MOST_WAITING: usize = 256 << 20;

/// The most earlier archives whose members are known at a time.
const MOST_KNOWN: usize = 16;

/// The names of archives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TarNames {
    before: String,
    /// The least number of digits.
    width: usize,
    after: String,
    /// The number of pictures in an archive.
    per_tar: usize,
}

impl TarNames {
    /// Returns whether a template names archives.
    pub(super) fn are_in(template: &str) -> bool {
        Path::new(template).extension().is_some_and(|ending| ending.eq_ignore_ascii_case("tar"))
    }

    /// Parses a template with the field {shard}, such as "shards/{shard:06}.tar". Fails with the
    /// reason if there is another field, or none.
    pub(super) fn parse(template: &str, per_tar: usize) -> Result<Self, String> {
        let wrong = || {
            "the name of an archive has the field {shard} once, such as {shard:06}.tar, and no \
             other one"
                .to_owned()
        };
        let (before, rest) = template.split_once("{shard").ok_or_else(wrong)?;
        let (format, after) = rest.split_once('}').ok_or_else(wrong)?;
        let width = match format.strip_prefix(':') {
            Some(digits) => digits.parse().ok().filter(|width| *width <= 20),
            None => Some(0).filter(|_| format.is_empty()),
        };
        if [before, after].iter().any(|text| text.contains(['{', '}'])) {
            return Err(wrong());
        }
        let width = width.ok_or_else(wrong)?;
        Ok(Self { before: before.to_owned(), width, after: after.to_owned(), per_tar })
    }

    /// Returns the number of pictures in an archive.
    pub(super) const fn per_tar(&self) -> usize {
        self.per_tar
    }

    /// Returns the file of an archive.
    fn path(&self, number: usize) -> PathBuf {
        let Self { before, width, after, .. } = self;
        PathBuf::from(format!("{before}{number:0width$}{after}"))
    }

    /// Returns the file of a picture in its archive, as if that were a folder. `field` is the end
    /// of its name, such as "depth.npy".
    pub(super) fn member(&self, index: usize, field: &str) -> PathBuf {
        self.path(index / self.per_tar).join(format!("{index:09}.{field}"))
    }

    /// Checks that the archives of these pictures replace no other files.
    pub(super) fn check(&self, pictures: impl Iterator<Item = usize>) -> Result<(), Failure> {
        let mut last = None;
        for number in pictures.map(|index| index / self.per_tar) {
            if last.replace(number) != Some(number) {
                let path = self.path(number);
                io::check_scheme(&path)?;
                if path.exists() && !is_archive(&path) {
                    return Err(Failure::Usage(format!(
                        "{}: a file with this name exists and is not an archive; choose another \
                         name",
                        path.display()
                    )));
                }
            }
        }
        Ok(())
    }
}

/// Returns whether a file is an archive, or empty.
fn is_archive(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(BLOCK as u64).read_to_end(&mut head));
    let (at, magic) = MAGIC;
    read.is_ok() && (head.is_empty() || head.get(at..).is_some_and(|end| end.starts_with(magic)))
}

/// A file in an archive.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Member {
    /// The path as [`TarNames::member`] returns it.
    pub(super) path: PathBuf,
    pub(super) content: Content,
}

/// The content of a member.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Content {
    /// The bytes.
    New(Vec<u8>),
    /// Its place in the file of waiting pictures.
    Waiting(Range<u64>),
    /// Its place in the archive of an earlier run.
    Earlier(Range<u64>),
}

/// An archive of an earlier run.
#[derive(Debug)]
struct EarlierTar {
    /// Its file, which is not kept open: some systems replace no open files.
    path: PathBuf,
    /// The places of the contents, by name.
    members: BTreeMap<String, Range<u64>>,
}

impl EarlierTar {
    /// Reads the headers of an archive. One that is cut off has the members before its end.
    fn read_headers(path: &Path) -> Option<Self> {
        let file = File::open(path).ok()?;
        let length = file.metadata().ok()?.len();
        let mut archive = tar::Archive::new(&file);
        let mut members = BTreeMap::new();
        for entry in archive.entries_with_seek().ok()? {
            let Ok(entry) = entry else { break };
            let begin = entry.raw_file_position();
            let place = begin..begin.checked_add(entry.size())?;
            if place.end > length {
                break;
            }
            members.insert(entry.path().ok()?.to_str()?.to_owned(), place);
        }
        Some(Self { path: path.to_owned(), members })
    }

    fn read(&self, place: &Range<u64>) -> std::io::Result<Vec<u8>> {
        let (mut file, mut content) = (File::open(&self.path)?, Vec::new());
        file.seek(SeekFrom::Start(place.start))?;
        file.take(place.end - place.start).read_to_end(&mut content)?;
        Ok(content)
    }
}

/// The archives of an earlier run.
#[derive(Debug)]
pub(super) struct EarlierTars {
    names: Arc<TarNames>,
    /// The last ones that were read, by number; `None` for one that does not exist.
    known: Mutex<BTreeMap<usize, Option<Arc<EarlierTar>>>>,
}

impl EarlierTars {
    pub(super) fn new(names: Arc<TarNames>) -> Self {
        Self { names, known: Mutex::default() }
    }

    fn get(&self, number: usize) -> Option<Arc<EarlierTar>> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if !known.contains_key(&number) && known.len() >= MOST_KNOWN {
            // Archives are read in their order.
            known.pop_first();
        }
        let earlier = || EarlierTar::read_headers(&self.names.path(number)).map(Arc::new);
        known.entry(number).or_insert_with(earlier).clone()
    }

    /// Returns the place of a file of a picture, and its content. `None` if it is not there.
    pub(super) fn member(&self, job: &Job, path: &Path) -> Option<(Range<u64>, Vec<u8>)> {
        let earlier = self.get(job.index / self.names.per_tar)?;
        let place = earlier.members.get(path.file_name()?.to_str()?)?;
        Some((place.clone(), earlier.read(place).ok()?))
    }
}

/// An archive that is not complete.
#[derive(Debug)]
struct OpenTar {
    /// The number of pictures without a result.
    left: usize,
    /// The members by the number of their picture.
    members: BTreeMap<usize, Vec<Member>>,
}

/// Writes archives.
#[derive(Debug)]
pub(super) struct Tars {
    names: Arc<TarNames>,
    /// The number of pictures in the whole list.
    pictures: usize,
    open: BTreeMap<usize, OpenTar>,
    earlier: Arc<EarlierTars>,
    /// The bytes that wait in memory.
    waiting: usize,
    /// The file for more of them, and the number of contents in it that are not written yet.
    spool: Option<Spool>,
    spooled: usize,
}

impl Tars {
    pub(super) const fn new(
        names: Arc<TarNames>,
        pictures: usize,
        earlier: Arc<EarlierTars>,
    ) -> Self {
        let open = BTreeMap::new();
        Self { names, pictures, open, earlier, waiting: 0, spool: None, spooled: 0 }
    }

    /// Adds the members of a picture: none if it cannot be drawn. Writes its archive if it is
    /// complete. Fails if a file cannot be written.
    pub(super) fn add(&mut self, index: usize, mut members: Vec<Member>) -> Result<(), SaveError> {
        let per_tar = self.names.per_tar;
        let number = index / per_tar;
        for member in &mut members {
            self.keep(number, &mut member.content)?;
        }
        let left = per_tar.min(self.pictures - number * per_tar);
        let new = || OpenTar { left, members: BTreeMap::new() };
        let open = self.open.entry(number).or_insert_with(new);
        open.left -= 1;
        open.members.insert(index, members);
        match open.left {
            0 => self.write(number),
            _ => Ok(()),
        }
    }

    /// Moves a content to a file, if those that wait take much memory.
    fn keep(&mut self, number: usize, content: &mut Content) -> Result<(), SaveError> {
        let Content::New(bytes) = content else { return Ok(()) };
        self.waiting += bytes.len();
        if self.waiting <= MOST_WAITING {
            return Ok(());
        }
        self.waiting -= bytes.len();
        let spool = match self.spool.take() {
            Some(spool) => spool,
            None => Spool::begin(&created_folder(&self.names.path(number)))?,
        };
        *content = Content::Waiting(self.spool.insert(spool).push(bytes)?);
        self.spooled += 1;
        Ok(())
    }

    /// Writes an archive, unless the earlier one is the same.
    fn write(&mut self, number: usize) -> Result<(), SaveError> {
        let Some(open) = self.open.remove(&number) else { return Ok(()) };
        let members: Vec<Member> = open.members.into_values().flatten().collect();
        let is_earlier = |member: &Member| matches!(member.content, Content::Earlier(_));
        let has_earlier = members.iter().any(is_earlier);
        let earlier = if has_earlier { self.earlier.get(number) } else { None };
        let count = earlier.as_ref().map(|earlier| earlier.members.len());
        if members.iter().all(is_earlier) && count == Some(members.len()) {
            return Ok(());
        }
        let path = self.names.path(number);
        let fail = |error: &dyn std::fmt::Display| SaveError {
            file: path.display().to_string(),
            reason: error.to_string(),
        };
        let mut file = begin(&path)?;
        for Member { path: name, content } in members {
            let bytes = match content {
                Content::New(bytes) => {
                    self.waiting -= bytes.len();
                    bytes
                }
                Content::Waiting(place) => {
                    self.spooled -= 1;
                    let spool = self.spool.as_mut().expect("the file that it was moved to");
                    spool.get(&place)?
                }
                Content::Earlier(place) => {
                    let earlier = earlier.as_ref().expect("the archive that it was found in");
                    earlier.read(&place).map_err(|error| fail(&error))?
                }
            };
            file.push(header(&name, bytes.len()).map_err(|error| fail(&error))?.as_bytes())?;
            file.push(&bytes)?;
            file.push(&[0; BLOCK][..member_size(bytes.len()) - BLOCK - bytes.len()])?;
        }
        if self.spooled == 0 {
            self.spool = None;
        }
        // An archive ends with two blocks of zeros.
        file.push(&[0; 2 * BLOCK])?;
        file.finish()
    }

    /// Writes the archives that are not complete, because the batch ends early.
    pub(super) fn finish(mut self) -> Result<(), SaveError> {
        while let Some(number) = self.open.keys().next().copied() {
            self.write(number)?;
        }
        Ok(())
    }
}

/// Returns the bytes that a content of this size takes in an archive: a header, and whole blocks.
pub(super) const fn member_size(content: usize) -> usize {
    BLOCK + content.next_multiple_of(BLOCK)
}

/// Returns the header of a member, which is the same on all systems.
fn header(path: &Path, size: usize) -> std::io::Result<tar::Header> {
    let mut header = tar::Header::new_ustar();
    header.set_path(path.file_name().unwrap_or_default())?;
    header.set_size(size as u64);
    header.set_mode(0o644);
    header.set_mtime(0);
    header.set_cksum();
    Ok(header)
}

/// Creates the folder of a file, and returns it.
fn created_folder(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    // If this fails, so does creating a file in it, with the reason.
    let _ = std::fs::create_dir_all(folder);
    folder.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(template: &str) -> Arc<TarNames> {
        Arc::new(TarNames::parse(template, 3).unwrap())
    }

    #[test]
    fn a_name_has_the_number_of_the_archive_and_nothing_else() {
        let member = |template: &str| names(template).member(7, "depth.npy");
        assert_eq!(member("s/{shard:04}.tar"), Path::new("s/0002.tar/000000007.depth.npy"));
        assert_eq!(member("{shard}-x.TAR"), Path::new("2-x.TAR/000000007.depth.npy"));
        for wrong in [
            "a.tar",
            "{shard",
            "{shard}{shard}.tar",
            "{shard}-{stem}.tar",
            "{shard:x}.tar",
            "{shards}.tar",
        ] {
            assert!(TarNames::parse(wrong, 3).unwrap_err().contains("{shard} once"), "{wrong}");
        }
        assert!(TarNames::are_in("a/{shard}.TAR") && !TarNames::are_in("{shard}.tar/{stem}.png"));
    }

    #[test]
    fn an_archive_has_its_members_in_the_order_of_the_list_whatever_the_order_of_results() {
        let written = |order: [usize; 5]| {
            let folder = tempfile::tempdir().unwrap();
            let template = format!("{}/new/{{shard}}.tar", folder.path().display());
            let names = names(&template);
            let earlier = Arc::new(EarlierTars::new(Arc::clone(&names)));
            let mut tars = Tars::new(Arc::clone(&names), 5, earlier);
            for index in order {
                let member = |field: &str| Member {
                    path: names.member(index, field),
                    content: Content::New(vec![7; 500 + 10 * index]),
                };
                tars.add(index, vec![member("png"), member("json")]).unwrap();
            }
            assert_eq!((tars.open.len(), tars.waiting), (0, 0));
            tars.finish().unwrap();
            [0, 1].map(|number| {
                let path = names.path(number);
                let tar = EarlierTar::read_headers(&path).unwrap();
                let found: Vec<String> = tar.members.keys().cloned().collect();
                assert_eq!(found.len(), if number == 0 { 6 } else { 4 });
                let (name, place) = tar.members.last_key_value().unwrap();
                assert_eq!(tar.read(place).unwrap(), vec![7; 520 + 20 * number]);
                assert_eq!(name, ["000000002.png", "000000004.png"][number]);
                std::fs::read(path).unwrap()
            })
        };
        assert!(written([0, 1, 2, 3, 4]) == written([4, 2, 0, 3, 1]));
    }
}
