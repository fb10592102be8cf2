//! Tests of the program as a whole, one module per question. `main.rs` lists them; what several of
//! them need stands in `browser`, `plan`, `sightline`, `reference` and `compare`.

mod browser;
mod compare;
mod plan;
mod reference;
mod sightline;

mod agree;
mod cli;
mod explain;
mod hard;
mod heights;
mod property;
mod readers;
mod readme;
mod regression;
mod study;
mod tidy;
