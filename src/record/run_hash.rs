//! The identity of a run: what decides its results.

use crate::digest::{Feed, Hash};
use crate::scene::Scene;

/// Hashes what decides the results of a run: its scene, and the energy terms of the caller's own, by name and hash,
/// where there are any.
pub fn run_hash(scene: &Scene, terms: &[(&str, Hash)]) -> Hash {
    if terms.is_empty() {
        return scene.hash();
    }
    let mut feed = Feed::new("foldline scene with terms");
    feed.bytes(scene.hash().as_bytes());
    for (name, hash) in terms {
        feed.integer(name.len() as u64);
        feed.bytes(name.as_bytes());
        feed.bytes(hash.as_bytes());
    }
    feed.finish()
}
