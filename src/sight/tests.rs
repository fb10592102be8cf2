//! Chains worked by hand, and many random ones against brute force in big integers.

use std::collections::HashSet;

use dashu_int::IBig;
use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::exact::{is_stabbed, slack};
use super::funnel::Funnel;
use super::*;
use crate::geom::{GridPoint, Line, Side, Vertex, VertexId, Vertices, orient};

/// Grid points.
fn grid(points: &[[i64; 2]]) -> Vertices {
    let exact = points.iter().map(|&[x, y]| GridPoint::new(x, y).into());
    Vertices::new(exact.collect())
}

/// Gates of consecutive vertices: left, right, left, right…
fn gates(n: u32) -> Vec<Gate> {
    let gate = |i| Gate {
        left: VertexId(2 * i),
        right: VertexId(2 * i + 1),
    };
    (0..n).map(gate).collect()
}

/// A chain of gates given as (left, right).
fn chain(points: &[[[i64; 2]; 2]]) -> (Vertices, Vec<Gate>) {
    (grid(&points.concat()), gates(points.len() as u32))
}

/// The answer, once every part of it has been checked; whether it is a line.
fn checked(vertices: &Vertices, chain: &[Gate]) -> bool {
    match exact::stab(vertices, chain) {
        Stabbing::Line(line) => {
            assert!(line.stabs(vertices, chain), "{line:?} of {chain:?}");
            let slack = slack(vertices, chain).expect("stabbed");
            assert_eq!(slack.width, line.slack);
            let nearest = nearest(vertices, chain);
            let error = (slack.width - nearest).abs();
            assert!(
                error <= 1e-12 * nearest || !vertices.is_grid(),
                "{slack:?}, not {nearest}"
            );
            assert!(slack.width > 0.0 && slack.left.len() + slack.right.len() <= 3);
            true
        }
        Stabbing::None(contradiction) => {
            assert!(contradiction.holds(vertices, chain), "{contradiction:?}");
            assert_eq!(slack(vertices, chain), None);
            without_any_end_it_falls(vertices, chain, &contradiction);
            false
        }
    }
}

/// The distance of the hulls: that of an end from the way between two of the other side.
fn nearest(vertices: &Vertices, chain: &[Gate]) -> f64 {
    let ends = |side: fn(&Gate) -> VertexId| -> Vec<DVec2> {
        chain.iter().map(|g| vertices.approx(side(g))).collect()
    };
    let (left, right) = (ends(|g| g.left), ends(|g| g.right));
    let mut least = f64::INFINITY;
    for (ends, others) in [(&left, &right), (&right, &left)] {
        for p in ends {
            for a in others {
                least = least.min(p.distance(*a));
                for b in others {
                    let way = *b - *a;
                    let along = (*p - *a).dot(way);
                    if along > 0.0 && along < way.length_squared() {
                        least = least.min(way.perp_dot(*p - *a).abs() / way.length());
                    }
                }
            }
        }
    }
    least
}

/// A chain that grows gate by gate, and shrinks again, has the slack of its gates at each length.
fn grows_and_shrinks(vertices: &Vertices, gates: &[Gate]) {
    let mut chain = Chain::new(vertices);
    let mut widths = vec![f64::INFINITY];
    for gate in gates {
        if !chain.push(*gate) {
            break;
        }
        let found = chain.slack().expect("not empty");
        assert_eq!(Some(&found), slack(vertices, chain.gates()).as_ref());
        let before = widths[widths.len() - 1];
        assert!(
            found.width <= before * (1.0 + 1e-14),
            "{found:?} after {before}"
        );
        widths.push(found.width);
    }
    let n = chain.gates().len();
    assert_eq!(
        n == gates.len(),
        is_stabbed(vertices, gates, &mut Funnel::default())
    );
    while chain.pop().is_some() {
        widths.pop();
        let width = chain.slack().map_or(f64::INFINITY, |found| found.width);
        assert_eq!(width, widths[widths.len() - 1]);
    }
    assert_eq!(widths.len(), 1);
}

