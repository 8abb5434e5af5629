//! Sweeps as files: a scene, what of it varies, and what is collected of each run.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::axis::{Axis, Scatter};
use super::error::SweepError;
use super::quantity::Quantity;

/// Points that Sobol's sequence is known for.
const MOST_OF_SOBOL: usize = 1 << 16;

/// Axes that it is known for.
const MOST_AXES_OF_SOBOL: usize = sobol_burley::NUM_DIMENSIONS as usize;

/// The most tasks of a sweep.
pub const MOST_TASKS: usize = 1_000_000;

/// A sweep over designs, as it is written.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepFile {
    /// What it shows.
    pub title: String,
    /// The scene that is varied: a path from the sweep's folder, or the name of a scene that comes with the program.
    pub scene: String,
    /// Settings `section.key=value` laid over every scene.
    #[serde(default)]
    pub settings: Vec<String>,
    /// Whether axes are combined or go in step.
    #[serde(default)]
    pub combine: Combine,
    /// What varies, in the order of the columns.
    #[serde(default)]
    pub axis: Vec<Axis>,
    /// How scattered values are drawn; wanted where there are any.
    pub sample: Option<Sample>,
    /// What is drawn at random: every sample with every combination of the axes.
    #[serde(default)]
    pub scatter: Vec<Scatter>,
    /// Settings laid over a task's own for the run that it is compared with.
    pub reference: Option<Reference>,
    /// What is collected of each run; where nothing is written, what a scene of its kind is run for.
    #[serde(default)]
    pub outputs: Vec<Quantity>,
}

/// How axes are combined.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Combine {
    /// Every value of one with every value of the others; the last axis changes fastest.
    #[default]
    All,
    /// The first values of all, then the second ones.
    Zip,
}

/// How points are spread over what is scattered.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sample {
    /// Number of points.
    pub count: usize,
    /// The way.
    #[serde(default)]
    pub method: Method,
    /// The same seed gives the same points.
    #[serde(default)]
    pub seed: u32,
}

/// Ways of spreading points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Each of as many strata of equal probability as there are points holds one, along every axis (McKay, Beckman & Conover 1979).
    #[default]
    LatinHypercube,
    /// Sobol's sequence with Owen's scrambling: fills the space evenly, and goes on doing so with more points.
    Sobol,
    /// Independent points.
    Random,
}

/// The run that a task is compared with.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Settings `section.key=value` laid over those of the task.
    pub settings: Vec<String>,
}

impl SweepFile {
    /// Reads a sweep; errors call it `file`.
    ///
    /// # Errors
    /// Where the text is none, or what it asks for cannot be.
    pub fn parse(text: &str, file: &str) -> Result<Self, SweepError> {
        let parsed: Result<Self, _> = toml::from_str(text);
        let sweep = parsed.map_err(|why| SweepError::Syntax { file: file.to_owned(), why: Box::new(why) })?;
        match sweep.problem() {
            Some(problem) => Err(SweepError::Wrong { file: file.to_owned(), problem }),
            None => Ok(sweep),
        }
    }

    /// Names of what varies, in the order of the columns.
    pub fn columns(&self) -> Vec<String> {
        let axes = self.axis.iter().flat_map(Axis::keys);
        axes.chain(self.scatter.iter().map(|scatter| &scatter.key)).cloned().collect()
    }

    /// Number of tasks, where it can be told without overflow.
    pub fn count(&self) -> Option<usize> {
        let lengths = self.axis.iter().map(Axis::count);
        let axes = match self.combine {
            Combine::All => lengths.clone().try_fold(1_usize, |product, len| product.checked_mul(len)),
            Combine::Zip => Some(lengths.max().unwrap_or(1)),
        };
        axes?.checked_mul(self.samples())
    }

    /// Number of samples.
    pub(super) fn samples(&self) -> usize {
        self.sample.filter(|_| !self.scatter.is_empty()).map_or(1, |sample| sample.count)
    }

    /// Why Sobol's sequence, where it is asked for, does not go as far.
    fn problem_of_sobol(&self) -> Option<String> {
        let Sample { count, .. } = self.sample.filter(|sample| sample.method == Method::Sobol)?;
        let too_many = match self.scatter.len() {
            axes if axes > MOST_AXES_OF_SOBOL => {
                format!("{MOST_AXES_OF_SOBOL} keys that scatter, and there are {axes}")
            }
            _ if count > MOST_OF_SOBOL => format!("{MOST_OF_SOBOL} points, and {count} are asked for"),
            _ => return None,
        };
        Some(format!("Sobol's sequence is known for {too_many}: write method = \"latin-hypercube\""))
    }

