//! What a stabbing test costs: microseconds by the linear programme and by the exact solver, against
//! the length of the chain.
//!
//! `cargo bench --bench sight`. The chains are drawn from a depth-first search of Freedoom maps (needs
//! the Debian package `freedoom`) and made up: doorways of random width along a line, on the grid and
//! off it. Each kind comes open, with a stabbing line, and shut: there the last gate is the first
//! that no line reaches. Every figure is a median over chains and repeats of one run, both solvers in
//! turn; ratios mean something on a noisy machine too.
//!
//! `yes/no` is the bare test of a whole chain, `answer` gives the line or the ends that contradict
//! each other as well, `+1` is one gate more on a chain that is kept, as the search does it.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use enfilade::cells::{CellGraph, CellId, Options, subdivide};
use enfilade::geom::{GridPoint, Vertex, VertexId, Vertices};
use enfilade::level::{doom, snap, wad::Wad};
use enfilade::sight::funnel::Funnel;
use enfilade::sight::{Chain, Gate, Stabbing, exact, lp};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const LENGTHS: [usize; 13] = [2, 3, 5, 7, 10, 14, 20, 30, 50, 70, 100, 140, 200];

/// Chains of one length and kind in the table.
const CHAINS: usize = 60;

const MAPS: [&str; 2] = ["E1M1", "E1M5"];

fn main() {
    println!(
        "{:<16} {:<4} {:>4} {:>6} | {:>9} {:>9} {:>7} | {:>9} {:>9} {:>7} | {:>7}",
        "chains",
        "",
        "len",
        "n",
        "LP yes/no",
        "exact",
        "ratio",
        "LP answer",
        "exact",
        "ratio",
        "+1"
    );
    let mut least = f64::INFINITY;
    let mut at_ten = Vec::new();
    let mut show = |name: &str, vertices: &Vertices, sets: &Sets| {
        for (length, [open, shut]) in LENGTHS.iter().zip(sets) {
            for (state, chains) in [("open", open), ("shut", shut)] {
                if chains.len() < 5 {
                    continue;
                }
                let row = measure(vertices, chains, state == "open");
                println!(
                    "{name:<16} {state:<4} {length:>4} {:>6} | {} | {} | {:>7.4}",
                    chains.len(),
                    pair(row.test),
                    pair(row.answer),
                    row.step,
                );
                let ratio = row.test[0] / row.test[1];
                least = least.min(ratio).min(row.answer[0] / row.answer[1]);
                if *length == 10 {
                    at_ten.push(ratio);
                }
            }
        }
    };
    for map in MAPS {
        let Some(graph) = load(map) else { continue };
        show(map, &graph.vertices, &drawn(&graph));
    }
    for off_grid in [false, true] {
        let (vertices, sets) = made_up(off_grid);
        let name = ["made up on grid", "made up off grid"][usize::from(off_grid)];
        show(name, &vertices, &sets);
    }
    at_ten.sort_by(f64::total_cmp);
    println!(
        "\nexact against LP, yes/no: {:.0} times faster at length 10 (median of the kinds above; least \
         {:.0}), and at least {least:.1} times at any length, test or answer",
        at_ten[at_ten.len() / 2],
        at_ten[0],
    );
    assert!(least > 1.0, "the exact solver is never slower");
    assert!(
        at_ten[at_ten.len() / 2] > 100.0,
        "the exact solver is a hundred times faster at length 10"
    );
}

/// Open and shut chains of each of [`LENGTHS`].
type Sets = Vec<[Vec<Vec<Gate>>; 2]>;

fn load(map: &str) -> Option<CellGraph> {
    let path = Path::new("/usr/share/games/doom/freedoom1.wad");
    let Ok(bytes) = std::fs::read(path) else {
        eprintln!(
            "left out {map}: {} is not there (apt-get install freedoom)",
            path.display()
        );
        return None;
    };
    let wad = Wad::parse(bytes).expect("the WAD is sound");
    let draft = doom::read_map(&wad, map, "freedoom1.wad").expect("the map reads");
    let level = snap::snap(draft).expect("it fits");
    Some(subdivide(&level, &Options::default()))
}

/// Chains of a search from every cell: of those of one length, an even choice.
fn drawn(graph: &CellGraph) -> Sets {
    let mut draw = Draw {
        graph,
        random: Pcg64::seed_from_u64(1),
        met: LENGTHS.map(|_| [0; 2]),
        sets: LENGTHS.map(|_| [Vec::new(), Vec::new()]).into(),
    };
    for source in graph.cell_ids() {
        let mut chain = Chain::new(&graph.vertices);
        draw.walk(&mut chain, source, source);
    }
    draw.sets
}

struct Draw<'a> {
    graph: &'a CellGraph,
    random: Pcg64,
    met: [[u64; 2]; 13],
    sets: Sets,
}

