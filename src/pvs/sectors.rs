//! Which sectors see which, from the cells' visible sets; and the REJECT table of Doom maps.
//!
//! A sector sees another if any cell of the one sees any cell of the other. Ground for which the
//! level's walls name several sectors ([`Cell::also`](crate::cells::Cell)) counts for all of them:
//! another program may take any. A sector without cells sees everything, for the same reason.

use super::BitMatrix;
use super::Pvs;
use crate::cells::CellGraph;

/// The relation between sectors: bit j of row i says that sector i sees sector j, of `n_sectors` in
/// all (as many as the level has). Symmetric where the visible sets are; every sector sees itself.
pub fn sectors(n_sectors: usize, graph: &CellGraph, pvs: &Pvs) -> BitMatrix {
    groups(n_sectors, pvs, |cell| {
        let cell = &graph.cells[cell];
        cell.sector.iter().chain(&cell.also).map(|sector| sector.0)
    })
}

/// The relation between groups of cells, of which each cell may be in several: bit j of row i says that
/// some cell of group i sees one of group j. Every group sees itself; one without cells sees, and is
/// seen by, every other. Numbers that are not below `n` count for nothing.
pub(super) fn groups<I>(n: usize, pvs: &Pvs, of: impl Fn(usize) -> I) -> BitMatrix
where
    I: Iterator<Item = u32>,
{
    let mut cells_of: Vec<Vec<usize>> = vec![Vec::new(); n];
    for cell in 0..pvs.visible.n() {
        for group in of(cell) {
            if let Some(cells) = cells_of.get_mut(group as usize) {
                cells.push(cell);
            }
        }
    }
    let mut result = BitMatrix::new(n);
    let mut seen = vec![0u64; pvs.visible.stride()];
    for (group, cells) in cells_of.iter().enumerate() {
        result.set(group, group);
        if cells.is_empty() {
            for other in 0..n {
                result.set(group, other);
                result.set(other, group);
            }
            continue;
        }
        seen.fill(0);
        for &cell in cells {
            for (word, more) in seen.iter_mut().zip(pvs.visible.row(cell)) {
                *word |= more;
            }
        }
        for cell in super::ones(&seen) {
            for other in of(cell).filter(|&other| (other as usize) < n) {
                result.set(group, other as usize);
            }
        }
    }
    result
}

