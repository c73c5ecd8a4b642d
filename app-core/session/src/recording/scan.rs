//! Goes through a recording once, from its first byte to its last, and trusts what checksums vouch for.
//!
//! A chunk or file is whole or is not there. Where lengths or checksums are wrong, the next chunk or file is looked for
//! byte by byte: it is one only if its own checksum holds. The summary at the end is not looked at, since a recording that
//! was cut has none.

use super::chunk::{CHUNK_HEAD_BYTES, MAX_CHUNK_BYTES};
use super::error::{Damage, Loss, RecordingError};
use super::found::{Found, Span};
use super::source::Source;
use super::wire::{
    ATTACHMENT, CHUNK, DATA_END, FOOTER, HEAD_BYTES, HEAD_LEN, HEADER, MAGIC, MESSAGE, MESSAGE_INDEX,
    METADATA, Rest, parse_head,
};

/// Bytes that are read at once where nothing larger is wanted.
const WINDOW_BYTES: u64 = 64 << 10;
/// No attached file has a longer path and media type.
const MAX_NAME_BYTES: u64 = 4096;
/// Bytes of an attached file's body before its path: two times.
const TIMES_BYTES: u64 = 16;
const CHECKSUM_BYTES: u64 = 4;
/// How often the file's size may be read for chunks and files that only seem to be some, where it is damaged.
const MAX_TRIALS: u64 = 4;
/// Losses that are told one by one.
const MAX_LOSSES: usize = 1000;

/// Reads all of it.
pub(super) fn scan(source: &dyn Source) -> Result<Found, RecordingError> {
    let mut scan = Scan {
        source,
        n_bytes: source.n_bytes(),
        at: 0,
        trusted: 0,
        trials_left: source.n_bytes().saturating_mul(MAX_TRIALS),
        has_data_end: false,
        has_footer: false,
        buffer: Vec::new(),
        found: Found::default(),
    };
    scan.run()?;
    Ok(scan.found)
}

struct Scan<'a> {
    source: &'a dyn Source,
    n_bytes: u64,
    at: u64,
    /// What is before was vouched for, or looked at for what can be. What follows up to `at` is indices, as it seems.
    trusted: u64,
    /// Bytes.
    trials_left: u64,
    has_data_end: bool,
    has_footer: bool,
    /// Of a chunk, used again.
    buffer: Vec<u8>,
    found: Found,
}

/// Why a record is not taken.
enum Bad {
    Damage(Damage),
    Io(RecordingError),
}

impl From<Damage> for Bad {
    fn from(damage: Damage) -> Self {
        Self::Damage(damage)
    }
}

impl From<std::io::Error> for Bad {
    fn from(error: std::io::Error) -> Self {
        Self::Io(RecordingError::Io(error.to_string()))
    }
}

