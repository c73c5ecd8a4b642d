//! What keeps a recording from being written or read.

use thiserror::Error;

/// Why writing has ended before it was finished.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Stop {
    /// The recording is as large as it may be.
    #[error("the recording would be larger than the {max_bytes} bytes it may have")]
    Size {
        /// The limit that was set.
        max_bytes: u64,
    },
    /// The device is as full as it may be.
    #[error("less than {min_free_bytes} bytes would be left free on the device")]
    Space {
        /// What is to be left free.
        min_free_bytes: u64,
    },
    /// The device is full; the end of the file is cut.
    #[error("no room is left on the device")]
    Full,
    /// What is written to refused otherwise; the end of the file is cut.
    #[error("cannot be written: {0}")]
    Sink(String),
}

/// Why something was not recorded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// Writing has ended, with this call or before it.
    #[error("recording has stopped: {0}")]
    Stopped(#[from] Stop),
    /// The session's index, or a frame's entry, that is no JSON object, or has not what it needs. Nothing was written.
    #[error("{what}: {reason}")]
    Json {
        /// What was to be written.
        what: &'static str,
        /// What the parser said.
        reason: String,
    },
    /// More than a chunk, or than 32 bits can count. Nothing was written.
    #[error("{what}: {n_bytes} bytes, more than the {max_bytes} that it may have")]
    TooLarge {
        /// What was to be written.
        what: &'static str,
        /// Its size.
        n_bytes: u64,
        /// The limit.
        max_bytes: u64,
    },
    /// A camera picture that could not be encoded, and why. Nothing was written.
    #[error("a picture cannot be encoded: {0}")]
    Picture(String),
    /// A frame that repeats a picture which was never written. Nothing was written.
    #[error("picture {sequence} is repeated, but was never recorded")]
    NoSuchPicture {
        /// Number of the picture, from 0.
        sequence: u32,
    },
}

/// A recording that cannot be opened at all.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The system refused.
    #[error("cannot be read: {0}")]
    Io(String),
    /// The first bytes are others, and nothing of a recording follows them.
    #[error("not an MCAP recording")]
    NotMcap,
    /// Recordings that were merged: which pictures belong to which cannot be known.
    #[error("two recordings of sessions were merged into it: give them one by one, as they were before")]
    TwoSessions,
    /// No chunk that is whole has a session in it.
    #[error("no session is in it{}", first_of(losses))]
    NoSession {
        /// What was found damaged.
        losses: Vec<Loss>,
    },
}

fn first_of(losses: &[Loss]) -> String {
    losses
        .first()
        .map_or(String::new(), |loss| format!(", and it is damaged: {loss}"))
}

/// What of a recording is lost; all else of it is read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Loss {
    /// It has no end: it was cut, or whoever wrote it was stopped. All that is whole was read.
    #[error("the recording was not finished: it ends at byte {at}, within a record")]
    Cut {
        /// Where the last whole record ends.
        at: u64,
    },
    /// As [`Loss::Cut`], where nothing is left of another record.
    #[error("the recording was not finished: it ends after byte {at} without its summary")]
    Unfinished {
        /// Size of the file.
        at: u64,
    },
    /// Bytes that are no record that can be trusted.
    #[error("bytes {from} to {to} are skipped: {reason}")]
    Skipped {
        /// First of them.
        from: u64,
        /// The first that is good again.
        to: u64,
        /// What is wrong with them.
        reason: Damage,
    },
    /// Chunks that were written and are not there.
    #[error("{n_chunks} chunks are lost, the first of them number {first}")]
    Chunks {
        /// Number of the first, from 0.
        first: u32,
        /// How many there are.
        n_chunks: u32,
    },
    /// Files that were written and are not there.
    #[error(
        "{n_files} of {n_written} attached files are lost: a program that wrote the recording anew may have left them out, as `mcap filter` does without --include-attachments"
    )]
    Files {
        /// How many are missing.
        n_files: u32,
        /// How many there were.
        n_written: u32,
    },
    /// Frames whose picture stood in a chunk that is lost, or stands behind one without its number.
    #[error("{n_frames} frames are left out, since their picture is lost or cannot be told from others")]
    Pictures {
        /// How many there are.
        n_frames: u32,
    },
    /// Messages outside of chunks, all of which have one checksum.
    #[error("bytes were changed somewhere in the recording: the checksum of all its data is another")]
    Changed,
    /// Messages beyond what a reader keeps.
    #[error("{n_messages} messages are left out: more than {max_bytes} bytes of them")]
    TooMany {
        /// How many there are.
        n_messages: u32,
        /// The limit.
        max_bytes: u64,
    },
}

/// What is wrong with a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Damage {
    /// Its bytes are not those that were written.
    #[error("the checksum is another")]
    Checksum,
    /// Its lengths do not fit one another, or the file.
    #[error("the lengths do not fit")]
    Length,
    /// An opcode that the format has not.
    #[error("no such kind of record")]
    Kind,
    /// The file does not begin as MCAP does.
    #[error("the first bytes are not those of MCAP")]
    Magic,
    /// Compressed, which no recording of ours is.
    #[error(
        "the chunk is compressed, which apps do not read: write it anew without compression, as `cargo xtask convert` does"
    )]
    Compressed,
    /// Compressed, and something else than what was compressed comes out.
    #[error("what is compressed in the chunk cannot be had again")]
    Inflate,
    /// Chunks that hold so much more than they take that no recording's do.
    #[error("the compressed chunks hold more than {max_bytes} bytes")]
    Inflated {
        /// The limit, for all chunks of the file.
        max_bytes: u64,
    },
    /// More than a reader takes at once.
    #[error("the chunk is larger than {max_bytes} bytes")]
    TooLarge {
        /// The limit.
        max_bytes: u64,
    },
    /// A message that stands alone in a recording of chunks, where nothing guards its bytes.
    #[error("a message outside of a chunk has no checksum")]
    Unguarded,
}
