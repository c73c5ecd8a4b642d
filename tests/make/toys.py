"""The toys of the sessions, by name."""
import shutil
from pathlib import Path

import blockman
import heron
import toy
from glb import Clip, write_glb

BUNDLED = Path(__file__).parent.parent / "sessions" / "llama" / "toy.glb"


def leap():
    """"Leap": a jump of 8 cm with the feet together at its top; only the root moves."""
    heights = [0.0, 0.08, 0.0]
    still = (0.0, 0.0, 0.0, 1.0)
    return Clip("Leap", [0.0, 0.5, 1.0], {"tail": [still, toy.turn(x=30), still]}, {"root": [toy.cm(0, 100 * h, 0) for h in heights]})


def about_turn():
    """"Turn": all of the toy turns on the spot to the left, by 120 degrees in a second."""
    return Clip("Turn", [0.0, 0.5, 1.0], {"root": [toy.turn(y=angle) for angle in (0, 60, 120)]})


def more_clips(path, *clips):
    """The llama with more clips, after its own."""
    write_glb(path, toy.carve(), toy.joints(), toy.materials(), [*toy.clips(), *clips])


def toy_file(name, path):
    """Puts the toy called `name` at `path`."""
    if name == "llama":
        if path.resolve() != BUNDLED.resolve():
            shutil.copyfile(BUNDLED, path)
        return
    writers = {"leaping-llama": lambda path: more_clips(path, leap()), "turning-llama": lambda path: more_clips(path, about_turn()),
               "heron": heron.write, "blockman": blockman.write}
    writers[name](path)
