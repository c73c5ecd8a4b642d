//! Sizes of the phones' files, compared with budgets.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail};

/// Head of the list of sizes.
const HEAD: &str = "\
# Sizes of what `cargo xtask ios package` and `cargo xtask android package` make without Apple's SDK and the NDK, in bytes:
# name, size when it was recorded, budget. `cargo xtask size` holds them; `cargo xtask size --record` takes sizes anew.
";

/// An entry of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Entry {
    name: String,
    recorded: u64,
    budget: u64,
}

fn parse(list: &str) -> Result<Vec<Entry>> {
    let lines = list
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'));
    let entry = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let [name, recorded, budget] = words[..] else {
            bail!("{line:?} is no entry");
        };
        Ok(Entry {
            name: name.to_owned(),
            recorded: recorded.parse().with_context(|| line.to_owned())?,
            budget: budget.parse().with_context(|| line.to_owned())?,
        })
    };
    lines.map(entry).collect()
}

/// A line for each entry, and whether all are within their budgets.
fn table(entries: &[(Entry, u64)]) -> (String, bool) {
    let mut text = format!(
        "{:<24} {:>10} {:>10} {:>8} {:>10}\n",
        "", "bytes", "recorded", "change", "budget"
    );
    for (entry, bytes) in entries {
        let change = 100.0 * (*bytes as f64 / entry.recorded.max(1) as f64 - 1.0);
        let verdict = if *bytes > entry.budget { "  TOO LARGE" } else { "" };
        let Entry {
            name,
            recorded,
            budget,
        } = entry;
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{name:<24} {bytes:>10} {recorded:>10} {change:>+7.1}% {budget:>10}{verdict}"
        );
    }
    (text, entries.iter().all(|(entry, bytes)| *bytes <= entry.budget))
}

/// Compares the packages under `root` with the list there, or rewrites the list.
pub(crate) fn hold(root: &Path, records: bool) -> Result<()> {
    let list = root.join("xtask/sizes.txt");
    let text = fs::read_to_string(&list).with_context(|| list.display().to_string())?;
    let made = |name: &str| -> Result<u64> {
        let path = root.join("target/phone").join(name);
        let file = fs::metadata(&path).with_context(|| path.display().to_string())?;
        Ok(file.len())
    };
    let measured: Vec<(Entry, u64)> = parse(&text)?
        .into_iter()
        .map(|entry| {
            let bytes = made(&entry.name)?;
            Ok((entry, bytes))
        })
        .collect::<Result<_>>()?;
    let (table, is_within) = table(&measured);
    print!("{table}");
    if !is_within {
        bail!("beyond the budget of xtask/sizes.txt");
    }
    if records {
        let lines = measured
            .iter()
            .map(|(entry, bytes)| format!("{} {bytes} {}\n", entry.name, entry.budget));
        fs::write(&list, HEAD.to_owned() + &lines.collect::<String>())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_beyond_its_budget_is_told() {
        let entries = parse("# sizes\nsmall 100 120\nlarge 1000 1100\n").expect("a list");
        let [small, large] = &entries[..] else {
            panic!("{entries:?}");
        };
        let (text, is_within) = table(&[(small.clone(), 110), (large.clone(), 1101)]);
        assert!(!is_within);
        assert!(
            text.contains("+10.0%") && text.matches("TOO LARGE").count() == 1,
            "{text}"
        );
        assert!(table(&[(small.clone(), 120)]).1);
        assert!(parse("small 100").is_err());
        assert!(parse("small 100 many").is_err());
    }
}
