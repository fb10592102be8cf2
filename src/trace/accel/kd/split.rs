//! Where the planes of a kd-tree are put.

use super::Split;
use crate::trace::accel::bounds::Bounds;

/// Primitives in a leaf by the lecture's heuristic.
const LEAF: usize = 4;

/// What passing a node costs, in tests of primitives.
const PASS: f64 = 1.5;

/// Part of the cost that is left where one side is empty: rays through it are done at once.
const EMPTY_SIDE: f64 = 0.8;

impl Split {
    /// The axis and place of the plane; none where the node should be a leaf.
    pub(super) fn choose(
        self,
        space: &Bounds,
        list: &[u32],
        boxes: &[Bounds],
    ) -> Option<(usize, f64)> {
        match self {
            Split::Balance => balance(space, list, boxes),
            Split::Area => area(space, list, boxes),
        }
    }
}

/// Least and greatest coordinates of the list's boxes along an axis, each sorted.
struct Sorted {
    least: Vec<f64>,
    greatest: Vec<f64>,
}

impl Sorted {
    fn new(list: &[u32], boxes: &[Bounds], axis: usize) -> Self {
        let sorted = |of: fn(&Bounds, usize) -> f64| {
            let mut all: Vec<f64> = list.iter().map(|&p| of(&boxes[p as usize], axis)).collect();
            all.sort_unstable_by(f64::total_cmp);
            all
        };
        Self {
            least: sorted(|b, axis| b.min[axis]),
            greatest: sorted(|b, axis| b.max[axis]),
        }
    }

    /// How many primitives touch the space up to the plane, and from it on.
    fn sides(&self, at: f64) -> (usize, usize) {
        let left = self.least.partition_point(|&x| x <= at);
        let right = self.greatest.len() - self.greatest.partition_point(|&x| x < at);
        (left, right)
    }
}

/// The lecture: sort the objects on each axis, take the middle one's point, and the axis with the
/// best distribution: L and R near n/2, |L - R| least. A plane that leaves more than two thirds of
/// the objects on a side, or puts many on both, is not worth it.
fn balance(space: &Bounds, list: &[u32], boxes: &[Bounds]) -> Option<(usize, f64)> {
    let n = list.len();
    if n <= LEAF {
        return None;
    }
    let mut best: Option<((usize, usize), (usize, f64))> = None;
    for axis in 0..3 {
        let mut centres: Vec<f64> = list
            .iter()
            .map(|&p| boxes[p as usize].centre()[axis])
            .collect();
        let (_, &mut at, _) = centres.select_nth_unstable_by(n / 2, f64::total_cmp);
        if !(space.min[axis] < at && at < space.max[axis]) {
            continue;
        }
        let (left, right) = Sorted::new(list, boxes, axis).sides(at);
        if left.max(right) == n || left + right > n + n / 2 {
            continue;
        }
        let quality = (left.abs_diff(right), left + right);
        if best.is_none_or(|(b, _)| quality < b) {
            best = Some((quality, (axis, at)));
        }
    }
    best.map(|(_, cut)| cut)
}

/// The least of: cost of passing the node + for each side its share of the area times its objects.
/// Only faces of boxes come into question, a last place outside so that the box lies on one side.
fn area(space: &Bounds, list: &[u32], boxes: &[Bounds]) -> Option<(usize, f64)> {
    let whole = space.half_area();
    let mut best = (list.len() as f64, None);
    for axis in 0..3 {
        let sorted = Sorted::new(list, boxes, axis);
        let below = sorted.least.iter().map(|x| x.next_down());
        let above = sorted.greatest.iter().map(|x| x.next_up());
        for at in below.chain(above) {
            if !(space.min[axis] < at && at < space.max[axis]) {
                continue;
            }
            let (left, right) = sorted.sides(at);
            let [low, high] = super::super::halves(space, axis, at);
            let share = low.half_area() * left as f64 + high.half_area() * right as f64;
            let mut cost = PASS + share / whole;
            if left == 0 || right == 0 {
                cost *= EMPTY_SIDE;
            }
            if cost < best.0 {
                best = (cost, Some((axis, at)));
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn cubes(places: &[[f64; 3]]) -> Vec<Bounds> {
        let cube = |&p: &[f64; 3]| Bounds::around([DVec3::from(p), DVec3::from(p) + 1.0]);
        places.iter().map(cube).collect()
    }

    #[test]
    fn balance_takes_the_axis_that_parts_the_objects() {
        // Along x they overlap, along y they stand apart.
        let boxes = cubes(&[
            [0.0, 0.0, 0.0],
            [0.1, 2.0, 0.0],
            [0.2, 4.0, 0.0],
            [0.3, 6.0, 0.0],
            [0.4, 8.0, 0.0],
            [0.5, 10.0, 0.0],
        ]);
        let all: Vec<u32> = (0..6).collect();
        let space = boxes.iter().fold(Bounds::EMPTY, |a, b| a.union(b));
        let (axis, at) = Split::Balance.choose(&space, &all, &boxes).unwrap();
        assert_eq!((axis, at), (1, 6.5), "the middle object's centre");
        let sides = Sorted::new(&all, &boxes, 1).sides(at);
        assert_eq!(sides, (4, 3));
    }

    #[test]
    fn the_area_heuristic_cuts_off_empty_space() {
        let boxes = cubes(&[[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [9.0, 0.0, 0.0]]);
        let space = boxes.iter().fold(Bounds::EMPTY, |a, b| a.union(b));
        let (axis, at) = Split::Area.choose(&space, &[0, 1, 2], &boxes).unwrap();
        assert_eq!(axis, 0);
        assert!(at == 1f64.next_up() || at == 9f64.next_down(), "{at}");
        // Coinciding objects cannot be parted.
        assert_eq!(Split::Area.choose(&boxes[0], &[0, 1], &boxes), None);
        assert_eq!(Split::Balance.choose(&boxes[0], &[0; 9], &boxes), None);
    }
}
