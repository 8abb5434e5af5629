//! The Kirchhoff–Love shell at a point: strains, energy and its derivatives, material, quadrature.

mod material;
mod point;
mod quadrature;
mod vector;

pub use material::{ShellStiffness, shell_stiffness};
pub use point::{Hessian, PointReference, Strains};
pub use quadrature::gauss_legendre;
pub(crate) use vector::{add, cross, dot, norm, scaled, sub};
