//! From a level's cells to pictures without rays: its polygons painted from back to front.
//!
//! In: a [`Space`](crate::trace::Space), the [`Tree`](crate::cells::Tree) that split the plan, a
//! camera, and which cells to draw. Out: a [`Canvas`] with a colour and a surface for every pixel, and
//! what that cost ([`Figures`]). There is no depth buffer: a later polygon covers earlier ones, and the
//! tree says in which order that is right. Source: lecture, "BSP tree: Hidden Surface Removal", "BSP
//! tree: Painting".
//!
//! | file | what |
//! |---|---|
//! | [`polygon`] | walls, steps, lintels, panes, floors and ceilings of each cell; back-face culling |
//! | [`border`] | borders of polygons as planes through the eye, exactly the same for neighbours |
//! | [`canvas`] | rows of pixels between borders, shaded in perspective |
//! | [`paint`](mod@paint) | the order, the culling, the figures |

pub mod border;
pub mod canvas;
pub mod paint;
pub mod polygon;

pub use canvas::{Canvas, Coat};
pub use paint::{Figures, paint};
pub use polygon::{Polygon, Polygons};
