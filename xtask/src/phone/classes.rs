//! Java class files: their names and the classes they refer to, so that a package with a missing
//! class is refused here.
//!
//! Source: The Java Virtual Machine Specification, chapter 4: `ClassFile`, the constant pool and
//! its tags.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context, Result, bail};

const MAGIC: u32 = 0xcafe_babe;

/// Packages that Android itself provides, if no list of its classes is available.
const PLATFORM: [&str; 8] = [
    "android/",
    "dalvik/",
    "java/",
    "javax/",
    "org/json/",
    "org/w3c/dom/",
    "org/xml/sax/",
    "org/xmlpull/v1/",
];

/// A class, and the classes in its constant pool.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct ClassFile {
    /// With slashes, like all names here.
    pub(super) name: String,
    /// Arrays as their element types.
    pub(super) names: BTreeSet<String>,
}

impl ClassFile {
    /// Reads the constant pool, and the class's own name after it.
    pub(super) fn read(bytes: &[u8]) -> Result<Self> {
        let mut reader = Reader { bytes, at: 0 };
        if reader.u32()? != MAGIC {
            bail!("no class file");
        }
        reader.skip(4)?;
        let pool = Pool::read(&mut reader)?;
        // Access flags.
        reader.skip(2)?;
        let own = reader.u16()?;
        let name = pool.class(own).context("a class without a name")?;
        let names = pool.classes.keys().filter_map(|index| pool.class(*index));
        let names = names.filter_map(|name| element(&name)).collect();
        Ok(Self { name, names })
    }
}

/// The element type of an array; the class itself if it is none; `None` for a primitive type.
fn element(name: &str) -> Option<String> {
    let Some(of) = name.strip_prefix('[') else {
        return Some(name.to_owned());
    };
    let of = of.trim_start_matches('[');
    Some(of.strip_prefix('L')?.strip_suffix(';')?.to_owned())
}

/// The classes of a constant pool.
#[derive(Default)]
struct Pool {
    words: BTreeMap<u16, String>,
    /// Index of a class's name by the index of the class.
    classes: BTreeMap<u16, u16>,
}

impl Pool {
    fn read(reader: &mut Reader<'_>) -> Result<Self> {
        let mut pool = Self::default();
        let n_entries = reader.u16()?;
        let mut index = 1;
        while index < n_entries {
            let tag = reader.u8()?;
            match tag {
                1 => {
                    let n_bytes = reader.u16()?;
                    let word = String::from_utf8_lossy(reader.take(n_bytes.into())?).into_owned();
                    pool.words.insert(index, word);
                }
                7 => {
                    pool.classes.insert(index, reader.u16()?);
                }
                8 | 16 | 19 | 20 => reader.skip(2)?,
                15 => reader.skip(3)?,
                3 | 4 | 9..=12 | 17 | 18 => reader.skip(4)?,
                5 | 6 => reader.skip(8)?,
                _ => bail!("a constant of kind {tag}, which is not known"),
            }
            // A long and a double take two entries.
            index += if matches!(tag, 5 | 6) { 2 } else { 1 };
        }
        Ok(pool)
    }

    fn class(&self, index: u16) -> Option<String> {
        self.words.get(self.classes.get(&index)?).cloned()
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8]> {
        let taken = self
            .bytes
            .get(self.at..self.at + n)
            .context("a class file that is cut")?;
        self.at += n;
        Ok(taken)
    }

    fn skip(&mut self, n: usize) -> Result<()> {
        self.take(n).map(drop)
    }

    fn u8(&mut self) -> Result<u8> {
        Ok(self.take(1)?[0])
    }

    fn u16(&mut self) -> Result<u16> {
        let taken = self.take(2)?;
        Ok(u16::from_be_bytes([taken[0], taken[1]]))
    }

    fn u32(&mut self) -> Result<u32> {
        Ok(u32::from(self.u16()?) << 16 | u32::from(self.u16()?))
    }
}

