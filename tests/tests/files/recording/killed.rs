//! A writer that is killed leaves all data that it reported as flushed.

use std::fs;
use std::path::Path;
use std::time::Duration;

use harness::endless::{kill, read};
use harness::temporary::Temporary;
use measure::random::Random;

use crate::recording::small::small;

const RECORDER: &str = env!("CARGO_BIN_EXE_recorder");

/// Kills this number of writers, and returns the number of frames that they had acknowledged.
fn kill_all(n_tries: u32) -> u32 {
    let folder = Temporary::new("recording");
    let mut random = Random::new(u64::from(n_tries));
    let (mut n_acknowledged, mut n_read, mut n_lost, mut n_errors) = (0, 0, 0, 0);
    for _ in 0..n_tries {
        let out = folder.0.join("killed.mcap");
        let delay = Duration::from_secs_f64(0.05 * random.uniform());
        match kill(Path::new(RECORDER), &out, delay) {
            Ok(killed) => {
                n_acknowledged += killed.n_acknowledged;
                n_read += killed.n_read;
                n_lost += killed.n_lost();
            }
            Err(error) => {
                eprintln!("{error:#}");
                n_errors += 1;
            }
        }
        fs::remove_file(&out).unwrap();
    }
    println!(
        "{n_tries} killed: {n_acknowledged} frames acknowledged, {n_read} read, {n_lost} lost, {n_errors} errors"
    );
    assert_eq!((n_lost, n_errors), (0, 0));
    n_acknowledged
}

#[test]
fn what_was_acknowledged_outlives_the_writer() {
    assert!(kill_all(20) > 0);
}

#[test]
#[ignore = "takes minutes"]
fn what_was_acknowledged_outlives_a_thousand_writers() {
    assert!(kill_all(1000) > 0);
}

/// Control for the comparison: a missing frame in the middle is detected, and so is a different
/// file.
#[test]
fn what_is_missing_is_found() {
    let folder = Temporary::new("recording");
    let out = folder.0.join("small.mcap");
    fs::write(&out, small(10).bytes).unwrap();
    assert_eq!(read(&out).unwrap_err().to_string(), "the attached file");
}
