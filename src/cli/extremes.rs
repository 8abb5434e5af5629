//! `foldline extremes`: scenes at and beyond the edge, and whether each ends as it states.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;

use super::columns::{Column, Columns};
use super::failure::Failure;
use super::output::{eprint, print, print_json};
use super::scene_file::read_scene;
use super::session::{open_archive, use_threads};
use super::shipped::SHIPPED;
use super::terminal::output_columns;
use super::wrapped::hanging;
use crate::scene::Scene;
use crate::study::{ExtremeRow, ExtremesSuite};
use crate::units::{count, duration};

/// Run scenes at and beyond the edge, and report whether each ends as it states
///
/// A scene states its end in a table `[expect]`; see `foldline help scene`. A line is printed as soon as its scene has
/// ended; what is wrong with it follows below.
#[derive(Args, Debug)]
#[command(after_help = COLUMNS)]
pub(super) struct Arguments {
    /// Run only scenes whose names contain this
    filter: Option<String>,
    /// Folder of the scenes [default: extreme/ of those that come with the program]
    #[arg(long, value_name = "FOLDER")]
    scenes: Option<PathBuf>,
    /// Seconds that one run of a scene may take
    #[arg(long, value_name = "SECONDS", default_value_t = 120, value_parser = clap::value_parser!(u64).range(1..))]
    limit: u64,
    /// Threads; the results are the same on any number of them [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Folder to keep the logs of the runs in, each named after the hash of its scene: those that are finished are read and not run
    /// again, whatever build made them [default: none is kept]
    #[arg(long, value_name = "DIR")]
    logs: Option<PathBuf>,
    /// Print a JSON object for each scene
    #[arg(long)]
    json: bool,
}

/// Where the extremes are among the scenes that come with the program.
const SHIPPED_FOLDER: &str = "extreme/";

/// Below the options in `--help`.
const COLUMNS: &str = "\
Columns:
  outcome    finished, or the kind of stop; an error follows below
  as stated  whether it ended as its [expect] says, and all numbers are sound
  error      largest error of the peak before the first jump and of the last result (moment, first probe,
             strain energy) against those that [expect] states, which says how much is allowed
  steps      load steps with an equilibrium
  iter       Newton iterations, those of solves that were rejected included
  residual   largest |residual| of all equilibria over the forces
  W - E      work less strain energy over the load steps that did not jump, relative to the largest
             strain energy; what jumps release and refinement changes is not counted
  cond       largest over smallest magnitude of the eigenvalues of the last stiffness (estimate)
  asym       |x.(K y) - y.(K x)| of the last stiffness, and of its stored half against it,
             relative to |x| |K y|
  bits       bits of the last moment (first probe, strain energy) that survive a change of one unit
             in the last place of a length of the geometry
  wall       time of the run; each scene is run twice

Exit codes: 0 all ended as stated, 1 some did not, 2 wrong arguments or a wrong scene";

impl Arguments {
    /// Runs and prints; the exit code.
    pub(super) fn run(self) -> Result<u8, Failure> {
        let files = match &self.scenes {
            Some(folder) => list_folder(folder)?,
            None => list_shipped(),
        };
        let names = self.chosen(files.keys())?;
        let scenes = read_scenes(&files, &names)?;
        let threads = use_threads(self.threads.map(usize::from))?;
        let fresh = tempfile::tempdir().map_err(|source| Failure::Write { path: std::env::temp_dir(), source })?;
        let archive = open_archive(self.logs.as_deref().unwrap_or(fresh.path()), threads)?;
        let table = ExtremesTable::new(names.iter().map(|name| stem(name)), output_columns());
        if !self.json {
            print(&table.head())?;
        }
        let begin = Instant::now();
        let mut suite = ExtremesSuite::new(scenes, Duration::from_secs(self.limit), archive);
        let mut failed = 0;
        for row in names.iter().filter_map(|name| suite.run(name)) {
            failed += usize::from(!row.as_stated);
            if self.json {
                print_json(&row)?;
            } else {
                print(&table.row(&row))?;
            }
        }
        let verdict = match failed {
            0 => "all as stated".to_owned(),
            some => format!("{some} not as stated"),
        };
        eprint(&format!("{}, {verdict}, {}", count(names.len(), "scene"), duration(begin.elapsed().as_secs_f64())));
        Ok(u8::from(failed > 0))
    }

