"""The photographer: builds Mitsuba scenes of the toy on its table and develops them to 8-bit sRGB."""
import tempfile
from dataclasses import dataclass
from pathlib import Path

import mitsuba as mi
import numpy as np
from PIL import Image

import hand
import sky
from setup import COOL, EVEN, Glow

mi.set_variant("llvm_ad_rgb")

PATH_DEPTH = 5
GRAIN_DEGREES = 24.0  # turn of the table's picture
SAMPLES_A_PASS = 64  # a square, as the multijitter sampler wants; keeps a pass within memory
PLATE_LEVEL = 1.0  # irradiance of the table below the light, over pi


def srgb(linear):
    """Exact sRGB curve to 8 bits; no tone mapping."""
    linear = np.clip(linear, 0, 1)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return np.round(encoded * 255).astype(np.uint8)


def linear(code):
    """8-bit sRGB to linear."""
    share = code / 255.0
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def picture(values, wrap):
    """Mitsuba texture of linear values; row 0 is v = 0."""
    return {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(values, np.float32)), "raw": True, "wrap_mode": wrap}


def write_ply(path, baked, world_from_object):
    """Little-endian PLY of a baked primitive in world space."""
    corners = baked.positions @ world_from_object[:3, :3].T + world_from_object[:3, 3]
    names = ["x", "y", "z"]
    if baked.uv is not None:
        corners, names = np.concatenate([corners, baked.uv], axis=1), names + ["u", "v"]
    faces = np.zeros(len(baked.triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, baked.triangles
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(corners)}", *(f"property float {n}" for n in names),
             f"element face {len(faces)}", "property list uchar int vertex_index", "end_header", ""]
    path.write_bytes("\n".join(lines).encode() + corners.astype("<f4").tobytes() + faces.tobytes())


@dataclass
class Shot:
    """One photograph: the toy's baked primitives, a seed of its own, and what differs from the setup's first frame."""

    baked: list
    seed: int
    view: int = 0
    power: float = 1.0  # of the first light
    gain: tuple = EVEN  # linear, per channel
    with_hand: bool = False
    is_plate: bool = False


class Photographer:
    """Receivers, lights and cameras of one setup; `shoot` puts a posed toy there and takes the picture."""

    def __init__(self, setup, spp):
        self.setup, self.passes = setup, setup.effort * max(1, round(spp / SAMPLES_A_PASS))
        self.folder = tempfile.TemporaryDirectory()
        self.parts = {"type": "scene"} | {f"receiver_{k}": self.receiver(r) for k, r in enumerate(setup.receivers)}
        self.parts |= {"sky": self.sky(), "integrator": {"type": "path", "max_depth": PATH_DEPTH, "rr_depth": 1000}}

    def receiver(self, receiver):
        """Diffuse rectangle with its repeating picture; Mitsuba's spans -1..1 in its own x and y."""
        width, depth = receiver.half_extent
        flat = mi.ScalarTransform4f(receiver.world_from_plane()).rotate([1, 0, 0], -90).scale([width, depth, 1.0])
        repeats = [2 * width / receiver.tile, 2 * depth / receiver.tile]
        surface = picture(receiver.reflectance(), "repeat") | {"to_uv": mi.ScalarTransform3f().rotate(GRAIN_DEGREES).scale(repeats)}
        matt = {"type": "diffuse", "reflectance": surface}
        return {"type": "rectangle", "to_world": flat, "bsdf": {"type": "twosided", "bsdf": matt} if receiver.upright else matt}

    def bulbs(self, power):
        """Spheres or points that give the table's origin their shares of the plate's level; the first times `power`."""
        out = {}
        for k, light in enumerate(self.setup.lights):
            if isinstance(light, Glow):
                continue
            position, radius = light.centre(), light.radius
            distance = np.linalg.norm(position)
            colour = PLATE_LEVEL * light.share * np.array(light.colour) * (power if k == 0 else 1.0)
            if radius == 0:
                intensity = np.pi * colour * distance**3 / position[1]
                out[f"bulb_{k}"] = {"type": "point", "position": position.tolist(), "intensity": {"type": "rgb", "value": intensity.tolist()}}
                continue
            form_factor = radius**2 / distance**2 * position[1] / distance
            glow = {"type": "area", "radiance": {"type": "rgb", "value": (colour / form_factor).tolist()}}
            out[f"bulb_{k}"] = {"type": "sphere", "center": position.tolist(), "radius": radius, "emitter": glow}
        return out

    def sky(self):
        """Surroundings with the rest of the plate's level. Even ones are found by diffuse bounces alone: half the noise of aiming at them too."""
        if self.setup.sky != "even":
            return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(sky.paint(self.setup) * PLATE_LEVEL, np.float32))}
        radiance = PLATE_LEVEL * (1 - sum(light.share for light in self.setup.lights)) * COOL
        return {"type": "constant", "sampling_weight": 0.0, "radiance": {"type": "rgb", "value": radiance.tolist()}}

    def camera(self, view):
        """Pinhole at one of the setup's poses; Mitsuba's own camera looks along +Z with +X to the left."""
        width, height = self.setup.size
        pose = self.setup.cameras()[view] @ np.diag([-1.0, 1.0, -1.0, 1.0])
        film = {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb", "component_format": "float32",
                "rfilter": {"type": "box"}}
        sampler = {"type": "multijitter", "sample_count": SAMPLES_A_PASS}
        fov = float(np.degrees(2 * np.arctan(width / 2 / self.setup.focal_px())))
        return {"type": "perspective", "fov_axis": "x", "fov": fov, "near_clip": 0.01, "far_clip": 20.0,
                "to_world": mi.ScalarTransform4f(pose), "film": film, "sampler": sampler}

    def casters(self, baked):
        """The baked primitives alone, for ray tests: neither table nor bulb can get in the way of a ray that ends on them."""
        return mi.load_dict({"type": "scene"} | self.meshes(baked))

    def meshes(self, baked):
        """Matt meshes of the baked primitives in world space."""
        parts = {}
        for k, primitive in enumerate(baked):
            path = Path(self.folder.name) / f"part_{k}.ply"
            write_ply(path, primitive, self.setup.world_from_object())
            colour = {"type": "rgb", "value": primitive.base_colour.tolist()}
            if primitive.texture is not None:
                colour = picture(linear(primitive.texture) * primitive.base_colour, "clamp")
            matt = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": colour}}
            parts[f"toy_{k}"] = {"type": "ply", "filename": str(path), "face_normals": True, "bsdf": matt}
        return parts

    def things(self, shot):
        """The things that a photograph shows."""
        shown = [thing for thing in self.setup.things if (thing.in_plates if shot.is_plate else thing.in_frames)]
        return {f"thing_{k}": thing.shape_of_mitsuba(self.folder.name) for k, thing in enumerate(shown)}

    def shoot(self, shot, path):
        """Renders and develops a photograph."""
        parts = self.parts | self.bulbs(shot.power) | {"camera": self.camera(shot.view)} | self.meshes(shot.baked)
        parts |= self.things(shot)
        scene = mi.load_dict(parts | (hand.shapes(*self.setup.hand) if shot.with_hand else {}))
        renders = (mi.render(scene, spp=SAMPLES_A_PASS, seed=shot.seed * 1000 + k) for k in range(self.passes))
        image = sum(np.array(render, np.float64) for render in renders) / self.passes
        Image.fromarray(srgb(image * shot.gain)).save(path, optimize=True)
