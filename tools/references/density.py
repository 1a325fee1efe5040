"""How far a density estimate of photons may be from the reference: the reference is compared with itself after its
indirect light is spread over the discs of the photon map. Uses only Mitsuba's picture and geometry."""

import numpy as np

# Two rules of our photon mapper: the largest first radius in pixels (of the median size), and the share of new
# photons that is kept when the radius shrinks.
MOST_PIXELS = 16.0
ALPHA = 0.7
# Rows and columns of the blocks whose means the suite compares.
BLOCKS = 8


def shares(passes: int) -> list[float]:
    """Radius over that of the first pass, for four passes that stand for all (Knaus and Zwicker 2011)."""
    steps = np.arange(1, passes)
    squares = np.concatenate([[1.0], np.cumprod((steps + ALPHA) / (steps + 1))])
    return [float(np.sqrt(squares[int(passes * at)])) for at in (0.125, 0.375, 0.625, 0.875)]


def surfaces(mi, scene, size):
    """What the ray through the middle of each pixel hits: position, normal, diffuse reflectance, whether it is
    specular, whether it hits at all, the size of the pixel there, and the cosine at which it is seen."""
    width, height = size
    x, y = (v.ravel() for v in np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height))
    sensor = scene.sensors()[0]

    def look(u, v):
        ray, _ = sensor.sample_ray(0.0, 0.5, mi.Point2f(u, v), mi.Point2f(0.5))
        si = scene.ray_intersect(ray)
        bsdf = si.bsdf(ray)
        delta = mi.has_flag(bsdf.flags(), mi.BSDFFlags.Delta) & ~mi.has_flag(bsdf.flags(), mi.BSDFFlags.Diffuse)
        colour = bsdf.eval_diffuse_reflectance(si)
        return [np.array(v) for v in (ray.d, si.p, si.n, colour, delta & si.is_valid(), si.is_valid(), si.t)]

    if mi.variant().startswith("scalar"):
        rows = [look(float(u), float(v)) for u, v in zip(x, y)]
        d, p, n, colour, delta, valid, t = (np.stack(v, -1) for v in zip(*rows))
    else:
        d, p, n, colour, delta, valid, t = look(x, y)
    grid = lambda v: v.reshape(3, height, width).transpose(1, 2, 0).astype(np.float64)
    d, p, n, colour = grid(d), grid(p), grid(n), grid(colour)
    delta, valid = delta.reshape(height, width), valid.reshape(height, width)
    t = np.where(valid, t.reshape(height, width), 0.0)
    step = np.linalg.norm(np.gradient(d, axis=1), axis=2)
    return p, n, colour, delta, valid, np.maximum(step * t, 1e-12), np.abs((d * n).sum(2))


def spread(mi, scene, full, direct, passes: int, mask=None):
    """Per pixel and channel: the change of the reference when its light, without emission and direct light, is averaged
    over discs on the visible surface (over discs on the screen where that is specular); and the light from the parts
    of discs that the picture does not show, of which nothing is known."""
    height, width = full.shape[:2]
    p, n, colour, delta, valid, footprint, cos = surfaces(mi, scene, [width, height])
    if mask is not None:
        valid = valid & (mask[:, :, 0] > 0.5)
    colour = np.where(delta[:, :, None], 1.0, np.maximum(colour, 0.05))
    light = (full - direct) / colour
    area = footprint**2 / np.maximum(cos, 0.05)
    middle = np.median(footprint[valid])
    change, unknown = np.zeros_like(full), np.zeros_like(full)
    sizes = shares(passes)
    for share in sizes:
        radius = MOST_PIXELS * middle * share
        reach = int(min(48, np.ceil(radius / footprint[valid].min())))
        total, weight = np.zeros_like(full), np.zeros((height, width, 1))
        for dy in range(-reach, reach + 1):
            for dx in range(-reach, reach + 1):
                here = np.s_[max(0, -dy) : height - max(0, dy), max(0, -dx) : width - max(0, dx)]
                there = np.s_[max(0, dy) : height - max(0, -dy), max(0, dx) : width - max(0, -dx)]
                between = p[there] - p[here]
                away = (between**2).sum(2) / radius**2
                flat = np.abs((between * n[here]).sum(2)) < 0.1 * radius
                alike = flat & ((n[there] * n[here]).sum(2) > 0.9) & ~delta[here] & ~delta[there]
                # Epanechnikov's kernel with unit mass over a disc.
                w = np.where(alike, np.maximum(1 - away, 0) * area[there] / (0.5 * np.pi * radius**2), 0.0)
                pixels = MOST_PIXELS * share
                screen = max(1 - (dx * dx + dy * dy) / pixels**2, 0) / (0.5 * np.pi * pixels**2)
                w = np.where(delta[here] & delta[there], screen, w)
                w = np.where(valid[here] & valid[there], w, 0.0)[:, :, None]
                total[here] += w * light[there]
                weight[here] += w
        mean = np.where(weight > 0, total / np.maximum(weight, 1e-300), light)
        change += (mean - light) * colour / len(sizes)
        unknown += np.clip(1 - weight, 0, 1) * np.abs(full - direct) / len(sizes)
    seen = valid[:, :, None]
    return np.where(seen, change, 0.0), np.where(seen, unknown, 0.0)


def blocks(image):
    """Means of BLOCKS × BLOCKS parts."""
    height, width = image.shape[:2]
    y, x = np.arange(BLOCKS) * height // BLOCKS, np.arange(BLOCKS) * width // BLOCKS
    sums = np.add.reduceat(np.add.reduceat(image, y, 0), x, 1)
    return sums / (np.diff([*y, height])[:, None, None] * np.diff([*x, width])[None, :, None])


def tolerance(change, unknown):
    """How far the mean of each block may be off, apart from noise."""
    return np.abs(blocks(change)) + blocks(unknown)