impl Draw<'_> {
    fn walk(&mut self, chain: &mut Chain, cell: CellId, from: CellId) {
        let mut right = self.graph.corners(cell).next().expect("cells have corners");
        for e in self.graph.edge_range(cell) {
            let edge = self.graph.edges[e as usize];
            let left = self.graph.end(enfilade::cells::EdgeId(e));
            let gate = Gate { left, right };
            right = left;
            let Some(next) = edge.twin().map(|t| self.graph.edge(t).cell) else {
                continue;
            };
            if next == from {
                continue;
            }
            let open = chain.push(gate);
            if !open {
                self.keep(chain.gates(), Some(gate), 1);
                continue;
            }
            self.keep(chain.gates(), None, 0);
            self.walk(chain, next, cell);
            chain.pop();
        }
    }

    /// Puts a chain among the kept ones of its length with the right probability.
    fn keep(&mut self, chain: &[Gate], more: Option<Gate>, state: usize) {
        let length = chain.len() + usize::from(more.is_some());
        let Ok(i) = LENGTHS.binary_search(&length) else {
            return;
        };
        self.met[i][state] += 1;
        let kept = &mut self.sets[i][state];
        let place = if kept.len() < CHAINS {
            kept.push(Vec::new());
            kept.len() - 1
        } else {
            self.random.random_range(0..self.met[i][state]) as usize
        };
        if let Some(kept) = kept.get_mut(place) {
            *kept = chain.iter().copied().chain(more).collect();
        }
    }
}

/// Doorways across a line through the level, of random width; in a shut chain, the last one lies
/// beside what the others let through.
fn made_up(off_grid: bool) -> (Vertices, Sets) {
    let mut random = Pcg64::seed_from_u64(2);
    let mut list: Vec<Vertex> = Vec::new();
    let mut sets = Sets::new();
    for n in LENGTHS {
        let mut both = [Vec::new(), Vec::new()];
        for (state, chains) in both.iter_mut().enumerate() {
            for _ in 0..CHAINS {
                let (run, rise) = (4096 / n as i64 + 1, random.random_range(-40..=40));
                let mut chain = Vec::new();
                for i in 0..n as i64 {
                    let (x, y) = (i * run, i * rise);
                    let beside = state == 1 && i + 1 == n as i64;
                    let mut put = |above: i64| {
                        let y = y + above + if beside { 9000 } else { 0 };
                        let [dx, dy] = std::array::from_fn(|_| random.random_range(1..1001));
                        let off = |n: i64, part: i128| i128::from(n) * 1009 + part;
                        list.push(if off_grid {
                            Vertex::homogeneous(off(x, dx), off(y, dy), 1009).expect("w is not 0")
                        } else {
                            GridPoint::new(x, y).into()
                        });
                        VertexId(list.len() as u32 - 1)
                    };
                    let width = 8 + (i * 7919 + rise).rem_euclid(89);
                    let (left, right) = (put(width), put(-width));
                    chain.push(Gate { left, right });
                }
                chains.push(chain);
            }
        }
        sets.push(both);
    }
    (Vertices::new(list), sets)
}

/// Microseconds by the LP and by the exact solver.
struct Row {
    test: [f64; 2],
    answer: [f64; 2],
    step: f64,
}

fn measure(vertices: &Vertices, chains: &[Vec<Gate>], open: bool) -> Row {
    let mut room = Funnel::default();
    for chain in chains {
        // On two gates in one cell, "beside" is no hindrance.
        let stabbed = exact::is_stabbed(vertices, chain, &mut room);
        assert!(stabbed == open || chain.len() == 2);
        let line = matches!(exact::stab(vertices, chain), Stabbing::Line(_));
        assert_eq!(line, stabbed);
    }
    let per_chain = |f: &mut dyn FnMut(&[Gate])| {
        let times = chains.iter().map(|chain| median(|| f(chain)));
        middle(times.collect())
    };
    let test = [
        per_chain(&mut |c| _ = black_box(lp::margin(vertices, c))),
        per_chain(&mut |c| _ = black_box(exact::is_stabbed(vertices, c, &mut room))),
    ];
    let answer = [
        per_chain(&mut |c| drop(black_box(lp::stab(vertices, c)))),
        per_chain(&mut |c| drop(black_box(exact::stab(vertices, c)))),
    ];
    let steps = chains.iter().map(|chain| {
        let (last, before) = chain.split_last().expect("no chain is empty");
        let mut chain = Chain::new(vertices);
        for gate in before {
            chain.push(*gate);
        }
        median(|| {
            if chain.push(*last) {
                chain.pop();
            }
        })
    });
    let step = middle(steps.collect());
    Row { test, answer, step }
}

fn pair([lp, exact]: [f64; 2]) -> String {
    format!("{lp:>9.2} {exact:>9.3} {:>7.1}", lp / exact)
}

/// Microseconds of one run, the median of a few repeats long enough to be timed.
fn median(mut run: impl FnMut()) -> f64 {
    let mut runs = 1u32;
    let mut times = Vec::new();
    while times.len() < 7 {
        let start = Instant::now();
        (0..runs).for_each(|_| run());
        let seconds = start.elapsed().as_secs_f64();
        if seconds < 2e-5 && runs < 1 << 16 {
            runs *= 2;
            times.clear();
            continue;
        }
        times.push(seconds * 1e6 / f64::from(runs));
    }
    middle(times)
}

fn middle(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
