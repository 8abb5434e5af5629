//! Stages of a log as a table, in full, and as JSON.

use foldline::cli::{json_line, stage_csv, stage_table, step_in_full};
use foldline::record::Reading;

use crate::synthetic;

#[test]
fn table_of_a_run() {
    let table = stage_table(&synthetic::records(), None);
    assert!(table.lines().all(|line| line.chars().count() <= 120));
    insta::assert_snapshot!(table);
}

#[test]
fn table_of_a_large_run_fits() {
    let mut records = synthetic::records();
    for record in &mut records {
        record.commit.ordinal += 1000;
        record.report.step += 1000;
        record.report.elements = [256, 32].into();
        record.report.unknowns = 27_195;
        record.report.moment_n_mm += 1000.0;
        record.report.strain_energy_n_mm += 100.0;
        record.wall_s += 100.0;
    }
    let table = stage_table(&records, None);
    let widest = table.lines().map(|line| line.chars().count()).max();
    assert!(widest <= Some(120), "{widest:?}\n{table}");
}

#[test]
fn table_of_an_empty_log_is_its_head() {
    insta::assert_snapshot!(stage_table(&[], None));
}

#[test]
fn step_with_a_refinement_in_full() {
    insta::assert_snapshot!(step_in_full(&synthetic::records(), 3));
}

#[test]
fn step_with_a_jump_in_full() {
    insta::assert_snapshot!(step_in_full(&synthetic::records(), 10));
}

#[test]
fn step_that_is_not_there() {
    assert_eq!(step_in_full(&synthetic::records(), 99), "");
}

#[test]
fn json_has_these_fields() {
    let records = synthetic::records();
    let line = json_line(&records[4]);
    assert!(!line.contains('\n'));
    insta::assert_snapshot!(line.replace(",\"", ",\n\""));
}

#[test]
fn json_numbers_come_back_bit_for_bit() {
    for record in synthetic::records() {
        let value: serde_json::Value = serde_json::from_str(&json_line(&record)).unwrap();
        let moment = value["moment_n_mm"].as_f64().unwrap();
        assert_eq!(moment.to_bits(), record.report.moment_n_mm.to_bits());
        let report: foldline::record::Report = serde_json::from_value(value).unwrap();
        assert_eq!(report, record.report);
    }
}

#[test]
fn warnings_stand_beside_their_stages() {
    let records = synthetic::coarse_records();
    insta::assert_snapshot!(stage_table(&records, None) + &step_in_full(&records, 5));
}

#[test]
fn csv_has_everything_that_json_has() {
    let mut records = synthetic::records();
    let last = records.len() - 1;
    records[last].report.probes = vec![Reading { name: "tip, left".into(), value: -1.5, unit: "mm".into(), at: None }];
    let csv = stage_csv(&records);
    let csv = csv.replace("\"probes.tip, left\"", "probes.tip");
    let heads: Vec<&str> = csv.lines().next().unwrap().split(',').collect();
    let json: serde_json::Value = serde_json::from_str(&json_line(&records[0])).unwrap();
    let known = |key: &&String| heads.iter().any(|head| head.split('.').next() == Some(key.as_str()));
    let missing: Vec<&String> = json.as_object().unwrap().keys().filter(|key| !known(key)).collect();
    assert!(missing.is_empty(), "{missing:?}");
    assert_eq!(csv.lines().count(), 1 + records.len());
    for (line, record) in csv.lines().skip(1).zip(&records) {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), heads.len(), "{line}");
        let of = |name: &str| cells[heads.iter().position(|head| *head == name).unwrap()];
        assert_eq!(of("moment_n_mm").parse(), Ok(record.report.moment_n_mm));
        assert_eq!(of("elements.1").parse(), Ok(record.report.elements.each()[0][1]));
        assert_eq!(of("state_hash"), record.commit.state_hash.to_string());
    }
    assert!(csv.lines().last().unwrap().ends_with(",-1.5") && csv.lines().nth(1).unwrap().ends_with(','));
}
