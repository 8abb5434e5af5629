//! What of a scene varies: values of one key or of several in step, and values that scatter.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal};

/// Values that keys of the scene take in turn: a list, or a range.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// The key that varies, as `section.key`.
    key: Option<String>,
    /// Keys that vary in step.
    keys: Option<Vec<String>>,
    /// Values of the key, or of all the keys, in turn.
    values: Option<Vec<toml::Value>>,
    /// First value of a range.
    from: Option<f64>,
    /// Last value of a range.
    to: Option<f64>,
    /// Number of values of a range, with both ends.
    count: Option<usize>,
    /// Spacing of a range.
    #[serde(default)]
    spacing: Spacing,
}

/// Spacing of a range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spacing {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal ratios.
    Log,
}

/// A key whose value scatters: uniformly between two values, or about a mean.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// The key that varies, as `section.key`.
    pub key: String,
    /// Least value of a uniform distribution; of a normal one, what it is cut at.
    from: Option<f64>,
    /// Largest value of a uniform distribution; of a normal one, what it is cut at.
    to: Option<f64>,
    /// Mean of a normal distribution.
    mean: Option<f64>,
    /// Standard deviation of a normal distribution.
    deviation: Option<f64>,
}

/// The most that normal values are off the mean where nothing cuts them, in standard deviations: one in 500 million is farther off.
const LARGEST_DEVIATION: f64 = 6.0;

impl Axis {
    /// The keys that vary.
    pub fn keys(&self) -> impl Iterator<Item = &String> + Clone {
        self.key.iter().chain(self.keys.iter().flatten())
    }

    /// Its name in messages.
    pub fn name(&self) -> String {
        self.keys().cloned().collect::<Vec<_>>().join(" and ")
    }

    /// Number of values.
    pub fn count(&self) -> usize {
        self.values.as_ref().map_or(self.count.unwrap_or(0), Vec::len)
    }

    /// Values of its keys at a place of the axis, as TOML.
    pub(super) fn at(&self, index: usize) -> Vec<toml::Value> {
        match &self.values {
            Some(values) => match (&self.keys, values.get(index)) {
                (Some(_), Some(toml::Value::Array(row))) => row.clone(),
                (_, value) => value.cloned().into_iter().collect(),
            },
            None => vec![self.number(index)],
        }
    }

    /// A value of a range; where all of them are whole they are written so, as keys that count want them.
    fn number(&self, index: usize) -> toml::Value {
        const EXACT: f64 = (1_u64 << 53) as f64;
        let is_whole = |value: f64| value.fract() == 0.0 && value.abs() < EXACT;
        match (0..self.count()).all(|index| is_whole(self.in_range(index))) {
            true => toml::Value::Integer(self.in_range(index) as i64),
            false => toml::Value::Float(self.in_range(index)),
        }
    }

    fn in_range(&self, index: usize) -> f64 {
        let (from, to) = (self.from.unwrap_or(0.0), self.to.unwrap_or(0.0));
        let last = self.count.unwrap_or(1).saturating_sub(1).max(1);
        let share = index as f64 / last as f64;
        match self.spacing {
            _ if index == 0 => from,
            _ if index == last => to,
            // Steps of whole numbers reach them exactly.
            Spacing::Linear if ((to - from) / last as f64).fract() == 0.0 => {
                from + (to - from) / last as f64 * index as f64
            }
            Spacing::Linear => from + share * (to - from),
            Spacing::Log => from * (to / from).powf(share),
        }
    }

    /// What the types do not say.
    pub(super) fn problem(&self) -> Option<String> {
        let name = match self.name() {
            name if name.is_empty() => {
                return Some("an [[axis]] names no key of the scene: write key = \"geometry.radius_mm\"".to_owned());
            }
            name => name,
        };
        if self.key.is_some() && self.keys.is_some() {
            return Some(format!("the [[axis]] of {name} has both `key` and `keys`: write one"));
        }
        match (&self.values, self.from, self.to, self.count) {
            (Some(values), None, None, None) if values.is_empty() => {
                Some(format!("the [[axis]] of {name} has no values"))
            }
            (Some(values), None, None, None) => self.problem_of_rows(values),
            (None, Some(from), Some(to), Some(count)) => {
                let finite = from.is_finite() && to.is_finite();
                match (count, self.spacing) {
                    _ if !finite => Some(format!("{name} goes from {from} to {to}: both ends are numbers")),
                    _ if self.keys.is_some() => {
                        Some(format!("{name} go in step: give `values` of all, as [[a, b], [c, d]]"))
                    }
                    _ if from == to => {
                        Some(format!("{name} goes from {from} to {to}, which is one value: write `values`"))
                    }
                    (0 | 1, _) => Some(format!("{name}: count = {count}, and a range has both its ends: 2 or more")),
                    (_, Spacing::Log) if from <= 0.0 || to <= 0.0 => {
                        Some(format!("{name} goes from {from} to {to} in equal ratios, which wants both above 0"))
                    }
                    _ => None,
                }
            }
            _ => Some(format!("the [[axis]] of {name} wants either `values`, or `from`, `to` and `count`")),
        }
    }

