"""Carves a held-out toy: a heron with thin legs, a long neck and wings that open.

Object space: metres, +Y up, the heron looks along +Z and stands on y = 0.
"""
from glb import Clip, Joint, Material, write_glb
from solids import bead, checked, loft
from toy import cm, mix, rings, turn

NECK = [(0, 8.6, 2.4), (0, 10.6, 3.3), (0, 12.6, 2.7), (0, 14.4, 2.9)]
WINGS = {"wing_left": 1, "wing_right": -1}


def joints():
    """Skeleton: name, parent, place in the bind pose."""
    skeleton = [Joint("root", None, cm(0, 0, 0)), Joint("body", "root", cm(0, 7.0, 0))]
    parent = "body"
    for k, place in enumerate(NECK):
        name = "head" if k == 3 else f"neck_{k}"
        skeleton.append(Joint(name, parent, cm(*place)))
        parent = name
    skeleton += [Joint(name, "body", cm(side * 1.5, 8.3, 1.2)) for name, side in WINGS.items()]
    for name, side in (("leg_left", 1), ("leg_right", -1)):
        skeleton += [Joint(name, "root", cm(side * 0.9, 6.2, 0)), Joint(f"shin_{name}", name, cm(side * 0.9, 3.4, -0.5))]
    return skeleton


def trunk():
    """Body with its tail, neck, head, beak, crest and eyes."""
    body = [(0, 7.2, -4.6, 0.3, 0.12), (0, 7.3, -3.2, 1.1, 0.6), (0, 7.3, -1.4, 1.75, 1.5), (0, 7.5, 0.4, 1.8, 1.75), (0, 8.0, 1.8, 1.35, 1.4), (0, 8.5, 2.6, 0.8, 0.8)]
    neck = [(0, 8.1, 1.7, 0.85, 0.9), (0, 8.8, 2.5, 0.68, 0.7), (0, 9.7, 3.1, 0.52, 0.55), (0, 10.6, 3.3, 0.46, 0.48), (0, 11.6, 3.05, 0.42, 0.44),
            (0, 12.6, 2.75, 0.42, 0.44), (0, 13.6, 2.75, 0.45, 0.47), (0, 14.4, 2.9, 0.5, 0.52)]
    bends = [{"body": 1.0}, mix("body", "neck_0", 0.5), {"neck_0": 1.0}, mix("neck_0", "neck_1", 0.5), {"neck_1": 1.0}, mix("neck_1", "neck_2", 0.5),
             {"neck_2": 1.0}, mix("neck_2", "head", 0.5)]
    skull = [(0, 14.6, 2.2, 0.3, 0.3), (0, 14.75, 2.7, 0.66, 0.62), (0, 14.75, 3.4, 0.62, 0.58), (0, 14.6, 4.0, 0.36, 0.32)]
    beak = [(0, 14.6, 3.8, 0.34, 0.3), (0, 14.45, 5.2, 0.2, 0.18), (0, 14.3, 6.8, 0.05, 0.05)]
    crest = [(0, 15.1, 3.0, 0.3, 0.12), (0, 15.2, 1.8, 0.26, 0.12), (0, 14.8, 0.2, 0.06, 0.05)]
    head = [{"head": 1.0}] * 4
    parts = [loft("slate", rings(body, [{"body": 1.0}] * 6), 12), loft("chalk", rings(neck, bends), 8), loft("chalk", rings(skull, head), 8),
             loft("straw", rings(beak, head), 6), loft("night", rings(crest, head), 6)]
    return parts + [bead("night", cm(side * 0.6, 14.85, 3.5), cm(0.12, 0.16, 0.16), "head", 6) for side in (1, -1)]


def limbs():
    """Folded wings and thin legs."""
    parts = []
    for name, side in WINGS.items():
        wing = [(side * 1.45, 8.7, 2.0, 0.22, 0.5), (side * 1.85, 8.3, 0.9, 0.3, 1.15), (side * 1.95, 7.9, -1.2, 0.28, 1.15), (side * 1.7, 7.4, -3.4, 0.2, 0.75), (side * 1.3, 7.0, -5.4, 0.08, 0.2)]
        parts.append(loft("night", rings(wing, [{name: 1.0}] * 5), 8))
    for name, x in (("leg_left", 0.9), ("leg_right", -0.9)):
        shin = f"shin_{name}"
        leg = [(x, 6.9, 0.1, 0.5, 0.5), (x, 5.6, -0.1, 0.3, 0.32), (x, 3.9, -0.45, 0.2, 0.2), (x, 3.4, -0.5, 0.24, 0.24), (x, 2.9, -0.45, 0.17, 0.17), (x, 0.3, 0, 0.17, 0.17)]
        foot = [(x, 0.12, -1.2, 0.12, 0.1), (x, 0.16, 0, 0.4, 0.16), (x, 0.12, 1.0, 0.75, 0.12), (x, 0.1, 1.9, 0.9, 0.06)]
        bends = [{name: 1.0}, {name: 1.0}, mix(name, shin, 0.25), mix(name, shin, 0.5), mix(name, shin, 0.75), {shin: 1.0}]
        parts += [loft("straw", rings(leg, bends), 6), loft("straw", rings(foot, [{shin: 1.0}] * 4), 6)]
    return parts


def clips():
    """"Fish": the neck stretches down and forward. "Fan": the wings open, one foot lifts."""
    def keys(*rotations):
        return [turn(**rotation) for rotation in rotations]

    return [
        Clip("Fish", [0.0, 1.0, 2.0], {
            "neck_0": keys({}, {"x": 62}, {}), "neck_1": keys({}, {"x": 48}, {"z": 20}), "neck_2": keys({}, {"x": -35}, {"z": -30}),
            "head": keys({}, {"x": 10}, {"y": 50})}),
        Clip("Fan", [0.0, 1.0, 2.0], {
            "wing_left": keys({}, {"y": -55, "z": 40}, {"y": -20}), "wing_right": keys({}, {"y": 55, "z": -40}, {"y": 20}),
            "leg_left": keys({}, {"x": -70}, {}), "shin_leg_left": keys({}, {"x": 95}, {}), "neck_1": keys({}, {"x": -15}, {"z": -25})}),
    ]


def write(path):
    """Writes the heron as a glTF binary."""
    materials = [Material("slate", (0.23, 0.3, 0.38)), Material("chalk", (0.72, 0.7, 0.66)), Material("night", (0.03, 0.035, 0.05)), Material("straw", (0.72, 0.4, 0.08))]
    write_glb(path, checked(trunk() + limbs()), joints(), materials, clips())
