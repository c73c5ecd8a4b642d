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


def patchwork(size=1024, count=10, seed=23):
    """Patches of saturated hues from nearly black (0.005) to nearly white (0.9), each with threads of another shade."""
    rng = np.random.default_rng(seed)
    row, column = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    i, j = row * count // size, column * count // size
    tone = np.exp(rng.uniform(np.log(0.005), np.log(0.9), (count, count)))[i, j]
    hue = rng.random((count, count))[i, j]
    weights = 0.5 + 0.5 * np.cos(2 * np.pi * (hue[..., None] - np.array([0, 1 / 3, 2 / 3])))
    saturation = rng.uniform(0.2, 0.95, (count, count))[i, j][..., None]
    thread = 1 + 0.25 * np.sign(np.sin(2 * np.pi * (row + column) * 32 / size)) * (rng.random((count, count))[i, j] > 0.4)
    speckle = 1 + 0.06 * noise((size, size), (1.5, 1.5), rng)
    return np.clip((tone * thread * speckle)[..., None] * (1 - saturation + saturation * weights), 0.005, 0.9)


def terrazzo(size=1024, chips=900, seed=31):
    """Pale cement with polished chips of four stones."""
    rng = np.random.default_rng(seed)
    row, column = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    out = np.array([0.56, 0.54, 0.5]) * (1 + 0.04 * noise((size, size), (2, 2), rng))[..., None]
    stones = np.array([(0.16, 0.17, 0.18), (0.44, 0.19, 0.12), (0.2, 0.28, 0.22), (0.75, 0.7, 0.6)])
    for _ in range(chips):
        centre, radius, turn = rng.integers(0, size, 2), rng.uniform(4, 17), rng.uniform(0, np.pi)
        window = np.arange(-30, 31)
        v, u = np.meshgrid(window, window, indexing="ij")
        along, across = u * np.cos(turn) + v * np.sin(turn), v * np.cos(turn) - u * np.sin(turn)
        inside = (abs(along) / radius) ** 2.6 + (abs(across) / (radius * rng.uniform(0.4, 0.9))) ** 2.6 < 1
        rows, columns = (centre[0] + v[inside]) % size, (centre[1] + u[inside]) % size
        out[rows, columns] = stones[rng.integers(len(stones))] * rng.uniform(0.8, 1.2)
    return np.clip(out, 0.02, 0.9)


def gingham(size=512, count=8, seed=41):
    """Checked cloth: two threads of blue on cream, with the weave visible."""
    rng = np.random.default_rng(seed)
    row, column = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    dyed = (row * count // size % 2 + column * count // size % 2) / 2
    colour = (1 - dyed[..., None]) * np.array([0.68, 0.65, 0.58]) + dyed[..., None] * np.array([0.06, 0.12, 0.34])
    weave = 1 + 0.05 * np.sign(np.sin(np.pi * row / 2 + 0.1) * np.sin(np.pi * column / 2 + 0.1)) + 0.03 * noise((size, size), (1, 1), rng)
    return np.clip(colour * weave[..., None], 0.02, 0.9)
