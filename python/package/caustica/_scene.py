"""Scenes: loading, looking at them, changing and rendering them."""

from __future__ import annotations

import difflib
import json
import operator
import os
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, TypedDict, cast

import numpy as np
import numpy.typing as npt

from . import _native
from ._errors import ArrayError, Diagnostic, Error, SceneError, SceneWarning, SettingError
from ._image import Image, Progress

Path = str | os.PathLike[str]
Setting = str | int | float | bool
Value = float | npt.NDArray[Any]


class _Options(TypedDict):
    defines: list[tuple[str, str]]
    sensor: int | None
    size: tuple[int, int] | None
    crop: tuple[int, int, int, int] | None
    filter: str | None
    lenient: bool
    allow_paths: list[str]
    spectral_to_rgb: str


def text(value: Setting) -> str:
    """A value in the words of the command line."""
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, np.floating)):
        return repr(float(value)) if not float(value).is_integer() else str(int(value))
    return str(value)


def pairs(values: Mapping[str, Setting]) -> list[tuple[str, str]]:
    return [(name, text(value)) for name, value in values.items()]


def _wholes(name: str, values: Any, lowest: Sequence[int], expected: str) -> tuple[int, ...]:
    """As many whole numbers as `lowest` has, none below those."""
    try:
        numbers = tuple(operator.index(value) for value in values)
    except TypeError:
        numbers = ()
    # The native part has 32 bits for each.
    fits = [low <= number < 2**32 for low, number in zip(lowest, numbers, strict=False)]
    if len(numbers) != len(lowest) or not all(fits):
        raise _refused(name, values, expected)
    return numbers


def _number(name: str, value: Any, kind: Callable[[Any], Any], expected: str) -> Any:
    """A number that `kind` takes; what range it may have is found out later."""
    try:
        return None if value is None else kind(value)
    except (TypeError, ValueError):
        raise _refused(name, value, expected) from None


def _refused(name: str, value: object, expected: str) -> SettingError:
    return SettingError(f"invalid value `{value}` for `{name}`: expected {expected}")


