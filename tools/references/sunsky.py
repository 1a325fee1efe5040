"""Prints the light of Mitsuba's `sunsky` for the rows of `formats/src/sky/tests.rs`.

    python3 tools/references/sunsky.py

Each row: height of the sun in degrees, turbidity, albedo; irradiance of the sky on level ground (midpoints of 512 x 1024
directions); radiance of the sky towards each of DIRECTIONS; radiance of the middle of the sun, even and complex.
Needs the package `mitsuba` 3.9.1, and LLVM for its variant `llvm_ad_rgb`.
"""

import drjit as dr
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

CASES = [
    (3, 2.0, 0.3),
    (6, 3.0, 0.3),
    (10, 4.5, 0.1),
    (20, 2.0, 0.0),
    (30, 3.0, 0.3),
    (40, 6.3, 0.8),
    (50, 1.0, 0.5),
    (60, 10.0, 0.2),
    (75, 3.7, 1.0),
    (90, 2.0, 0.3),
]
AZIMUTH = np.radians(20)
DIRECTIONS = [(0, 0, 1), (0.6, 0, 0.8), (-0.6, 0.64, 0.48), (0.28, -0.96, 0.01)]


def seen(emitter, directions):
    """Radiance towards each direction, one row each."""
    columns = [mi.Float(np.ascontiguousarray(c, dtype=np.float32)) for c in np.array(directions).T]
    si = dr.zeros(mi.SurfaceInteraction3f, len(directions))
    si.wi = -mi.Vector3f(*columns)
    return np.array(emitter.eval(si)).T


def rust(numbers):
    return "[" + ", ".join(f"{x:.6g}" if "." in f"{x:.6g}" else f"{x:.1f}" for x in numbers) + "]"


n = 512
cosine, angle = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(2 * n) + 0.5) * np.pi / n, indexing="ij")
sine = np.sqrt(1 - cosine**2)
upwards = np.stack([(sine * np.cos(angle)).ravel(), (sine * np.sin(angle)).ravel(), cosine.ravel()], axis=1)

for height, turbidity, albedo in CASES:
    h = np.radians(height)
    sun = [float(x) for x in (np.cos(h) * np.cos(AZIMUTH), np.cos(h) * np.sin(AZIMUTH), np.sin(h))]
    light = {
        "type": "sunsky",
        "sun_direction": sun,
        "turbidity": turbidity,
        "albedo": {"type": "rgb", "value": [albedo] * 3},
    }
    sky = mi.load_dict({**light, "sun_scale": 0.0})
    level = (seen(sky, upwards) * cosine.reshape(-1, 1)).mean(0) * 2 * np.pi
    disc = [seen(mi.load_dict({**light, "sky_scale": 0.0, "complex_sun": c}), [sun])[0] for c in (False, True)]
    towards = ", ".join(rust(row) for row in seen(sky, DIRECTIONS))
    print(f"    ({height:.1f}, {turbidity}, {albedo}, {rust(level)}, [{towards}], [{rust(disc[0])}, {rust(disc[1])}]),")
