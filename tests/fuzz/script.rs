//! What the fuzzer is given: pieces of a log, which are put together with every seal right, so that what lies behind the
//! seals is met. A piece is a byte that says what it is, two bytes of length, and its content.

use foldline::journal::Log;
use foldline::scene::Stage;

use super::crafted::{self, Crafted, Said};

const SCENE: u8 = 0;
const MESH: u8 = 1;
const DISPLACEMENT: u8 = 2;
const STATE: u8 = 3;
const REPORT: u8 = 4;
const COMMIT: u8 = 5;
const OTHER: u8 = 6;
const RECORDS: u8 = 7;
const OUTSIDE: u8 = 8;
const FINISH: u8 = 9;
const KINDS: u8 = 10;

/// In front of bytes that are a log as they are.
const AS_IT_IS: u8 = 255;

/// The log that a script stands for.
pub fn log_of(script: &[u8]) -> Vec<u8> {
    if let [AS_IT_IS, bytes @ ..] = script {
        return bytes.to_vec();
    }
    let mut crafted: Option<Crafted> = None;
    let mut said = Said::default();
    let mut rest = script;
    while let [kind, low, high, following @ ..] = rest {
        let (piece, following) =
            following.split_at(usize::from(u16::from_le_bytes([*low, *high])).min(following.len()));
        rest = following;
        let text = || String::from_utf8_lossy(piece).into_owned();
        if kind % KINDS == SCENE {
            match &mut crafted {
                Some(crafted) => crafted.manifest(&[("scene", &text())]),
                None => crafted = Some(Crafted::new(&text())),
            }
            continue;
        }
        let crafted = crafted.get_or_insert_with(|| Crafted::new(""));
        match kind % KINDS {
            MESH => said.mesh = piece.to_vec(),
            DISPLACEMENT => said.fields.push(piece.to_vec()),
            STATE => said.state = piece.to_vec(),
            REPORT => said.report = piece.to_vec(),
            OTHER => said.others.push((text().chars().take(40).collect(), piece.to_vec())),
            RECORDS => said.records.extend_from_slice(piece),
            OUTSIDE => crafted.bytes.extend_from_slice(piece),
            FINISH => crafted.finish(),
            _ => {
                let stage = STAGES[piece.first().map_or(0, |stage| usize::from(*stage) % STAGES.len())];
                crafted.commit(stage, piece.get(1).map_or(0, |step| u64::from(*step)), std::mem::take(&mut said));
            }
        }
    }
    crafted.map(|crafted| crafted.bytes).unwrap_or_default()
}

const STAGES: [Stage; 7] = [
    Stage::Solve,
    Stage::EvaluateIndicators,
    Stage::RefineKnots,
    Stage::ProjectDisplacements,
    Stage::ReEquilibrate,
    Stage::SwitchBranch,
    Stage::CoarsenKnots,
];

/// The script that makes a log again, of its first commits.
pub fn script_of(log: &[u8], commits: usize) -> Vec<u8> {
    let mut script = Vec::new();
    let mut piece = |kind: u8, data: &[u8]| {
        let data = &data[..data.len().min(usize::from(u16::MAX))];
        script.push(kind);
        script.extend((data.len() as u16).to_le_bytes());
        script.extend(data);
    };
    let read = Log::from_bytes(log.to_vec()).unwrap();
    piece(SCENE, read.manifests().first().map_or("", |manifest| &manifest.scene_text).as_bytes());
    let mut topics = std::collections::BTreeMap::new();
    for entry in read.entries().iter().take(commits) {
        let (from, to) = (entry.bytes.start as usize, entry.bytes.end as usize);
        let mut records = &log[from + 9 + 40..to];
        while let [opcode, after @ ..] = records {
            let (length, after) = after.split_at(8);
            let (body, after) = after.split_at(u64::from_le_bytes(length.try_into().unwrap()) as usize);
            records = after;
            let id = [body[0], body[1]];
            if *opcode == crafted::CHANNEL {
                let length = u32::from_le_bytes(body[4..8].try_into().unwrap()) as usize;
                topics.insert(id, String::from_utf8_lossy(&body[8..8 + length]).into_owned());
            } else if *opcode == crafted::MESSAGE {
                let kind = match topics[&id].as_str() {
                    "/foldline/mesh" => MESH,
                    "/foldline/displacement" => DISPLACEMENT,
                    "/foldline/state" => STATE,
                    "/foldline/report" => REPORT,
                    _ => continue,
                };
                piece(kind, &body[22..]);
            }
        }
        let commit = &entry.record.commit;
        let stage = STAGES.iter().position(|stage| *stage == commit.stage).unwrap();
        piece(COMMIT, &[stage as u8, commit.step as u8]);
    }
    piece(FINISH, &[]);
    script
}

/// Reads a log as every command does, and holds what it says against what it gives: no panic, and no finding that is not said.
pub fn read(bytes: Vec<u8>) {
    let Ok(log) = Log::from_bytes(bytes) else { return };
    foldline::journal::verify_log(&log);
    for index in 0..log.commits().min(8) {
        let Ok(state) = log.state(index) else { continue };
        let encoded = foldline::journal::encode_state(&state).expect("what is read can be written");
        assert_eq!(state.hash(), log.entries()[index].record.commit.state_hash);
        let again = foldline::journal::decode_state(
            &encoded.state,
            |asked| encoded.fields.iter().find(|field| field.hash == asked).map(|field| &field.bytes[..]),
            state.mesh.clone(),
            state.mesh.hash(),
            state.hash(),
        );
        assert_eq!(again.expect("what is written can be read").hash(), state.hash());
    }
    for entry in log.entries() {
        let json = serde_json::to_string(&foldline::record::fields_of(&entry.record.report));
        json.expect("what is read can be shown");
    }
}
