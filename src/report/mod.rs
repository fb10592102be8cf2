//! Results for people and other programs: JSON, and pictures of the plan.

pub mod json;
