"""Gives a session a poorer model than the toy that its pictures show: fewer triangles, or a surface that is off.

usage: poor.py SESSION OUT [--keep SHARE] [--off MM]
"""
import argparse
import heapq
from pathlib import Path

import numpy as np

from folder import copied
from glb import packed
from skin import DTYPES, Toy

WAVE_MM = 12.0  # length of the waves of a surface that is off
LEAST_COSINE = 0.2  # between the normals of a triangle before and after a collapse
N_WAVES = 24


def faces_of(points, triangles):
    """Normals of triangles, twice their area long."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def quadrics(points, triangles):
    """Squared distances from the planes of the triangles around each vertex, weighted by area. Source: Garland and Heckbert 1997."""
    normals = faces_of(points, triangles)
    lengths = np.linalg.norm(normals, axis=1)
    planes = np.c_[normals, -np.einsum("ij,ij->i", normals, points[triangles[:, 0]])] / np.maximum(lengths, 1e-30)[:, None]
    out = np.zeros((len(points), 4, 4))
    for k in range(3):
        np.add.at(out, triangles[:, k], lengths[:, None, None] * planes[:, :, None] * planes[:, None, :])
    return out


class Collapser:
    """Moves vertices onto their neighbours, the cheapest first; the corners of all triangles follow."""

    def __init__(self, points, triangles):
        self.points, self.triangles = points, triangles.copy()
        self.quadrics = quadrics(points, triangles)
        self.around = [set() for _ in points]
        for index, corners in enumerate(self.triangles):
            for corner in corners:
                self.around[corner].add(index)
        self.n_left, self.version = len(triangles), np.zeros(len(points), int)
        self.heap = []
        for vertex in range(len(points)):
            self.push(vertex)

    def beside(self, vertex):
        return {int(corner) for index in self.around[vertex] for corner in self.triangles[index]} - {vertex}

    def push(self, vertex):
        for other in self.beside(vertex):
            place = np.append(self.points[other], 1.0)
            cost = place @ (self.quadrics[vertex] + self.quadrics[other]) @ place
            heapq.heappush(self.heap, (cost, vertex, other, self.version[vertex], self.version[other]))

    def can(self, vertex, other):
        """Whether the surface stays closed, and no triangle turns over."""
        shared = self.around[vertex] & self.around[other]
        if len(shared) != 2 or len(self.beside(vertex) & self.beside(other)) != 2:
            return False
        left = self.triangles[sorted(self.around[vertex] - shared)]
        before, after = faces_of(self.points, left), faces_of(self.points, np.where(left == vertex, other, left))
        return bool(np.all(np.einsum("ij,ij->i", before, after) > LEAST_COSINE * np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)))

    def collapse(self, vertex, other):
        touched = self.beside(vertex) | {vertex, other}
        for index in self.around[vertex] & self.around[other]:
            for corner in set(self.triangles[index]):
                self.around[corner].discard(index)
            self.triangles[index] = -1
            self.n_left -= 1
        for index in self.around[vertex]:
            self.triangles[index][self.triangles[index] == vertex] = other
            self.around[other].add(index)
        self.around[vertex] = set()
        self.quadrics[other] += self.quadrics[vertex]
        for one in touched:
            self.version[one] += 1
        for one in touched:
            self.push(one)

    def down_to(self, n):
        while self.n_left > n and self.heap:
            _, vertex, other, *versions = heapq.heappop(self.heap)
            if versions == [self.version[vertex], self.version[other]] and self.can(vertex, other):
                self.collapse(vertex, other)


def waves(points_mm, off_mm):
    """Smooth displacements, millimetres; the root mean square of each component is `off_mm`."""
    random = np.random.default_rng(3)
    directions = random.normal(size=(N_WAVES, 3))
    directions *= 2 * np.pi / WAVE_MM / np.linalg.norm(directions, axis=1, keepdims=True)
    phases, sizes = random.uniform(0, 2 * np.pi, N_WAVES), random.normal(size=(N_WAVES, 3))
    sizes *= off_mm * np.sqrt(2 / (sizes**2).sum(0))
    return np.sin(points_mm @ directions.T + phases) @ sizes


class Rewriter:
    """Replaces the arrays of a glTF binary."""

    def __init__(self, path):
        self.toy = Toy(path)
        self.document, self.binary = self.toy.document, bytearray(self.toy.binary)

    def raw(self, index):
        """An accessor as it is stored."""
        entry = self.document["accessors"][index]
        view = self.document["bufferViews"][entry["bufferView"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[entry["type"]]
        start = view.get("byteOffset", 0) + entry.get("byteOffset", 0)
        return np.frombuffer(self.toy.binary, DTYPES[entry["componentType"]], entry["count"] * width, start).reshape(-1, width)

    def replace(self, index, array):
        self.binary += bytes(-len(self.binary) % 4)
        entry = self.document["accessors"][index]
        self.document["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": array.nbytes})
        self.binary += array.tobytes()
        entry |= {"bufferView": len(self.document["bufferViews"]) - 1, "byteOffset": 0, "count": len(array) if array.shape[1] > 1 else array.size}
        if "min" in entry:
            entry |= {"min": array.min(0).tolist(), "max": array.max(0).tolist()}

    def write(self, path):
        path.write_bytes(packed(self.document, self.binary))


def poorer(rewriter, primitive, keep, off):
    """Rewrites a faceted primitive: its corners stay vertices of their own. `off` displaces points."""
    attributes = primitive["attributes"]
    arrays = {name: rewriter.raw(index) for name, index in attributes.items()}
    corners = rewriter.raw(primitive["indices"]).reshape(-1, 3).astype(int)
    points, of_vertex = np.unique(arrays["POSITION"], axis=0, return_inverse=True)
    of_vertex = of_vertex.ravel()
    welded = of_vertex[corners]
    collapser = Collapser(points.astype(float), welded)
    collapser.down_to(keep * len(welded))
    left = collapser.triangles[:, 0] >= 0
    triangles, own = collapser.triangles[left], corners[left]
    # A corner that was moved takes the attributes of a vertex of its new place, with the nearest texture coordinates.
    uv = arrays.get("TEXCOORD_0", np.zeros((len(of_vertex), 2), np.float32))
    copies = [np.flatnonzero(of_vertex == place) for place in range(len(points))]
    sources = [vertex if of_vertex[vertex] == place else min(copies[place], key=lambda copy: np.sum((uv[copy] - uv[vertex]) ** 2))
               for vertex, place in zip(own.ravel(), triangles.ravel())]
    moved = points + off(points)
    normals = faces_of(moved, triangles)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    for name, index in attributes.items():
        rewriter.replace(index, np.ascontiguousarray(arrays[name][sources]))
    rewriter.replace(attributes["POSITION"], moved[triangles.ravel()].astype(np.float32))
    rewriter.replace(attributes["NORMAL"], np.repeat(normals, 3, axis=0).astype(np.float32))
    rewriter.document["accessors"][primitive["indices"]]["componentType"] = 5125
    rewriter.replace(primitive["indices"], np.arange(len(sources), dtype=np.uint32)[:, None])
    return len(welded), len(triangles)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("session", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--keep", type=float, default=1.0, help="share of the triangles to keep")
    parser.add_argument("--off", type=float, default=0.0, help="root mean square of each component of the surface's displacement, millimetres")
    args = parser.parse_args()
    index = copied(args.session, args.out)
    file = index["toy"]["file"]
    scale_mm = 1e3 * np.linalg.norm(index["toy"]["world_from_object"][:3])
    rewriter = Rewriter(args.session / file)
    primitives = [primitive for mesh in rewriter.document["meshes"] for primitive in mesh["primitives"]]
    counts = [poorer(rewriter, primitive, args.keep, lambda points: waves(points * scale_mm, args.off) / scale_mm) for primitive in primitives]
    rewriter.write(args.out / file)
    print("%d of %d triangles" % tuple(np.sum(counts, axis=0)[::-1]))


if __name__ == "__main__":
    main()
