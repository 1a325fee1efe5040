"""Rendering: the same bytes as the command line's, budgets, callbacks and interruption."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import Program

import caustica

GLASS = "scenes/cornell-glass.xml"


@pytest.mark.parametrize(
    "settings",
    [
        {"passes": 3},
        {"integrator": "path", "passes": 2, "seed": 5},
        {"mode": "classic", "photons": 5e4, "nee": False, "passes": 2},
    ],
)
def test_pictures_are_the_bytes_of_the_command_line(
    root: Path, tmp_path: Path, program: Program, settings: dict[str, float | str | bool]
) -> None:
    words = {"photons": "50000", "nee": "false"}
    given = [a for n, v in settings.items() for a in ("--set", f"{n}={words.get(n, v)}")]
    given += ["--size", "48x32", "--filter", "tent"]
    scene = caustica.load(root / GLASS, size=(48, 32), filter="tent")
    image = caustica.render(scene, **settings)  # type: ignore[arg-type]
    for extension in ["exr", "png", "hdr", "pfm"]:
        expected = program.rendered(tmp_path, GLASS, *given, extension=extension)
        file = tmp_path / f"ours.{extension}"
        image.save(file)
        assert file.read_bytes() == expected, extension
    assert image.png() == image._repr_png_() == (tmp_path / "ours.png").read_bytes()


def test_layers_half_floats_and_exposure_too(root: Path, tmp_path: Path, program: Program) -> None:
    layers = "direct,caustic,variance,samples,albedo,uv,depth"
    scene = caustica.load(root / GLASS, size=(32, 32))
    image = caustica.render(scene, passes=2, layers=layers.split(","))
    image.save(tmp_path / "ours.exr", tmp_path / "ours.png", half=True, exposure=1.5)
    program.run(
        *("render", GLASS, "--size", "32x32", "--passes", 2, "--layers", layers, "--half", "--exposure", 1.5),
        *("-q", "-o", tmp_path / "theirs.exr", "--png"),
    )
    assert (tmp_path / "ours.exr").read_bytes() == (tmp_path / "theirs.exr").read_bytes()
    assert (tmp_path / "ours.png").read_bytes() == (tmp_path / "theirs.png").read_bytes()
    # Later renders have the layers that they ask for, and no others.
    assert "uv" not in caustica.render(scene, passes=1)


def test_threads_change_nothing(root: Path) -> None:
    scene = caustica.load(root / GLASS, size=(32, 32))
    one = caustica.render(scene, passes=2, threads=1)
    assert np.array_equal(one.numpy(), caustica.render(scene, passes=2, threads=3).numpy())


def test_a_path_is_a_scene(room: Path) -> None:
    assert caustica.render(room, spp=1).passes == 1


def test_budgets(root: Path) -> None:
    scene = caustica.load(root / GLASS, size=(16, 16))
    image = caustica.render(scene, time=0.2)
    assert image.stop == "time" and image.passes >= 1
    both = caustica.render(scene, time=1000, passes=2)
    assert (both.stop, both.passes) == ("passes", 2)
    good = caustica.render(scene, target_error=0.2)
    assert good.stop == "error" and good.error is not None and good.error <= 0.2


def test_settings_are_checked(root: Path) -> None:
    scene = caustica.load(root / GLASS, size=(16, 16))
    with pytest.raises(caustica.SettingError, match="no setting `kernal`; did you mean `kernel`") as e:
        caustica.render(scene, kernal="cone")
    assert e.value.suggestion == "kernel"
    with pytest.raises(ValueError, match="invalid value `nearst` for setting `lookup`"):
        caustica.render(scene, lookup="nearst")
    with pytest.raises(caustica.SettingError, match="no layer `depht`; did you mean `depth`"):
        caustica.render(scene, layers="depht")
    with pytest.raises(TypeError, match="passes and spp"):
        caustica.render(scene, passes=1, spp=2)
    for budget, expected in [
        ({"passes": 0}, "invalid value `0` for setting `passes`: expected a whole number from 1$"),
        ({"time": "long"}, "invalid value `long` for `time`: expected a positive number of seconds"),
        ({"threads": 1.5}, "invalid value `1.5` for `threads`: expected a whole number from 1"),
        ({"time": -1}, "invalid value `-1` for `time`: expected a positive number of seconds"),
        ({"time": float("nan")}, "`time`"),
        ({"target_error": -0.1}, "invalid value `-0.1` for `target_error`"),
        ({"threads": 0}, "invalid value `0` for `threads`: expected a whole number from 1 to"),
        ({"threads": -1}, "`threads`"),
        ({"tme": 3}, "did you mean the argument `time`"),
    ]:
        with pytest.raises(caustica.SettingError, match=expected):
            caustica.render(scene, **budget)  # type: ignore[arg-type]
    names = [row.name for row in caustica.settings()]
    assert "radius" in names and set(names) == set(scene.settings)


def test_on_pass_hears_of_every_pass_and_may_end_the_render(root: Path) -> None:
    scene = caustica.load(root / GLASS, size=(16, 16))
    heard: list[caustica.Progress] = []
    caustica.render(scene, passes=4, on_pass=heard.append)
    assert [p.passes for p in heard] == [1, 2, 3, 4]
    assert heard[0].error is None and heard[3].error is not None and heard[3].error > 0
    assert 0 < heard[0].elapsed < heard[3].elapsed
    assert str(heard[0]).startswith("pass 1, ")

    for no in [False, np.False_]:
        image = caustica.render(scene, time=1000, on_pass=lambda p, no=no: no if p.passes == 3 else None)
        assert (image.passes, image.stop) == (3, "interrupted")
    assert np.array_equal(image.numpy(), caustica.render(scene, passes=3).numpy())


def test_exceptions_of_on_pass_end_the_render_and_are_raised(root: Path) -> None:
    scene = caustica.load(root / GLASS, size=(16, 16))

    def fail(progress: caustica.Progress) -> None:
        if progress.passes == 2:
            raise LookupError("mine")

    with pytest.raises(LookupError, match="mine"):
        caustica.render(scene, time=1000, on_pass=fail)


def test_other_threads_run_meanwhile(root: Path) -> None:
    scene = caustica.load(root / GLASS, size=(64, 64))
    stop = threading.Event()
    images: list[caustica.Image] = []
    thread = threading.Thread(
        target=lambda: images.append(caustica.render(scene, passes=100000, on_pass=lambda p: not stop.is_set()))
    )
    thread.start()
    # A render that kept the lock would never let this thread set the event.
    stop.set()
    thread.join()
    assert images[0].stop == "interrupted"


def test_on_pass_may_use_the_package(root: Path) -> None:
    scene = caustica.load(root / GLASS, size=(16, 16))
    seen: list[float] = []

    def look(progress: caustica.Progress) -> None:
        other = caustica.render(caustica.load(root / GLASS, size=(8, 8)), passes=1, threads=1)
        seen.append(caustica.compare(other, other, hdr=False).flip)

    # The only thread of the render waits meanwhile.
    caustica.render(scene, passes=2, threads=1, on_pass=look)
    assert seen == [0, 0]
    with pytest.raises(ValueError, match="`threads`: expected a whole number from 1 to 1024"):
        caustica.render(scene, passes=1, threads=0)


INTERRUPTED = """
import caustica, os, signal, sys
scene = caustica.load(sys.argv[1], size=(32, 32))
def kill(progress):
    if progress.passes == 3:
        os.kill(os.getpid(), signal.SIGINT)
