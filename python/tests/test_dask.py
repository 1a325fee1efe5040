"""Many workers make the picture of one run, also when one of them is killed."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest

import caustica

distributed = pytest.importorskip("distributed")

from caustica import dask  # noqa: E402


def test_ranges_make_up_all_passes() -> None:
    for passes, parts in [(10, 3), (4, 9), (1, 1), (64, 64)]:
        found = dask.ranges(passes, parts)
        assert [n for first, end in found for n in range(first, end)] == list(range(passes))
        assert len(found) == min(passes, parts)


def test_a_cluster_makes_the_bytes_of_one_run(root: Path, tmp_path: Path) -> None:
    scene = caustica.load(root / "scenes/cornell-glass.xml", size=(48, 48))
    scene["white.reflectance"] = np.full((4, 4, 3), 0.6)
    settings: dict[str, int] = {"seed": 7}
    passes = 24
    caustica.render(scene, passes=passes, layers="direct,albedo", **settings).save(tmp_path / "one.exr")
    killed: list[int] = []

    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, worker_dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):

        def kill(progress: caustica.Progress) -> None:
            if not killed:
                # The nanny starts another worker in its place.
                killed.extend(client.run(os.getpid).values())
                os.kill(killed[0], signal.SIGKILL)

        image = dask.render(
            scene, client, passes=passes, parts=12, layers=["direct", "albedo"], on_part=kill, **settings
        )
        assert killed and image.passes == passes and image.stop == "passes"
        image.save(tmp_path / "many.exr")
        assert (tmp_path / "many.exr").read_bytes() == (tmp_path / "one.exr").read_bytes()

        with pytest.raises(caustica.SettingError, match="did you mean `kernel`"):
            dask.render(scene, client, passes=2, kernal="cone")

        some = dask.render(scene, client, passes=8, parts=8, on_part=lambda p: p.passes < 3)
        assert 3 <= some.passes < 8 and some.stop == "interrupted"
        assert "missingPasses" in some.metadata
