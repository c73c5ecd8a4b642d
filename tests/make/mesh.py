"""Adds a scanner's mesh of the place to a session, from the planes that a session lists.

usage: mesh.py SESSION OUT [--of SESSION] [--noise MM] [--spacing MM] [--deviation MM] [--move X Y Z] [--turn DEG] [--tilt DEG]
"""
import argparse
from pathlib import Path

import numpy as np

from folder import copied, index_of, write
from glb import FLOAT, Buffer, binary
from setup import matrix

NAME = "place.glb"
UNSIGNED_INT = 5125
REACH = 0.4  # of the ground's mesh around its middle


def faces(listing, is_solid):
    """Corners of the quadrangles of a rectangle, with its sides down to y = 0 if it is solid."""
    x, z = np.minimum(listing["half_extent"], REACH)
    around = np.array([[-x, 0, -z, 1], [-x, 0, z, 1], [x, 0, z, 1], [x, 0, -z, 1]]) @ matrix(listing["world_from_plane"]).T
    top = around[:, :3]
    yield top
    if is_solid:
        for k in range(4):
            side = top[[k, k - 3]]
            yield np.concatenate([side[::-1], side * [1, 0, 1]])


def grid(quad, spacing):
    """Points and triangles of a quadrangle."""
    a, b, c, d = quad
    n, m = (max(1, int(np.ceil(np.linalg.norm(side) / spacing))) for side in (b - a, d - a))
    u, v = np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij")
    u, v = u.reshape(-1, 1), v.reshape(-1, 1)
    points = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
    at = np.arange((n + 1) * (m + 1)).reshape(n + 1, m + 1)
    corners = [at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, :-1], at[1:, 1:], at[:-1, 1:]]
    return points, np.stack([corner.ravel() for corner in corners], 1).reshape(-1, 3)


def misplaced(points, args):
    """The mesh as somebody else's world has it."""
    turn, tilt = np.radians([args.turn, args.tilt])
    about_y = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    about_x = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    return points @ (about_x @ about_y).T + args.move


def glb(points, triangles):
    """One mesh in world space."""
    buffer = Buffer()
    position = buffer.accessor(points.astype("<f4"), FLOAT, "VEC3", bounds=True)
    corners = buffer.accessor(triangles.astype("<u4").ravel(), UNSIGNED_INT, "SCALAR")
    return binary({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                   "meshes": [{"primitives": [{"attributes": {"POSITION": position}, "indices": corners}]}]}, buffer)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("session", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--of", type=Path, help="a session that lists all planes of the place; all but the first are tops of solids")
    parser.add_argument("--noise", type=float, default=0.0, help="deviation of each point along each axis, millimetres")
    parser.add_argument("--spacing", type=float, default=10.0, help="distance of neighbouring points, millimetres")
    parser.add_argument("--deviation", type=float, help="the deviation that the session states, millimetres")
    parser.add_argument("--move", type=float, nargs=3, default=(0, 0, 0), help="metres")
    parser.add_argument("--turn", type=float, default=0.0, help="about +Y, degrees")
    parser.add_argument("--tilt", type=float, default=0.0, help="about +X, degrees")
    args = parser.parse_args()
    index, of = copied(args.session, args.out), index_of(args.of or args.session)
    quads = [quad for k, listing in enumerate(of["receivers"]) for quad in faces(listing, is_solid=k > 0)]
    points, triangles, n = [], [], 0
    for quad in quads:
        some, corners = grid(quad, 1e-3 * args.spacing)
        points.append(some)
        triangles.append(corners + n)
        n += len(some)
    points = np.concatenate(points)
    points = points + np.random.default_rng(6).normal(scale=1e-3 * args.noise, size=points.shape) if args.noise else points
    (args.out / NAME).write_bytes(glb(misplaced(points, args), np.concatenate(triangles)))
    index["place_mesh"] = {"file": NAME} | ({"deviation": 1e-3 * args.deviation} if args.deviation is not None else {})
    write(args.out, index)


if __name__ == "__main__":
    main()
