"""Photographs the toy with Mitsuba 3 and writes `shadow-capture` folders.

usage: session.py [--variant NAME] [--out DIR] [--spp N]
World: right-handed, metres, +Y up. The camera looks along its -Z with +Y up.
"""
import argparse
import json
import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ground
from mask import mask_png
from photo import Photographer
from skin import Toy

SESSIONS = Path(__file__).parent.parent / "sessions"
LOOKS = (("Look", 0.6), ("Look", 1.8), ("Step", 0.5), ("Step", 1.25))


@dataclass
class Setup:
    """One table, light and camera. Lengths in metres, angles in degrees."""

    name: str
    description: str
    size: tuple = (640, 360)
    eye: tuple = (0.03, 0.222, 0.325)
    target: tuple = (0.026, 0.046, 0.0)
    yaw: float = -52.0
    scale: float = 1.0
    light_azimuth: float = 186.0  # from +X towards +Z
    light_elevation: float = 47.0
    light_distance: float = 1.0
    light_radius: float = 0.015
    light_share: float = 0.6  # of the plate's irradiance below the light
    table: str = "wood"
    tile: float = 0.9  # side of the table's repeating picture
    poses: tuple = LOOKS
    ends_in_physical_pose: bool = True

    def light_position(self):
        """Centre of the bulb in the world."""
        azimuth, elevation = np.radians(self.light_azimuth), np.radians(self.light_elevation)
        return self.light_distance * np.array([np.cos(elevation) * np.cos(azimuth), np.sin(elevation), np.cos(elevation) * np.sin(azimuth)])

    def focal_px(self):
        """Focal length in pixels, the same for both axes."""
        return 0.9 * self.size[0]

    def world_from_camera(self):
        """Camera pose, 4x4 for column vectors."""
        back = np.subtract(self.eye, self.target)
        back /= np.linalg.norm(back)
        right = np.cross((0.0, 1.0, 0.0), back)
        right /= np.linalg.norm(right)
        out = np.eye(4)
        out[:3, :4] = np.stack([right, np.cross(back, right), back, self.eye], axis=1)
        return out

    def world_from_object(self):
        """Toy's pose: a turn about +Y and a uniform scale."""
        cos, sin = self.scale * np.cos(np.radians(self.yaw)), self.scale * np.sin(np.radians(self.yaw))
        return np.array([[cos, 0, sin, 0], [0, self.scale, 0, 0], [-sin, 0, cos, 0], [0, 0, 0, 1.0]])

    def reflectance(self):
        """Table's linear reflectance picture, and whether it counts as textured."""
        if self.table == "uniform":
            return np.full((2, 2, 3), (0.56, 0.55, 0.53)), "uniform"
        return getattr(ground, self.table)(), "textured"


HD = {"size": (1280, 720), "poses": (("Look", 0.6), ("Look", 1.8), ("Step", 0.5)), "ends_in_physical_pose": False}
SETUPS = {s.name: s for s in (
    Setup("llama", "A jointed wooden llama on waxed planks under one frosted bulb, fixed camera."),
    Setup("bulb-uniform", "One small bulb, hard shadow, uniform table, fixed camera.", light_radius=0.006, table="uniform", **HD),
    Setup("area-wood", "One large lamp, wide penumbra, wooden table, fixed camera.", light_radius=0.07, **HD),
    Setup("bulb-tiles", "One small bulb, tiles, another side of the toy, fixed camera.",
          eye=(-0.13, 0.26, 0.33), target=(-0.01, 0.05, 0.025), yaw=38.0,
          light_azimuth=330.0, light_elevation=55.0, light_radius=0.01, table="tiles", tile=0.4, **HD),
)}


def columns(matrix):
    """16 numbers, column-major."""
    return [float(x) for x in matrix.T.ravel()]


def capture_json(setup, surface, clips):
    """The session's description; pose k of the toy is frame k."""
    camera = columns(setup.world_from_camera())
    width, height = setup.size
    frames = []
    for k, (clip, time) in enumerate(clips):
        truth = "frame_0000.png" if clip is None else f"truth_{k:04}.png"
        frames.append({"time": round(k / 30, 6), "image": "frame_0000.png", "world_from_camera": camera,
                       "animation": {"clip": clip, "time": time}, "truth": truth, "mask": f"mask_{k:04}.png"})
    return {
        "format": "shadow-capture", "version": 1, "name": setup.name, "description": setup.description,
        "credits": "Toy, table and pictures: this project's own work (tests/make).", "units": "metre",
        "width": width, "height": height, "encoding": "srgb",
        "intrinsics": {"fx": setup.focal_px(), "fy": setup.focal_px(), "cx": width / 2, "cy": height / 2},
        "toy": {"file": "toy.glb", "world_from_object": columns(setup.world_from_object()), "physical_pose": {"clip": None, "time": 0.0}},
        "receivers": [{"name": "table", "world_from_plane": columns(np.eye(4)), "half_extent": [1.5, 1.5], "surface": surface}],
        "lights": [{"kind": "sphere", "position": setup.light_position().tolist(), "radius": setup.light_radius}],
        "backgrounds": [{"image": "background_0000.png", "world_from_camera": camera}],
        "frames": frames,
    }


def make(setup, out, spp):
    """Renders one session into the folder `out`, which gets a copy of the toy."""
    out.mkdir(parents=True, exist_ok=True)
    source = SESSIONS / "llama" / "toy.glb"
    if out.resolve() != source.parent.resolve():
        shutil.copyfile(source, out / "toy.glb")
    toy = Toy(source)
    clips = list(setup.poses) + ([(None, 0.0)] if setup.ends_in_physical_pose else [])
    reflectance, surface = setup.reflectance()
    photographer = Photographer(setup, reflectance, spp)
    physical = toy.bake(None, 0.0)
    photographer.shoot([], 1, out / "background_0000.png")
    photographer.shoot(physical, 2, out / "frame_0000.png")
    for k, (clip, time) in enumerate(clips):
        posed = toy.bake(clip, time)
        if clip:
            photographer.shoot(posed, 3 + k, out / f"truth_{k:04}.png")
        mask_png(setup, photographer.casters(posed), photographer.casters(physical), out / f"mask_{k:04}.png")
    (out / "capture.json").write_text(json.dumps(capture_json(setup, surface, clips), indent=1) + "\n")
    print(f"{out}: {sum(f.stat().st_size for f in out.iterdir()) / 1e6:.2f} MB")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--variant", choices=SETUPS, default="llama")
    parser.add_argument("--out", type=Path, help="folder to write, by default tests/sessions/VARIANT")
    parser.add_argument("--spp", type=int, default=1024, help="samples a pixel, in multiples of 64")
    args = parser.parse_args()
    make(SETUPS[args.variant], args.out or SESSIONS / args.variant, args.spp)


if __name__ == "__main__":
    main()
