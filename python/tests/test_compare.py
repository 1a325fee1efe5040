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
    out = program.run("compare", tmp_path / "a.exr", reference, "--json", "--spp", image.samples).stdout
    theirs = json.loads(out)["comparisons"][0]
    for picture in [image, image.numpy(), tmp_path / "a.exr"]:
        found = caustica.compare(picture, reference, spp=image.samples)
        for name in set(theirs) - {"name", "image", "reference"}:
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
    with pytest.raises(ValueError, match="a picture has shape"):
        caustica.compare(np.zeros(3), gray)
    with pytest.raises(caustica.Error, match="not finite"):
        caustica.compare(np.full((8, 9), np.nan), gray)
    with pytest.raises(caustica.Error, match="different sizes"):
        caustica.compare(gray, np.zeros((4, 4)))
    with pytest.raises(caustica.Error, match="nowhere.exr"):
        caustica.compare(gray, "nowhere.exr")


def test_conversion_writes_what_the_command_line_writes(root: Path, tmp_path: Path, program: Program) -> None:
    source = root / "scenes/cornell-glass.pbrt"
    done = caustica.convert(source, tmp_path / "ours.xml")
    said = program.run("convert", source, tmp_path / "theirs.xml").stderr
    assert (tmp_path / "ours.xml").read_bytes() == (tmp_path / "theirs.xml").read_bytes()
    assert said.count("lost: ") == len(done.losses)
    assert done.shapes > 3
    with pytest.raises(caustica.Error, match="exists"):
        caustica.convert(source, tmp_path / "ours.xml")
    caustica.convert(source, tmp_path / "ours.xml", force=True)
    with pytest.raises(caustica.Error, match="did you mean .xml"):
        caustica.convert(source, tmp_path / "ours.xm")


def test_losses_are_listed(tmp_path: Path) -> None:
    (tmp_path / "a.pbrt").write_text(
        'LookAt 0 0 5 0 0 0 0 1 0 Camera "perspective"\nWorldBegin\nLightSource "point"\n'
        'Texture "n" "spectrum" "marble"\nMaterial "diffuse" "texture reflectance" "n"\nShape "sphere"\n'
    )
    done = caustica.convert(tmp_path / "a.pbrt", tmp_path / "a.xml")
    assert done.losses and "marble" in str(done.losses[0])
    assert done.losses[0].place is not None and done.losses[0].place.endswith("a.pbrt:4:21")
