//! Runs with an energy of the caller's own: their logs say so, and are not gone on with by who does not have it.

use std::sync::Arc;

use foldline::journal::{JournalWriter, Log, Manifest};
use foldline::model::{At, ModelError, Tables, Term, TermSource};
use foldline::pipeline::{Run, Stages};
use foldline::scene::{Scene, SyncPolicy};
use foldline::spline::Mesh;
use foldline::state::Hash;

use crate::program::{Place, SMALL};

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

    fn on(&self, _: &Scene, _: &Mesh, _: &Tables) -> Result<Box<dyn Term>, ModelError> {
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

#[test]
fn a_log_with_a_term_that_is_not_there_is_not_gone_on_with() {
    let place = Place::new();
    let path = place.file("own.mcap");
    let scene = foldline::scene::parse(SMALL, "small.toml").unwrap();
    let mut stages = Stages::with_terms(scene.clone(), vec![Arc::new(Pull(1e-3))]);
    let manifest = Manifest::here("small.toml".as_ref(), &scene.to_toml(), 1).with_terms(stages.own_terms());
    let start = stages.start().unwrap();
    let mut writer = JournalWriter::create(&path, &manifest, SyncPolicy::AtEnd).unwrap();
    let mut run = Run::new(stages, start, None);
    (0..4).for_each(|_| drop(run.advance(&mut writer).unwrap()));
    drop(writer);

    let log = Log::read(&path).unwrap();
    assert_eq!(log.manifests()[0].own_terms, [("a pull".to_owned(), Pull(1e-3).hash().to_string())]);
    place.foldline("inspect own.mcap").ends(0).says(&["made with terms of its program's own (a pull)"]);
    for command in ["resume own.mcap", "run small.toml -o own.mcap --resume", "replay own.mcap --step 1"] {
        place.foldline(command).ends(1).says(&["terms of its program's own (a pull)"]);
    }
}
