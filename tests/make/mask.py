"""Score masks: where the toy covers the picture, and how much of the lights the receivers see."""
import mitsuba as mi
import numpy as np
from PIL import Image

import thing

GRID = 4  # coverage is tested at GRID x GRID places in each pixel
BULB_POINTS = 64
OUT_OF_SIGHT = 20.0  # how far a ray that misses all receivers is followed, metres


def camera_rays(setup, view, offset):
    """Origins and unit directions through each pixel at `offset` (u, v) from its corner, world space."""
    width, height = setup.size
    v, u = np.meshgrid(np.arange(height) + offset[1], np.arange(width) + offset[0], indexing="ij")
    focal, pose = setup.focal_px(), setup.cameras()[view]
    local = np.stack([(u - width / 2) / focal, (height / 2 - v) / focal, -np.ones_like(u)], -1).reshape(-1, 3)
    direction = local @ pose[:3, :3].T
    return np.broadcast_to(pose[:3, 3], direction.shape), direction / np.linalg.norm(direction, axis=1, keepdims=True)


def receiver_hits(setup, origin, direction):
    """Where the rays meet the nearest thing, or the nearest receiver from its front, and whether they do; else a point out of sight."""
    nearest = np.minimum(thing.hits([one for one in setup.things if one.in_frames], origin, direction), OUT_OF_SIGHT)
    for receiver in setup.receivers:
        plane_from_world = np.linalg.inv(receiver.world_from_plane())
        start = origin @ plane_from_world[:3, :3].T + plane_from_world[:3, 3]
        way = direction @ plane_from_world[:3, :3].T
        falling = way[:, 1] < 0
        reach = np.where(falling, -start[:, 1] / np.where(falling, way[:, 1], 1.0), -1.0)
        place = start + reach[:, None] * way
        inside = (abs(place[:, 0]) <= receiver.half_extent[0]) & (abs(place[:, 2]) <= receiver.half_extent[1])
        nearest = np.where((reach > 0) & inside & (reach < nearest), reach, nearest)
    return origin + nearest[:, None] * direction, nearest < OUT_OF_SIGHT


def blocked(scene, origin, target):
    """True where the scene lies between two points."""
    way = target - origin
    length = np.linalg.norm(way, axis=1)
    ray = mi.Ray3f(mi.Point3f(origin.T.astype(np.float32)), mi.Vector3f((way / length[:, None]).T.astype(np.float32)))
    ray.maxt = mi.Float(length.astype(np.float32))
    return np.array(scene.ray_test(ray), bool)


def coverage(setup, view, scene):
    """Pixels that the toy covers at least in part, and the pixels whose centre sees it."""
    touched = np.zeros(setup.size[0] * setup.size[1], bool)
    places = (np.arange(GRID) + 0.5) / GRID
    for offset in [(a, b) for a in places for b in places]:
        origin, direction = camera_rays(setup, view, offset)
        touched |= blocked(scene, origin, receiver_hits(setup, origin, direction)[0])
    origin, direction = camera_rays(setup, view, (0.5, 0.5))
    return touched, blocked(scene, origin, receiver_hits(setup, origin, direction)[0])


def bulb_points(light, receivers):
    """Point k of BULB_POINTS on the half of the bulb that faces each receiver, spread as its light arrives; yields [n, 3]."""
    centre, radius = light.centre(), light.radius
    towards = receivers - centre
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    side = np.cross(towards, (0.0, 0.0, 1.0))
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(towards, side)
    for k in range(BULB_POINTS):
        reach, angle = np.sqrt((k + 0.5) / BULB_POINTS), k * np.pi * (3 - np.sqrt(5))
        yield centre + radius * (reach * np.cos(angle) * side + reach * np.sin(angle) * other + np.sqrt(1 - reach**2) * towards)


def hidden_light(setup, view, scene, covered):
    """Share that the toy hides from the receivers of the light it hides most, listed or not; zero where the toy covers them.

    The toy alone hides: neither a wall, a thing nor a hand does, for none of them moves.
    """
    points, seen = receiver_hits(setup, *camera_rays(setup, view, (0.5, 0.5)))
    points = points[seen & ~covered]
    out = np.zeros(len(covered))
    for light in setup.lights:
        hits = sum(blocked(scene, points, place).astype(np.float64) for place in bulb_points(light, points))
        out[seen & ~covered] = np.maximum(out[seen & ~covered], hits / BULB_POINTS)
    return out


def channels(setup, view, scene):
    """Coverage and hidden light of one pose, 0 to 255."""
    touched, centre = coverage(setup, view, scene)
    return touched * 255.0, 255 * hidden_light(setup, view, scene, centre)


def mask_png(setup, posed, physical, path):
    """Given the `channels` of the posed and of the real toy, writes R, G: coverage with the posed and the real toy; B, A: hidden light with the posed and the real toy."""
    packed = np.round(np.stack([posed[0], physical[0], posed[1], physical[1]], -1)).astype(np.uint8)
    Image.fromarray(packed.reshape(setup.size[1], setup.size[0], 4), "RGBA").save(path, optimize=True)