fn without_any_end_it_falls(vertices: &Vertices, chain: &[Gate], whole: &Contradiction) {
    for i in 0..whole.left.len() {
        let mut less = whole.clone();
        less.left.remove(i);
        assert!(!less.holds(vertices, chain), "{i} of {whole:?}");
    }
    for i in 0..whole.right.len() {
        let mut less = whole.clone();
        less.right.remove(i);
        assert!(!less.holds(vertices, chain), "{i} of {whole:?}");
    }
}

#[test]
fn one_doorway() {
    let (vertices, chain) = chain(&[[[-3, 4], [0, 0]]]);
    assert!(checked(&vertices, &chain));
    let found = slack(&vertices, &chain).unwrap();
    assert_eq!(found.width, 5.0);
    assert_eq!((found.left[0], found.right[0]), (VertexId(0), VertexId(1)));
}

#[test]
fn two_doorways_in_line_of_sight() {
    // Walking right: the left end is above.
    let (vertices, chain) = chain(&[[[0, 4], [0, 0]], [[8, 7], [8, 1]]]);
    let Stabbing::Line(line) = stab(&vertices, &chain, Solver::Exact) else {
        panic!("nothing in the way");
    };
    // The left ends' nearest point to the right ends is (0, 4), 32/√65 from the line through them.
    assert!(line.stabs(&vertices, &chain));
    assert_eq!(line.slack, 32.0 / 65f64.sqrt());
    let found = slack(&vertices, &chain).unwrap();
    assert_eq!(found.left[..], [VertexId(0)]);
    assert_eq!(found.right[..], [VertexId(1), VertexId(3)]);
    let [_, b, c] = line.approx();
    assert!((4.0 * b + c - line.slack / 2.0).abs() < 1e-12);
    assert!((c + line.slack / 2.0).abs() < 1e-12);
}

#[test]
fn grazing_is_not_sight() {
    // The third doorway begins where the line through the first two ends.
    let pinned = |y| chain(&[[[0, 1], [0, 0]], [[4, 0], [4, -1]], [[8, y + 1], [8, y]]]);
    let (vertices, gates) = pinned(-2);
    assert!(checked(&vertices, &gates));
    let (vertices, gates) = pinned(0);
    assert!(!checked(&vertices, &gates));
    let Stabbing::None(why) = exact::stab(&vertices, &gates) else {
        panic!("the line may only graze");
    };
    // (0, 0) and (8, 0) on the right with (4, 0) on the left between them.
    assert_eq!(why.left[..], [VertexId(2)]);
    let mut right = why.right.to_vec();
    right.sort();
    assert_eq!(right, [VertexId(1), VertexId(5)]);
}

#[test]
fn a_needle_of_two_hundred_doorways() {
    // Along a line of slope 1/3. The lowest left ends lie on y = (x + 1)/3, the highest right ends on
    // y = (x - 1)/3.
    let ends = |x: i64| {
        let left = x.div_euclid(3) + 1;
        [[x, left], [x, left - 1 - i64::from(x % 3 == 0)]]
    };
    let portals: Vec<_> = (0..200).map(ends).collect();
    let (vertices, gates) = chain(&portals);
    assert!(checked(&vertices, &gates));
    let width = slack(&vertices, &gates).unwrap().width;
    assert!((width - 2.0 / 10f64.sqrt()).abs() < 1e-12, "{width}");
    // One doorway a step to the right, and it is shut.
    let mut shut = portals;
    shut[101] = shut[101].map(|[x, y]| [x, y - 1]);
    let (vertices, gates) = chain(&shut);
    assert!(!checked(&vertices, &gates));
}

#[test]
fn what_is_no_doorway() {
    // Without width; the same again; the same backwards; in line with the one before.
    for (portals, open) in [
        (vec![[[1, 1], [1, 1]]], false),
        (vec![[[0, 1], [0, 0]], [[3, 0], [3, 0]]], false),
        (vec![[[0, 1], [0, 0]], [[0, 1], [0, 0]]], true),
        (vec![[[0, 1], [0, 0]], [[0, 0], [0, 1]]], false),
        (vec![[[0, 1], [0, 0]], [[0, -4], [0, -2]]], false),
        (vec![[[0, 1], [0, 0]], [[0, 0], [0, -2]]], false),
        // Around a corner, with an end in common: open on two sides of it, not on all.
        (vec![[[0, 0], [0, -3]], [[0, 0], [3, 0]]], true),
        (
            vec![[[0, 0], [0, -3]], [[0, 0], [3, 0]], [[0, 0], [0, 3]]],
            false,
        ),
    ] {
        let (vertices, gates) = chain(&portals);
        assert_eq!(checked(&vertices, &gates), open, "{portals:?}");
    }
}

