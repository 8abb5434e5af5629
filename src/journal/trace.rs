//! Newton iterates of replayed stages as an MCAP file that any reader can plot.

use std::collections::BTreeMap;
use std::io::Cursor;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::message::schema_of;

/// Topic of the messages with Newton iterates.
pub const ITERATE_TOPIC: &str = "/foldline/iterate";

/// A Newton iterate of a stage, as a row of the trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TraceRow {
    /// Ordinal of the stage in its log.
    pub ordinal: u64,
    /// Load step.
    pub step: u64,
    /// Name of the stage.
    pub stage: String,
    /// Newton steps taken.
    pub iteration: usize,
    /// Strain energy of the model, N·mm.
    pub energy_n_mm: f64,
    /// |residual|, N.
    pub residual_n: f64,
    /// |residual| over the forces that it is compared with.
    pub relative_residual: f64,
    /// Length of the last step along its direction; 1 is a full Newton step.
    pub step_length: f64,
    /// Largest amount added to the negative pivots to make the stiffness positive definite: 0 where it is; twice the
    /// largest magnitude of a negative pivot where it is not, N/mm.
    pub shift_n_per_mm: f64,
    /// Negative pivots of the stiffness.
    pub negative_pivots: usize,
    /// Control point with the largest residual: its indices along the length and along the arc.
    pub worst_point: [usize; 2],
    /// Its undeformed place, mm.
    pub worst_point_mm: [f64; 3],
}

/// Encodes iterates, in order, as an MCAP file; their time is their number in milliseconds.
///
/// # Errors
/// Where MCAP refuses one.
pub fn trace_file(rows: &[TraceRow]) -> Result<Vec<u8>, mcap::McapError> {
    let options = mcap::WriteOptions::new().profile("").compression(None);
    let mut file = Cursor::new(Vec::new());
    let mut writer = options.create(&mut file)?;
    let schema = writer.add_schema("foldline.Iterate", "jsonschema", &schema_of::<TraceRow>("A Newton iterate"))?;
    let channel = writer.add_channel(schema, ITERATE_TOPIC, "json", &BTreeMap::new())?;
    for (number, row) in rows.iter().enumerate() {
        let time = number as u64 * 1_000_000;
        let header = mcap::records::MessageHeader {
            channel_id: channel,
            sequence: number as u32,
            log_time: time,
            publish_time: time,
        };
        let data = serde_json::to_vec(row).map_err(std::io::Error::from)?;
        writer.write_to_known_channel(&header, &data)?;
    }
    writer.finish()?;
    drop(writer);
    Ok(file.into_inner())
}