impl Scan<'_> {
    fn run(&mut self) -> Result<(), RecordingError> {
        let magic = self.head_bytes(0, MAGIC.len() as u64)?;
        if magic == MAGIC {
            self.at = MAGIC.len() as u64;
        } else {
            self.skip_damage(Damage::Magic)?;
            if self.at == self.n_bytes {
                return Err(RecordingError::NotMcap);
            }
        }
        let is_finished = loop {
            let left = self.n_bytes - self.at;
            if left < HEAD_BYTES {
                let rest = self.head_bytes(self.at, left)?;
                let is_end = rest == MAGIC;
                if left > 0 && !is_end {
                    self.lose(Loss::Cut { at: self.at });
                }
                break is_end && self.has_footer;
            }
            match self.record() {
                Ok(end) => self.at = end,
                Err(Bad::Io(error)) => return Err(error),
                Err(Bad::Damage(damage)) => self.skip_damage(damage)?,
            }
        };
        let is_told = match self.found.losses.last() {
            Some(Loss::Cut { .. }) => true,
            Some(Loss::Skipped { to, .. }) => *to == self.n_bytes,
            _ => false,
        };
        if !is_finished && !is_told {
            self.lose(Loss::Unfinished { at: self.n_bytes });
        }
        Ok(())
    }

    fn lose(&mut self, loss: Loss) {
        if self.found.losses.len() < MAX_LOSSES {
            self.found.losses.push(loss);
        }
    }

    /// Up to `n_bytes` bytes, fewer where the file ends.
    fn head_bytes(&self, at: u64, n_bytes: u64) -> Result<Vec<u8>, RecordingError> {
        let n_bytes = n_bytes.min(self.n_bytes.saturating_sub(at)).min(MAX_CHUNK_BYTES);
        let mut bytes = vec![0; n_bytes as usize];
        self.source
            .read_at(at, &mut bytes)
            .map_err(|error| RecordingError::Io(error.to_string()))?;
        Ok(bytes)
    }

    /// Reads the record at the place of the scan, and returns where it ends.
    fn record(&mut self) -> Result<u64, Bad> {
        let mut head = [0; HEAD_LEN];
        self.source.read_at(self.at, &mut head)?;
        let (opcode, n_bytes) = parse_head(head);
        let body_at = self.at + HEAD_BYTES;
        let end = body_at
            .checked_add(n_bytes)
            .filter(|end| *end <= self.n_bytes)
            .ok_or(Damage::Length)?;
        match opcode {
            CHUNK => {
                self.chunk(body_at, n_bytes)?;
                self.trusted = end;
            }
            ATTACHMENT => {
                self.file(body_at, n_bytes)?;
                self.trusted = end;
            }
            MESSAGE => return Err(Damage::Unguarded.into()),
            MESSAGE_INDEX => self.index(body_at, n_bytes)?,
            METADATA => {}
            HEADER if self.at == MAGIC.len() as u64 => {}
            DATA_END => self.has_data_end = true,
            FOOTER if self.has_data_end => self.has_footer = true,
            // The summary tells nothing that chunks do not.
            _ if self.has_data_end => {}
            _ => return Err(Damage::Kind.into()),
        }
        Ok(end)
    }

    /// An index is one by its lengths: where it is none, it may be a chunk whose kind has one wrong bit.
    fn index(&self, body_at: u64, n_bytes: u64) -> Result<(), Bad> {
        const HEAD: u64 = 6;
        const ENTRY: u64 = 16;
        let head = self.head_bytes(body_at, HEAD.min(n_bytes)).map_err(Bad::Io)?;
        let mut rest = Rest(&head);
        let n_entry_bytes = rest.u16().and_then(|_channel| rest.u32()).map(u64::from);
        let is_index = n_entry_bytes.is_some_and(|n| n % ENTRY == 0 && n + HEAD == n_bytes);
        Ok(if is_index { Ok(()) } else { Err(Damage::Kind) }?)
    }

    /// Size of a chunk's records, after a look at its first bytes.
    fn chunk_head(&self, body_at: u64, n_bytes: u64) -> Result<(u64, u32), Bad> {
        let head = self.head_bytes(body_at, CHUNK_HEAD_BYTES).map_err(Bad::Io)?;
        let mut rest = Rest(&head);
        let _times = rest.take(TIMES_BYTES).ok_or(Damage::Length)?;
        let n_uncompressed = rest.u64().ok_or(Damage::Length)?;
        let checksum = rest.u32().ok_or(Damage::Length)?;
        let n_name_bytes = rest.u32().ok_or(Damage::Length)?;
        if n_name_bytes != 0 {
            let name = rest.take(3);
            let is_known = matches!((n_name_bytes, name), (3, Some(b"lz4")) | (4, Some(b"zst")));
            return Err(if is_known {
                Damage::Compressed
            } else {
                Damage::Length
            }
            .into());
        }
        let n_record_bytes = rest.u64().ok_or(Damage::Length)?;
        let is_whole = n_record_bytes.checked_add(CHUNK_HEAD_BYTES) == Some(n_bytes);
        if n_uncompressed != n_record_bytes || !is_whole {
            return Err(Damage::Length.into());
        }
        Ok((n_record_bytes, checksum))
    }

    fn chunk(&mut self, body_at: u64, n_bytes: u64) -> Result<(), Bad> {
        self.check_chunk(body_at, n_bytes)?;
        let is_taken = self.found.chunk(body_at + CHUNK_HEAD_BYTES, &self.buffer);
        Ok(is_taken.ok_or(Damage::Length)?)
    }

    /// Fills the buffer with a chunk's records, and compares their checksum.
    fn check_chunk(&mut self, body_at: u64, n_bytes: u64) -> Result<(), Bad> {
        let (n_record_bytes, checksum) = self.chunk_head(body_at, n_bytes)?;
        let max_bytes = MAX_CHUNK_BYTES;
        if n_record_bytes > max_bytes {
            return Err(Damage::TooLarge { max_bytes }.into());
        }
        #[expect(clippy::cast_possible_truncation, reason = "at most a chunk")]
        self.buffer.resize(n_record_bytes as usize, 0);
        self.source
            .read_at(body_at + CHUNK_HEAD_BYTES, &mut self.buffer)?;
        // Nought stands for no checksum.
        if checksum == 0 || crc32fast::hash(&self.buffer) == checksum {
            Ok(())
        } else {
            Err(Damage::Checksum.into())
        }
    }

    /// Path of an attached file and place of its bytes, after a look at its first ones.
    fn file_head(&self, body_at: u64, n_bytes: u64) -> Result<(String, Span), Bad> {
        let head = self
            .head_bytes(body_at, n_bytes.min(MAX_NAME_BYTES))
            .map_err(Bad::Io)?;
        let mut rest = Rest(&head);
        let _times = rest.take(TIMES_BYTES).ok_or(Damage::Length)?;
        let path = rest.text().ok_or(Damage::Length)?.to_owned();
        let _media_type = rest.text().ok_or(Damage::Length)?;
        let n_data_bytes = rest.u64().ok_or(Damage::Length)?;
        let n_head_bytes = (head.len() - rest.0.len()) as u64;
        let n_fixed = n_head_bytes + CHECKSUM_BYTES;
        if n_data_bytes.checked_add(n_fixed) != Some(n_bytes) {
            return Err(Damage::Length.into());
        }
        let span = Span {
            at: body_at + n_head_bytes,
            n_bytes: n_data_bytes,
        };
        Ok((path, span))
    }

    fn file(&mut self, body_at: u64, n_bytes: u64) -> Result<(), Bad> {
        let (path, span) = self.check_file(body_at, n_bytes)?;
        self.found.file(path, span);
        Ok(())
    }

    /// Compares the checksum of an attached file, a window at a time.
    fn check_file(&self, body_at: u64, n_bytes: u64) -> Result<(String, Span), Bad> {
        let (path, span) = self.file_head(body_at, n_bytes)?;
        let end = span.at + span.n_bytes;
        let mut hasher = crc32fast::Hasher::new();
        let mut at = body_at;
        while at < end {
            let window = self.head_bytes(at, WINDOW_BYTES.min(end - at)).map_err(Bad::Io)?;
            hasher.update(&window);
            at += window.len() as u64;
        }
        let mut checksum = [0; size_of::<u32>()];
        self.source.read_at(end, &mut checksum)?;
        let checksum = u32::from_le_bytes(checksum);
        if checksum != 0 && checksum != hasher.finalize() {
            return Err(Damage::Checksum.into());
        }
        Ok((path, span))
    }

    /// Goes on with the next chunk or file whose checksum holds. What seemed to be indices before the damage may have been
    /// something else, so that they are looked through again.
    fn skip_damage(&mut self, damage: Damage) -> Result<(), RecordingError> {
        let (from, damaged_at) = (self.trusted, self.at);
        let mut at = from;
        while at + HEAD_BYTES <= self.n_bytes {
            let window = self.head_bytes(at, WINDOW_BYTES)?;
            for (offset, head) in window.windows(HEAD_LEN).enumerate() {
                let Some(head) = head.first_chunk() else { continue };
                if self.is_good(at + offset as u64, *head)? {
                    self.at = at + offset as u64;
                    // Where its records are none of ours it is not found again.
                    self.trusted = self.at + 1;
                    self.has_data_end = false;
                    self.lose(Loss::Skipped {
                        from,
                        to: self.at,
                        reason: damage,
                    });
                    return Ok(());
                }
            }
            at += (window.len() as u64 + 1 - HEAD_BYTES).max(1);
        }
        // Nothing follows: a record that reaches beyond the end is one that was cut.
        let loss = match damage {
            Damage::Length => Loss::Cut { at: damaged_at },
            reason => Loss::Skipped {
                from,
                to: self.n_bytes,
                reason,
            },
        };
        self.lose(loss);
        self.at = self.n_bytes;
        Ok(())
    }

    /// Whether a chunk or file begins here, whose checksum holds.
    fn is_good(&mut self, at: u64, head: [u8; HEAD_LEN]) -> Result<bool, RecordingError> {
        let (opcode, n_bytes) = parse_head(head);
        let body_at = at + HEAD_BYTES;
        if body_at.checked_add(n_bytes).is_none_or(|end| end > self.n_bytes) {
            return Ok(false);
        }
        let seems = match opcode {
            CHUNK => self.chunk_head(body_at, n_bytes).map(|_| ()),
            ATTACHMENT => self.file_head(body_at, n_bytes).map(|_| ()),
            _ => return Ok(false),
        };
        match seems {
            Ok(()) => {}
            Err(Bad::Damage(_)) => return Ok(false),
            Err(Bad::Io(error)) => return Err(error),
        }
        if n_bytes > self.trials_left {
            return Ok(false);
        }
        self.trials_left -= n_bytes;
        let tried = match opcode {
            CHUNK => self.check_chunk(body_at, n_bytes),
            _ => self.check_file(body_at, n_bytes).map(|_| ()),
        };
        match tried {
            Ok(()) => Ok(true),
            Err(Bad::Damage(_)) => Ok(false),
            Err(Bad::Io(error)) => Err(error),
        }
    }
}
