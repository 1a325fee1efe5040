"""caustica renders Mitsuba and pbrt scenes by photon mapping.

>>> import caustica
>>> scene = caustica.load("scene.xml", width=256)
>>> image = caustica.render(scene, time=20, on_pass=print)
>>> image.save("scene.exr", "scene.png")
"""

from __future__ import annotations

from typing import NamedTuple

from . import _native
from ._compare import Comparison, compare
from ._convert import Converted, Loss, convert
from ._errors import (
    ArrayError,
    Diagnostic,
    Error,
    Related,
    SceneError,
    SceneWarning,
    SettingError,
    UnknownNameError,
)
from ._image import Image, Progress
from ._scene import Scene, load, render

__version__ = _native.__version__

__all__ = [
    "ArrayError",
    "Comparison",
    "Converted",
    "Diagnostic",
    "Error",
    "Image",
    "Loss",
    "Progress",
    "Related",
    "Scene",
    "SceneError",
    "SceneWarning",
    "SettingError",
    "SettingRow",
    "UnknownNameError",
    "compare",
    "convert",
    "load",
    "render",
    "settings",
]


class SettingRow(NamedTuple):
    """A setting of `render`."""

    name: str
    expected: str
    """What its values look like."""
    default: str
    meaning: str


def settings() -> list[SettingRow]:
    """Every setting that `render` takes, as ``caustica render --help-settings`` lists them."""
    return [SettingRow(*row) for row in _native.settings()]
