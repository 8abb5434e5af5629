//! Logs of every layout that there ever was stay readable, to the last state.

use std::path::Path;

use foldline::journal::{Completeness, Level, Log, verify_log};

#[test]
fn old_logs_stay_readable() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("checkpoints/golden");
    let logs = std::fs::read_dir(&folder).into_iter().flatten().map(|entry| entry.unwrap().path());
    for path in logs.filter(|path| path.extension().is_some_and(|extension| extension == "mcap")) {
        let log = Log::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(log.completeness(), Completeness::Finished, "{}", path.display());
        let findings = verify_log(&log);
        assert!(findings.iter().all(|finding| finding.level < Level::Error), "{}: {findings:?}", path.display());
    }
}
