//! A fake of ARCore's library: a test sets its answers, its calls are recorded, and every object
//! that it returns must be released once.

#![allow(clippy::unwrap_used, reason = "a test's, which is to fail")]

mod functions;
mod images;
mod modes;
mod table;

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::ffi::ArPlane;

pub use table::FUNCTIONS;

/// A plane that the fake has found.
#[derive(Clone)]
pub struct FakePlane {
    /// `ArTrackingState`.
    pub state: i32,
    /// `ArPlaneType`.
    pub kind: i32,
    /// Pose in the order of `ArPose_getPoseRaw`.
    pub pose: [f32; 7],
    /// Corners, `x` and `z` in turn, metres.
    pub outline: Vec<f32>,
}

/// The fake's answers, and the recorded calls.
pub struct World {
    /// Successive results of `checkAvailability`; the last one remains.
    pub availability: Vec<i32>,
    /// Status and outcome of `requestInstall`.
    pub install: (i32, i32),
    /// Status by the name of the function; success if it is not listed.
    pub fails: BTreeMap<&'static str, i32>,
    /// Modes of the camera: width, height, frames a second.
    pub modes: Vec<[i32; 3]>,
    /// Modes of a camera that faces the person, by their indices.
    pub fronts: Vec<usize>,
    /// Whether a filter with any condition finds no mode.
    pub filters_all: bool,
    /// Modes in which no picture arrives.
    pub silent: Vec<usize>,
    /// Refused settings of a configuration: names and refused values.
    pub refuses: Vec<(&'static str, i32)>,
    /// Index of the present mode.
    mode: usize,
    /// Whether the filter has any condition.
    is_filtered: bool,
    /// Settings of the configuration that is being made.
    config: BTreeMap<&'static str, i32>,
    /// Number of pauses after which `ACAMERA_CONTROL_AF_MODE` of pictures becomes right.
    pub stuck_focus: u32,
    /// Quarter turns from the sensor to the display.
    pub display_turns: u8,
    focus_mode: u8,
    /// Time of the frame.
    pub time_ns: i64,
    /// State and reason of a failure.
    pub tracking: (i32, i32),
    /// Pose of the camera.
    pub pose: [f32; 7],
    /// Focal lengths and principal point, pixels.
    pub intrinsics: [f32; 4],
    /// Size of the picture.
    pub size_px: [i32; 2],
    /// Format of the picture, as `AIMAGE_FORMAT_*`.
    pub format: i32,
    /// Bytes, row stride and pixel stride of each plane.
    pub image: Vec<(Vec<u8>, i32, i32)>,
    /// Nanoseconds and ISO speed of the picture, and the type that the camera reports for the
    /// speed.
    pub exposure: (i64, i32, u8),
    /// Planes that are found.
    pub planes: Vec<FakePlane>,
    /// Images that are tracked; their kind is the tracking method.
    pub images: Vec<FakePlane>,
    /// Whether images were requested for the list.
    lists_images: bool,
    /// `ArTrackingState` of the anchor.
    pub anchor_state: i32,
    /// Poses that were given.
    given: Vec<[f32; 7]>,
    /// Calls of interest to a test, in order.
    pub calls: String,
    /// Objects that are not yet released: address, kind, and number.
    alive: BTreeMap<usize, (&'static str, usize)>,
    n_made: usize,
    /// Objects that were released or used when they did not exist.
    pub wrong: Vec<String>,
}

impl Default for World {
    fn default() -> Self {
        let pixel = |value, n| vec![value; n];
        Self {
            availability: vec![203],
            install: (0, 0),
            fails: BTreeMap::new(),
            modes: vec![
                [640, 480, 30],
                [1920, 1080, 60],
                [1920, 1080, 30],
                [4000, 3000, 30],
            ],
            fronts: Vec::new(),
            filters_all: false,
            silent: Vec::new(),
            refuses: Vec::new(),
            mode: 0,
            is_filtered: false,
            config: BTreeMap::new(),
            stuck_focus: 0,
            display_turns: 0,
            focus_mode: 0,
            time_ns: 1,
            tracking: (0, 0),
            pose: [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 3.0],
            intrinsics: [500.0, 510.0, 2.0, 1.0],
            size_px: [4, 2],
            format: 0x23,
            image: vec![(pixel(50, 8), 4, 1), (pixel(90, 2), 2, 1), (pixel(200, 2), 2, 1)],
            exposure: (10_000_000, 200, 1),
            planes: Vec::new(),
            images: Vec::new(),
            lists_images: false,
            anchor_state: 0,
            given: Vec::new(),
            calls: String::new(),
            alive: BTreeMap::new(),
            n_made: 0,
            wrong: Vec::new(),
        }
    }
}

/// First number of an image.
const IMAGES: usize = 500;

thread_local! {
    /// Each test runs on its own thread.
    static WORLD: RefCell<World> = RefCell::default();
}

/// Reads the fake, or changes its answers.
pub fn world<T>(look: impl FnOnce(&mut World) -> T) -> T {
    WORLD.with_borrow_mut(look)
}

/// Kinds of the objects that are not yet released.
pub fn alive() -> Vec<&'static str> {
    world(|world| world.alive.values().map(|(kind, _)| *kind).collect())
}

impl World {
    fn status(&self, name: &str) -> i32 {
        self.fails.get(name).copied().unwrap_or(0)
    }

    fn call(&mut self, what: &str) {
        let _ = write!(self.calls, "{what} ");
    }

    fn make<T>(&mut self, kind: &'static str, stands_for: usize) -> *mut T {
        self.n_made += 1;
        let address = 0x1000 * self.n_made;
        self.alive.insert(address, (kind, stands_for));
        std::ptr::without_provenance_mut(address)
    }

    fn give_back<T>(&mut self, kind: &'static str, object: *mut T) {
        if self.alive.remove(&object.addr()).map(|(kind, _)| kind) != Some(kind) {
            self.wrong.push(format!("{kind} given back, which is none"));
        }
    }

    /// Number of an object.
    fn used<T>(&mut self, kind: &'static str, object: *const T) -> usize {
        match self.alive.get(&object.addr()) {
            Some((of, stands_for)) if *of == kind => *stands_for,
            other => {
                let other = format!("{kind} used, which is {other:?}");
                self.wrong.push(other);
                0
            }
        }
    }

    /// Indices of the modes that pass the filter.
    fn listed(&self) -> Vec<usize> {
        let all = 0..self.modes.len();
        all.filter(|index| !self.is_filtered || !(self.filters_all || self.fronts.contains(index)))
            .collect()
    }

    /// The pose of the camera in the display's axes.
    fn display_pose(&self) -> [f32; 7] {
        let half_turned = f32::from(self.display_turns) * std::f32::consts::FRAC_PI_4;
        let [qx, qy, qz, qw, tx, ty, tz] = self.pose;
        let (sin, cos) = half_turned.sin_cos();
        // The pose's rotation, then a rotation about its own z.
        [
            qx * cos + qy * sin,
            qy * cos - qx * sin,
            qz * cos + qw * sin,
            qw * cos - qz * sin,
            tx,
            ty,
            tz,
        ]
    }

    fn plane(&mut self, plane: *const ArPlane) -> FakePlane {
        let index = self.used("plane", plane);
        self.trackable(index).clone()
    }

    /// A plane, or from [`IMAGES`] on an image.
    fn trackable(&self, index: usize) -> &FakePlane {
        let image = index.checked_sub(IMAGES).map(|index| &self.images[index]);
        image.unwrap_or_else(|| &self.planes[index])
    }
}
