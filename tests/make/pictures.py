"""Makes the pictures of README and the documents anew, from what the programs make of the bundled session.

usage: pictures.py [--programs DIR] [--hand SESSION] [NAME...]

NAMEs are moving, contact, presets, page, aligned, found, tour and hand; without any all are made but `page`, if chromium is missing, and
`hand`, which needs the session `intruder` (`session.py --variant intruder --spp 64 --out SESSION`). With --programs, programs of that
folder are run in place of `cargo xtask`.
"""
import argparse
import json
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image, ImageChops, ImageDraw, ImageFont

ROOT = Path(__file__).resolve().parents[2]
LLAMA = ROOT / "tests/sessions/llama"
# Left, top, right and bottom, pixels: the toy with all of its shadows, and within that the toy alone.
CROP, TOY = (112, 28, 546, 328), (0, 0, 256, 300)
GAP_PX, LABEL_PX, JPEG_QUALITY = 4, 18, 86
PRESETS = ("flat", "paper", "fast", "balanced", "best")
SCREENS = ("welcome", "find_table", "take_plate", "put_toy", "asked", "play")
# 640 pixels of width at a focal length of 576.
FOCAL_35MM = "32.4"
FILM_MS, FILM_COLORS, TOY_WEIGHT, KMEANS_ROUNDS = 80, 255, 6, 10
ERROR_TIMES = 8


def opened(path, crop=None):
    picture = Image.open(path).convert("RGB")
    return picture.crop(crop) if crop else picture


