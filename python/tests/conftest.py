"""Scenes for the tests, and the command line to compare with."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

ROOM = """<scene version="3.0.0">
    <default name="width" value="24"/>
    <sensor type="perspective" id="camera">
        <float name="fov" value="40"/>
        <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="$width"/><integer name="height" value="16"/><rfilter type="box"/>
        </film>
    </sensor>
    <bsdf type="diffuse" id="box"><rgb name="reflectance" value="0.2, 0.4, 0.6"/></bsdf>
    <texture type="bitmap" id="wood"><string name="filename" value="wood.png"/></texture>
    <shape type="obj" id="quad">
        <string name="filename" value="quad.obj"/>
        <ref id="box"/>
    </shape>
    <shape type="sphere" id="ball">
        <point name="center" value="0.3, 0, 1"/><float name="radius" value="0.4"/>
        <bsdf type="plastic"><ref id="wood" name="diffuse_reflectance"/></bsdf>
    </shape>
    <emitter type="point" id="lamp">
        <point name="position" value="0, 2, 3"/><rgb name="intensity" value="9"/>
    </emitter>
</scene>
"""

QUAD = """v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
f 1/1 2/2 3/3 4/4
"""


@pytest.fixture
def root() -> Path:
    """The repository."""
    return ROOT


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """A scene of a mesh, a textured ball and a lamp, 24 × 16 pixels."""
    from caustica import load

    (tmp_path / "room.xml").write_text(ROOM)
    (tmp_path / "quad.obj").write_text(QUAD)
    # Four pixels: a picture of a picture, written by the package itself.
    plain = tmp_path / "plain.xml"
    plain.write_text('<scene version="3.0.0"><emitter type="constant"/><sensor type="perspective"/></scene>')
    from caustica import render

    render(load(plain, size=(2, 2)), passes=1).save(tmp_path / "wood.png")
    return tmp_path / "room.xml"


class Program:
    """The command line."""

    def __init__(self, path: str) -> None:
        self.path = path

    def run(self, *arguments: object, status: int = 0) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [self.path, *map(str, arguments)], capture_output=True, text=True, cwd=ROOT, check=False
        )
        assert done.returncode == status, done.stderr
        return done

    def rendered(self, folder: Path, *arguments: object, extension: str = "exr") -> bytes:
        """The bytes of the picture that `render` writes."""
        output = folder / f"by-program.{extension}"
        self.run("render", *arguments, "-o", output, "-q")
        return output.read_bytes()


@pytest.fixture
def program() -> Program:
    """The command line of the same build, by the variable CAUSTICA."""
    path = os.environ.get("CAUSTICA")
    if path is None:
        pytest.skip("CAUSTICA=target/release/caustica names the program to compare with")
    return Program(path)
