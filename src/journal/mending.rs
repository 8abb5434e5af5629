//! Stages that a log has lost, put back: whole ones behind them follow on them again. That they are the right ones is shown by
//! the chain.

use super::codec::{EncodedState, encode_mesh, encode_state_on};
use super::encode_error::EncodeError;
use super::encoder::{Encoder, Parts};
use super::ledger::Ledger;
use super::log::Log;
use super::reader::ReadError;
use crate::record::Record;
use crate::state::State;

/// Why lost stages cannot be put back into a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MendError {
    /// They have no place in a log.
    #[error(transparent)]
    Encode(#[from] EncodeError),
    /// The result is not a log.
    #[error(transparent)]
    Read(#[from] ReadError),
}

impl Log {
    /// Returns the same log with stages behind its good part; `None` where no later commit of the log follows on them.
    ///
    /// # Errors
    /// Where a stage cannot be put into a log.
    pub fn with_stages(&self, made: &[(State, Record)]) -> Result<Option<Log>, MendError> {
        let good = &self.bytes[..self.good_end];
        let mut ledger = Ledger::default();
        ledger.enter(self.base, good);
        if ledger.channels.is_empty() {
            // Numbers that the chunks behind may use otherwise are not described.
            let mut describing = Encoder::new(&self.library).map_err(EncodeError::Mcap)?;
            self.encode(&made[..made.len().min(1)], &mut describing)?;
            ledger = describing.ledger().clone();
        }
        let mut encoder = Encoder::behind(ledger, self.good_end()).map_err(EncodeError::Mcap)?;
        let put_back = self.encode(made, &mut encoder)?;
        // What is damaged stays in between, and costs nothing any more.
        let mended = Log::from_bytes([good, &put_back, &self.bytes[self.good_end..self.walked]].concat())?;
        Ok((mended.commits() > self.commits() + made.len()).then_some(mended))
    }

    fn encode(&self, made: &[(State, Record)], encoder: &mut Encoder) -> Result<Vec<u8>, EncodeError> {
        if let Some(stretch) = self.stretches.last_hash() {
            encoder.go_on_with(stretch);
        }
        for (state, record) in made {
            let mesh_hash = state.mesh.hash();
            let mesh = (!self.meshes.contains_key(&mesh_hash)).then(|| encode_mesh(&state.mesh)).transpose()?;
            let EncodedState { state, fields } = encode_state_on(state, mesh_hash, &[])?;
            let (state, fields) = (&state, &fields);
            encoder.commit(&Parts { record, mesh_hash, mesh, state, fields, known: &[], viewer: &[] })?;
        }
        Ok(encoder.take())
    }
}
