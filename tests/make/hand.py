"""A hand made of capsules that lies on the table: what the plate has not seen."""
import mitsuba as mi
import numpy as np

SKIN = (0.52, 0.31, 0.22)
BONES = (  # ends (x, y, z) in centimetres and radius; the fingers point along -X
    ((-2.6, 1.3, 2.2), (-7.2, 0.8, 3.2), 0.72),
    ((-3.0, 1.4, 0.8), (-8.4, 0.8, 1.0), 0.76),
    ((-3.0, 1.4, -0.7), (-8.0, 0.8, -1.0), 0.75),
    ((-2.6, 1.2, -2.0), (-6.4, 0.75, -2.9), 0.65),
    ((1.6, 1.4, 2.2), (-2.6, 0.85, 5.8), 0.84),
    ((3.0, 1.6, 1.0), (-2.4, 1.25, 2.0), 1.2),
    ((3.0, 1.7, 0.0), (-2.4, 1.35, 0.1), 1.3),
    ((3.0, 1.6, -1.0), (-2.4, 1.2, -1.7), 1.15),
    ((2.8, 1.9, 0.0), (14.0, 3.0, 0.6), 1.9),
)


def shapes(x, z, turn):
    """Mitsuba shapes of the hand with its knuckles near (x, z), turned about +Y by `turn` degrees."""
    place = mi.ScalarTransform4f().translate([x, 0.0, z]).rotate([0, 1, 0], turn).scale(0.01)
    world = np.array(place.matrix, float)
    skin = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(SKIN)}}
    out = {}
    for k, (*ends, radius) in enumerate(BONES):
        points = [(world[:3, :3] @ end + world[:3, 3]).tolist() for end in ends]
        out[f"hand_bone_{k}"] = {"type": "cylinder", "p0": points[0], "p1": points[1], "radius": radius / 100,
                                 "bsdf": {"type": "twosided", "bsdf": skin}}
        for j, point in enumerate(points):
            out[f"hand_joint_{k}_{j}"] = {"type": "sphere", "center": point, "radius": radius / 100, "bsdf": skin}
    return out
