"""Make the moving picture of README: the bundled photograph beside the film that `animate` has made of it.

    cargo xtask animate --clips Look --fps 12 --loop && python tests/make/moving_picture.py

The camera's pixels are the same in all frames, so one palette without dithering keeps the file small. Toy and shadow weigh more
in it than the table.
"""

from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
PHOTOGRAPH = ROOT / "tests/sessions/llama/frame_0000.png"
FILM = ROOT / "target/film/llama"
OUT = ROOT / "app-core/doc/llama.gif"
# Left, top, right and bottom, pixels: the toy with all of its shadows, and within that the toy alone.
CROP = (112, 28, 546, 328)
TOY = (0, 0, 256, 300)
GAP_PX = 4
FRAME_MS = 80
N_COLORS = 255
# How many times the toy counts beside the whole picture.
TOY_WEIGHT = 6
KMEANS_ROUNDS = 10


def beside(left, right):
    """Two pictures of one size, with a white gap between them."""
    width, height = left.size
    both = Image.new("RGB", (2 * width + GAP_PX, height), "white")
    both.paste(left, (0, 0))
    both.paste(right, (width + GAP_PX, 0))
    return both


def main():
    photograph = Image.open(PHOTOGRAPH).convert("RGB").crop(CROP)
    paths = sorted(FILM.glob("llama_*.png"))
    if not paths:
        raise SystemExit(f"{FILM} has no pictures: run the first command above")
    frames = [beside(photograph, Image.open(path).convert("RGB").crop(CROP)) for path in paths]
    # A palette of several poses serves all of them.
    samples = []
    for path in paths[:: max(1, len(paths) // 6)]:
        made = Image.open(path).convert("RGB").crop(CROP)
        samples += [made] + TOY_WEIGHT * [made.crop(TOY)]
    together = Image.new("RGB", (photograph.width, sum(sample.height for sample in samples)))
    top = 0
    for sample in samples:
        together.paste(sample.resize((photograph.width, sample.height), Image.Resampling.NEAREST), (0, top))
        top += sample.height
    palette = together.quantize(N_COLORS, method=Image.Quantize.MEDIANCUT, kmeans=KMEANS_ROUNDS)
    coded = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    coded[0].save(OUT, save_all=True, append_images=coded[1:], duration=FRAME_MS, loop=0, optimize=True)
    print(f"{OUT}: {len(frames)} frames, {OUT.stat().st_size // 1024} KiB")


if __name__ == "__main__":
    main()
