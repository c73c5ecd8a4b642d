"""Sessions that nothing is tuned on: other toys, angles, lights and tables, several difficulties at once."""
from setup import Bulb, Receiver, Sun, gains, orbit
from setups import scene

TERRAZZO, CLOTH = Receiver(surface="terrazzo", tile=0.35), Receiver(surface="gingham", tile=0.24)
PLANKS = Receiver(tile=0.7, tint=(0.8, 0.62, 0.5))
SCREEN = Receiver("screen", "gingham", tile=0.3, half_extent=(0.13, 0.07), tint=(0.9, 1.0, 0.8), upright=True, place=(0.05, -0.1), turn=-18.0)
FISH_AND_FAN = (("Fish", 1.0), ("Fan", 1.0), ("Fish", 1.8))
WAVE_AND_MARCH = (("Wave", 0.8), ("March", 1.0), ("Wave", 1.7))

SCENES = (
    scene("held-1", "A heron on terrazzo under two bulbs, fixed camera.", toy="heron", receivers=(TERRAZZO,), poses=FISH_AND_FAN, yaw=140.0,
          eye=(-0.08, 0.27, -0.37), target=(0.0, 0.055, 0.02), lights=(Bulb(20.0, 52.0, 0.8, 0.02, 0.36, (1.1, 1.0, 0.85)), Bulb(285.0, 60.0, 1.2, 0.008, 0.24, (0.85, 1.0, 1.2)))),
    scene("held-2", "A figure of blocks before a checked screen in a low sun; the plate's exposure differs.", toy="blockman", receivers=(PLANKS, SCREEN),
          poses=WAVE_AND_MARCH, yaw=65.0, eye=(0.03, 0.2, 0.42), target=(0.02, 0.05, -0.02), lights=(Sun(115.0, 30.0, 3.0, 0.65),), plate_gains=((0.86, 0.95, 1.05),)),
    scene("held-3", "A moving camera around a heron on cloth; exposures drift; two plates.", toy="heron", receivers=(CLOTH,),
          poses=(("Fan", 0.75), ("Fan", 1.0), ("Fish", 0.6), ("Fish", 1.8)), yaw=-110.0, lights=(Bulb(310.0, 44.0, 0.7, 0.03, 0.5),),
          views=orbit(4, 200.0, 245.0, reach=0.37, height=0.25), plates=(0, 3), plate_gains=gains(2, 17), frame_gains=gains(4, 18)),
    scene("held-4", "A figure of blocks 2 cm above terrazzo under a large lamp, with a hand on the table; no plate.", toy="blockman", receivers=(TERRAZZO,), lift=0.02,
          poses=WAVE_AND_MARCH, yaw=-15.0, eye=(0.12, 0.26, 0.36), target=(0.055, 0.04, 0.0), lights=(Bulb(160.0, 50.0, 0.9, 0.05, 0.55),), hand=(-0.15, 0.06, 195.0), plates=()),
)
