"""Surroundings from a photograph of all directions: an equirectangular Radiance file, with +Y up.

Bright spots stay in the map, where the path tracer finds them by their power.
"""
import mitsuba as mi
import numpy as np

from setup import Spot, towards

SUFFIX = ".hdr"
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
WHITE = 0.9  # reflectance of paper
SPOT_DEGREES = 5.0  # light this close to the brightest texel is the spot's
FINE = 601  # samples across a spot
N_CENTRINGS = 4


def read(path):
    """Linear radiance [rows, columns, 3], exposed for the highlights: white paper that faces the light is as bright as a picture can show.

    The map's own colour stays.
    """
    radiance = np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False), np.float64)
    way, solid_angle = directions(radiance.shape)
    light = (radiance * solid_angle[..., None]).reshape(-1, 3)
    brightest = max((np.clip(way @ facing, 0, None).ravel() @ light).max() for facing in upper_sides()) / np.pi
    return radiance / (WHITE * brightest)


def upper_sides():
    """Normals that look up, about 10 degrees apart."""
    return [towards(azimuth, elevation) for elevation in range(0, 91, 10) for azimuth in range(0, 360, 10)]


def directions(shape):
    """Unit direction and solid angle of each texel; as Mitsuba has them, the first and the last row are the poles."""
    rows, columns = shape[:2]
    polar, turn = np.meshgrid(np.arange(rows) / (rows - 1) * np.pi, (np.arange(columns) + 0.5) / columns * 2 * np.pi, indexing="ij")
    way = np.stack([np.sin(polar) * np.sin(turn), np.cos(polar), -np.sin(polar) * np.cos(turn)], -1)
    return way, np.sin(polar) * np.pi / (rows - 1) * 2 * np.pi / columns


def level(radiance, way, solid_angle):
    """Irradiance that a map of one channel brings to the table, over pi."""
    return float((radiance * np.clip(way[..., 1], 0, None) * solid_angle).sum() / np.pi)


def between_texels(radiance, way):
    """Radiance in any directions, linear between the texels of a map of one channel."""
    rows, columns = radiance.shape
    v = np.arccos(np.clip(way[..., 1], -1, 1)) / np.pi * (rows - 1)
    u = np.arctan2(way[..., 0], -way[..., 2]) / (2 * np.pi) * columns - 0.5
    i, j = np.clip(np.floor(v).astype(int), 0, rows - 2), np.floor(u).astype(int)
    v, u = v - i, u - j
    row = lambda k: (1 - u) * radiance[k, j % columns] + u * radiance[k, (j + 1) % columns]
    return (1 - v) * row(i) + v * row(i + 1)


def around(centre):
    """Directions of a square grid about a direction, and their angles from it in degrees; cells have equal solid angles but for 1 %."""
    side = np.cross(centre, (0.0, 1.0, 0.0))
    side /= np.linalg.norm(side)
    place = np.tan(np.radians(SPOT_DEGREES)) * np.linspace(-1, 1, FINE)
    x, y = np.meshgrid(place, place)
    way = centre + x[..., None] * side + y[..., None] * np.cross(side, centre)
    return way / np.linalg.norm(way, axis=-1, keepdims=True), np.degrees(np.arctan(np.hypot(x, y)))


def spot(radiance):
    """The map's brightest spot: its light's centroid, and a disc that has half of its light where the spot has half of its own.

    A disc of the same variance would be too large: a camera's glare is faint, but far from the middle.
    """
    luminance = radiance @ LUMINANCE
    way, solid_angle = directions(radiance.shape)
    centre = way.reshape(-1, 3)[luminance.argmax()]
    for _ in range(N_CENTRINGS):
        near, angle = around(centre)
        light = between_texels(luminance, near) * (angle < SPOT_DEGREES)
        centre = (near * light[..., None]).sum((0, 1))
        centre /= np.linalg.norm(centre)
    near, angle = around(centre)
    light = (between_texels(luminance, near) * (angle < SPOT_DEGREES)).ravel()
    order = np.argsort(angle.ravel())
    sums = np.cumsum(light[order])
    half = angle.ravel()[order][np.searchsorted(sums, sums[-1] / 2)]
    inside = np.degrees(np.arccos(np.clip(way @ centre, -1, 1))) < SPOT_DEGREES
    share = level(luminance * inside, way, solid_angle) / level(luminance, way, solid_angle)
    azimuth, elevation = np.degrees(np.arctan2(centre[2], centre[0])), np.degrees(np.arcsin(centre[1]))
    return Spot(float(azimuth), float(elevation), float(np.sqrt(2) * half), share)
