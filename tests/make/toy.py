"""Carves the bundled toy, a jointed wooden llama with a woven blanket, and writes it as a glTF binary.

usage: toy.py [FILE.glb]
Object space: metres, +Y up, the llama looks along +Z and stands on y = 0.
"""
import io
import sys
from pathlib import Path

import numpy as np
from PIL import Image

from glb import Clip, Joint, Material, write_glb
from solids import Ring, bead, checked, loft, saddle, superellipse

CM = 0.01
LEGS = {"front_left": (1.35, 2.35), "front_right": (-1.35, 2.35), "hind_left": (1.35, -2.75), "hind_right": (-1.35, -2.75)}
BODY_RINGS = [(-4.25, 6.35, 0.75, 0.7), (-3.95, 6.3, 1.45, 1.35), (-3.1, 6.25, 2.0, 1.85), (-1.6, 6.15, 2.15, 1.95),
              (0.0, 6.1, 2.1, 1.95), (1.6, 6.2, 2.05, 2.0), (2.9, 6.45, 1.85, 1.95), (3.75, 6.75, 1.3, 1.45), (4.05, 6.9, 0.7, 0.8)]
BODY_SIDES, BODY_EXPONENT = 14, 2.5


def cm(*values):
    """Centimetres to metres."""
    return tuple(value * CM for value in values)


def rings(rows, right_joints):
    """Rings from rows (x, y, z, half width, half height) in centimetres and one joint mix per row."""
    return [Ring(cm(*row[:3]), row[3] * CM, row[4] * CM, mix) for row, mix in zip(rows, right_joints)]


def mix(first, second, share):
    """Joint weights with `share` of the second joint."""
    return {name: weight for name, weight in ((first, 1 - share), (second, share)) if weight > 0}


def joints():
    """Skeleton: name, parent, place in the bind pose, and rotation in the authored pose (the head looks a little aside)."""
    skeleton = [
        Joint("root", None, cm(0, 0, 0)),
        Joint("body", "root", cm(0, 5.6, -2.75)),
        Joint("neck", "body", cm(0, 7.2, 2.9)),
        Joint("nape", "neck", cm(0, 9.4, 3.75), turn(y=4)),
        Joint("head", "nape", cm(0, 11.3, 4.1), turn(y=8)),
        Joint("ear_left", "head", cm(0.55, 12.2, 3.85)),
        Joint("ear_right", "head", cm(-0.55, 12.2, 3.85)),
        Joint("tail", "body", cm(0, 7.2, -4.0)),
    ]
    for name, (x, z) in LEGS.items():
        skeleton.append(Joint(f"leg_{name}", "root", cm(x, 5.4, z)))
        skeleton.append(Joint(f"shin_{name}", f"leg_{name}", cm(x, 2.7, z)))
    return skeleton


def turn(x=0.0, y=0.0, z=0.0):
    """Quaternion (x, y, z, w) of a rotation about z, then x, then y, in degrees."""
    out = np.array([0.0, 0.0, 0.0, 1.0])
    for axis, degrees in ((1, y), (0, x), (2, z)):
        step = np.zeros(4)
        step[axis], step[3] = np.sin(np.radians(degrees) / 2), np.cos(np.radians(degrees) / 2)
        vector = out[3] * step[:3] + step[3] * out[:3] + np.cross(out[:3], step[:3])
        out = np.append(vector, out[3] * step[3] - out[:3] @ step[:3])
    return tuple(out)


def trunk():
    """Body, neck and tail."""
    body = [Ring(cm(0, y, z), a * CM, b * CM, {"body": 1.0}) for z, y, a, b in BODY_RINGS]
    neck = [(0, 5.9, 2.2, 1.45, 1.5), (0, 6.9, 2.75, 1.4, 1.45), (0, 7.8, 3.15, 1.2, 1.25), (0, 8.7, 3.48, 1.02, 1.08),
            (0, 9.5, 3.72, 0.93, 0.98), (0, 10.3, 3.9, 0.88, 0.94), (0, 11.0, 4.02, 0.86, 0.95), (0, 11.6, 4.1, 0.8, 0.85)]
    bends = [mix("body", "neck", 0), mix("body", "neck", 0.25), mix("body", "neck", 0.7), mix("neck", "nape", 0.15),
             mix("neck", "nape", 0.5), mix("neck", "nape", 0.9), mix("nape", "head", 0.45), mix("nape", "head", 0.9)]
    tail = [(0, 6.9, -3.7, 0.4, 0.4), (0, 7.35, -4.3, 0.55, 0.55), (0, 7.45, -5.0, 0.72, 0.7), (0, 7.1, -5.6, 0.62, 0.6), (0, 6.6, -5.95, 0.25, 0.25)]
    sway = [{"body": 1.0}, mix("body", "tail", 0.6)] + [{"tail": 1.0}] * 3
    return [
        loft("birch", body, BODY_SIDES, BODY_EXPONENT),
        loft("birch", rings(neck, bends), 10, 2.2),
        loft("wool", rings(tail, sway), 7),
    ]


