//! Verification of the finite elements, in one binary: it links once and its tests share both cores.
//! One file of it: `cargo test -p lut-gen --test suite closed_forms::`.

mod adhesion;
mod central_differences;
mod chain;
mod closed_forms;
mod compression;
mod coupon;
mod designs;
mod discretisation;
mod dynamics;
mod field;
mod force_model;
mod homogeneous;
mod indentation;
mod law;
mod magnet;
mod model;
mod pad;
mod region;
mod relaxation;
mod sensitivity;
mod simulation;
mod sweep;
mod sweep_of_solves;
mod table_bound;
mod table_rates;