class Scene:
    """A scene that is read and compiled; made by `load`.

    ``print(scene)`` shows what ``caustica inspect`` prints. Its values can be read and changed by name before a
    render: ``scene["white.reflectance"] = [0.8, 0.2, 0.2]``. The names are the ids of the scene file and the names
    of the parameters, and `keys` lists them all; what has no id is called by what refers to it, as in
    ``floor.bsdf.reflectance``, or by its number, as in ``emitter_0.intensity``.

    Scenes can be pickled: as the absolute path of the file, which is read again, and the changed values.
    """

    def __init__(self, path: Path, options: _Options) -> None:
        self._path = os.path.abspath(path)
        self._options = options
        self._changes: dict[str, npt.NDArray[np.float64]] = {}
        self._native = _native.Scene(os.fspath(path), **options)
        for diagnostic in self.diagnostics:
            warnings.warn(str(diagnostic), SceneWarning, stacklevel=3)

    @property
    def path(self) -> str:
        """The scene file, absolute."""
        return self._path

    @property
    def width(self) -> int:
        """Of the picture, in pixels."""
        return self._native.size[0]

    @property
    def height(self) -> int:
        """Of the picture, in pixels."""
        return self._native.size[1]

    @property
    def diagnostics(self) -> list[Diagnostic]:
        """Warnings and notes about the scene."""
        return self._native.diagnostics()

    @property
    def settings(self) -> dict[str, str]:
        """The value of every setting: what the scene asks for, or its default. Those given to `render` are in
        `Image.settings`."""
        return dict(self._native.settings())

    def inspect(self) -> dict[str, Any]:
        """What ``caustica inspect --json`` prints: contents, statistics, plan, settings, diagnostics."""
        found: dict[str, Any] = json.loads(self._native.inspect())
        return found

    def keys(self) -> list[str]:
        """The names of all values."""
        return self._native.keys()

    def __getitem__(self, key: str) -> Value:
        """A value of the scene: a number, or an array.

        =================================  ==================================================================
        colours (reflectance, radiance)    float64 of shape (3,), linear Rec. 709
        textured colours, `NAME.data`      float32 of shape (height, width, 3), linear, row 0 at the top
        positions and directions           float64 of shape (3,)
        `to_world`                         float64 of shape (4, 4), for column vectors
        `vertex_positions`                 float32 of shape (n, 3), before `to_world`
        `vertex_normals`                   float32 of shape (n, 3), or (0, 3) for a flat mesh
        `vertex_texcoords`                 float32 of shape (n, 2), or (0, 2) where there are none
        `faces`                            uint32 of shape (m, 3)
        =================================  ==================================================================
        """
        return self._native.get(key)

    def __setitem__(self, key: str, value: npt.ArrayLike) -> None:
        """Changes a value before the next render.

        Colours take a number or an array of shape (3,), and where a texture may stand also a picture of shape
        (height, width) or (height, width, 3); a picture in the place of a picture lies on the surface as that
        did. Vertices keep their number. When positions change in a Mitsuba scene, vertex normals are computed
        anew, as Mitsuba does; in a pbrt scene the author's stay.
        """
        try:
            array = np.array(value, dtype=np.float64)
        except (TypeError, ValueError) as problem:
            raise ArrayError(f"`{key}`: expected numbers, not {value!r}") from problem
        self._native.set(key, array)
        self._changes[key] = array

    def update(self, values: Mapping[str, npt.ArrayLike]) -> None:
        """Changes several values."""
        for key, value in values.items():
            self[key] = value

    def __contains__(self, key: object) -> bool:
        return key in self.keys()

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def __len__(self) -> int:
        return len(self.keys())

    def __str__(self) -> str:
        return self._native.describe()

    def __repr__(self) -> str:
        return f"<caustica.Scene {self._path!r}, {self.width}×{self.height}>"

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        printer.text(str(self))

    def __reduce__(self) -> tuple[object, ...]:
        return (_restored, (self._path, self._options, self._changes))


def _restored(path: str, options: _Options, changes: dict[str, npt.NDArray[np.float64]]) -> Scene:
    with warnings.catch_warnings():
        # They were told when the scene was loaded first.
        warnings.simplefilter("ignore", SceneWarning)
        scene = Scene(path, options)
    scene.update(changes)
    return scene


def load(
    path: Path,
    *,
    sensor: int | None = None,
    size: tuple[int, int] | None = None,
    crop: tuple[int, int, int, int] | None = None,
    filter: str | None = None,
    lenient: bool = False,
    allow_paths: Sequence[Path] = (),
    spectral_to_rgb: str = "mitsuba3",
    defines: Mapping[str, Setting] | None = None,
    **parameters: Setting,
) -> Scene:
    """Reads a Mitsuba (.xml) or pbrt (.pbrt) scene and all that it names.

    Further keyword arguments are values of the scene's own parameters (``$width`` of a Mitsuba scene is
    ``width=256``), as ``-D`` of the command line; `defines` takes those whose names are arguments here.

    :param sensor: which sensor, from 0 in file order
    :param size: (width, height) of the full film in pixels
    :param crop: (x, y, width, height): the part of the film to render
    :param filter: reconstruction filter: box, tent, gaussian, mitchell, catmullrom or lanczos
    :param lenient: use the nearest thing for what is unknown or not supported, with a warning
    :param allow_paths: folders that the scene may read from beside its own
    :param spectral_to_rgb: how spectra become RGB: mitsuba3, mitsuba06, or file (as the file's own renderer)
    :raises SceneError: with every problem of the scene
    :warns SceneWarning: for each thing that is not rendered as it is written
    """
    if size is not None:
        words = "(width, height), such as (640, 480)"
        size = cast(tuple[int, int], _wholes("size", size, (1, 1), words))
    if crop is not None:
        words = "(x, y, width, height), such as (0, 0, 64, 64)"
        crop = cast(tuple[int, int, int, int], _wholes("crop", crop, (0, 0, 1, 1), words))
    options = _Options(
        defines=pairs({**(defines or {}), **parameters}),
        sensor=_number("sensor", sensor, operator.index, "a whole number from 0"),
        size=size,
        crop=crop,
        filter=filter,
        lenient=lenient,
        # Absolute, because a scene may be restored in another folder.
        allow_paths=[os.path.abspath(folder) for folder in allow_paths],
        spectral_to_rgb=spectral_to_rgb,
    )
    try:
        return Scene(path, options)
    except SceneError as error:
        raise _meant(error, parameters, _Options.__annotations__) from None


