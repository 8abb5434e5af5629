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
    pub(super) fn read(path: &Path, chosen: &Chosen, mut see: impl FnMut(&Portion)) -> Result<Self, Failure> {
        let mut gathered = Gathered::with_probes(chosen.probes());
        let read = read_through(path, |portion| {
            see(portion);
            gathered.take(portion);
        })?;
        let mut records = gathered.records;
        remove_redefined(&redefined_probes(&read.log), &mut records);
        let drawn = match chosen.is_none() {
            true if read.scene.end_rotation().is_some() => Vec::new(),
            true => read.scene.probes.first().map(|probe| probe.name.clone()).into_iter().collect(),
            false => {
                let quantities = chosen.quantities(path, &read.scene)?;
                quantities.iter().filter_map(|quantity| Some(quantity.probe()?.to_owned())).collect::<Vec<_>>()
            }
        };
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
    let names = names_of(logs);
    let named = names.into_iter().zip(logs);
    let runs: Vec<PlottedRun> =
        named.map(|(name, log)| PlottedRun { name, scene: &log.read.scene, records: &log.records }).collect();
    let title = if let [only] = &runs[..] { only.name.clone() } else { String::new() };
    let turned = logs.iter().filter(|log| log.read.scene.end_rotation().is_some()).count();
    let drawn = if !chosen.is_none() {
        let quantities = logs.iter().map(|log| chosen.quantities(&log.path, &log.read.scene));
        let [x, y] = quantities.reduce(|first, next| next.and(first)).ok_or(Failure::NoCommonCurve)??;
        let file = format!("{}-over-{}.svg", y.in_file_name(), x.in_file_name());
        (file, curve_plot(&runs, &x, &y, &title)?)
    } else if turned == logs.len() {
        ("moment-rotation.svg".to_owned(), moment_rotation_plot(&runs, &title)?)
    } else if turned > 0 {
        return Err(Failure::NoCommonCurve);
    } else {
        let Some([x, y]) = load_probe(&runs) else {
            return if logs.len() > 1 { Err(Failure::NoProbe { log: logs[0].path.clone() }) } else { Ok(None) };
        };
        // All of them must have it.
        let of_probe = Chosen { x: Some(format!("probe.{}", x.probe().unwrap_or_default())), y: None };
        logs.iter().try_for_each(|log| of_probe.quantities(&log.path, &log.read.scene).map(drop))?;
        ("load-probe.svg".to_owned(), curve_plot(&runs, &x, &y, &title)?)
    };
    Ok(Some((drawn.0, drawn.1.into_bytes())))
}

/// What a log is called in pictures.
pub(super) fn name_of(log: &Path) -> String {
    log.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// The names of some logs; their paths, where names are the same.
fn names_of(logs: &[PlottedLog]) -> Vec<String> {
    let names: Vec<String> = logs.iter().map(|log| name_of(&log.path)).collect();
    let is_twice = |name: &String| names.iter().filter(|other| *other == name).count() > 1;
    let shown = |(name, log): (&String, &PlottedLog)| {
        if is_twice(name) { path_in_line(&log.path) } else { name.clone() }
    };
    names.iter().zip(logs).map(shown).collect()
}
