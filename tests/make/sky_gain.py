"""How much a light of low order from all around could gain, were it known: a bound, fitted to the truth itself.

usage: sky_gain.py SESSION OUT [--plant]     OUT is what `cargo xtask replay SESSION --out OUT` wrote

The model takes the light from all around for even. Here spherical harmonics of order 1 and 2 are put on top: what the toy hides of
each is drawn on the table in old and new pose, and its normals turn in each. Their factors are fitted to truth less picture,
by least squares for each colour; of all frames, which no method can beat, and of the other frames, which is what one could know.
`--plant` first puts a light of order 1 into the truth, which must then be found.
"""
import argparse
import json
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from skin import Toy

N_DIRECTIONS = 96
GRID = 300
GRID_METRES = 0.7
PLANTED = np.array([0.9, -0.4, 0.0])


def linear(path):
    """A picture in linear light."""
    codes = np.asarray(Image.open(path).convert("RGB"), float) / 255
    return np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)


def codes(light):
    """8-bit sRGB codes, not rounded."""
    light = np.clip(light, 0, 1)
    return 255 * np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)


def harmonics(directions, order):
    """Real spherical harmonics from order 1 on, but for their factors."""
    x, y, z = directions.T
    first = [x, z, y]
    second = [x * z, x * x - z * z, x * y, z * y, 3 * y * y - 1]
    return np.stack(first + (second if order == 2 else []), -1)


def sky():
    """Cosine-distributed directions."""
    at = np.arange(N_DIRECTIONS) + 0.5
    radius, angle = np.sqrt(at / N_DIRECTIONS), at * np.pi * (3 - np.sqrt(5))
    return np.stack([radius * np.cos(angle), np.sqrt(1 - radius**2), radius * np.sin(angle)], -1)


def matrix(entries):
    """A column-major matrix of a session's index."""
    return np.array(entries).reshape(4, 4).T


class Session:
    """A session with its truths, and the pictures that were made of it. The table is the plane y = 0."""

    def __init__(self, folder, out):
        self.folder, self.out = Path(folder), Path(out)
        self.index = json.loads((self.folder / "capture.json").read_text())
        self.toy = Toy(self.folder / self.index["toy"]["file"])
        self.world_from_object = matrix(self.index["toy"]["world_from_object"])
        self.frames = self.index["frames"]
        self.plate = linear(self.folder / self.index["backgrounds"][0]["image"])

    def triangles(self, pose):
        """Corners in the world."""
        baked = self.toy.bake(pose.get("clip"), pose["time"])
        corners = [part.positions[part.triangles] for part in baked]
        return np.concatenate(corners) @ self.world_from_object[:3, :3].T + self.world_from_object[:3, 3]

    def rays(self, frame):
        """The camera's place, and a direction for each pixel."""
        k, camera = self.index["intrinsics"], matrix(frame["world_from_camera"])
        v, u = np.mgrid[0 : self.index["height"], 0 : self.index["width"]] + 0.5
        rays = np.stack([(u - k["cx"]) / k["fx"], (k["cy"] - v) / k["fy"], -np.ones_like(u)], -1)
        return camera[:3, 3], rays @ camera[:3, :3].T

    def on_grid(self, at):
        """Cells of the grid on the table."""
        return (at - self.world_from_object[:3, 3] + 0.5 * GRID_METRES)[..., [0, 2]] / GRID_METRES * GRID

    def hidden(self, pose):
        """Whether the toy hides each direction from each cell."""
        corners = self.triangles(pose)
        out = np.zeros((GRID, GRID, N_DIRECTIONS), np.float32)
        for index, to_light in enumerate(sky()):
            flat = self.on_grid(corners - to_light * (corners[..., 1:2] / to_light[1]))
            picture = Image.new("1", (GRID, GRID))
            draw = ImageDraw.Draw(picture)
            for triangle in flat:
                draw.polygon([tuple(corner) for corner in triangle], fill=1)
            out[..., index] = picture
        return out

    def seen(self, frame, pose):
        """Index of the triangle that each pixel shows, or -1."""
        k, camera = self.index["intrinsics"], matrix(frame["world_from_camera"])
        local = (self.triangles(pose) - camera[:3, 3]) @ camera[:3, :3]
        u = k["cx"] - k["fx"] * local[..., 0] / local[..., 2]
        v = k["cy"] + k["fy"] * local[..., 1] / local[..., 2]
        picture = Image.new("I", (self.index["width"], self.index["height"]), -1)
        draw = ImageDraw.Draw(picture)
        for index in np.argsort(local[..., 2].mean(1)):
            draw.polygon(list(zip(u[index], v[index])), fill=int(index))
        return np.asarray(picture)


