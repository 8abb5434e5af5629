//! What a stage reports of the worth of its numbers: where its mesh cannot show what the shell does.
//!
//! | warning | measure | looked for |
//! |---|---|---|
//! | the elements are coarse | the strain energy that halving all of them would change ([`Halving`](crate::adapt::Halving)) | before a jump, and at the end of a run |
//! | a probe is off | what it reads at the equilibrium of the halved mesh | at the end of a run |
//! | buckling is late | the load at which the halved mesh buckles ([`LinearBuckling`](crate::equilibrium::LinearBuckling)) | the same, and where a critical point is passed |
//! | strains are large | the largest in the surfaces of the shell | before a jump, and at the end of a run |
//! | refinement is blocked | how long the spans that the length limit keeps are for their bending ([`Blocked`]) | where nothing is marked any more |
//! | refining changed the energy | the strain energy that the finer mesh stores otherwise at the same load | wherever the mesh is refined, but behind a jump: there it is meant to |

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::adapt::Blocked;
use crate::record::ConnectionReading;
use crate::spline::Elements;
use crate::state::State;
use crate::units::{count, signed, significant};

/// Change of the strain energy, relative to it, from which on there is a warning.
pub(crate) const LARGE: f64 = 0.05;

/// A reason to doubt numbers of the run, with the numbers that show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Warning {
    /// Halving every element would change the strain energy by much.
    CoarseElements {
        /// The scene's parameter at the equilibrium concerned.
        parameter: f64,
        /// Elements each way of the model there.
        elements: Elements,
        /// What halving them would change of the strain energy, relative to it ([`crate::adapt::Halving::energy_share`]).
        energy_share: f64,
    },
    /// A probe would read another value with every element halved.
    ProbeOff {
        /// The scene's parameter at the equilibrium concerned.
        parameter: f64,
        /// Elements each way of the model there.
        elements: Elements,
        /// The probe that is off the most, relative to its value.
        probe: String,
        /// The reading of the probe.
        value: f64,
        /// What it reads on the halved mesh.
        halved: f64,
        /// Unit of both readings.
        unit: String,
        /// Other probes that are off as well.
        others: usize,
    },
    /// With every element halved the shell would have buckled before.
    LateBuckling {
        /// The scene's parameter at the equilibrium concerned.
        parameter: f64,
        /// Elements each way of the model there.
        elements: Elements,
        /// The parameter at which the halved mesh buckles, to first order.
        halved: f64,
    },
    /// Strains that the material law is not meant for.
    LargeStrains {
        /// The scene's parameter at the equilibrium concerned.
        parameter: f64,
        /// The largest magnitude of a Green–Lagrange strain along u or v in a surface of the shell.
        strain: f64,
        /// The middle of the element where it is, as parameters (u, v) in [0, 1].
        at: [f64; 2],
        /// The shell of a structure that it is in.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        shell: Option<String>,
    },
    /// The length limit keeps spans that are far longer than their bending allows.
    RefinementBlocked {
        /// The scene's parameter.
        parameter: f64,
        /// Number of such spans in each direction.
        spans: [usize; 2],
        /// Length of the longest, in decay lengths √(t/κ) of its bending.
        decay_lengths: f64,
        /// Largest indicator among them, over its threshold.
        over_threshold: f64,
    },
    /// The estimated error is above the tolerance, and no span may be split further.
    ToleranceNotMet {
        /// The scene's parameter.
        parameter: f64,
        /// Estimated relative error of the measured quantity.
        estimated: f64,
        /// Relative error that the scene allows.
        tolerance: f64,
    },
    /// A finer mesh stores another strain energy at the same load.
    EnergyChangedByRefining {
        /// The scene's parameter.
        parameter: f64,
        /// Elements each way of the model, after refining.
        elements: Elements,
        /// Change of the strain energy, relative to it.
        energy_change: f64,
    },
    /// A joint or a bond stores more of the energy than one that holds does.
    SoftConnection {
        /// The scene's parameter.
        parameter: f64,
        /// Name of the joint or bond.
        connection: String,
        /// Its share of the energy.
        energy_share: f64,
    },
}

/// Share of the energy from which on a connection is said to be soft: in a right model a joint has about h/(1300 L).
const SOFT: f64 = 1e-3;

impl Warning {
    /// What refining at the same load did to the energy, where that is much.
    pub(crate) fn of_refining(before: &State, after: &State, elements: Elements) -> Option<Self> {
        let energy_change = after.strain_energy_n_mm / before.strain_energy_n_mm - 1.0;
        let is_large = energy_change.is_finite() && energy_change.abs() > LARGE;
        // Behind a jump there is no equilibrium before: the fold only forms, and refining is to change it.
        let is_said = is_large && before.drive.previous().is_some();
        is_said.then_some(Self::EnergyChangedByRefining { parameter: before.parameter, elements, energy_change })
    }

    /// A connection that gives way.
    pub(crate) fn of_connection(parameter: f64, connection: &ConnectionReading) -> Option<Self> {
        (connection.energy_share > SOFT).then(|| Self::SoftConnection {
            parameter,
            connection: connection.name.clone(),
            energy_share: connection.energy_share,
        })
    }