/// Refuses classes that refer to others which neither they nor the platform have.
///
/// `of_platform` has the classes of the framework, as a list of an archive's files; `None` if only
/// their packages are known.
pub(super) fn check_closure(classes: &[ClassFile], of_platform: Option<&BTreeSet<String>>) -> Result<()> {
    let own: BTreeSet<&str> = classes.iter().map(|class| class.name.as_str()).collect();
    let is_there = |name: &str| {
        own.contains(name)
            || of_platform.map_or_else(
                || PLATFORM.iter().any(|package| name.starts_with(package)),
                |classes| classes.contains(name),
            )
    };
    let mut missing: BTreeMap<&str, &str> = BTreeMap::new();
    for class in classes {
        for name in class.names.iter().filter(|name| !is_there(name)) {
            missing.entry(name).or_insert(&class.name);
        }
    }
    if missing.is_empty() {
        return Ok(());
    }
    let lines = missing
        .iter()
        .map(|(name, by)| format!("  {name}, which {by} names"));
    bail!(
        "the app would end if one of these classes is used, which neither the archive nor Android has:\n{}",
        lines.collect::<Vec<_>>().join("\n")
    )
}

/// The bytes of a class that refers to others: for tests, without a Java compiler.
#[cfg(test)]
pub(super) fn class_file(name: &str, names: &[&str]) -> Vec<u8> {
    let mut pool = Vec::new();
    let mut n_entries = 1_u16;
    let mut class = |name: &str| {
        pool.push(1);
        pool.extend(u16::try_from(name.len()).expect("a short name").to_be_bytes());
        pool.extend(name.as_bytes());
        pool.push(7);
        pool.extend(n_entries.to_be_bytes());
        n_entries += 2;
        n_entries - 1
    };
    let own = class(name);
    let parent = class("java/lang/Object");
    for name in names {
        class(name);
    }
    // A long, which takes two entries, and a string of the class's own name.
    pool.push(5);
    pool.extend([0; 8]);
    n_entries += 2;
    pool.extend([8, 0, 1]);
    n_entries += 1;
    // Version 52 is Java 8's.
    let mut bytes = [MAGIC.to_be_bytes(), [0, 0, 0, 52]].concat();
    bytes.extend(n_entries.to_be_bytes());
    bytes.extend(pool);
    // Public; no interfaces, fields, methods and attributes.
    bytes.extend([0, 0x21]);
    bytes.extend([own.to_be_bytes(), parent.to_be_bytes()].concat());
    bytes.extend([0; 8]);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn class(name: &str, names: &[&str]) -> ClassFile {
        ClassFile::read(&class_file(name, names)).expect("a class file")
    }

    #[test]
    fn a_class_file_says_what_it_names() {
        let read = class("a/B", &["a/C", "[[La/D;", "[I", "android/app/Activity"]);
        assert_eq!(read.name, "a/B");
        let names: Vec<&str> = read.names.iter().map(String::as_str).collect();
        assert_eq!(
            names,
            ["a/B", "a/C", "a/D", "android/app/Activity", "java/lang/Object"]
        );
    }

    #[test]
    fn classes_that_name_what_nobody_has_are_refused_by_name() {
        let activity = || {
            class(
                "com/google/ar/core/InstallActivity",
                &["com/google/ar/core/R$layout", "android/app/Activity"],
            )
        };
        let error = check_closure(&[activity()], None).expect_err("no R").to_string();
        assert!(
            error.contains("com/google/ar/core/R$layout, which com/google/ar/core/InstallActivity names"),
            "{error}"
        );
        let whole = [activity(), class("com/google/ar/core/R$layout", &[])];
        check_closure(&whole, None).expect("whole");
        let platform = BTreeSet::from(["java/lang/Object".to_owned()]);
        let error = check_closure(&whole, Some(&platform))
            .expect_err("no activities there")
            .to_string();
        assert!(error.contains("android/app/Activity"), "{error}");
    }

    #[test]
    fn what_is_no_class_file_is_refused() {
        let whole = class_file("a/B", &[]);
        for n in 0..whole.len() - 10 {
            assert!(ClassFile::read(&whole[..n]).is_err(), "{n}");
        }
        assert!(ClassFile::read(b"PK\x03\x04 and so on").is_err());
        let mut unknown = whole;
        unknown[10] = 99;
        assert!(ClassFile::read(&unknown).is_err());
    }
}
