//! The target `scene` of the fuzzer; see the `README.md` of this folder.
#![no_main]

use libfuzzer_sys::{Corpus, fuzz_target};

#[path = "../scene_text.rs"]
mod scene_text;

fuzz_target!(|bytes: &[u8]| -> Corpus {
    let Ok(text) = std::str::from_utf8(bytes) else { return Corpus::Reject };
    scene_text::read(text);
    Corpus::Keep
});
