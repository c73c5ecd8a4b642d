//! Recordings: a session in one MCAP file, written live and read like a folder.
//!
//! A [`Writer`] appends to the caller's output, and a [`Recording`] reads through a [`Source`]:
//! this module opens no file itself, and times come from the caller.
//!
//! [session format]: crate
//!
#![doc = include_str!("../../../doc/recording.md")]

mod chunk;
mod codec;
mod entry;
mod error;
mod found;
mod index;
mod inflate;
mod job;
mod json;
mod maps;
mod message;
mod protobuf;
mod queue;
mod reader;
mod scan;
mod source;
mod summary;
mod topics;
mod viewer;
mod wire;
mod writer;

pub use codec::{PictureCodec, PlatformEncoder};
pub use entry::LiveFrame;
pub use error::{Damage, Loss, RecordingError, Stop, WriteError};
pub use found::Note;
pub use job::{Ending, RecordingJob, RecordingOptions, RecordingOutcome};
pub use maps::Maps;
pub use queue::{Item, RecordingReceiver, RecordingSender, queue};
pub use reader::Recording;
pub use source::Source;
pub use topics::Topic;
pub use writer::{Flushed, Limits, Picture, Writer};
