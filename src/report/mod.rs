//! Results for people and other programs: findings, JSON, and pictures of the plan.

pub mod check;
pub mod costs;
pub mod explain;
pub mod export;
pub mod json;
pub mod page;
pub mod picture;
pub mod plan;
pub mod prt;
pub mod sightlines;
pub mod walkthrough;
pub mod wording;
