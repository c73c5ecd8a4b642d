//! Ledgers of a scene's frames, counted without a device.

use app_core::camera_frame::Display;
use app_core::core::{Core, CoreError};
use app_core::frame::FrameInput;
use app_core::governor::QualityStep;
use app_core::ledger::Ledger;
use app_core::preset::Preset;
use app_core::scene::Scene;
use app_pipeline::core::inspect::Inspect;

use crate::bench::{FRAME_KINDS, FrameKind, aligned, with_new};

/// The cost of a kind of frame, on a screen of the picture's size.
#[derive(Clone, Debug, PartialEq)]
pub struct Counted {
    /// The kind.
    pub kind: FrameKind,
    /// Memory traffic and draws of a frame.
    pub ledger: Ledger,
    /// Largest number of bytes of textures and buffers.
    pub peak_bytes: u64,
}

impl Counted {
    /// The peak in units of 2^20 bytes.
    #[must_use]
    pub fn peak_mib(&self) -> f64 {
        self.peak_bytes as f64 / 1048576.0
    }
}

/// Counts each kind of frame with all else known.
///
/// # Errors
/// When the core refuses the scene or a frame.
pub fn count(
    scene: &Scene,
    (preset, quality_reductions): (Preset, &[QualityStep]),
    input: &FrameInput,
) -> Result<Vec<Counted>, CoreError> {
    let of_kind = |kind: FrameKind| {
        let mut core = Core::counting();
        core.set_scene(scene.clone(), preset)?;
        core.set_quality_reductions(quality_reductions)?;
        core.draw_every_pose()?;
        let others = [input.clone(), with_new(input, kind)];
        for known in &others {
            core.frame(known)?;
        }
        let screen_px = [scene.width_px, scene.height_px];
        // Two successive pictures add to different means: the more expensive one counts.
        let mut next = |input: &FrameInput| -> Result<Ledger, CoreError> {
            let report = core.frame(input)?;
            let present = core.count_present(screen_px, Display::default());
            Ok(Ledger::new(&report, screen_px, present))
        };
        let [one, other] = [next(&others[0])?, next(&others[1])?];
        let is_other_dearer = one.bytes_moved() < other.bytes_moved();
        Ok(Counted {
            kind,
            ledger: if is_other_dearer { other } else { one },
            peak_bytes: core.memory().peak_bytes,
        })
    };
    FRAME_KINDS.into_iter().map(of_kind).collect()
}

/// The ledgers as columns, each under the name of its kind.
#[must_use]
pub fn ledgers(counted: &[Counted]) -> String {
    let one = |counted: &Counted| {
        let rows: Vec<Vec<String>> = counted.ledger.rows().into_iter().map(Vec::from).collect();
        format!(
            "{}: {:.1} MiB at most\n{}\n",
            counted.kind.name(),
            counted.peak_mib(),
            aligned(&rows)
        )
    };
    counted.iter().map(one).collect()
}
