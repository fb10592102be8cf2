//! Everything that is connected through portals.
//!
//! A sightline leads from cell to cell through portals, so what no walk through portals reaches is
//! hidden. That is all this method knows: the coarsest conservative answer, and the cheapest.

use rayon::prelude::*;

use super::{BitMatrix, Class, Method, Progress, Pvs};
use crate::cells::{CellGraph, CellId, EdgeId};

/// The PVS in which a cell sees every cell that a walk through portals reaches. Uses the current
/// rayon thread pool; the result does not depend on its size.
pub fn flood(graph: &CellGraph, progress: &Progress) -> Pvs {
    let n = graph.cells.len();
    progress.begin(n);
    let component = components(graph);
    let n_components = component.iter().max().map_or(0, |&c| c as usize + 1);
    // One row for each component, which all of its cells share.
    let mut rows = vec![vec![0u64; n.div_ceil(64)]; n_components];
    for (cell, &c) in component.iter().enumerate() {
        rows[c as usize][cell / 64] |= 1 << (cell % 64);
    }
    let mut visible = BitMatrix::new(n);
    let filled = visible.par_rows_mut().zip(&component);
    filled.for_each(|(row, &c)| {
        row.copy_from_slice(&rows[c as usize]);
        progress.advance(1);
    });
    Pvs {
        visible,
        method: Method::Flood,
        class: Class::Conservative,
        heights: false,
        undecided: 0,
        steps: n as u64,
    }
}

/// For every cell the number of its component, in the order of the components' first cells.
pub fn components(graph: &CellGraph) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let mut component = vec![NONE; graph.cells.len()];
    let mut n_components = 0;
    let mut open: Vec<CellId> = Vec::new();
    for start in graph.cell_ids() {
        if component[start.0 as usize] != NONE {
            continue;
        }
        component[start.0 as usize] = n_components;
        open.push(start);
        while let Some(cell) = open.pop() {
            let twins = graph.edge_range(cell).map(EdgeId);
            for twin in twins.filter_map(|e| graph.edge(e).twin()) {
                let next = graph.edge(twin).cell;
                if component[next.0 as usize] == NONE {
                    component[next.0 as usize] = n_components;
                    open.push(next);
                }
            }
        }
        n_components += 1;
    }
    component
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::{Options, subdivide};
    use crate::level::read::read;

    #[test]
    fn what_is_connected_sees_each_other() {
        // Two pairs of rooms; nothing joins the pairs.
        let text = "[[room]]\nname = \"A\"\nrect = [0, 0, 4, 4]\n\
            [[room]]\nname = \"B\"\nrect = [4, 0, 8, 4]\n\
            [[room]]\nname = \"C\"\nrect = [0, 4, 4, 8]\n\
            [[room]]\nname = \"D\"\nrect = [4, 4, 8, 8]\n\
            [[door]]\nbetween = [\"A\", \"B\"]\nwidth = 1\n\
            [[door]]\nbetween = [\"C\", \"D\"]\nwidth = 1\n";
        let level = read(text.into(), "rooms.toml", None).unwrap();
        let graph = subdivide(&level, &Options::default());
        let pvs = flood(&graph, &Progress::default());
        pvs.validate(&graph).unwrap();
        assert_eq!((pvs.pairs(), graph.cells.len()), (8, 4));
        let sector = |cell| graph.cell(cell).sector.unwrap().0;
        for a in graph.cell_ids() {
            for b in graph.cell_ids() {
                assert_eq!(pvs.sees(a, b), sector(a) / 2 == sector(b) / 2);
            }
        }
    }
}
