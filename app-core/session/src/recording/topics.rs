//! The channels of a recording, and their schemas for viewers.

use std::collections::BTreeMap;

use serde_json::json;

use super::protobuf::{Descriptor, Kind};
use super::wire::{Body, CHANNEL, SCHEMA};

/// A channel of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Topic {
    /// The index of the session without its frames; repeated in each chunk.
    Session,
    /// Camera pictures, `foxglove.CompressedImage`.
    Image,
    /// Depths of frames, `foxglove.CompressedImage`.
    Depth,
    /// Masks of the people in frames, `foxglove.CompressedImage`.
    People,
    /// Projection of a frame's camera, `foxglove.CameraCalibration`.
    Calibration,
    /// Poses of camera and toy, `foxglove.FrameTransform`.
    Transform,
    /// A frame's entry in the index of the session.
    Frame,
    /// Planes that the platform tracks.
    Planes,
    /// Anchors that the platform tracks.
    Anchors,
    /// The platform's estimate of the light.
    Light,
    /// Exposure and white balance of a frame.
    Exposure,
    /// Events: tracking states, touches, dropped frames.
    Events,
    /// Times of a frame's passes.
    Profile,
}

impl Topic {
    /// All topics; a channel's id and its schema's are its position here, counted from 1.
    pub const ALL: [Self; 13] = [
        Self::Session,
        Self::Image,
        Self::Depth,
        Self::People,
        Self::Calibration,
        Self::Transform,
        Self::Frame,
        Self::Planes,
        Self::Anchors,
        Self::Light,
        Self::Exposure,
        Self::Events,
        Self::Profile,
    ];
    /// Channels for arbitrary JSON objects.
    pub const NOTES: [Self; 6] = [
        Self::Planes,
        Self::Anchors,
        Self::Light,
        Self::Exposure,
        Self::Events,
        Self::Profile,
    ];

    /// Name of the channel.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Session => "/session",
            Self::Image => "/camera/image",
            Self::Depth => "/camera/depth",
            Self::People => "/camera/people",
            Self::Calibration => "/camera/calibration",
            Self::Transform => "/tf",
            Self::Frame => "/frame",
            Self::Planes => "/planes",
            Self::Anchors => "/anchors",
            Self::Light => "/light",
            Self::Exposure => "/exposure",
            Self::Events => "/events",
            Self::Profile => "/profile",
        }
    }

    /// The channel of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|topic| topic.name() == name)
    }

    /// Id of the channel, and of its schema.
    pub(super) fn id(self) -> u16 {
        self as u16 + 1
    }

    fn descriptor(self) -> Option<&'static Descriptor> {
        match self {
            Self::Image | Self::Depth | Self::People => Some(&COMPRESSED_IMAGE),
            Self::Calibration => Some(&CAMERA_CALIBRATION),
            Self::Transform => Some(&FRAME_TRANSFORM),
            _ => None,
        }
    }

    /// Name, description and required keys of a JSON message.
    const fn object(self) -> (&'static str, &'static str, &'static [&'static str]) {
        match self {
            Self::Session => (
                "shadow_capture.Session",
                "The session's index but its frames, the device, the place of this chunk and the files before it.",
                &["chunk", "n_files", "device", "session"],
            ),
            Self::Frame => (
                "shadow_capture.Frame",
                "An entry of a session's frames, the sequence number of its picture on /camera/image, and those of its depths on /camera/depth and of its mask of people on /camera/people.",
                &["picture", "entry"],
            ),
            Self::Planes => ("shadow_capture.Planes", "Planes that the platform tracks.", &[]),
            Self::Anchors => ("shadow_capture.Anchors", "Anchors that the platform tracks.", &[]),
            Self::Light => (
                "shadow_capture.Light",
                "The platform's estimate of the light.",
                &[],
            ),
            Self::Exposure => (
                "shadow_capture.Exposure",
                "Exposure and white balance of a frame.",
                &[],
            ),
            Self::Profile => ("shadow_capture.Profile", "Times of a frame's passes.", &[]),
            _ => ("shadow_capture.Event", "What happened.", &[]),
        }
    }

    /// The two records that announce the channel.
    pub(super) fn records(self) -> Vec<u8> {
        let (name, schema_encoding, schema, encoding) = match self.descriptor() {
            Some(descriptor) => (
                format!("{}.{}", descriptor.package, descriptor.message),
                "protobuf",
                descriptor.with_used(),
                "protobuf",
            ),
            None => {
                let (title, description, required) = self.object();
                let schema = json!({
                    "title": title,
                    "description": description,
                    "type": "object",
                    "required": required,
                });
                let schema = schema.to_string().into_bytes();
                (title.to_owned(), "jsonschema", schema, "json")
            }
        };
        let schema_body = Body::new().u16(self.id()).text(&name);
        let schema_record = schema_body.text(schema_encoding).counted(&schema).record(SCHEMA);
        let channel = Body::new().u16(self.id()).u16(self.id()).text(self.name());
        let channel_record = channel.text(encoding).map(&BTreeMap::new()).record(CHANNEL);
        [schema_record, channel_record].concat()
    }
}

