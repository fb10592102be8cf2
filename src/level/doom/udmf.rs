//! Text maps.
use super::defect::Tally;
use super::error::Problem;
use super::raw::RawMap;
use crate::level::wad::{Wad, WadMap};
use thiserror::Error;
/// A mistake in a text map, with its place.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("line {line}, column {column}: {problem}")]
pub struct TextError {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
    /// What is wrong.
    pub problem: TextProblem,
}
/// What is wrong with a text map.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TextProblem {
    /// Not yet.
    #[error("text maps cannot be read yet")]
    Unsupported,
}
/// Reads a text map.
pub fn read(_wad: &Wad, _map: &WadMap, _tally: &mut Tally) -> Result<RawMap, Problem> {
    Err(Problem::Text(TextError {
        line: 1,
        column: 1,
        problem: TextProblem::Unsupported,
    }))
}
