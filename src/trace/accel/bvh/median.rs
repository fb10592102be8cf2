//! The lecture's median cut, from the top down.
//!
//! Of the list of bounding volumes: the widest slab around it, d_max[k] - d_min[k]; sorted by d_min
//! of that slab; cut into two halves. The halves are the same whether the list is sorted or only
//! divided at its median, which takes less time.

use glam::DVec3;

use super::{LEAF, Topology};
use crate::trace::accel::bounds::Bounds;

/// A tree over boxes; `slabs` are the directions among which the widest is chosen.
pub(super) fn median_cut(boxes: &[Bounds], slabs: &[DVec3]) -> Topology {
    let mut tree = Topology::new((0..boxes.len() as u32).collect());
    if boxes.is_empty() {
        return tree;
    }
    let mut open = vec![(0, 0, boxes.len())];
    while let Some((node, first, end)) = open.pop() {
        if end - first <= LEAF {
            tree.set_leaf(node, first, end);
            continue;
        }
        let list = &mut tree.order[first..end];
        let k = widest(boxes, list, slabs);
        let middle = list.len() / 2;
        let least = |i: u32| slab(&boxes[i as usize], slabs[k]).0;
        list.select_nth_unstable_by(middle, |&a, &b| {
            least(a).total_cmp(&least(b)).then(a.cmp(&b))
        });
        let child = tree.split(node);
        open.push((child, first, first + middle));
        open.push((child + 1, first + middle, end));
    }
    tree
}

/// The direction of the widest slab around the boxes of the list, lengths taken into account.
fn widest(boxes: &[Bounds], list: &[u32], slabs: &[DVec3]) -> usize {
    let width = |direction: DVec3| {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        let (min, max) = list.iter().fold(start, |(min, max), &i| {
            let (low, high) = slab(&boxes[i as usize], direction);
            (min.min(low), max.max(high))
        });
        (max - min) / direction.length()
    };
    let widths: Vec<f64> = slabs.iter().map(|&d| width(d)).collect();
    // The first of equals.
    (0..slabs.len())
        .rev()
        .max_by(|&a, &b| widths[a].total_cmp(&widths[b]))
        .unwrap_or(0)
}

/// Least and greatest product of a point of the box with the direction.
fn slab(b: &Bounds, direction: DVec3) -> (f64, f64) {
    let (centre, half) = (
        b.centre().dot(direction),
        b.size().dot(direction.abs()) * 0.5,
    );
    (centre - half, centre + half)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lecture_s_example() {
        // Five volumes whose slab 1 (here y) is the widest: sorted by d_min they are 1, 5, 3, 2, 4.
        let starts = [0.0, 6.0, 4.0, 9.0, 2.0];
        let boxes: Vec<Bounds> = starts
            .iter()
            .map(|&y| Bounds::around([DVec3::new(0.0, y, 0.0), DVec3::new(3.0, y + 3.0, 1.0)]))
            .collect();
        let all: Vec<u32> = (0..5).collect();
        assert_eq!(widest(&boxes, &all, &[DVec3::X, DVec3::Y, DVec3::Z]), 1);
        let tree = median_cut(&boxes, &[DVec3::X, DVec3::Y, DVec3::Z]);
        // Halves of 2 and 3 volumes: numbers 1 and 5 of the example go left.
        let mut left = tree.order[..2].to_vec();
        left.sort();
        assert_eq!(left, [0, 4]);
    }
}