def head():
    """Head, muzzle, tuft, eyes and ears."""
    skull = [(0, 11.55, 3.1, 0.5, 0.5), (0, 11.6, 3.35, 0.85, 0.8), (0, 11.65, 3.95, 1.05, 0.98), (0, 11.6, 4.7, 0.98, 0.88), (0, 11.42, 5.35, 0.78, 0.66)]
    muzzle = [(0, 11.42, 5.2, 0.66, 0.54), (0, 11.36, 5.75, 0.68, 0.54), (0, 11.32, 6.2, 0.6, 0.46), (0, 11.3, 6.4, 0.36, 0.26)]
    tuft = [(0, 12.3, 3.05, 0.3, 0.25), (0, 12.5, 3.45, 0.66, 0.42), (0, 12.56, 4.0, 0.72, 0.45), (0, 12.42, 4.55, 0.55, 0.36), (0, 12.2, 4.85, 0.22, 0.16)]
    still = [{"head": 1.0}] * 5
    parts = [loft("birch", rings(skull, still), 10, 2.4), loft("walnut", rings(muzzle, still), 10, 2.4), loft("wool", rings(tuft, still), 7)]
    for side, name in ((1, "ear_left"), (-1, "ear_right")):
        ear = [(0.5, 12.0, 3.85, 0.22, 0.3), (0.66, 12.7, 3.8, 0.24, 0.42), (0.74, 13.35, 3.78, 0.2, 0.36), (0.72, 13.9, 3.86, 0.07, 0.12)]
        mixes = [{"head": 1.0}, mix("head", name, 0.7), {name: 1.0}, {name: 1.0}]
        parts.append(loft("birch", rings([(side * row[0], *row[1:]) for row in ear], mixes), 6))
        parts.append(bead("ink", cm(side * 0.98, 11.85, 4.5), cm(0.14, 0.2, 0.2), "head", 6))
    return parts


def leg(name, x, z):
    """One leg with a soft knee, and its hoof."""
    thigh, shin = f"leg_{name}", f"shin_{name}"
    rows = [(x, 6.9, z, 0.45, 0.6), (x, 6.4, z, 0.8, 1.05), (x, 5.4, z, 0.82, 1.1), (x, 4.3, z, 0.66, 0.82), (x, 3.3, z, 0.55, 0.62),
            (x, 2.7, z, 0.52, 0.58), (x, 2.1, z, 0.49, 0.53), (x, 0.75, z, 0.48, 0.5)]
    bends = [{thigh: 1.0}] * 4 + [mix(thigh, shin, 0.2), mix(thigh, shin, 0.5), mix(thigh, shin, 0.85), {shin: 1.0}]
    hoof = [(x, 0.85, z + 0.06, 0.53, 0.54), (x, 0.5, z + 0.06, 0.6, 0.65), (x, 0.0, z + 0.06, 0.65, 0.75)]
    return [loft("birch", rings(rows, bends), 7, 2.2), loft("walnut", rings(hoof, [{shin: 1.0}] * 3), 7, 2.2)]


def collar():
    """Ribbon around the neck with a bell."""
    rows = [(0, 8.2, 3.3, 1.22, 1.28), (0, 8.32, 3.34, 1.3, 1.36), (0, 8.56, 3.43, 1.26, 1.32), (0, 8.66, 3.47, 1.14, 1.2)]
    return [loft("madder", rings(rows, [mix("body", "neck", 0.93)] * 4), 10, 2.2), bead("brass", cm(0, 7.9, 4.72), cm(0.36, 0.4, 0.36), "neck", 6)]


def blanket():
    """Woven blanket over the back: a thin sheet that follows the body's cross-sections."""
    stations = np.array([-2.3, -1.55, -0.8, 0.0, 0.8, 1.5])
    table = np.array(BODY_RINGS)
    y, a, b = (np.interp(stations, table[:, 0], table[:, k]) for k in (1, 2, 3))
    outline = superellipse(BODY_SIDES, BODY_EXPONENT)
    arc = outline[np.argsort(np.arctan2(outline[:, 0], outline[:, 1]))]
    arc = arc[arc[:, 1] > -0.6]

    def sheet(gap):
        x = arc[None, :, 0] * (a[:, None] + gap)
        height = y[:, None] + arc[None, :, 1] * (b[:, None] + gap)
        return np.stack([x, height, np.broadcast_to(stations[:, None], x.shape)], -1) * CM

    return [saddle("weave", sheet(0.2), sheet(0.03), "body")]


