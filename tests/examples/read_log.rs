//! Reads a log: what it is worth, what every stage said, and the last state.
//!
//! ```text
//! cargo run --release --example read_log [LOG.mcap]
//! ```

use std::error::Error;
use std::path::PathBuf;

use foldline::journal::Log;

fn main() -> Result<(), Box<dyn Error>> {
    let golden = || PathBuf::from("checkpoints/golden/v3-0.1.0-finished.mcap");
    let log = Log::read(&std::env::args_os().nth(1).map_or_else(golden, PathBuf::from))?;
    println!("{} stages, {:?}", log.commits(), log.completeness());
    for entry in log.entries() {
        let report = &entry.record.report;
        println!(
            "{:>4}  step {:>3}  {:<22} {:.4}",
            entry.record.commit.ordinal,
            report.step,
            report.stage.name(),
            report.parameter
        );
    }
    if let Some(last) = log.commits().checked_sub(1) {
        // Decoded only now, and compared with the hash that its commit names.
        let state = log.state(last)?;
        let largest = state.displacement.iter().flatten().fold(0.0, |most: f64, u| most.max(u.abs()));
        println!("the last state: {} control points, moved by {largest:.4} mm at most", state.displacement.len());
    }
    Ok(())
}