/// A reference that shares nothing with the solvers: whether at most four ends contradict each other
/// (Kirchberger), all sets of them tried, with the sides of all triples in big integers.
struct Reference {
    n: usize,
    /// Left ends first.
    points: Vec<Vertex>,
    sides: Vec<i8>,
}

impl Reference {
    fn new(vertices: &Vertices, chain: &[Gate]) -> Self {
        let ends = chain
            .iter()
            .map(|g| g.left)
            .chain(chain.iter().map(|g| g.right));
        let points: Vec<Vertex> = ends.map(|v| *vertices.exact(v)).collect();
        let m = points.len();
        let big: Vec<[IBig; 3]> = points
            .iter()
            .map(|v| [v.x().into(), v.y().into(), v.w().into()])
            .collect();
        let mut sides = vec![0; m * m * m];
        for i in 0..m {
            for j in i + 1..m {
                let [p, q] = [&big[i], &big[j]];
                let line = [
                    &p[1] * &q[2] - &q[1] * &p[2],
                    &p[2] * &q[0] - &q[2] * &p[0],
                    &p[0] * &q[1] - &q[0] * &p[1],
                ];
                for k in 0..m {
                    let r = &big[k];
                    let value = &line[0] * &r[0] + &line[1] * &r[1] + &line[2] * &r[2];
                    let side = match Side::of_big(&value) {
                        Side::Left => 1,
                        Side::On => 0,
                        Side::Right => -1,
                    };
                    sides[(i * m + j) * m + k] = side;
                    sides[(j * m + i) * m + k] = -side;
                }
            }
        }
        let n = chain.len();
        Self { n, points, sides }
    }

    fn side(&self, i: usize, j: usize, k: usize) -> i8 {
        let m = self.points.len();
        self.sides[(i * m + j) * m + k]
    }

    /// Whether k lies between i and j, or is one of them.
    fn between(&self, i: usize, j: usize, k: usize) -> bool {
        let [a, b, p] = [i, j, k].map(|n| &self.points[n]);
        let key = |v: &Vertex| (v.x(), v.y(), v.w());
        if key(p) == key(a) || key(p) == key(b) {
            return true;
        }
        self.side(i, j, k) == 0 && key(a) != key(b) && {
            // The scalar product of the ways from p to a and to b.
            let less = |m: i128, mw: i64, n: i128, nw: i64| {
                IBig::from(m) * IBig::from(nw) - IBig::from(n) * IBig::from(mw)
            };
            let way = |q: &Vertex| {
                (
                    less(q.x(), q.w(), p.x(), p.w()),
                    less(q.y(), q.w(), p.y(), p.w()),
                )
            };
            let ((ax, ay), (bx, by)) = (way(a), way(b));
            ax * bx + ay * by < IBig::ZERO
        }
    }

    fn in_triangle(&self, [i, j, l]: [usize; 3], k: usize) -> bool {
        let sides = [self.side(i, j, k), self.side(j, l, k), self.side(l, i, k)];
        sides == [1; 3] || sides == [-1; 3]
    }

    fn contradicts(&self) -> bool {
        let (n, m) = (self.n, self.points.len());
        let (lefts, rights) = (0..n, n..m);
        for (own, other) in [(lefts.clone(), rights.clone()), (rights, lefts)] {
            for i in own.clone() {
                for j in i..own.end {
                    for k in other.clone() {
                        if self.between(i, j, k) {
                            return true;
                        }
                        if (j + 1..own.end).any(|l| self.in_triangle([i, j, l], k)) {
                            return true;
                        }
                        for l in k + 1..other.end {
                            if self.side(i, j, k) * self.side(i, j, l) < 0
                                && self.side(k, l, i) * self.side(k, l, j) < 0
                            {
                                return true;
                            }
                        }
                    }
                }
            }
        }
        false
    }
}

