//! The frames of a session as the core is given them: as recorded, or aligned by their pictures.

use std::ops::Range;
use std::time::Instant;

use app_core::alignment::{Aligner, Alignment};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Scene};
use app_core::session::{Session, SessionFrame};

use crate::replay::ReplayError;

/// Corrections of frames, found once for all presets.
pub struct Alignments {
    first: usize,
    found: Vec<Aligned>,
    /// Plates whose camera was corrected, by their index.
    moved_plates: Vec<(usize, Camera)>,
}

/// Of one frame.
pub struct Aligned {
    /// Where toy and lights are.
    pub alignment: Alignment,
    /// What finding it took on the processor.
    pub cpu_ms: f64,
}

impl Alignments {
    /// Frames stay as they were recorded.
    #[must_use]
    pub fn none() -> Self {
        Self {
            first: 0,
            found: Vec::new(),
            moved_plates: Vec::new(),
        }
    }

    /// Aligns frames one after the other.
    ///
    /// # Errors
    /// When a frame cannot be read or aligned.
    pub fn find(session: &dyn Session, frames: Range<usize>) -> Result<Self, ReplayError> {
        let mut aligner = Aligner::new(session.scene().clone());
        let mut found = Vec::with_capacity(frames.len());
        for index in frames.clone() {
            let input = FrameInput::from(&session.frame(index)?);
            let start = Instant::now();
            let alignment = aligner.align(&input).map_err(|reason| ReplayError::Align {
                index,
                reason: Box::new(reason),
            })?;
            found.push(Aligned {
                alignment,
                cpu_ms: start.elapsed().as_secs_f64() * 1e3,
            });
        }
        Ok(Self {
            first: frames.start,
            found,
            moved_plates: moved_plates(session.scene(), aligner.scene()),
        })
    }

    /// What the core is given of a session's scene.
    #[must_use]
    pub fn scene(&self, given: &Scene) -> Scene {
        let mut scene = given.clone();
        for (index, camera) in &self.moved_plates {
            scene.plates[*index].camera = *camera;
        }
        scene
    }

    /// Plates whose camera was corrected, by their index.
    #[must_use]
    pub fn moved_plates(&self) -> &[(usize, Camera)] {
        &self.moved_plates
    }

    /// Of a frame; none where it stays as recorded.
    #[must_use]
    pub fn of(&self, index: usize) -> Option<&Aligned> {
        self.found.get(index.checked_sub(self.first)?)
    }

    /// What the core is given of a frame.
    #[must_use]
    pub fn input(&self, index: usize, frame: &SessionFrame) -> FrameInput {
        let input = FrameInput::from(frame);
        match self.of(index) {
            Some(aligned) => aligned.alignment.applied_to(&input),
            None => input,
        }
    }
}

fn moved_plates(given: &Scene, aligned: &Scene) -> Vec<(usize, Camera)> {
    let plates = given.plates.iter().zip(&aligned.plates).enumerate();
    let moved = plates.filter(|(_, (given, aligned))| given.camera != aligned.camera);
    moved
        .map(|(index, (_, aligned))| (index, aligned.camera))
        .collect()
}
