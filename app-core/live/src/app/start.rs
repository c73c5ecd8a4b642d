//! The start under way: whether it is a good one, whether its device is, and which preset that leaves.

use super::App;
use super::event::{ShellCommand, WorkCommand};
use super::launch_history::{LaunchHistory, N_GOOD_FRAMES, Simplified};
use super::notice::Notice;
use app_pipeline::governor::Exhausted;
use app_pipeline::preset::Preset;

/// The start under way.
#[derive(Clone, Debug)]
pub(super) struct Start {
    history: LaunchHistory,
    /// Whether it counts as unfinished, as it stands.
    is_counted: bool,
    n_good_frames: u32,
    /// What is wrong with the device.
    refused: Option<String>,
    /// As the self-test has named it.
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
    /// Why the simplest preset is used, where it is.
    #[must_use]
    pub fn simplified(&self) -> Option<Simplified> {
        self.start.as_ref()?.simplified()
    }

    /// The preset to draw with, where the shell has chosen another.
    #[must_use]
    pub fn preset(&self, chosen: Preset) -> Preset {
        self.simplified().map_or(chosen, |_| Preset::Flat)
    }

    /// Whether a device has still to show that it draws what it should. Never where the shell keeps nothing.
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

    /// Whether a device, named with its driver, has drawn its test picture as it should, or what is wrong; what is to be done.
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

    /// All that could be turned down was, for the log.
    pub fn note_lowered(&mut self, exhausted: Exhausted) {
        let what = if self.is_for_engineers() {
            "preset fast would be next"
        } else {
            "preset fast"
        };
        self.note(&(what, exhausted));
    }

    /// How far a test picture is off, for the log: also where it passes, since no bound was set by a phone.
    pub fn note_self_test(&mut self, words: &str) {
        self.note(&("test picture", words));
    }

    /// A picture of the moving toy was drawn; what is to be done.
    pub fn drawn(&mut self) -> Option<WorkCommand> {
        let start = self.start.as_mut()?;
        start.n_good_frames = start.n_good_frames.saturating_add(1);
        (start.n_good_frames == N_GOOD_FRAMES).then(|| {
            start.is_counted = false;
            start.history.n_unfinished = 0;
            start.remember()
        })
    }

    /// An app that has left the front may be ended there without having failed.
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

    /// A person wants the preset back: what is wrong with the device is taken for nothing.
    pub(super) fn restore_preset(&mut self, commands: &mut Vec<ShellCommand>) {
        let Some(start) = &mut self.start else { return };
        if start.simplified().is_none() {
            return;
        }
        start.history.is_simple = false;
        if start.refused.take().is_some() {
            start.history.passed.clone_from(&start.device);
        }
        // It is the other preset that has to prove itself now.
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
