//! Names of rooms and materials: looked up with a suggestion where nothing is found.

use std::collections::HashMap;

use super::super::finding::Place;
use super::error::{TomlError, probably_meant};
use super::record::Name;
use super::source::SourceText;

/// Names of things of one kind, with index and place.
pub(super) struct Names {
    what: &'static str,
    index: HashMap<String, (usize, Place)>,
}

impl Names {
    /// Numbers the names from 0; an error where one occurs twice. `what` is "room", "material", …
    /// for errors.
    pub(super) fn of<'n>(
        source: &SourceText,
        what: &'static str,
        names: impl Iterator<Item = &'n Name>,
    ) -> Result<Self, TomlError> {
        let index = HashMap::new();
        let mut result = Names { what, index };
        for (i, name) in names.enumerate() {
            let place = source.place(name.span());
            let earlier = result.index.insert(name.get_ref().clone(), (i, place));
            if let Some((_, first)) = earlier {
                return Err(TomlError::DuplicateName {
                    place,
                    what,
                    name: name.get_ref().clone(),
                    first,
                });
            }
        }
        Ok(result)
    }

    /// The index of a name; an error, with a suggestion, where nothing has it.
    pub(super) fn find(&self, source: &SourceText, name: &Name) -> Result<usize, TomlError> {
        self.index
            .get(name.get_ref())
            .map(|(i, _)| *i)
            .ok_or_else(|| {
                // Sorted, so that the suggestion does not depend on the order of a hash map.
                let mut known: Vec<&str> = self.index.keys().map(String::as_str).collect();
                known.sort_unstable();
                TomlError::UnknownName {
                    place: source.place(name.span()),
                    what: self.what,
                    name: name.get_ref().clone(),
                    suggestion: probably_meant(name.get_ref(), known.into_iter()),
                }
            })
    }
}