image = caustica.render(scene, time=1000, on_pass=kill if sys.argv[2] == "inside" else None)
print(image.passes, image.stop)
"""


@pytest.mark.parametrize("where", ["inside", "outside"])
def test_ctrl_c_returns_what_is_done(root: Path, where: str) -> None:
    # A shell starts what runs in the background with SIGINT ignored, and Python then leaves it so.
    process = subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED, str(root / GLASS), where],
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    if where == "outside":
        time.sleep(3)
        process.send_signal(signal.SIGINT)
    try:
        said, _ = process.communicate(timeout=120)
    finally:
        process.kill()
    assert process.returncode == 0
    passes, stop = said.split()
    assert stop == "interrupted" and int(passes) >= 3
    if where == "inside":
        assert int(passes) == 3


def test_checkpoints_go_on(room: Path, tmp_path: Path) -> None:
    checkpoint = tmp_path / "a.ckpt"
    scene = caustica.load(room)
    with pytest.raises(TypeError, match="resume needs a checkpoint"):
        caustica.render(scene, passes=1, resume=True)
    caustica.render(scene, passes=2, checkpoint=checkpoint)
    image = caustica.render(scene, passes=5, checkpoint=checkpoint, resume=True)
    assert image.statistics["resumed_passes"] == 2
    whole = caustica.render(scene, passes=5)
    image.save(tmp_path / "a.exr")
    whole.save(tmp_path / "b.exr")
    assert (tmp_path / "a.exr").read_bytes() == (tmp_path / "b.exr").read_bytes()


def _mean(path: str) -> float:
    return float(caustica.render(path, passes=1).numpy().mean())


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system does not fork")
def test_a_forked_process_renders_too(room: Path) -> None:
    here = _mean(str(room))
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert pool.apply_async(_mean, [str(room)]).get(timeout=120) == here


def test_statistics_are_those_of_the_command_line(room: Path, tmp_path: Path, program: Program) -> None:
    program.run("render", room, "-q", "--passes", 2, "-o", tmp_path / "a.exr", "--stats", tmp_path / "a.json")
    theirs = json.loads((tmp_path / "a.json").read_text())
    ours = caustica.render(room, passes=2)
    for name in ["passes", "light_paths", "photons_stored", "rays", "first_radius"]:
        assert ours.statistics[name] == theirs["render"][name], name
    assert ours.error == theirs["relative_standard_error"]
    assert {**ours.settings, "passes": "2"} == theirs["settings"]
