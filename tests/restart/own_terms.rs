//! Runs with an energy of the caller's own: their logs say so, and are continued by who has it, and by nobody else.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use foldline::energy::{At, Term, TermSource};
use foldline::history::{
    LoggedSceneError, SnapError, States, Verdict, basis, find_snap, logged_scene, plan, replay_stage, restored_scene,
    verdict,
};
use foldline::journal::{JournalWriter, Log, Manifest, Resume};
use foldline::model::{ModelError, Tables};
use foldline::pipeline::{Run, Stages};
use foldline::record::MemorySink;
use foldline::scene::{Scene, SyncPolicy, parse};
use foldline::spline::Mesh;
use foldline::state::Hash;

use crate::elastic_foundation::Foundation;
use crate::program::{SMALL, Sandbox};

/// A force along z on the first control point, whatever the shell does.
#[derive(Debug)]
struct Pull(f64);

impl TermSource for Pull {
    fn name(&self) -> &str {
        "a pull"
    }

    fn hash(&self) -> Hash {
        blake3::hash(&self.0.to_le_bytes())
    }

    fn on(&self, _: &Scene, _: &Mesh, _: &[Tables]) -> Result<Box<dyn Term>, ModelError> {
        Ok(Box::new(Self(self.0)))
    }
}

impl Term for Pull {
    fn energy(&self, at: At) -> f64 {
        -self.0 * at.displacement[0][2]
    }

    fn add_forces(&self, _: At, forces: &mut [[f64; 3]]) {
        forces[0][2] += self.0;
    }
}

fn pull(force: f64) -> Vec<Arc<dyn TermSource>> {
    vec![Arc::new(Pull(force))]
}

/// A log of the first stages of a run.
fn begun(place: &Sandbox, scene: &Scene, own: &[Arc<dyn TermSource>], count: usize) -> PathBuf {
    let path = place.file("own.mcap");
    let mut stages = Stages::with_terms(scene.clone(), own.to_vec());
    let manifest = Manifest::here("small.toml".as_ref(), &scene.to_toml(), 1).with_terms(stages.own_terms());
    let start = stages.start().unwrap();
    let mut writer = JournalWriter::create(&path, &manifest, SyncPolicy::AtEnd).unwrap();
    let mut run = Run::new(stages, start, None);
    (0..count).for_each(|_| drop(run.advance(&mut writer).unwrap()));
    path
}

/// Continues a log to the end of its run, as a program that has the terms does.
fn gone_on_with(path: &Path, own: &[Arc<dyn TermSource>]) -> Log {
    let claim = Resume::open(path).unwrap();
    let log = claim.log();
    let scene = logged_scene(log, log.commits() - 1, &[], own).unwrap();
    let mut stages = Stages::with_terms(scene.clone(), own.to_vec());
    assert!(restored_scene(log, &stages).is_some() && restored_scene(log, &Stages::new(scene.clone())).is_none());
    let keep = plan(log, &scene, &scene).unwrap().unwrap().keep;
    assert_eq!(keep, log.commits());
    let basis = basis(log, keep, &mut stages).unwrap();
    let manifest = Manifest::here("small.toml".as_ref(), &scene.to_toml(), 1).with_terms(own);
    let mut writer = claim.start_after(keep, &manifest, SyncPolicy::AtEnd).unwrap().writer;
    Run::new(stages, basis.state, basis.commit).to_end(None, &|| false, &mut writer).unwrap();
    drop(writer);
    Log::read(path).unwrap()
}

/// Chain hashes of a run that nothing stopped.
fn straight(scene: &Scene, own: &[Arc<dyn TermSource>]) -> Vec<Hash> {
    let mut stages = Stages::with_terms(scene.clone(), own.to_vec());
    let start = stages.start().unwrap();
    let mut sink = MemorySink::default();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
    sink.stages.iter().map(|(_, record)| record.commit.chain_hash).collect()
}

