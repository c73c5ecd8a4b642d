"""Score masks: where the toy covers the picture, and how much of the bulb the table sees."""
import mitsuba as mi
import numpy as np
from PIL import Image

GRID = 4  # coverage is tested at GRID x GRID places in each pixel
BULB_POINTS = 64


def camera_rays(setup, offset):
    """Origins and unit directions through each pixel at `offset` (u, v) from its corner, world space."""
    width, height = setup.size
    v, u = np.meshgrid(np.arange(height) + offset[1], np.arange(width) + offset[0], indexing="ij")
    focal, pose = setup.focal_px(), setup.world_from_camera()
    local = np.stack([(u - width / 2) / focal, (height / 2 - v) / focal, -np.ones_like(u)], -1).reshape(-1, 3)
    direction = local @ pose[:3, :3].T
    return np.broadcast_to(pose[:3, 3], direction.shape), direction / np.linalg.norm(direction, axis=1, keepdims=True)


def table_hits(origin, direction):
    """Where the rays meet y = 0; the camera looks down on all of the picture."""
    return origin - direction * (origin[:, 1:2] / direction[:, 1:2])


def blocked(scene, origin, target):
    """True where the scene lies between two points."""
    way = target - origin
    length = np.linalg.norm(way, axis=1)
    ray = mi.Ray3f(mi.Point3f(origin.T.astype(np.float32)), mi.Vector3f((way / length[:, None]).T.astype(np.float32)))
    ray.maxt = mi.Float(length.astype(np.float32))
    return np.array(scene.ray_test(ray), bool)


def coverage(setup, scene):
    """Pixels that the toy covers at least in part, and the pixels whose centre sees it."""
    touched = np.zeros(setup.size[0] * setup.size[1], bool)
    places = (np.arange(GRID) + 0.5) / GRID
    for offset in [(a, b) for a in places for b in places]:
        origin, direction = camera_rays(setup, offset)
        touched |= blocked(scene, origin, table_hits(origin, direction))
    origin, direction = camera_rays(setup, (0.5, 0.5))
    return touched, blocked(scene, origin, table_hits(origin, direction))


def bulb_points(setup, receivers):
    """Point k of BULB_POINTS on the half of the bulb that faces each receiver, spread as its light arrives; yields [n, 3]."""
    centre, radius = setup.light_position(), setup.light_radius
    towards = receivers - centre
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    side = np.cross(towards, (0.0, 0.0, 1.0))
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(towards, side)
    for k in range(BULB_POINTS):
        reach, angle = np.sqrt((k + 0.5) / BULB_POINTS), k * np.pi * (3 - np.sqrt(5))
        yield centre + radius * (reach * np.cos(angle) * side + reach * np.sin(angle) * other + np.sqrt(1 - reach**2) * towards)


def hidden_light(setup, scene, covered):
    """Share of the bulb that the toy hides from the table, zero where the toy covers the table."""
    points = table_hits(*camera_rays(setup, (0.5, 0.5)))
    hits = sum(blocked(scene, points, light).astype(np.float64) for light in bulb_points(setup, points))
    return np.where(covered, 0.0, hits / BULB_POINTS)


def mask_png(setup, posed, physical, path):
    """Given the meshes of the posed and of the real toy, writes R, G: coverage with the posed and the real toy; B, A: hidden light with the posed and the real toy."""
    channels = []
    shown = [coverage(setup, scene) for scene in (posed, physical)]
    channels += [touched * 255.0 for touched, _ in shown]
    channels += [255 * hidden_light(setup, scene, centre) for scene, (_, centre) in zip((posed, physical), shown)]
    packed = np.round(np.stack(channels, -1)).astype(np.uint8).reshape(setup.size[1], setup.size[0], 4)
    Image.fromarray(packed, "RGBA").save(path, optimize=True)
