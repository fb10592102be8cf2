//! Why a file is not accepted as a `.pvs` file.

use thiserror::Error;

use crate::cells::{self, PartsError};
use crate::pvs;

/// Why bytes are not accepted as a `.pvs` file. Messages do not name the file: the caller knows it.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FileError {
    /// Does not begin as a `.pvs` file does.
    #[error("this is no .pvs file of enfilade: it begins with '{found}'")]
    Foreign {
        /// Its first bytes, escaped.
        found: String,
    },
    /// Made by a later version of this program.
    #[error(
        "the file has layout version {found}, this program reads version {known}; build the file \
         again or use a newer enfilade"
    )]
    Version {
        /// The file's version.
        found: u32,
        /// The version that this program reads.
        known: u32,
    },
    /// Shorter than it should be.
    #[error("the file is cut off: {size} of {expected} bytes are there")]
    CutOff {
        /// Bytes that are there.
        size: usize,
        /// Bytes that there should be (at least).
        expected: u64,
    },
    /// Longer than it should be.
    #[error("the file should end after {expected} bytes, but has {size}")]
    TooLong {
        /// Bytes that are there.
        size: usize,
        /// Bytes that there should be.
        expected: u64,
    },
    /// Bytes have changed since it was written.
    #[error(
        "the file is damaged: its checksum is {found:08x}, its bytes have {computed:08x}; fetch or \
         build it again"
    )]
    Checksum {
        /// What the file says.
        found: u32,
        /// What its bytes have.
        computed: u32,
    },
    /// A section reaches past the end, or holds another amount than it says, or is missing.
    #[error("section '{tag}' {what}")]
    Section {
        /// Its tag, escaped.
        tag: String,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A number or name in a section has no meaning.
    #[error("{part} {index} of section '{tag}' {what}")]
    Value {
        /// The section's tag.
        tag: &'static str,
        /// What it is: "vertex", "string".
        part: &'static str,
        /// Its number.
        index: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// A name that this program does not know.
    #[error("the file names the {what} '{name}', which this program does not know")]
    Unknown {
        /// What is named: "method".
        what: &'static str,
        /// The name.
        name: String,
    },
    /// Indices contradict each other.
    #[error("the file contradicts itself: {0}")]
    Parts(#[from] PartsError),
    /// The cells do not fit together.
    #[error("the file's cells do not fit together: {0}")]
    Cells(cells::Flaw),
    /// The visible sets cannot be right.
    #[error("the file's visible sets cannot be right: {0}")]
    Visible(pvs::Flaw),
}
