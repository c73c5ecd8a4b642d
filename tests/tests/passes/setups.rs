//! The setups for comparing the passes: lights, a camera's distance, and an optional wall.

use app_core::scene::Light;
use glam::{DVec3, UVec2};

/// A setup for comparing a pass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setup {
    pub(crate) name: &'static str,
    pub(crate) image_px: UVec2,
    pub(crate) lights: &'static [Light],
    /// Distance of the camera from the toy; a larger one leaves room around the work region.
    pub(crate) distance_m: f64,
    /// Height of the toy's feet over the receiver, since tracking is never exact.
    pub(crate) feet_m: f64,
    /// The second receiver.
    pub(crate) beside: Beside,
}

/// What is beside the toy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Beside {
    Nothing,
    /// A wall behind the toy, so that its shadow is broken by the crease.
    Wall,
    /// A book, of which the top is a receiver: it hides light and sky from the table.
    Book,
    /// Three equal books, each lying on another.
    Pile,
    /// A book, of which the top and the side before the camera are receivers.
    Side,
    /// A ramp with its high edge to the left: its top is tilted.
    Ramp,
}

impl Setup {
    /// The same in a picture of another size.
    pub(crate) const fn of_size(self, width_px: u32, height_px: u32) -> Self {
        Self {
            image_px: UVec2::new(width_px, height_px),
            ..self
        }
    }

    /// The same in a picture twice as large, and odd.
    pub(crate) fn twice(self) -> Self {
        let UVec2 { x, y } = 2 * self.image_px + 1;
        self.of_size(x, y)
    }
}

const BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(0.32, 0.62, 0.02),
    radius_m: 0.05,
};
const OTHER_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(-0.3, 0.7, 0.25),
    radius_m: 0.03,
};
/// Unit vector: -3, 6, -2 over 7, away from the camera, so that the camera sees the shadow.
const SKY: Light = Light::Directional {
    direction_to_light_in_world: DVec3::new(-3.0 / 7.0, 6.0 / 7.0, -2.0 / 7.0),
    angular_radius_rad: 0.06,
};

const POINT: Light = Light::Sphere {
    position_in_world: DVec3::new(0.3, 0.5, -0.2),
    radius_m: 0.0,
};
/// Low and in front of the toy: its shadow continues up the wall.
const LOW_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(-0.22, 0.27, 0.36),
    radius_m: 0.02,
};
/// Behind the wall, whose front it does not light.
const BACK_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(0.05, 0.75, -0.4),
    radius_m: 0.04,
};

/// Behind the high edge of the ramp, 25 degrees high.
const RAMP_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(-0.7, 0.27, 0.0),
    radius_m: 0.03,
};

/// Over the left half of the book, so that it meets none of its faces.
const BULB_OVER_BOOK: Light = Light::Sphere {
    position_in_world: DVec3::new(-0.13, 0.5, 0.03),
    radius_m: 0.03,
};

/// Behind the toy and the book.
const FAR_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(0.35, 0.45, -0.5),
    radius_m: 0.03,
};
const LEFT_BULB: Light = Light::Sphere {
    position_in_world: DVec3::new(0.1, 0.5, -0.3),
    radius_m: 0.02,
};
/// Below the table, before the side of the book.
const BULB_BELOW: Light = Light::Sphere {
    position_in_world: DVec3::new(0.1, -0.4, 0.6),
    radius_m: 0.02,
};

const NEAR: Setup = Setup {
    name: "bulb",
    image_px: UVec2::new(97, 61),
    lights: &[BULB],
    distance_m: 0.42,
    feet_m: 0.0,
    beside: Beside::Nothing,
};
/// The shadow of one light continues up a wall that ends within the picture; another light is
/// behind it.
pub(crate) const WALL: Setup = Setup {
    name: "wall",
    image_px: UVec2::new(163, 119),
    lights: &[LOW_BULB, BACK_BULB],
    distance_m: 0.55,
    beside: Beside::Wall,
    ..NEAR
};
/// The toy's shadow falls on a book and on the table, and the book's own shadow on the table.
pub(crate) const BOOK: Setup = Setup {
    name: "book",
    image_px: UVec2::new(131, 89),
    lights: &[BULB],
    beside: Beside::Book,
    ..NEAR
};
/// Two faces of the book see no light, although one lamp is on their side of its middle.
pub(crate) const UNLIT_FACES: Setup = Setup {
    name: "unlit faces",
    lights: &[BULB, BULB_OVER_BOOK],
    ..BOOK
};
/// The table beside the pile sees none of the light, and little of the sky.
pub(crate) const PILE: Setup = Setup {
    name: "pile",
    beside: Beside::Pile,
    ..BOOK
};
/// The table beside a ramp: one light is to the right of its low edge, the other behind its high
/// one, below the plane of its top for the points before the low edge.
pub(crate) const RAMP: Setup = Setup {
    name: "ramp",
    lights: &[RAMP_BULB, BULB],
    beside: Beside::Ramp,
    ..BOOK
};
/// The side of the book is lit by the table, on which the toy's shadows fall before it, partly
/// within the book's own; a light below the table casts none there.
pub(crate) const SIDE: Setup = Setup {
    name: "side",
    lights: &[FAR_BULB, LEFT_BULB, BULB_BELOW],
    beside: Beside::Side,
    ..BOOK
};
/// Ambient light alone.
pub(crate) const NO_LIGHT: Setup = Setup {
    name: "no light",
    lights: &[],
    ..NEAR
};
/// The maximum number of lights.
pub(crate) const FOUR_LIGHTS: Setup = Setup {
    name: "four lights",
    image_px: UVec2::new(131, 75),
    lights: &[BULB, OTHER_BULB, SKY, POINT],
    distance_m: 0.72,
    ..NEAR
};
/// One light close by, two lights, a directional light on a sunken toy, the hard edge of a lifted
/// one from a distance, and a second receiver.
pub(crate) const SETUPS: [Setup; 5] = [
    NEAR,
    Setup {
        name: "two bulbs",
        image_px: UVec2::new(131, 75),
        lights: &[BULB, OTHER_BULB],
        distance_m: 0.72,
        ..NEAR
    },
    Setup {
        name: "directional",
        lights: &[SKY],
        distance_m: 0.5,
        feet_m: -0.004,
        ..NEAR
    },
    Setup {
        name: "point",
        image_px: UVec2::new(163, 119),
        lights: &[POINT],
        distance_m: 0.9,
        feet_m: 0.006,
        ..NEAR
    },
    WALL,
];