/// What the points of a pool are.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// On a small grid: many in line, many the same.
    Small,
    /// Anywhere on the grid.
    Large,
    /// Within a few steps of a line across the whole grid.
    Thin,
    /// Where lines through points of a small grid meet.
    OffSmall,
    /// Where lines through points anywhere on the grid meet.
    OffLarge,
}

const KINDS: [Kind; 5] = [
    Kind::Small,
    Kind::Large,
    Kind::Thin,
    Kind::OffSmall,
    Kind::OffLarge,
];

fn pool(kind: Kind, n: usize, random: &mut Pcg64Mcg) -> Vertices {
    let limit = (1 << 25) - 1;
    let mut point = |size: i64| {
        GridPoint::new(
            random.random_range(-size..=size),
            random.random_range(-size..=size),
        )
    };
    let mut list: Vec<Vertex> = Vec::new();
    while list.len() < n {
        list.push(match kind {
            Kind::Small => point(3).into(),
            Kind::Large => point(limit).into(),
            Kind::Thin => {
                let p = point(limit / 4);
                GridPoint::new(p.x, p.x * 3 + p.y % 3).into()
            }
            Kind::OffSmall | Kind::OffLarge => {
                let size = if matches!(kind, Kind::OffSmall) {
                    4
                } else {
                    limit
                };
                // Several points on one line are common in levels.
                let [a, b, c, d, e] = std::array::from_fn(|_| point(size));
                let Some(line) = Line::through(a, b) else {
                    continue;
                };
                let others = [
                    Line::through(c, d),
                    Line::through(d, e),
                    Line::through(c, e),
                ];
                let meets = others.into_iter().flatten().filter_map(|o| line.meet(&o));
                let size = i128::from(limit);
                list.extend(meets.filter(|v| {
                    v.x().abs() <= size * i128::from(v.w())
                        && v.y().abs() <= size * i128::from(v.w())
                }));
                continue;
            }
        });
    }
    // Each point once, as in the cells of a level.
    let mut met = HashSet::new();
    list.retain(|v| met.insert(*v));
    Vertices::new(list)
}

/// Whether the second gate can be in the convex cell beyond the first.
fn follows(vertices: &Vertices, last: Gate, gate: Gate) -> bool {
    // Counterclockwise around the cell.
    let corners = [last.left, last.right, gate.right, gate.left].map(|v| vertices.exact(v));
    let [a, b, c, d] = corners;
    let convex = [
        (a, b, c),
        (a, b, d),
        (b, c, d),
        (c, d, a),
        (c, d, b),
        (d, a, b),
        (d, a, c),
    ]
    .into_iter()
    .all(|(p, q, r)| orient(p, q, r) != Side::Right);
    let flat = orient(a, b, c) == Side::On && orient(a, b, d) == Side::On;
    let apart = a != b && c != d;
    // In line: first the one, then the other.
    let in_order = || {
        let along = |p: &Vertex, q: &Vertex| {
            let forward = a.cmp_x(b).then(a.cmp_y(b));
            p.cmp_x(q).then(p.cmp_y(q)) != forward.reverse()
        };
        along(b, c) && along(c, d)
    };
    apart && convex && (!flat || in_order())
}

/// A chain through convex cells with its gates' ends in the pool.
fn wander(vertices: &Vertices, length: usize, random: &mut Pcg64Mcg) -> Vec<Gate> {
    let n = vertices.len() as u32;
    let mut chain: Vec<Gate> = Vec::new();
    for _ in 0..40 * length {
        if chain.len() == length {
            break;
        }
        let mut gate = Gate {
            left: VertexId(random.random_range(0..n)),
            right: VertexId(random.random_range(0..n)),
        };
        let Some(last) = chain.last() else {
            if vertices.exact(gate.left) != vertices.exact(gate.right) {
                chain.push(gate);
            }
            continue;
        };
        match random.random_range(0..6) {
            0 | 1 => gate.left = last.left,
            2 | 3 => gate.right = last.right,
            _ => {}
        }
        if follows(vertices, *last, gate) {
            chain.push(gate);
        }
    }
    chain
}

