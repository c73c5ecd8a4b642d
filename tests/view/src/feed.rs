//! A session as a camera: its plate while the place is empty, then its frames in a loop.

use std::sync::Arc;

use app_core::app::Step;
use app_core::camera_frame::{
    Anchor, CameraFrame, CameraImage, Display, Exposure, FoundPlane, Stamp, Tracking,
};
use app_core::card::card_from_lens;
use app_core::scene::{Camera, ProbeShape, Scene};
use app_core::session::{Capture, Session, SessionError, SessionFrame, toy_bytes};
use glam::{DMat4, DVec2, DVec3};

use desk::files::index_of;
use desk::stored::Stored;

/// Cosine of 10 degrees, the largest inclination of a level receiver.
const LEVEL: f64 = 0.985;

/// Limit for the decoded pictures that are kept, in bytes: a session's loop is then decoded once.
const MOST_KEPT_BYTES: usize = 1 << 30;

/// A session as a camera delivers it.
pub struct Feed {
    scene: Scene,
    session: Arc<dyn Session>,
    /// The decoded frames from the first on; those of a long recording are decoded as they come.
    kept: Vec<SessionFrame>,
    planes: Arc<[FoundPlane]>,
    toy_file: Arc<[u8]>,
    /// Whether the toy is in the picture.
    pub is_toy_there: bool,
    /// Whether the platform has not found a plane yet.
    pub hides_planes: bool,
    /// Whether the camera is darkened: it then shows the session's probe picture.
    pub is_dark: bool,
    /// Quality of the tracking; without `Normal` there is no pose.
    pub tracking: Tracking,
    /// Presentation of the picture.
    pub display: Display,
    /// Another number means another world.
    pub world_epoch: u32,
    next: usize,
    n_delivered: u64,
    time_ns: i64,
}

impl Feed {
    /// All frames of a session.
    ///
    /// # Errors
    /// When one cannot be read.
    pub fn of(session: Arc<dyn Session>) -> Result<Self, SessionError> {
        Self::keeping(session, MOST_KEPT_BYTES)
    }

    /// The same, with at most so many bytes of decoded pictures, or one picture.
    ///
    /// # Errors
    /// As [`Feed::of`].
    pub fn keeping(session: Arc<dyn Session>, most_kept_bytes: usize) -> Result<Self, SessionError> {
        let scene = session.scene().clone();
        let n_frames = session.n_frames();
        let frame_bytes = 4 * scene.width_px as usize * scene.height_px as usize;
        let n_kept = n_frames.min((most_kept_bytes / frame_bytes.max(1)).max(1));
        session.check_pictures(n_kept..n_frames)?;
        let kept = (0..n_kept).map(|index| session.frame(index));
        Ok(Self {
            kept: kept.collect::<Result<_, _>>()?,
            session,
            planes: level_planes(&scene),
            toy_file: Arc::new([]),
            scene,
            is_toy_there: false,
            hides_planes: false,
            is_dark: false,
            tracking: Tracking::Normal,
            display: Display::default(),
            world_epoch: 0,
            next: 0,
            n_delivered: 0,
            time_ns: 0,
        })
    }

    /// All frames of a stored session, and its toy's file with the files that this refers to.
    ///
    /// # Errors
    /// When one cannot be read.
    pub fn of_stored(stored: Stored) -> anyhow::Result<Self> {
        let index = index_of(&stored)?;
        let toy = index["toy"]["file"].as_str().map(|file| toy_bytes(&stored, file));
        let feed = Self::of(Arc::new(Capture::open(stored)?))?;
        Ok(Self {
            toy_file: toy.transpose()?.unwrap_or_default().into(),
            ..feed
        })
    }

    /// The toy's file, a binary glTF; empty if the session came without it.
    #[must_use]
    pub fn toy_file(&self) -> Arc<[u8]> {
        Arc::clone(&self.toy_file)
    }

    /// Follows the app's step: the person puts the toy onto the session's empty place, and takes it
    /// off for another photograph of that.
    pub fn follow(&mut self, step: Step) {
        self.is_toy_there = step >= Step::PlaceToy;
    }

