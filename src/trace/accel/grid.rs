//! The uniform grid.
//!
//! In: boxes of primitives. Out: equal cells in a three-dimensional array, each listing the primitives
//! whose enlarged boxes ([`super::margin`]) touch it. Two walks: [`classical`] intersects the ray with
//! the faces of each cell, [`amanatides`] adds up steps.

mod amanatides;
mod classical;

use glam::{DVec3, USizeVec3};

use super::Walk;
use super::bounds::Bounds;
use super::brute::all;
use super::cast::Cast;
use super::count::Count;
use super::mailbox::Mailbox;
use super::margin::Margin;
use super::primitives::Primitives;
use super::search::Search;

/// Cells per primitive, roughly.
const DENSITY: f64 = 4.0;

/// Cells in a row, at most: the bound on [`amanatides`]' rounding depends on it.
const LONGEST_ROW: usize = 128;

/// How the next cell is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GridWalk {
    /// By the face of the cell through which the ray leaves.
    Classical,
    /// Amanatides and Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987.
    AmanatidesWoo,
}

/// A uniform grid.
#[derive(Clone, Debug)]
pub struct Grid {
    margin: Margin,
    walk: GridWalk,
    /// Cells along each axis.
    n: USizeVec3,
    /// Sides of a cell.
    cell: DVec3,
    /// Where the list of each cell begins; one more at the end.
    starts: Vec<u32>,
    list: Vec<u32>,
    len: u32,
}

impl Grid {
    /// Builds it.
    pub fn new<P: Primitives>(primitives: &P, walk: GridWalk) -> Self {
        let margin = Margin::new(primitives);
        let boxes = margin.boxes(primitives);
        let n = resolution(&margin.root, boxes.len());
        let cell = margin.root.size() / n.as_dvec3();
        let mut grid = Self {
            margin,
            walk,
            n,
            cell,
            starts: Vec::new(),
            list: Vec::new(),
            len: boxes.len() as u32,
        };
        (grid.starts, grid.list) = grid.fill(&boxes);
        grid
    }

    /// Counts, then lists, the primitives of each cell.
    fn fill(&self, boxes: &[Bounds]) -> (Vec<u32>, Vec<u32>) {
        let mut starts = vec![0; self.n.element_product() + 1];
        for b in boxes {
            self.for_cells(b, |cell| starts[cell + 1] += 1);
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut list = vec![0; starts.last().map_or(0, |&end| end as usize)];
        for (primitive, b) in (0..).zip(boxes) {
            self.for_cells(b, |cell| {
                list[next[cell] as usize] = primitive;
                next[cell] += 1;
            });
        }
        (starts, list)
    }

    /// The cells that the box touches. One cell too many on a side does no harm: what rounding may
    /// do to an index is far less than the margin, so none is missing.
    fn for_cells(&self, b: &Bounds, mut visit: impl FnMut(usize)) {
        let (from, to) = (self.index(b.min), self.index(b.max));
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                for x in from.x..=to.x {
                    visit(self.number(USizeVec3::new(x, y, z)));
                }
            }
        }
    }

    /// The cell in which the point lies, or the nearest.
    fn index(&self, p: DVec3) -> USizeVec3 {
        let at = (p - self.margin.root.min) / self.cell;
        // From f64 to usize: below 0 gives 0.
        at.as_usizevec3().min(self.n - 1)
    }

    fn number(&self, cell: USizeVec3) -> usize {
        (cell.z * self.n.y + cell.y) * self.n.x + cell.x
    }

    /// The coordinate of the plane before cell i of a row.
    fn plane(&self, axis: usize, i: usize) -> f64 {
        self.margin.root.min[axis] + self.cell[axis] * i as f64
    }

    /// The cell in which the ray begins, and when it enters the grid; none if it does not.
    fn enter<S: Search>(&self, cast: &Cast, search: &S) -> Option<(USizeVec3, f64)> {
        let (near, far) = self.margin.interval(cast);
        (near <= far && near <= search.limit()).then(|| (self.index(cast.ray.at(near)), near))
    }

    /// Tests what lies in a cell. Returns whether the search is over.
    fn visit<S: Search, C: Count>(
        &self,
        cell: USizeVec3,
        mailbox: &mut Mailbox,
        search: &mut S,
        count: &mut C,
    ) -> bool {
        count.cell();
        let number = self.number(cell);
        let range = self.starts[number] as usize..self.starts[number + 1] as usize;
        self.list[range]
            .iter()
            .any(|&primitive| mailbox.is_new(primitive) && search.test(primitive, count))
    }

    /// The cell after `cell` along the axis; none if the ray leaves the grid.
    fn step(&self, mut cell: USizeVec3, axis: usize, forward: bool) -> Option<USizeVec3> {
        cell[axis] = if forward {
            cell[axis] + 1
        } else {
            cell[axis].checked_sub(1)?
        };
        (cell[axis] < self.n[axis]).then_some(cell)
    }
}

