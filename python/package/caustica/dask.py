"""Rendering on the workers of a Dask cluster.

>>> from dask.distributed import Client
>>> import caustica, caustica.dask
>>> scene = caustica.load("/shared/scene.xml")
>>> image = caustica.dask.render(scene, Client("scheduler:8786"), passes=4096)
"""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from . import _native
from ._image import Image, Progress
from ._scene import Scene, Setting, pairs

if TYPE_CHECKING:
    from distributed import Client

Job = tuple[Scene, list[tuple[str, str]], str | None, int | None]


@lru_cache(maxsize=2)
def _job(pickled: bytes) -> Job:
    """What to render; a worker reads a scene once for all its tasks."""
    job: Job = pickle.loads(pickled)
    return job


def _part(pickled: bytes, first: int, end: int) -> bytes:
    """The passes first..end, on a worker."""
    scene, settings, layers, threads = _job(pickled)
    image = scene._native.render(
        settings=settings,
        layers=layers,
        passes=True,
        time=None,
        target_error=None,
        threads=threads,
        checkpoint=None,
        resume=False,
        pass_range=(first, end),
        on_pass=None,
    )
    return image.part()


def ranges(passes: int, parts: int) -> list[tuple[int, int]]:
    """The passes 0..`passes` in `parts` ranges of about one length, each the first pass and the one after the last."""
    parts = max(1, min(parts, passes))
    ends = [passes * i // parts for i in range(parts + 1)]
    return list(zip(ends[:-1], ends[1:]))


def render(
    scene: Scene,
    client: Client,
    *,
    passes: int | None = None,
    parts: int | None = None,
    layers: str | Sequence[str] | None = None,
    threads: int | None = 1,
    on_part: Callable[[Progress], object] | None = None,
    **settings: Setting,
) -> Image:
    """Renders a scene on the workers of a cluster: the picture is that of one run to the last bit.

    The passes are divided into ranges, each a task. When a worker dies, Dask gives its tasks to others. Every worker
    reads the scene file at the same absolute path, so it lies in a folder that all of them see; values that were
    changed in the scene travel with the tasks.

    :param passes: number of passes; the scene's own without it
    :param parts: number of tasks; four for each thread of the cluster without it
    :param layers: what to render beside the parts of the picture, as for `caustica.render`
    :param threads: threads of a task; a worker with n threads runs n tasks at once
    :param on_part: called with a `Progress` when a task is done; the other tasks are cancelled where it returns
        ``False``, and the picture has the passes that are done
    """
    import distributed

    # Most of what Dask has is without types.
    cluster: Any = client
    completed: Any = distributed.as_completed
    if passes is None:
        passes = int(scene.settings["passes"])
    if parts is None:
        parts = 4 * max(1, sum(cluster.nthreads().values()))
    if layers is not None and not isinstance(layers, str):
        layers = ",".join(layers) or "none"
    job: Job = (scene, pairs(settings), layers, threads)
    pickled = pickle.dumps(job)
    started = time.monotonic()
    # Not by the arguments: the file may have changed since the same render was made before.
    futures = {
        cluster.submit(_part, pickled, first, end, pure=False, key=None): (first, end)
        for first, end in ranges(passes, parts)
    }
    merge = _native.Merge()
    done = 0
    try:
        for future, part in completed(futures, with_results=True):
            first, end = futures[future]
            merge.add(f"passes {first}..{end}", part)
            future.release()
            done += end - first
            if on_part is not None and _refused(on_part(Progress(done, time.monotonic() - started, None))):
                break
    finally:
        cluster.cancel([future for future in futures if not future.done()])
    return Image(merge.finish(passes, allow_missing=done < passes))


def _refused(answer: Any) -> bool:
    return answer is False or (type(answer).__name__ == "bool_" and not answer)