    /// What the types do not say.
    fn problem(&self) -> Option<String> {
        if self.axis.is_empty() && self.scatter.is_empty() {
            return Some(
                "nothing varies: write an [[axis]] with a key of the scene and its values, or a [[scatter]]".to_owned(),
            );
        }
        if let Some(problem) = self.axis.iter().find_map(Axis::problem) {
            return Some(problem);
        }
        if let Some(problem) = self.scatter.iter().find_map(Scatter::problem) {
            return Some(problem);
        }
        match (&self.sample, self.scatter.is_empty()) {
            (None, false) => {
                return Some("a [[scatter]] wants to know how many points: write [sample] count = 200".to_owned());
            }
            (Some(_), true) => return Some("there is a [sample] and no [[scatter]] to draw".to_owned()),
            (Some(Sample { count: 0, .. }), false) => return Some("[sample] count = 0 draws nothing".to_owned()),
            _ => {}
        }
        let mut seen = BTreeSet::new();
        if let Some(twice) = self.columns().into_iter().find(|key| !seen.insert(key.clone())) {
            return Some(format!("{twice} varies twice: give all its values in one [[axis]]"));
        }
        if let Some(fixed) =
            self.settings.iter().find(|setting| seen.contains(setting.split('=').next().unwrap_or("").trim()))
        {
            return Some(format!("{fixed} is set for all tasks, and varies: leave one of the two out"));
        }
        if let (Combine::Zip, Some(first)) = (self.combine, self.axis.first()) {
            let other = self.axis.iter().find(|axis| axis.count() != first.count());
            if let Some(other) = other {
                return Some(format!(
                    "axes go in step (combine = \"zip\"), and {} has {} values where {} has {}",
                    other.name(),
                    other.count(),
                    first.name(),
                    first.count()
                ));
            }
        }
        if let Some(error) = self.outputs.iter().find(|output| output.needs_reference() && self.reference.is_none()) {
            return Some(format!("{error} compares with a reference: write [reference] settings = [...] for its runs"));
        }
        let mut asked = BTreeSet::new();
        if let Some(twice) = self.outputs.iter().map(ToString::to_string).find(|output| !asked.insert(output.clone())) {
            return Some(format!("{twice} is asked for twice in `outputs`"));
        }
        if let Some(problem) = self.problem_of_sobol() {
            return Some(problem);
        }
        match self.count() {
            Some(count) if count <= MOST_TASKS => None,
            count => Some(format!(
                "that is {} tasks, and a sweep has at most {MOST_TASKS}: take fewer values",
                count.map_or("countless".to_owned(), |count| count.to_string())
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TWO: &str = r#"
        title = "two"
        scene = "baseline"
        [[axis]]
        key = "geometry.radius_mm"
        values = [10, 15, 20]
        [[axis]]
        keys = ["material.thickness_mm", "geometry.arc_deg"]
        values = [[0.1, 105], [0.06, 90]]
    "#;

    fn problem(text: &str) -> String {
        SweepFile::parse(text, "s.toml").unwrap_err().to_string()
    }

    #[test]
    fn axes_are_combined_or_go_in_step() {
        let sweep = SweepFile::parse(TWO, "s.toml").unwrap();
        assert_eq!(sweep.count(), Some(6));
        assert_eq!(sweep.columns(), ["geometry.radius_mm", "material.thickness_mm", "geometry.arc_deg"]);
        let zipped = TWO.replace("scene =", "combine = \"zip\"\nscene =");
        assert!(problem(&zipped).contains("has 2 values where geometry.radius_mm has 3"), "{}", problem(&zipped));
        assert_eq!(SweepFile::parse(&zipped.replace(", 20", ""), "s.toml").unwrap().count(), Some(2));
    }

    #[test]
    fn what_cannot_be_is_refused_with_the_way_out() {
        let head = "title = \"t\"\nscene = \"baseline\"\n";
        for (text, said) in [
            ("", "nothing varies"),
            ("[[axis]]\nkey = \"a\"\nvalues = []", "no values"),
            ("[[axis]]\nkey = \"a.b\"\nfrom = 1\nto = 2\ncount = 1", "count"),
            ("[[axis]]\nkey = \"a.b\"\nfrom = 0\nto = 2\ncount = 3\nspacing = \"log\"", "above 0"),
            ("[[axis]]\nkeys = [\"a.b\", \"c.d\"]\nvalues = [[1, 2], [3]]", "2 keys"),
            ("[[axis]]\nkey = \"a.b\"\nvalues = [1]\n[[axis]]\nkey = \"a.b\"\nvalues = [1]", "varies twice"),
            ("settings = [\"a.b=1\"]\n[[axis]]\nkey = \"a.b\"\nvalues = [1]", "is set for all tasks"),
            ("[[scatter]]\nkey = \"a.b\"\nfrom = 1\nto = 2", "how many points"),
            ("[sample]\ncount = 3\n[[axis]]\nkey = \"a.b\"\nvalues = [1]", "no [[scatter]]"),
            ("[sample]\ncount = 3\n[[scatter]]\nkey = \"a.b\"\nmean = 1\ndeviation = -1", "deviation"),
            ("[sample]\ncount = 3\n[[scatter]]\nkey = \"a.b\"\nmean = 1", "deviation"),
            ("[sample]\ncount = 2000000\n[[scatter]]\nkey = \"a.b\"\nfrom = 1\nto = 2", "at most 1000000"),
            ("outputs = [\"error_before\"]\n[[axis]]\nkey = \"a.b\"\nvalues = [1]", "reference"),
            ("outputs = [\"peak_momnt\"]\n[[axis]]\nkey = \"a.b\"\nvalues = [1]", "peak_moment_n_mm"),
            (
                "[sample]\ncount = 70000\nmethod = \"sobol\"\n[[scatter]]\nkey = \"a.b\"\nfrom = 1\nto = 2",
                "65536 points",
            ),
            ("[[axis]]\nkey = \"a.b\"\nfrom = 1\nto = 1\ncount = 3", "one value"),
            ("outputs = [\"snaps\", \"snaps\"]\n[[axis]]\nkey = \"a.b\"\nvalues = [1]", "asked for twice"),
            ("[[axes]]\nkey = 1", "axes"),
        ] {
            let problem = problem(&format!("{head}{text}"));
            assert!(problem.contains(said) && problem.starts_with("s.toml"), "{text}\n{problem}");
        }
    }
}
