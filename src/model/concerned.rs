//! The tables of a scene that an error is about.

use crate::model::ModelError;

impl ModelError {
    /// The tables of a scene that the error is about: their kind, and a name where it is one of them; `None` where it is about
    /// none, or about several kinds.
    pub fn concerns(&self) -> Option<(&'static str, Option<&str>)> {
        match self {
            Self::FreeMotion { .. } | Self::NothingFree { .. } => Some(("support", None)),
            Self::NotAnEdge { support }
            | Self::NotASymmetryPlane { support, .. }
            | Self::NotItsOwnImage { support, .. }
            | Self::MaterialNotMirrored { support, .. }
            | Self::SectionShared { support, .. }
            | Self::Contradiction { support, .. }
            | Self::NoFreeMotion { support }
            | Self::TooFewPoints { support, .. }
            | Self::Unbalanced { support, .. } => Some(("support", Some(support))),
            Self::NotALine { action } | Self::Overhang { action, .. } | Self::LoadNotMirrored { action, .. } => {
                Some(("action", Some(action)))
            }
            Self::EdgesApart { joint, .. } | Self::NotSmooth { joint, .. } => Some(("joint", Some(joint))),
            Self::NothingGlued { bond, .. } | Self::ShellsCross { bond, .. } => Some(("bond", Some(bond))),
            Self::Imperfection(error) => Some(("imperfection", error.imperfection())),
            Self::NotASection { probe } => Some(("probe", Some(probe))),
            _ => None,
        }
    }
}
