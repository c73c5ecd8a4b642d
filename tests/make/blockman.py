"""Carves a held-out toy: a stout figure of painted blocks with stiff, jointed limbs.

Object space: metres, +Y up, the figure looks along +Z and stands on y = 0.
"""
from glb import Clip, Joint, Material, write_glb
from solids import bead, checked, loft
from toy import cm, rings, turn

BOXY = 7.0  # exponent of the blocks' outlines
SIDES = {"left": 1, "right": -1}


def joints():
    """Skeleton: name, parent, place in the bind pose."""
    skeleton = [Joint("root", None, cm(0, 0, 0)), Joint("hips", "root", cm(0, 4.4, 0)), Joint("chest", "hips", cm(0, 5.6, 0)), Joint("head", "chest", cm(0, 9.2, 0))]
    for name, side in SIDES.items():
        skeleton += [Joint(f"arm_{name}", "chest", cm(side * 2.5, 8.5, 0)), Joint(f"fist_{name}", f"arm_{name}", cm(side * 3.1, 6.4, 0)),
                     Joint(f"leg_{name}", "hips", cm(side * 1.1, 4.3, 0)), Joint(f"foot_{name}", f"leg_{name}", cm(side * 1.1, 2.2, 0))]
    return skeleton


def block(material, joint, *rows):
    """Upright block through rows (x, y, z, half width, half depth) in centimetres."""
    return loft(material, rings(rows, [{joint: 1.0}] * len(rows)), 16, BOXY)


def carve():
    """All blocks."""
    parts = [
        block("teal", "hips", (0, 3.9, 0, 1.9, 1.2), (0, 4.1, 0, 2.0, 1.3), (0, 5.5, 0, 2.0, 1.3), (0, 5.6, 0, 1.9, 1.2)),
        block("coral", "chest", (0, 5.7, 0, 2.0, 1.3), (0, 5.9, 0, 2.1, 1.4), (0, 8.8, 0, 2.4, 1.5), (0, 9.0, 0, 2.2, 1.3)),
        block("beech", "head", (0, 9.2, 0, 1.2, 1.1), (0, 9.5, 0, 1.5, 1.4), (0, 11.6, 0, 1.5, 1.4), (0, 11.8, 0, 1.3, 1.2)),
        block("teal", "head", (0, 11.8, 0, 2.3, 2.2), (0, 12.0, 0, 2.3, 2.2), (0, 12.05, 0, 1.2, 1.1), (0, 13.2, 0, 1.1, 1.0)),
    ]
    for name, side in SIDES.items():
        parts += [
            bead("soot", cm(side * 0.6, 10.7, 1.4), cm(0.22, 0.26, 0.12), "head", 8),
            block("coral", f"arm_{name}", (side * 3.1, 6.5, 0, 0.6, 0.7), (side * 3.0, 7.5, 0, 0.7, 0.8), (side * 2.9, 8.8, 0, 0.6, 0.7)),
            block("beech", f"fist_{name}", (side * 3.1, 4.4, 0, 0.6, 0.7), (side * 3.1, 5.2, 0, 0.7, 0.8), (side * 3.1, 6.4, 0, 0.5, 0.6)),
            block("teal", f"leg_{name}", (side * 1.1, 2.2, 0, 0.75, 0.85), (side * 1.1, 4.2, 0, 0.85, 1.0)),
            block("soot", f"foot_{name}", (side * 1.1, 0, 0.4, 0.95, 1.5), (side * 1.1, 0.7, 0.4, 0.95, 1.4), (side * 1.1, 0.9, 0, 0.8, 0.9), (side * 1.1, 2.1, 0, 0.7, 0.8)),
        ]
    return parts


def clips():
    """"Wave": one arm goes up and over. "March": a knee and the other arm rise, the body leans."""
    def keys(*rotations):
        return [turn(**rotation) for rotation in rotations]

    return [
        Clip("Wave", [0.0, 1.0, 2.0], {
            "arm_left": keys({}, {"z": 150}, {"z": 70}), "fist_left": keys({}, {"z": 20}, {"z": 80}), "head": keys({}, {"y": 30, "z": -10}, {"y": -25}),
            "chest": keys({}, {"z": -6}, {"y": 20}), "arm_right": keys({}, {"z": -12}, {"x": -40})}),
        Clip("March", [0.0, 1.0, 2.0], {
            "leg_left": keys({}, {"x": -75}, {}), "foot_left": keys({}, {"x": 70}, {}), "arm_right": keys({}, {"x": -80}, {"x": 30}),
            "arm_left": keys({}, {"x": 40}, {"x": -60}), "chest": keys({}, {"x": 8, "y": -12}, {"x": -5}), "leg_right": keys({}, {}, {"x": -55}),
            "foot_right": keys({}, {}, {"x": 55})}),
    ]


def write(path):
    """Writes the figure as a glTF binary."""
    materials = [Material("beech", (0.7, 0.52, 0.34)), Material("coral", (0.62, 0.16, 0.1)), Material("teal", (0.06, 0.28, 0.3)), Material("soot", (0.04, 0.038, 0.036))]
    write_glb(path, checked(carve()), joints(), materials, clips())
