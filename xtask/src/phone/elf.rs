//! The imports of an Android library, read from its ELF headers.
//!
//! Source: System V ABI, "Object Files" and "Program Loading and Dynamic Linking", for 64-bit
//! little-endian files.

use std::collections::BTreeSet;

use anyhow::{Context, Result, bail};

/// Machine of a 64-bit ARM library.
pub(crate) const AARCH64: u64 = 183;

const LOADED: u64 = 1;
const DYNAMIC: u64 = 2;
const NEEDED: u64 = 1;
const STRINGS: u64 = 5;
const SYMBOL_TABLE: u64 = 11;

/// A shared library.
#[derive(Debug)]
pub(crate) struct Library {
    pub(crate) machine: u64,
    /// Alignment of each mapped segment, bytes.
    pub(crate) alignments: Vec<u64>,
    /// Required libraries.
    pub(crate) needed: BTreeSet<String>,
    /// Imported names, without optional ones.
    pub(crate) imports: BTreeSet<String>,
    /// Exported names.
    pub(crate) exports: BTreeSet<String>,
}

/// The relevant fields of a segment.
struct Segment {
    kind: u64,
    offset: u64,
    address: u64,
    n_bytes: u64,
    alignment: u64,
}

impl Library {
    /// Reads the headers of `file`.
    pub(crate) fn read(file: &[u8]) -> Result<Self> {
        // Class 2 is 64 bits, data 1 is little-endian.
        if file.get(..6) != Some(b"\x7fELF\x02\x01".as_slice()) {
            bail!("no 64-bit little-endian ELF file");
        }
        let segments = segments(file)?;
        let loaded = segments.iter().filter(|segment| segment.kind == LOADED);
        let (imports, exports) = symbols(file)?;
        Ok(Self {
            machine: number(file, 18, 2)?,
            alignments: loaded.map(|segment| segment.alignment).collect(),
            needed: needed(file, &segments)?,
            imports,
            exports,
        })
    }
}

fn segments(file: &[u8]) -> Result<Vec<Segment>> {
    let (table, size, count) = (number(file, 32, 8)?, number(file, 54, 2)?, number(file, 56, 2)?);
    let segment = |index| {
        let at = table + index * size;
        let field = |offset, n_bytes| number(file, at + offset, n_bytes);
        Ok(Segment {
            kind: field(0, 4)?,
            offset: field(8, 8)?,
            address: field(16, 8)?,
            n_bytes: field(32, 8)?,
            alignment: field(48, 8)?,
        })
    };
    (0..count).map(segment).collect()
}

fn needed(file: &[u8], segments: &[Segment]) -> Result<BTreeSet<String>> {
    let dynamic = segments
        .iter()
        .find(|segment| segment.kind == DYNAMIC)
        .context("no dynamic section")?;
    let mut entries = Vec::new();
    for at in (dynamic.offset..dynamic.offset + dynamic.n_bytes).step_by(16) {
        entries.push((number(file, at, 8)?, number(file, at + 8, 8)?));
    }
    let address = entries
        .iter()
        .find(|(tag, _)| *tag == STRINGS)
        .context("no names")?
        .1;
    let strings = segments
        .iter()
        .filter(|segment| segment.kind == LOADED)
        .find(|segment| (segment.address..segment.address + segment.n_bytes).contains(&address))
        .map(|segment| address - segment.address + segment.offset)
        .context("names outside of the file")?;
    let names = entries.iter().filter(|(tag, _)| *tag == NEEDED);
    names.map(|(_, name)| text(file, strings + name)).collect()
}

/// Imported and exported names.
fn symbols(file: &[u8]) -> Result<(BTreeSet<String>, BTreeSet<String>)> {
    let (table, size, count) = (number(file, 40, 8)?, number(file, 58, 2)?, number(file, 60, 2)?);
    let (mut imports, mut exports) = (BTreeSet::new(), BTreeSet::new());
    for section in (0..count).map(|index| table + index * size) {
        if number(file, section + 4, 4)? != SYMBOL_TABLE {
            continue;
        }
        let (offset, n_bytes) = (number(file, section + 24, 8)?, number(file, section + 32, 8)?);
        let linked = table + number(file, section + 40, 4)? * size;
        let strings = number(file, linked + 24, 8)?;
        // The first symbol is a null entry.
        for symbol in (offset..offset + n_bytes).step_by(24).skip(1) {
            let name = text(file, strings + number(file, symbol, 4)?)?;
            let (binding, defined_in) = (number(file, symbol + 4, 1)? >> 4, number(file, symbol + 6, 2)?);
            let is_weak = binding == 2;
            if defined_in != 0 {
                exports.insert(name);
            } else if !is_weak {
                imports.insert(name);
            }
        }
    }
    Ok((imports, exports))
}

/// A little-endian number of up to eight bytes.
fn number(file: &[u8], at: u64, n_bytes: usize) -> Result<u64> {
    let at = usize::try_from(at)?;
    let end = at.checked_add(n_bytes).context("a place that is none")?;
    let bytes = file.get(at..end).context("an ELF file that is cut")?;
    Ok(bytes
        .iter()
        .rev()
        .fold(0, |number, byte| number << 8 | u64::from(*byte)))
}

fn text(file: &[u8], at: u64) -> Result<String> {
    let rest = file
        .get(usize::try_from(at)?..)
        .context("a name outside of the file")?;
    let name = rest.split(|byte| *byte == 0).next().unwrap_or_default();
    Ok(String::from_utf8_lossy(name).into_owned())
}

#[cfg(all(test, target_os = "linux", target_pointer_width = "64"))]
mod tests {
    use super::*;

    #[test]
    fn this_very_program_needs_a_c_library() {
        let file = std::fs::read(std::env::current_exe().expect("a program")).expect("its file");
        let program = Library::read(&file).expect("its headers");
        assert!(program.needed.contains("libc.so.6"), "{:?}", program.needed);
        assert!(
            program.imports.iter().any(|name| name == "malloc"),
            "{:?}",
            program.imports
        );
        assert!(program.alignments.iter().all(|alignment| *alignment >= 4096));
        assert!(Library::read(&file[..200]).is_err());
        assert!(Library::read(b"!<arch>\n").is_err());
    }
}