/// Gates that need be no chain.
fn any_gates(vertices: &Vertices, length: usize, random: &mut Pcg64Mcg) -> Vec<Gate> {
    let n = vertices.len() as u32;
    let mut end = || VertexId(random.random_range(0..n));
    let mut gate = || Gate {
        left: end(),
        right: end(),
    };
    (0..length).map(|_| gate()).collect()
}

#[test]
fn random_chains_agree_with_brute_force() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    let (mut stabbed, mut blocked, mut loose) = ([0; 5], [0; 5], [0; 2]);
    for round in 0..6000 {
        let kind = round % KINDS.len();
        let vertices = pool(KINDS[kind], 12, &mut random);
        for _ in 0..20 {
            let length = random.random_range(1..=6);
            let chain = wander(&vertices, length, &mut random);
            if chain.is_empty() {
                continue;
            }
            let open = checked(&vertices, &chain);
            let reference = Reference::new(&vertices, &chain);
            assert_eq!(open, !reference.contradicts(), "{vertices:?} {chain:?}");
            assert_eq!(
                open,
                is_stabbed(&vertices, &chain, &mut Funnel::default()),
                "{chain:?}"
            );
            grows_and_shrinks(&vertices, &chain);
            [&mut blocked, &mut stabbed][usize::from(open)][kind] += 1;
            // Any gates at all, such as those of no cells, with every point there twice.
            let twice = vertices.iter().chain(vertices.iter()).copied();
            let twice = Vertices::new(twice.collect());
            let gates = any_gates(&twice, length, &mut random);
            let open = checked(&twice, &gates);
            assert_eq!(open, !Reference::new(&twice, &gates).contradicts());
            loose[usize::from(open)] += 1;
        }
    }
    println!("stabbed {stabbed:?}, blocked {blocked:?}, loose {loose:?}");
    assert!(
        stabbed
            .iter()
            .chain(&blocked)
            .chain(&loose)
            .all(|n| *n > 1000)
    );
}

#[test]
fn the_linear_programme_agrees_where_there_is_room() {
    let mut random = Pcg64Mcg::seed_from_u64(5);
    let (mut roomy, mut blocked, mut proofs, mut wrong) = (0, 0, 0, 0);
    for round in 0..2000 {
        let kind = KINDS[round % KINDS.len()];
        let vertices = pool(kind, 12, &mut random);
        for loose in [false, true].repeat(10) {
            let length = random.random_range(1..=6);
            let chain = if loose {
                any_gates(&vertices, length, &mut random)
            } else {
                wander(&vertices, length, &mut random)
            };
            if chain.is_empty() {
                continue;
            }
            let exact = slack(&vertices, &chain);
            let place = |v| vertices.approx(v);
            let ends = || chain.iter().flat_map(|g| [place(g.left), place(g.right)]);
            let low = ends().reduce(DVec2::min).unwrap();
            let high = ends().reduce(DVec2::max).unwrap();
            let size = (high - low).max_element();
            match (lp::stab(&vertices, &chain), exact) {
                (Stabbing::Line(line), Some(exact)) if exact.width > 1e-8 * size => {
                    assert!(line.stabs(&vertices, &chain), "{chain:?}");
                    assert!(line.slack <= exact.width * (1.0 + 1e-6), "{chain:?}");
                    roomy += 1;
                }
                (Stabbing::Line(_), None) => {
                    // Only where it grazes.
                    assert!(lp::margin(&vertices, &chain).unwrap() < 1e-7, "{chain:?}");
                    wrong += 1;
                }
                (Stabbing::None(why), None) => {
                    blocked += 1;
                    proofs += u32::from(why.holds(&vertices, &chain));
                }
                (Stabbing::None(_), Some(exact)) => {
                    assert!(exact.width <= 1e-8 * size, "{} of {size}", exact.width);
                }
                _ => {}
            }
        }
    }
    println!("{roomy} lines, {blocked} blocked, of them {proofs} with proof, {wrong} wrong");
    assert!(roomy > 10_000 && blocked > 5_000);
    // Grazing is where it errs, and seldom is its contradiction none.
    assert!(wrong > 0 && wrong < blocked / 20);
    assert!(proofs > blocked - blocked / 100);
}
