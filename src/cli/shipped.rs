//! The scenes and studies of `pipelines/`, which are in the program itself and run from any folder.

use std::path::{Component, Path, PathBuf};

/// A scene or a study that comes with the program.
#[derive(Debug)]
pub(super) struct Shipped {
    /// Its path in `pipelines/`, without the ending.
    pub(super) name: &'static str,
    /// What is in its file.
    pub(super) text: &'static str,
}

macro_rules! shipped {
    ($($name:literal)+) => {
        &[$(Shipped { name: $name, text: include_str!(concat!("../../pipelines/", $name, ".toml")) }),+]
    };
}

/// All of them: scenes, benchmarks, extremes, studies.
pub(super) const SHIPPED: &[Shipped] = shipped! {
    "baseline-accurate"
    "baseline-path"
    "baseline-quarter"
    "baseline-reference"
    "baseline-tolerance"
    "baseline-uniform"
    "baseline"
    "equal-sense-adaptive"
    "equal-sense"
    "length-150"
    "length-600"
    "radius-15-thickness-0.06"
    "radius-15"
    "radius-20"
    "radius-6-thickness-0.15"
    "structures/imperfect-column"
    "structures/imperfect-trac-boom"
    "structures/right-angle-frame"
    "structures/trac-boom"
    "verification/bistable-tape"
    "verification/cantilever-end-shear"
    "verification/cone-pressure"
    "verification/cross-ply-fold"
    "verification/cured-plate-saddle"
    "verification/cured-plate-snap"
    "verification/cured-plate"
    "verification/hinged-roof-12.7-snap"
    "verification/hinged-roof-12.7"
    "verification/hinged-roof-6.35-snap"
    "verification/laminated-plate"
    "verification/pinched-hemisphere"
    "verification/rolled-cantilever"
    "verification/scordelis-lo-roof"
    "verification/slit-annular-plate"
    "verification/sphere-zone-pressure"
    "extreme/arc-020"
    "extreme/arc-200"
    "extreme/arc-350"
    "extreme/arc-359"
    "extreme/aspect-1000"
    "extreme/bifurcation"
    "extreme/degree-2"
    "extreme/degree-3"
    "extreme/degree-4"
    "extreme/degree-5"
    "extreme/equal-sense"
    "extreme/increment-30"
    "extreme/increments-1e-6"
    "extreme/laminate-1000-across"
    "extreme/laminate-1000-along"
    "extreme/laminate-1000-crossed"
    "extreme/length-over-radius-002"
    "extreme/length-over-radius-010"
    "extreme/length-over-radius-100"
    "extreme/length-over-radius-300"
    "extreme/modulus-1e-3"
    "extreme/modulus-1e12"
    "extreme/no-equilibrium"
    "extreme/one-element-degree-2"
    "extreme/one-element"
    "extreme/poisson-0.49"
    "extreme/poisson-0"
    "extreme/poisson-minus-0.5"
    "extreme/radius-over-thickness-0020"
    "extreme/radius-over-thickness-0100"
    "extreme/radius-over-thickness-1000"
    "extreme/radius-over-thickness-5000"
    "extreme/roof-metres"
    "extreme/roof-micrometres"
    "extreme/roof-millimetres"
    "extreme/rotation-170"
    "extreme/snap-back"
    "extreme/units-metres"
    "extreme/units-micrometres"
    "studies/length-limit"
    "studies/length"
    "studies/radius-thickness"
    "sweeps/fold-moments"
    "sweeps/imperfect-trac-booms"
    "sweeps/mesh-error"
    "sweeps/roof-snap"
    "sweeps/scattered-springs"
};

/// Names offered for a wrong one, at most.
const MOST_OFFERED: usize = 3;

