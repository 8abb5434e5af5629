//! Stages that cannot run, in words.

use super::explanation::{Explanation, shorten, type_words};
use crate::scene::data::Stage;
use crate::scene::problem::StageOrderProblem;

pub(super) fn wrong_order(problem: &StageOrderProblem) -> Explanation {
    let explanation = match problem {
        StageOrderProblem::Empty => Explanation::new("a load step needs at least the stage solve", "no stage"),
        StageOrderProblem::Unknown { found, meant } => {
            let explanation = Explanation::new(format!("there is no stage \"{}\"", shorten(found)), "");
            match meant {
                Some(meant) => explanation.fix(format!("did you mean \"{meant}\"?")),
                None => explanation,
            }
        }
        StageOrderProblem::NotAName { found } => {
            Explanation::new("a stage is given by its name in quotes", format!("this is {}", type_words(*found)))
        }
        StageOrderProblem::Twice { stage } => Explanation::new(format!("the stage {stage} is listed twice"), "again")
            .also("first here")
            .note("the list names each stage once; a load step refines as often as it needs to"),
        StageOrderProblem::TooEarly { stage, needs } => {
            Explanation::new(format!("{stage} cannot run before {needs}"), takes(*stage)).also("comes only here")
        }
        StageOrderProblem::WithoutSource { stage, needs } => {
            Explanation::new(format!("{stage} cannot run without {needs}"), takes(*stage))
        }
        StageOrderProblem::WithoutSequel { stage, sequel } => {
            Explanation::new(format!("{stage} cannot be left without {sequel}"), leaves(*stage))
                .fix("carry it to its end")
        }
    };
    explanation
        .help(format!("to solve on the mesh as it is: {}", list(&Stage::REFINING[..1])))
        .help(format!("to watch where it is too coarse: {}", list(&Stage::REFINING[..2])))
        .help(format!("to refine it: {}", list(&Stage::REFINING)))
        .help("to coarsen it as well where a tolerance allows: \"coarsen-knots\" at the end".to_string())
        .help("to leave unstable equilibria as well: \"switch-branch\" after \"solve\"".to_string())
}

pub(super) fn adapt_unused() -> Explanation {
    Explanation::new("[adapt] is given, but no stage reads it", "read by no stage")
        .also("these stages neither measure nor refine")
        .help("take [adapt] out for a uniform mesh")
        .help(format!("to refine: stages = {}", list(&Stage::REFINING)))
}

/// What a stage takes from the one before it.
fn takes(stage: Stage) -> &'static str {
    match stage {
        Stage::Solve => "begins the load step",
        Stage::SwitchBranch => "leaves an unstable equilibrium that solve has found",
        Stage::EvaluateIndicators => "measures the bending of an equilibrium that solve has found",
        Stage::RefineKnots => "inserts the knots that evaluate-indicators has marked",
        Stage::ProjectDisplacements => "carries displacements to the mesh that refine-knots has made",
        Stage::CoarsenKnots => "takes out knots that refine-knots has inserted, and leaves it to re-equilibrate",
        Stage::ReEquilibrate => "starts from the displacements that project-displacements has carried over",
    }
}

/// How a stage leaves the state.
fn leaves(stage: Stage) -> &'static str {
    match stage {
        Stage::RefineKnots => "leaves displacements that belong to the mesh before",
        Stage::ProjectDisplacements | Stage::CoarsenKnots => "leaves a mesh on which equilibrium is not found yet",
        Stage::Solve | Stage::SwitchBranch | Stage::EvaluateIndicators | Stage::ReEquilibrate => {
            "leaves an equilibrium"
        }
    }
}

fn list(stages: &[Stage]) -> String {
    let names: Vec<_> = stages.iter().map(|stage| format!("\"{stage}\"")).collect();
    format!("[{}]", names.join(", "))
}
