"""Things on the table beside the toy: boxes and books, ramps, cups, posts. Lengths in metres, angles in degrees."""
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import mitsuba as mi
import numpy as np

import ground
from setup import EVEN

AROUND = 48  # sides of a cup
WALL = 0.08  # thickness of a cup's wall, of its width


@dataclass
class Thing:
    """One thing that stands on the table. `shape` is a function of this module that gives its polygons in a unit box."""

    shape: str = "box"
    size: tuple = (0.1, 0.02, 0.1)  # along x, y, z before it is turned
    place: tuple = (0.0, 0.0)  # x, z of its middle
    turn: float = 0.0  # about +Y
    surface: str = "uniform"  # or a picture of `ground`
    tile: float = 0.3
    tint: tuple = EVEN
    in_plates: bool = True
    in_frames: bool = True
    listed: bool = False  # its top is a receiver of capture.json

    def world_from_unit(self):
        """4x4 for column vectors."""
        cos, sin = np.cos(np.radians(self.turn)), np.sin(np.radians(self.turn))
        turn = np.array([[cos, 0, sin, self.place[0]], [0, 1, 0, 0], [-sin, 0, cos, self.place[1]], [0, 0, 0, 1.0]])
        return turn @ np.diag([*self.size, 1.0])

    def triangles(self):
        """Corners [n, 3, 3] in the world and texture coordinates [n, 3, 2], in metres along each polygon's own plane."""
        corners, places = [], []
        for polygon in globals()[self.shape]():
            flat = np.c_[polygon, np.ones(len(polygon))] @ self.world_from_unit().T
            flat = flat[:, :3]
            along = flat[1] - flat[0]
            along /= np.linalg.norm(along)
            normal = np.cross(along, flat[2] - flat[1])
            across = np.cross(normal / np.linalg.norm(normal), along)
            place = np.stack([(flat - flat[0]) @ along, (flat - flat[0]) @ across], 1)
            for k in range(1, len(polygon) - 1):
                corners.append(flat[[0, k, k + 1]])
                places.append(place[[0, k, k + 1]])
        return np.array(corners), np.array(places)

    def shape_of_mitsuba(self, folder):
        """Its matt mesh; a file is written into the folder."""
        corners, places = self.triangles()
        path = Path(folder) / f"thing_{abs(hash((self.shape, self.size, self.place, self.turn)))}.ply"
        write_ply(path, corners, places / self.tile)
        colour = np.full((2, 2, 3), (0.56, 0.55, 0.53)) if self.surface == "uniform" else getattr(ground, self.surface)()
        surface = {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(colour * self.tint, np.float32)), "raw": True, "wrap_mode": "repeat"}
        matt = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": surface}}
        return {"type": "ply", "filename": str(path), "face_normals": self.shape != "cup", "bsdf": matt}

    def listing(self):
        """Entry of capture.json for its top."""
        width, height, depth = self.size
        slope = np.arctan2(height, width) if self.shape == "ramp" else 0.0
        cos, sin = np.cos(slope), np.sin(slope)
        top = np.array([[cos, -sin, 0, 0], [sin, cos, 0, height / 2 if slope else height], [0, 0, 1, 0], [0, 0, 0, 1.0]])
        plane = replace(self, size=(1, 1, 1)).world_from_unit() @ top
        return {"name": self.shape, "world_from_plane": [float(x) for x in plane.T.ravel()], "half_extent": [width / cos / 2, depth / 2],
                "surface": "uniform" if self.surface == "uniform" else "textured"}


def box():
    """A box."""
    a, b = 0.5, 1.0
    yield [(-a, b, a), (a, b, a), (a, b, -a), (-a, b, -a)]
    for k in range(4):
        cos, sin = round(np.cos(k * np.pi / 2)), round(np.sin(k * np.pi / 2))
        yield [(x * cos + a * sin, y, a * cos - x * sin) for x, y in ((-a, 0), (a, 0), (a, b), (-a, b))]


def ramp():
    """A wedge that rises along +x."""
    a, b = 0.5, 1.0
    yield [(-a, 0, a), (a, b, a), (a, b, -a), (-a, 0, -a)]
    yield [(a, 0, a), (a, 0, -a), (a, b, -a), (a, b, a)]
    yield [(-a, 0, a), (a, 0, a), (a, b, a)]
    yield [(a, 0, -a), (-a, 0, -a), (a, b, -a)]


def cup():
    """A cup without a handle: wall, rim, inner wall, floor."""
    profile = [(0.5, 0.0), (0.5, 1.0), (0.5 - WALL, 1.0), (0.5 - WALL, 0.06), (0.0, 0.06)]
    angles = np.linspace(0, 2 * np.pi, AROUND + 1)
    for (inner, low), (outer, high) in zip(profile[1:], profile[:-1]):
        for first, second in zip(angles[:-1], angles[1:]):
            ring = [(r * np.cos(angle), y, r * np.sin(angle)) for r, y, angle in
                    ((outer, high, first), (inner, low, first), (inner, low, second), (outer, high, second))]
            yield [ring[0], ring[1], ring[3]] if inner == 0 else ring


def write_ply(path, corners, places):
    """Little-endian PLY of separate triangles."""
    rows = np.concatenate([corners, places], axis=2).reshape(-1, 5).astype("<f4")
    faces = np.zeros(len(corners), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, np.arange(3 * len(corners)).reshape(-1, 3)
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(rows)}", *(f"property float {n}" for n in "xyzuv"),
             f"element face {len(faces)}", "property list uchar int vertex_index", "end_header", ""]
    path.write_bytes("\n".join(lines).encode() + rows.tobytes() + faces.tobytes())


def hits(things, origin, direction):
    """Distances along unit directions to the first thing; infinite where there is none."""
    if not things:
        return np.full(len(origin), np.inf)
    with tempfile.TemporaryDirectory() as folder:
        scene = mi.load_dict({"type": "scene"} | {f"thing_{k}": thing.shape_of_mitsuba(folder) for k, thing in enumerate(things)})
    ray = mi.Ray3f(mi.Point3f(origin.T.astype(np.float32)), mi.Vector3f(direction.T.astype(np.float32)))
    return np.array(scene.ray_intersect_preliminary(ray).t, np.float64)

