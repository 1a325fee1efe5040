"""Converting scenes."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from . import _native
from ._errors import SceneWarning
from ._scene import Path, Setting, pairs


@dataclass(frozen=True)
class Loss:
    """Something that the written scene cannot express."""

    what: str
    """What is lost."""
    instead: str
    """What is written instead."""
    place: str | None
    """`file:line:column` in the scene that was read."""
    size: float | None
    """How much more light there is, in parts of what there was; `None` where that is not known."""

    def __str__(self) -> str:
        place = "" if self.place is None else f"{self.place}: "
        return f"{place}{self.what}; instead: {self.instead}"


@dataclass(frozen=True)
class Converted:
    """A scene that was written."""

    path: str
    """The scene file."""
    shapes: int
    """Shapes in it."""
    files: int
    """Meshes and textures written beside it."""
    losses: tuple[Loss, ...]
    """What the language could not express."""


def convert(
    source: Path,
    target: Path,
    *,
    force: bool = False,
    lenient: bool = False,
    allow_paths: Sequence[Path] = (),
    spectral_to_rgb: str = "mitsuba3",
    defines: Mapping[str, Setting] | None = None,
    **parameters: Setting,
) -> Converted:
    """Writes a scene in the language of the target's extension (.xml: Mitsuba 3, .pbrt: pbrt-v4), with its meshes
    and textures, as ``caustica convert`` does.

    Further keyword arguments are values of the scene's own parameters, see `load`.

    :param force: replace files that exist
    :param lenient: use the nearest thing for what is unknown or not supported, with a warning
    :param allow_paths: folders that the scene may read from beside its own
    :param spectral_to_rgb: how spectra that the language cannot express become RGB, see `load`
    :raises SceneError: with every problem of the scene
    """
    shapes, files, losses, diagnostics = _native.convert(
        os.fspath(source),
        os.fspath(target),
        defines=pairs({**(defines or {}), **parameters}),
        force=force,
        lenient=lenient,
        allow_paths=[os.fspath(folder) for folder in allow_paths],
        spectral_to_rgb=spectral_to_rgb,
    )
    for diagnostic in diagnostics:
        warnings.warn(str(diagnostic), SceneWarning, stacklevel=2)
    return Converted(os.fspath(target), shapes, files, tuple(Loss(*loss) for loss in losses))
