//! What this process has used so far, as Linux counts it.

use std::fs;

use anyhow::Context;

/// Hertz of the kernel's clock ticks towards programs, on every platform of today. Source: proc(5), sysconf(3).
const TICKS_PER_SEC: f64 = 100.0;
/// What written to `clear_refs` sets the peak to what is held now. Source: proc(5).
const RESET_PEAK: &str = "5";

/// Seconds on processors, of all threads.
///
/// # Errors
/// Where there is no `/proc`.
pub fn cpu_secs() -> anyhow::Result<f64> {
    let stat = fs::read_to_string("/proc/self/stat")?;
    // The name may hold anything; what follows its bracket is numbers.
    let (_, fields) = stat.rsplit_once(')').context("no name in /proc/self/stat")?;
    let ticks = fields.split_whitespace().skip(11).take(2);
    let ticks = ticks.map(str::parse::<f64>).sum::<Result<f64, _>>()?;
    Ok(ticks / TICKS_PER_SEC)
}

/// MiB in memory now.
///
/// # Errors
/// Where there is no `/proc`.
pub fn held_mib() -> anyhow::Result<f64> {
    status_mib("VmRSS:")
}

/// Most MiB in memory since the last [`reset_peak`].
///
/// # Errors
/// Where there is no `/proc`.
pub fn peak_mib() -> anyhow::Result<f64> {
    status_mib("VmHWM:")
}

/// Begins a new peak.
///
/// # Errors
/// Where there is no `/proc`.
pub fn reset_peak() -> anyhow::Result<()> {
    Ok(fs::write("/proc/self/clear_refs", RESET_PEAK)?)
}

fn status_mib(field: &str) -> anyhow::Result<f64> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix(field));
    let kib = line.and_then(|line| line.split_whitespace().next());
    let kib: f64 = kib
        .with_context(|| format!("no {field} in /proc/self/status"))?
        .parse()?;
    Ok(kib / 1024.0)
}
