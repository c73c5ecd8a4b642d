"""Photographs toys with Mitsuba 3 and writes `shadow-capture` folders.

usage: session.py [--variant NAME] [--light-map FILE.hdr [--spot listed|unlisted]] [--out DIR] [--spp N]
       session.py --all DIR [--held-out] [--spp N]
"""
import argparse
import json
from dataclasses import replace
from pathlib import Path

import held_out
import light_map
import setups
from mask import channels, mask_png
from photo import Photographer, Shot
from setup import EVEN, columns
from skin import Toy
from toys import toy_file

SESSIONS = Path(__file__).parent.parent / "sessions"
PLATE_SEED, FRAME_SEED, TRUTH_SEED = 1, 2, 3  # of the first of each kind
LATER_SEEDS = 100  # plate or frame k of several has its first seed + 100 k


def frame_name(setup, k):
    """Picture of frame k; they share one as long as the camera sees the same."""
    return f"frame_{k if setup.has_own_frames() else 0:04}.png"


def plate_names(setup):
    """Pictures of the plates, after their views."""
    return [f"background_{view:04}.png" for view in setup.plates]


def truth_name(setup, k):
    """A frame that shows the physical pose is its own truth."""
    return frame_name(setup, k) if setup.clips()[k] == setup.physical else f"truth_{k:04}.png"


def capture_json(setup):
    """The session's description."""
    cameras = [columns(camera) for camera in setup.cameras()]
    width, height = setup.size
    frames = []
    for k, (clip, time) in enumerate(setup.clips()):
        frames.append({"time": round(k / setup.rate, 6), "image": frame_name(setup, k), "world_from_camera": cameras[k % len(cameras)],
                       "animation": {"clip": clip, "time": time}, "truth": truth_name(setup, k), "mask": f"mask_{k:04}.png"})
    clip, time = setup.physical
    return {
        "format": "shadow-capture", "version": 1, "name": setup.name, "description": setup.description,
        "credits": "Toy, table and pictures: this project's own work (tests/make).", "units": "metre",
        "width": width, "height": height, "encoding": "srgb",
        "intrinsics": {"fx": setup.focal_px(), "fy": setup.focal_px(), "cx": width / 2, "cy": height / 2},
        "toy": {"file": "toy.glb", "world_from_object": columns(setup.world_from_object()), "physical_pose": {"clip": clip, "time": time}},
        "receivers": [surface.listing() for surface in (*setup.receivers, *(thing for thing in setup.things if thing.listed))],
        "lights": [light.listing() for light in setup.lights if light.listed],
        "backgrounds": [{"image": name, "world_from_camera": cameras[view]} for name, view in zip(plate_names(setup), setup.plates)],
        "frames": frames,
    }


def plates(setup):
    """File and shot of each plate."""
    for k, (name, view) in enumerate(zip(plate_names(setup), setup.plates)):
        gain = setup.plate_gains[k] if setup.plate_gains else EVEN
        yield name, Shot([], PLATE_SEED + LATER_SEEDS * k, view, gain=gain, is_plate=True)


def photographs(setup, toy):
    """File and shot of each frame's picture, and of its truth where the toy moved."""
    physical, views = toy.bake(*setup.physical), len(setup.cameras())
    for k, (clip, time) in enumerate(setup.clips()):
        same = {"view": k % views, "power": setup.powers[k] if setup.powers else 1.0,
                "gain": setup.frame_gains[k] if setup.frame_gains else EVEN, "with_hand": setup.hand is not None}
        if k == 0 or setup.has_own_frames():
            yield frame_name(setup, k), Shot(physical, FRAME_SEED + LATER_SEEDS * k, **same)
        if (clip, time) != setup.physical:
            yield truth_name(setup, k), Shot(toy.bake(clip, time), TRUTH_SEED + (0 if setup.same_noise else k), **same)


def masks(setup, toy, photographer, out):
    """Writes the score masks; what a camera sees of the real toy is found once."""
    physical, views = {}, len(setup.cameras())
    for k, (clip, time) in enumerate(setup.clips()):
        view = k % views
        if view not in physical:
            physical[view] = channels(setup, view, photographer.casters(toy.bake(*setup.physical)))
        posed = channels(setup, view, photographer.casters(toy.bake(clip, time)))
        mask_png(setup, posed, physical[view], out / f"mask_{k:04}.png")


def make(setup, out, spp):
    """Renders one session into the folder `out`, which gets the toy too."""
    out.mkdir(parents=True, exist_ok=True)
    toy_file(setup.toy, out / "toy.glb")
    toy = Toy(out / "toy.glb")
    toy.paint(setup.paints)
    photographer = Photographer(setup, spp)
    for name, shot in [*plates(setup), *photographs(setup, toy)]:
        photographer.shoot(shot, out / name)
    masks(setup, toy, photographer, out)
    (out / "capture.json").write_text(json.dumps(capture_json(setup), indent=1) + "\n")


def lit_by(setup, path, spot):
    """The setup in the light of a map alone; `spot` tells whether the brightest spot is a light of its own, and listed."""
    lights = (replace(light_map.spot(light_map.read(path)), listed=spot == "listed"),) if spot else ()
    return replace(setup, sky=str(path), lights=lights, description=f"{setup.description} Lit by {path.stem}.")


def make_all(wanted, folder, spp):
    """Renders each setup into `folder`/NAME unless that exists; a folder has its name only when it is whole."""
    for setup in wanted:
        if (folder / setup.name).exists():
            continue
        unfinished = folder / f".{setup.name}"
        make(setup, unfinished, spp)
        unfinished.rename(folder / setup.name)
        print(f"{setup.name}: {setup.description}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    named = {setup.name: setup for setup in (*setups.BUNDLED, *setups.SCENES, *setups.OPEN_AIR, *held_out.SCENES)}
    parser.add_argument("--variant", choices=named, default="llama")
    parser.add_argument("--light-map", type=Path, metavar="FILE.hdr", help="surroundings of all directions, instead of the variant's lights and sky")
    parser.add_argument("--spot", choices=("listed", "unlisted"), help="the map's brightest spot casts the shadow that is scored; with or without an entry in capture.json")
    parser.add_argument("--out", type=Path, help="folder to write, by default tests/sessions/VARIANT")
    parser.add_argument("--all", type=Path, metavar="DIR", help="renders all scenes into DIR/NAME, but for those that exist")
    parser.add_argument("--held-out", action="store_true", help="with --all: the scenes that nothing is tuned on")
    parser.add_argument("--spp", type=int, help="samples a pixel, in multiples of 64; by default 1024, with --all 128")
    args = parser.parse_args()
    if args.all:
        make_all(held_out.SCENES if args.held_out else setups.SCENES, args.all, args.spp or 128)
    else:
        setup = lit_by(named[args.variant], args.light_map, args.spot) if args.light_map else named[args.variant]
        make(setup, args.out or SESSIONS / args.variant, args.spp or 1024)


if __name__ == "__main__":
    main()
