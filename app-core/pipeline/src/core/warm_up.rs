//! Compilation of the passes of a frame before a scene exists.

use std::sync::Arc;

use super::Core;
use crate::gpu::{Gpu, GpuError};
use crate::passes::list::WarmUp as Compile;
use crate::preset::Settings;
use crate::stage::method;

impl Core {
    /// Compiles the passes of frames with these settings, one pass a step: on another thread, or a
    /// few steps between two frames of the shell. [`Core::set_scene`] compiles passes that are then
    /// still missing. The passes that read pictures in pixels rather than in a phone's planes are
    /// compiled by the first such frames.
    #[must_use]
    pub fn warm_up(&self, settings: impl Into<Settings>) -> WarmUp {
        WarmUp {
            gpu: Arc::clone(&self.gpu),
            left: method::warm_ups(settings.into()).into_iter(),
        }
    }
}

/// The steps of [`Core::warm_up`]: each is the name of the pass that it compiled, and
/// [`len`](ExactSizeIterator::len) is the number of remaining steps.
#[derive(Debug)]
pub struct WarmUp {
    gpu: Arc<Gpu>,
    left: std::vec::IntoIter<Compile>,
}

impl Iterator for WarmUp {
    type Item = Result<&'static str, GpuError>;

    fn next(&mut self) -> Option<Self::Item> {
        let (pass, compile) = self.left.next()?;
        Some(self.gpu.guarded(|| compile(&self.gpu)).map(|()| pass))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.left.size_hint()
    }
}

impl ExactSizeIterator for WarmUp {}
