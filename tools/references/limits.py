"""The limits that our pictures must keep, from Mitsuba's pictures alone. README.md says why."""

import json
import os
import subprocess
import tempfile
from dataclasses import dataclass
from math import ceil, floor, log10
from pathlib import Path

import numpy as np
from exr import write_exr

ROOT = Path(__file__).resolve().parents[2]
# Factor above the worst of Mitsuba's own pictures.
MARGIN = 1.25
# Standard errors by which a mean may be off, and the share that single precision may add.
SIGMAS = 4.5
PRECISION = 0.002
# Variance of a photon map's picture over that of Mitsuba's with as many samples: it follows a quarter as
# many light paths as camera paths.
PHOTON_NOISE = 4.0
# Samples of the long profile over those of the short one.
LONG = 4


@dataclass
class Measured:
    """A reference: its file, mean, variance of the mean, samples a pixel."""

    file: Path
    mean: np.ndarray
    variance: np.ndarray
    spp: int

    def noise(self, spp: int, factor: float) -> float:
        """Largest relative standard error of a channel's mean, of a picture with `spp` samples."""
        n = self.mean.shape[0] * self.mean.shape[1]
        total = self.variance.reshape(n, 3).sum(0) * (factor * self.spp / spp + 1)
        return float((np.sqrt(total) / n / self.mean.reshape(n, 3).mean(0)).max())


@dataclass
class Pictures:
    """Pictures by Mitsuba with the samples of the suite's short profile."""

    spp: int
    images: list


def pictures(take, spp: int, mask) -> Pictures:
    images = [take(spp, seed) for seed in (500, 501)]
    return Pictures(spp, images if mask is None else [i * mask for i in images])


def compare(image, reference: Path) -> dict:
    """RMSE and FLIP of a picture, by our judge: a built program (CAUSTICA=FILE) or through cargo."""
    program = os.environ.get("CAUSTICA")
    command = [program] if program else ["cargo", "run", "--quiet", "--release", "--"]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "image.exr"
        write_exr(path, image)
        command += ["compare", path, reference, "--no-hdr", "--json"]
        out = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    found = json.loads(out)["comparisons"][0]
    return {"rmse": found["rmse_all"], "flip": found["flip_ldr"]["mean"]}


def up(value: float) -> float:
    """Two significant digits, rounded up."""
    unit = 10.0 ** (floor(log10(value)) - 1)
    return float(f"{ceil(value / unit - 1e-9) * unit:.12g}")


def profiles(measured: Measured, pictures: Pictures, change, factor: float, extra: dict) -> dict:
    """Limits of both profiles; `change` is how far the pictures may differ apart from noise."""
    scores = [compare(image + change, measured.file) for image in pictures.images]
    rmse, flip = (max(s[k] for s in scores) for k in ("rmse", "flip"))
    systematic = float((np.abs(change.mean((0, 1))) / measured.mean.mean((0, 1))).max())
    # Noise falls with the root of the samples, down to that of the reference; `change` stays.
    fixed = float((change**2).mean() + measured.variance.mean())
    long_rmse = np.sqrt(max(rmse**2 - fixed, 0) / LONG + fixed)
    limits = {}
    for name, spp, error in [("short", pictures.spp, rmse), ("long", LONG * pictures.spp, long_rmse)]:
        bias = SIGMAS * measured.noise(spp, factor) + PRECISION + systematic
        limits[name] = {
            "spp": spp,
            "max_rmse": up(MARGIN * float(error)),
            "max_flip": up(MARGIN * flip),
            "max_bias": up(bias),
            "noise": factor,
            **extra,
        }
    return limits


def path(measured: Measured, pictures: Pictures, z_test: bool) -> dict:
    reason = f"RMSE and FLIP: {MARGIN} times the worse of two pictures by Mitsuba with the same number of samples and" \
        f" other seeds. Bias: {SIGMAS} standard errors of the mean of such a picture, and {PRECISION:.1%} for single" \
        " precision; the same for the mean of each block. z-test: that of Mitsuba's render tests, unless the light of a" \
        " pixel comes from so few paths that its variance is not known."
    none = np.zeros_like(measured.mean)
    return {"reason": reason, **profiles(measured, pictures, none, 1.0, {"z_test": z_test})}


def photonmap(measured: Measured, pictures: Pictures, change, args: list) -> dict:
    reason = f"RMSE and FLIP: {MARGIN} times the worse of two pictures by Mitsuba whose indirect light is spread over the" \
        f" discs of the photon map. Bias: {SIGMAS} standard errors of a picture of {PHOTON_NOISE:g} times their variance (a" \
        f" quarter as many light paths), {PRECISION:.1%} for single precision, and the change of the mean by spreading; the" \
        " same for the mean of each block, plus all indirect light from parts of discs that the reference does not show."
    return {"reason": reason, **profiles(measured, pictures, change, PHOTON_NOISE, {"args": args})}