    /// A frame of the session; the first one if a file was damaged since its head was checked.
    fn recorded(&self, index: usize) -> SessionFrame {
        if let Some(kept) = self.kept.get(index) {
            return kept.clone();
        }
        self.session.frame(index).unwrap_or_else(|error| {
            eprintln!("{error}");
            self.kept[0].clone()
        })
    }

    /// The next frame, `elapsed_s` after the one before.
    pub fn next(&mut self, elapsed_s: f64) -> CameraFrame {
        #[allow(clippy::cast_possible_truncation, reason = "within a session")]
        let elapsed_ns = (elapsed_s * 1e9) as i64;
        self.time_ns += elapsed_ns;
        self.n_delivered += 1;
        let frame = &self.recorded(self.next);
        let plate = self.scene.plates.first().filter(|_| !self.is_toy_there);
        let (image, camera) = plate.map_or((&frame.image, &frame.camera), |plate| {
            (&plate.image, &plate.camera)
        });
        let probe = self.scene.probe.as_ref().filter(|_| self.is_dark);
        let taken = match probe.and_then(|probe| probe.pictures.first()) {
            Some(dark) => {
                let exposure = frame.exposure * dark.exposure_ratio;
                self.frame((Arc::clone(&dark.image).into(), exposure), &dark.camera, frame)
            }
            None => self.frame((Arc::clone(image).into(), frame.exposure), camera, frame),
        };
        if self.is_toy_there {
            self.next = (self.next + 1) % self.session.n_frames();
        }
        taken
    }

    fn frame(
        &self,
        (image, exposure): (CameraImage, f64),
        camera: &Camera,
        of: &SessionFrame,
    ) -> CameraFrame {
        let is_known = self.tracking == Tracking::Normal;
        CameraFrame {
            stamp: Stamp {
                id: self.n_delivered,
                time_ns: self.time_ns,
                world_epoch: self.world_epoch,
            },
            // It is delivered as soon as it is made.
            age_ms: Some(0.0),
            image,
            intrinsics: camera.intrinsics,
            exposure: Some(Exposure {
                duration_s: 0.01 * exposure,
                iso: 100.0,
            }),
            tracking: self.tracking,
            world_from_camera: is_known.then_some(camera.world_from_camera),
            planes: if self.hides_planes {
                Arc::new([])
            } else {
                Arc::clone(&self.planes)
            },
            anchors: Arc::from(Vec::<Anchor>::new()),
            world_from_card: self.world_from_card().filter(|_| is_known && !self.is_dark),
            light_estimate: of.light_estimate,
            // They belong to the frame's own picture.
            people: of.people.clone().filter(|_| self.is_toy_there && !self.is_dark),
            // It belongs to the frame's own picture.
            depth: of.depth.clone().filter(|_| self.is_toy_there && !self.is_dark),
            display: self.display,
        }
    }

    /// The card under the lens of a session.
    fn world_from_card(&self) -> Option<DMat4> {
        let probe = self.scene.probe.as_ref()?;
        let is_lens = matches!(probe.shape, ProbeShape::FresnelLens { .. });
        let first = probe.pictures.first().filter(|_| is_lens)?;
        Some(first.world_from_probe * card_from_lens().inverse())
    }

    /// Pose of the real toy, and the first camera that shows it.
    #[must_use]
    pub fn toy(&self) -> (&DMat4, &Camera) {
        let frame = &self.kept[0];
        (&frame.world_from_object, &frame.camera)
    }

    /// The session's scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }
}

/// The receivers that a platform would find: all if none is level.
fn level_planes(scene: &Scene) -> Arc<[FoundPlane]> {
    let planes = (0..).zip(&scene.receivers).map(|(id, receiver)| FoundPlane {
        id,
        world_from_plane: receiver.world_from_plane,
        half_extent_m: DVec2::max(receiver.half_extent_m, DVec2::ZERO),
    });
    let (level, others): (Vec<_>, Vec<_>) =
        planes.partition(|plane| plane.world_from_plane.y_axis.truncate().dot(DVec3::Y) > LEVEL);
    if level.is_empty() { others } else { level }.into()
}
