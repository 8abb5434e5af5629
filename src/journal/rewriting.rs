//! A log written again and compared: a byte that no hash covers (a time, an index, the summary) shows here.

use super::encode_error::EncodeError;
use super::encoder::Encoder;
use super::frame;
use super::log::Log;

/// The first bytes of a log, written again.
pub(super) struct Rewriting<R> {
    encoder: Encoder,
    /// Bytes of the log: so many from a place on, fewer at its end.
    theirs: R,
    written: u64,
    checksum: crc32fast::Hasher,
    /// The first byte that differs.
    differs: Option<u64>,
}

/// Length of the record in front of the summary, up to its checksum.
const DATA_END_HEAD_LEN: u64 = 9;

impl<R: Fn(u64, usize) -> Vec<u8>> Rewriting<R> {
    /// Starts to write a log again whose header names `library`, and compares with the bytes of the original.
    pub fn new(library: &str, theirs: R) -> Result<Self, EncodeError> {
        let encoder = Encoder::new(library)?;
        Ok(Self { encoder, theirs, written: 0, checksum: crc32fast::Hasher::new(), differs: None })
    }

    /// Writes the records of a part of the log before `end`, an offset in that part.
    pub fn write(&mut self, part: &Log, end: usize) -> Result<(), EncodeError> {
        for place in part.parts.iter().filter(|place| place.at < end) {
            if let Some(Ok(record)) = frame::next(&part.bytes, place.at) {
                self.encoder.again(&part.bytes, &record)?;
                let bytes = self.encoder.take();
                self.checksum.update(&bytes);
                self.compare(&bytes);
            }
        }
        Ok(())
    }

    /// Writes the summary, where the log has one, and returns the first offset at which the bytes differ from the
    /// original.
    pub fn end(mut self, log: &Log) -> Option<u64> {
        if log.parts.is_empty() {
            let bytes = self.encoder.take();
            self.compare(&bytes);
        }
        if log.closed {
            let theirs = (self.theirs)(self.written + DATA_END_HEAD_LEN, 4);
            // Version 1 had a checksum of all bytes there.
            let checksum = if theirs == [0; 4] { 0 } else { self.checksum.clone().finalize() };
            let encoder = std::mem::replace(&mut self.encoder, Encoder::new("").ok()?);
            let _ = encoder.close_with_checksum(log.commits() as u64, checksum, |piece| {
                self.compare(&piece);
                Ok::<(), std::convert::Infallible>(())
            });
        }
        self.differs.or((self.written < log.file_len).then_some(self.written))
    }

    fn compare(&mut self, ours: &[u8]) {
        let theirs = (self.theirs)(self.written, ours.len());
        let same = ours.iter().zip(&theirs).take_while(|(ours, theirs)| ours == theirs).count();
        if same < ours.len() {
            self.differs.get_or_insert(self.written + same as u64);
        }
        self.written += ours.len() as u64;
    }
}
