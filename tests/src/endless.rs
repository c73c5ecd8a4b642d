//! A recording that a process writes until it is killed, and the check of the rest.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use anyhow::{Context, ensure};
use app_core::recording::{Limits, Picture, Recording, Topic, Writer};
use app_core::session::Files;
use serde::Deserialize;
use serde_json::value::RawValue;
use serde_json::{Value, json};

use desk::stored::Stored;

/// Time between two frames.
const FRAME_NS: u64 = 40_000_000;
/// An attached file, like the toy.
const FILE: &str = "toy.glb";

#[derive(Deserialize)]
struct Index<'a> {
    #[serde(borrow)]
    frames: Vec<&'a RawValue>,
}

#[derive(Deserialize)]
struct Entry {
    image: String,
}

/// Index of the session without its frames.
#[must_use]
pub fn session() -> Value {
    json!({ "format": "shadow-capture", "version": 1, "name": "endless", "width": 640, "height": 480,
        "intrinsics": { "fx": 576.0, "fy": 576.0, "cx": 320.0, "cy": 240.0 } })
}

/// The picture of a frame: random bytes, the same for the same frame. Some frames have large ones.
#[must_use]
pub fn picture(frame: u32) -> Vec<u8> {
    let n_bytes = if frame % 50 == 49 {
        600_000
    } else {
        500 + 37 * (frame as usize % 100)
    };
    let mut state = frame.wrapping_mul(2_654_435_761) | 1;
    let bytes = (0..n_bytes).map(|_| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state.to_le_bytes()[1]
    });
    b"\xff\xd8\xff".iter().copied().chain(bytes).collect()
}

/// A frame's entry, with numbers that are hard for shortest decimals.
#[must_use]
pub fn entry(frame: u32) -> Value {
    let at = f64::from(frame) / 30.0;
    json!({ "time": at, "image": format!("frame_{frame:06}.jpg"), "animation": { "clip": null, "time": at },
        "world_from_camera": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, at.sin(), 0.1 + at, 0.3, 1] })
}

/// Time of a frame.
#[must_use]
pub fn time_ns(frame: u32) -> u64 {
    u64::from(frame) * FRAME_NS
}

/// Adds a frame and a note.
///
/// # Errors
/// As the writer.
pub fn add<W: Write>(writer: &mut Writer<W>, frame: u32) -> anyhow::Result<()> {
    let time_ns = time_ns(frame);
    writer.frame(time_ns, Picture::New(&picture(frame)), &entry(frame).to_string())?;
    Ok(writer.note(time_ns, Topic::Light, r#"{"lux":300}"#)?)
}

/// Writes as fast as it can until the process is killed, and reports on `acknowledge`, a line each,
/// the number of frames that would survive.
///
/// # Errors
/// When the system refuses.
pub fn write(out: &Path, mut acknowledge: impl Write) -> anyhow::Result<()> {
    let file = File::create(out)?;
    let mut writer = Writer::new(file, &session().to_string(), BTreeMap::new(), Limits::default())?;
    writer.file(0, FILE, &picture(u32::MAX))?;
    let mut told = 0;
    for frame in 0.. {
        add(&mut writer, frame)?;
        let n_frames = writer.flushed().n_frames;
        if told != n_frames {
            writeln!(acknowledge, "{n_frames}")?;
            acknowledge.flush()?;
            told = n_frames;
        }
    }
    Ok(())
}

/// The result of a killed process.
#[derive(Clone, Copy, Debug, Default)]
pub struct Killed {
    /// Number of acknowledged frames.
    pub n_acknowledged: u32,
    /// Number of readable frames.
    pub n_read: u32,
}

impl Killed {
    /// Number of acknowledged frames that are missing.
    #[must_use]
    pub fn n_lost(&self) -> u32 {
        self.n_acknowledged.saturating_sub(self.n_read)
    }
}

/// Starts `program`, which writes to `out`, kills it after its first acknowledgement and `delay`,
/// and reads the rest.
///
/// # Errors
/// When the system refuses, or the rest cannot be read or differs from the written data.
pub fn kill(program: &Path, out: &Path, delay: Duration) -> anyhow::Result<Killed> {
    let mut child = Command::new(program)
        .arg(out)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()?;
    let pipe = child.stdout.take().context("no pipe")?;
    let mut lines = BufReader::new(pipe);
    let mut line = String::new();
    lines.read_line(&mut line)?;
    sleep(delay);
    child.kill()?;
    child.wait()?;
    let mut n_acknowledged = 0;
    // A line without an end was not acknowledged.
    while line.ends_with('\n') {
        n_acknowledged = line.trim().parse()?;
        line.clear();
        lines.read_line(&mut line)?;
    }
    Ok(Killed {
        n_acknowledged,
        n_read: read(out)?,
    })
}

/// Number of frames of the rest.
///
/// # Errors
/// When it cannot be read, or a frame, its picture or the attached file differs from the written
/// data.
pub fn read(out: &Path) -> anyhow::Result<u32> {
    let Stored::Recording(recording) = Stored::open(out)? else {
        anyhow::bail!("not a file");
    };
    ensure!(
        recording.read(FILE, u64::MAX)? == picture(u32::MAX),
        "the attached file"
    );
    let frames = compare(&recording)?;
    let n_frames = u32::try_from(frames.len())?;
    ensure!(frames == (0..n_frames).collect::<Vec<_>>(), "frames are missing");
    Ok(n_frames)
}

/// Numbers of the existing frames.
///
/// # Errors
/// When a frame or its picture differs from the written data.
pub fn compare(recording: &Recording) -> anyhow::Result<Vec<u32>> {
    let index = recording.read("capture.json", u64::MAX)?;
    let index: Index = serde_json::from_slice(&index)?;
    let mut numbers = Vec::new();
    for found in index.frames {
        let named: Entry = serde_json::from_str(found.get())?;
        let path = named.image.as_str();
        let number = path.trim_matches(|c: char| !c.is_ascii_digit()).parse()?;
        // Compared as text, since a parser may err in the last digit of a number.
        let written = entry(number).to_string();
        ensure!(found.get() == written.as_str(), "frame {number}");
        ensure!(
            recording.read(path, u64::MAX)? == picture(number),
            "picture {number}"
        );
        numbers.push(number);
    }
    Ok(numbers)
}
