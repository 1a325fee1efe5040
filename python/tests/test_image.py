"""Pictures: arrays, layers, files."""

from pathlib import Path

import numpy as np
import pytest

import caustica


@pytest.fixture(scope="module")
def image() -> caustica.Image:
    root = Path(__file__).resolve().parents[2]
    scene = caustica.load(root / "scenes/cornell-glass.xml", size=(40, 24))
    return caustica.render(scene, passes=4, layers="albedo,depth,uv")


def test_arrays_are_float32_with_rows_from_the_top(image: caustica.Image) -> None:
    rgb = image.numpy()
    assert rgb.shape == image.shape == (24, 40, 3) and rgb.dtype == np.float32
    # The left wall is red, the right one green; the lamp is above.
    left, right = rgb[:, 3].mean(axis=0), rgb[:, 36].mean(axis=0)
    assert left[0] > left[1] and right[1] > right[0]
    assert rgb[:6].mean() > rgb[-6:].mean()
    assert np.array_equal(np.asarray(image), rgb)
    assert np.asarray(image, dtype=np.float64).dtype == np.float64


def test_parts_add_up_to_the_picture(image: caustica.Image) -> None:
    parts = [image[name] for name in ["emission", "direct", "caustic", "indirect"]]
    assert all(part.shape == image.shape and part.dtype == np.float32 for part in parts)
    # Each part is rounded once, the sum too: five roundings of 2⁻²⁴.
    assert np.allclose(sum(parts), image.numpy(), rtol=5 * 2**-24, atol=1e-9)
    assert image["caustic"].max() > 0


def test_layers_have_the_shape_of_their_channels(image: caustica.Image) -> None:
    assert image.keys()[:3] == ["albedo", "depth", "uv"]
    assert image["albedo"].shape == (24, 40, 3)
    assert image["uv"].shape == (24, 40, 2) and image.channels("uv") == ["U", "V"]
    assert image["depth"].shape == image["variance"].shape == image.alpha.shape == (24, 40)
    # Noisy pixels take more of them than others.
    assert abs(image["samples"].mean() - image.samples) <= 0.5
    assert np.all(image["samples"] % 1 == 0) and image["samples"].min() >= image.passes
    assert np.all((image.alpha >= 0) & (image.alpha <= 1))
    assert "medium" not in image and "caustic" in image
    with pytest.raises(KeyError, match="no layer `caustics`; did you mean `caustic`"):
        image["caustics"]


def test_pictures_say_what_they_are(image: caustica.Image) -> None:
    assert image.passes == 4 and image.stop == "passes"
    assert image.error is not None and 0 < image.error < 1
    assert repr(image).startswith("<caustica.Image 40×24, 4 passes, error ")
    assert image.metadata["passes"] == "4" and image.settings["seed"] == "0"
    assert image.png().startswith(b"\x89PNG") and image.png() != image.png(exposure=1)


def test_files_that_cannot_be_written_are_refused(image: caustica.Image, tmp_path: Path) -> None:
    with pytest.raises(caustica.Error, match="the extension is `jpg`"):
        image.save(tmp_path / "a.jpg")
    with pytest.raises(caustica.Error, match="there is no folder"):
        image.save(tmp_path / "none/a.exr")
    with pytest.raises(caustica.Error, match="the scene was read from it"):
        scene = tmp_path / "a.exr"
        text = '<scene version="3.0.0"><emitter type="envmap"><string name="filename" value="a.exr"/></emitter>'
        (tmp_path / "s.xml").write_text(text + '<sensor type="perspective"/></scene>')
        image.save(scene)
        caustica.render(caustica.load(tmp_path / "s.xml", size=(4, 4)), passes=1).save(scene)
    with pytest.raises(TypeError):
        image.save()
