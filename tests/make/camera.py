"""Develops a session's photographs as a camera would have: soft, sharpened, compressed, or as a phone gives them.

usage: camera.py SESSION OUT --as defocus|soft|sharp|jpeg|phone

Truths and masks are copied as they are: alignment is judged by the pose that capture.json has, pictures by an ideal camera's.
"""
import argparse
import io
import json
import shutil
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter

from photo import linear, srgb

JPEG_QUALITY = 90
SHARPENED_PX, SHARPENED_BY = 1.2, 0.7  # unsharp mask on luma codes
LUMA = np.array([0.2126, 0.7152, 0.0722])


def spread(light, deviation_px):
    """Out of focus: a Gaussian in linear light."""
    return gaussian_filter(light, (deviation_px, deviation_px, 0))


def sharpened(codes):
    """Unsharp mask."""
    luma = codes @ LUMA
    return np.clip(codes + SHARPENED_BY * (luma - gaussian_filter(luma, SHARPENED_PX))[..., None], 0, 255)


def compressed(codes):
    """There and back by JPEG."""
    file = io.BytesIO()
    Image.fromarray(np.uint8(np.round(codes))).save(file, "JPEG", quality=JPEG_QUALITY)
    return np.asarray(Image.open(file).convert("RGB"), float)


def vignetted(light):
    """A fifth less in the corners."""
    height, width, _ = light.shape
    y, x = np.mgrid[:height, :width]
    square = ((x - width / 2) ** 2 + (y - height / 2) ** 2) / ((width / 2) ** 2 + (height / 2) ** 2)
    return light * (1 - 0.2 * square)[..., None]


def filmic(light):
    """A tone curve with toe and shoulder. Source: Narkowicz 2015, at .6 of the exposure."""
    light = 0.6 * light
    return np.clip(light * (2.51 * light + 0.03) / (light * (2.43 * light + 0.59) + 0.14), 0, 1)


def phone(codes, seed):
    """Vignette, noise of sensor and photons, tone curve, sharpening, JPEG."""
    light = vignetted(linear(codes))
    noise = np.random.default_rng(seed).normal(size=light.shape)
    light = light + noise * np.sqrt(1e-5 + 2e-4 * np.clip(light, 0, 1))
    return compressed(sharpened(srgb(filmic(np.clip(light, 0, None))).astype(float)))


def developed(codes, kind, seed, is_plate):
    """A photograph's codes by a kind of camera; out of focus is the toy alone, the plate was sharp."""
    match kind:
        case "defocus":
            return codes if is_plate else srgb(spread(linear(codes), 2.0))
        case "soft":
            return srgb(spread(linear(codes), 0.8))
        case "sharp":
            return sharpened(codes)
        case "jpeg":
            return compressed(codes)
        case "phone":
            return phone(codes, seed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("session", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--as", dest="kind", required=True, choices=("defocus", "soft", "sharp", "jpeg", "phone"))
    args = parser.parse_args()
    shutil.copytree(args.session, args.out)
    capture = json.loads((args.out / "capture.json").read_text())
    plates = {plate["image"] for plate in capture["backgrounds"]}
    for seed, name in enumerate(sorted(plates | {frame["image"] for frame in capture["frames"]})):
        codes = np.asarray(Image.open(args.session / name).convert("RGB"), float)
        pixels = np.uint8(np.round(developed(codes, args.kind, seed, name in plates)))
        Image.fromarray(pixels).save(args.out / name, optimize=True)


if __name__ == "__main__":
    main()