def sheet(pictures, n_columns, labels=None):
    """Pictures of one size in rows, with a word above each."""
    width, height = pictures[0].size
    head = LABEL_PX if labels else 0
    n_rows = -(-len(pictures) // n_columns)
    size = (n_columns * (width + GAP_PX) - GAP_PX, n_rows * (height + head + GAP_PX) - GAP_PX)
    whole = Image.new("RGB", size, "white")
    draw, font = ImageDraw.Draw(whole), ImageFont.load_default(14)
    for index, picture in enumerate(pictures):
        left, top = index % n_columns * (width + GAP_PX), index // n_columns * (height + head + GAP_PX)
        whole.paste(picture, (left, top + head))
        if labels:
            draw.text((left + 2, top + 1), labels[index], fill="black", font=font)
    return whole


def resized(picture, width):
    return picture.resize((width, round(width * picture.height / picture.width)), Image.Resampling.LANCZOS)


def write(picture, path):
    picture.save(ROOT / path, quality=JPEG_QUALITY)
    print(path)


class Maker:
    """Runs the programs into a folder, each once."""

    def __init__(self, folder, programs, hand):
        self.folder, self.programs, self.hand_session = folder, programs, hand

    def run(self, program, *args):
        command = [self.programs / program] if self.programs else ["cargo", "xtask", program]
        subprocess.run([str(part) for part in (*command, *args)], cwd=ROOT, check=True)

    def replayed(self, name, session, *args):
        out = self.folder / name
        if not out.exists():
            self.run("replay", session, "--out", out, "--quiet", *args)
        return out

    def film(self):
        out = self.folder / "film"
        if not out.exists():
            self.run("animate", "--clips", "Look", "--fps", "12", "--loop", "--out", out, "--quiet")
        return out

    def moving(self):
        """The photograph beside the film, as a GIF with one palette, in which toy and shadow weigh more than the table. The camera's
        pixels are the same in all frames, so without dithering the file is small."""
        photograph = opened(LLAMA / "frame_0000.png", CROP)
        made = [opened(path, CROP) for path in sorted(self.film().glob("llama_*.png"))]
        samples = [part for frame in made[:: max(1, len(made) // 6)] for part in [frame] + TOY_WEIGHT * [frame.crop(TOY)]]
        together = np.concatenate([np.asarray(sample).reshape(-1, 3) for sample in samples])
        together = Image.fromarray(together[: len(together) // 1000 * 1000].reshape(-1, 1000, 3))
        palette = together.quantize(FILM_COLORS, method=Image.Quantize.MEDIANCUT, kmeans=KMEANS_ROUNDS)
        frames = [sheet([photograph, frame], 2).quantize(palette=palette, dither=Image.Dither.NONE) for frame in made]
        out = "app-core/doc/llama.gif"
        frames[0].save(ROOT / out, save_all=True, append_images=frames[1:], duration=FILM_MS, loop=0, optimize=True)
        print(f"{out}: {len(frames)} frames, {(ROOT / out).stat().st_size // 1024} KiB")

    def contact(self):
        write(resized(opened(self.film() / "contact.png"), 1160), "tests/film/doc/contact.jpg")

    def presets(self):
        out = self.replayed("presets", LLAMA, "--preset", ",".join(PRESETS))
        shown = {preset: opened(out / preset / "frame_0000.png", CROP) for preset in PRESETS}
        truth = opened(LLAMA / "truth_0000.png", CROP)
        error = ImageChops.difference(shown["balanced"], truth).point(lambda code: min(255, code * ERROR_TIMES))
        pictures = [opened(LLAMA / "frame_0000.png", CROP), *shown.values(), truth, error]
        labels = ["photograph", *PRESETS, "truth", f"balanced - truth, {ERROR_TIMES} times"]
        write(sheet([resized(picture, 280) for picture in pictures], 4, labels), "tests/measure/doc/presets.jpg")

    def page(self):
        """The page of `replay`, as a browser shows it."""
        page = self.replayed("presets", LLAMA, "--preset", ",".join(PRESETS)) / "index.html"
        shot = self.folder / "page.png"
        subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--window-size=1400,1000", "--virtual-time-budget=8000",
                        f"--screenshot={shot}", page.as_uri()], check=True, capture_output=True)
        write(resized(opened(shot, (0, 0, 1385, 700)), 1108), "xtask/doc/page.jpg")

    def aligned(self):
        """The bundled session with a wrong pose and light, as given and aligned; prints the table of the document, too."""
        session = self.folder / "off"
        if not session.exists():
            disturbed(session)
        given = self.replayed("given", session, "--as-given")
        found = self.replayed("aligned", session)
        exact = self.replayed("exact", LLAMA, "--as-given")
        crop = (92, 20, 548, 340)
        write(sheet([opened(out / "frame_0000.png", crop) for out in (given, found)], 2), "app-core/doc/aligned.jpg")
        for name, out in (("as given", given), ("aligned", found), ("exact pose and light", exact)):
            scores = json.loads((out / "report.json").read_text())["mean"]["scores"]
            print(f"| {name} |", " | ".join(f"{scores[region]['rmse']:.2f}" for region in ("shadow", "toy", "edge")), "|")

    def found(self):
        out = self.folder / "found"
        self.run("new", LLAMA / "background_0000.png", LLAMA / "frame_0000.png", "--toy", LLAMA / "toy.glb", "--focal-35mm", FOCAL_35MM,
                 "--out", out)
        write(opened(out / "found.png"), "tests/film/doc/found.jpg")

    def tour(self):
        out = self.folder / "tour"
        self.run("view", "--tour", "--size", "390x844", "--out", out)
        paths = {path.stem.split("_", 1)[1]: path for path in sorted(out.glob("[0-9][0-9]_*.png"))}
        there = [screen for screen in SCREENS if screen in paths]
        write(sheet([resized(opened(paths[screen]), 195) for screen in there], len(there), there), "tests/view/doc/tour.jpg")

    def hand(self):
        out = self.replayed("hand", self.hand_session)
        crop = (80, 30, 600, 330)
        pictures = [opened(path, crop) for path in (self.hand_session / "frame_0000.png", out / "frame_0000.png")]
        write(sheet(pictures, 2), "app-core/doc/hand.jpg")


def turn(axis, degrees):
    """Rotation about an axis, as a matrix."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def disturbed(folder):
    """A copy of the bundled session with the toy moved by 5 mm and turned by 3 degrees, its light 10 degrees off and twice as large."""
    shutil.copytree(LLAMA, folder)
    index = json.loads((folder / "capture.json").read_text())
    world_from_object = np.array(index["toy"]["world_from_object"]).reshape(4, 4).T
    pivot, moved = np.array([0, 0.08, 0]), np.array([0.7, 0.1, -0.7])
    rotation = turn([0.5, 1, 0.3], 3)
    world_from_object[:3, :3] = rotation @ world_from_object[:3, :3]
    world_from_object[:3, 3] = rotation @ (world_from_object[:3, 3] - pivot) + pivot + 0.005 * moved / np.linalg.norm(moved)
    index["toy"]["world_from_object"] = world_from_object.T.ravel().tolist()
    light = index["lights"][0]
    light["position"] = (turn([0.2, 1, 0.1], 10) @ light["position"]).tolist()
    light["radius"] *= 2
    (folder / "capture.json").write_text(json.dumps(index, indent=1))


def main():
    names = ["moving", "contact", "presets", "page", "aligned", "found", "tour", "hand"]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", type=lambda path: Path(path).resolve(), metavar="DIR")
    parser.add_argument("--hand", type=lambda path: Path(path).resolve(), metavar="SESSION")
    parser.add_argument("names", nargs="*", choices=[*names, []], metavar="NAME")
    args = parser.parse_args()
    missing = {"page": not shutil.which("chromium"), "hand": not args.hand}
    chosen = args.names or [name for name in names if not missing.get(name)]
    with tempfile.TemporaryDirectory() as folder:
        maker = Maker(Path(folder), args.programs, args.hand)
        for name in chosen:
            getattr(maker, name)()


if __name__ == "__main__":
    main()
