"""Reads a glTF binary and bakes a pose of its skinned mesh: plain numpy, written apart from the app's loader.

Positions come out in glTF scene space. Only what the toy uses is read: one skin, linear keys, no morph targets.
"""
import io
import json
import struct
from dataclasses import dataclass

import numpy as np
from PIL import Image

DTYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


@dataclass
class Baked:
    """Triangles of one primitive in a pose; `texture` is 8-bit sRGB or None."""

    positions: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    uv: np.ndarray | None
    base_colour: np.ndarray
    texture: np.ndarray | None


def slerp(a, b, t):
    """Shorter arc between unit quaternions."""
    cosine = float(a @ b)
    if cosine < 0:
        b, cosine = -b, -cosine
    if cosine > 0.9995:
        mixed = a + (b - a) * t
        return mixed / np.linalg.norm(mixed)
    angle = np.arccos(cosine)
    return (np.sin((1 - t) * angle) * a + np.sin(t * angle) * b) / np.sin(angle)


def matrix(translation, rotation, scale):
    """Translation x rotation x scale as a 4x4 matrix for column vectors."""
    x, y, z, w = rotation
    turn = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = turn * scale, translation
    return out


class Toy:
    """A glTF binary held in memory."""

    def __init__(self, path):
        raw = path.read_bytes()
        length = struct.unpack_from("<I", raw, 12)[0]
        self.document = json.loads(raw[20:20 + length])
        self.binary = raw[28 + length:]

    def paint(self, factors):
        """Multiplies the base colour of each material, linear."""
        for material, factor in zip(self.document["materials"], factors):
            surface = material["pbrMetallicRoughness"]
            surface["baseColorFactor"] = [*(np.array(surface["baseColorFactor"][:3]) * factor), 1.0]

    def accessor(self, index):
        """Tightly packed accessor as an array, normalised integers as fractions."""
        entry = self.document["accessors"][index]
        view = self.document["bufferViews"][entry["bufferView"]]
        width, dtype = WIDTHS[entry["type"]], DTYPES[entry["componentType"]]
        start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        flat = np.frombuffer(self.binary, dtype, entry["count"] * width, start)
        flat = flat.astype(np.float64) / (np.iinfo(dtype).max if entry.get("normalized") else 1)
        return flat.reshape(-1, width) if width > 1 else flat

    def animation(self, clip):
        """Animation by name, or by `#N`."""
        entries = self.document["animations"]
        return entries[int(clip[1:])] if clip.startswith("#") else next(e for e in entries if e["name"] == clip)

    def local_transforms(self, clip, time):
        """Translation, rotation and scale of each node; a clip of None leaves the nodes as authored."""
        nodes = [{"translation": np.array(n.get("translation", (0, 0, 0)), float), "rotation": np.array(n.get("rotation", (0, 0, 0, 1)), float),
                  "scale": np.array(n.get("scale", (1, 1, 1)), float)} for n in self.document["nodes"]]
        for channel in self.animation(clip)["channels"] if clip else []:
            sampler = self.animation(clip)["samplers"][channel["sampler"]]
            assert sampler.get("interpolation", "LINEAR") == "LINEAR", "only linear keys"
            times, values = self.accessor(sampler["input"]), self.accessor(sampler["output"])
            last = int(np.clip(np.searchsorted(times, time, "right"), 1, len(times) - 1))
            share = float(np.clip((time - times[last - 1]) / (times[last] - times[last - 1]), 0, 1))
            path = channel["target"]["path"]
            between = slerp if path == "rotation" else lambda a, b, t: a + (b - a) * t
            nodes[channel["target"]["node"]][path] = between(values[last - 1], values[last], share)
        return [matrix(**node) for node in nodes]

    def world_transforms(self, clip, time):
        """Scene-from-node matrices."""
        local, out = self.local_transforms(clip, time), {}

        def visit(index, parent):
            out[index] = parent @ local[index]
            for child in self.document["nodes"][index].get("children", []):
                visit(child, out[index])

        for root in self.document["scenes"][self.document.get("scene", 0)]["nodes"]:
            visit(root, np.eye(4))
        return out

    def texture(self, material):
        """Base-colour picture of a material, 8-bit sRGB, or None."""
        link = material["pbrMetallicRoughness"].get("baseColorTexture")
        if link is None:
            return None
        view = self.document["bufferViews"][self.document["images"][self.document["textures"][link["index"]]["source"]]["bufferView"]]
        raw = self.binary[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]
        return np.asarray(Image.open(io.BytesIO(raw)).convert("RGB"))

    def bake(self, clip, time):
        """All primitives in the pose of `clip` at `time` seconds."""
        skin = self.document["skins"][0]
        world = self.world_transforms(clip, time)
        binds = self.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        joints = np.stack([world[node] @ bind for node, bind in zip(skin["joints"], binds)])
        return [self.bake_primitive(p, joints) for p in self.document["meshes"][0]["primitives"]]

    def bake_primitive(self, primitive, joints):
        """One primitive under the given joint matrices."""
        get = {name: self.accessor(index) for name, index in primitive["attributes"].items()}
        weights = get["WEIGHTS_0"] / get["WEIGHTS_0"].sum(1, keepdims=True)
        blend = np.einsum("vk,vkij->vij", weights, joints[get["JOINTS_0"].astype(int)])
        positions = np.einsum("vij,vj->vi", blend[:, :3, :3], get["POSITION"]) + blend[:, :3, 3]
        normals = np.linalg.solve(blend[:, :3, :3].transpose(0, 2, 1), get["NORMAL"][..., None])[..., 0]
        material = self.document["materials"][primitive["material"]]
        return Baked(positions, normals / np.linalg.norm(normals, axis=1, keepdims=True),
                     self.accessor(primitive["indices"]).astype(int).reshape(-1, 3), get.get("TEXCOORD_0"),
                     np.array(material["pbrMetallicRoughness"]["baseColorFactor"][:3]), self.texture(material))
