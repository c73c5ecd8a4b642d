"""The sessions to tune on: the bundled one with its variants, and one scene for each thing that the method must cope with."""
from dataclasses import replace

from setup import LOOKS, Bulb, Glow, Receiver, Setup, Sun, gains, orbit
from thing import Thing

WOOD, TILES = Receiver(), Receiver(surface="tiles", tile=0.4)
UNIFORM, PATCHES = Receiver(surface="uniform"), Receiver(surface="patchwork", tile=0.4)
THREE, TWO = (("Look", 0.6), ("Look", 1.8), ("Step", 0.5)), (("Look", 1.8), ("Step", 0.5))
HD = {"size": (1280, 720), "poses": THREE, "ends_in_physical_pose": False}

BUNDLED = (
    Setup("llama", "A jointed wooden llama on waxed planks under one frosted bulb, fixed camera."),
    Setup("bulb-uniform", "One small bulb, hard shadow, uniform table, fixed camera.", lights=(Bulb(radius=0.006),), receivers=(UNIFORM,), **HD),
    Setup("area-wood", "One large lamp, wide penumbra, wooden table, fixed camera.", lights=(Bulb(radius=0.07),), **HD),
    Setup("bulb-tiles", "One small bulb, tiles, another side of the toy, fixed camera.",
          eye=(-0.13, 0.26, 0.33), target=(-0.01, 0.05, 0.025), yaw=38.0, lights=(Bulb(330.0, 55.0, radius=0.01),), receivers=(TILES,), **HD),
)


def scene(name, description, **changes):
    """A small session that never shows the physical pose."""
    return Setup(name, description, **{"poses": THREE, "ends_in_physical_pose": False} | changes)


AMBER, BLUE, GREEN, ROSE = (1.25, 0.92, 0.55), (0.7, 0.95, 1.4), (0.8, 1.12, 0.75), (1.2, 0.8, 1.0)
WALL_VIEW = {"eye": (0.075, 0.175, 0.33), "target": (-0.025, 0.055, -0.02), "lights": (Bulb(52.0, 38.0, radius=0.01),), "yaw": -30.0, "effort": 2}
BACK_WALL = Receiver("wall", "uniform", half_extent=(0.6, 0.4), tint=(0.85, 0.87, 0.9), upright=True, place=(0.0, -0.115))
TURNED_WALL = Receiver("wall", "uniform", half_extent=(0.065, 0.05), tint=(0.75, 0.3, 0.22), upright=True, place=(-0.075, -0.085), turn=30.0)
ARC = orbit(6, 120.0, 55.0)
ORBIT = {"views": ARC, "receivers": (TILES,), "lights": (Bulb(200.0, 50.0, radius=0.012),),
         "poses": (("Look", 0.3), ("Look", 0.6), ("Look", 1.2), ("Look", 1.8), ("Step", 0.5), ("Step", 1.25)), "yaw": -20.0}
CALM = tuple(("Look", round(0.3 + k / 60, 6)) for k in range(12))

NEEDED_FIRST = (
    scene("wall", "A bulb that casts the shadow over the table and a wall behind the toy, fixed camera.", receivers=(UNIFORM, BACK_WALL), **WALL_VIEW),
    scene("orbit", "A camera that moves around the toy; tiles; plates from three of its six views.", plates=(0, 3, 5), **ORBIT),
    scene("two-lights-apart", "Two bulbs of unlike colour, size and distance. The toy was photographed in the air with its shadows apart; in the shown poses they overlap.",
          toy="leaping-llama", physical=("Leap", 0.5), poses=(("Leap", 0.0), ("Look", 1.8), ("Leap", 0.12)), eye=(-0.02, 0.34, 0.42), target=(-0.02, 0.05, -0.045), yaw=-60.0,
          lights=(Bulb(122.0, 58.0, 0.9, 0.012, 0.35, AMBER), Bulb(28.0, 52.0, 1.3, 0.035, 0.3, BLUE)), receivers=(TILES,)),
    scene("plate-exposed", "The plate was taken with another exposure and white balance than the frames.", plate_gains=((1.22, 1.04, 0.86),)),
    scene("no-plate", "No photograph of the table without the toy.", plates=()),
    scene("orbit-exposure", "A moving camera; each plate and frame has its own exposure and white balance.", plates=(0, 5),
          plate_gains=gains(2, 5), frame_gains=gains(6, 6), **ORBIT),
    scene("intruder", "A hand that the plate has not seen lies on the table, partly in the toy's shadow.", hand=(0.17, 0.045, -20.0),
          eye=(0.07, 0.26, 0.36), target=(0.07, 0.035, 0.0)),
    scene("environment-lobe", "A room with one dominant bright lobe, listed as a light, and broad uneven surroundings.", sky="window",
          lights=(Glow(186.0, 48.0, 14.0, 0.5),), effort=4),
)

RADII = tuple(
    scene(f"radius-{radius:g}".replace("0.", "0"), f"One bulb of radius {radius:g} m, a step of a progression.", poses=TWO,
          lights=(Bulb(radius=radius),), receivers=(UNIFORM,))
    for radius in (0.0, 0.01, 0.03, 0.07, 0.12))

