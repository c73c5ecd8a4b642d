//! Resources used by this process so far, as Linux counts them.

use std::fs;

use anyhow::Context;

/// Clock ticks per second in `/proc`, on every present platform. Source: proc(5), sysconf(3).
const TICKS_PER_SEC: f64 = 100.0;
/// Value that, written to `clear_refs`, resets the peak to the present memory. Source: proc(5).
const RESET_PEAK: &str = "5";

/// Processor seconds of all threads.
///
/// # Errors
/// Without `/proc`.
pub fn cpu_secs() -> anyhow::Result<f64> {
    let stat = fs::read_to_string("/proc/self/stat")?;
    // The name may contain anything; the fields after its bracket are numbers.
    let (_, fields) = stat.rsplit_once(')').context("no name in /proc/self/stat")?;
    let ticks = fields.split_whitespace().skip(11).take(2);
    let ticks = ticks.map(str::parse::<f64>).sum::<Result<f64, _>>()?;
    Ok(ticks / TICKS_PER_SEC)
}

/// Present memory in MiB.
///
/// # Errors
/// Without `/proc`.
pub fn held_mib() -> anyhow::Result<f64> {
    status_mib("VmRSS:")
}

/// Largest memory in MiB since the last [`reset_peak`].
///
/// # Errors
/// Without `/proc`.
pub fn peak_mib() -> anyhow::Result<f64> {
    status_mib("VmHWM:")
}

/// Resets the peak.
///
/// # Errors
/// Without `/proc`.
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
