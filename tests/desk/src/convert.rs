//! Sessions written anew: into a folder, or into a recording.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs::{self, File};
use std::path::{self, Path};

use anyhow::{Context, ensure};
use app_core::recording::{Limits, Maps, Note, Picture, Topic, Writer};
use app_core::session::{FileError, Files, index_bytes};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::files::{SESSION_FILE, check_index_size};
use crate::output::{make_folder, write_whole};
use crate::stored::Stored;

/// The file name extension of a recording.
pub const EXTENSION: &str = "mcap";
/// In a folder: messages of the platform's channels, one per line.
const NOTES_FILE: &str = "notes.jsonl";
/// In a folder: facts about the device.
const DEVICE_FILE: &str = "device.json";
/// No file of a session is larger, the toy's 256 MiB included.
const MAX_FILE_BYTES: u64 = 512 << 20;

/// A line of the file of notes.
#[derive(Serialize, Deserialize)]
struct NoteLine {
    time_ns: u64,
    topic: String,
    message: Box<RawValue>,
}

/// The keys of the index whose values are stored elsewhere.
#[derive(Deserialize)]
struct Index<'a> {
    #[serde(borrow, default)]
    frames: Vec<&'a RawValue>,
}

#[derive(Deserialize)]
struct Entry {
    image: String,
    depth: Option<String>,
    people: Option<String>,
    #[serde(default)]
    time: f64,
}

impl Entry {
    /// Paths of its maps.
    fn maps(&self) -> Maps<&str> {
        Maps {
            depth: self.depth.as_deref(),
            people: self.people.as_deref(),
        }
    }

    /// Paths of its files that have a channel of a recording.
    fn files(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.image.as_str()).chain(self.maps().in_order().into_iter().flatten())
    }
}

/// Refuses a path for a session that is written anew. Call it before long work.
///
/// # Errors
/// When `out` exists already, or lies in the folder of `session`.
pub fn check_out(session: &Stored, out: &Path) -> anyhow::Result<()> {
    let named = || out.display().to_string();
    ensure!(
        !out.exists(),
        "{}: exists already: delete it or name another path",
        out.display()
    );
    let Stored::Folder(folder) = session else {
        return Ok(());
    };
    // Folders on the way to it may be missing.
    let absolute = path::absolute(out).with_context(named)?;
    let existing = absolute.ancestors().find(|ancestor| ancestor.exists());
    let is_inside = existing.map(|existing| folder.holds(existing)).transpose();
    ensure!(
        is_inside.with_context(named)? != Some(true),
        "{}: lies in the session itself: name a path outside of it",
        out.display()
    );
    Ok(())
}

/// Writes a session to `out`, as a recording if the path ends so, else as a folder; folders on the
/// way to it are made. `index` replaces its `capture.json` if given.
///
/// # Errors
/// When `out` exists already or lies in the session's folder, the index is too large to be read, a
/// file of the session cannot be read or is a link, or the system refuses.
pub fn write(session: &Stored, index: Option<Vec<u8>>, out: &Path) -> anyhow::Result<()> {
    check_out(session, out)?;
    let index = match index {
        Some(index) => index,
        None => index_bytes(session)?,
    };
    check_index_size(&index)?;
    let paths = session.paths()?;
    if let Some(parent) = out.parent() {
        make_folder(parent)?;
    }
    if out.extension().is_some_and(|extension| extension == EXTENSION) {
        write_recording(session, &index, &paths, out)
    } else {
        write_folder(session, &index, &paths, out)
    }
}

fn read(session: &dyn Files, path: &str) -> anyhow::Result<Vec<u8>> {
    session
        .read(path, MAX_FILE_BYTES)
        .with_context(|| path.to_owned())
}

fn write_folder(session: &Stored, index: &[u8], paths: &[String], out: &Path) -> anyhow::Result<()> {
    make_folder(out)?;
    for path in paths.iter().filter(|path| *path != SESSION_FILE) {
        let file = out.join(path);
        if let Some(folder) = file.parent() {
            make_folder(folder)?;
        }
        write_whole(&file, &read(session, path)?)?;
    }
    if let Stored::Recording(recording) = session {
        if !recording.notes().is_empty() {
            let lines = recording.notes().iter().map(note_line);
            let lines = lines.collect::<Result<Vec<_>, _>>()?.concat();
            write_whole(&out.join(NOTES_FILE), lines.as_bytes())?;
        }
        if !recording.device().is_empty() {
            let device = serde_json::to_vec_pretty(recording.device())?;
            write_whole(&out.join(DEVICE_FILE), &device)?;
        }
    }
    // Written last, so that a folder with an index is complete.
    Ok(write_whole(&out.join(SESSION_FILE), index)?)
}

fn note_line(note: &Note) -> serde_json::Result<String> {
    let line = NoteLine {
        time_ns: note.time_ns,
        topic: note.topic.name().to_owned(),
        message: RawValue::from_string(note.message.replace(['\n', '\r'], " "))?,
    };
    Ok(serde_json::to_string(&line)? + "\n")
}

