"""Closed faceted solids with joint weights: the pieces that the toy is carved from.

Lengths are metres. Faces wind counter-clockwise seen from outside.
"""
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Ring:
    """One cross-section of a loft, lying across the spine."""

    centre: tuple
    half_width: float
    half_height: float
    joints: dict  # joint name -> weight; the weights add up to 1


@dataclass
class Solid:
    """Indexed triangles; each vertex carries its joints, and a texture place where the material needs one."""

    material: str
    positions: np.ndarray
    triangles: np.ndarray
    joints: list
    uv: np.ndarray | None = field(default=None)


def superellipse(sides, exponent):
    """Closed curve of `sides` points; exponent 2 is an ellipse, more is boxier."""
    angle = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([np.sign(cos) * abs(cos) ** (2 / exponent), np.sign(sin) * abs(sin) ** (2 / exponent)], axis=1)


def strip(rings, sides):
    """Triangles of the tube through `rings` loops of `sides` vertices each."""
    i, j = np.meshgrid(np.arange(rings - 1), np.arange(sides), indexing="ij")
    a, b = i * sides + j, i * sides + (j + 1) % sides
    return np.concatenate([np.stack([a, b, b + sides], -1).reshape(-1, 3), np.stack([a, b + sides, a + sides], -1).reshape(-1, 3)])


def loft(material, rings, sides=10, exponent=2.0, right=(1.0, 0.0, 0.0)):
    """Tube through `rings`, closed by flat ends; `right` is the direction of the half widths."""
    centres = np.array([ring.centre for ring in rings], float)
    tangents = np.gradient(centres, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    right = np.asarray(right, float)
    outline = superellipse(sides, exponent)
    loops = []
    for ring, centre, tangent in zip(rings, centres, tangents):
        across = right - tangent * (right @ tangent)
        across /= np.linalg.norm(across)
        up = np.cross(tangent, across)
        loops.append(centre + outline[:, :1] * ring.half_width * across + outline[:, 1:] * ring.half_height * up)
    last = len(rings) * sides
    around, after = np.arange(sides), (np.arange(sides) + 1) % sides
    start = np.stack([np.full(sides, last), after, around], -1)
    end = np.stack([np.full(sides, last + 1), last - sides + around, last - sides + after], -1)
    return Solid(
        material,
        np.concatenate(loops + [centres[:1], centres[-1:]]),
        np.concatenate([strip(len(rings), sides), start, end]),
        [ring.joints for ring in rings for _ in range(sides)] + [rings[0].joints, rings[-1].joints],
    )


def bead(material, centre, radii, joint, sides=8):
    """Ellipsoid with its poles along x; `radii` are (x, y, z)."""
    rings = []
    for angle in np.radians([-78, -40, 0, 40, 78]):
        shrink = np.cos(angle)
        place = (centre[0] + radii[0] * np.sin(angle), centre[1], centre[2])
        rings.append(Ring(place, radii[2] * shrink, radii[1] * shrink, {joint: 1.0}))
    return loft(material, rings, sides, right=(0.0, 0.0, 1.0))


def saddle(material, outer, inner, joint):
    """Thin closed sheet between two grids of points [along, across, 3] of the same shape."""
    along, across = outer.shape[:2]
    count = along * across
    grid = np.arange(count).reshape(along, across)
    a, b, c, d = grid[:-1, :-1].ravel(), grid[1:, :-1].ravel(), grid[1:, 1:].ravel(), grid[:-1, 1:].ravel()
    top = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    border = np.concatenate([grid[:-1, 0], grid[-1, :-1], grid[:0:-1, -1], grid[0, :0:-1]])
    following = np.roll(border, -1)
    rim = np.concatenate([np.stack([following, border, border + count], -1), np.stack([following, border + count, following + count], -1)])
    v, u = np.meshgrid(np.linspace(0, 1, along), np.linspace(0, 1, across), indexing="ij")
    uv = np.stack([u, v], -1).reshape(-1, 2)
    return Solid(
        material,
        np.concatenate([outer.reshape(-1, 3), inner.reshape(-1, 3)]),
        np.concatenate([top, top[:, ::-1] + count, rim]),
        [{joint: 1.0}] * (2 * count),
        np.concatenate([uv, uv]),
    )


def signed_volume(solid):
    """Volume enclosed, cubic metres; positive when the faces wind outwards."""
    a, b, c = (solid.positions[solid.triangles[:, k]] for k in range(3))
    return float((np.cross(a, b) * c).sum() / 6)


def is_closed(solid):
    """True when each edge belongs to two faces that run along it in opposite directions."""
    edges = {}
    for triangle in solid.triangles.tolist():
        for start, end in zip(triangle, triangle[1:] + triangle[:1]):
            edges[start, end] = edges.get((start, end), 0) + 1
    return all(count == 1 and edges.get((end, start)) == 1 for (start, end), count in edges.items())


def checked(solids):
    """The solids, once each is known to be closed with outward faces and the lowest stands on y = 0."""
    for solid in solids:
        assert is_closed(solid) and signed_volume(solid) > 0, f"{solid.material}: not a closed solid with outward faces"
    assert min(solid.positions[:, 1].min() for solid in solids) == 0.0, "the feet are not on y = 0"
    return solids