REST = (
    scene("low-sun", "A low directional light with an angular radius of 5 degrees: penumbras are ellipses.", eye=(0.07, 0.28, 0.4), target=(0.08, 0.02, -0.01),
          lights=(Sun(192.0, 25.0, 5.0),)),
    scene("unlisted-light", "A second bulb that is not listed.", lights=(Bulb(share=0.4), Bulb(75.0, 50.0, 0.9, 0.012, 0.25, AMBER, listed=False)),
          eye=(0.03, 0.26, 0.36), target=(0.026, 0.04, -0.02)),
    scene("calm", "Twelve frames at 60 a second, fixed camera.", poses=CALM, rate=60.0, same_noise=True, receivers=(TILES,)),
    scene("light-change", "The bulb's power changes between frames; the plate saw it at 1.", poses=LOOKS, powers=(1.0, 1.0, 1.5, 0.6)),
    scene("wall-turned", "A small red wall, turned 30 degrees, that clips the shadow.", receivers=(WOOD, TURNED_WALL), **WALL_VIEW),
    scene("four-lights", "Four bulbs of unlike colour, size and distance whose shadows overlap.", eye=(0.0, 0.28, 0.36), target=(0.0, 0.04, -0.01), yaw=-40.0,
          lights=(Bulb(186.0, 47.0, 1.0, 0.015, 0.25, AMBER), Bulb(250.0, 55.0, 0.8, 0.03, 0.18, BLUE),
                  Bulb(75.0, 50.0, 1.3, 0.008, 0.18, GREEN), Bulb(330.0, 60.0, 1.1, 0.05, 0.15, ROSE))),
    scene("patches", "A table of saturated patches from nearly black to nearly white.", receivers=(PATCHES,)),
    scene("lifted", "The toy hangs 4 cm above the table.", lift=0.04, eye=(0.05, 0.26, 0.39), target=(0.05, 0.065, 0.0)),
    scene("environment-even", "Broad uneven surroundings, no dominant light: none is listed.", sky="overcast", lights=(), effort=4),
    scene("contact", "A foot leaves the table; the surroundings give most of the light.", lights=(Bulb(share=0.3),),
          poses=(("Step", 0.25), ("Step", 0.5), ("Step", 1.3)), eye=(-0.06, 0.17, 0.33), target=(0.0, 0.05, 0.0)),
    scene("repainted", "The real toy's paints are faded and tinted against its file's; the shown poses turn up sides that the camera has not seen.", toy="turning-llama",
          poses=(("Turn", 0.4), ("Turn", 1.0), ("Look", 1.8)),
          paints=((0.8, 0.62, 0.5), (1.6, 1.4, 1.1), (0.7, 0.8, 0.95), (1.0, 1.0, 1.0), (0.65, 1.5, 1.2), (0.8, 0.9, 1.2), (0.55, 0.7, 0.85))),
    scene("orbit-calm", "Twelve frames of a slowly moving camera; the shown pose stays the same.", views=orbit(12, 96.0, 90.0), plates=(0, 11),
          poses=(("Look", 1.8),) * 12, rate=60.0, receivers=(TILES,)),
)

OPEN_AIR = (  # for light maps: a light map is sampled less well than a lamp
    scene("open-air-llama", "A llama on wood in the open.", sky="overcast", lights=(), effort=4, yaw=14.0, eye=(0.39, 0.28, 0.1), target=(0.025, 0.02, -0.07)),
    scene("open-air-heron", "A heron on tiles in the open.", toy="heron", sky="overcast", lights=(), effort=4, yaw=75.0, receivers=(TILES,), poses=(("Fish", 1.0), ("Fan", 1.0), ("Fish", 1.8)),
          eye=(-0.1, 0.33, 0.4), target=(0.04, 0.03, -0.04)),
)

BESIDE = {"eye": (0.07, 0.26, 0.36), "target": (0.06, 0.04, 0.0)}  # shows what stands in the shadow
BOOK = Thing(size=(0.12, 0.018, 0.16), place=(0.125, 0.01), turn=12.0, tint=(1.1, 0.75, 0.55))
RAMP = Thing("ramp", size=(0.14, 0.035, 0.14), place=(0.125, 0.0), turn=8.0, surface="wood", tile=0.4)
THINGS = (
    scene("book", "The shadow falls on a book.", things=(BOOK,), **BESIDE),
    scene("book-listed", "The same; the book's top is listed.", things=(replace(BOOK, listed=True),), **BESIDE),
    scene("ramp", "The shadow falls on a ramp.", things=(RAMP,), **BESIDE),
    scene("ramp-listed", "The same; the ramp's top is listed.", things=(replace(RAMP, listed=True),), **BESIDE),
    scene("white-cup", "The shadow falls on a white cup.", things=(Thing("cup", (0.07, 0.08, 0.07), (0.11, 0.0), tint=(1.5, 1.5, 1.5)),), **BESIDE),
    scene("post", "A post before the toy.", things=(Thing(size=(0.015, 0.1, 0.015), place=(0.045, 0.05), turn=20.0, tint=(0.5, 0.7, 1.2)),), **BESIDE),
    scene("moved-box", "A box that the plate shows and the frames do not.", things=(Thing(size=(0.05, 0.04, 0.05), place=(0.12, 0.02), in_frames=False),), **BESIDE),
)

SCENES = (*NEEDED_FIRST, *RADII, *REST, *THINGS)
