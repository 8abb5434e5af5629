//! Logs, as curves are drawn of them.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::log_file::{Gathered, ReadLog, read_through};
use super::output::path_in_line;
use crate::history::{redefined_probes, remove_redefined};
use crate::journal::Portion;
use crate::record::{Record, Report};
use crate::scene::Scene;
use crate::study::equilibria;
use crate::view::{PlottedRun, Quantity, curve_plot, load_probe, moment_rotation_plot, quantities_of, quantity_named};

/// What `--x` and `--y` name.
#[derive(Debug)]
pub(super) struct Chosen {
    pub(super) x: Option<String>,
    pub(super) y: Option<String>,
}

impl Chosen {
    /// Whether nothing is chosen, so that the curve of the structure is drawn.
    pub(super) fn is_none(&self) -> bool {
        self.x.is_none() && self.y.is_none()
    }

    /// Both names, with the scene's own where one is not given.
    fn names(&self, scene: &Scene) -> [String; 2] {
        let [parameter, response] = match scene.end_rotation() {
            Some(_) => ["rotation", "moment"],
            None => ["load_factor", "load_factor"],
        };
        let name = |given: &Option<String>, default: &str| given.clone().unwrap_or_else(|| default.to_owned());
        [name(&self.x, parameter), name(&self.y, response)]
    }

    /// Both quantities of a run of this scene.
    fn quantities(&self, log: &Path, scene: &Scene) -> Result<[Quantity; 2], Failure> {
        let of_name = |name: &String| {
            let no_such = || {
                let known = quantities_of(scene).into_iter().map(|quantity| quantity.name).collect();
                Failure::NoSuchQuantity { log: log.to_path_buf(), quantity: name.clone(), known }
            };
            quantity_named(scene, name).ok_or_else(no_such)
        };
        let [x, y] = self.names(scene);
        Ok([of_name(&x)?, of_name(&y)?])
    }

    /// What may be names of probes.
    fn probes(&self) -> Vec<String> {
        let named = [&self.x, &self.y].into_iter().flatten();
        let plain = |name: &String| {
            let name = name.trim_start_matches(['-', '−']);
            name.strip_prefix("probe.").unwrap_or(name).to_owned()
        };
        named.map(plain).collect()
    }
}

/// A log with the stages of its run.
pub(super) struct PlottedLog {
    path: PathBuf,
    pub(super) read: ReadLog,
    pub(super) records: Vec<Record>,
}

impl PlottedLog {
    /// Reads a log once, showing it to `see` portion by portion; readings that it lacks of the probes that are drawn are made.
    pub(super) fn read(path: &Path, chosen: &Chosen, see: impl FnMut(&Portion)) -> Result<Self, Failure> {
        Self::read_with(path, chosen, None, see)
    }

    /// Reads logs that are drawn in one picture: where nothing is chosen, all of them for the first probe of the first.
    pub(super) fn read_all(paths: &[PathBuf], chosen: &Chosen) -> Result<Vec<Self>, Failure> {
        let mut logs: Vec<Self> = Vec::new();
        for path in paths {
            let probe = logs.first().and_then(|first| first.read.scene.probes.first()).map(|probe| probe.name.clone());
            logs.push(Self::read_with(path, chosen, probe, |_| {})?);
        }
        Ok(logs)
    }

    /// Where nothing is chosen, `probe` is drawn, or the scene's first.
    fn read_with(
        path: &Path,
        chosen: &Chosen,
        probe: Option<String>,
        mut see: impl FnMut(&Portion),
    ) -> Result<Self, Failure> {
        let mut gathered = Gathered::with_probes(chosen.probes().into_iter().chain(probe.clone()).collect());
        let read = read_through(path, |portion| {
            see(portion);
            gathered.take(portion);
        })?;
        let mut records = gathered.records;
        remove_redefined(&redefined_probes(&read.log), &mut records);
        let mut drawn: Vec<String> = match chosen.is_none() {
            true if read.scene.end_rotation().is_some() => Vec::new(),
            true => probe.or_else(|| Some(read.scene.probes.first()?.name.clone())).into_iter().collect(),
            false => {
                let quantities = chosen.quantities(path, &read.scene)?;
                quantities.iter().filter_map(|quantity| Some(quantity.probe()?.to_owned())).collect()
            }
        };
        drawn.retain(|name| read.scene.probes.iter().any(|probe| probe.name == *name));
        let lacks = |report: &Report, name: &String| report.probes.iter().all(|reading| reading.name != *name);
        // As where the run began without the probe.
        let is_unread = equilibria(&records).any(|record| drawn.iter().any(|name| lacks(&record.report, name)));
        let read = if is_unread { read.whole(path)? } else { read };
        if is_unread {
            records = read.records_of_scene(path)?;
        }
        Ok(Self { path: path.to_path_buf(), read, records })
    }
}

/// The curve of some logs, if they have one, as a file.
pub(super) fn curve(logs: &[PlottedLog], chosen: &Chosen) -> Result<Option<(String, Vec<u8>)>, Failure> {
    let Some(first) = logs.first() else { return Ok(None) };
    let named = names_of(logs.iter().map(|log| &*log.path)).into_iter().zip(logs);
    let runs: Vec<PlottedRun> =
        named.map(|(name, log)| PlottedRun { name, scene: &log.read.scene, records: &log.records }).collect();
    // Of several runs the legend has the names.
    let title = if let [only] = &runs[..] { only.name.clone() } else { String::new() };
    let all_have =
        |chosen: &Chosen| logs.iter().try_for_each(|log| chosen.quantities(&log.path, &log.read.scene).map(drop));
    let turned = logs.iter().filter(|log| log.read.scene.end_rotation().is_some()).count();
    let drawn = if !chosen.is_none() {
        all_have(chosen)?;
        let [x, y] = chosen.quantities(&first.path, &first.read.scene)?;
        let file = format!("{}-over-{}.svg", y.in_file_name(), x.in_file_name());
        (file, curve_plot(&runs, &x, &y, &title)?)
    } else if turned == logs.len() {
        ("moment-rotation.svg".to_owned(), moment_rotation_plot(&runs, &title)?)
    } else if turned > 0 {
        return Err(Failure::NoCommonCurve);
    } else {
        let Some([x, y]) = load_probe(&runs) else {
            return if logs.len() > 1 { Err(Failure::NoProbe { log: first.path.clone() }) } else { Ok(None) };
        };
        all_have(&Chosen { x: x.probe().map(|name| format!("probe.{name}")), y: None })?;
        ("load-probe.svg".to_owned(), curve_plot(&runs, &x, &y, &title)?)
    };
    Ok(Some((drawn.0, drawn.1.into_bytes())))
}

/// What a log is called in pictures.
pub(super) fn name_of(log: &Path) -> String {
    log.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The names of some logs; their paths, where names are the same.
pub(super) fn names_of<'p>(logs: impl Iterator<Item = &'p Path> + Clone) -> Vec<String> {
    let names: Vec<String> = logs.clone().map(name_of).collect();
    let is_twice = |name: &String| names.iter().filter(|other| *other == name).count() > 1;
    let shown = |(name, log): (&String, &Path)| if is_twice(name) { path_in_line(log) } else { name.clone() };
    names.iter().zip(logs).map(shown).collect()
}