const TIMESTAMP: Descriptor = Descriptor {
    file: "google/protobuf/timestamp.proto",
    package: "google.protobuf",
    message: "Timestamp",
    uses: &[],
    fields: &[("seconds", 1, Kind::Int64), ("nanos", 2, Kind::Int32)],
};
const TIME: Kind = Kind::Message(".google.protobuf.Timestamp");
const VECTOR3: Descriptor = Descriptor {
    file: "foxglove/Vector3.proto",
    package: "foxglove",
    message: "Vector3",
    uses: &[],
    fields: &[
        ("x", 1, Kind::Double),
        ("y", 2, Kind::Double),
        ("z", 3, Kind::Double),
    ],
};
const QUATERNION: Descriptor = Descriptor {
    file: "foxglove/Quaternion.proto",
    package: "foxglove",
    message: "Quaternion",
    uses: &[],
    fields: &[
        ("x", 1, Kind::Double),
        ("y", 2, Kind::Double),
        ("z", 3, Kind::Double),
        ("w", 4, Kind::Double),
    ],
};
/// Source of the numbers: Foxglove's schemas, `CompressedImage.proto`.
const COMPRESSED_IMAGE: Descriptor = Descriptor {
    file: "foxglove/CompressedImage.proto",
    package: "foxglove",
    message: "CompressedImage",
    uses: &[&TIMESTAMP],
    fields: &[
        ("timestamp", 1, TIME),
        ("frame_id", 4, Kind::Text),
        ("data", 2, Kind::Bytes),
        ("format", 3, Kind::Text),
    ],
};
/// Source of the numbers: Foxglove's schemas, `CameraCalibration.proto`.
const CAMERA_CALIBRATION: Descriptor = Descriptor {
    file: "foxglove/CameraCalibration.proto",
    package: "foxglove",
    message: "CameraCalibration",
    uses: &[&TIMESTAMP],
    fields: &[
        ("timestamp", 1, TIME),
        ("frame_id", 9, Kind::Text),
        ("width", 2, Kind::Fixed32),
        ("height", 3, Kind::Fixed32),
        ("distortion_model", 4, Kind::Text),
        ("D", 5, Kind::Doubles),
        ("K", 6, Kind::Doubles),
        ("R", 7, Kind::Doubles),
        ("P", 8, Kind::Doubles),
    ],
};
/// Source of the numbers: Foxglove's schemas, `FrameTransform.proto`.
const FRAME_TRANSFORM: Descriptor = Descriptor {
    file: "foxglove/FrameTransform.proto",
    package: "foxglove",
    message: "FrameTransform",
    uses: &[&QUATERNION, &VECTOR3, &TIMESTAMP],
    fields: &[
        ("timestamp", 1, TIME),
        ("parent_frame_id", 2, Kind::Text),
        ("child_frame_id", 3, Kind::Text),
        ("translation", 4, Kind::Message(".foxglove.Vector3")),
        ("rotation", 5, Kind::Message(".foxglove.Quaternion")),
    ],
};
