"""The photographer: builds Mitsuba scenes of the toy on its table and develops them to 8-bit sRGB."""
import tempfile
from pathlib import Path

import mitsuba as mi
import numpy as np
from PIL import Image

mi.set_variant("llvm_ad_rgb")

WARM, COOL = np.array([1.05, 1.0, 0.91]), np.array([0.93, 1.0, 1.1])
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


class Photographer:
    """Camera, light and table of one setup; `scene` puts a posed toy there, `shoot` takes the picture."""

    def __init__(self, setup, reflectance, spp):
        self.setup, self.passes = setup, max(1, round(spp / SAMPLES_A_PASS))
        self.folder = tempfile.TemporaryDirectory()
        self.parts = {"type": "scene", "table": self.table(reflectance), "bulb": self.bulb(), "sky": self.sky(), "camera": self.camera(),
                      "integrator": {"type": "path", "max_depth": PATH_DEPTH, "rr_depth": 1000}}

    def table(self, reflectance):
        """Diffuse square of 3 m with its repeating picture; Mitsuba's rectangle spans -1..1 in its own x and y."""
        flat = mi.ScalarTransform4f().rotate([1, 0, 0], -90).scale(1.5)
        surface = picture(reflectance, "repeat") | {"to_uv": mi.ScalarTransform3f().rotate(GRAIN_DEGREES).scale(3.0 / self.setup.tile)}
        return {"type": "rectangle", "to_world": flat, "bsdf": {"type": "diffuse", "reflectance": surface}}

    def bulb(self):
        """Sphere whose irradiance on the table's origin is its share of the plate's level."""
        position, radius = self.setup.light_position(), self.setup.light_radius
        distance = np.linalg.norm(position)
        form_factor = radius**2 / distance**2 * position[1] / distance
        radiance = PLATE_LEVEL * self.setup.light_share / form_factor * WARM
        light = {"type": "area", "radiance": {"type": "rgb", "value": radiance.tolist()}}
        return {"type": "sphere", "center": position.tolist(), "radius": radius, "emitter": light}

    def sky(self):
        """Constant surroundings with the rest of the plate's level, found by diffuse bounces alone: half the noise of aiming at them too."""
        radiance = PLATE_LEVEL * (1 - self.setup.light_share) * COOL
        return {"type": "constant", "sampling_weight": 0.0, "radiance": {"type": "rgb", "value": radiance.tolist()}}

    def camera(self):
        """Pinhole at the setup's pose; Mitsuba's own camera looks along +Z with +X to the left."""
        width, height = self.setup.size
        pose = self.setup.world_from_camera() @ np.diag([-1.0, 1.0, -1.0, 1.0])
        film = {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb", "component_format": "float32",
                "rfilter": {"type": "box"}}
        sampler = {"type": "multijitter", "sample_count": SAMPLES_A_PASS}
        fov = float(np.degrees(2 * np.arctan(width / 2 / self.setup.focal_px())))
        return {"type": "perspective", "fov_axis": "x", "fov": fov, "near_clip": 0.01, "far_clip": 20.0,
                "to_world": mi.ScalarTransform4f(pose), "film": film, "sampler": sampler}

    def scene(self, baked):
        """Scene with the given baked primitives on the table."""
        return mi.load_dict(self.parts | self.meshes(baked))

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

    def shoot(self, baked, seed, path):
        """Renders and develops a photograph of the baked primitives; `seed` sets it apart from the others of the session."""
        scene, passes = self.scene(baked), range(self.passes)
        image = sum(np.array(mi.render(scene, spp=SAMPLES_A_PASS, seed=seed * 1000 + k), np.float64) for k in passes) / self.passes
        Image.fromarray(srgb(image)).save(path, optimize=True)
