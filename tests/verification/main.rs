//! Physics against closed forms, published tables, independent solvers and finite differences.

mod assembly;
mod baseline;
mod benchmarks;
mod extreme;
mod house;
mod quadrature;
mod refinement;
mod support;
