//! Tests of the program as a whole, one module per question. `main.rs` lists them; what several of
//! them need stands in `plan`, `sightline`, `reference` and `compare`.

mod compare;
mod plan;
mod random;
mod reference;
mod sightline;

mod agree;
mod bulk;
mod cli;
mod generated;
mod hard;
mod heights;
mod property;
mod readers;
mod readme;
mod regression;
mod stability;
mod tidy;
