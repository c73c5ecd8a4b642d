//! The start under way: whether it is a good one, whether its device is, and which preset that leaves.

use super::App;
use super::event::ShellCommand;
use super::notice::Notice;
use super::starts::{N_GOOD_FRAMES, Simplified, Starts};
use app_pipeline::preset::Preset;

/// The start under way.
#[derive(Clone, Debug)]
pub(super) struct Start {
    starts: Starts,
    /// Whether it counts as unfinished, as it stands.
    is_counted: bool,
    n_good_frames: u32,
    /// What is wrong with the device.
    refused: Option<String>,
    /// As the self-test has named it.
    device: Option<String>,
}

impl Start {
    fn remember(&self) -> ShellCommand {
        ShellCommand::Remember(self.starts.text())
    }

    fn simplified(&self) -> Option<Simplified> {
        let refused = self.refused.clone().map(Simplified::SelfTest);
        refused.or(self.starts.is_simple.then_some(Simplified::Starts))
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
            start.simplified().is_none() && start.starts.passed.as_deref() != Some(&one_line(device))
        };
        self.start.as_ref().is_some_and(is_wanted)
    }

    pub(super) fn started(&mut self, starts: Starts) {
        self.start = Some(Start {
            starts,
            is_counted: true,
            n_good_frames: 0,
            refused: None,
            device: None,
        });
        self.tell_simplified();
    }

    pub(super) fn self_tested(
        &mut self,
        device: &str,
        outcome: Result<(), String>,
        commands: &mut Vec<ShellCommand>,
    ) {
        self.note(&("self-test", device, &outcome));
        let Some(start) = &mut self.start else { return };
        start.device = Some(one_line(device));
        match outcome {
            Ok(()) => {
                start.starts.passed.clone_from(&start.device);
                commands.push(start.remember());
            }
            Err(reason) => {
                start.refused = Some(reason);
                self.tell_simplified();
            }
        }
    }

    /// A picture of the moving toy was drawn.
    pub(super) fn drawn(&mut self, commands: &mut Vec<ShellCommand>) {
        let Some(start) = &mut self.start else { return };
        start.n_good_frames = start.n_good_frames.saturating_add(1);
        if start.n_good_frames == N_GOOD_FRAMES {
            start.is_counted = false;
            start.starts.n_unfinished = 0;
            commands.push(start.remember());
        }
    }

    /// An app that has left the front may be ended there without having failed.
    pub(super) fn follow_start(&mut self, is_foreground: bool, commands: &mut Vec<ShellCommand>) {
        let Some(start) = &mut self.start else { return };
        if start.n_good_frames >= N_GOOD_FRAMES || start.is_counted == is_foreground {
            return;
        }
        start.is_counted = is_foreground;
        start.starts.n_unfinished = if is_foreground {
            start.starts.n_unfinished.saturating_add(1)
        } else {
            start.starts.n_unfinished.saturating_sub(1)
        };
        commands.push(start.remember());
    }

    /// A person wants the preset back: what is wrong with the device is taken for nothing.
    pub(super) fn restore_preset(&mut self, commands: &mut Vec<ShellCommand>) {
        let Some(start) = &mut self.start else { return };
        if start.simplified().is_none() {
            return;
        }
        start.starts.is_simple = false;
        if start.refused.take().is_some() {
            start.starts.passed.clone_from(&start.device);
        }
        // It is the other preset that has to prove itself now.
        start.n_good_frames = 0;
        start.is_counted = true;
        start.starts.n_unfinished = start.starts.n_unfinished.max(1);
        commands.push(start.remember());
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
