"""Paints surroundings as equirectangular radiance maps, with +Y up."""
import numpy as np

import light_map
from setup import COOL, Glow, towards

ROWS = 256


def directions():
    """Unit direction through each texel; Mitsuba's u runs from -Z over +X."""
    polar, turn = np.meshgrid((np.arange(ROWS) + 0.5) / ROWS * np.pi, (np.arange(2 * ROWS) + 0.5) / ROWS * np.pi, indexing="ij")
    return np.stack([np.sin(polar) * np.sin(turn), np.cos(polar), -np.sin(polar) * np.cos(turn)], -1)


def level(radiance, way):
    """Irradiance that a map of one channel brings to the table, over pi."""
    texel = np.sqrt(np.clip(1 - way[..., 1] ** 2, 0, 1)) * (np.pi / ROWS) ** 2
    return float((radiance * np.clip(way[..., 1], 0, None) * texel).sum() / np.pi)


def lobe(way, azimuth, elevation, deviation):
    """Gaussian of the angle from a direction, `deviation` in degrees per axis."""
    angle = np.arccos(np.clip(way @ towards(azimuth, elevation), -1, 1))
    return np.exp(-0.5 * (angle / np.radians(deviation)) ** 2)


def window(way):
    """A pale room with one very wide bright side and a darker floor."""
    return 0.35 + 0.25 * way[..., 1] + 1.1 * lobe(way, 115.0, 35.0, 48.0)


def overcast(way):
    """Cloud cover: three times brighter overhead than at the horizon, a little brighter on one side."""
    return (1 + 2 * np.clip(way[..., 1], 0, None)) / 3 + 0.12 * way[..., 0]


def paint(setup):
    """Radiance map [rows, 2 rows, 3] of the setup's sky and its glowing lobes, as shares of a plate's level of 1."""
    if setup.sky.endswith(light_map.SUFFIX):
        return light_map.read(setup.sky)
    way = directions()
    broad = {"window": window, "overcast": overcast}[setup.sky](way)
    rest = 1 - sum(light.share for light in setup.lights)
    out = (rest / level(broad, way) * broad)[..., None] * COOL
    for light in setup.lights:
        if isinstance(light, Glow):
            shape = lobe(way, light.azimuth, light.elevation, light.angular_radius / 2)
            out = out + (light.share / level(shape, way) * shape)[..., None] * np.array(light.colour)
    return out
