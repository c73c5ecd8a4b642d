//! Work on threads of its own, whose results are fetched with the next picture.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use app_core::app::ShellEvent;

use crate::guard::{Callback, guarded};

/// Threads at work, and what they have to tell.
#[derive(Debug)]
pub struct Jobs {
    done: Sender<ShellEvent>,
    results: Receiver<ShellEvent>,
}

impl Default for Jobs {
    fn default() -> Self {
        let (done, results) = channel();
        Self { done, results }
    }
}

impl Jobs {
    /// Runs `job` on a thread; what it comes to, or `failed` where it panics or has no thread, is a result.
    pub fn start(
        &self,
        job: impl FnOnce() -> ShellEvent + Send + 'static,
        failed: impl Fn() -> ShellEvent + Clone + Send + 'static,
    ) {
        let (done, otherwise) = (self.done.clone(), failed.clone());
        let run = move || {
            // Whoever waited may be gone.
            let _ = done.send(guarded(Callback::Thread, job).unwrap_or_else(otherwise));
        };
        if thread::Builder::new().spawn(run).is_err() {
            let _ = self.done.send(failed());
        }
    }

    /// Takes what another thread has to tell.
    #[must_use]
    pub fn teller(&self) -> Sender<ShellEvent> {
        self.done.clone()
    }

    /// A result that has come.
    #[must_use]
    pub fn result(&self) -> Option<ShellEvent> {
        self.results.try_recv().ok()
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn wait_for(jobs: &Jobs) -> ShellEvent {
        let start = Instant::now();
        loop {
            if let Some(event) = jobs.result() {
                return event;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "no result");
            thread::sleep(Duration::from_millis(1));
        }
    }

    #[test]
    fn a_job_that_panics_is_told_as_one_that_failed() {
        let jobs = Jobs::default();
        jobs.start(|| panic!("as planned"), || ShellEvent::Aligned(None));
        assert!(matches!(wait_for(&jobs), ShellEvent::Aligned(None)));
        jobs.start(|| ShellEvent::MemoryLow, || ShellEvent::Aligned(None));
        assert!(matches!(wait_for(&jobs), ShellEvent::MemoryLow));
    }
}
