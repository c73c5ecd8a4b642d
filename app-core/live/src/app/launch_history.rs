//! The stored history of starts: unfinished ones, and the device that passed the self-test.

/// Number of successive unfinished starts after which the app starts with the simplest preset.
pub const MAX_FAILED_LAUNCHES: u32 = 2;
/// Number of pictures of the moving toy after which a start counts as good.
pub const N_GOOD_FRAMES: u32 = 60;

/// The values that the shell stores between starts, as a text of a few lines.
///
/// It is read, [begun](LaunchHistory::begin) and stored again before the graphics device is opened,
/// then passed to the app ([`ShellEvent::Started`](super::ShellEvent::Started)), which requests its
/// storage after every change.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LaunchHistory {
    /// Number of successive unfinished starts, including the present one.
    pub(super) n_unfinished: u32,
    /// Whether the simplest preset is used because of unfinished starts, until the person wants
    /// another.
    pub(super) is_simple: bool,
    /// The device that passed the self-test, with its driver.
    pub(super) passed: Option<String>,
    /// Whether the package is one for engineers, who stop the app at will: no start counts, and
    /// nothing falls back. Not stored.
    pub(super) is_first_phone: bool,
}

/// The reason why the app uses the simplest preset.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Simplified {
    /// Several starts were unfinished.
    FailedLaunches,
    /// The device draws incorrectly; with a description.
    SelfTest(String),
}

impl LaunchHistory {
    /// Reads a stored text. Invalid lines are skipped, so that no file can prevent a start.
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

    /// The text to be stored.
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

    /// The history in a package for engineers: unfinished starts do not count, every start draws
    /// the test picture, and nothing falls back to the simplest preset by itself.
    #[must_use]
    pub fn for_engineers(self) -> Self {
        Self {
            is_first_phone: true,
            is_simple: false,
            n_unfinished: 0,
            ..self
        }
    }

    /// Whether this start is the first since a finished one, so that an earlier one's data can be
    /// trusted.
    #[must_use]
    pub fn is_first_try(&self) -> bool {
        self.n_unfinished <= 1
    }

    /// Records the beginning of another start, to be stored before anything that may end it.
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
