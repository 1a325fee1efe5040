"""EXR files: linear RGB, float32, ZIP."""

from pathlib import Path

import numpy as np
import OpenEXR


def write_exr(path: Path, image) -> None:
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    channels = {c: np.ascontiguousarray(image[:, :, i], dtype=np.float32) for i, c in enumerate("RGB")}
    OpenEXR.File(header, channels).write(str(path))


def read_exr(path: Path):
    return np.asarray(OpenEXR.File(str(path)).channels()["RGB"].pixels, dtype=np.float64)
