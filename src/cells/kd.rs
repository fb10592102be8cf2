//! The rule of the kd-tree: split by axis-aligned lines through wall ends, then by the walls left.
//!
//! The wider axis is tried first; of the wall ends on it, the one that balances best is taken. When
//! no axis-aligned line through a wall's end separates anything any more, or few walls are left, the
//! walls themselves split the leaf, so that cells are free of walls and convex.
//! Source: lecture, "Non Uniform Grid: Kd-Tree".

use super::arrangement::{Arrangement, LineId};
use super::bsp;
use super::partition::Fragment;
use crate::geom::{Line, Side};

/// Options of [`choose`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KdOptions {
    /// Regions with at most this many walls are split by the walls themselves.
    pub leaf_walls: usize,
    /// How many wall ends are tried per axis; at least 1.
    pub candidates: usize,
    /// The rule for walls inside a leaf.
    pub bsp: bsp::BspOptions,
}

impl Default for KdOptions {
    fn default() -> Self {
        Self {
            leaf_walls: 6,
            candidates: 9,
            bsp: bsp::BspOptions::default(),
        }
    }
}

/// The best axis-aligned line through a wall's end, or else a wall's own line.
pub fn choose(
    arrangement: &mut Arrangement,
    fragments: &[Fragment],
    options: &KdOptions,
) -> LineId {
    if fragments.len() > options.leaf_walls {
        let mut best: Option<(u64, Line)> = None;
        for axis in axes_by_width(arrangement, fragments) {
            for &at in middle(
                &ends(arrangement, fragments, axis),
                options.candidates.max(1),
            ) {
                let line = match axis {
                    Axis::X => Line::vertical(at),
                    Axis::Y => Line::horizontal(at),
                };
                if let Some(cost) = cost(arrangement, fragments, &line, &options.bsp)
                    && best.is_none_or(|b| cost < b.0)
                {
                    best = Some((cost, line));
                }
            }
            if best.is_some() {
                break;
            }
        }
        if let Some((_, line)) = best {
            return arrangement.lines.insert(line);
        }
    }
    bsp::choose(arrangement, fragments, &options.bsp)
}

#[derive(Clone, Copy)]
enum Axis {
    X,
    Y,
}

/// Grid coordinates of the fragments' ends, ascending, each once.
fn ends(arrangement: &Arrangement, fragments: &[Fragment], axis: Axis) -> Vec<i64> {
    let mut list: Vec<i64> = fragments
        .iter()
        .flat_map(|f| [f.from, f.to])
        .filter_map(|v| arrangement.vertices.get(v).grid())
        .map(|p| match axis {
            Axis::X => p.x,
            Axis::Y => p.y,
        })
        .collect();
    list.sort_unstable();
    list.dedup();
    list
}

fn axes_by_width(arrangement: &Arrangement, fragments: &[Fragment]) -> [Axis; 2] {
    let width = |axis| {
        let ends = ends(arrangement, fragments, axis);
        ends.last()
            .zip(ends.first())
            .map_or(0, |(high, low)| high - low)
    };
    if width(Axis::X) >= width(Axis::Y) {
        [Axis::X, Axis::Y]
    } else {
        [Axis::Y, Axis::X]
    }
}

/// At most `n` elements around the middle.
fn middle(list: &[i64], n: usize) -> &[i64] {
    let n = n.min(list.len());
    let first = (list.len() - n) / 2;
    &list[first..first + n]
}

/// The cost of splitting by `line`; `None` where that makes no progress.
fn cost(
    arrangement: &Arrangement,
    fragments: &[Fragment],
    line: &Line,
    options: &bsp::BspOptions,
) -> Option<u64> {
    let (mut left, mut right, mut cut, mut on) = (0u64, 0u64, 0u64, 0u64);
    for f in fragments {
        let side = |v| arrangement.vertices.side(v, line);
        match (side(f.from), side(f.to)) {
            (Side::On, Side::On) => on += 1,
            (Side::Left, Side::Right) | (Side::Right, Side::Left) => cut += 1,
            (Side::Left, _) | (_, Side::Left) => left += 1,
            _ => right += 1,
        }
    }
    // Otherwise one side would hold as many walls as before.
    if left + on == 0 || right + on == 0 {
        return None;
    }
    Some(
        cut * u64::from(options.split_weight)
            + left.abs_diff(right) * u64::from(options.balance_weight),
    )
}
