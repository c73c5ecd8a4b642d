//! A fake of ARCore's library: what it answers is set by a test, what it is asked is written down, and whatever it hands
//! out must come back once.

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
    /// As `ArPose_getPoseRaw` has it.
    pub pose: [f32; 7],
    /// Corners, `x` and `z` in turn, metres.
    pub outline: Vec<f32>,
}

/// What the fake answers, and what it was asked.
pub struct World {
    /// What `checkAvailability` says, one after the other; the last for good.
    pub availability: Vec<i32>,
    /// Status and outcome of `requestInstall`.
    pub install: (i32, i32),
    /// Status by name of the function; success where none is set.
    pub fails: BTreeMap<&'static str, i32>,
    /// Modes of the camera: width, height, frames a second.
    pub modes: Vec<[i32; 3]>,
    /// Modes of a camera that faces the person, by their places.
    pub fronts: Vec<usize>,
    /// Whether a filter that asks for anything finds no mode.
    pub filters_all: bool,
    /// Modes in which no picture comes.
    pub silent: Vec<usize>,
    /// Settings of a configuration that are refused, by their names, each with what it must not be.
    pub refuses: Vec<(&'static str, i32)>,
    /// The mode that is set.
    mode: usize,
    /// Whether the filter asks for anything.
    is_filtered: bool,
    /// Settings of the configuration under way.
    config: BTreeMap<&'static str, i32>,
    /// `ACAMERA_CONTROL_AF_MODE` of pictures, until so many pauses.
    pub stuck_focus: u32,
    /// Quarter turns from the sensor to the display.
    pub display_turns: u8,
    focus_mode: u8,
    /// Of the frame.
    pub time_ns: i64,
    /// State and reason of a failure.
    pub tracking: (i32, i32),
    /// Of the camera.
    pub pose: [f32; 7],
    /// Focal lengths and principal point, pixels.
    pub intrinsics: [f32; 4],
    /// Of the picture.
    pub size_px: [i32; 2],
    /// Of the picture, as `AIMAGE_FORMAT_*`.
    pub format: i32,
    /// Bytes, row stride and pixel stride of each plane.
    pub image: Vec<(Vec<u8>, i32, i32)>,
    /// Nanoseconds and ISO speed of the picture, and the type that the camera says the speed is of.
    pub exposure: (i64, i32, u8),
    /// What is found.
    pub planes: Vec<FakePlane>,
    /// Images that are followed; their kind is the tracking method.
    pub images: Vec<FakePlane>,
    /// Whether the list was asked for images.
    lists_images: bool,
    /// `ArTrackingState` of the anchor.
    pub anchor_state: i32,
    /// Poses that were given.
    given: Vec<[f32; 7]>,
    /// Calls that a test looks at, in order.
    pub calls: String,
    /// Handed out and not given back: address, kind, and what it stands for.
    alive: BTreeMap<usize, (&'static str, usize)>,
    n_made: usize,
    /// What was given back or used without being alive.
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

/// Numbers of images begin here.
const IMAGES: usize = 500;

thread_local! {
    /// Each test runs on a thread of its own.
    static WORLD: RefCell<World> = RefCell::default();
}

/// Looks at the fake, or changes what it answers.
pub fn world<T>(look: impl FnOnce(&mut World) -> T) -> T {
    WORLD.with_borrow_mut(look)
}

/// Kinds of what has not been given back.
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

    /// What an object stands for.
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

    /// The modes that the filter lets through, by their places.
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
        // The pose's rotation, then one about its own z.
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
