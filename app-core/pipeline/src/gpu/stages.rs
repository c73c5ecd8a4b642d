//! Stages of a frame on the processor, timed by the caller's clock, since the core has none.

use std::fmt;
use std::sync::Arc;

use serde::Serialize;

/// A caller's clock: monotonic milliseconds from any origin.
#[derive(Clone)]
pub struct Clock(Arc<dyn Fn() -> f64 + Send + Sync>);

impl Clock {
    /// A clock from a function that returns milliseconds since any origin.
    pub fn new(now_ms: impl Fn() -> f64 + Send + Sync + 'static) -> Self {
        Self(Arc::new(now_ms))
    }

    /// Milliseconds since the clock's origin.
    pub fn now_ms(&self) -> f64 {
        (self.0)()
    }
}

impl fmt::Debug for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Clock")
    }
}

/// Time of one stage on the processor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StageTime {
    /// Its name.
    pub stage: &'static str,
    /// Start by the caller's clock.
    pub begin_ms: f64,
    /// Duration.
    pub cpu_ms: f64,
}

/// Stages of a frame, in sequence.
#[derive(Debug, Default)]
pub(crate) struct Stages {
    clock: Option<Clock>,
    current: Option<(&'static str, f64)>,
    ended: Vec<StageTime>,
}

impl Stages {
    /// Stages timed by `clock`; without it nothing is timed.
    pub(crate) fn new(clock: Option<Clock>) -> Self {
        Self {
            clock,
            ..Self::default()
        }
    }

    /// Ends the previous stage and begins the next.
    pub(crate) fn begin(&mut self, stage: &'static str) {
        let Some(clock) = &self.clock else {
            return;
        };
        let now_ms = clock.now_ms();
        self.end_at(now_ms);
        self.current = Some((stage, now_ms));
    }

    /// Ends the last stage.
    pub(crate) fn end(mut self) -> Vec<StageTime> {
        if let Some(now_ms) = self.clock.as_ref().map(Clock::now_ms) {
            self.end_at(now_ms);
        }
        self.ended
    }

    fn end_at(&mut self, now_ms: f64) {
        if let Some((stage, begin_ms)) = self.current.take() {
            self.ended.push(StageTime {
                stage,
                begin_ms,
                cpu_ms: now_ms - begin_ms,
            });
        }
    }
}
