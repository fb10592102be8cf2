//! Cells that keep to a tree which another program made: the nodes of a Doom map.
//!
//! In: a [`Level`] and a [`Guide`], a tree of lines through grid points. Out: a [`CellGraph`] in which
//! every cell lies in one leaf of the tree, and the number of that leaf for each. What walls are left
//! inside of a leaf split it further, as in [`bsp`]: cells are convex and free of walls whatever the
//! tree is like.

use super::arrangement::arrange;
use super::partition::{self, Choose, GuideSplit, Guided};
use super::{CellGraph, Cost, Options, bsp, finish, mesh};
use crate::geom::{GridPoint, Line};
use crate::level::Level;

/// Part of the plan, as a guide has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Below {
    /// One of the splits that [`Guide::new`] was given, by its index.
    Split(u32),
    /// A leaf, by its number.
    Leaf(u32),
}

/// A line that splits a part of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Split {
    /// Two points of it; its direction is from the first to the second.
    pub through: [GridPoint; 2],
    /// What lies on the right hand of somebody walking that way.
    pub right: Below,
    /// What lies on the left hand.
    pub left: Below,
}

/// A binary space partition of the plan, made elsewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Guide {
    splits: Vec<Split>,
    root: Below,
}

/// Why splits are no tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GuideError {
    /// A line is given by one point.
    #[error("node {0} has a partition line without a direction")]
    NoLine(usize),
    /// A child that is not there.
    #[error("node {0} has a child that does not exist")]
    NoChild(usize),
    /// A child that is its own ancestor, or another node's child, too.
    #[error("node {0} is reached in more than one way, so the nodes are no tree")]
    Twice(usize),
}

impl Guide {
    /// A tree of these splits, with leaves below `n_leaves`.
    ///
    /// # Errors
    /// Where they are none.
    pub fn new(splits: Vec<Split>, root: Below, n_leaves: usize) -> Result<Self, GuideError> {
        let mut reached = vec![false; splits.len()];
        let mut open = vec![(0, root)];
        while let Some((from, below)) = open.pop() {
            let i = match below {
                Below::Leaf(leaf) if (leaf as usize) < n_leaves => continue,
                Below::Split(i) if (i as usize) < splits.len() => i as usize,
                _ => return Err(GuideError::NoChild(from)),
            };
            if std::mem::replace(&mut reached[i], true) {
                return Err(GuideError::Twice(i));
            }
            let split = &splits[i];
            if split.through[0] == split.through[1] {
                return Err(GuideError::NoLine(i));
            }
            open.extend([(i, split.right), (i, split.left)]);
        }
        Ok(Self { splits, root })
    }
}

