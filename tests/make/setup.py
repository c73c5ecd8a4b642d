"""What one session shows: toy, receivers, lights, cameras, exposures. Lengths in metres, angles in degrees.

World: right-handed, +Y up. The camera looks along its -Z with +Y up. A receiver's own plane is its local y = 0.
"""
from dataclasses import dataclass

import numpy as np

import ground

WARM, COOL = np.array([1.05, 1.0, 0.91]), np.array([0.93, 1.0, 1.1])
LOOKS = (("Look", 0.6), ("Look", 1.8), ("Step", 0.5), ("Step", 1.25))
FAR = 1000.0  # stands for infinity: across half a metre of table its direction turns by .03 degrees
EVEN = (1.0, 1.0, 1.0)


def towards(azimuth, elevation):
    """Unit direction; the azimuth counts from +X towards +Z."""
    azimuth, elevation = np.radians(azimuth), np.radians(elevation)
    return np.array([np.cos(elevation) * np.cos(azimuth), np.sin(elevation), np.cos(elevation) * np.sin(azimuth)])


@dataclass
class Bulb:
    """Glowing sphere; `share` is its part of the plate's irradiance at the world's origin."""

    azimuth: float = 186.0
    elevation: float = 47.0
    distance: float = 1.0
    radius: float = 0.015
    share: float = 0.6
    colour: tuple = tuple(WARM)
    listed: bool = True  # in capture.json

    def centre(self):
        """Place in the world."""
        return self.distance * towards(self.azimuth, self.elevation)

    def listing(self):
        """Entry of capture.json."""
        return {"kind": "sphere", "position": self.centre().tolist(), "radius": self.radius}


@dataclass
class Sun:
    """Glowing disc at infinity."""

    azimuth: float = 186.0
    elevation: float = 25.0
    angular_radius: float = 5.0
    share: float = 0.6
    colour: tuple = tuple(WARM)
    listed: bool = True
    distance: float = FAR

    @property
    def radius(self):
        """Of the far sphere that stands for the disc."""
        return self.distance * np.sin(np.radians(self.angular_radius))

    def centre(self):
        """Place of the far sphere."""
        return self.distance * towards(self.azimuth, self.elevation)

    def listing(self):
        """Entry of capture.json."""
        return {"kind": "directional", "direction_to_light": towards(self.azimuth, self.elevation).tolist(),
                "angular_radius_deg": self.angular_radius}


@dataclass
class Glow(Sun):
    """Gaussian lobe of the sky; it is listed as the disc of the same variance, whose radius is two standard deviations."""


@dataclass
class Spot(Glow):
    """Brightest spot of a light map, which has its power; it is listed as the disc that `light_map` fits to it."""


@dataclass
class Receiver:
    """A plane that catches the shadow: `surface` is a picture of `ground` that repeats every `tile`, or "uniform"."""

    name: str = "table"
    surface: str = "wood"
    tile: float = 0.9
    half_extent: tuple = (1.5, 1.5)
    tint: tuple = EVEN
    upright: bool = False  # a wall that stands on the table
    place: tuple = (0.0, 0.0)  # x, z of the centre, of the foot's centre if upright
    turn: float = 0.0  # of a wall about +Y; at 0 it faces +Z

    def world_from_plane(self):
        """4x4 for column vectors."""
        out = np.eye(4)
        out[:3, 3] = self.place[0], 0.0, self.place[1]
        if self.upright:
            cos, sin = np.cos(np.radians(self.turn)), np.sin(np.radians(self.turn))
            out[:3, :3] = np.array([[cos, sin, 0], [0, 0, -1], [-sin, cos, 0]])
            out[1, 3] = self.half_extent[1]
        return out

    def reflectance(self):
        """Linear reflectance picture."""
        plain = np.full((2, 2, 3), (0.56, 0.55, 0.53)) if self.surface == "uniform" else getattr(ground, self.surface)()
        return plain if tuple(self.tint) == EVEN else plain * self.tint

    def listing(self):
        """Entry of capture.json."""
        return {"name": self.name, "world_from_plane": columns(self.world_from_plane()), "half_extent": list(self.half_extent),
                "surface": "uniform" if self.surface == "uniform" else "textured"}


