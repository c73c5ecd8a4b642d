"""Writes skinned, animated solids as one glTF 2.0 binary, faceted: each triangle has its own corners and normal."""
import json
import struct
from dataclasses import dataclass, field

import numpy as np

FLOAT, UNSIGNED_BYTE, UNSIGNED_SHORT = 5126, 5121, 5123
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
IDENTITY = (0.0, 0.0, 0.0, 1.0)


@dataclass
class Joint:
    """A joint: `place` in object space (m) when the mesh was bound, `rotation` in the authored pose."""

    name: str
    parent: str | None
    place: tuple
    rotation: tuple = IDENTITY


@dataclass
class Material:
    """Matt material: linear base colour and, if any, an embedded PNG that multiplies it."""

    name: str
    base_colour: tuple
    png: bytes | None = None


@dataclass
class Clip:
    """Animation: key times (s), per joint one rotation per key, and per joint one translation (m) per key."""

    name: str
    times: list
    rotations: dict
    moves: dict = field(default_factory=dict)


class Buffer:
    """The binary chunk and the accessors into it."""

    def __init__(self):
        self.data, self.views, self.accessors = bytearray(), [], []

    def view(self, raw, target=None):
        """Appends bytes at a multiple of four and returns the index of their view."""
        self.data += bytes(-len(self.data) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(raw)} | ({"target": target} if target else {}))
        self.data += raw
        return len(self.views) - 1

    def accessor(self, array, component, kind, target=None, **extra):
        """Appends an array and returns the index of its accessor; 'bounds' asks for its minimum and maximum."""
        entry = {"componentType": component, "count": len(array), "type": kind}
        if extra.pop("bounds", False):
            rows = array.reshape(len(array), -1)
            entry |= {"min": rows.min(0).tolist(), "max": rows.max(0).tolist()}
        self.accessors.append({"bufferView": self.view(array.tobytes(), target)} | entry | extra)
        return len(self.accessors) - 1


def byte_weights(mix, order):
    """Four joint indices and four weights in 255ths that add up to 255."""
    names = sorted(mix, key=mix.get, reverse=True)[:4]
    shares = np.floor([mix[name] * 255 for name in names]).astype(int)
    shares[0] += 255 - shares.sum()
    pad = [0] * (4 - len(names))
    return [order[name] for name in names] + pad, shares.tolist() + pad


def primitive(buffer, solids, order, material):
    """One glTF primitive of all solids that share a material."""
    positions, normals, uv, joints, weights = [], [], [], [], []
    for solid in solids:
        corners = solid.triangles.ravel()
        points = solid.positions[corners].reshape(-1, 3, 3)
        normal = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        positions.append(points.reshape(-1, 3))
        normals.append(np.repeat(normal, 3, axis=0))
        packed = [byte_weights(mix, order) for mix in solid.joints]
        joints.append(np.array([p[0] for p in packed])[corners])
        weights.append(np.array([p[1] for p in packed])[corners])
        if solid.uv is not None:
            uv.append(solid.uv[corners])
    streams = [np.concatenate(positions).astype(np.float32), np.concatenate(normals).astype(np.float32)]
    bones = np.concatenate([np.concatenate(joints), np.concatenate(weights)], axis=1).astype(np.uint8)
    places = np.concatenate(uv).astype(np.float32) if uv else np.zeros((len(bones), 0), np.float32)
    table = np.concatenate([streams[0].view(np.uint8), streams[1].view(np.uint8), bones, places.view(np.uint8)], axis=1)
    _, first, inverse = np.unique(table, axis=0, return_index=True, return_inverse=True)
    keep = np.sort(first)
    rank = np.searchsorted(keep, first)
    indices = rank[inverse.ravel()].astype(np.uint16)

    def put(array, component, kind, **extra):
        return buffer.accessor(np.ascontiguousarray(array[keep]), component, kind, ARRAY_BUFFER, **extra)

    attributes = {
        "POSITION": put(streams[0], FLOAT, "VEC3", bounds=True),
        "NORMAL": put(streams[1], FLOAT, "VEC3"),
        "JOINTS_0": put(bones[:, :4], UNSIGNED_BYTE, "VEC4"),
        "WEIGHTS_0": put(bones[:, 4:], UNSIGNED_BYTE, "VEC4", normalized=True),
    }
    if uv:
        attributes["TEXCOORD_0"] = put(places, FLOAT, "VEC2")
    index = buffer.accessor(indices, UNSIGNED_SHORT, "SCALAR", ELEMENT_ARRAY_BUFFER)
    return {"attributes": attributes, "indices": index, "material": material}


