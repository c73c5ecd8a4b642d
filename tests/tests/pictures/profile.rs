//! Profiles: a trace for viewers, and the layout of Table 1, from any file.

use app_core::preset::Preset;
use app_core::profile::{DEVICE, FRAME, PROCESSOR, Profile};
use app_core::session::Session;
use app_pipeline::shaders;
use harness::{bundled_session, open_core};
use measure::profiled::{TASKS, parse, profile, tables, task};
use serde_json::Value;

fn measured() -> (Profile, usize) {
    let session = bundled_session();
    let profile = profile(&session, &mut open_core(), Preset::Paper).unwrap();
    (profile, session.n_frames())
}

#[test]
fn a_profile_is_a_trace_whose_scopes_lie_within_their_frames() {
    let (profile, n_frames) = measured();
    let frames: Vec<_> = profile
        .scopes(PROCESSOR)
        .filter(|event| event.name == FRAME)
        .collect();
    assert_eq!(frames.len(), n_frames);
    for (index, frame) in frames.iter().enumerate() {
        assert_eq!(frame.args.number, Some(index as u64));
        let end = frame.ts + frame.dur;
        let stages: Vec<_> = profile
            .scopes(PROCESSOR)
            .filter(|event| event.name != FRAME && (frame.ts..end).contains(&event.ts))
            .collect();
        assert!(stages.iter().any(|stage| stage.name == "submit"), "{stages:?}");
        let sum: f64 = stages.iter().map(|stage| stage.dur).sum();
        assert!(
            sum <= frame.dur && sum > 0.5 * frame.dur,
            "{sum} of {}",
            frame.dur
        );
    }
    // The file as any reader of JSON sees it, by the names of the format.
    let text = serde_json::to_string(&profile).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    let events = value["traceEvents"].as_array().unwrap();
    let has_scope = |tid: u32, name: &str| {
        let is_it = |event: &&Value| event["ph"] == "X" && event["tid"] == tid && event["name"] == name;
        events.iter().find(is_it).cloned()
    };
    assert!(has_scope(PROCESSOR, FRAME).unwrap()["ts"].is_number());
    if let Some(search) = has_scope(DEVICE, "search") {
        assert!(search["dur"].as_f64().unwrap() > 0.0 && search["args"]["bytes"].as_u64().unwrap() > 0);
    }
    let read = parse(&text).unwrap();
    assert_eq!(
        (&read.about, read.events.len()),
        (&profile.about, profile.events.len())
    );
    for (read, written) in read.events.iter().zip(&profile.events) {
        assert_eq!(
            (&read.name, &read.ph, read.tid),
            (&written.name, &written.ph, written.tid)
        );
        // Decimals are rounded in between.
        assert!((read.ts - written.ts).abs() < 1e-3 && (read.dur - written.dur).abs() < 1e-3);
        assert_eq!(
            (&read.args.kind, read.args.bytes),
            (&written.args.kind, written.args.bytes)
        );
    }
    let tables = tables(&profile);
    assert!(TASKS.iter().all(|(name, _)| tables.contains(name)), "{tables}");
}

/// Two frames as a phone may write them, with a counter between them that viewers show and the
/// tables do not.
const FROM_A_PHONE: &str = r#"{"traceEvents":[
    {"name":"frame","ph":"X","ts":1000,"dur":3000,"pid":1,"tid":1,"args":{"number":0,"kind":"picture","heat":"fair","camera_to_present_ms":41.5,"dropped":0}},
    {"name":"align","ph":"X","ts":1000,"dur":2000,"pid":1,"tid":1},
    {"name":"search","ph":"X","ts":1000,"dur":6000,"pid":1,"tid":2},
    {"name":"battery","ph":"C","ts":1500,"args":{}},
    {"name":"frame","ph":"X","ts":20000,"dur":3000,"pid":1,"tid":1,"args":{"number":1,"kind":"picture","camera_to_present_ms":38,"dropped":2}},
    {"name":"search","ph":"X","ts":20000,"dur":2000,"pid":1,"tid":2}],
    "otherData":{"version":1,"session":"desk","preset":"paper","device":"A11","picture_px":[1920,1440]}}"#;

#[test]
fn a_phones_file_is_read_as_one_of_a_desktop_and_another_version_is_not() {
    let tables = tables(&parse(FROM_A_PHONE).unwrap());
    assert!(
        tables.contains("camera to present: median 39.8 ms, longest 41.5 ms; 2 pictures dropped"),
        "{tables}"
    );
    let row = |name: &str| -> Vec<String> {
        let line = tables.lines().find(|line| line.starts_with(name)).unwrap();
        line[name.len()..].split_whitespace().map(str::to_owned).collect()
    };
    // Means over two frames: 1 ms of registration and 4 ms of search.
    assert_eq!(row("Object Registration"), ["1.00", "20.00", "1.83", "4.43"]);
    assert_eq!(row("Discretized Search"), ["4.00", "80.00", "15.78", "38.21"]);
    assert_eq!(row("Total")[..2], ["5.00", "100.00"]);
    let another = FROM_A_PHONE.replace("\"version\":1", "\"version\":2");
    assert!(parse(&another).unwrap_err().to_string().contains("version 2"));
    assert!(parse("{}").is_err());
}

#[test]
fn every_pass_is_a_part_of_a_task() {
    let missing: Vec<_> = shaders()
        .map(|shader| shader.name)
        .filter(|name| task(name).is_none())
        .collect();
    assert_eq!(missing, Vec::<&str>::new());
}
