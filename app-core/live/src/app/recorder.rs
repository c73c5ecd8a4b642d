//! Passes the camera's data to the recording, without ever waiting for it.

use std::fmt::Debug;
use std::sync::Arc;

use serde_json::{Value, json};

use app_scene::camera_frame::{CameraFrame, FoundPlane, Tracking};
use app_scene::scene::{Light, Scene};
use app_session::record::{LightEstimateRecord, LightRecord};
use app_session::recording::{Item, LiveFrame, RecordingJob, RecordingSender, Topic};

/// Time between reports of free space, in nanoseconds: without frames they are the only clock.
const TICK_NS: u64 = 1_000_000_000;

/// One recording, on the camera's side.
#[derive(Debug)]
pub(super) struct Recorder {
    number: u64,
    sender: RecordingSender,
    /// The first frame's time, by the platform's clock.
    origin_ns: i64,
    /// Time of the latest frame, or of a later tick, from the first frame on.
    now_ns: u64,
    /// Whether a tick was reported since the latest frame.
    has_ticked: bool,
    tracking: Option<Tracking>,
    planes: Option<Arc<[FoundPlane]>>,
    has_reported_drops: bool,
}

impl Recorder {
    /// Begins with a frame of `scene`.
    pub(super) fn begin(number: u64, scene: Scene, frame: &CameraFrame) -> (Self, RecordingJob) {
        let (sender, job) = RecordingJob::new(number, scene, frame.intrinsics);
        let recorder = Self {
            number,
            sender,
            origin_ns: frame.stamp.time_ns,
            now_ns: 0,
            has_ticked: false,
            tracking: None,
            planes: None,
            has_reported_drops: false,
        };
        (recorder, job)
    }

    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Adds a frame with the platform's data; `live` is `None` if the frame's pose cannot be
    /// trusted.
    pub(super) fn frame(&mut self, frame: &CameraFrame, live: Option<LiveFrame>) {
        let since_ns = frame.stamp.time_ns.saturating_sub(self.origin_ns);
        self.now_ns = u64::try_from(since_ns).unwrap_or(0);
        self.has_ticked = false;
        if self.tracking.replace(frame.tracking) != Some(frame.tracking) {
            let state = format!("{:?}", frame.tracking);
            self.note(Topic::Events, &json!({ "event": "tracking", "state": state }));
        }
        if self.planes.as_ref() != Some(&frame.planes) {
            self.note(Topic::Planes, &planes(&frame.planes));
            self.planes = Some(Arc::clone(&frame.planes));
        }
        if !frame.anchors.is_empty() {
            let anchors = frame.anchors.iter().map(
                |anchor| json!({ "id": anchor.id, "world_from_anchor": anchor.world_from_anchor.to_cols_array() }),
            );
            self.note(Topic::Anchors, &json!({ "anchors": anchors.collect::<Vec<_>>() }));
        }
        if let Some(exposure) = &frame.exposure {
            self.note(
                Topic::Exposure,
                &json!({ "duration_s": exposure.duration_s, "iso": exposure.iso }),
            );
        }
        if let Some(estimate) = &frame.light_estimate {
            self.note(Topic::Light, &json!(LightEstimateRecord::from(estimate)));
        }
        if let Some(live) = live {
            self.offer(Item::Live(Box::new(live)));
        }
    }

    /// Adds a line that is also in the app's log.
    pub(super) fn logged(&self, what: &dyn Debug) {
        self.note(
            Topic::Events,
            &json!({ "event": "log", "text": format!("{what:?}") }),
        );
    }

    /// Adds the result of an alignment.
    pub(super) fn aligned(&self, world_from_object: &glam::DMat4, lights: &[Light]) {
        let lights: Vec<_> = lights.iter().map(LightRecord::from).collect();
        self.note(
            Topic::Events,
            &json!({ "event": "aligned", "world_from_object": world_from_object.to_cols_array(), "lights": lights }),
        );
    }

    /// Adds the times of a frame.
    pub(super) fn profile(&self, times: &Value) {
        self.note(Topic::Profile, times);
    }

    /// Adds the device's free space, once a second.
    pub(super) fn tick(&mut self, free_bytes: u64) {
        if std::mem::replace(&mut self.has_ticked, true) {
            self.now_ns += TICK_NS;
        }
        self.offer(Item::Tick {
            free_bytes: Some(free_bytes),
        });
    }

    /// Whether frames were dropped for the first time.
    pub(super) fn begins_to_drop(&mut self) -> bool {
        let is_dropping = self.sender.n_dropped_frames() > 0;
        is_dropping && !std::mem::replace(&mut self.has_reported_drops, is_dropping)
    }

    fn note(&self, topic: Topic, message: &Value) {
        self.offer(Item::Note {
            topic,
            message: message.to_string(),
        });
    }

    /// Items without space are counted in the queue.
    fn offer(&self, item: Item) {
        let _ = self.sender.offer(self.now_ns, item);
    }
}

fn planes(planes: &[FoundPlane]) -> Value {
    let planes = planes.iter().map(|plane| {
        json!({
            "id": plane.id,
            "world_from_plane": plane.world_from_plane.to_cols_array(),
            "half_extent_m": plane.half_extent_m.to_array(),
        })
    });
    json!({ "planes": planes.collect::<Vec<_>>() })
}
