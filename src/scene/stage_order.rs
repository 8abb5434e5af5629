//! Which lists of stages can run. Each stage after solve takes what the one before it made, and what refine-knots
//! begins must be carried to its end; so a list is solve, perhaps switch-branch, perhaps evaluate-indicators, and then
//! perhaps the rest.

use toml::de::DeValue;

use super::data::Stage;
use super::entry::Entry;
use super::fault::{Checked, Fault, TextSpan};
use super::keys::Key;
use super::nearest::nearest;
use super::problem::{Problem, StageOrderProblem, ValueType};
use super::value::value_type;

/// What a stage takes from the one before it.
pub(super) fn needs(stage: Stage) -> Option<Stage> {
    match stage {
        Stage::Solve => None,
        Stage::EvaluateIndicators | Stage::SwitchBranch => Some(Stage::Solve),
        Stage::RefineKnots => Some(Stage::EvaluateIndicators),
        Stage::ProjectDisplacements => Some(Stage::RefineKnots),
        Stage::ReEquilibrate => Some(Stage::ProjectDisplacements),
        Stage::CoarsenKnots => Some(Stage::ReEquilibrate),
    }
}

/// The stage that must carry on from where a stage leaves the state.
fn sequel(stage: Stage) -> Option<Stage> {
    match stage {
        Stage::Solve | Stage::SwitchBranch | Stage::EvaluateIndicators | Stage::ReEquilibrate | Stage::CoarsenKnots => {
            None
        }
        Stage::RefineKnots => Some(Stage::ProjectDisplacements),
        Stage::ProjectDisplacements => Some(Stage::ReEquilibrate),
    }
}

/// Reads a list of stages that can run.
pub(super) fn read(key: &'static Key, entry: &Entry<'_>) -> Checked<Vec<Stage>> {
    let whole = entry.value_place();
    let items = match entry.value.get_ref() {
        DeValue::Array(items) => items,
        DeValue::String(name) => {
            let fault = Fault::new(Problem::WrongType { key, found: ValueType::Text }, &whole);
            return Err(match by_name(name) {
                Some(stage) => fault.edit(&whole, format!("[\"{stage}\"]")),
                None => fault,
            });
        }
        other => return Err(Fault::new(Problem::WrongType { key, found: value_type(other) }, &whole)),
    };
    let named = items.iter().map(|item| {
        let place = entry.place_of(item.span());
        Ok((stage(item.get_ref(), &place)?, place))
    });
    let named = named.collect::<Checked<Vec<_>>>()?;
    check(&named, &whole)?;
    Ok(named.into_iter().map(|(stage, _)| stage).collect())
}

fn by_name(name: &str) -> Option<Stage> {
    Stage::ALL.into_iter().find(|stage| stage.name() == name)
}

fn problem(problem: StageOrderProblem, place: &TextSpan) -> Box<Fault> {
    Fault::new(Problem::Stages(problem), place)
}

fn stage(item: &DeValue<'_>, place: &TextSpan) -> Checked<Stage> {
    let Some(found) = item.as_str() else {
        return Err(problem(StageOrderProblem::NotAName { found: value_type(item) }, place));
    };
    by_name(found).ok_or_else(|| {
        let meant = nearest(found, Stage::ALL.iter().map(|stage| stage.name())).and_then(by_name);
        let fault = problem(StageOrderProblem::Unknown { found: found.into(), meant }, place);
        match meant {
            Some(meant) => fault.edit(place, format!("\"{meant}\"")),
            None => fault,
        }
    })
}

fn check(named: &[(Stage, TextSpan)], whole: &TextSpan) -> Checked<()> {
    if named.is_empty() {
        return Err(problem(StageOrderProblem::Empty, whole));
    }
    let at = |wanted: Stage| named.iter().position(|(stage, _)| *stage == wanted);
    for (index, (stage, place)) in named.iter().enumerate() {
        let first = &named[at(*stage).unwrap_or(index)].1;
        if first != place {
            return Err(problem(StageOrderProblem::Twice { stage: *stage }, place).also(Some(first)));
        }
    }
    if let (Some(switch), Some(evaluate)) = (at(Stage::SwitchBranch), at(Stage::EvaluateIndicators))
        && switch > evaluate
    {
        let order = StageOrderProblem::TooEarly { stage: Stage::EvaluateIndicators, needs: Stage::SwitchBranch };
        return Err(problem(order, &named[evaluate].1).also(Some(&named[switch].1)));
    }
    for (index, (stage, place)) in named.iter().enumerate() {
        let Some(needs) = needs(*stage) else { continue };
        match at(needs) {
            Some(source) if source < index => {}
            Some(source) => {
                let fault = problem(StageOrderProblem::TooEarly { stage: *stage, needs }, place);
                return Err(fault.also(Some(&named[source].1)));
            }
            None => return Err(problem(StageOrderProblem::WithoutSource { stage: *stage, needs }, place)),
        }
    }
    for (stage, place) in named {
        if let Some(sequel) = sequel(*stage).filter(|sequel| at(*sequel).is_none()) {
            let last = named.last().map_or(place, |(_, place)| place);
            let behind = TextSpan { source: last.source, span: last.span.end..last.span.end };
            let fault = problem(StageOrderProblem::WithoutSequel { stage: *stage, sequel }, place);
            let begun = Stage::REFINING.into_iter().skip_while(|earlier| *earlier != *stage);
            let rest = begun.filter(|later| at(*later).is_none());
            return Err(fault.edit(&behind, rest.map(|later| format!(", \"{later}\"")).collect::<String>()));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every list without repetition: exactly eight can run.
    #[test]
    fn eight_lists_can_run() {
        let mut lists: Vec<Vec<Stage>> = vec![vec![]];
        let mut from = 0;
        while from < lists.len() {
            for stage in Stage::ALL {
                if !lists[from].contains(&stage) {
                    let longer = [lists[from].clone(), vec![stage]].concat();
                    lists.push(longer);
                }
            }
            from += 1;
        }
        assert_eq!(lists.len(), 13_700);
        let whole = TextSpan { source: 0, span: 0..0 };
        let place = |index| TextSpan { source: 0, span: index..index + 1 };
        let can_run = |list: &Vec<Stage>| {
            let named: Vec<_> = list.iter().enumerate().map(|(index, stage)| (*stage, place(index))).collect();
            check(&named, &whole).is_ok()
        };
        lists.retain(can_run);
        let refining = &Stage::REFINING;
        assert_eq!(
            lists,
            [
                &refining[..1],
                &Stage::ALL[..2],
                &refining[..2],
                &Stage::ALL[..3],
                &refining[..],
                &Stage::ALL[..6],
                &[&refining[..], &[Stage::CoarsenKnots]].concat()[..],
                &Stage::ALL[..],
            ]
        );
    }
}
