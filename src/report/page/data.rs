//! The data in the page: facts as JSON, and arrays of numbers, deflated, in base 64.
//!
//! The arrays, one after the other, little-endian: `vertices` (f64, x and y of each vertex in the level's
//! coordinates) and `sight` (f64, of each cell both ends of its longest sightline), then as u32 `first` (of each cell its first edge, and one past the last), `origin` (of
//! each edge, the vertex in which it starts), `twin` (the same edge of the cell beyond, all ones for a
//! wall), `room` (of each cell); as f32 the measures, cell after cell, in the order in which the facts
//! name them; `growth` (f32, only with a baseline; NaN for new ground); and last the visible sets as
//! bits: row i has the ⌈i/8⌉ bytes of the cells before i, the least bit first.

use std::io::Write;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::{Value, json};

use super::Report;
use super::plan::Sheet;
use crate::cells::EdgeId;
use crate::report::wording;

/// What the script is told by name.
pub fn facts(report: &Report, sheet: &Sheet) -> String {
    let costs = report.costs;
    let measures = costs.measures().into_iter().map(|m| {
        json!({
            "key": m.key(), "title": m.title(), "whole": m.is_count(), "unit": super::plan::unit_of(costs, m),
            "steps": super::plan::steps(costs, m),
        })
    });
    let gaps = costs.gaps.iter().map(
        |g| json!({ "title": g.title, "segment": g.segment, "cells": g.cells, "share": g.share }),
    );
    let lanes = costs.lanes.iter().map(|l| json!([l.from, l.to]));
    let walks = report.reveals.iter().map(|r| &r.line);
    let value = json!({
        "cells": costs.graph.cells.len(),
        "edges": costs.graph.edges.len(),
        "vertices": costs.graph.vertices.len(),
        "unit": wording::unit(costs.level),
        "step": costs.graph.grid.step.length(),
        "scale": sheet.scale,
        "corner": sheet.corner.to_array(),
        "size": sheet.size.to_array(),
        "rooms": costs.rooms.list.iter().map(|r| &r.name).collect::<Vec<_>>(),
        "measures": measures.collect::<Vec<Value>>(),
        "growth": report.comparison.map(super::plan::growth_steps),
        "gaps": gaps.collect::<Vec<Value>>(),
        "lanes": lanes.collect::<Vec<Value>>(),
        "walks": walks.collect::<Vec<_>>(),
    });
    // Inside of a script nothing is escaped, but `</script` ends it.
    value.to_string().replace('<', "\\u003c")
}

/// The arrays.
pub fn packed(report: &Report) -> String {
    let costs = report.costs;
    let graph = costs.graph;
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::new(4));
    let mut put = |bytes: &[u8]| {
        // A vector takes everything.
        _ = zlib.write_all(bytes);
    };
    let vertices = graph.vertices.iter().map(|v| v.to_level(&graph.grid));
    let vertices: Vec<f64> = vertices.flat_map(|p| p.to_array()).collect();
    put(&bytes(&vertices, f64::to_le_bytes));
    let sight = graph.cell_ids().flat_map(|c| {
        let ends = costs.sightline(c).map(|l| [l.from, l.to]);
        let at = |p: glam::DVec2| graph.grid.offset_to_level(p.x, p.y).to_array();
        ends.map_or([[0.0; 2]; 2], |ends| ends.map(at)).concat()
    });
    put(&bytes(&sight.collect::<Vec<f64>>(), f64::to_le_bytes));
    let first = graph.cell_ids().map(|c| graph.edge_range(c).start);
    let first: Vec<u32> = first.chain([graph.edges.len() as u32]).collect();
    let edges = || (0..graph.edges.len() as u32).map(|e| graph.edge(EdgeId(e)));
    let origin: Vec<u32> = edges().map(|e| e.origin.0).collect();
    let twin = edges().map(|e| e.twin().map_or(u32::MAX, |t| t.0));
    for list in [&first, &origin, &twin.collect(), &costs.rooms.of_cell] {
        put(&bytes(list, u32::to_le_bytes));
    }
    for measure in costs.measures() {
        let values = graph.cell_ids().map(|c| costs.value(measure, c) as f32);
        put(&bytes(&values.collect::<Vec<f32>>(), f32::to_le_bytes));
    }
    if let Some(comparison) = report.comparison {
        let growth = comparison.growth.iter();
        let growth: Vec<f32> = growth.map(|g| g.map_or(f32::NAN, |g| g as f32)).collect();
        put(&bytes(&growth, f32::to_le_bytes));
    }
    for i in 0..graph.cells.len() {
        let row = bytes(costs.pvs.visible.row(i), u64::to_le_bytes);
        let n = i.div_ceil(8);
        put(&row[..n]);
    }
    BASE64_STANDARD.encode(zlib.finish().unwrap_or_default())
}

fn bytes<T: Copy, const N: usize>(values: &[T], to: impl Fn(T) -> [u8; N]) -> Vec<u8> {
    values.iter().flat_map(|&x| to(x)).collect()
}
