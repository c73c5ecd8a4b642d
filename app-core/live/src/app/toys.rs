//! Selection of another toy: by the platform's own picker, or from the files that the shell has
//! found.

use std::sync::Arc;

use super::App;
use super::event::{ShellCommand, WorkCommand};
use super::ghost_shape::GhostShape;
use super::notice::Notice;
use super::playback::Playback;
use super::step::{Cause, Step};
use super::toy_refusal::ToyRefusal;
use app_scene::toy::Toy;

impl App {
    /// Available files of toys, while a person selects one.
    #[must_use]
    pub fn toy_files(&self) -> Option<&[String]> {
        self.toy_files.as_deref()
    }

    /// Handles the person's choice of a file, or of none.
    pub(super) fn choose_toy(&mut self, chosen: Option<usize>, commands: &mut Vec<ShellCommand>) {
        let files = self.toy_files.take().unwrap_or_default();
        let file = chosen.and_then(|chosen| files.into_iter().nth(chosen));
        commands.extend(file.map(|file| WorkCommand::ReadToy(file).into()));
    }

    /// Adopts a toy of the person's own; the photograph of the place stays.
    pub(super) fn take_toy(&mut self, read: Result<Arc<Toy>, ToyRefusal>) {
        match read {
            Ok(toy) => {
                self.playback = Playback::of(&toy);
                self.ghost_shape = GhostShape::of(&toy);
                self.toy = toy;
                self.go(Cause::Replace);
                (self.ghost, self.scanned_at) = (None, None);
                if self.step == Step::PlaceToy && self.has_plate() {
                    self.search.begin(true);
                } else {
                    self.search.give_up();
                }
            }
            Err(reason) => self.tell(Notice::ToyRefused(reason)),
        }
    }
}