    /// Spans that are kept too long.
    pub(crate) fn of_blocked(state: &State, blocked: Blocked) -> Self {
        let Blocked { spans, decay_lengths, over_threshold } = blocked;
        Self::RefinementBlocked { parameter: state.parameter, spans, decay_lengths, over_threshold }
    }

    /// Short name of the kind of warning.
    pub fn name(&self) -> &'static str {
        match self {
            Self::CoarseElements { .. } => "coarse elements",
            Self::ProbeOff { .. } => "probe off",
            Self::LateBuckling { .. } => "late buckling",
            Self::LargeStrains { .. } => "large strains",
            Self::RefinementBlocked { .. } => "refinement blocked",
            Self::ToleranceNotMet { .. } => "tolerance not met",
            Self::EnergyChangedByRefining { .. } => "energy changed",
            Self::SoftConnection { .. } => "soft connection",
        }
    }

    /// The value of the scene's parameter that the warning is about.
    pub fn parameter(&self) -> f64 {
        match *self {
            Self::CoarseElements { parameter, .. }
            | Self::ProbeOff { parameter, .. }
            | Self::LateBuckling { parameter, .. }
            | Self::LargeStrains { parameter, .. }
            | Self::RefinementBlocked { parameter, .. }
            | Self::ToleranceNotMet { parameter, .. }
            | Self::EnergyChangedByRefining { parameter, .. }
            | Self::SoftConnection { parameter, .. } => parameter,
        }
    }

    /// Whether results up to the warning's parameter are wrong.
    pub fn doubts_results(&self) -> bool {
        !matches!(self, Self::RefinementBlocked { .. })
    }

    /// Describes the warning in a sentence, with its numbers and what to do.
    pub fn in_words(&self) -> String {
        match self {
            Self::CoarseElements { elements, energy_share, .. } => {
                let change = if *energy_share > 1.0 {
                    "more than all".to_owned()
                } else {
                    format!("some {:.0} %", 100.0 * energy_share)
                };
                format!(
                    "{elements} elements cannot show this shape: halving each would change {change} of the strain energy; \
                     write more elements or a higher degree in [mesh], or a lower adapt.threshold or adapt.tolerance"
                )
            }
            Self::ProbeOff { elements, probe, value, halved, unit, others, .. } => {
                let others = match others {
                    0 => String::new(),
                    _ => format!("; {} off as well", count(*others, "other probe")),
                };
                format!(
                    "probe \"{probe}\" reads {} {unit} on {elements} elements and {} {unit} with each of them \
                     halved{others}; write more elements or a higher degree in [mesh], or a lower adapt.threshold or adapt.tolerance",
                    significant(*value, 3),
                    significant(*halved, 3)
                )
            }
            Self::LateBuckling { parameter, elements, halved } => format!(
                "{elements} elements are too stiff against buckling: with each of them halved the shell is unstable at {}, \
                 and buckles at some {}; write more elements or a higher degree in [mesh]",
                significant(*parameter, 3),
                significant(*halved, 3)
            ),
            Self::LargeStrains { strain, at: [u, v], shell, .. } => format!(
                "strains reach {} %, at u = {}, v = {}{}: the law of the material (stress in proportion to strain) and the theory \
                 of thin shells are meant for small ones, and err by some {} % there; look at loads, thickness and units",
                significant(100.0 * strain, 2),
                significant(*u, 2),
                significant(*v, 2),
                shell.as_ref().map_or(String::new(), |shell| format!(" of \"{shell}\"")),
                significant(100.0 * 1.5 * strain, 2)
            ),
            &Self::ToleranceNotMet { estimated, tolerance, .. } => format!(
                "the mesh causes an estimated error of {:.2} %, where adapt.tolerance allows {:.2} %, and the length limit keeps it \
                 from being refined; write a lower adapt.length_limit_mm, or a higher degree in [mesh]",
                100.0 * estimated,
                100.0 * tolerance
            ),
            &Self::RefinementBlocked { spans, decay_lengths, over_threshold, .. } => {
                let each_way = spans.iter().zip(["u", "v"]).filter(|(number, _)| **number > 0);
                let kept: Vec<String> =
                    each_way.map(|(number, way)| format!("{} along {way}", count(*number, "span"))).collect();
                format!(
                    "the length limit keeps {} up to {decay_lengths:.1} times as long as the decay of their bending, √(t/κ), \
                     with indicators up to {over_threshold:.0} times the threshold; write a lower adapt.length_limit_mm",
                    kept.join(" and ")
                )
            }
            Self::SoftConnection { connection, energy_share, .. } => format!(
                "\"{connection}\" stores {} % of the energy, and a connection that holds stores less than {} %: write more elements \
                 on the side that has fewer, or numbers of elements that are multiples of each other",
                significant(100.0 * energy_share, 2),
                100.0 * SOFT
            ),
            Self::EnergyChangedByRefining { elements, energy_change, .. } => format!(
                "refining to {elements} elements changed the strain energy at the same load by {} %, and what was read before \
                 is as far off; start from a finer mesh, or lower adapt.threshold or adapt.tolerance",
                signed(100.0 * energy_change, 1)
            ),
        }
    }
}
