//! The lecture's construction from below: objects are added one at a time, each to the subtree whose
//! area it increases least (Goldsmith and Salmon, "Automatic Creation of Object Hierarchies", 1987).
//!
//! On the way down a new object may also become the sibling of the node reached, where the new
//! parent costs less area than going on: else a tree that began badly stays bad, and inner nodes
//! never get a far neighbour. Objects come in a fixed shuffled order, since sorted input makes the
//! worst trees; of two equal increases the smaller subtree takes the object.

use super::Topology;
use crate::trace::accel::bounds::Bounds;

/// A node while the tree grows.
#[derive(Clone, Copy)]
struct Grown {
    bounds: Bounds,
    /// Objects beneath.
    size: u32,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    Object(u32),
    Branch([u32; 2]),
}

/// A tree over boxes, one to a leaf.
pub(super) fn insert_all(boxes: &[Bounds]) -> Topology {
    let mut nodes: Vec<Grown> = Vec::with_capacity(boxes.len() * 2);
    for object in shuffled(boxes.len()) {
        insert(&mut nodes, object, &boxes[object as usize]);
    }
    flatten(&nodes)
}

/// 0 … n - 1 in an order that has nothing to do with that of the input.
fn shuffled(n: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..n as u32).collect();
    // Steele, Lea and Flood's mixer, as a key to sort by.
    let key = |i: u32| {
        let mut z = (u64::from(i) + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    order.sort_by_key(|&i| key(i));
    order
}

fn insert(nodes: &mut Vec<Grown>, object: u32, bounds: &Bounds) {
    let new = Grown {
        bounds: *bounds,
        size: 1,
        kind: Kind::Object(object),
    };
    if nodes.is_empty() {
        nodes.push(new);
        return;
    }
    let mut at = 0;
    loop {
        let node = nodes[at];
        let whole = node.bounds.union(bounds);
        let Kind::Branch(children) = node.kind else {
            break;
        };
        // Wherever it ends there will be a new branch: around both, if that is a leaf, and otherwise
        // at least around the object.
        let increase = |child: u32| {
            let child = &nodes[child as usize];
            let whole = child.bounds.union(bounds).half_area();
            match child.kind {
                Kind::Object(_) => (whole, child.size),
                Kind::Branch(_) => {
                    let more = whole - child.bounds.half_area();
                    (more + bounds.half_area(), child.size)
                }
            }
        };
        let [a, b] = children.map(increase);
        let (next, best) = if (a.0, a.1) <= (b.0, b.1) {
            (children[0], a.0)
        } else {
            (children[1], b.0)
        };
        // A new parent here costs the area of the whole; going on costs what this node grows to get
        // there, and `best`.
        if node.bounds.half_area() < best {
            break;
        }
        nodes[at].bounds = whole;
        nodes[at].size += 1;
        at = next as usize;
    }
    let old = nodes[at];
    let first = nodes.len() as u32;
    nodes.push(old);
    nodes.push(new);
    nodes[at] = Grown {
        bounds: old.bounds.union(bounds),
        size: old.size + 1,
        kind: Kind::Branch([first, first + 1]),
    };
}

/// Puts the children of each node side by side.
fn flatten(nodes: &[Grown]) -> Topology {
    let mut tree = Topology::new(Vec::new());
    if nodes.is_empty() {
        return tree;
    }
    let mut open = vec![(0, 0u32)];
    while let Some((node, from)) = open.pop() {
        match nodes[from as usize].kind {
            Kind::Object(object) => {
                let first = tree.order.len();
                tree.order.push(object);
                tree.set_leaf(node, first, first + 1);
            }
            Kind::Branch([a, b]) => {
                let child = tree.split(node);
                open.push((child + 1, b));
                open.push((child, a));
            }
        }
    }
    tree
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn equal_objects_make_a_balanced_tree() {
        let boxes = vec![Bounds::around([DVec3::ZERO, DVec3::ONE]); 1000];
        let tree = insert_all(&boxes);
        assert!(tree.depth() <= 24, "{}", tree.depth());
    }

    #[test]
    fn a_sorted_row_makes_no_list() {
        let at = |i: u32| Bounds::around([DVec3::X * f64::from(i), DVec3::X * f64::from(i) + 0.5]);
        let boxes: Vec<Bounds> = (0..1000).map(at).collect();
        let tree = insert_all(&boxes);
        assert!(tree.depth() <= 40, "{}", tree.depth());
    }

    #[test]
    fn an_object_goes_where_the_area_grows_least() {
        let cube = |x: f64| Bounds::around([DVec3::X * x, DVec3::X * x + 1.0]);
        let mut nodes = Vec::new();
        for (object, x) in [0.0, 10.0, 11.5].into_iter().enumerate() {
            insert(&mut nodes, object as u32, &cube(x));
        }
        let Kind::Branch(children) = nodes[0].kind else {
            panic!("the root is a leaf");
        };
        let sizes = children.map(|c| nodes[c as usize].size);
        assert_eq!(sizes.iter().sum::<u32>(), 3);
        let pair = children[if sizes[0] == 2 { 0 } else { 1 }];
        assert_eq!(
            nodes[pair as usize].bounds.min.x, 10.0,
            "10 and 11.5 are together"
        );
    }
}