/// The REJECT lump of this relation between n sectors: bit s1·n + s2 (least significant bit of each
/// byte first, rows not padded) is 1 where s1 does not see s2; ⌈n²/8⌉ bytes, the bits past n² are 0.
pub fn reject(sees: &BitMatrix) -> Vec<u8> {
    let n = sees.n();
    let bits = n * n;
    let mut lump = vec![0xff; bits.div_ceil(8)];
    if let Some(last) = lump.last_mut().filter(|_| !bits.is_multiple_of(8)) {
        *last = (1 << (bits % 8)) - 1;
    }
    for i in 0..n {
        for j in sees.ones(i) {
            let bit = i * n + j;
            lump[bit / 8] &= !(1 << (bit % 8));
        }
    }
    lump
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;
    use crate::cells::{Locator, Options, Subdivision, subdivide};
    use crate::geom::{GridPoint, Side, orient};
    use crate::level::{Level, WallKind, doom, snap, toml, wad};
    use crate::pvs::{Progress, sweep};

    #[test]
    fn the_bits_of_a_reject() {
        // Three sectors in a row, the first and the last hidden from each other.
        let mut sees = BitMatrix::new(3);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1), (1, 2), (2, 1), (2, 2)] {
            sees.set(i, j);
        }
        // Bits 0·3 + 2 = 2 and 2·3 + 0 = 6; bit 8 is 0, and what follows it is padding.
        assert_eq!(reject(&sees), [0b0100_0100, 0]);
        assert!(reject(&BitMatrix::new(0)).is_empty());
        assert_eq!(reject(&BitMatrix::new(4)), [0xff, 0xff]);
    }

    #[test]
    fn rooms_around_a_corner() {
        let text = r#"
            [[room]]
            name = "A"
            rect = [0, 0, 4, 4]
            [[room]]
            name = "B"
            rect = [4, 0, 8, 4]
            [[room]]
            name = "C"
            rect = [4, 4, 8, 8]
            [[door]]
            between = ["A", "B"]
            width = 0.5
            [[door]]
            between = ["B", "C"]
            width = 0.5
        "#;
        let level = toml::read(text, "rooms.toml").unwrap();
        for subdivision in Subdivision::ALL {
            let graph = subdivide(
                &level,
                &Options {
                    subdivision,
                    ..Options::default()
                },
            );
            let pvs = sweep::sweep(&graph, &Progress::default());
            let sees = sectors(3, &graph, &pvs);
            assert!(sees.get(0, 1) && sees.get(1, 2) && sees.get(1, 1));
            assert!(sees.is_symmetric());
            // From door to door: (4, 1.75…2.25) to (5.75…6.25, 4) lies free in B, so A sees C.
            assert!(sees.get(0, 2));
            // A sector that no cell lies in.
            let sees = sectors(4, &graph, &pvs);
            assert!((0..4).all(|i| sees.get(3, i) && sees.get(i, 3)));
        }
    }

    fn touches(a: GridPoint, b: GridPoint, c: GridPoint, d: GridPoint) -> bool {
        let [a, b, c, d] = [a, b, c, d].map(Into::into);
        let (p, q) = (orient(&a, &b, &c), orient(&a, &b, &d));
        let (r, s) = (orient(&c, &d, &a), orient(&c, &d, &b));
        // On one line counts as touching: stricter than need be.
        let apart = |p: Side, q: Side| p == q && p != Side::On;
        !apart(p, q) && !apart(r, s)
    }

    fn random_segments_are_never_rejected(level: &Level, subdivision: Subdivision, n: usize) {
        let graph = subdivide(
            level,
            &Options {
                subdivision,
                ..Options::default()
            },
        );
        let pvs = sweep::sweep(&graph, &Progress::default());
        let n_sectors = level.sectors.len();
        let lump = reject(&sectors(n_sectors, &graph, &pvs));
        let locator = Locator::new(&graph);
        let opaque: Vec<_> = level
            .walls
            .iter()
            .filter(|w| w.kind == WallKind::Solid)
            .collect();
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let corners: Vec<GridPoint> = graph.vertices.iter().filter_map(|v| v.grid()).collect();
        let mut free = 0;
        let mut point = || {
            // Beside a corner, where thin sightlines begin.
            let corner = corners[rng.random_range(0..corners.len())];
            let mut near = || rng.random_range(-9..=9);
            let p = GridPoint::new(corner.x + near(), corner.y + near());
            match locator.cells_at(&graph, &p.into())[..] {
                [cell] => Some((p, graph.cell(cell).sector?.0 as usize)),
                _ => None,
            }
        };
        for _ in 0..n {
            let (Some((p, from)), Some((q, to))) = (point(), point()) else {
                continue;
            };
            let bit = from * n_sectors + to;
            // Seen pairs need no proof here: only hidden ones are of interest.
            if lump[bit / 8] >> (bit % 8) & 1 == 0 {
                continue;
            }
            free += 1;
            assert!(
                opaque.iter().any(|w| touches(p, q, w.from, w.to)),
                "{}: sectors {from} and {to} see each other along {p:?} to {q:?}",
                level.name
            );
        }
        assert!(free > 100, "{}: {free}", level.name);
    }

    /// Needs the Debian package `freedoom`; does nothing without it.
    #[test]
    fn a_reject_never_hides_what_a_free_segment_joins() {
        let Ok(bytes) = std::fs::read("/usr/share/games/doom/freedoom1.wad") else {
            return;
        };
        let wad = wad::Wad::parse(bytes).unwrap();
        for map in ["E1M1", "E1M5", "E2M4"] {
            let draft = doom::read_map(&wad, map, "freedoom1.wad").unwrap();
            let level = snap::snap(draft).unwrap();
            let all: Vec<_> = Subdivision::ALL
                .map(|subdivision| {
                    let graph = subdivide(
                        &level,
                        &Options {
                            subdivision,
                            ..Options::default()
                        },
                    );
                    let pvs = sweep::sweep(&graph, &Progress::default());
                    sectors(level.sectors.len(), &graph, &pvs)
                })
                .into();
            assert_eq!(all[0], all[1], "{map}");
            assert_eq!(all[0], all[2], "{map}");
            random_segments_are_never_rejected(&level, Subdivision::Cdt, 20_000);
        }
    }
}