def weave_png(size=96):
    """Paints the blanket's pattern: stripes along the llama with rows of diamonds, sRGB."""
    cream, madder, indigo, ochre = (236, 222, 190), (176, 58, 44), (38, 66, 104), (222, 158, 54)
    v, u = np.meshgrid((np.arange(size) + 0.5) / size, (np.arange(size) + 0.5) / size, indexing="ij")
    image = np.empty((size, size, 3))
    image[:] = madder
    across = abs(u - 0.5)
    stripes = ((0.0, 0.13, indigo), (0.13, 0.155, cream), (0.2, 0.24, ochre), (0.3, 0.325, cream), (0.325, 0.44, indigo), (0.44, 0.465, cream))
    for low, high, colour in stripes:
        image[(across >= low) & (across < high)] = colour
    for centre, half, colour, count in ((0.0, 0.09, ochre, 5), (0.0, 0.04, cream, 5), (0.383, 0.045, ochre, 8)):
        diamond = abs(across - centre) / half + abs((v * count) % 1 - 0.5) / 0.42
        image[diamond < 1] = colour
    image[(v < 0.07) | (v > 0.93)] = cream
    thread = 1 - 0.06 * ((np.indices((size, size)).sum(0)) % 2)
    packed = io.BytesIO()
    Image.fromarray(np.round(image * thread[..., None]).astype(np.uint8)).save(packed, "PNG", optimize=True)
    return packed.getvalue()


def clips():
    """"Look": the neck bends and the head turns, the tail wags. "Step": a front leg lifts and the body leans back."""
    look = [0.0, 0.6, 1.2, 1.8, 2.4]
    step = [0.0, 0.5, 0.8, 1.0, 1.3, 1.6]

    def keys(*rotations):
        return [turn(**rotation) for rotation in rotations]

    rest_nape, rest_head = {"y": 4}, {"y": 8}
    return [
        Clip("Look", look, {
            "neck": keys({}, {"x": -6, "z": -16}, {"x": 10, "y": 6}, {"x": 34, "z": 12}, {}),
            "nape": keys(rest_nape, {"y": 30, "z": -8}, {"x": 4}, {"x": 22, "y": -22}, rest_nape),
            "head": keys(rest_head, {"x": -8, "y": 36, "z": -6}, {"y": 4}, {"x": 16, "y": -26}, rest_head),
            "ear_left": keys({}, {"z": -14}, {}, {"x": -30}, {}),
            "ear_right": keys({}, {"z": 24}, {}, {"x": -24, "z": 10}, {}),
            "tail": keys({}, {"y": 34}, {"y": -34}, {"y": 30, "x": 14}, {}),
        }),
        Clip("Step", step, {
            "leg_front_left": keys({}, {"x": -62}, {"x": -44}, {}, {}, {}),
            "shin_front_left": keys({}, {"x": 74}, {"x": 38}, {}, {}, {}),
            "leg_front_right": keys({}, {}, {}, {}, {"x": -52}, {}),
            "shin_front_right": keys({}, {}, {}, {}, {"x": 70}, {}),
            "body": keys({}, {"x": -6, "z": 3}, {"x": -8, "z": 3}, {"x": -3}, {"x": -6, "z": -3}, {}),
            "neck": keys({}, {"x": -10}, {"x": -16, "z": -8}, {"x": 4}, {"x": 16, "z": 10}, {}),
            "nape": keys(rest_nape, {"x": 6, "y": -10}, {"x": 10, "y": 14}, {"y": 8}, {"x": 12, "z": 6}, rest_nape),
            "head": keys(rest_head, {"x": 14, "y": -14}, {"x": 8, "y": 22}, {"y": 14}, {"x": 6, "y": 12}, rest_head),
            "tail": keys({}, {"x": 34}, {"x": 20, "y": 24}, {"x": 10}, {"x": 30, "y": -20}, {}),
        }, moves={"body": [cm(0, 5.6, -2.75), cm(0.1, 5.5, -2.95), cm(0.15, 5.45, -3.05), cm(0, 5.55, -2.85), cm(-0.1, 5.5, -2.9), cm(0, 5.6, -2.75)]}),
    ]


def materials():
    """Linear base colours; all of them matt."""
    return [
        Material("birch", (0.68, 0.5, 0.3)),
        Material("walnut", (0.15, 0.072, 0.04)),
        Material("wool", (0.66, 0.61, 0.53)),
        Material("ink", (0.025, 0.022, 0.02)),
        Material("madder", (0.5, 0.07, 0.05)),
        Material("brass", (0.66, 0.42, 0.1)),
        Material("weave", (0.95, 0.95, 0.95), weave_png()),
    ]


def carve():
    """All solids of the toy, each closed."""
    solids = trunk() + head() + collar() + blanket()
    for name, (x, z) in LEGS.items():
        solids += leg(name, x, z)
    return checked(solids)


def main():
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent.parent / "sessions" / "llama" / "toy.glb"
    out.parent.mkdir(parents=True, exist_ok=True)
    solids = carve()
    write_glb(out, solids, joints(), materials(), clips())
    print(f"{out}: {sum(len(s.triangles) for s in solids)} triangles, {out.stat().st_size} bytes")


if __name__ == "__main__":
    main()
