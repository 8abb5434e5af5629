//! The Kirchhoff–Love shell at a point: strains, energy and its derivatives, material, quadrature.
//!
//! | file | what |
//! |---|---|
//! | `vector` | vectors of three components |
//! | `material` | from a material to a quadratic form of the strains |
//! | `free_strain` | strains without forces |
//! | `quadrature` | Gauss–Legendre rules |
//! | `point` | a point: energy, gradient, Hessian |
//! | `local` | its strains and resultants in its own axes |
//! | `layer`, `failure` | layers of the shell, and how near they are to failing |
//! | `surface_frame` | normals as functions of the tangents |
//! | `lanes`, `lanes_x86` | several numbers at once |
//! | `lane_vector` | vectors whose components are such lanes |
//! | `batch` | four points at once: what both kinds share |
//! | `point_batch`, `stretching_batch` | bending and stretching; stretching alone |

mod batch;
mod failure;
mod free_strain;
mod lane_vector;
pub(crate) mod lanes;
#[cfg(target_arch = "x86_64")]
pub(crate) mod lanes_x86;
mod layer;
mod local;
mod material;
mod point;
mod point_batch;
mod quadrature;
mod stretching_batch;
mod surface_frame;
mod vector;

pub(crate) use batch::{BatchGradient, BatchHessian, PointKernel};
pub use free_strain::{FreeStrain, thermal_strain};
pub use layer::{Criterion, Layer, layers};
pub use local::{LocalPoint, local_point, principal};
pub use material::{ShellStiffness, shell_stiffness};
pub use point::{Hessian, PointReference, Strains};
pub use point_batch::PointBatch;
pub use quadrature::gauss_legendre;
pub use stretching_batch::StretchingBatch;
pub(crate) use surface_frame::{FrameVector, TANGENTS};
pub(crate) use vector::{add, basis_vector, cross, dot, norm, scaled, sub, unit_normal};
