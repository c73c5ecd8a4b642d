"""Adds the depths of a LiDAR scanner to a session, from its geometry.

usage: depth.py SESSION OUT [--of SESSION] [--noise MM] [--grain PX] [--side PX]
"""
import argparse
from pathlib import Path

import mitsuba as mi
import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter

from folder import copied, index_of, write
from setup import matrix
from skin import Toy

mi.set_variant("llvm_ad_rgb")


def mesh(corners, faces):
    """A mesh of Mitsuba."""
    made = mi.Mesh("mesh", len(corners), len(faces))
    parameters = mi.traverse(made)
    parameters["vertex_positions"] = np.ravel(corners).astype(np.float32)
    parameters["faces"] = np.ravel(faces).astype(np.uint32)
    parameters.update()
    return made


def receiver(listing, is_solid):
    """A rectangle, with its sides down to y = 0 if it is solid."""
    x, z = listing["half_extent"]
    around = np.array([[-x, 0, -z, 1], [x, 0, -z, 1], [x, 0, z, 1], [-x, 0, z, 1]]) @ matrix(listing["world_from_plane"]).T
    top = around[:, :3]
    faces = [[0, 1, 2], [0, 2, 3]]
    if is_solid:
        for k in range(4):
            j = (k + 1) % 4
            faces += [[k, j, 4 + j], [k, 4 + j, 4 + k]]
    return mesh(np.concatenate([top, top * [1, 0, 1]]), faces)


def geometry(index, of, folder):
    """The shapes that the scanner sees."""
    toy = Toy(folder / index["toy"]["file"])
    pose = index["toy"]["physical_pose"]
    place = matrix(index["toy"]["world_from_object"])
    shapes = {"type": "scene"}
    for k, part in enumerate(toy.bake(pose["clip"], pose["time"])):
        shapes[f"toy_{k}"] = mesh(part.positions @ place[:3, :3].T + place[:3, 3], part.triangles)
    for k, listing in enumerate(of["receivers"]):
        shapes[f"receiver_{k}"] = receiver(listing, is_solid=k > 0)
    return mi.load_dict(shapes)


def depths(scene, index, frame, size):
    """Distance along the view in metres; 0 where nothing is."""
    width, height = size
    k = frame.get("intrinsics", index["intrinsics"])
    u, v = np.meshgrid((np.arange(width) + 0.5) * index["width"] / width, (np.arange(height) + 0.5) * index["height"] / height)
    rays = np.stack([(u - k["cx"]) / k["fx"], -(v - k["cy"]) / k["fy"], -np.ones_like(u)], -1).reshape(-1, 3)
    pose = matrix(frame["world_from_camera"])
    hit = scene.ray_intersect_preliminary(mi.Ray3f(mi.Point3f(pose[:3, 3]), mi.Vector3f((rays @ pose[:3, :3].T).T)))
    distance = np.array(hit.t)
    return np.where(np.isfinite(distance), distance, 0).reshape(height, width)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("session", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--of", type=Path, help="a session that lists all planes of the place; all but the first are tops of solids")
    parser.add_argument("--noise", type=float, default=5.0, help="deviation, millimetres")
    parser.add_argument("--grain", type=float, default=0.0, help="deviation of the blur that neighbouring pixels' noise shares, pixels")
    parser.add_argument("--side", type=int, default=256, help="columns")
    args = parser.parse_args()
    index, of = copied(args.session, args.out), index_of(args.of or args.session)
    scene = geometry(index, of, args.session)
    size = (args.side, round(args.side * index["height"] / index["width"]))
    random = np.random.default_rng(5)
    for number, frame in enumerate(index["frames"]):
        exact = depths(scene, index, frame, size)
        noise = random.normal(size=exact.shape)
        if args.grain:
            noise = gaussian_filter(noise, args.grain)
            noise /= noise.std()
        seen = np.where(exact > 0, 1e3 * exact + args.noise * noise, 0)
        frame["depth"] = f"depth_{number:04}.png"
        Image.fromarray(np.clip(np.round(seen), 0, 65535).astype(np.uint16)).save(args.out / frame["depth"])
    write(args.out, index)


if __name__ == "__main__":
    main()
