//! Explanations of what is seen and what is not.

use std::time::Instant;

use enfilade::cells::{CellId, Options, Subdivision, subdivide};
use enfilade::level::{doom, snap, wad::Wad};
use enfilade::pvs::explain::{Corner, ExplainOptions, Explanation, corner_at, explain};
use enfilade::pvs::{Progress, sweep::sweep};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

#[test]
fn stats() {
    for (file, map) in [("freedoom1.wad", "E1M1"), ("freedoom2.wad", "MAP12")] {
        let bytes = std::fs::read(format!("/usr/share/games/doom/{file}")).unwrap();
        let wad = Wad::parse(bytes).unwrap();
        let level = snap::snap(doom::read_map(&wad, map, file).unwrap()).unwrap();
        for subdivision in Subdivision::ALL {
            let graph = subdivide(
                &level,
                &Options {
                    subdivision,
                    ..Options::default()
                },
            );
            let pvs = sweep(&graph, &Progress::default());
            let mut random = Pcg64::seed_from_u64(1);
            let n = graph.cells.len() as u32;
            let (mut seen, mut hidden, mut steps) = (Vec::new(), Vec::new(), Vec::new());
            let (mut incomplete, mut fail, mut apart, mut long) = (0, 0, 0, 0);
            let mut kinds = [0usize; 3];
            let mut hkinds = [0usize; 4];
            let mut grid = 0;
            while seen.len() < 60 || hidden.len() < 30 {
                let [a, b] = [0, 0].map(|_| CellId(random.random_range(0..n)));
                let sees = pvs.sees(a, b);
                if a == b || (sees && seen.len() >= 60) || (!sees && hidden.len() >= 30) {
                    continue;
                }
                let start = Instant::now();
                let e = explain(&graph, &pvs, a, b, &ExplainOptions::default());
                let t = start.elapsed().as_secs_f64() * 1e3;
                if t > 50.0 {
                    if let Some(Explanation::Visible(v)) = &e {
                        println!(
                            "{a:?} {b:?} {t} steps {} complete {} portals {}",
                            v.steps,
                            v.complete,
                            v.portals.len()
                        )
                    } else {
                        println!("{a:?} {b:?} {t} {sees}")
                    }
                }
                match e {
                    None => {
                        fail += 1;
                        println!("no answer {a:?} {b:?} {sees}");
                        if fail > 5 {
                            panic!()
                        }
                    }
                    Some(Explanation::Visible(v)) => {
                        assert!(sees);
                        seen.push(t);
                        steps.push(v.steps as f64);
                        incomplete += usize::from(!v.complete);
                        grid += usize::from(v.segment.from.grid().is_some());
                        let of = |id| {
                            let base = (0..graph.edges.len() as u32)
                                .map(enfilade::cells::EdgeId)
                                .filter(|&e| graph.edge(e).origin == id);
                            let mut k = Corner::Open;
                            for base in base {
                                match corner_at(&graph, base) {
                                    Corner::Jutting => k = Corner::Jutting,
                                    Corner::Flat if k == Corner::Open => k = Corner::Flat,
                                    _ => {}
                                }
                            }
                            k
                        };
                        let both = [v.strip.left.clone(), v.strip.right.clone()].concat();
                        let worst = both
                            .iter()
                            .map(|&id| match of(id) {
                                Corner::Jutting => 0,
                                Corner::Flat => 1,
                                Corner::Open => 2,
                            })
                            .max()
                            .unwrap();
                        kinds[worst] += 1;
                    }
                    Some(Explanation::Hidden(h)) => {
                        hidden.push(t);
                        long += h.way.bends.len();
                        let all = [h.ends.left.to_vec(), h.ends.right.to_vec()].concat();
                        hkinds[if all
                            .iter()
                            .all(|&v| !enfilade::pvs::explain::edges_at(&graph, v).is_empty())
                        {
                            0
                        } else {
                            1
                        }] += 1;
                        let gates =
                            enfilade::pvs::explain::gates(&graph, &h.way.portals[..=h.stop]);
                        assert!(h.ends.holds(&graph.vertices, &gates));
                    }
                    Some(Explanation::Apart) => {
                        apart += 1;
                        if apart > 100 {
                            break;
                        }
                    }
                    Some(Explanation::Same) => {}
                }
            }
            let stat = |l: &mut Vec<f64>| {
                l.sort_by(f64::total_cmp);
                let n = l.len().max(1);
                format!(
                    "median {:.3} 99% {:.3} worst {:.3}",
                    l[n / 2],
                    l[n * 99 / 100],
                    l[n - 1]
                )
            };
            println!(
                "{map} {} cells {n}: visible {} ms; hidden {} ms; steps {}",
                subdivision.as_str(),
                stat(&mut seen),
                stat(&mut hidden),
                stat(&mut steps)
            );
            println!(
                "   incomplete {incomplete} apart {apart} kinds {kinds:?} hidden {hkinds:?} bends {long} grid {grid}"
            );
        }
    }
}
