//! The polygons of a level, cell by cell.
//!
//! In: a [`Space`]. Out: for each cell its floor, its ceiling, and what stands on its edges: walls,
//! steps, lintels and panes, each seen from the cell's inside only. All are convex and plane; floors
//! and ceilings have the cell's outline, with the corners of neighbours that lie on it.

use glam::DVec3;
use smallvec::SmallVec;

use super::border::{Border, level, upright};
use crate::cells::{CellId, EdgeId};
use crate::trace::space::{Chamber, Space, Surface, WALL};

/// A polygon of a level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polygon {
    /// What it is.
    pub surface: Surface,
    /// Lowest z.
    pub bottom: f64,
    /// Highest z.
    pub top: f64,
}

/// All polygons of a level.
#[derive(Clone, Debug)]
pub struct Polygons {
    list: Vec<Polygon>,
    /// Where those of each cell start, and, last, their number.
    first: Vec<u32>,
    /// Of each cell, how many triangles its polygons make.
    triangles: Vec<u32>,
}

impl Polygons {
    /// Those of a space. Floors and ceilings infinitely far away are none.
    pub fn of(space: &Space) -> Self {
        let (mut list, mut first, mut triangles) = (Vec::new(), vec![0], Vec::new());
        for (cell, id) in space.cells.iter().zip(0..) {
            let start = list.len();
            // A door that stands closed has no inside.
            if cell.floor < cell.ceiling {
                in_cell(space, cell, CellId(id), &mut list);
            }
            let n: usize = list[start..].iter().map(|p| p.n_triangles(space)).sum();
            triangles.push(n as u32);
            first.push(list.len() as u32);
        }
        Self {
            list,
            first,
            triangles,
        }
    }

    /// Those of a cell. None of them hides any of the others from an eye before them.
    #[inline]
    pub fn in_cell(&self, cell: CellId) -> &[Polygon] {
        let cell = cell.0 as usize;
        &self.list[self.first[cell] as usize..self.first[cell + 1] as usize]
    }

    /// Number of the first polygon of a cell, in [`Polygons::iter`].
    #[inline]
    pub fn first_in(&self, cell: CellId) -> u32 {
        self.first[cell.0 as usize]
    }

    /// The polygon of that number.
    #[inline]
    pub fn get(&self, number: u32) -> &Polygon {
        &self.list[number as usize]
    }

    /// All, cell after cell.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &Polygon> {
        self.list.iter()
    }

    /// Number of triangles of a cell's polygons: two for a wall, as many as corners for a floor.
    pub fn triangles_in(&self, cell: CellId) -> u32 {
        self.triangles[cell.0 as usize]
    }
}

fn in_cell(space: &Space, cell: &Chamber, id: CellId, list: &mut Vec<Polygon>) {
    let flat = |surface, z: f64| Polygon {
        surface,
        bottom: z,
        top: z,
    };
    if cell.floor.is_finite() {
        list.push(flat(Surface::Floor(id), cell.floor));
    }
    if cell.ceiling.is_finite() {
        list.push(flat(Surface::Ceiling(id), cell.ceiling));
    }
    for e in cell.first..cell.past {
        let (edge, id) = (space.edge(e), EdgeId(e));
        let mut add = |surface, bottom: f64, top: f64| {
            if bottom < top {
                list.push(Polygon {
                    surface,
                    bottom,
                    top,
                });
            }
        };
        let (floor, ceiling) = (cell.floor, cell.ceiling);
        let (bottom, top) = (edge.bottom.max(floor), edge.top.min(ceiling));
        if edge.twin == WALL {
            if edge.outside && bottom < top {
                add(Surface::Wall(id), floor, bottom);
                add(Surface::Outside(id), bottom, top);
                add(Surface::Wall(id), top, ceiling);
            } else {
                add(Surface::Wall(id), floor, ceiling);
            }
            continue;
        }
        // An opening that is shut is all step, as rays have it.
        if bottom >= top {
            add(Surface::Step(id), floor, bottom.min(ceiling));
            add(Surface::Lintel(id), bottom.min(ceiling), ceiling);
            continue;
        }
        add(Surface::Step(id), floor, bottom);
        add(Surface::Lintel(id), top, ceiling);
        if edge.pane.is_some() {
            add(Surface::Pane(id), bottom, top);
        }
    }
}

