//! Physics against closed forms, published tables, independent solvers and finite differences.

mod actions;
mod assembly;
mod balance;
mod baseline;
mod benchmarks;
mod buckling;
mod coarse;
mod connectivity;
mod cured_plate;
mod elastic_foundation;
mod extreme;
mod foundation;
mod free_strain;
mod house;
mod imports;
mod mirrors;
mod path;
mod quadrature;
mod quadrature_balance;
mod reactions;
mod refinement;
mod roofs;
mod soft_mode;
mod spring_path;
mod support;
mod surfaces;
