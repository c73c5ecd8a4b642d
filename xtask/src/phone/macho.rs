//! The imports of an iPhone executable, read from its Mach-O load commands.
//!
//! Source: Apple, `mach-o/loader.h` and `mach-o/nlist.h`, for 64-bit little-endian files.

use std::collections::BTreeSet;

use anyhow::{Context, Result, bail};

/// Processor of a 64-bit ARM executable.
pub(crate) const ARM64: u32 = 0x0100_000c;
/// Platform number of iOS.
pub(crate) const IOS: u32 = 2;
/// Kind of an executable file.
pub(crate) const EXECUTABLE: u32 = 2;

const MAGIC: u32 = 0xfeed_facf;
const N_HEADER: usize = 32;
const LOAD_DYLIB: u32 = 0xc;
const LOAD_WEAK_DYLIB: u32 = 0x8000_0018;
const SYMTAB: u32 = 2;
const BUILD_VERSION: u32 = 0x32;

/// An executable.
#[derive(Debug)]
pub(crate) struct Executable {
    pub(crate) processor: u32,
    /// Kind of file.
    pub(crate) kind: u32,
    /// Platform and its oldest supported version, as major and minor number.
    pub(crate) platform: Option<(u32, [u32; 2])>,
    /// Libraries and frameworks that are loaded with it.
    pub(crate) loads: BTreeSet<String>,
    /// Imported names.
    pub(crate) imports: BTreeSet<String>,
}

impl Executable {
    /// Reads the load commands of `file`.
    pub(crate) fn read(file: &[u8]) -> Result<Self> {
        if word(file, 0)? != MAGIC {
            bail!("no 64-bit little-endian Mach-O file");
        }
        let mut executable = Self {
            processor: word(file, 4)?,
            kind: word(file, 12)?,
            platform: None,
            loads: BTreeSet::new(),
            imports: BTreeSet::new(),
        };
        let mut at = N_HEADER;
        for _ in 0..word(file, 16)? {
            let size = word(file, at + 4)? as usize;
            let command = file
                .get(at..at + size)
                .filter(|command| command.len() >= 8)
                .context("a load command that is cut")?;
            executable.take(file, command)?;
            at += size;
        }
        Ok(executable)
    }

    fn take(&mut self, file: &[u8], command: &[u8]) -> Result<()> {
        match word(command, 0)? {
            LOAD_DYLIB | LOAD_WEAK_DYLIB => {
                self.loads.insert(text(command, word(command, 8)?)?);
            }
            BUILD_VERSION => {
                let oldest = word(command, 12)?;
                self.platform = Some((word(command, 8)?, [oldest >> 16, oldest >> 8 & 0xff]));
            }
            SYMTAB => self.imports = imports(file, command)?,
            _ => {}
        }
        Ok(())
    }
}

fn imports(file: &[u8], command: &[u8]) -> Result<BTreeSet<String>> {
    // Bits of a symbol's type: for the debugger, kind (0 is undefined), external.
    const DEBUG: u8 = 0xe0;
    const KIND: u8 = 0x0e;
    const EXTERNAL: u8 = 0x01;
    let [symbols, count, strings] = [8, 12, 16].map(|at| word(command, at));
    let (symbols, strings) = (symbols? as usize, strings?);
    let mut imports = BTreeSet::new();
    for symbol in (0..count? as usize).map(|index| symbols + 16 * index) {
        let flags = *file.get(symbol + 4).context("a symbol that is cut")?;
        if flags & (DEBUG | KIND) == 0 && flags & EXTERNAL != 0 {
            let name = strings
                .checked_add(word(file, symbol)?)
                .context("a place that is none")?;
            imports.insert(text(file, name)?);
        }
    }
    Ok(imports)
}

fn word(bytes: &[u8], at: usize) -> Result<u32> {
    let four = bytes
        .get(at..)
        .and_then(|rest| rest.first_chunk())
        .context("a Mach-O file that is cut")?;
    Ok(u32::from_le_bytes(*four))
}

fn text(bytes: &[u8], at: u32) -> Result<String> {
    let rest = bytes.get(at as usize..).context("a name outside of the file")?;
    let name = rest.split(|byte| *byte == 0).next().unwrap_or_default();
    Ok(String::from_utf8_lossy(name).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An executable for iOS 16.2 that loads one library and imports `_used` of two names.
    fn small() -> Vec<u8> {
        let mut commands: Vec<u32> = vec![BUILD_VERSION, 24, IOS, 16 << 16 | 2 << 8, 0, 0];
        let name = *b"/usr/lib/libA.dylib\0";
        commands.extend([LOAD_DYLIB, 24 + 20, 24, 0, 0, 0]);
        commands.extend(
            name.chunks(4)
                .map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]])),
        );
        let symbols = 32 + 4 * (u32::try_from(commands.len()).expect("few") + 6);
        commands.extend([SYMTAB, 24, symbols, 2, symbols + 32, 12]);
        let n_commands = 4 * u32::try_from(commands.len()).expect("few");
        let mut words = vec![MAGIC, ARM64, 0, EXECUTABLE, 3, n_commands, 0, 0];
        words.extend(commands);
        // An import, then a name that the file itself defines.
        words.extend([0, u32::from(0x01_u8), 0, 0, 6, 0x0f, 0, 0]);
        let mut file: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        file.extend(b"_used\0_own\0\0");
        file
    }

    #[test]
    fn load_commands_and_imports_are_read() {
        let executable = Executable::read(&small()).expect("an executable");
        assert_eq!((executable.processor, executable.kind), (ARM64, EXECUTABLE));
        assert_eq!(executable.platform, Some((IOS, [16, 2])));
        assert_eq!(
            executable.loads,
            BTreeSet::from(["/usr/lib/libA.dylib".to_owned()])
        );
        assert_eq!(executable.imports, BTreeSet::from(["_used".to_owned()]));
    }

    #[test]
    fn a_file_that_is_cut_is_refused() {
        let whole = small();
        // The last two bytes only end a name and fill a word.
        for n_bytes in 0..whole.len() - 12 {
            assert!(Executable::read(&whole[..n_bytes]).is_err(), "{n_bytes} bytes");
        }
    }
}
