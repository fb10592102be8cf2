//! The text of a level file: from byte offsets to lines and columns, and from the parser's errors
//! to ours.

use std::ops::Range;

use serde::de::DeserializeOwned;

use super::super::finding::Place;
use super::error::{TomlError, probably_meant};

/// A text with the start of each of its lines.
pub(super) struct SourceText<'a> {
    text: &'a str,
    line_starts: Vec<usize>,
}

impl<'a> SourceText<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        let after_newlines = text.match_indices('\n').map(|(i, _)| i + 1);
        SourceText {
            text,
            line_starts: std::iter::once(0).chain(after_newlines).collect(),
        }
    }

    /// Line and column (in characters, both from 1) of the start of a span of bytes.
    pub(super) fn place(&self, span: Range<usize>) -> Place {
        let offset = span.start.min(self.text.len());
        let line = self.line_starts.partition_point(|&start| start <= offset);
        let before = self.text.get(self.line_starts[line - 1]..offset);
        let column = before.map_or(0, |s| s.chars().count()) + 1;
        Place::Text {
            line: u32::try_from(line).unwrap_or(u32::MAX),
            column: u32::try_from(column).unwrap_or(u32::MAX),
        }
    }

    /// The tables of the text.
    pub(super) fn parse<T: DeserializeOwned>(&self) -> Result<T, TomlError> {
        toml::from_str(self.text).map_err(|e| self.parse_error(&e))
    }

    /// The error of the parser, with a suggestion where a key is unknown.
    fn parse_error(&self, error: &toml::de::Error) -> TomlError {
        let place = self.place(error.span().unwrap_or(0..0));
        let message = error.message().to_string();
        // serde says: unknown field `celing`, expected one of `name`, `ceiling`
        let Some((unknown, expected)) = message
            .strip_prefix("unknown field `")
            .and_then(|rest| rest.split_once('`'))
        else {
            return TomlError::Parse { place, message };
        };
        let allowed: Vec<&str> = expected.split('`').skip(1).step_by(2).collect();
        TomlError::UnknownKey {
            place,
            key: unknown.to_string(),
            suggestion: probably_meant(unknown, allowed.iter().copied()),
            allowed: allowed.join(", "),
        }
    }
}