/// Cells along each axis: as cubic as possible.
fn resolution(root: &Bounds, len: usize) -> USizeVec3 {
    if root.is_empty() {
        return USizeVec3::ONE;
    }
    let size = root.size();
    // A flat scene has a thickness, be it that of the margin: no row gets more than its share.
    let size = size.max(DVec3::splat(size.max_element() / LONGEST_ROW as f64));
    let per_length = (DENSITY * len as f64 / size.element_product()).cbrt();
    let row = |length: f64| ((length * per_length) as usize).clamp(1, LONGEST_ROW);
    USizeVec3::new(row(size.x), row(size.y), row(size.z))
}

impl Walk for Grid {
    fn walk<S: Search, C: Count>(&self, cast: &Cast, _: f64, search: &mut S, count: &mut C) {
        if !self.margin.covers(cast) {
            all(self.len, search, count);
            return;
        }
        match self.walk {
            GridWalk::Classical => classical::walk(self, cast, search, count),
            GridWalk::AmanatidesWoo => amanatides::walk(self, cast, search, count),
        }
    }

    fn bytes(&self) -> usize {
        size_of::<Self>() + (self.starts.capacity() + self.list.capacity()) * size_of::<u32>()
    }

    /// Every primitive is listed once in every cell that its box touches.
    fn validate<P: Primitives>(&self, primitives: &P) -> Result<(), String> {
        let boxes: Vec<Bounds> = (0..primitives.len() as u32)
            .map(|i| primitives.bounds(i))
            .collect();
        for z in 0..self.n.z {
            for y in 0..self.n.y {
                for x in 0..self.n.x {
                    let number = self.number(USizeVec3::new(x, y, z));
                    let low = [x, y, z];
                    let corner = |more: usize| {
                        let plane = |axis: usize| self.plane(axis, low[axis] + more);
                        DVec3::new(plane(0), plane(1), plane(2))
                    };
                    let cell = Bounds {
                        min: corner(0),
                        max: corner(1),
                    };
                    let range = self.starts[number] as usize..self.starts[number + 1] as usize;
                    let listed = &self.list[range];
                    super::check_leaf(&cell, listed, &boxes)?;
                }
            }
        }
        super::check_root(&self.margin.root, &boxes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_cubes_where_they_can_be() {
        let root = Bounds::around([DVec3::ZERO, DVec3::new(40.0, 20.0, 10.0)]);
        // 8000 units³ and 1000 primitives: a cell of 2 units³.
        assert_eq!(
            resolution(&root, 1000),
            USizeVec3::new(31, 15, 7),
            "40, 20, 10 over the cube root of 2"
        );
        let flat = Bounds::around([DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)]);
        let n = resolution(&flat, 1000);
        assert!(n.x == n.y && n.x > 50 && n.z == 1, "{n}");
        assert_eq!(resolution(&Bounds::EMPTY, 0), USizeVec3::ONE);
    }
}
