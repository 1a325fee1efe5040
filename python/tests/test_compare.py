"""Comparing and converting: the numbers and files of the command line."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import Program

import caustica


def test_numbers_are_those_of_the_command_line(root: Path, tmp_path: Path, program: Program) -> None:
    scene = caustica.load(root / "scenes/cornell-owner.xml", size=(96, 96), photons=20000, spp=2)
    image = caustica.render(scene)
    image.save(tmp_path / "a.exr")
    reference = root / "reference/cornell-owner.exr"
    out = program.run("compare", tmp_path / "a.exr", reference, "--json").stdout
    theirs = json.loads(out)["comparisons"][0]
    # An array tells nothing of noise.
    own = {"name", "image", "reference", "seconds"}
    for picture, less in [(image.numpy(), {"z_test", "notes", "checks"}), (tmp_path / "a.exr", {}), (image, {})]:
        found = caustica.compare(picture, reference)
        for name in set(theirs) - own - set(less):
            assert found.numbers[name] == theirs[name], name
    assert found.flip == theirs["flip_ldr"]["mean"] > 0
    assert found.flip_map.shape == (96, 96) and found.flip_map.mean() == pytest.approx(found.flip, rel=1e-5)
    # The mask beside this reference is used, as there.
    assert any("masked out" in note for note in found.notes)
    assert (found.rmse, found.relmse, found.psnr) == (theirs["rmse_all"], theirs["relmse"], theirs["psnr"])


def test_arrays_of_any_kind_are_pictures() -> None:
    gray = np.full((8, 9), 0.5)
    same = caustica.compare(gray, np.full((8, 9, 4), 0.5, dtype=np.float16), hdr=False)
    assert (same.flip, same.rmse, same.psnr, same.hdr_flip) == (0, 0, None, None)
    assert caustica.compare(gray, gray * 2).bias == pytest.approx(-0.5)
    with pytest.raises(caustica.ArrayError, match="a picture has shape"):
        caustica.compare(np.zeros(3), gray)
    with pytest.raises(caustica.Error, match="not finite"):
        caustica.compare(np.full((8, 9), np.nan), gray)
    with pytest.raises(caustica.Error, match="different sizes"):
        caustica.compare(gray, np.zeros((4, 4)))
    with pytest.raises(caustica.Error, match="nowhere.exr"):
        caustica.compare(gray, "nowhere.exr")


def test_conversion_writes_what_the_command_line_writes(root: Path, tmp_path: Path, program: Program) -> None:
    source = root / "scenes/cornell-owner.pbrt"
    for folder in ["ours", "theirs"]:
        (tmp_path / folder).mkdir()
    ours, theirs, report = tmp_path / "ours/a.xml", tmp_path / "theirs/a.xml", tmp_path / "losses.json"
    done = caustica.convert(source, ours)
    program.run("convert", source, theirs, "--report", report)
    files = [f.relative_to(tmp_path / "theirs") for f in (tmp_path / "theirs").rglob("*") if f.is_file()]
    assert files
    for file in files:
        assert (tmp_path / "ours" / file).read_bytes() == (tmp_path / "theirs" / file).read_bytes()
    assert [vars(loss) for loss in done.losses] == json.loads(report.read_text())
    assert done.losses and done.shapes > 3 and str(source) in str(done.losses[0])
    with pytest.raises(caustica.Error, match="a.xml exists; force=True replaces it"):
        caustica.convert(source, ours)
    caustica.convert(source, ours, force=True)
    with pytest.raises(caustica.Error, match="did you mean .xml"):
        caustica.convert(source, tmp_path / "ours.xm")