def normals(triangles):
    """Unit normals."""
    out = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-20)


def grown(mask, pixels):
    """A mask grown by pixels; shrunk by negative ones."""
    kind = ImageFilter.MaxFilter if pixels > 0 else ImageFilter.MinFilter
    return np.asarray(Image.fromarray((mask * 255).astype(np.uint8)).filter(kind(2 * abs(pixels) + 1))) > 0


def of_table(session, index, order, before):
    """Pixels in and around the shadows, and how what the toy hides of each harmonic changes there, over the plate."""
    frame = session.frames[index]
    mask = np.moveaxis(np.asarray(Image.open(session.folder / frame["mask"])), -1, 0)
    eye, rays = session.rays(frame)
    cells = np.floor(session.on_grid(eye - rays * (eye[1] / rays[..., 1:2]))).astype(int)
    on_grid = (rays[..., 1] < 0) & (cells >= 0).all(-1) & (cells < GRID).all(-1)
    pixels = grown((mask[1] > 0) | (mask[2] > 2) | (mask[3] > 2), 6) & ~grown(mask[0] > 0, 2) & on_grid
    change = (before - session.hidden(frame["animation"])) @ harmonics(sky(), order) / N_DIRECTIONS
    at = cells[pixels]
    return pixels, change[at[:, 1], at[:, 0]], session.plate[pixels]


def of_toy(session, index, order, before):
    """Pixels of the toy, and how each harmonic changes with the normal there, over the picture."""
    frame = session.frames[index]
    mask = np.asarray(Image.open(session.folder / frame["mask"]))
    seen = session.seen(frame, frame["animation"])
    pixels = grown(mask[..., 0] > 0, -2) & (seen >= 0)
    now = normals(session.triangles(frame["animation"]))
    change = harmonics(now, order) - harmonics(before, order)
    return pixels, change[seen[pixels]], linear(session.out / f"frame_{index:04}.png")[pixels]


def gained(frames, is_alone):
    """Mean RMSE in codes before and after."""
    errors = []
    for index, (change, base, made, truth) in enumerate(frames):
        others = [frame for other, frame in enumerate(frames) if other != index or not is_alone]
        better = made.copy()
        for channel in range(3):
            rows = np.concatenate([c * b[:, channel, None] for c, b, _, _ in others])
            missing = np.concatenate([(t - m)[:, channel] for _, _, m, t in others])
            factors = np.linalg.lstsq(rows, missing, rcond=None)[0]
            better[:, channel] += change @ factors * base[:, channel]
        errors.append([np.sqrt(np.mean((codes(one) - codes(truth)) ** 2)) for one in (made, better)])
    return np.mean(errors, 0)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("session")
    arguments.add_argument("out")
    arguments.add_argument("--plant", action="store_true", help="put a light of order 1 into the truth, which must be found")
    arguments = arguments.parse_args()
    session = Session(arguments.session, arguments.out)
    physical = session.index["toy"]["physical_pose"]
    parts = {"shadow": (of_table, session.hidden(physical)), "toy": (of_toy, normals(session.triangles(physical)))}
    for name, (part, before) in parts.items():
        for order in (1, 2):
            frames = []
            for index, frame in enumerate(session.frames):
                pixels, change, base = part(session, index, order, before)
                truth = linear(session.folder / frame["truth"])[pixels]
                if arguments.plant:
                    truth = truth + change[:, :3] @ PLANTED[:, None] * base
                frames.append((change, base, linear(session.out / f"frame_{index:04}.png")[pixels], truth))
            told = [f"{what} {was:.2f} -> {now:.2f}" for what, (was, now) in (("of all", gained(frames, False)), ("of the others", gained(frames, True)))]
            print(f"{name} order {order}: RMSE {', '.join(told)}")


if __name__ == "__main__":
    main()
