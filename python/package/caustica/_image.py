"""Pictures, and how far a render is."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import UnknownNameError

Floats = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Progress:
    """State of a render after a pass."""

    passes: int
    """Passes done."""
    elapsed: float
    """Seconds since the render began."""
    error: float | None
    """Standard error of the picture relative to its mean; `None` while it is not known."""

    def __str__(self) -> str:
        error = "" if self.error is None else f", error {100 * self.error:.2f} %"
        return f"pass {self.passes}, {self.elapsed:.1f} s{error}"


class Image:
    """A rendered picture: radiance in linear Rec. 709, in the units of the scene's lamps (W·m⁻²·sr⁻¹), row 0 at
    the top.

    In a notebook it shows itself. ``numpy.asarray(image)`` is `image.numpy()`.
    """

    def __init__(self, native: _native.Image) -> None:
        self._native = native

    def numpy(self) -> Floats:
        """Red, green and blue: float32 of shape (height, width, 3)."""
        return self._native.rgb()

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        if copy is False:
            raise ValueError("the array of an image is always made anew")
        return self.numpy().astype(dtype if dtype is not None else np.float32, copy=False)

    def keys(self) -> list[str]:
        """The names of its layers."""
        return self._native.layers()

    def __getitem__(self, layer: str) -> Floats:
        """A layer by its name, as float32.

        `emission`, `direct`, `caustic`, `indirect` and (in scenes with media) `medium` are the parts of the
        picture, of shape (height, width, 3); they add up to it. `variance` (of each pixel's mean luminance) and
        `samples` (camera samples a pixel) have shape (height, width). Others are there if `render` was asked for
        them with `layers=`: of shape (height, width), or (height, width, n) where they have n channels.
        """
        data = self._native.layer(layer)
        if data is None:
            near = get_close_matches(layer, self.keys(), 1)
            hint = f"; did you mean `{near[0]}`?" if near else f"; there are {', '.join(self.keys())}"
            raise UnknownNameError(
                f"the picture has no layer `{layer}`{hint}", suggestion=near[0] if near else None
            )
        return data

    def __contains__(self, layer: object) -> bool:
        return layer in self.keys()

    def channels(self, layer: str) -> list[str]:
        """The names of a layer's channels."""
        self[layer]
        return self._native.channels(layer) or []

    @property
    def alpha(self) -> Floats:
        """Share of each pixel's camera samples that met a surface: float32 of shape (height, width)."""
        return self._native.alpha()

    @property
    def error(self) -> float | None:
        """Standard error of the pixels, root mean square over the picture, relative to its mean; `None` after a
        single pass. What a photon map blurs (bias) is not in it."""
        return self._native.error

    @property
    def passes(self) -> int:
        """Passes in the picture."""
        return self._native.passes

    @property
    def samples(self) -> int:
        """Camera samples a pixel."""
        return self._native.samples

    @property
    def stop(self) -> str:
        """Why the render ended: `"passes"`, `"time"`, `"error"` or `"interrupted"`."""
        return self._native.stop

    @property
    def width(self) -> int:
        """In pixels."""
        return self._native.size[0]

    @property
    def height(self) -> int:
        """In pixels."""
        return self._native.size[1]

    @property
    def shape(self) -> tuple[int, int, int]:
        """(height, width, 3)."""
        return (self.height, self.width, 3)

    @property
    def statistics(self) -> dict[str, Any]:
        """Counts and times of the render, as `render` of the JSON that ``caustica render --stats`` writes; nothing
        for a picture that was rendered in parts."""
        statistics: dict[str, Any] = json.loads(self._native.statistics())
        return statistics

    @property
    def metadata(self) -> dict[str, str]:
        """What an EXR says about the picture in its header."""
        return self._native.metadata()

    @property
    def settings(self) -> dict[str, str]:
        """Every setting in effect, but for the number of passes."""
        rows = (row.partition("=") for row in self._native.settings().split())
        return {name: value for name, _, value in rows}

    def save(self, *files: str | os.PathLike[str], half: bool = False, exposure: float = 0.0) -> None:
        """Writes the picture to .exr (with its layers), .png, .hdr or .pfm files: the same bytes as the command
        line's.

        `half` stores 16-bit floats in EXR files, and `exposure` brightens PNG files by so many stops.
        """
        if not files:
            raise TypeError("save() needs a file")
        self._native.save([os.fspath(file) for file in files], half, exposure)

    def png(self, exposure: float = 0.0) -> bytes:
        """The bytes of a PNG, brightened by `exposure` stops."""
        return self._native.encode("png", False, exposure)

    def _exr(self) -> bytes:
        """The bytes of an EXR with all that `compare` may use."""
        return self._native.encode("exr", False, 0.0)

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        error = "" if self.error is None else f", error {100 * self.error:.2f} %"
        passes = "1 pass" if self.passes == 1 else f"{self.passes} passes"
        return f"<caustica.Image {self.width}×{self.height}, {passes}{error}>"
