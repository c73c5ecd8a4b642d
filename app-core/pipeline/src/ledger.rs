//! The ledger of a frame: the device-independent cost of its passes, summed and arranged in
//! columns.
//!
//! Its entries are the passes of a [`FrameReport`], whose work a recorder counts from its
//! descriptors; [`Core::counting`](crate::Core::counting) makes such reports without a device.

use crate::frame::FrameReport;
use crate::gpu::{PassGroup, PassRun, Work};

/// Number of bytes of a mebibyte.
const MEBIBYTE: f64 = 1048576.0;
/// Number of bytes of a screen pixel.
const SCREEN_PIXEL_BYTES: u64 = 4;

/// The cost of a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Ledger {
    /// Width and height of the screen, the unit of copies.
    screen_px: [u32; 2],
    entries: Vec<PassRun>,
    uploaded_bytes: u64,
}

impl Ledger {
    /// The ledger of a frame on a screen of `screen_px` pixels; `present` is the cost of presenting
    /// it there, if it is presented.
    #[must_use]
    pub fn new(report: &FrameReport, screen_px: [u32; 2], present: Option<Work>) -> Self {
        let shown = present.map(|work| PassRun {
            path: PassGroup::Frame,
            pass: "screen",
            n_runs: 1,
            work,
        });
        Self {
            screen_px,
            entries: report.ran.iter().copied().chain(shown).collect(),
            uploaded_bytes: report.uploaded_bytes,
        }
    }

    /// The passes, in the order of their first runs.
    #[must_use]
    pub fn entries(&self) -> &[PassRun] {
        &self.entries
    }

    /// Sums over all passes.
    #[must_use]
    pub fn total(&self) -> Work {
        self.entries.iter().map(|run| run.work).sum()
    }

    /// Bytes that the processor transfers, which are written once: camera picture, pose, uniforms.
    #[must_use]
    pub fn uploaded_bytes(&self) -> u64 {
        self.uploaded_bytes
    }

    /// Bytes that the device moves, including those that the processor transfers.
    #[must_use]
    pub fn bytes_moved(&self) -> u64 {
        self.total().bytes_moved() + self.uploaded_bytes
    }

    /// The same in units of 2^20 bytes.
    #[must_use]
    pub fn mebibytes_moved(&self) -> f64 {
        mebibytes(self.bytes_moved())
    }

    /// Number of copies of the screen: each reads and writes all of its pixels, of four bytes.
    #[must_use]
    pub fn copies(&self, bytes: u64) -> f64 {
        let [width, height] = self.screen_px.map(u64::from);
        let copy = 2 * SCREEN_PIXEL_BYTES * width * height;
        bytes as f64 / copy.max(1) as f64
    }

    /// The frame's cost in copies of the screen.
    #[must_use]
    pub fn copies_moved(&self) -> f64 {
        self.copies(self.bytes_moved())
    }

    /// A row for each pass, then one for the processor's transfers and one for the total, under a
    /// head: pass, runs, triangles, vertices, mebibytes read and written, copies of the screen.
    #[must_use]
    pub fn rows(&self) -> Vec<[String; 7]> {
        let head = [
            "pass",
            "runs",
            "triangles",
            "vertices",
            "MiB read",
            "MiB written",
            "copies",
        ];
        let mut rows = vec![head.map(str::to_owned)];
        for run in &self.entries {
            let name = format!("{} ({})", run.pass, run.path.name());
            rows.push(self.row(name, run.n_runs.to_string(), &run.work, 0));
        }
        rows.push(self.row(
            "from the processor".to_owned(),
            String::new(),
            &Work::default(),
            self.uploaded_bytes,
        ));
        rows.push(self.row(
            "all".to_owned(),
            String::new(),
            &self.total(),
            self.uploaded_bytes,
        ));
        rows
    }

    fn row(&self, name: String, n_runs: String, work: &Work, uploaded_bytes: u64) -> [String; 7] {
        let moved = work.bytes_moved() + uploaded_bytes;
        [
            name,
            n_runs,
            work.triangles().to_string(),
            work.vertices().to_string(),
            format!("{:.2}", mebibytes(work.bytes_read())),
            format!("{:.2}", mebibytes(work.bytes_written() + uploaded_bytes)),
            format!("{:.3}", self.copies(moved)),
        ]
    }
}

fn mebibytes(bytes: u64) -> f64 {
    bytes as f64 / MEBIBYTE
}
