"""The types are complete, and the stub says what the extension module has."""

import subprocess
import sys
from pathlib import Path

USER = """
import numpy as np
import caustica

scene = caustica.load("scene.xml", width=256)
scene["box.reflectance"] = np.zeros(3)
image: caustica.Image = caustica.render(scene, time=20, radius=0.05, on_pass=print)
flip: float = caustica.compare(image, "reference.exr").flip
error: float | None = image.error
shape: tuple[int, ...] = image["caustic"].shape
losses: tuple[caustica.Loss, ...] = caustica.convert("scene.pbrt", "scene.xml").losses
"""


def run(*command: str, folder: Path) -> None:
    done = subprocess.run([sys.executable, "-m", *command], capture_output=True, text=True, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr


def test_programs_and_the_package_are_checked_strictly(tmp_path: Path) -> None:
    (tmp_path / "user.py").write_text(USER)
    run("mypy", "--strict", "-p", "caustica", folder=tmp_path)
    run("mypy", "--strict", "user.py", folder=tmp_path)


def test_the_stub_is_right(tmp_path: Path) -> None:
    run("mypy.stubtest", "caustica._native", folder=tmp_path)
