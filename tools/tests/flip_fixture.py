"""Prints the numbers of tests/flip.rs: FLIP by the public evaluator on pictures made by formula.

    python3 -m venv venv && venv/bin/pip install flip-evaluator==1.7 numpy
    venv/bin/python tools/tests/flip_fixture.py > tools/tests/flip_fixture.txt

The formulas use integers and powers of two only, so both languages make the same bits; they are
written a second time in tests/flip.rs. One line a pair: name, mean, and the map's values at every
7th pixel in reading order.
"""

import flip_evaluator
import numpy as np


def mix(x, y, c, seed):
    h = (x * 73856093 ^ y * 19349663 ^ c * 83492791 ^ seed * 2654435761) & 0xFFFFFFFF
    h = ((h ^ (h >> 16)) * 0x7FEB352D) & 0xFFFFFFFF
    h = ((h ^ (h >> 15)) * 0x846CA68B) & 0xFFFFFFFF
    return (h ^ (h >> 16)) >> 16  # 16 bits


def noise(x, y, c, k):
    base = 64 * (x + 2 * y + 5 * c)
    return (base + k * (mix(x, y, c, 1) >> 3)) / 16384


def checker(x, y, c, k):
    return 0.75 if ((x + k) // 6 + y // 6) % 2 == 0 else 0.125 * (c + 1)


def patches(x, y, c, k):
    patch = (x // 8 + 3 * (y // 8) + k) % 7 + 1
    return 1.0 if patch >> c & 1 else 0.0


def fireflies(x, y, c, k):
    lit = k * (mix(x, y, 0, 2) < 655)
    return 1.0 if lit else 0.03125 + x / 1024


def texture(x, y, c, k):
    return ((mix(x // 2, y // 2, c, 3) >> 8) // 2 + 64 * k * (x + y) // 80) / 256


def tiny(x, y, c, k):
    return (1 + x + y * c + k) / 16


def caustic(x, y, c, k):
    d = (x - 24) ** 2 + (y - 18) ** 2
    stops = max(0, 10 - d // 24) - 4
    return 2.0**stops * (256 + k * (mix(x, y, c, 4) >> 9)) / 512


def lamp(x, y, c, k):
    inside = 20 <= x < 26 and 12 <= y < 20
    return 900.0 - 16 * k * (x - 20) + 8 * c if inside else 0.0


def night(x, y, c, k):
    return (mix(x, y, c, 5 + k) >> 4) / 2.0**16 * (1 if x < 30 else 2.0**-5)


def ranges(x, y, c, k):
    return 2.0 ** (x // 8 - 3) * (1 + (mix(x, y, c, 6 + k) >> 11) / 128) * (1 + c / 4)


def picture(formula, size, k):
    w, h = size
    return np.array(
        [[[formula(x, y, c, k) for c in range(3)] for x in range(w)] for y in range(h)], dtype=np.float32
    )


PAIRS = [
    ("noise", noise, (61, 47), "LDR", {}),
    ("checker", checker, (64, 48), "LDR", {}),
    ("patches", patches, (56, 40), "LDR", {}),
    ("fireflies", fireflies, (64, 48), "LDR", {}),
    ("texture", texture, (80, 33), "LDR", {"ppd": 30.0}),
    ("tiny", tiny, (5, 3), "LDR", {}),
    ("caustic", caustic, (48, 40), "HDR", {}),
    ("lamp", lamp, (45, 31), "HDR", {}),
    ("night", night, (50, 40), "HDR", {}),
    ("ranges", ranges, (64, 24), "HDR", {}),
    ("ranges-hable", ranges, (64, 24), "HDR", {"tonemapper": "hable"}),
    ("ranges-reinhard", ranges, (64, 24), "HDR", {"tonemapper": "reinhard"}),
]

for name, formula, size, kind, parameters in PAIRS:
    reference, test = picture(formula, size, 0), picture(formula, size, 1)
    error, mean, used = flip_evaluator.evaluate(
        reference, test, kind, inputsRGB=False, applyMagma=False, parameters=parameters
    )
    samples = " ".join(f"{v:.7f}" for v in error.reshape(-1)[::7])
    mean = float(np.mean(error.astype(np.float64)))
    exposures = f"{used.get('startExposure', 0):.6f} {used.get('stopExposure', 0):.6f} {used.get('numExposures', 0)}"
    print(f"{name} | {mean:.8f} | {exposures if kind == 'HDR' else '-'} | {samples}")
