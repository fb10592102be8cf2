//! Counts the work of a query, where somebody asks.

/// Told of every step of a query. The unit type hears nothing and costs nothing.
pub trait Count {
    /// A node of a tree was looked at.
    fn node(&mut self);
    /// A cell that holds primitives (or none) was entered: a leaf, a cell of a grid.
    fn cell(&mut self);
    /// A primitive was tested.
    fn test(&mut self);
}

impl Count for () {
    #[inline]
    fn node(&mut self) {}
    #[inline]
    fn cell(&mut self) {}
    #[inline]
    fn test(&mut self) {}
}

/// What queries did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Nodes of trees whose volume was tested or that were passed on the way down.
    pub nodes: u64,
    /// Leaves, and cells of grids.
    pub cells: u64,
    /// Primitives tested, those in meshes included.
    pub tests: u64,
}

impl Count for Counters {
    #[inline]
    fn node(&mut self) {
        self.nodes += 1;
    }
    #[inline]
    fn cell(&mut self) {
        self.cells += 1;
    }
    #[inline]
    fn test(&mut self) {
        self.tests += 1;
    }
}

impl std::ops::AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.nodes += other.nodes;
        self.cells += other.cells;
        self.tests += other.tests;
    }
}
