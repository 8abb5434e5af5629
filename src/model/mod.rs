//! A scene made discrete: the mesh that it starts from, and the tables, supports and free unknowns of a mesh.
//!
//! | file | what |
//! |---|---|
//! | `limits` | tolerances and limits |
//! | `error`, `concerned` | why a scene cannot be made discrete, and the tables that this is about |
//! | `shape` | the surface of a scene in its fewest elements |
//! | `profile` | a profile of lines and arcs as one curve |
//! | `joint` | knot lines across which the surface is smooth |
//! | `soundness`, `thinness`, `overhang` | whether a shell can have that surface |
//! | `subdivision`, `start` | the mesh that a run starts from |
//! | `imperfection`, `imperfection_error` | surfaces that are not perfect |
//! | `imperfection_field`, `random_field`, `gaussian` | imperfections as functions of the place; random numbers |
//! | `largest_offset` | how far they are from the perfect ones |
//! | `size`, `oddity` | the size of a shell in a few numbers; numbers of a scene that look like slips |
//! | `parametrize`, `edge`, `direction` | parameters at fractions of length and angle; rows and normals of edges; directions at a point |
//! | `expressions` | displacements of places as sums over control points |
//! | `symmetry_plane`, `symmetric_line`, `mirror` | planes of symmetry |
//! | `mirror_check`, `mirror_image` | whether loads, material and shell are their own mirror images |
//! | `symmetric_shell` | in which lines they would be |
//! | `scene_supports` | the supports of a scene |
//! | `member` | the shells of a structure one by one |
//! | `ties` | joints, seams and planes that tie rows |
//! | `edge_pair`, `edge_ties` | edges of several shells that a joint joins, and their ties |
//! | `unjoined` | edges that lie on each other though nothing connects them |
//! | `body` | a rigid body and its motions |
//! | `supports` | the constraints of supports on a mesh |
//! | `hold`, `rigid_support` | the constraints that each kind makes |
//! | `rigid_motion` | motions that they leave free |
//! | `elimination` | constraints eliminated |
//! | `unknowns` | free unknowns and coordinates |
//! | `rotation`, `placement` | displacements at some coordinates |
//! | `quadrature`, `imbalance` | Gauss points of each element, and whether they balance membrane forces |
//! | `gauss` | Gauss points on parameters |
//! | `connectivity` | control points of each element, and the order of sums |
//! | `tables` | shape functions at the points |
//! | `block_pattern`, `blocks` | 3 × 3 blocks of a matrix on control points |
//! | `free_strains` | free strains over the parameter |
//! | `reactions` | forces that supports exert |

mod block_pattern;
mod blocks;
mod body;
mod concerned;
mod connectivity;
mod direction;
mod edge;
mod edge_pair;
mod edge_ties;
mod elimination;
mod error;
mod expressions;
mod free_strains;
mod gauss;
mod gaussian;
mod hold;
mod imbalance;
mod imperfection;
mod imperfection_error;
mod imperfection_field;
mod joint;
mod largest_offset;
mod limits;
mod member;
mod mirror;
mod mirror_check;
mod mirror_image;
mod oddity;
mod overhang;
mod parametrize;
mod placement;
mod profile;
mod quadrature;
mod random_field;
mod reactions;
mod rigid_motion;
mod rigid_support;
mod rotation;
mod scene_supports;
mod shape;
mod size;
mod soundness;
mod start;
mod subdivision;
mod supports;
mod symmetric_line;
mod symmetric_shell;
mod symmetry_plane;
mod tables;
mod thinness;
mod ties;
mod unjoined;
mod unknowns;

pub use block_pattern::BlockPattern;
pub(crate) use blocks::BLOCK;
pub use blocks::Blocks;
pub(crate) use body::{Body, FreeMotions};
pub use connectivity::{Connectivity, Strand};
pub(crate) use direction::{Site, direction_at};
pub(crate) use edge::{EdgeRows, edge_rows};
pub(crate) use edge_pair::{EdgePair, PairedEdge, SAME_KNOT, edge_pairs, pass_on};
pub(crate) use edge_ties::is_tied_smoothly;
pub use error::ModelError;
pub(crate) use expressions::control_expressions;
pub use free_strains::{FreeStrains, NaturalState};
pub(crate) use gauss::gauss_points;
pub(crate) use gaussian::Gaussians;
pub use imperfection::perfect_on;
pub(crate) use imperfection::{kept_together, moved, thinnest_mm};
pub use imperfection_error::ImperfectionError;
pub(crate) use imperfection_field::ImperfectionField;
pub(crate) use largest_offset::{SurfaceSample, largest_offset};
pub use limits::MOST_CONTROL_POINTS;
pub(crate) use limits::ROUNDING;
pub(crate) use member::{Member, members};
pub(crate) use mirror::Mirror;
pub use oddity::{is_driven_by_loads, odd_motion, oddities};
pub(crate) use parametrize::{line_place, parameters_of};
pub use placement::Placement;
pub(crate) use quadrature::PointCounts;
pub use reactions::{Exerted, PointForces};
pub(crate) use rigid_motion::{HELD, free_motions};
pub(crate) use scene_supports::supports_of;
pub use size::Size;
pub(crate) use size::moduli_mpa;
pub use start::{starting_mesh, starting_patch};
pub use supports::Supports;
pub use symmetric_shell::symmetric_lines;
pub(crate) use tables::{BATCH, LANES};
pub use tables::{PointTable, Tables};
pub(crate) use thinness::{ERROR_OF_OFFSET, Extent, THICK};
pub(crate) use unjoined::unjoined_edges;
pub use unknowns::{Entry, Unknowns};
