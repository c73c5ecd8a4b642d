//! Recording of a session: its beginning and end, its content, and the messages about it.

use serde_json::Value;

use super::App;
use super::event::Recorded;
use super::notice::Notice;
use super::recorder::Recorder;
use super::step::Step;
use app_scene::camera_frame::CameraFrame;
use app_scene::scene::Scene;
use app_session::recording::{Ending, Limits, LiveFrame, RecordingJob};

impl App {
    /// Starts or ends a recording for a person.
    pub(super) fn want_recording(&mut self, is_on: bool) {
        let is_short = self
            .platform
            .free_bytes
            .is_some_and(|free| free < Limits::APP.min_free_bytes);
        if is_on && is_short {
            return self.tell(Notice::NoRoomToRecord);
        }
        self.captures.recording = is_on;
    }

    /// Begins a wanted recording, or ends an unwanted one, whose queue is closed by that. Returns
    /// the one that began.
    pub(super) fn follow_recording(&mut self, is_wanted: bool) -> Option<Box<RecordingJob>> {
        if !is_wanted {
            self.recorder = None;
            return None;
        }
        let (Some(place), Some(latest), None) = (&self.place, &self.latest, &self.recorder) else {
            return None;
        };
        self.n_recordings += 1;
        let (recorder, job) = Recorder::begin(self.n_recordings, Scene::clone(&place.scene), latest);
        self.recorder = Some(recorder);
        Some(Box::new(job))
    }

    /// Adds a frame with the platform's values, in the world in which the toy was placed: the input
    /// of an alignment.
    pub(super) fn record(&mut self, frame: &CameraFrame) {
        if self.recorder.is_none() {
            return;
        }
        let is_seen = self.step == Step::Play && frame.camera().is_some();
        let live = self.place.as_ref().filter(|_| is_seen).and_then(|place| {
            let input = place.anchored(self.input(1.0)?);
            input.check().ok()?;
            Some(LiveFrame {
                image: input.image.kept(),
                camera: input.camera,
                world_from_object: input.world_from_object,
                exposure: input.exposure,
                light_estimate: input.light_estimate,
                depth: input.depth,
                people: input.people,
                shown_pose: input.shown_pose,
                world_from_shown: input.world_from_shown,
            })
        });
        let Some(recorder) = &mut self.recorder else {
            return;
        };
        recorder.frame(frame, live);
        if recorder.begins_to_drop() {
            self.tell(Notice::RecordingDrops);
        }
    }

    /// Adds a line to the log and to the recording.
    pub(super) fn note(&mut self, what: &dyn std::fmt::Debug) {
        self.log.line(self.time_s, what);
        if let Some(recorder) = &self.recorder {
            recorder.logged(what);
        }
    }

    /// Adds the times of a frame to the recording, if there is one.
    pub(crate) fn record_profile(&self, times: &Value) {
        if let Some(recorder) = &self.recorder {
            recorder.profile(times);
        }
    }

    pub(super) fn free_space(&mut self, free_bytes: u64) {
        self.platform.free_bytes = Some(free_bytes);
        if let Some(recorder) = &mut self.recorder {
            recorder.tick(free_bytes);
        }
    }

    /// Handles the end of a recording; another may have begun since.
    pub(super) fn recorded(&mut self, recorded: Recorded) {
        let number = recorded.outcome.number;
        if self
            .recorder
            .as_ref()
            .is_some_and(|recorder| recorder.number() == number)
        {
            self.recorder = None;
            self.captures.recording = false;
        }
        self.note(&recorded);
        self.tell(
            if recorded.outcome.n_frames == 0 && recorded.outcome.ending == Ending::Asked {
                Notice::NothingRecorded
            } else {
                Notice::Recorded(recorded)
            },
        );
    }
}
