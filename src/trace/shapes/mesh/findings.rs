//! What is odd about a mesh.

use rustc_hash::FxHashMap;

use super::Points;

/// Oddities of a mesh. None is an error: a leaf has open edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Findings {
    /// Edges of one triangle only: through them one sees the inside.
    pub open: usize,
    /// Edges of two triangles that pass it in the same direction: one of them is inside out, and rays
    /// that start next to the edge may go wrong.
    pub turned: usize,
    /// Edges of more than two triangles.
    pub crowded: usize,
    /// Triangles without area. No ray meets them.
    pub flat: usize,
}

impl Findings {
    /// Looks for them. Points at the same place count as one, since files repeat a point for each
    /// normal that it has.
    pub fn of(points: &Points) -> Self {
        let mut numbers: FxHashMap<[u64; 3], u32> = FxHashMap::default();
        let mut number = |i: u32| {
            let place = points.places[i as usize].to_array();
            // 0 and -0 are the same place.
            let next = numbers.len() as u32;
            *numbers
                .entry(place.map(|x| (x + 0.0).to_bits()))
                .or_insert(next)
        };
        // How often each edge is passed upwards and downwards, by the numbers of its ends.
        let mut edges: FxHashMap<(u32, u32), [usize; 2]> = FxHashMap::default();
        let mut findings = Self::default();
        for (triangle, ends) in (0..).zip(&points.triangles) {
            let [a, b, c] = points.corners(triangle);
            if (b - a).cross(c - a) == glam::DVec3::ZERO {
                findings.flat += 1;
            }
            let ends = ends.map(&mut number);
            for k in 0..3 {
                let (from, to) = (ends[k], ends[(k + 1) % 3]);
                if from != to {
                    let edge = edges.entry((from.min(to), from.max(to))).or_default();
                    edge[usize::from(from > to)] += 1;
                }
            }
        }
        for [up, down] in edges.into_values() {
            match up + down {
                1 => findings.open += 1,
                2 if up != down => findings.turned += 1,
                2 => {}
                _ => findings.crowded += 1,
            }
        }
        findings
    }

    /// Whether the mesh has an inside and an outside.
    pub fn is_closed(&self) -> bool {
        self.open == 0 && self.turned == 0 && self.crowded == 0
    }
}
