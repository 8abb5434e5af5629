//! `[load]` of kind `steps`.

use super::data::{Load, LoadSteps};
use super::fault::Checked;
use super::table::{Range, Table};

/// Steps of the load factor.
pub(super) fn steps(table: Table<'_, '_>) -> Checked<Load> {
    table.word("kind", &[("steps", ())])?;
    let positive = Range { above: 0.0, most: 1e6, reason: "load factors grow from 0" };
    let factor = table.number_or("factor", positive, 1.0)?;
    let increment = table.number("increment", positive, "0.05")?;
    let longest = table.number_or("longest_increment", positive, increment)?;
    let load = LoadSteps {
        factor,
        increment,
        longest_increment: (longest > increment).then_some(longest),
        least_increment: table.number_or("least_increment", positive, 1e-6)?,
        snap_tolerance: table.number_or("snap_tolerance", positive, 1e-3)?,
    };
    if load.increment > load.factor {
        let problem =
            format!("the increment, {}, goes past the load factor at the end, {}", load.increment, load.factor);
        return Err(table.wrong(table.place_of("increment").as_ref(), problem, "make it smaller"));
    }
    if longest < increment {
        let problem = format!("the longest increment, {longest}, is smaller than the increment, {increment}");
        return Err(table.wrong(
            table.place_of("longest_increment").as_ref(),
            problem,
            "make it larger, or take it out",
        ));
    }
    if load.least_increment > load.increment || load.snap_tolerance < load.least_increment {
        let problem = format!(
            "least_increment = {} must be at most the increment ({}) and at most snap_tolerance ({})",
            load.least_increment, load.increment, load.snap_tolerance
        );
        return Err(table.wrong(table.place_of("least_increment").as_ref(), problem, "make it smaller"));
    }
    table.finish()?;
    Ok(Load::Steps(load))
}
