//! The cells laid out for speed: what a ray asks of a cell, and nothing else.
//!
//! In: the cells and edges of a [`super::Space`]. Out: a [`Layout`] with the same numbers of cells
//! and edges. The corners of a cell stand eight by eight in two cache lines ([`Block`]), so that a ray
//! asks eight at once on which side it passes; the signs become bits of a mask, and the edge through
//! which the ray leaves is found by shifting ([`Turn`]). An edge keeps the heights between which a
//! ray goes on, and where ([`Gate`]). For rays without order all this stands once more in f32: what is
//! asked of every corner ([`Corner`]), and what is asked of the one edge through which a ray leaves, so
//! that a vector picks it by number ([`Plate`]). What they meet at last stands by edge ([`Face`], [`Kind`]).

use std::hint::select_unpredictable;

use glam::DVec2;

use super::space::{Border, Chamber, WALL};

/// Cells in a form that is quick to walk through.
#[derive(Clone, Debug)]
pub struct Layout {
    /// By cell.
    pub rooms: Vec<Room>,
    /// The corners: cell after cell, counterclockwise.
    pub blocks: Vec<Block>,
    /// By edge.
    pub gates: Vec<Gate>,
    /// The greatest coordinate of any corner.
    pub extent: f64,
    /// The greatest height of any gate, without infinite ones.
    pub rise: f64,
    /// Cell after cell, the corners of each twice over.
    pub corners: Vec<Corner>,
    /// Cell after cell.
    pub plates: Vec<Plate>,
    /// What a ray asks, by the edge through which it came; then by the cell in which it starts.
    pub asked: Vec<Asked>,
    /// By edge.
    pub faces: Vec<Face>,
    /// By edge.
    pub kinds: Vec<Kind>,
}

/// Where a cell's corners and edges are.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Its first block.
    pub block: u32,
    /// Its first edge.
    pub first: u32,
    /// How many corners, and edges, it has.
    pub n: u32,
}

/// Eight corners of a cell. Behind the last one the first is repeated.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Block {
    /// Their x.
    pub x: [f64; 8],
    /// Their y.
    pub y: [f64; 8],
}

/// What a ray meets at an edge.
#[derive(Clone, Copy, Debug)]
pub struct Gate {
    /// A ray goes on if it is not below this: the floor, or the opening's lower end; ∞ where
    /// something fills the edge.
    pub low: f64,
    /// Nor above this.
    pub high: f64,
    /// Into this cell.
    pub cell: u32,
    /// Through its edge with this place in it.
    pub entry: u32,
    /// The number of that edge; [`WALL`] where nothing lies beyond.
    pub twin: u32,
}

/// A corner, rounded.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Where it is.
    pub at: [f32; 2],
    /// The place in its cell of the edge from it.
    pub place: u32,
}

/// Eight edges of a cell, rounded. A last one that is not full begins again with the cell's first.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Plate {
    /// The x of their unit normals, out of the cell.
    pub nx: [f32; 8],
    /// The y of those.
    pub ny: [f32; 8],
    /// The product of those with a corner of the edge.
    pub offset: [f32; 8],
    /// As that of the [`Gate`].
    pub low: [f32; 8],
    /// As that of the [`Gate`].
    pub high: [f32; 8],
    /// As that of the [`Gate`].
    pub twin: [u32; 8],
}

/// What rays ask of a cell that came into it through the same edge, or start in it.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// The first of [`Layout::corners`] that they ask, and the one after the last, which is the end of
    /// the edge before.
    pub corners: [u32; 2],
    /// The cell's first of [`Layout::plates`], and the one after its last.
    pub plates: [u32; 2],
    /// The cell's first edge.
    pub edge: u32,
}

/// Where an edge stands, and the heights at which rays end that come to it: a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Face {
    /// Its start.
    pub from: [f64; 2],
    /// Its end.
    pub to: [f64; 2],
    /// Floor and ceiling of its cell.
    pub flats: [f64; 2],
    /// Lower and upper end of its opening.
    pub gap: [f64; 2],
}

/// What it is that rays meet at an edge.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Its cell.
    pub cell: u32,
    /// 1 if it is a wall, and 2 if it looks outside.
    pub sort: u32,
}

/// Stands for no entry: the ray starts in the cell.
pub const INSIDE: u32 = u32::MAX;

/// Cells with more corners are asked one corner at a time.
pub const MOST: u32 = 32;

