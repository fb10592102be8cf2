//! enfilade: exact cells-and-portals visibility of architectural levels.
//!
//! This page is the map of the house. Every stage is a function from a finished value to a new
//! value; nothing is filled in later.
//!
//! ```text
//! level file ──level──▶ Level ──cells──▶ CellGraph ──pvs──▶ Pvs ──┬──report──▶ JSON, plans, explanations
//! (toml, wad)                  (bsp kd cdt)  (cells, portals)      ├──study───▶ what accuracy costs
//! svg, uvtt)                                                       └──pvs::file──▶ FILE.pvs
//! ```
//!
//! # Rooms
//!
//! Lowest first; a module uses only those above it in this list (a test keeps that so).
//!
//! | module | in → out | what lives there |
//! |---|---|---|
//! | [`geom`] | numbers | grid points, lines, exact vertices, predicates that return a named side, intervals |
//! | [`level`] | file → [`Level`](level::Level) | the model; readers for the own TOML format, Doom WADs and UDMF maps, and, through [`drawing`](level::drawing), for DXF, SVG and Universal VTT; the door to the grid; findings |
//! | [`cells`] | `Level` → [`CellGraph`](cells::CellGraph) | the arrangement of the walls, subdivision by `bsp`, `kd` and `cdt` or by a `guide` from elsewhere, inside and outside, portals, point location |
//! | [`sight`] | chain of portals → stabbing line, or why there is none | the exact funnel that grows and shrinks with the chain; the exact solver; the lecture's linear programme |
//! | [`pvs`] | `CellGraph` → [`Pvs`](pvs::Pvs) | the methods: `sweep` about vertices and depth-first `search` (exact), `lp`, `flow`, `flood`, `sample`; `heights`; `eye` within a cone; `explain` for one pair; `closing` (what each opening lets be seen) and `longest` sightlines; what sectors and GL nodes' subsectors see; the file format, `runtime` for engines, `verify` |
//! | [`trace`] | `Level` + `CellGraph` + `Pvs` → image | rays that walk through portals, beams, shapes, acceleration structures; the world with its lights, shading, effects and which of them a picture calls for, pictures; floating point begins here |
//! | [`preview`] | world + tree + camera → painted picture | the BSP's back-to-front order, culling by back faces, PVS and what the eye sees, a raster without a depth buffer that agrees with the rays on every pixel; flat or with textures |
//! | [`walk`] | path or `Level` + `CellGraph` + person → [`Track`](walk::Track) | the eye at each moment: smooth paths at constant speed, tours of everything that can be reached on foot, and what each frame has to draw |
//! | [`report`] | results → people | JSON, pictures of the plan, explanations in words; what places cost ([`report::costs`]) and its page; `export` to other programs' formats |
//! | [`study`] | results → people | what accuracy costs in time; the hard cases; what effects, samples and structures cost |
//! | `viewer` (feature `viewer`) | level file → window | walking through a level; the plan; what is visible from where, why, and what it costs |
//! | [`cli`] | arguments → all of it | one file per subcommand; the only place that touches files, clock, terminal |
//!
//! # Numbers: exact inside, one door
//!
//! Coordinates are x right, y up. Each enters once, at [`level::snap`], and is put on an integer
//! grid of less than 2^25 steps each way. A line through two grid points has integer coefficients;
//! a vertex that splitting creates is never rounded, but kept as the meeting of two such lines. So
//! every geometric sign in `geom`, `cells`, `sight` and `pvs` is decided exactly, by
//! [`geom::predicate`]: there is no epsilon, and the answer does not depend on the order of the
//! walls, on rotation by 90°, mirroring, translation or the number of threads.
//!
//! # What 'visible' means
//!
//! Cells are open convex sets. A sees B when some segment from inside A to inside B crosses no
//! opaque wall. Such segments form an open set: a line that only grazes a corner, or squeezes
//! through two walls that touch, is not sight; a line of any width, however thin, is.
//!
//! # Two ways to every answer
//!
//! [`pvs::sweep`] and [`pvs::search`] share no algorithm and must agree bit for bit; the three
//! subdivisions must agree point by point; [`pvs::verify`] checks a finished file against the walls
//! of the level without using any of them. Whoever says that a chain of portals is stabbed, or is
//! not, hands over a line or the ends that contradict each other, and both can be checked exactly.
//!
//! # Where floating point is allowed to err
//!
//! [`sight::lp`] with [`pvs::lp`] (the lecture's linear programme) and [`pvs::flow`] (what the Quake
//! tools do) are there to be compared with. Their tolerances are theirs, and say so; everything else
//! up to `pvs` is exact, or proved by intervals ([`pvs::heights`]).
//!
//! # Deliberately absent
//!
//! - Tolerances. What should touch but does not is joined at the door, counted and reported; after
//!   that a gap is a gap.
//! - Repairs that guess. A defect is repaired where there is one way to, else it is reported; gaps in a
//!   drawing are closed when somebody says up to which size.
//! - State. There are no globals and no caches; options come in as one struct per stage.

pub mod cells;
pub mod cli;
pub mod geom;
pub mod level;
pub mod preview;
pub mod pvs;
pub mod report;
pub mod sight;
pub mod study;
pub mod trace;
#[cfg(feature = "viewer")]
pub mod viewer;
pub mod walk;
