//! Errors and losses of recordings.

use thiserror::Error;

/// The reason why writing ended early.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Stop {
    /// The recording has reached its size limit.
    #[error("the recording would be larger than its limit of {max_bytes} bytes")]
    Size {
        /// The limit.
        max_bytes: u64,
    },
    /// The index of the frames has reached the size that readers accept.
    #[error("the index of its frames would be larger than the limit of {max_bytes} bytes")]
    Index {
        /// The limit.
        max_bytes: u64,
    },
    /// The device has reached its limit of free space.
    #[error("less than {min_free_bytes} bytes would be left free on the device")]
    Space {
        /// The free space to keep.
        min_free_bytes: u64,
    },
    /// The device is full; the end of the file is cut.
    #[error("no free space is left on the device")]
    Full,
    /// The output reported another error; the end of the file is cut.
    #[error("cannot be written: {0}")]
    Sink(String),
}

/// The reason why something was not recorded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// Writing has ended, with this call or before it.
    #[error("recording has stopped: {0}")]
    Stopped(#[from] Stop),
    /// The session's index, or a frame's entry, is no JSON object, or lacks a required key. Nothing
    /// was written.
    #[error("{what}: {reason}")]
    Json {
        /// The rejected item.
        what: &'static str,
        /// The parser's error.
        reason: String,
    },
    /// The item is larger than a chunk, or than 32 bits can count. Nothing was written.
    #[error("{what}: {n_bytes} bytes, more than the limit of {max_bytes}")]
    TooLarge {
        /// The rejected item.
        what: &'static str,
        /// Its size.
        n_bytes: u64,
        /// The limit.
        max_bytes: u64,
    },
    /// A camera picture or one of its maps could not be encoded, for this reason. Nothing was written.
    #[error("a picture, its depths or its mask of people cannot be encoded: {0}")]
    Picture(String),
    /// A frame repeats a picture, depths, or a mask of people that were never written. Nothing was written.
    #[error("a frame repeats picture, depths or mask {sequence}, which were never recorded")]
    NoSuchPicture {
        /// Number of the picture, or of the map, from 0.
        sequence: u32,
    },
}

/// A recording that cannot be opened.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The system refused.
    #[error("cannot be read: {0}")]
    Io(String),
    /// The first bytes are not MCAP's, and no record follows them.
    #[error("not an MCAP recording")]
    NotMcap,
    /// Merged recordings, whose pictures cannot be separated.
    #[error("two recordings of sessions were merged into it: give the original recordings one by one")]
    TwoSessions,
    /// No intact chunk has a session in it.
    #[error("no session is in it{}", first_of(losses))]
    NoSession {
        /// The damage that was found.
        losses: Vec<Loss>,
    },
}

fn first_of(losses: &[Loss]) -> String {
    losses
        .first()
        .map_or(String::new(), |loss| format!(", and it is damaged: {loss}"))
}

/// A lost part of a recording; all else of it is read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Loss {
    /// The recording has no end: it was cut, or its writer was stopped. All intact parts were read.
    #[error("the recording was not finished: it ends at byte {at}, within a record")]
    Cut {
        /// End of the last intact record.
        at: u64,
    },
    /// Loss as in [`Loss::Cut`], without a partial record.
    #[error("the recording was not finished: it ends after byte {at} without its summary")]
    Unfinished {
        /// Size of the file.
        at: u64,
    },
    /// Untrusted bytes.
    #[error("bytes {from} to {to} are skipped: {reason}")]
    Skipped {
        /// The first of them.
        from: u64,
        /// The first intact byte after them.
        to: u64,
        /// The reason.
        reason: Damage,
    },
    /// Missing chunks.
    #[error("{n_chunks} chunks are lost; the first is number {first}")]
    Chunks {
        /// Number of the first, from 0.
        first: u32,
        /// Their number.
        n_chunks: u32,
    },
    /// Missing attached files.
    #[error(
        "{n_files} of {n_written} attached files are lost: a program that rewrote the recording may have dropped them, as `mcap filter` does without --include-attachments"
    )]
    Files {
        /// Number of missing files.
        n_files: u32,
        /// Number of written files.
        n_written: u32,
    },
    /// Frames whose picture, or one of its maps, was in a lost chunk, or are after one without its number.
    #[error(
        "{n_frames} frames are skipped, since their picture, depths or mask of people are lost or cannot be identified"
    )]
    Pictures {
        /// Their number.
        n_frames: u32,
    },
    /// Messages outside of chunks, which share one checksum, have changed.
    #[error("bytes were changed somewhere in the recording: the checksum of its data does not match")]
    Changed,
    /// Messages beyond the reader's limit.
    #[error("{n_messages} messages are skipped: they exceed {max_bytes} bytes")]
    TooMany {
        /// Their number.
        n_messages: u32,
        /// The limit.
        max_bytes: u64,
    },
}

/// The damage of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum Damage {
    /// Its checksum does not match.
    #[error("the checksum does not match")]
    Checksum,
    /// Its lengths contradict one another, or the file.
    #[error("the lengths do not fit")]
    Length,
    /// An unknown opcode.
    #[error("no such kind of record")]
    Kind,
    /// The file does not begin like MCAP.
    #[error("the first bytes are not those of MCAP")]
    Magic,
    /// Compression, which our own recordings do not use.
    #[error(
        "the chunk is compressed, which apps do not read: rewrite it without compression, as `cargo xtask convert` does"
    )]
    Compressed,
    /// Compressed data that cannot be decompressed.
    #[error("the chunk cannot be decompressed")]
    Inflate,
    /// Chunks with an implausible compression ratio.
    #[error("the compressed chunks hold more than {max_bytes} bytes")]
    Inflated {
        /// The limit, for all chunks of the file.
        max_bytes: u64,
    },
    /// A chunk above the reader's limit.
    #[error("the chunk is larger than {max_bytes} bytes")]
    TooLarge {
        /// The limit.
        max_bytes: u64,
    },
    /// A message outside of chunks in a recording with chunks, where no checksum covers it.
    #[error("a message outside of a chunk has no checksum")]
    Unguarded,
}
