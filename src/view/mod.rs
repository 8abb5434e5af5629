//! Pictures of runs: the moment–rotation curve, the deformed mesh, and the mesh for ParaView.
//!
//! | file | what |
//! |---|---|
//! | `fields` | what can be shown of a shell, with names and units |
//! | `bonded` | the shells of a state, with what bonds carry on them |
//! | `samples` | a sampled surface |
//! | `deformed_surface` | the deformed shell as one |
//! | `camera`, `viewpoint`, `colour`, `ticks` | projection, where a structure is seen from, colours, round numbers |
//! | `plot` | curves |
//! | `mesh_picture`, `marks`, `glyphs` | the mesh as a picture; supports, loads and the outline before, and their signs |
//! | `drawing`, `raster` | shapes on a canvas, as SVG and as pixels |
//! | `animation` | the mesh over the load steps as a GIF |
//! | `viewers` | what viewers of MCAP draw |
//! | `report` | runs as a page |
//! | `vtu` | the mesh as drawn, for ParaView |
//! | `export` | states in the formats of other programs |

#[cfg(feature = "pictures")]
mod animation;
mod bonded;
mod camera;
mod colour;
mod deformed_surface;
mod drawing;
mod export;
mod fields;
mod glyphs;
mod marks;
mod mesh_picture;
#[cfg(feature = "pictures")]
mod plot;
#[cfg(feature = "pictures")]
mod raster;
mod report;
mod samples;
mod ticks;
mod viewers;
mod viewpoint;
mod vtu;

#[cfg(feature = "pictures")]
pub use animation::{AnimationError, mesh_animation};
pub use bonded::ShellsOfState;
pub use camera::ViewDirection;
pub use deformed_surface::{coloured_surface, deformed_surface, mode_surface};
pub use export::{
    Instant, StatesOnMesh, WholeShell, csv, json, knot_lines_vtu, npz, pvd, step, stl, surface_vtu, time_steps,
};
pub use fields::{Field, FieldPoint, ShellFields, fields_of};
pub use marks::Marks;
pub use mesh_picture::{Picture, mesh_picture};
#[cfg(feature = "pictures")]
pub use plot::{
    PlotError, PlottedRun, Quantity, curve_plot, load_probe, moment_rotation_plot, quantities_of, quantity_named,
};
pub use report::{FrameAt, ReportedRun, Shape, Told, chosen_frames, report_page, study_page, sweep_page};
pub use samples::{SamplesError, SurfaceSamples};
pub use viewers::{LOG_TOPIC, MESH_HISTORY_TOPIC, MeshHistory, PictureError, StepTimes, ViewerFile};
pub use viewpoint::viewpoint;
pub use vtu::vtu;