fn chain(log: &Log) -> Vec<Hash> {
    log.entries().iter().map(|entry| entry.record.commit.chain_hash).collect()
}

#[test]
fn a_log_with_a_term_that_is_not_there_is_not_gone_on_with() {
    let place = Sandbox::new();
    let scene = parse(SMALL, "small.toml").unwrap();
    let path = begun(&place, &scene, &pull(1e-3), 4);
    let log = Log::read(&path).unwrap();
    assert_eq!(log.manifests()[0].own_terms, [("a pull".to_owned(), Pull(1e-3).hash().to_string())]);
    place.foldline("inspect own.mcap").ends(0).says(&["made with terms of its program's own (a pull)"]);
    let commands = [
        "resume own.mcap",
        "run small.toml -o own.mcap --resume",
        "replay own.mcap --step 1",
        "stability own.mcap --step 1",
        "inspect own.mcap --probes",
    ];
    for command in commands {
        place.foldline(command).ends(1).says(&["terms of its program's own (a pull)"]);
    }
    let refused = |own: &[Arc<dyn TermSource>]| logged_scene(&log, 3, &[], own).unwrap_err();
    assert!(matches!(refused(&[]), LoggedSceneError::OwnTerms { names, .. } if names == "a pull"));
    let other = refused(&pull(2e-3)).to_string();
    assert!(other.contains("\"a pull\" had other parameters"), "{other}");
    let more = refused(&[pull(1e-3), vec![Arc::new(Foundation(1.0))]].concat()).to_string();
    assert!(more.contains("\"elastic foundation\" was not there"), "{more}");
}

/// Who has the term continues, runs stages again and locates the snap.
#[test]
fn a_log_is_gone_on_with_by_who_has_its_terms() {
    let place = Sandbox::new();
    let scene = parse(SMALL, "small.toml").unwrap();
    let own = pull(1e-3);
    let log = gone_on_with(&begun(&place, &scene, &own, 9), &own);
    assert_eq!(chain(&log), straight(&scene, &own));
    assert!(log.missed_manifests().next().is_none());
    let mut states = States::of(&log).with_terms(&own);
    let mut stages = Stages::with_terms(scene.clone(), own.clone());
    for index in [0, log.commits() - 1] {
        let replayed = replay_stage(&mut states, index, &mut stages, &mut |_, _| {}).unwrap();
        assert_eq!(verdict(&replayed.comparison), Verdict::BitIdentical, "stage {index}");
    }
    assert!(matches!(find_snap(&mut States::of(&log), &scene, 0.01), Err(SnapError::Terms(_))));
    let jump = log.entries().iter().map(|entry| &entry.record.report).find(|report| report.jumped).unwrap();
    let [low, high] = find_snap(&mut states, &scene, 0.01).unwrap().bracket;
    assert!(high - low <= 0.01 && high <= jump.parameter && low > jump.parameter - 2.0, "{low} {high}");
}

/// A path over an elastic foundation, cut anywhere, continues as if it had never stopped.
#[test]
fn a_path_on_a_foundation_is_gone_on_with() {
    let text = include_str!("column.toml").replace("[-1.43932, 0.0, 0.0]", "[-4.0, 0.0, 0.004]");
    let scene = parse(&text, "column.toml").unwrap();
    let own: Vec<Arc<dyn TermSource>> = vec![Arc::new(Foundation(0.002))];
    let whole = straight(&scene, &own);
    assert!(whole.len() > 4, "{} stages", whole.len());
    for count in [1, whole.len() / 2, whole.len() - 1] {
        let place = Sandbox::new();
        let log = gone_on_with(&begun(&place, &scene, &own, count), &own);
        assert_eq!(chain(&log), whole, "cut after {count}");
        let report = &log.entries().last().unwrap().record.report;
        assert!(report.path_length_mm.is_some() && report.parameter > 1.0, "{report:?}");
    }
}