/// Cuts a level into cells that each lie in one leaf of the guide; and which leaf that is, for each
/// cell. The graph has no [`Tree`](super::Tree).
pub fn subdivide(level: &Level, guide: &Guide, options: &Options) -> (CellGraph, Vec<u32>) {
    let mut arrangement = arrange(level, options.doors);
    let mut cost = Cost {
        pieces: arrangement.pieces.len(),
        ..Cost::default()
    };
    let mirrored = arrangement.frame.mirrors();
    let guided = |below: Below| match below {
        Below::Split(i) => Guided::Split(i),
        Below::Leaf(leaf) => Guided::Part(leaf),
    };
    let in_frame = |split: &Split| {
        let [p, q] = split.through.map(|p| arrangement.frame.enter(p));
        let line = Line::through(p, q).expect("a guide's lines have a direction");
        // Lines point right, or straight up.
        let turned = (q.x, q.y) < (p.x, p.y);
        let [left, right] = [split.left, split.right].map(guided);
        let exchanged = turned != mirrored;
        (
            line,
            if exchanged {
                [right, left]
            } else {
                [left, right]
            },
        )
    };
    let lines: Vec<_> = guide.splits.iter().map(in_frame).collect();
    let splits: Vec<GuideSplit> = (lines.into_iter())
        .map(|(line, sides)| GuideSplit {
            line: arrangement.lines.insert(line),
            sides,
        })
        .collect();
    let by_walls: &mut Choose = &mut |a, fragments| bsp::choose(a, fragments, &options.bsp);
    let root = guided(guide.root);
    let partition = partition::guided(&mut arrangement, &splits, root, by_walls);
    cost.wall_splits = partition.splits;
    cost.depth = partition.depth;
    let mesh = mesh::join_leaves(&arrangement, &partition);
    let (graph, labels) = finish(level, options, &arrangement, &mesh, cost);
    let inside = labels.iter().zip(&partition.parts);
    let leaf_of = inside.filter(|(inside, _)| **inside).map(|(_, part)| *part);
    (graph, leaf_of.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::Locator;
    use crate::geom::{Side, Vertex};
    use crate::level::read::read;

    /// The leaf that holds a point, by the guide alone; `None` on a line.
    fn leaf(guide: &Guide, p: &Vertex) -> Option<u32> {
        let mut at = guide.root;
        loop {
            at = match at {
                Below::Leaf(leaf) => return Some(leaf),
                Below::Split(i) => {
                    let split = &guide.splits[i as usize];
                    let [a, b] = split.through.map(Vertex::from);
                    match crate::geom::orient(&a, &b, p) {
                        Side::Left => split.left,
                        Side::Right => split.right,
                        Side::On => return None,
                    }
                }
            }
        }
    }

    #[test]
    fn cells_lie_in_the_leaves_that_the_guide_says() {
        let text = "[[room]]\nname = \"A\"\nrect = [0, 0, 0.05, 0.04]\n\
            [[pillar]]\nrect = [0.02, 0.01, 0.025, 0.03]\n";
        let level = read(text.into(), "a.toml", None).unwrap();
        let at = |x, y| level.grid.nearest(glam::DVec2::new(x, y)).unwrap();
        // A line that runs through all, one that cuts the pillar, one that misses its part.
        let split = |p: [f64; 2], q: [f64; 2], right, left| Split {
            through: [at(p[0], p[1]), at(q[0], q[1])],
            right,
            left,
        };
        let splits = vec![
            split([0.01, 0.03], [0.01, 0.01], Below::Leaf(0), Below::Split(1)),
            split([0.0, 0.0], [0.05, 0.04], Below::Leaf(1), Below::Split(2)),
            split([0.003, 0.0], [0.003, 0.01], Below::Leaf(2), Below::Leaf(3)),
        ];
        let guide = Guide::new(splits, Below::Split(0), 4).unwrap();
        let (graph, leaves) = subdivide(&level, &guide, &Options::default());
        graph.validate().unwrap();
        assert_eq!(leaves.len(), graph.cells.len());
        let locator = Locator::new(&graph);
        let mut met = [0; 4];
        for x in -250..=250 {
            for y in -200..=200 {
                let p = GridPoint::new(x, y).into();
                let (Some(leaf), [cell]) = (leaf(&guide, &p), &locator.cells_at(&graph, &p)[..])
                else {
                    continue;
                };
                assert_eq!(leaves[cell.0 as usize], leaf, "{x}, {y}");
                met[leaf as usize] += 1;
            }
        }
        assert!(met[0] > 1000 && met[1] > 1000 && met[2] > 1000, "{met:?}");
        assert_eq!(met[3], 0);
    }

    #[test]
    fn what_is_no_tree_is_refused() {
        let p = GridPoint::new(0, 0);
        let q = GridPoint::new(1, 0);
        let node = |through, right, left| Split {
            through,
            right,
            left,
        };
        let refused = |splits, root| Guide::new(splits, root, 2).unwrap_err();
        let (leaf, own) = (Below::Leaf(0), Below::Split(0));
        assert_eq!(refused(vec![], own), GuideError::NoChild(0));
        assert_eq!(refused(vec![], Below::Leaf(2)), GuideError::NoChild(0));
        let circle = vec![node([p, q], leaf, own)];
        assert_eq!(refused(circle, own), GuideError::Twice(0));
        let shared = vec![
            node([p, q], Below::Split(1), Below::Split(1)),
            node([p, q], leaf, leaf),
        ];
        assert_eq!(refused(shared, own), GuideError::Twice(1));
        assert_eq!(
            refused(vec![node([p, p], leaf, leaf)], own),
            GuideError::NoLine(0)
        );
    }
}
