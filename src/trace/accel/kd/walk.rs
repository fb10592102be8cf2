//! Three ways of a ray through a kd-tree.
//!
//! Each node has an interval [near, far] of t. The time t at the plane is computed by the same
//! expression wherever it is needed, so it is the same number each time: intervals that should meet do
//! meet, and restarting ends. The near child is the one on the side from which the ray comes, by the
//! sign of the direction. (The lecture's `thit < 0 → first` then would be wrong, for a ray that starts
//! behind the plane and leaves it; `thit ≤ tmin → second` already says the right thing.)
//!
//! A leaf ends the search only if what was found lies strictly before the next interval begins: of
//! equal contacts the lower number must win.

use smallvec::SmallVec;

use super::{Kd, Node};
use crate::trace::accel::bounds::Bounds;
use crate::trace::accel::cast::Cast;
use crate::trace::accel::count::Count;
use crate::trace::accel::mailbox::Mailbox;
use crate::trace::accel::search::Search;

/// What the ray does at a plane.
enum Way {
    /// It meets this child only.
    One(u32),
    /// First the one, and the other after t.
    Both(u32, f64, u32),
}

fn way(node: &Node, cast: &Cast, (near, far): (f64, f64)) -> Way {
    let axis = node.tag as usize;
    let t = (node.at - cast.ray.origin[axis]) * cast.inverse[axis];
    let (first, second) = if cast.inverse[axis] > 0.0 {
        (node.first, node.first + 1)
    } else {
        (node.first + 1, node.first)
    };
    if t <= near {
        Way::One(second)
    } else if t >= far {
        Way::One(first)
    } else {
        Way::Both(first, t, second)
    }
}

/// Tests what lies in a leaf. Returns whether the search is over.
fn visit<S: Search, C: Count>(
    list: &[u32],
    mailbox: &mut Mailbox,
    search: &mut S,
    count: &mut C,
) -> bool {
    count.cell();
    list.iter()
        .any(|&primitive| mailbox.is_new(primitive) && search.test(primitive, count))
}

/// The far child waits on a stack with its interval.
pub(super) fn stack<S: Search, C: Count>(
    tree: &Kd,
    cast: &Cast,
    (mut near, mut far): (f64, f64),
    search: &mut S,
    count: &mut C,
) {
    let mut mailbox = Mailbox::new();
    let mut open: SmallVec<[(u32, f64, f64); 32]> = SmallVec::new();
    let mut at = 0;
    loop {
        let node = &tree.nodes[at as usize];
        if node.tag < Node::LEAF {
            count.node();
            match way(node, cast, (near, far)) {
                Way::One(child) => at = child,
                Way::Both(first, t, second) => {
                    open.push((second, t, far));
                    (at, far) = (first, t);
                }
            }
            continue;
        }
        if visit(tree.leaf(node), &mut mailbox, search, count) {
            return;
        }
        let Some(next) = open.pop() else {
            return;
        };
        (at, near, far) = next;
        // What waits deeper on the stack is later still.
        if search.limit() < near {
            return;
        }
    }
}

/// From `from` down to the first leaf in the interval; returns it and when the ray leaves it.
fn descend<'a, C: Count>(
    tree: &'a Kd,
    cast: &Cast,
    mut from: u32,
    (near, mut far): (f64, f64),
    count: &mut C,
) -> (u32, &'a Node, f64) {
    loop {
        let node = &tree.nodes[from as usize];
        if node.tag >= Node::LEAF {
            return (from, node, far);
        }
        count.node();
        match way(node, cast, (near, far)) {
            Way::One(child) => from = child,
            Way::Both(first, t, _) => (from, far) = (first, t),
        }
    }
}

/// Without a stack: after a leaf, from the root again, the interval beginning where the leaf ended.
/// That is the time at some plane above, which is strictly later than the beginning was, or else the
/// end of all; so the search moves on and ends.
pub(super) fn restart<S: Search, C: Count>(
    tree: &Kd,
    cast: &Cast,
    (mut near, end): (f64, f64),
    search: &mut S,
    count: &mut C,
) {
    let mut mailbox = Mailbox::new();
    loop {
        let (_, leaf, far) = descend(tree, cast, 0, (near, end), count);
        if visit(tree.leaf(leaf), &mut mailbox, search, count) {
            return;
        }
        near = far;
        if near >= end || search.limit() < near {
            return;
        }
    }
}

/// Without a stack and without the way down from the root: up by the parents until a node is found
/// that the ray leaves strictly later than the leaf. When it does is computed from the node's box by
/// the same expression as at the planes, so 'strictly' means what it says.
pub(super) fn backtrack<S: Search, C: Count>(
    tree: &Kd,
    cast: &Cast,
    (mut near, end): (f64, f64),
    search: &mut S,
    count: &mut C,
) {
    let mut mailbox = Mailbox::new();
    let (mut from, mut far) = (0, end);
    loop {
        let (at, leaf, leaves) = descend(tree, cast, from, (near, far), count);
        if visit(tree.leaf(leaf), &mut mailbox, search, count) {
            return;
        }
        near = leaves;
        if near >= end || search.limit() < near {
            return;
        }
        from = at;
        loop {
            // The root, which is its own parent, is left at `end`.
            from = tree.upward[from as usize].1;
            count.node();
            far = leaving(&tree.upward[from as usize].0, cast).min(end);
            if far > near || from == 0 {
                break;
            }
        }
    }
}

/// When the ray has left the box.
fn leaving(space: &Bounds, cast: &Cast) -> f64 {
    let one = (space.min - cast.ray.origin) * cast.inverse;
    let two = (space.max - cast.ray.origin) * cast.inverse;
    one.max(two).min_element()
}
