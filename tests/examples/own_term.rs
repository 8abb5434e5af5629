//! A user-defined energy term: a strip on an elastic foundation, compared with the closed form of a beam on one.
//!
//! ```text
//! cargo run --release --example own_term
//! ```

use std::error::Error;
use std::sync::Arc;

use foldline::pipeline::{Run, Stages};
use foldline::record::MemorySink;
use foldline::scene::parse;

#[path = "../verification/elastic_foundation.rs"]
mod elastic_foundation;

use elastic_foundation::Foundation;

/// Half of a long strip under a line force in its middle, where it is symmetric.
const SCENE: &str = r#"
geometry = { kind = "plate", length_mm = 400.0, width_mm = 1.0 }
material = { kind = "isotropic", youngs_modulus_mpa = 70e3, poissons_ratio = 0.0, thickness_mm = 1.0 }
mesh = { degree = 4, elements = [32, 1] }
load = { kind = "steps", increment = 1.0 }

[[support]]
on = "u-start"
kind = "symmetric"

[[support]]
on = "u-end"
kind = "fixed"
hold = ["y", "z"]

[[action]]
kind = "line-force"
on = "u-start"
force_n_per_mm = [0.0, 0.0, 0.25]

[[probe]]
name = "middle"
kind = "displacement"
on = [0.0, 0.5]
component = "z"
"#;

fn main() -> Result<(), Box<dyn Error>> {
    let stiffness: f64 = 0.02;
    let mut stages = Stages::with_terms(parse(SCENE, "strip.toml")?, vec![Arc::new(Foundation(stiffness))]);
    let start = stages.start()?;
    let mut sink = MemorySink::default();
    Run::new(stages, start, None).to_end(None, &|| false, &mut sink)?;
    let (_, record) = sink.stages.last().ok_or("no stage was run")?;
    // w = P β / (2 k) with β⁴ = k / (4 E I), for a width of 1 mm (Hetényi, Beams on Elastic Foundation, section 3).
    let beta = (stiffness / (4.0 * 70e3 / 12.0)).powf(0.25);
    let closed_form = 0.5 * beta / (2.0 * stiffness);
    println!("deflection {:.5} mm, closed form {closed_form:.5} mm", record.report.probes[0].value);
    Ok(())
}
