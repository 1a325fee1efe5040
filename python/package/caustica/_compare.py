"""Comparing pictures."""

from __future__ import annotations

import json
import os
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import ArrayError
from ._image import Floats, Image

Picture = Image | str | os.PathLike[str] | npt.NDArray[Any]


class Comparison:
    """How a picture differs from its reference."""

    def __init__(self, numbers: dict[str, Any], flip_map: Floats) -> None:
        self.numbers: dict[str, Any] = numbers
        """Every number, as an element of ``comparisons`` of ``caustica compare --json``."""
        self.flip_map: Floats = flip_map
        """LDR-FLIP of each pixel, from 0 (no visible difference) to 1: float32 of shape (height, width)."""

    @property
    def flip(self) -> float:
        """Mean LDR-FLIP."""
        return float(self.numbers["flip_ldr"]["mean"])

    @property
    def hdr_flip(self) -> float | None:
        """Mean HDR-FLIP; `None` where it was not computed."""
        found = self.numbers["flip_hdr"]
        return None if found is None else float(found["mean"])

    @property
    def rmse(self) -> float:
        """Root mean square error over pixels and channels."""
        return float(self.numbers["rmse_all"])

    @property
    def relmse(self) -> float:
        """Mean of squared errors over the reference's squares."""
        return float(self.numbers["relmse"])

    @property
    def mape(self) -> float:
        """Mean absolute error over the reference's values."""
        return float(self.numbers["mape"])

    @property
    def psnr(self) -> float | None:
        """Peak signal-to-noise ratio in dB; `None` for equal pictures."""
        found = self.numbers["psnr"]
        return None if found is None else float(found)

    @property
    def bias(self) -> float:
        """Difference of the means, relative to the reference's."""
        return float(self.numbers["bias"]["relative_all"])

    @property
    def z_test(self) -> dict[str, Any] | None:
        """Result of the z-test, where there is a variance image."""
        found: dict[str, Any] | None = self.numbers["z_test"]
        return found

    @property
    def notes(self) -> list[str]:
        """What to know about the numbers."""
        return list(self.numbers["notes"])

    def __repr__(self) -> str:
        return (
            f"<caustica.Comparison flip {self.flip:.4f}, rmse {self.rmse:.4g}, "
            f"relmse {self.relmse:.4g}, bias {100 * self.bias:+.2f} %>"
        )


def _picture(picture: Picture, name: str) -> tuple[str, bytes | Floats | None]:
    """What messages call it, and the picture itself where it is in memory."""
    if isinstance(picture, (str, os.PathLike)):
        return os.fspath(picture), None
    if isinstance(picture, Image):
        return f"<{name}>", picture._exr()
    array = np.asarray(picture)
    if array.ndim == 2:
        array = array[:, :, np.newaxis]
    if array.ndim != 3 or array.shape[2] not in (1, 3, 4):
        raise ArrayError(f"{name}: a picture has shape (h, w), (h, w, 1), (h, w, 3) or (h, w, 4), not {array.shape}")
    rgb = np.broadcast_to(array[:, :, :3], (*array.shape[:2], 3))
    return f"<{name}>", np.ascontiguousarray(rgb, dtype=np.float32)


def compare(
    image: Picture,
    reference: Picture,
    *,
    layer: str | None = None,
    reference_layer: str | None = None,
    mask: str | os.PathLike[str] | None = None,
    variance: str | os.PathLike[str] | None = None,
    spp: float | None = None,
    reference_spp: float | None = None,
    exposure: float = 0.0,
    ppd: float | None = None,
    psnr_peak: float = 1.0,
    hdr: bool = True,
) -> Comparison:
    """Compares two pictures by every metric of ``caustica compare``.

    Each is an `Image`, the path of a file (.exr, .png, ...), or an array of linear radiance of shape (height,
    width, 3) with row 0 at the top. A mask (``X.mask.exr``) and a variance image (``X.var.exr``) beside the
    reference ``X.exr`` are used as there.

    :param layer: compare this layer instead of the picture
    :param reference_layer: the layer of the reference, if it has another name
    :param spp: samples a pixel of the image, for the z-test, where the picture does not say
    :param reference_spp: samples a pixel of the reference
    :param exposure: stops of both pictures for LDR-FLIP
    :param ppd: pixels per degree for FLIP
    :param psnr_peak: signal of PSNR
    :param hdr: also compute HDR-FLIP, the slowest metric
    """
    image_name, image_array = _picture(image, "image")
    reference_name, reference_array = _picture(reference, "reference")
    numbers, flip_map = _native.compare(
        image_name,
        image_array,
        reference_name,
        reference_array,
        layer=layer,
        reference_layer=reference_layer,
        mask=None if mask is None else os.fspath(mask),
        variance=None if variance is None else os.fspath(variance),
        spp=spp,
        reference_spp=reference_spp,
        exposure=exposure,
        ppd=ppd if ppd is not None else _native.DEFAULT_PPD,
        psnr_peak=psnr_peak,
        hdr=hdr,
    )
    return Comparison(json.loads(numbers), flip_map)
