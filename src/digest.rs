//! Content hashes of numbers, independent of how anything is encoded.

/// A content hash (BLAKE3, 256 bits).
pub type Hash = blake3::Hash;

/// Feeds numbers into a hash by their bits, each sequence with its length in front.
pub(crate) struct Feed {
    hasher: blake3::Hasher,
    /// Bytes on their way to the hasher, which is fast only on long inputs.
    pending: Vec<u8>,
}

/// Bytes that the hasher gets at a time: whole subtrees of its own, which it hashes side by side.
const BATCH: usize = 64 * 1024;

impl Feed {
    pub(crate) fn new(domain: &str) -> Self {
        let mut feed = Self { hasher: blake3::Hasher::new(), pending: Vec::with_capacity(2 * BATCH) };
        feed.integer(domain.len() as u64);
        feed.bytes(domain.as_bytes());
        feed
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
        if self.pending.len() >= BATCH {
            let whole = self.pending.len() / BATCH * BATCH;
            self.hasher.update(&self.pending[..whole]);
            self.pending.drain(..whole);
        }
    }

    pub(crate) fn integer(&mut self, value: u64) {
        self.bytes(&value.to_le_bytes());
    }

    pub(crate) fn number(&mut self, value: f64) {
        self.bytes(&value.to_bits().to_le_bytes());
    }

    pub(crate) fn numbers(&mut self, values: &[f64]) {
        self.integer(values.len() as u64);
        values.iter().for_each(|value| self.number(*value));
    }

    pub(crate) fn finish(mut self) -> Hash {
        self.hasher.update(&self.pending);
        self.hasher.finalize()
    }
}
