//! What is kept from start to start: starts that came to no end, and the device that draws what it should.

/// Unfinished starts in a row after which the app starts with the simplest preset.
pub const MAX_FAILED_LAUNCHES: u32 = 2;
/// Pictures of the moving toy after which a start is a good one.
pub const N_GOOD_FRAMES: u32 = 60;

/// What the shell keeps from start to start, as a text of some lines.
///
/// It is read, [begun](LaunchHistory::begin) and stored again before the graphics device is opened, then handed to the app
/// ([`ShellEvent::Started`](super::ShellEvent::Started)), which asks for it to be stored whenever it changes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LaunchHistory {
    /// Starts in a row that did not come to an end, with the one under way.
    pub(super) n_unfinished: u32,
    /// So many had not that the simplest preset is used, until the person wants another.
    pub(super) is_simple: bool,
    /// The device that drew its test picture as it should, with its driver.
    pub(super) passed: Option<String>,
    /// Of a package for engineers, who stop the app at will: nothing counts, and nothing falls back. Not kept.
    pub(super) is_first_phone: bool,
}

/// Why the app uses the simplest preset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Simplified {
    /// The app came to no end several times.
    FailedLaunches,
    /// The device does not draw what it should, and what is wrong.
    SelfTest(String),
}

impl LaunchHistory {
    /// What was kept. Lines that mean nothing are skipped, so that no file can keep an app from starting.
    #[must_use]
    pub fn read(text: &str) -> Self {
        let mut history = Self::default();
        for line in text.lines() {
            match line.split_once(' ') {
                Some(("unfinished", n)) => history.n_unfinished = n.trim().parse().unwrap_or(0),
                Some(("passed", device)) => history.passed = Some(device.to_owned()),
                None if line == "simple" => history.is_simple = true,
                _ => {}
            }
        }
        history
    }

    /// What is to be kept.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = format!("unfinished {}\n", self.n_unfinished);
        if self.is_simple {
            text.push_str("simple\n");
        }
        if let Some(device) = &self.passed {
            text.push_str(&format!("passed {device}\n"));
        }
        text
    }

    /// As a package for engineers takes it: starts that end early do not count, the test picture is drawn by each, and nothing falls back
    /// to the simplest preset by itself.
    #[must_use]
    pub fn for_engineers(self) -> Self {
        Self {
            is_first_phone: true,
            is_simple: false,
            n_unfinished: 0,
            ..self
        }
    }

    /// Whether this start is the first since one that came to an end: what an earlier one has left behind can be trusted.
    #[must_use]
    pub fn is_first_try(&self) -> bool {
        self.n_unfinished <= 1
    }

    /// Another start begins, which is to be stored before anything is done that may end it.
    pub fn begin(&mut self) {
        if self.is_first_phone {
            return;
        }
        if self.n_unfinished >= MAX_FAILED_LAUNCHES {
            self.is_simple = true;
            self.n_unfinished = 0;
        }
        self.n_unfinished = self.n_unfinished.saturating_add(1);
    }
}