    fn problem_of_rows(&self, values: &[toml::Value]) -> Option<String> {
        let keys = self.keys.as_ref()?.len();
        let is_row = |value: &&toml::Value| value.as_array().is_some_and(|row| row.len() == keys);
        let odd = values.iter().find(|value| !is_row(value))?;
        Some(format!(
            "the [[axis]] of {} has {keys} keys, and one of its values is {odd}: write a list of {keys}",
            self.name()
        ))
    }
}

impl Scatter {
    /// The value below which lies so much of its probability, from 0 to 1.
    pub(super) fn quantile(&self, share: f64) -> f64 {
        let Some((mean, deviation)) = self.mean.zip(self.deviation) else {
            let (from, to) = (self.from.unwrap_or(0.0), self.to.unwrap_or(0.0));
            return from + share * (to - from);
        };
        let Ok(normal) = Normal::new(mean, deviation) else { return mean };
        let least = self.from.unwrap_or(mean - LARGEST_DEVIATION * deviation);
        let most = self.to.unwrap_or(mean + LARGEST_DEVIATION * deviation);
        let (low, high) = (normal.cdf(least), normal.cdf(most));
        normal.inverse_cdf(low + share * (high - low)).clamp(least, most)
    }

    /// What the types do not say.
    pub(super) fn problem(&self) -> Option<String> {
        let Self { key, from, to, mean, deviation } = self;
        let numbers = [from, to, mean, deviation].into_iter().flatten();
        if let Some(odd) = numbers.into_iter().find(|number| !number.is_finite()) {
            return Some(format!("the [[scatter]] of {key} has {odd}, which is no number"));
        }
        if let Some((from, to)) = from.zip(*to).filter(|(from, to)| from >= to) {
            return Some(format!("the [[scatter]] of {key} goes from {from} to {to}: the smaller comes first"));
        }
        match (mean, deviation, from, to) {
            (None, None, Some(_), Some(_)) => None,
            (Some(_), Some(deviation), ..) if *deviation <= 0.0 => Some(format!(
                "the [[scatter]] of {key} has deviation = {deviation}, which is above 0 where anything scatters"
            )),
            (Some(mean), Some(_), from, to) => {
                let outside = from.is_some_and(|from| from >= *mean) || to.is_some_and(|to| to <= *mean);
                outside.then(|| format!("the [[scatter]] of {key} is cut on one side of its mean {mean} alone: put the mean between `from` and `to`"))
            }
            _ => Some(format!(
                "the [[scatter]] of {key} wants `from` and `to` (uniform), or `mean` and `deviation` (normal)"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(text: &str) -> Axis {
        toml::from_str(text).unwrap()
    }

    #[test]
    fn ranges_have_both_ends() {
        let linear = axis("key = \"a.b\"\nfrom = 1\nto = 2\ncount = 5");
        let values: Vec<_> = (0..5).flat_map(|index| linear.at(index)).filter_map(|value| value.as_float()).collect();
        assert_eq!(values, [1.0, 1.25, 1.5, 1.75, 2.0]);
        let seeds = axis("key = \"a.b\"\nfrom = 1\nto = 100\ncount = 100");
        let values: Vec<_> =
            (0..100).flat_map(|index| seeds.at(index)).filter_map(|value| value.as_integer()).collect();
        assert_eq!(values, (1..=100).collect::<Vec<i64>>());
        let log = axis("key = \"a.b\"\nfrom = 1\nto = 100\ncount = 3\nspacing = \"log\"");
        let values: Vec<_> = (0..3).flat_map(|index| log.at(index)).filter_map(|value| value.as_integer()).collect();
        assert_eq!(values, [1, 10, 100], "whole numbers, as keys that count want them");
    }

    #[test]
    fn scatter_is_what_it_says() {
        let normal: Scatter = toml::from_str("key = \"a.b\"\nmean = 10\ndeviation = 2").unwrap();
        // The quantile of the standard normal at 0.975 is 1.959964 (any table).
        assert!((normal.quantile(0.975) - 13.919928).abs() < 1e-6 && (normal.quantile(0.5) - 10.0).abs() < 1e-9);
        assert!(normal.quantile(0.0).is_finite() && normal.quantile(1.0).is_finite());
        let cut: Scatter = toml::from_str("key = \"a.b\"\nmean = 10\ndeviation = 2\nfrom = 9\nto = 11").unwrap();
        assert_eq!((cut.quantile(0.0), cut.quantile(1.0)), (9.0, 11.0));
        let uniform: Scatter = toml::from_str("key = \"a.b\"\nfrom = 9\nto = 11").unwrap();
        assert_eq!(uniform.quantile(0.25), 9.5);
    }
}
