//! From a level's cells to pictures without rays: its polygons painted from back to front.
//!
//! In: a [`World`](crate::trace::world::World) with its cells and PVS, made ready once as a [`Painter`];
//! a camera, and [`Options`]: which cells to draw and in which order. Out: on an [`Easel`] a [`Canvas`] with a
//! colour for every pixel, and what that cost ([`Figures`]). There is no depth buffer: a later polygon
//! covers earlier ones, and the tree says in which order that is right. Source: lecture, "BSP tree:
//! Hidden Surface Removal", "BSP tree: Painting", "Eye-to-Cell Visibility".
//!
//! | file | what |
//! |---|---|
//! | [`polygon`] | walls, steps, lintels, panes, floors and ceilings of each cell; back-face culling |
//! | [`border`] | borders of polygons as planes through the eye, exactly the same for neighbours |
//! | [`coat`] | what polygons are painted with: colours, pictures, the sky, glass; light |
//! | [`culling`] | which cells are painted: all, the PVS, or what the eye sees |
//! | [`view`](mod@view) | polygons as a camera sees them |
//! | [`fill`](mod@fill) | rows of pixels, in perspective |
//! | [`objects`] | what stands in the cells, by rays, in the cells' turn |
//! | [`draw`] | the order, the figures |
//! | `band` | bands of rows, painted on threads |
//! | [`canvas`] | the picture |
//!
//! Objects are no polygons of the plan, so the tree does not order them; but each cell is convex, and what
//! stands in it has its turn just after its walls: see [`objects`].
//!
//! # Two orders
//!
//! Backwards through the same list, the nearest polygon comes first. Painting only on pixels that are
//! still free then paints each pixel once, and may stop when none is left; glass and gratings wait, and
//! are painted at the end, the farthest first. Both orders give the same bytes.

mod band;
pub mod border;
pub mod canvas;
pub mod coat;
pub mod culling;
pub mod draw;
pub mod fill;
pub mod objects;
pub mod polygon;
pub mod view;

pub use canvas::Canvas;
pub use coat::{Coats, Finish};
pub use culling::Culling;
pub use draw::{Brushes, Easel, Figures, Options, Order, Painter, Turn};
pub use polygon::{Polygon, Polygons};