@dataclass
class Setup:
    """One session. Frame k shows `poses[k]`; what has one entry per frame may be empty, then nothing changes."""

    name: str
    description: str
    toy: str = "llama"
    size: tuple = (640, 360)
    eye: tuple = (0.03, 0.222, 0.325)
    target: tuple = (0.026, 0.046, 0.0)
    views: tuple = ()  # (eye, target) per frame of a moving camera
    focal: float = 0.9  # in picture widths
    yaw: float = -52.0
    scale: float = 1.0
    paints: tuple = ()  # per material of the toy: factor on its colours that the toy's file does not know
    lift: float = 0.0  # of the toy above the table
    receivers: tuple = (Receiver(),)
    lights: tuple = (Bulb(),)
    powers: tuple = ()  # factor on the first light, per frame
    sky: str = "even"  # fills what the lights leave of the plate's irradiance: see `sky`; or path of a light map that gives all
    things: tuple = ()  # of `thing`, on the table
    hand: tuple | None = None  # x, z, turn of a hand on the table that the plates have not seen
    physical: tuple = (None, 0.0)
    poses: tuple = LOOKS
    rate: float = 30.0  # frames per second
    ends_in_physical_pose: bool = True
    plates: tuple = (0,)  # views that have a plate
    plate_gains: tuple = ()  # per plate and channel, linear
    frame_gains: tuple = ()  # per frame and channel, linear; the truth has its frame's
    effort: int = 1  # samples a pixel relative to other sessions, where the light is hard to find
    same_noise: bool = False  # one seed for all truths, so that what stands still stays equal

    def cameras(self):
        """World-from-camera poses, 4x4 for column vectors: one, or one per frame."""
        return [pose(*view) for view in self.views or ((self.eye, self.target),)]

    def clips(self):
        """(clip, time) of each frame."""
        return list(self.poses) + ([self.physical] if self.ends_in_physical_pose else [])

    def has_own_frames(self):
        """True when the camera's picture changes from frame to frame."""
        return bool(self.views or self.frame_gains or self.powers)

    def focal_px(self):
        """Focal length in pixels, the same for both axes."""
        return self.focal * self.size[0]

    def world_from_object(self):
        """Toy's pose: a turn about +Y and a uniform scale."""
        cos, sin = self.scale * np.cos(np.radians(self.yaw)), self.scale * np.sin(np.radians(self.yaw))
        return np.array([[cos, 0, sin, 0], [0, self.scale, 0, self.lift], [-sin, 0, cos, 0], [0, 0, 0, 1.0]])


def pose(eye, target):
    """World-from-camera of an upright camera at `eye` that looks at `target`."""
    back = np.subtract(eye, target)
    back /= np.linalg.norm(back)
    right = np.cross((0.0, 1.0, 0.0), back)
    right /= np.linalg.norm(right)
    out = np.eye(4)
    out[:3, :4] = np.stack([right, np.cross(back, right), back, eye], axis=1)
    return out


def orbit(count, first, last, reach=0.3, height=0.2, target=(0.02, 0.045, 0.0)):
    """Views on an arc about the target, azimuths from `first` to `last`."""
    angles = np.radians(np.linspace(first, last, count))
    return tuple(((target[0] + reach * np.cos(a), height, target[2] + reach * np.sin(a)), target) for a in angles)


def gains(count, seed):
    """Exposure times white balance for `count` pictures, each channel within 0.8 to 1.25."""
    rng = np.random.default_rng(seed)
    exposure, balance = rng.uniform(-1, 1, (count, 1)), rng.uniform(-1, 1, (count, 3))
    return tuple(tuple(row) for row in 1.25 ** np.clip(0.65 * exposure + 0.35 * balance, -1, 1))


def columns(matrix):
    """16 numbers, column-major."""
    return [float(x) for x in matrix.T.ravel()]


def matrix(columns):
    """4x4 for column vectors, of 16 numbers."""
    return np.array(columns).reshape(4, 4).T
