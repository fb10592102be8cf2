//! Tests of the program as a whole, one module per question. `main.rs` lists them; what several of
//! them need stands in `browser`, `caster`, `plan`, `random`, `sightline`, `reference`, `scene` and `compare`.

mod browser;
mod caster;
mod compare;
mod plan;
mod random;
mod reference;
mod scene;
mod sightline;

mod agree;
mod bulk;
mod cli;
mod drawing;
mod drawn_studies;
mod engines;
mod explain;
mod exported;
mod exports;
mod eye;
mod generated;
mod hard;
mod heights;
mod methods;
mod pictures;
mod pixels;
mod plans;
mod preview;
mod programme;
mod property;
mod props;
mod readers;
mod readme;
mod regression;
mod render;
mod report;
mod stability;
mod study;
mod tidy;
mod tour;
mod walking;
