//! The Kirchhoff–Love shell at a point: strains, energy and its derivatives, material, quadrature.

mod free_strain;
mod lane_vector;
pub(crate) mod lanes;
#[cfg(target_arch = "x86_64")]
pub(crate) mod lanes_x86;
mod material;
mod point;
mod point_batch;
mod quadrature;
mod stretching_batch;
mod vector;

pub use free_strain::{FreeStrain, thermal_strain};
pub use material::{ShellStiffness, shell_stiffness};
pub use point::{Hessian, PointReference, Strains};
pub use point_batch::PointBatch;
pub(crate) use point_batch::{BatchGradient, BatchHessian, PointKernel};
pub use quadrature::gauss_legendre;
pub use stretching_batch::StretchingBatch;
pub(crate) use vector::{add, cross, dot, norm, scaled, sub};