def material_entry(material, texture):
    """glTF material; `texture` is the index of its texture or None."""
    surface = {"baseColorFactor": [*material.base_colour, 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0}
    if texture is not None:
        surface["baseColorTexture"] = {"index": texture}
    return {"name": material.name, "pbrMetallicRoughness": surface}


def animation(buffer, clip, order):
    """glTF animation with linear rotation and translation channels."""
    times = buffer.accessor(np.array(clip.times, np.float32), FLOAT, "SCALAR", bounds=True)
    channels, samplers = [], []
    for path, kind, tracks in (("rotation", "VEC4", clip.rotations), ("translation", "VEC3", clip.moves)):
        for name, values in tracks.items():
            samplers.append({"input": times, "output": buffer.accessor(np.array(values, np.float32), FLOAT, kind), "interpolation": "LINEAR"})
            channels.append({"sampler": len(samplers) - 1, "target": {"node": order[name], "path": path}})
    return {"name": clip.name, "channels": channels, "samplers": samplers}


def nodes(joints, order):
    """Joint nodes in the order of the list, then the node of the mesh."""
    places = {joint.name: np.array(joint.place) for joint in joints}
    out = []
    for joint in joints:
        local = places[joint.name] - (places[joint.parent] if joint.parent else 0)
        node = {"name": joint.name, "translation": local.tolist()}
        if joint.rotation != IDENTITY:
            node["rotation"] = list(joint.rotation)
        children = [order[other.name] for other in joints if other.parent == joint.name]
        out.append(node | ({"children": children} if children else {}))
    return out + [{"name": "toy", "mesh": 0, "skin": 0}]


def write_glb(path, solids, joints, materials, clips):
    """Writes the file; joints come before their children, and node k is joint k."""
    buffer, order = Buffer(), {joint.name: k for k, joint in enumerate(joints)}
    binds = np.tile(np.eye(4, dtype=np.float32), (len(joints), 1, 1))
    binds[:, 3, :3] = [-np.array(joint.place) for joint in joints]  # column-major: the translation is the last row
    primitives = [primitive(buffer, [s for s in solids if s.material == m.name], order, k) for k, m in enumerate(materials)]
    textured = [m for m in materials if m.png]
    document = {
        "asset": {"version": "2.0", "generator": "tests/make/toy.py"},
        "scene": 0,
        "scenes": [{"nodes": [0, len(joints)]}],
        "nodes": nodes(joints, order),
        "meshes": [{"name": "toy", "primitives": primitives}],
        "skins": [{"joints": list(range(len(joints))), "skeleton": 0, "inverseBindMatrices": buffer.accessor(binds, FLOAT, "MAT4")}],
        "materials": [material_entry(m, textured.index(m) if m.png else None) for m in materials],
        "textures": [{"source": k, "sampler": 0} for k in range(len(textured))],
        "images": [{"mimeType": "image/png", "bufferView": buffer.view(m.png), "name": m.name} for m in textured],
        "samplers": [{"magFilter": 9729, "minFilter": 9729, "wrapS": 33071, "wrapT": 33071}],
        "animations": [animation(buffer, clip, order) for clip in clips],
    }
    path.write_bytes(binary(document, buffer))


def binary(document, buffer):
    """Binary glTF of a document without its accessors and buffers, which are the buffer's."""
    return packed(document | {"accessors": buffer.accessors, "bufferViews": buffer.views}, buffer.data)


def packed(document, data):
    """Binary glTF of a document whose only buffer has these bytes."""
    document = document | {"buffers": [{"byteLength": len(data)}]}
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    body = bytes(data) + bytes(-len(data) % 4)
    document_chunk = struct.pack("<II", len(text), 0x4E4F534A) + text
    binary_chunk = struct.pack("<II", len(body), 0x004E4942) + body
    header = struct.pack("<4sII", b"glTF", 2, 12 + len(document_chunk) + len(binary_chunk))
    return header + document_chunk + binary_chunk
