//! Content hashes of numbers and texts, independent of how anything is encoded.

/// A content hash (BLAKE3, 256 bits).
pub type Hash = blake3::Hash;

/// Hasher of numbers by their bits, and of texts; each sequence is preceded by its length.
pub(crate) struct Feed {
    hasher: blake3::Hasher,
    /// Bytes collected for the hasher, which is fast only on long inputs.
    pending: Vec<u8>,
}

/// Number of bytes that the hasher gets at a time: whole subtrees of its own, which it hashes in parallel.
const BATCH: usize = 64 * 1024;

impl Feed {
    pub(crate) fn new(domain: &str) -> Self {
        let mut feed = Self { hasher: blake3::Hasher::new(), pending: Vec::with_capacity(2 * BATCH) };
        feed.text(domain);
        feed
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.integer(text.len() as u64);
        self.bytes(text.as_bytes());
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
        self.hash_whole_batches();
    }

    fn hash_whole_batches(&mut self) {
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
        self.each(values);
    }

    /// Adds numbers without their count in front.
    pub(crate) fn each(&mut self, values: &[f64]) {
        for values in values.chunks(BATCH / size_of::<f64>()) {
            extend_with_numbers(&mut self.pending, values);
            self.hash_whole_batches();
        }
    }

    pub(crate) fn finish(mut self) -> Hash {
        self.hasher.update(&self.pending);
        self.hasher.finalize()
    }
}

/// Adds numbers by their bits, lowest byte first.
pub(crate) fn extend_with_numbers(bytes: &mut Vec<u8>, values: &[f64]) {
    let from = bytes.len();
    // Room first: so all of them are copied at once.
    bytes.resize(from + size_of_val(values), 0);
    for (place, value) in bytes[from..].chunks_exact_mut(size_of::<f64>()).zip(values) {
        place.copy_from_slice(&value.to_bits().to_le_bytes());
    }
}