impl Polygon {
    /// Positive for an eye on the side of the plane from which it is seen, and the more so the farther
    /// from the plane the eye is.
    #[inline]
    pub fn before(&self, space: &Space, eye: DVec3) -> f64 {
        match self.surface {
            Surface::Floor(_) => eye.z - self.bottom,
            Surface::Ceiling(_) => self.top - eye.z,
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let edge = space.edge(e.0);
                let o = eye.truncate();
                (space.vertex(edge.from) - o).perp_dot(space.vertex(edge.to) - o)
            }
        }
    }

    /// Its borders as seen from an eye before it.
    pub fn borders(&self, space: &Space, eye: DVec3, borders: &mut SmallVec<[Border; 12]>) {
        borders.clear();
        match self.surface {
            Surface::Floor(c) | Surface::Ceiling(c) => {
                let cell = space.cell(c.0);
                let is_floor = matches!(self.surface, Surface::Floor(_));
                borders.extend((cell.first..cell.past).map(|e| {
                    let edge = space.edge(e);
                    let ends = [edge.from, edge.to];
                    let (normal, turned) = level(space, eye, ends, self.bottom);
                    // Rays to the floor pass below its border, as seen from inside the cell.
                    Border {
                        normal,
                        positive: is_floor == turned,
                    }
                }));
            }
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let edge = space.edge(e.0);
                let ends = [edge.from, edge.to];
                for (vertex, positive) in [(edge.from, false), (edge.to, true)] {
                    borders.push(Border {
                        normal: upright(space, eye, vertex),
                        positive,
                    });
                }
                for (z, above) in [(self.bottom, true), (self.top, false)] {
                    if z.is_finite() {
                        let (normal, turned) = level(space, eye, ends, z);
                        borders.push(Border {
                            normal,
                            positive: above != turned,
                        });
                    }
                }
            }
        }
    }

    /// Its corners, counterclockwise as seen from before it; those on a straight side included.
    pub fn corners(&self, space: &Space, corners: &mut SmallVec<[DVec3; 12]>) {
        corners.clear();
        let at = |v: u32, z: f64| space.vertex(v).extend(z);
        match self.surface {
            Surface::Floor(c) | Surface::Ceiling(c) => {
                let cell = space.cell(c.0);
                let edges = cell.first..cell.past;
                corners.extend(edges.map(|e| at(space.edge(e).from, self.bottom)));
                if matches!(self.surface, Surface::Ceiling(_)) {
                    corners.reverse();
                }
            }
            Surface::Wall(e)
            | Surface::Step(e)
            | Surface::Lintel(e)
            | Surface::Pane(e)
            | Surface::Outside(e) => {
                let edge = space.edge(e.0);
                let (from, to) = (edge.from, edge.to);
                corners.extend([
                    at(from, self.top),
                    at(to, self.top),
                    at(to, self.bottom),
                    at(from, self.bottom),
                ]);
            }
        }
    }

    /// How many triangles a graphics card would be given: a floor is fanned out from its middle, so
    /// that corners of neighbours on its border leave no gaps.
    pub fn n_triangles(&self, space: &Space) -> usize {
        match self.surface {
            Surface::Floor(c) | Surface::Ceiling(c) => {
                let cell = space.cell(c.0);
                (cell.past - cell.first) as usize
            }
            _ => 2,
        }
    }

    /// Its triangles, counterclockwise as seen from before it.
    pub fn triangles(&self, space: &Space) -> Vec<[DVec3; 3]> {
        let mut corners = SmallVec::new();
        self.corners(space, &mut corners);
        let n = corners.len();
        match self.surface {
            Surface::Floor(_) | Surface::Ceiling(_) => {
                let middle = corners.iter().sum::<DVec3>() / n as f64;
                let pairs = (0..n).map(|i| [corners[i], corners[(i + 1) % n], middle]);
                pairs.collect()
            }
            _ => vec![
                [corners[0], corners[1], corners[2]],
                [corners[0], corners[2], corners[3]],
            ],
        }
    }
}
