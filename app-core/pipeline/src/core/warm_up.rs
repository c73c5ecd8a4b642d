//! Compiling what frames need before there is a scene.

use std::sync::Arc;

use super::Core;
use crate::gpu::{Gpu, GpuError};
use crate::passes::list::WarmUp as Compile;
use crate::preset::Settings;
use crate::stage::method;

impl Core {
    /// Compiles what frames with these settings need, one pass a step: on another thread, or a few steps between two frames of
    /// the shell's own. What has not been compiled until then, [`Core::set_scene`] compiles; what reads pictures that come as pixels
    /// rather than as a phone's planes, the first frames with such.
    #[must_use]
    pub fn warm_up(&self, settings: impl Into<Settings>) -> WarmUp {
        WarmUp {
            gpu: Arc::clone(&self.gpu),
            left: method::warm_ups(settings.into()).into_iter(),
        }
    }
}

/// The steps of [`Core::warm_up`]: each is the name of the pass that it compiled, and [`len`](ExactSizeIterator::len) says how
/// many are left.
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
