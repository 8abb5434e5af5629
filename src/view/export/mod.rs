//! States in the formats of other programs.
//!
//! | file | what |
//! |---|---|
//! | `whole_shell` | the whole shell of a state, whatever part is modelled |
//! | `instant` | the numbers that name a state |
//! | `bezier` | its elements as Bézier patches |
//! | `xml_array` | arrays of VTK's XML files |
//! | `surface`, `knot_lines`, `bezier_grid` | surface and knot lines for ParaView; what both have in common |
//! | `pvd` | their series |
//! | `table` | fields at points: CSV and JSON |
//! | `npz` | states as arrays for numpy |
//! | `stl`, `step` | the deformed surface: triangles, and NURBS for CAD |

mod bezier;
mod bezier_grid;
mod instant;
mod knot_lines;
mod npz;
mod pvd;
mod step;
mod stl;
mod surface;
mod table;
mod whole_shell;
mod xml_array;

pub use instant::Instant;
pub use knot_lines::knot_lines_vtu;
pub use npz::{StatesOnMesh, npz};
pub use pvd::{pvd, time_steps};
pub use step::step;
pub use stl::stl;
pub use surface::surface_vtu;
pub use table::{csv, json};
pub(super) use whole_shell::WholePoint;
pub use whole_shell::WholeShell;
pub(super) use xml_array::{OPENING, XmlArray, base64};
