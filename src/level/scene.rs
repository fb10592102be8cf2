//! What stands in a level besides its walls: materials, lights, objects, cameras, paths.
//! Read and checked with the level; used by `trace`, `preview` and `walk`.

/// Everything in a level that is not plan geometry. Empty where the source has none of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {}
