//! The portal file of the Quake tools, format PRT1.
//!
//! A text: `PRT1`, the number of leaves, the number of portals, each on a line; then a line for each
//! portal: `<points> <leaf A> <leaf B> (x y z) (x y z) …`. The points p0, p1, … go around the
//! portal such that (p0 − p1) × (p2 − p1) points into leaf A.

use std::io::{self, Write};

use crate::cells::CellGraph;

/// Writes the portals of a graph; leaves are its cells. A portal is an upright rectangle from the
/// lower to the upper end of its opening at its widest (moving floors, ceilings and doors out of the
/// way), in the level's own coordinates; from 0 to 1 where the level has no heights. Portals that
/// never open are left out. Returns how many were written.
///
/// # Errors
/// Those of `out`.
pub fn write(mut out: impl Write, graph: &CellGraph) -> io::Result<usize> {
    let open: Vec<_> = graph
        .portals
        .iter()
        .map(|portal| (portal, portal.widest.unwrap_or((0.0, 1.0))))
        .filter(|(_, (bottom, top))| bottom < top)
        .collect();
    writeln!(out, "PRT1\n{}\n{}", graph.cells.len(), open.len())?;
    for &(portal, (bottom, top)) in &open {
        let [a, b] = graph.joined(portal);
        let edge = portal.edges[0];
        let ends = [graph.edge(edge).origin, graph.end(edge)];
        let [p, q] = ends.map(|v| graph.vertices.exact(v).to_level(&graph.grid));
        // Leaf A lies left of p → q: (p − q) × up points there.
        write!(out, "4 {} {}", a.0, b.0)?;
        for (at, z) in [(p, bottom), (q, bottom), (q, top), (p, top)] {
            write!(out, " ({} {} {} )", at.x, at.y, z)?;
        }
        writeln!(out)?;
    }
    Ok(open.len())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::cells::{Options, Subdivision, subdivide};
    use crate::level::toml;

    #[test]
    fn normals_point_into_the_first_leaf() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/levels/house.toml");
        let level = toml::read(&std::fs::read_to_string(path).unwrap(), "house.toml").unwrap();
        for subdivision in Subdivision::ALL {
            let graph = subdivide(
                &level,
                &Options {
                    subdivision,
                    ..Options::default()
                },
            );
            let mut bytes = Vec::new();
            let n = write(&mut bytes, &graph).unwrap();
            let text = String::from_utf8(bytes).unwrap();
            let mut lines = text.lines();
            assert_eq!(lines.next(), Some("PRT1"));
            assert_eq!(lines.next(), Some(&*graph.cells.len().to_string()));
            assert_eq!(lines.next(), Some(&*n.to_string()));
            let centre = |cell: usize| {
                let id = crate::cells::CellId(cell as u32);
                let corners: Vec<_> = graph.corners(id).collect();
                let at = |&v| graph.vertices.exact(v).to_level(&graph.grid);
                corners.iter().map(at).sum::<glam::DVec2>() / corners.len() as f64
            };
            assert!(n > 0 && lines.clone().count() == n);
            for line in lines {
                let numbers: Vec<f64> = line
                    .split(|c: char| c.is_whitespace() || "()".contains(c))
                    .filter(|word| !word.is_empty())
                    .map(|word| word.parse().unwrap())
                    .collect();
                assert_eq!((numbers[0], numbers.len()), (4.0, 15));
                let p: Vec<DVec3> = numbers[3..].chunks(3).map(DVec3::from_slice).collect();
                let normal = (p[0] - p[1]).cross(p[2] - p[1]).truncate();
                let (a, b) = (centre(numbers[1] as usize), centre(numbers[2] as usize));
                assert!(normal.dot(a - p[0].truncate()) > 0.0, "{line}");
                assert!(normal.dot(b - p[0].truncate()) < 0.0, "{line}");
            }
        }
    }
}
