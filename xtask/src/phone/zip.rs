//! Archives for phones: uncompressed entries, libraries with the alignment for mapping.
//!
//! Source: PKWARE's APPNOTE.TXT 6.3 for the format; the padding is Android's extra field 0xd935, as
//! `zipalign` writes it.

use anyhow::{Context, Result, bail};

/// Alignment of an uncompressed library in a package, in bytes, for phones with pages of 16 KB.
pub(crate) const PAGE: usize = 16 * 1024;
/// Alignment of all other entries.
const WORD: usize = 4;

const LOCAL: u32 = 0x0403_4b50;
const CENTRAL: u32 = 0x0201_4b50;
const END: u32 = 0x0605_4b50;
/// Header of an entry, without its name and extra field.
const N_LOCAL: usize = 30;
const N_CENTRAL: usize = 46;
const N_END: usize = 22;
/// Extra field of alignment: identifier, size, and the alignment itself, before the padding.
const ALIGNMENT_FIELD: u16 = 0xd935;
const N_ALIGNMENT_FIELD: usize = 6;
/// 1 January 1980, so that an archive depends only on its contents.
const DATE: u16 = 0x21;
/// Made by Unix, for the archive's file modes.
const MADE_BY: u16 = 0x031e;

/// A file in an archive.
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) bytes: Vec<u8>,
    /// Whether it is executable.
    pub(crate) is_program: bool,
}

/// A file found in an archive.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Found {
    pub(crate) name: String,
    /// Offset of its bytes.
    pub(crate) at: usize,
    pub(crate) n_bytes: usize,
    pub(crate) is_stored: bool,
}

impl Found {
    /// Whether it is aligned as a package requires.
    pub(crate) fn is_aligned(&self) -> bool {
        !self.is_stored || self.at.is_multiple_of(alignment(&self.name))
    }
}

fn alignment(name: &str) -> usize {
    if is_library(name) { PAGE } else { WORD }
}

fn is_library(name: &str) -> bool {
    std::path::Path::new(name)
        .extension()
        .is_some_and(|end| end == "so")
}

/// An archive of `entries`, in their order.
pub(crate) fn write(entries: &[Entry]) -> Result<Vec<u8>> {
    let mut archive = Vec::new();
    let mut directory = Vec::new();
    for entry in entries {
        let extra = padding(archive.len() + N_LOCAL + entry.name.len(), alignment(&entry.name))?;
        let sums = sums(entry)?;
        let at = u32::try_from(archive.len())?;
        put32(&mut archive, LOCAL);
        archive.extend(&sums);
        put16(&mut archive, u16::try_from(extra.len())?);
        archive.extend(entry.name.bytes());
        archive.extend(&extra);
        archive.extend(&entry.bytes);

        put32(&mut directory, CENTRAL);
        put16(&mut directory, MADE_BY);
        directory.extend(&sums);
        // No extra field, no comment, the first disk, a binary file.
        directory.extend([0; 8]);
        let mode: u32 = if entry.is_program { 0o100_755 } else { 0o100_644 };
        put32(&mut directory, mode << 16);
        put32(&mut directory, at);
        directory.extend(entry.name.bytes());
    }
    let (at, n_bytes) = (u32::try_from(archive.len())?, u32::try_from(directory.len())?);
    let n_entries = u16::try_from(entries.len())?;
    archive.extend(directory);
    put32(&mut archive, END);
    archive.extend([0; 4]);
    put16(&mut archive, n_entries);
    put16(&mut archive, n_entries);
    put32(&mut archive, n_bytes);
    put32(&mut archive, at);
    put16(&mut archive, 0);
    Ok(archive)
}

/// The fields that a local header and the directory share: version 2.0, UTF-8, stored, date,
/// checksum, sizes, length of the name.
fn sums(entry: &Entry) -> Result<Vec<u8>> {
    let n_bytes = u32::try_from(entry.bytes.len())?;
    let mut sums = Vec::new();
    for half in [20, 0x0800, 0, 0, DATE] {
        put16(&mut sums, half);
    }
    for word in [crc32(&entry.bytes), n_bytes, n_bytes] {
        put32(&mut sums, word);
    }
    put16(&mut sums, u16::try_from(entry.name.len())?);
    Ok(sums)
}

/// The extra field after which data for the offset `at` begins at a multiple of `alignment`.
fn padding(at: usize, alignment: usize) -> Result<Vec<u8>> {
    if alignment == WORD && at.is_multiple_of(WORD) {
        return Ok(Vec::new());
    }
    let n_padding = (at + N_ALIGNMENT_FIELD).next_multiple_of(alignment) - at - N_ALIGNMENT_FIELD;
    let mut extra = Vec::new();
    put16(&mut extra, ALIGNMENT_FIELD);
    put16(&mut extra, u16::try_from(2 + n_padding)?);
    put16(&mut extra, u16::try_from(alignment)?);
    extra.resize(N_ALIGNMENT_FIELD + n_padding, 0);
    Ok(extra)
}

