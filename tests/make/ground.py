"""Paints tops of tables: linear reflectance pictures that tile without a seam."""
import numpy as np


def noise(shape, correlation_px, rng):
    """Periodic Gaussian noise of unit variance; `correlation_px` are its blur radii (rows, columns)."""
    rows, columns = np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])[None, :]
    spectrum = np.fft.rfft2(rng.standard_normal(shape))
    spectrum *= np.exp(-2 * np.pi**2 * ((rows * correlation_px[0]) ** 2 + (columns * correlation_px[1]) ** 2))
    out = np.fft.irfft2(spectrum, shape)
    return (out - out.mean()) / out.std()


def wood(size=2048, planks=10, seed=7):
    """Waxed planks along the columns with soft grain and narrow joints."""
    rng = np.random.default_rng(seed)
    width = size / planks
    row = np.arange(size)[:, None]
    plank = np.minimum((row / width).astype(int), planks - 1)
    # Each plank is cut from another place of the tree, so its grain starts elsewhere along the columns.
    shifts = rng.integers(0, size, planks)
    column = (np.arange(size)[None, :] + shifts[plank]) % size
    broad, fibre, pores = (noise((size, size), radii, rng)[row, column] for radii in ((22, 110), (1.3, 22), (1.0, 9)))
    rings = np.sin(2 * np.pi * (row / width * 2.3 + 0.8 * broad + rng.random(planks)[plank]))
    tone = 1 + 0.2 * (rng.random(planks)[plank] - 0.5) + 0.05 * rings + 0.03 * fibre - 0.05 * np.clip(pores - 1.2, 0, 2)
    joint = np.minimum(row % width, width - row % width) / width
    tone = tone * (1 - 0.5 * np.exp(-((joint / 0.009) ** 2)))
    return np.clip(tone[..., None] * np.array([0.4, 0.315, 0.24]) ** (1 + 0.25 * (1 - tone[..., None])), 0.02, 0.9)


def tiles(size=1024, count=8, seed=11):
    """Glazed square tiles in two colours, each a little different, with pale joints."""
    rng = np.random.default_rng(seed)
    width = size / count
    row, column = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    i, j = (row / width).astype(int), (column / width).astype(int)
    shade = 1 + 0.1 * (rng.random((count, count))[i, j] - 0.5) + 0.03 * noise((size, size), (9, 9), rng) + 0.02 * noise((size, size), (1.5, 1.5), rng)
    colour = np.where(((i + j) % 2)[..., None] == 0, (0.62, 0.58, 0.5), (0.24, 0.34, 0.38)) * shade[..., None]
    edge = np.minimum(np.minimum(row % width, width - 1 - row % width), np.minimum(column % width, width - 1 - column % width))
    joint = np.clip(1.6 - edge / 3.0, 0, 1)[..., None]
    return np.clip(colour * (1 - joint) + 0.5 * joint, 0.02, 0.9)