impl Shipped {
    /// Finds what a name stands for: a path in `pipelines/`, or the last part of it where one alone ends so.
    pub(super) fn named(name: &Path) -> Option<&'static Self> {
        let name = name.to_str()?;
        let mut ending = SHIPPED.iter().filter(|shipped| shipped.last_name() == name);
        SHIPPED.iter().find(|shipped| shipped.name == name).or_else(|| {
            let first = ending.next()?;
            ending.next().is_none().then_some(first)
        })
    }

    /// Finds the scene that a shipped study calls by its path, such as "studies/../baseline.toml".
    pub(super) fn at(path: &Path) -> Option<&'static Self> {
        let mut parts: Vec<&str> = Vec::new();
        for part in path.components() {
            match part {
                Component::ParentDir => _ = parts.pop()?,
                Component::Normal(part) => parts.push(part.to_str()?),
                _ => {}
            }
        }
        let path = parts.join("/");
        SHIPPED.iter().find(|shipped| path.strip_suffix(".toml") == Some(shipped.name))
    }

    /// The file that it would be in a folder of the user's: logs are named after it.
    pub(super) fn file(&self) -> PathBuf {
        PathBuf::from(format!("{}.toml", self.name))
    }

    /// The name without its folders.
    pub(super) fn last_name(&self) -> &'static str {
        self.name.rsplit_once('/').map_or(self.name, |(_, name)| name)
    }

    /// What it shows: the first sentence of the comment at its head.
    pub(super) fn summary(&self) -> String {
        let comment = self.text.lines().map_while(|line| line.strip_prefix('#'));
        let whole = comment.map(str::trim).collect::<Vec<_>>().join(" ");
        match whole.split_once(". ") {
            Some((first, _)) => format!("{first}."),
            None => whole,
        }
    }
}

/// The names nearest to a wrong one, the nearest first.
pub(super) fn nearest_names(wrong: &Path) -> Vec<&'static str> {
    let stem =
        if wrong.extension().is_some_and(|ending| ending == "toml") { wrong.file_stem() } else { wrong.file_name() };
    let wanted = stem.unwrap_or_default().to_string_lossy().to_lowercase();
    let distance = |shipped: &Shipped| {
        let own = shipped.last_name();
        let part = wanted.len() > 3 && own.contains(&wanted);
        let slips = strsim::osa_distance(&wanted, own);
        (part || 3 * slips <= wanted.chars().count().max(3)).then_some(slips)
    };
    let mut near: Vec<(usize, &str)> =
        SHIPPED.iter().filter_map(|shipped| Some((distance(shipped)?, shipped.name))).collect();
    near.sort_unstable();
    near.into_iter().take(MOST_OFFERED).map(|(_, name)| name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every file of a folder in `pipelines/`, and of the folders in it, without its ending.
    fn files(folder: &Path, prefix: &str, found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = format!("{prefix}{}", path.file_name().unwrap().to_str().unwrap());
            match path.is_dir() {
                true => files(&path, &format!("{name}/"), found),
                false => found.push(name.strip_suffix(".toml").unwrap().to_owned()),
            }
        }
    }

    #[test]
    fn every_file_of_the_folder_is_in_the_program() {
        let mut found = Vec::new();
        files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("pipelines"), "", &mut found);
        found.sort_unstable();
        let mut shipped: Vec<&str> = SHIPPED.iter().map(|shipped| shipped.name).collect();
        shipped.sort_unstable();
        assert_eq!(shipped, found);
    }

    #[test]
    fn names_are_found_whole_or_by_their_last_part() {
        let found = |name: &str| Shipped::named(Path::new(name)).map(|shipped| shipped.name);
        assert_eq!(found("baseline"), Some("baseline"));
        assert_eq!(found("extreme/arc-020"), Some("extreme/arc-020"));
        assert_eq!(found("arc-020"), Some("extreme/arc-020"));
        assert_eq!(found("equal-sense"), Some("equal-sense"), "the extreme of that name needs its folder");
        assert_eq!(found("baseline.toml"), None, "that is a file");
        assert_eq!(Shipped::at(Path::new("studies/../baseline.toml")).map(|shipped| shipped.name), Some("baseline"));
        assert_eq!(Shipped::named(Path::new("poisson-0.49")).unwrap().file(), Path::new("extreme/poisson-0.49.toml"));
    }

    #[test]
    fn the_nearest_names_are_offered() {
        let near = |name: &str| nearest_names(Path::new(name));
        assert_eq!(near("basline")[0], "baseline");
        assert_eq!(near("pipelines/baseline.toml")[0], "baseline");
        assert!(near("poisson-0.5").contains(&"extreme/poisson-0.49"));
        assert!(near("my-own-boom").is_empty());
    }

    #[test]
    fn every_one_says_what_it_shows_in_a_sentence() {
        for shipped in SHIPPED {
            let summary = shipped.summary();
            assert!(summary.ends_with('.') && summary.len() > 8, "{}: {summary}", shipped.name);
        }
    }
}