fn put16(to: &mut Vec<u8>, number: u16) {
    to.extend(number.to_le_bytes());
}

fn put32(to: &mut Vec<u8>, number: u32) {
    to.extend(number.to_le_bytes());
}

/// CRC-32 of ISO-HDLC, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    const POLYNOMIAL: u32 = 0xedb8_8320;
    let step = |crc: u32, _| (crc >> 1) ^ (POLYNOMIAL & (crc & 1).wrapping_neg());
    let crc = bytes
        .iter()
        .fold(!0, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step));
    !crc
}

/// The contents of an archive, by its directory.
pub(crate) fn read(archive: &[u8]) -> Result<Vec<Found>> {
    let last = archive.len().checked_sub(N_END).context("no archive")?;
    // A comment of up to 64 KiB may follow.
    let end = (last.saturating_sub(usize::from(u16::MAX))..=last)
        .rev()
        .find(|at| get32(archive, *at).ok() == Some(END))
        .context("no end of a directory")?;
    let n_entries = get16(archive, end + 10)?;
    let mut at = get32(archive, end + 16)? as usize;
    let mut found = Vec::new();
    for _ in 0..n_entries {
        if get32(archive, at)? != CENTRAL {
            bail!("no entry of a directory at {at}");
        }
        let [n_name, n_extra, n_comment] = [28, 30, 32].map(|field| get16(archive, at + field));
        let name = archive
            .get(at + N_CENTRAL..at + N_CENTRAL + usize::from(n_name?))
            .context("a name that is cut")?;
        let local = get32(archive, at + 42)? as usize;
        if get32(archive, local)? != LOCAL {
            bail!("no entry at {local}");
        }
        let in_front = get16(archive, local + 26)? + get16(archive, local + 28)?;
        found.push(Found {
            name: String::from_utf8_lossy(name).into_owned(),
            at: local + N_LOCAL + usize::from(in_front),
            n_bytes: get32(archive, at + 24)? as usize,
            is_stored: get16(archive, at + 10)? == 0,
        });
        at += N_CENTRAL + name.len() + usize::from(n_extra?) + usize::from(n_comment?);
    }
    Ok(found)
}

fn get16(bytes: &[u8], at: usize) -> Result<u16> {
    let two = bytes
        .get(at..)
        .and_then(|rest| rest.first_chunk())
        .context("an archive that is cut")?;
    Ok(u16::from_le_bytes(*two))
}

fn get32(bytes: &[u8], at: usize) -> Result<u32> {
    let four = bytes
        .get(at..)
        .and_then(|rest| rest.first_chunk())
        .context("an archive that is cut")?;
    Ok(u32::from_le_bytes(*four))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(name: &str, n_bytes: usize) -> Entry {
        Entry {
            name: name.into(),
            bytes: vec![7; n_bytes],
            is_program: false,
        }
    }

    #[test]
    fn libraries_begin_on_pages_and_all_else_on_words() {
        let entries = [
            entry("AndroidManifest.xml", 13),
            entry("lib/arm64-v8a/liba.so", 40_001),
            entry("resources.arsc", 3),
            entry("lib/arm64-v8a/libb.so", 1),
        ];
        let archive = write(&entries).expect("an archive");
        let found = read(&archive).expect("what is in it");
        assert_eq!(found.len(), 4);
        for (entry, found) in entries.iter().zip(&found) {
            assert_eq!(entry.name, found.name);
            assert_eq!(archive[found.at..found.at + found.n_bytes], entry.bytes);
            assert!(found.is_aligned(), "{found:?}");
        }
        assert_eq!([found[1].at % PAGE, found[3].at % PAGE], [0, 0]);
    }

    #[test]
    fn a_library_on_a_page_of_4_kb_is_not_aligned() {
        let shifted = |at| Found {
            name: "lib/arm64-v8a/liba.so".into(),
            at,
            n_bytes: 1,
            is_stored: true,
        };
        assert!(!shifted(4096).is_aligned());
        assert!(shifted(PAGE).is_aligned());
    }

    #[test]
    fn the_checksum_is_that_of_its_catalogue() {
        // Check value of CRC-32/ISO-HDLC in the catalogue of parametrised CRC algorithms.
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn what_is_no_archive_is_refused() {
        assert!(read(&[]).is_err());
        assert!(read(&[0; 100]).is_err());
        let archive = write(&[entry("a", 1)]).expect("an archive");
        assert!(
            read(&archive[20..]).is_err(),
            "entries that are not where the directory says"
        );
    }
}
