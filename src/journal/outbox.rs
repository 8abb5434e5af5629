//! Where MCAP's writers put their bytes, and how they write chunks.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use mcap::WriteOptions;

use super::format::PROFILE;

/// Bytes on their way out, shared with MCAP's writer, which would not give them back.
#[derive(Clone, Debug, Default)]
pub(super) struct Outbox(Arc<Mutex<Vec<u8>>>);

impl Outbox {
    pub(super) fn bytes(&self) -> MutexGuard<'_, Vec<u8>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Write for Outbox {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.bytes().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// How chunks are written: each when it is flushed, and never gone back to.
pub(super) fn options() -> WriteOptions {
    let options = WriteOptions::new().profile(PROFILE).chunk_size(None).disable_seeking(true);
    options.calculate_data_section_crc(false).compression_threads(0)
}
