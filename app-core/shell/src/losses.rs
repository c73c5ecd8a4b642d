//! Recovery after drawing has failed: a new surface, if its window was closed and opened, or a new
//! device with all of its pipelines.

use app_core::CoreError;
use app_core::gpu::GpuError;

/// Whether a surface was lost and none has shown a picture since.
#[derive(Clone, Copy, Debug, Default)]
pub struct Losses {
    was_lost: bool,
}

impl Losses {
    /// A picture was shown.
    pub fn shown(&mut self) {
        self.was_lost = false;
    }

    /// Whether another surface is enough after an error: not if the surface that replaced a lost
    /// one was lost in turn, which a lost device causes, too.
    pub fn is_of_surface(&mut self, error: &CoreError) -> bool {
        let is_surface = matches!(error, CoreError::Gpu(GpuError::SurfaceLost));
        is_surface && !std::mem::replace(&mut self.was_lost, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_that_is_lost_again_and_again_is_a_lost_device() {
        let lost = || CoreError::Gpu(GpuError::SurfaceLost);
        let mut losses = Losses::default();
        assert!(losses.is_of_surface(&lost()));
        assert!(!losses.is_of_surface(&lost()), "nothing was shown in between");
        losses.shown();
        assert!(losses.is_of_surface(&lost()));
        assert!(!Losses::default().is_of_surface(&CoreError::NoScene));
    }
}
