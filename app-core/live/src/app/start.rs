//! The present start: whether it is good, whether its device is, and the resulting preset.

use super::App;
use super::event::{ShellCommand, WorkCommand};
use super::launch_history::{LaunchHistory, N_GOOD_FRAMES, Simplified};
use super::notice::Notice;
use app_pipeline::governor::Exhausted;
use app_pipeline::preset::Preset;

/// The present start.
#[derive(Clone, Debug)]
pub(super) struct Start {
    history: LaunchHistory,
    /// Whether it is counted as unfinished at present.
    is_counted: bool,
    n_good_frames: u32,
    /// The fault of the device.
    refused: Option<String>,
    /// Name of the device in the self-test.
    device: Option<String>,
}

impl Start {
    fn remember(&self) -> WorkCommand {
        WorkCommand::Remember(self.history.text())
    }

    fn simplified(&self) -> Option<Simplified> {
        if self.history.is_first_phone {
            return None;
        }
        let refused = self.refused.clone().map(Simplified::SelfTest);
        refused.or(self.history.is_simple.then_some(Simplified::FailedLaunches))
    }
}

impl App {
    /// The reason why the simplest preset is used, if it is.
    #[must_use]
    pub fn simplified(&self) -> Option<Simplified> {
        self.start.as_ref()?.simplified()
    }

    /// The preset for drawing; `chosen` is the shell's choice.
    #[must_use]
    pub fn preset(&self, chosen: Preset) -> Preset {
        self.simplified().map_or(chosen, |_| Preset::Flat)
    }

    /// Whether a device must still pass the self-test. Never if the shell stores nothing.
    #[must_use]
    pub fn wants_self_test(&self, device: &str) -> bool {
        let is_wanted = |start: &Start| {
            let has_passed = start.history.passed.as_deref() == Some(&one_line(device));
            start.history.is_first_phone || (start.simplified().is_none() && !has_passed)
        };
        self.start.as_ref().is_some_and(is_wanted)
    }

    pub(super) fn started(&mut self, history: LaunchHistory) {
        self.start = Some(Start {
            is_counted: !history.is_first_phone,
            history,
            n_good_frames: 0,
            refused: None,
            device: None,
        });
        self.tell_simplified();
    }

    /// Handles the self-test's result for a device, named with its driver; returns the commands.
    pub fn self_tested(&mut self, device: &str, outcome: Result<(), String>) -> Option<WorkCommand> {
        self.note(&("self-test", device, &outcome));
        let start = self.start.as_mut()?;
        start.device = Some(one_line(device));
        match outcome {
            Ok(()) => {
                start.history.passed.clone_from(&start.device);
                Some(start.remember())
            }
            Err(reason) => {
                start.refused = Some(reason);
                self.tell_simplified();
                None
            }
        }
    }

    /// Whether the package is one for engineers, in which nothing falls back by itself.
    #[must_use]
    pub fn is_for_engineers(&self) -> bool {
        let start = self.start.as_ref();
        start.is_some_and(|start| start.history.is_first_phone)
    }

    /// Adds a line to the log: the quality ladder is exhausted.
    pub fn note_lowered(&mut self, exhausted: Exhausted) {
        let what = if self.is_for_engineers() {
            "preset fast would be next"
        } else {
            "preset fast"
        };
        self.note(&(what, exhausted));
    }

    /// Adds the error of the test picture to the log, also after a pass, since no bound was
    /// determined on a phone.
    pub fn note_self_test(&mut self, words: &str) {
        self.note(&("test picture", words));
    }

    /// Counts a drawn picture of the moving toy; returns the commands.
    pub fn drawn(&mut self) -> Option<WorkCommand> {
        self.n_failed_pictures = 0;
        let start = self.start.as_mut()?;
        start.n_good_frames = start.n_good_frames.saturating_add(1);
        (start.n_good_frames == N_GOOD_FRAMES).then(|| {
            start.is_counted = false;
            start.history.n_unfinished = 0;
            start.remember()
        })
    }

    /// An app in the background may be ended there without having failed.
    pub(super) fn follow_start(&mut self, is_foreground: bool, commands: &mut Vec<ShellCommand>) {
        let Some(start) = self.start.as_mut().filter(|start| !start.history.is_first_phone) else {
            return;
        };
        if start.n_good_frames >= N_GOOD_FRAMES || start.is_counted == is_foreground {
            return;
        }
        start.is_counted = is_foreground;
        start.history.n_unfinished = if is_foreground {
            start.history.n_unfinished.saturating_add(1)
        } else {
            start.history.n_unfinished.saturating_sub(1)
        };
        commands.push(start.remember().into());
    }

    /// Restores the preset for a person and ignores the device's fault.
    pub(super) fn restore_preset(&mut self, commands: &mut Vec<ShellCommand>) {
        let Some(start) = &mut self.start else { return };
        if start.simplified().is_none() {
            return;
        }
        start.history.is_simple = false;
        if start.refused.take().is_some() {
            start.history.passed.clone_from(&start.device);
        }
        // Now the other preset has to prove itself.
        start.n_good_frames = 0;
        start.is_counted = true;
        start.history.n_unfinished = start.history.n_unfinished.max(1);
        commands.push(start.remember().into());
    }

    fn tell_simplified(&mut self) {
        if let Some(simplified) = self.simplified() {
            self.tell(Notice::Simplified(simplified));
        }
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
