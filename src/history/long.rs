//! Questions to a long log that are answered without reading all of it: its index gives the places, and what is found there counts.

use crate::history::Condition;
use crate::journal::{LongLog, LongLogError};
use crate::record::Record;

/// Reads the stages of load step `step`, in their order.
///
/// # Errors
/// Where the log or its index cannot be read.
pub fn stages_of_step(log: &LongLog, step: u64) -> Result<Vec<Record>, LongLogError> {
    let mut found = Vec::new();
    let mut from = 0;
    while let Some(ordinal) = log.search(from, &["step"], |numbers| f64::from_bits(numbers[0]) == step as f64)? {
        found.push(log.record(ordinal)?);
        from = ordinal + 1;
    }
    let tail = log.tail().entries().iter().map(|entry| &entry.record);
    found.extend(tail.filter(|record| record.report.step == step).cloned());
    found.retain(|record| record.report.step == step);
    Ok(found)
}

/// Reads the first stage whose report meets a condition, and the stage before it.
///
/// # Errors
/// Where the log or its index cannot be read.
pub fn first_where(log: &LongLog, condition: &Condition) -> Result<Option<Vec<Record>>, LongLogError> {
    let fields = condition.fields();
    let with_the_one_before = |ordinal: usize| {
        (ordinal.saturating_sub(1)..=ordinal)
            .map(|ordinal| log.record(ordinal))
            .collect::<Result<Vec<_>, _>>()
            .map(Some)
    };
    let mut from = 0;
    while let Some(ordinal) = log.search(from, &fields, |numbers| condition.holds_for(numbers))? {
        if condition.holds(&log.record(ordinal)?.report) {
            return with_the_one_before(ordinal);
        }
        from = ordinal + 1;
    }
    let in_tail = log.tail().entries().iter().position(|entry| condition.holds(&entry.record.report));
    in_tail.map_or(Ok(None), |place| with_the_one_before(log.tail().first() + place))
}
