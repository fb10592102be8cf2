//! The envelope: header, sections, checksum; and reading numbers from a section's content.

use std::io::Read;

use super::{FileError, HEADER, MAGIC, TRAILER, VERSION};

/// Bytes of a section before its data.
const SECTION: usize = 20;
/// zlib makes of n bytes at most this many times n (a run of 258 bytes takes 2 bits).
const MAX_RATIO: u64 = 1032;

/// A section's tag and content.
pub(super) type Section = ([u8; 4], Vec<u8>);

/// The sections of a file whose envelope is sound, still compressed.
pub(super) struct Sections<'a> {
    list: Vec<Stored<'a>>,
}

struct Stored<'a> {
    tag: [u8; 4],
    length: u64,
    data: &'a [u8],
}

impl<'a> Sections<'a> {
    /// Checks header, length and checksum, and finds the sections.
    pub fn split(bytes: &'a [u8]) -> Result<Self, FileError> {
        let size = bytes.len();
        let begin = &bytes[..size.min(MAGIC.len())];
        if begin != &MAGIC[..begin.len()] || begin.is_empty() {
            return Err(FileError::Foreign {
                found: begin.escape_ascii().to_string(),
            });
        }
        let least = (HEADER + TRAILER) as u64;
        let cut_off = |expected| FileError::CutOff { size, expected };
        let mut header = Reader {
            tag: "header",
            rest: &bytes[begin.len()..],
        };
        let version = header.u32().map_err(|_| cut_off(least))?;
        if version != VERSION {
            return Err(FileError::Version {
                found: version,
                known: VERSION,
            });
        }
        let n_sections = header.u32().map_err(|_| cut_off(least))?;
        let expected = header.u64().map_err(|_| cut_off(least))?;
        if expected > size as u64 || size < HEADER + TRAILER {
            return Err(cut_off(expected.max(least)));
        }
        if expected < size as u64 {
            return Err(FileError::TooLong { size, expected });
        }
        let (covered, trailer) = bytes.split_at(size - TRAILER);
        let found = Reader {
            tag: "trailer",
            rest: trailer,
        }
        .u32()?;
        let computed = crc32fast::hash(covered);
        if found != computed {
            return Err(FileError::Checksum { found, computed });
        }
        let mut rest = Reader {
            tag: "header",
            rest: &covered[HEADER..],
        };
        let mut list = Vec::new();
        for _ in 0..n_sections {
            list.push(Stored::next(&mut rest)?);
        }
        if !rest.rest.is_empty() {
            return Err(wrong(b"last", "is followed by bytes of no section"));
        }
        Ok(Self { list })
    }

    /// The content of the section with this tag, which must have `expected` bytes, or, where that
    /// is not known, at most `limit`.
    pub fn content(&self, tag: &'static str, expected: Expected) -> Result<Vec<u8>, FileError> {
        let of_tag = || self.list.iter().filter(|s| s.tag == tag.as_bytes());
        let stored = of_tag()
            .next()
            .ok_or_else(|| wrong(tag.as_bytes(), "is missing"))?;
        let fits = match expected {
            Expected::Exactly(n) => stored.length == n,
            Expected::AtMost(n) => stored.length <= n,
        };
        let what = if of_tag().count() > 1 {
            "is there more than once"
        } else if !fits {
            "has another length than the counts in section 'INFO' say"
        } else if stored.length / MAX_RATIO > stored.data.len() as u64 {
            "claims a length that its data cannot have"
        } else {
            return stored.inflate();
        };
        Err(wrong(tag.as_bytes(), what))
    }
}

/// How long a section should be.
pub(super) enum Expected {
    /// This many bytes.
    Exactly(u64),
    /// This many bytes or fewer.
    AtMost(u64),
}

impl<'a> Stored<'a> {
    fn next(rest: &mut Reader<'a>) -> Result<Self, FileError> {
        let past_end = |tag: &[u8]| wrong(tag, "reaches past the end of the file");
        if rest.rest.len() < SECTION {
            return Err(past_end(b"next"));
        }
        let tag: [u8; 4] = rest.array()?;
        let (length, stored) = (rest.u64()?, rest.u64()?);
        let stored = usize::try_from(stored).map_err(|_| past_end(&tag))?;
        let data = rest.take(stored).map_err(|_| past_end(&tag))?;
        Ok(Self { tag, length, data })
    }

    fn inflate(&self) -> Result<Vec<u8>, FileError> {
        let mut content = Vec::new();
        let mut decoder = flate2::read::ZlibDecoder::new(self.data);
        // One byte more than is said, to notice when there are more.
        let result = decoder
            .by_ref()
            .take(self.length.saturating_add(1))
            .read_to_end(&mut content);
        if result.is_err() {
            return Err(wrong(&self.tag, "is no proper zlib stream"));
        }
        if content.len() as u64 != self.length || decoder.total_in() != self.data.len() as u64 {
            return Err(wrong(
                &self.tag,
                "holds another amount of data than it says",
            ));
        }
        Ok(content)
    }
}

fn wrong(tag: &[u8], what: &'static str) -> FileError {
    FileError::Section {
        tag: tag.escape_ascii().to_string(),
        what,
    }
}

/// Takes numbers off the front of a section's content.
pub(super) struct Reader<'a> {
    /// The section's tag, for errors.
    pub tag: &'static str,
    /// What has not been read yet.
    pub rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub fn take(&mut self, n: usize) -> Result<&'a [u8], FileError> {
        let Some((taken, rest)) = self.rest.split_at_checked(n) else {
            return Err(wrong(self.tag.as_bytes(), "ends too early"));
        };
        self.rest = rest;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], FileError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    pub fn u32(&mut self) -> Result<u32, FileError> {
        self.array().map(u32::from_le_bytes)
    }

    /// A number that may be absent (`FFFFFFFF`).
    pub fn option(&mut self) -> Result<Option<u32>, FileError> {
        Ok(Some(self.u32()?).filter(|&n| n != u32::MAX))
    }

    pub fn i32(&mut self) -> Result<i32, FileError> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn u64(&mut self) -> Result<u64, FileError> {
        self.array().map(u64::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64, FileError> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn i128(&mut self) -> Result<i128, FileError> {
        self.array().map(i128::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, FileError> {
        self.array().map(f64::from_le_bytes)
    }

    /// Whether everything has been read.
    pub fn finish(&self) -> Result<(), FileError> {
        if self.rest.is_empty() {
            Ok(())
        } else {
            Err(wrong(self.tag.as_bytes(), "holds more than it should"))
        }
    }
}
