//! Tests of the program as a whole, one module per question. `main.rs` lists them; what several of
//! them need stands in `plan`, `sightline`, `reference` and `compare`.

mod caster;
mod compare;
mod plan;
mod reference;
mod sightline;

mod agree;
mod cli;
mod eye;
mod hard;
mod pictures;
mod property;
mod readers;
mod readme;
mod regression;
mod tidy;
