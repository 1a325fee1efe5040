from collections.abc import Callable
from typing import Any, final

import numpy as np
import numpy.typing as npt

from ._errors import Diagnostic
from ._image import Progress

__all__ = ["DEFAULT_PPD", "Image", "Merge", "Scene", "__version__", "compare", "convert", "settings"]

__version__: str
DEFAULT_PPD: float

def settings() -> list[tuple[str, str, str, str]]: ...
def compare(
    image_name: str,
    image: bytes | npt.NDArray[np.float32] | None,
    reference_name: str,
    reference: bytes | npt.NDArray[np.float32] | None,
    *,
    layer: str | None,
    reference_layer: str | None,
    mask: str | None,
    variance: str | None,
    spp: float | None,
    reference_spp: float | None,
    exposure: float,
    ppd: float,
    psnr_peak: float,
    hdr: bool,
) -> tuple[str, npt.NDArray[np.float32]]: ...
def convert(
    source: str,
    target: str,
    *,
    defines: list[tuple[str, str]],
    force: bool,
    lenient: bool,
    allow_paths: list[str],
    spectral_to_rgb: str,
) -> tuple[int, int, list[tuple[str, str, str | None, float | None]], list[Diagnostic]]: ...
@final
class Scene:
    def __new__(
        cls,
        path: str,
        *,
        defines: list[tuple[str, str]],
        sensor: int | None,
        size: tuple[int, int] | None,
        crop: tuple[int, int, int, int] | None,
        filter: str | None,
        lenient: bool,
        allow_paths: list[str],
        spectral_to_rgb: str,
    ) -> Scene: ...
    @property
    def size(self) -> tuple[int, int]: ...
    def keys(self) -> list[str]: ...
    def get(self, key: str) -> float | npt.NDArray[Any]: ...
    def set(self, key: str, value: npt.NDArray[np.float64]) -> None: ...
    def describe(self) -> str: ...
    def inspect(self) -> str: ...
    def diagnostics(self) -> list[Diagnostic]: ...
    def settings(self) -> list[tuple[str, str]]: ...
    def render(
        self,
        *,
        settings: list[tuple[str, str]],
        layers: str | None,
        passes: bool,
        time: float | None,
        target_error: float | None,
        threads: int | None,
        checkpoint: str | None,
        resume: bool,
        pass_range: tuple[int, int] | None,
        on_pass: Callable[[Progress], object] | None,
    ) -> Image: ...

@final
class Image:
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def passes(self) -> int: ...
    @property
    def samples(self) -> int: ...
    @property
    def error(self) -> float | None: ...
    @property
    def stop(self) -> str: ...
    def layers(self) -> list[str]: ...
    def layer(self, name: str) -> npt.NDArray[np.float32] | None: ...
    def channels(self, name: str) -> list[str] | None: ...
    def rgb(self) -> npt.NDArray[np.float32]: ...
    def alpha(self) -> npt.NDArray[np.float32]: ...
    def statistics(self) -> str: ...
    def metadata(self) -> dict[str, str]: ...
    def settings(self) -> str: ...
    def part(self) -> bytes: ...
    def save(self, files: list[str], half: bool, exposure: float) -> None: ...
    def encode(self, extension: str, half: bool, exposure: float) -> bytes: ...

@final
class Merge:
    def __new__(cls) -> Merge: ...
    def add(self, name: str, part: bytes) -> None: ...
    def finish(self, passes: int, allow_missing: bool) -> Image: ...