impl Layout {
    /// Lays out cells and edges.
    pub fn new(vertices: &[DVec2], cells: &[Chamber], edges: &[Border]) -> Self {
        let mut blocks = Vec::new();
        let rooms = cells.iter().map(|cell| {
            let room = Room {
                block: blocks.len() as u32,
                first: cell.first,
                n: cell.past - cell.first,
            };
            for eight in 0..room.n.div_ceil(8) {
                let corner = |k: usize| {
                    let i = 8 * eight + k as u32;
                    let edge = room.first + if i < room.n { i } else { 0 };
                    vertices[edges[edge as usize].from as usize]
                };
                blocks.push(Block {
                    x: std::array::from_fn(|k| corner(k).x),
                    y: std::array::from_fn(|k| corner(k).y),
                });
            }
            room
        });
        let rooms: Vec<Room> = rooms.collect();
        let gates = edges.iter().map(|edge| {
            let own = &cells[edge.cell as usize];
            if edge.twin == WALL {
                return Gate {
                    low: f64::INFINITY,
                    high: own.ceiling,
                    cell: edge.cell,
                    entry: INSIDE,
                    twin: WALL,
                };
            }
            let beyond = edges[edge.twin as usize].cell;
            Gate {
                low: if edge.pane.is_some() {
                    f64::INFINITY
                } else {
                    own.floor.max(edge.bottom)
                },
                high: own.ceiling.min(edge.top),
                cell: beyond,
                entry: edge.twin - cells[beyond as usize].first,
                twin: edge.twin,
            }
        });
        let gates: Vec<Gate> = gates.collect();
        let heights = gates.iter().flat_map(|gate| [gate.low, gate.high]);
        let rise = heights
            .filter(|z| z.is_finite())
            .fold(0.0, |most: f64, z| most.max(z.abs()));
        let faces = edges.iter().map(|edge| {
            let own = &cells[edge.cell as usize];
            Face {
                from: vertices[edge.from as usize].to_array(),
                to: vertices[edge.to as usize].to_array(),
                flats: [own.floor, own.ceiling],
                gap: [edge.bottom, edge.top],
            }
        });
        let faces = faces.collect();
        let kinds = edges.iter().map(|edge| Kind {
            cell: edge.cell,
            sort: u32::from(edge.twin == WALL) | u32::from(edge.outside) << 1,
        });
        let kinds = kinds.collect();
        let (mut corners, mut plates) = (Vec::with_capacity(2 * edges.len()), Vec::new());
        let none = Asked {
            corners: [0; 2],
            plates: [0; 2],
            edge: 0,
        };
        let mut asked = vec![none; edges.len() + cells.len()];
        for (room, id) in rooms.iter().zip(edges.len()..) {
            let (base, plate, n) = (corners.len() as u32, plates.len() as u32, room.n);
            corners.extend((0..n).chain(0..n).map(|place| {
                let from = edges[(room.first + place) as usize].from;
                let at = vertices[from as usize].as_vec2().to_array();
                Corner { at, place }
            }));
            for eight in 0..n.div_ceil(8) {
                let own = std::array::from_fn(|k| room.first + (8 * eight + k as u32) % n);
                plates.push(Plate::new(vertices, edges, &gates, own));
            }
            let those = |corners| Asked {
                corners,
                plates: [plate, plates.len() as u32],
                edge: room.first,
            };
            for k in 0..n {
                asked[(room.first + k) as usize] = those([base + k + 1, base + k + 1 + n]);
            }
            asked[id] = those([base, base + n + 1]);
        }
        Self {
            rooms,
            blocks,
            gates,
            rise,
            corners,
            plates,
            asked,
            faces,
            kinds,
            extent: vertices
                .iter()
                .fold(0.0, |most, v| v.abs().max_element().max(most)),
        }
    }

    /// A cell's place.
    #[inline]
    pub fn room(&self, cell: u32) -> Room {
        self.rooms[cell as usize]
    }

    /// A cell's blocks.
    #[inline]
    pub fn blocks(&self, room: Room) -> &[Block] {
        &self.blocks[room.block as usize..][..room.n.div_ceil(8) as usize]
    }

    /// A corner of a cell, counted from 0.
    #[inline]
    pub fn corner(&self, room: Room, k: u32) -> DVec2 {
        let block = &self.blocks[(room.block + k / 8) as usize];
        let k = (k % 8) as usize;
        DVec2::new(block.x[k], block.y[k])
    }

    /// The edge of a cell, counted from 0.
    #[inline]
    pub fn gate(&self, room: Room, edge: u32) -> &Gate {
        &self.gates[(room.first + edge) as usize]
    }
}

/// The order in which a ray asks the corners of a cell of at most [`MOST`]: those behind the edge
/// through which it came first. Masks have a bit for each corner.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    by: u32,
    n: u32,
    /// How many edges may be the exit.
    exits: u32,
}

impl Turn {
    /// For a ray that came through this edge, or [`INSIDE`].
    #[inline]
    pub fn new(n: u32, entry: u32) -> Self {
        let by = entry.wrapping_add(1);
        let exits = n - u32::from(by != 0);
        Self { by, n, exits }
    }

    /// The mask, its lowest bit for the corner that is asked first; the bit after the last is that
    /// of the first again.
    #[inline]
    pub fn of(self, mask: u64) -> u64 {
        let own = mask & ((1 << self.n) - 1);
        let twice = own | (own << self.n);
        twice >> self.by
    }

    /// Turned masks of corners on the right and on the left: the edge, in this order, that is the
    /// first to lead from right to left; if there is none, some other, and false.
    #[inline]
    pub fn exit(self, right: u64, left: u64) -> (u32, bool) {
        let none = 1 << self.exits;
        let exits = right & (left >> 1) & (none - 1);
        ((exits | none).trailing_zeros(), exits != 0)
    }

    /// The edge's place in its cell.
    #[inline]
    pub fn back(self, edge: u32) -> u32 {
        let at = edge + self.by;
        select_unpredictable(at >= self.n, at.wrapping_sub(self.n), at)
    }
}

impl Plate {
    /// Of these edges.
    fn new(vertices: &[DVec2], edges: &[Border], gates: &[Gate], own: [u32; 8]) -> Self {
        let normals = own.map(|e| {
            let edge = &edges[e as usize];
            let (a, b) = (vertices[edge.from as usize], vertices[edge.to as usize]);
            let normal = -(b - a).normalize().perp();
            (normal.as_vec2(), normal.dot(a) as f32)
        });
        let gates = own.map(|e| &gates[e as usize]);
        Self {
            nx: normals.map(|(normal, _)| normal.x),
            ny: normals.map(|(normal, _)| normal.y),
            offset: normals.map(|(_, offset)| offset),
            low: gates.map(|gate| gate.low as f32),
            high: gates.map(|gate| gate.high as f32),
            twin: gates.map(|gate| gate.twin),
        }
    }
}

impl Room {
    /// The place of the edge that follows.
    #[inline]
    pub fn next(self, edge: u32) -> u32 {
        select_unpredictable(edge + 1 == self.n, 0, edge + 1)
    }
}
