//! Probes that a scene has and the log of its run has not: what they measure on the states of the log.

use super::json_line::json_line;
use crate::pipeline::Record;
use crate::scene::Scene;
use crate::study::equilibria;
use crate::units::reading;

/// Names of the probes that are new or measure something else.
pub(super) fn names(was: &Scene, is: &Scene) -> Vec<String> {
    is.probes.iter().filter(|probe| !was.probes.contains(probe)).map(|probe| probe.name.clone()).collect()
}

/// A line for each equilibrium at which they were read.
pub(super) fn table(names: &[String], records: &[Record]) -> String {
    let mut text = String::from("new probes on the equilibria of the log, which itself keeps the ones that it has\n");
    for Record { report, .. } in equilibria(records) {
        let new = report.probes.iter().filter(|probe| names.contains(&probe.name));
        let readings: Vec<String> =
            new.map(|probe| format!("{} {} {}", probe.name, reading(probe.value, 6), probe.unit)).collect();
        let at = report.driven_by.shown(report.parameter);
        text.push_str(&format!("{:>5}  {at}: {}\n", report.step, readings.join(", ")));
    }
    text
}

/// The same as the lines of `run --json`, with the readings of all probes of the scene.
pub(super) fn json_lines(records: &[Record]) -> String {
    equilibria(records).map(|record| json_line(record) + "\n").collect()
}
