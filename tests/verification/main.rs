//! Physics against closed forms, published tables, independent solvers and finite differences.

mod assembly;
mod balance;
mod baseline;
mod benchmarks;
mod buckling;
mod cured_plate;
mod extreme;
mod free_strain;
mod house;
mod path;
mod quadrature;
mod reactions;
mod refinement;
mod roofs;
mod soft_mode;
mod spring_path;
mod support;
