//! What a run shows when it is compared with theory: the closed-form laws of tape springs, the summary of a run, and suites
//! of scenes that state how they end.
//!
//! | file | what |
//! |---|---|
//! | `wuest`, `section_shape` | closed-form laws of tape springs |
//! | `path` | the equilibria of a run, and its jumps |
//! | `summary`, `summary_text` | what a run found |
//! | `forecast` | what is known of a run before it |
//! | `timed_run`, `bench` | what it costs |
//! | `accuracy`, `convergence` | error against that |
//! | `comparison` | runs next to each other |
//! | `engine`, `room` | the loop over tasks; memory that they share |
//! | `archive` | runs by what decides their results, each in a log |
//! | `study_file`, `speed_up` | studies of structures, and what they show |
//! | `calibration` | the threshold of the bending indicator |
//! | `extremes`, `extremes_run`, `extremes_curve`, `extremes_fault` | scenes that state how they end |

mod accuracy;
mod archive;
mod bench;
mod calibration;
mod comparison;
mod convergence;
mod engine;
mod extremes;
mod extremes_curve;
mod extremes_fault;
mod extremes_run;
mod forecast;
mod path;
mod room;
mod section_shape;
mod speed_up;
mod study_file;
mod summary;
mod summary_text;
mod timed_run;
mod wuest;

pub use accuracy::{AccuracyError, AccuracyRow, Measured, is_comparable, is_one_structure};
pub(crate) use archive::short_name;
pub use archive::{Archive, Done, Purpose, TaskError, run_name};
pub use bench::{BenchError, Figure, kernel_figures, run_figure};
pub use calibration::{
    Calibrated, Calibration, CalibrationError, CalibrationPoint, CoarseIn, EndedBy, Verdict, calibrate,
    check_calibratable, fine_elements,
};
pub use comparison::{Curve, CurveError, Deviation, Finding};
pub use convergence::{ConvergenceRow, NotASpring, converged, path_scene};
pub use engine::{EngineError, Workers, guarded, in_turn};
pub use extremes::{ExtremeRow, ExtremesSuite};
pub use extremes_fault::ExtremeFault;
pub use extremes_run::ExtremeEnd;
pub use forecast::{FinestCost, FinestMesh, Forecast, StepCost, hardly_moved_or_thrown_off};
pub use path::{OnPath, Passed, PathPoint, Snap, equilibria, equilibrium_path, records_on_path, snaps};
pub use room::{Held, Room};
pub use speed_up::{Errors, MeshPoint, SpeedUp, error_of_finer, speed_up};
pub use study_file::{Adaptive, Family, Planned, ReferenceMesh, Role, Structure, StudyError, StudyFile};
pub use summary::{EnergyBalance, FoldMean, MeasuredPeak, MeshChange, PeakFound, StageWork, Summary, WarningCount};
pub use wuest::{FoldMoments, Peak, Plateau, TapeSpring};