    /// Names that the filter leaves.
    fn chosen<'n>(&self, names: impl Iterator<Item = &'n String> + Clone) -> Result<Vec<String>, Failure> {
        let matches = |name: &&String| self.filter.as_ref().is_none_or(|filter| stem(name).contains(filter.as_str()));
        let chosen: Vec<String> = names.clone().filter(matches).cloned().collect();
        if chosen.is_empty() {
            let known = names.map(|name| stem(name).to_owned()).collect();
            return Err(Failure::NoSuchScene {
                filter: self.filter.clone(),
                folder: self.scenes.clone().unwrap_or_else(|| SHIPPED_FOLDER.into()),
                known,
            });
        }
        Ok(chosen)
    }
}

/// Every scene file of a folder by its name.
fn list_folder(folder: &Path) -> Result<BTreeMap<String, PathBuf>, Failure> {
    let failed = |source| Failure::Read { path: folder.to_path_buf(), source };
    let mut files = BTreeMap::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            files.insert(path.file_name().unwrap_or_default().to_string_lossy().into_owned(), path);
        }
    }
    Ok(files)
}

/// Every extreme that comes with the program by the name that its file has.
fn list_shipped() -> BTreeMap<String, PathBuf> {
    let extremes = SHIPPED.iter().filter(|shipped| shipped.name.starts_with(SHIPPED_FOLDER));
    extremes.map(|shipped| (format!("{}.toml", shipped.last_name()), shipped.name.into())).collect()
}

/// The scenes that are run, and those that they are compared with; others in the folder may be as they are.
fn read_scenes(files: &BTreeMap<String, PathBuf>, names: &[String]) -> Result<BTreeMap<String, Scene>, Failure> {
    let mut scenes = BTreeMap::new();
    let mut wanted: Vec<String> = names.to_vec();
    while let Some(name) = wanted.pop() {
        let Some(path) = files.get(&name).filter(|_| !scenes.contains_key(&name)) else { continue };
        let scene = read_scene(path, &[])?.scene;
        wanted.extend(scene.expect.iter().filter_map(|expect| expect.same_as.clone()));
        scenes.insert(name, scene);
    }
    Ok(scenes)
}

/// A file name without its ending.
fn stem(name: &str) -> &str {
    name.strip_suffix(".toml").unwrap_or(name)
}

/// The table that `foldline extremes` prints, a line for each scene as it ends.
pub struct ExtremesTable {
    table: Columns,
    columns: Option<usize>,
}

impl ExtremesTable {
    /// Creates a table whose columns are wide enough for these names; some are left out where a terminal has fewer `columns`.
    pub fn new<'n>(names: impl Iterator<Item = &'n str>, columns: Option<usize>) -> Self {
        let widest = names.map(|name| name.chars().count()).chain([5]).max().unwrap_or(5);
        let all = vec![
            Column::of_words("scene", widest),
            Column::of_words("outcome", 19).behind(2),
            Column::of_words("as stated", 9),
            Column::of_numbers("error", 7),
            Column::of_numbers("steps", 5).rank(2),
            Column::of_numbers("iter", 6).rank(3),
            Column::of_numbers("residual", 8).rank(5),
            Column::of_numbers("W - E", 7).rank(4),
            Column::of_numbers("cond", 6).rank(7),
            Column::of_numbers("asym", 6).rank(8),
            Column::of_numbers("bits", 4).rank(6),
            Column::of_numbers("wall", 8).rank(1),
        ];
        Self { table: Columns::fitting(all, columns), columns }
    }

    /// Returns the line with the heads of the columns.
    pub fn head(&self) -> String {
        self.table.head()
    }

    /// Returns the line of a scene and, below it, the error that ended the scene and the faults found.
    pub fn row(&self, row: &ExtremeRow) -> String {
        let small = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.0e}"));
        let balance = row.energy_balance.map_or_else(|| "-".to_owned(), |value| format!("{value:+.0e}"));
        let mut text = self.table.row(&[
            stem(&row.scene).to_owned(),
            row.outcome.name().to_owned(),
            if row.as_stated { "yes" } else { "NO" }.to_owned(),
            row.error.map_or_else(|| "-".to_owned(), |error| format!("{:.2} %", 100.0 * error)),
            row.load_steps.to_string(),
            row.iterations.to_string(),
            small(row.worst_residual),
            balance,
            small(row.condition),
            small(row.symmetry_error),
            row.significant_bits.map_or_else(|| "-".to_owned(), |bits| format!("{bits:.0}")),
            format!("{:.1} s", row.wall_s),
        ]);
        let below = |head: &str, said: String| hanging(&format!("    {head}"), &said, self.columns) + "\n";
        let message = row.message.iter().map(|message| below("", message.clone()));
        let reason = row.inexact.iter().map(|reason| below("inexact: ", reason.clone()));
        let faults = row.faults.iter().map(|fault| below("NO: ", fault.to_string()));
        text.extend(message.chain(reason).chain(faults));
        text
    }
}