def _meant(error: Error, keywords: Mapping[str, Setting], arguments: Iterable[str]) -> Error:
    """The error, with the argument that was probably meant by a keyword of which it speaks."""
    arguments = list(arguments)
    known = arguments if error.suggestion is None else [*arguments, error.suggestion]
    for name in keywords:
        nearest = difflib.get_close_matches(name, known, n=1, cutoff=0.7)
        if nearest and nearest[0] != name and nearest[0] in arguments and f"`{name}`" in str(error):
            message = str(error).partition("; did you mean")[0]
            return type(error)(
                f"{message}\n = help: did you mean the argument `{nearest[0]}`?", error.diagnostics, nearest[0]
            )
    return error


def render(
    scene: Scene | Path,
    *,
    time: float | None = None,
    passes: int | None = None,
    target_error: float | None = None,
    layers: str | Sequence[str] | None = None,
    threads: int | None = None,
    checkpoint: Path | None = None,
    resume: bool = False,
    on_pass: Callable[[Progress], object] | None = None,
    **settings: Setting,
) -> Image:
    """Renders a scene; the picture is the command line's to the last bit.

    Further keyword arguments are settings by the names of ``--set``: ``photons=1e6, radius=0.05, seed=3``.
    `settings()` lists them. Other Python threads run meanwhile. Ctrl-C ends the render, and the result is the
    picture of the passes that are done.

    :param scene: a scene, or the path of one
    :param time: seconds after which the render ends
    :param passes: number of passes (camera samples a pixel, and photon maps), also called `spp`
    :param target_error: the render ends when the picture's relative standard error is this small
    :param layers: what to render beside the parts of the picture, such as ``"albedo,depth"``
    :param threads: number of threads; all cores without it
    :param checkpoint: file in which the state of the render is saved after every pass
    :param resume: go on from the checkpoint, if it is there
    :param on_pass: called after every pass with a `Progress`; the render ends where it returns ``False``
    :raises SettingError: for a setting that does not exist or cannot have this value, with a suggestion
    """
    if "spp" in settings:
        if passes is not None:
            raise TypeError("passes and spp are the same")
        passes = int(settings.pop("spp"))
    if passes is not None:
        settings["passes"] = passes
    if resume and checkpoint is None:
        raise TypeError("resume needs a checkpoint")
    if not isinstance(scene, Scene):
        scene = load(scene)
    try:
        native = scene._native.render(
            settings=pairs(settings),
            layers=layers if layers is None or isinstance(layers, str) else ",".join(layers) or "none",
            passes=passes is not None,
            time=_number("time", time, float, "a positive number of seconds"),
            target_error=_number("target_error", target_error, float, "a positive number, such as 0.01"),
            threads=_number("threads", threads, operator.index, "a whole number from 1"),
            checkpoint=None if checkpoint is None else os.fspath(checkpoint),
            resume=resume,
            pass_range=None,
            on_pass=on_pass,
        )
    except SettingError as error:
        raise _meant(error, settings, render.__kwdefaults__ or ()) from None
    return Image(native)