fn write_recording(session: &Stored, index: &[u8], paths: &[String], out: &Path) -> anyhow::Result<()> {
    let index = std::str::from_utf8(index).context(SESSION_FILE)?;
    let frames = serde_json::from_str::<Index>(index).context(SESSION_FILE)?.frames;
    let entries = frames.iter().enumerate().map(|(place, frame)| {
        let entry: Entry =
            serde_json::from_str(frame.get()).with_context(|| format!("{SESSION_FILE} (frames[{place}])"))?;
        anyhow::Ok((entry, frame.get()))
    });
    let entries = entries.collect::<Result<Vec<_>, _>>()?;
    let (notes, device) = told(session)?;
    // Written under another name until it is complete.
    let partial = out.with_extension(format!("{}.partial", std::process::id()));
    let context = || partial.display().to_string();
    let written = File::create(&partial).with_context(context).and_then(|file| {
        let mut writer = Writer::new(file, index, device, Limits::default())?;
        let of_frames: HashSet<&str> = entries.iter().flat_map(|(entry, _)| entry.files()).collect();
        let first_ns = entries.first().map_or(0, |(entry, _)| time_ns(entry.time));
        let others = paths
            .iter()
            .filter(|path| !of_frames.contains(path.as_str()) && !is_of_recording(path));
        for path in others {
            writer.file(first_ns, path, &read(session, path)?)?;
        }
        write_frames((session, paths), &mut writer, &entries, &notes)?;
        let (file, _) = writer.finish()?;
        Ok(file.sync_all()?)
    });
    let moved = written.and_then(|()| fs::rename(&partial, out).with_context(context));
    if moved.is_err() {
        let _ = fs::remove_file(&partial);
    }
    moved
}

/// Whether a recording has a channel of its own for that file.
fn is_of_recording(path: &str) -> bool {
    [SESSION_FILE, NOTES_FILE, DEVICE_FILE].contains(&path)
}

/// Pictures of one kind that were written, with their numbers.
#[derive(Default)]
struct Numbered<'a> {
    numbers: HashMap<&'a str, u32>,
    /// The file that is written next.
    bytes: Vec<u8>,
}

impl<'a> Numbered<'a> {
    /// A picture by its path: a new one, or one that was written before.
    fn picture(&mut self, session: &Stored, path: &str) -> anyhow::Result<Picture<'_>> {
        Ok(match self.numbers.get(path) {
            Some(number) => Picture::Again(*number),
            None => {
                self.bytes = read(session, path)?;
                Picture::New(&self.bytes)
            }
        })
    }

    fn is_written(&mut self, path: &'a str, number: u32) {
        self.numbers.insert(path, number);
    }
}

fn write_frames(
    (session, paths): (&Stored, &[String]),
    writer: &mut Writer<File>,
    entries: &[(Entry, &str)],
    notes: &[Note],
) -> anyhow::Result<()> {
    let known: HashSet<&str> = paths.iter().map(String::as_str).collect();
    let mut pictures = Numbered::default();
    let mut numbered_maps = Maps::<()>::default().in_order().map(|_| Numbered::default());
    let mut notes = notes.iter().peekable();
    for (entry, text) in entries {
        let time_ns = time_ns(entry.time);
        while let Some(note) = notes.next_if(|note| note.time_ns <= time_ns) {
            writer.note(note.time_ns, note.topic, &note.message)?;
        }
        let picture = pictures.picture(session, &entry.image)?;
        // A folder may lack one, and is converted all the same.
        let paths = entry.maps().in_order();
        let paths = paths.map(|path| path.filter(|path| known.contains(path)));
        let mut maps = Maps::default().in_order();
        for ((map, path), numbered) in maps.iter_mut().zip(paths).zip(&mut numbered_maps) {
            *map = path.map(|path| numbered.picture(session, path)).transpose()?;
        }
        let (number, map_numbers) =
            writer.frame_with_maps(time_ns, picture, Maps::from_ordered(maps), text)?;
        pictures.is_written(&entry.image, number);
        let written = paths.into_iter().zip(map_numbers.in_order());
        for (numbered, (path, number)) in numbered_maps.iter_mut().zip(written) {
            if let Some((path, number)) = path.zip(number) {
                numbered.is_written(path, number);
            }
        }
    }
    for note in notes {
        writer.note(note.time_ns, note.topic, &note.message)?;
    }
    Ok(())
}

/// Nanoseconds of a time in seconds; 0 before the origin.
#[expect(clippy::cast_possible_truncation, reason = "a cast saturates")]
fn time_ns(secs: f64) -> u64 {
    (secs * 1e9).round() as u64
}

/// The session's notes of the platform and facts about the device.
fn told(session: &Stored) -> anyhow::Result<(Vec<Note>, BTreeMap<String, String>)> {
    let folder = match session {
        Stored::Recording(recording) => {
            return Ok((recording.notes().to_vec(), recording.device().clone()));
        }
        Stored::Folder(folder) => folder,
    };
    let file = |path: &str| match folder.read(path, MAX_FILE_BYTES) {
        Err(FileError::Missing) => Ok(None),
        read => read.map(Some).with_context(|| path.to_owned()),
    };
    let device = match file(DEVICE_FILE)? {
        Some(bytes) => serde_json::from_slice(&bytes).context(DEVICE_FILE)?,
        None => BTreeMap::new(),
    };
    let lines = file(NOTES_FILE)?.unwrap_or_default();
    let lines = std::str::from_utf8(&lines).context(NOTES_FILE)?.lines();
    let notes = lines.enumerate().map(|(place, line)| {
        let context = || format!("{NOTES_FILE} (line {})", place + 1);
        let line: NoteLine = serde_json::from_str(line).with_context(context)?;
        let topic = Topic::named(&line.topic).with_context(context)?;
        anyhow::Ok(Note {
            time_ns: line.time_ns,
            topic,
            message: line.message.get().to_owned(),
        })
    });
    Ok((notes.collect::<Result<_, _>>()?, device))
}
