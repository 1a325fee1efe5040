"""Loading, looking at scenes, and changing them."""

import copy
import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, Program

import caustica


def test_keyword_arguments_are_the_parameters_of_the_scene(room: Path) -> None:
    assert (caustica.load(room).width, caustica.load(room).height) == (24, 16)
    assert caustica.load(room, width=40).width == 40
    assert caustica.load(room, defines={"width": "12"}).width == 12
    with pytest.raises(caustica.SceneError, match="given by a keyword argument") as parameter:
        caustica.load(room, widht=40)
    assert parameter.value.suggestion == "did you mean `width`?"
    with pytest.raises(caustica.SceneError, match="did you mean the argument `size`") as argument:
        caustica.load(room, sise=(4, 4))  # type: ignore[arg-type]
    assert argument.value.suggestion == "size"
    with pytest.raises(caustica.SettingError, match="invalid value `3` for `sensor`"):
        caustica.load(room, sensor=3)
    wrong: list[tuple[dict[str, Any], str]] = [
        ({"size": 96}, r"invalid value `96` for `size`: expected \(width, height\), such as \(640, 480\)"),
        ({"size": (96,)}, "for `size`"),
        ({"size": "96x96"}, "for `size`"),
        ({"size": (-1, 4)}, "for `size`"),
        ({"size": (0.5, 4)}, "for `size`"),
        ({"crop": (0, 0, 2**40, 1)}, "for `crop`"),
        ({"sensor": "first"}, "invalid value `first` for `sensor`: expected a whole number from 0"),
    ]
    for arguments, message in wrong:
        with pytest.raises(caustica.SettingError, match=message):
            caustica.load(room, **arguments)


def test_options_choose_film_and_filter(room: Path) -> None:
    scene = caustica.load(room, size=(20, 10))
    assert caustica.render(scene, passes=1).shape == (10, 20, 3)
    part = caustica.load(room, crop=(2, 3, 5, 4))
    assert caustica.render(part, passes=1).shape == (4, 5, 3)
    with pytest.raises(caustica.SettingError, match="did you mean `gaussian`"):
        caustica.load(room, filter="gausian")


def test_scenes_print_what_inspect_prints(room: Path, program: Program) -> None:
    scene = caustica.load(room)
    assert str(scene) + "\n" == program.run("inspect", room).stdout
    assert scene.inspect() == json.loads(program.run("inspect", room, "--json").stdout)
    assert scene.settings["kernel"] == "epanechnikov"


def test_values_are_named_by_ids(room: Path) -> None:
    scene = caustica.load(room)
    keys = scene.keys()
    for key in [
        "box.reflectance",
        "wood.data",
        "quad.vertex_positions",
        "quad.faces",
        "quad.to_world",
        "ball.center",
        "ball.radius",
        "ball.bsdf.diffuse_reflectance",
        "ball.bsdf.int_ior",
        "lamp.intensity",
        "lamp.position",
        "camera.to_world",
    ]:
        assert key in keys, key
        assert key in scene
    assert len(set(keys)) == len(keys) == len(scene)
    assert list(scene) == keys


def test_values_are_those_of_the_file(room: Path) -> None:
    scene = caustica.load(room)
    assert np.array_equal(scene["box.reflectance"], [0.2, 0.4, 0.6])
    assert np.array_equal(scene["lamp.intensity"], [9, 9, 9])
    assert np.array_equal(scene["ball.center"], [0.3, 0, 1])
    assert scene["ball.radius"] == 0.4
    # Mitsuba's name `polypropylene`, its default.
    assert scene["ball.bsdf.int_ior"] == pytest.approx(1.49)
    positions, faces = scene["quad.vertex_positions"], scene["quad.faces"]
    assert isinstance(positions, np.ndarray) and isinstance(faces, np.ndarray)
    assert positions.dtype == np.float32 and faces.dtype == np.uint32
    assert {tuple(p) for p in positions.tolist()} == {(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)}
    assert faces.shape == (2, 3)
    wood = scene["wood.data"]
    assert isinstance(wood, np.ndarray) and wood.shape == (2, 2, 3) and wood.dtype == np.float32
    # A light of 1 everywhere is white in the PNG.
    assert np.array_equal(wood, np.ones((2, 2, 3)))
    assert np.array_equal(scene["ball.bsdf.diffuse_reflectance"], wood)


def test_what_is_set_to_itself_changes_nothing(room: Path) -> None:
    before = caustica.render(caustica.load(room), passes=2).numpy()
    scene = caustica.load(room)
    for key in scene.keys():
        scene[key] = scene[key]
    assert np.array_equal(caustica.render(scene, passes=2).numpy(), before)


SCENES = sorted(
    str(path.relative_to(ROOT)) for path in (ROOT / "scenes").rglob("*.*") if path.suffix in (".xml", ".pbrt")
)


@pytest.mark.filterwarnings("ignore::caustica.SceneWarning")
@pytest.mark.parametrize("path", SCENES)
def test_every_value_of_every_scene_can_be_read_and_given_back(path: str) -> None:
    scene = caustica.load(ROOT / path)
    keys = scene.keys()
    assert len(set(keys)) == len(keys) > 3
    for key in keys:
        try:
            value = scene[key]
        except caustica.ArrayError as procedural:
            assert "it is a texture of kind" in str(procedural)
            continue
        scene[key] = value
        assert np.allclose(scene[key], value, rtol=1e-6)
    # It is compiled again.
    assert scene.settings


def test_a_reflectance_scales_the_light_of_its_surface(room: Path) -> None:
    scene = caustica.load(room)
    # Direct light on a diffuse surface is proportional to its albedo; no light comes from elsewhere.
    settings: dict[str, int | str] = {"integrator": "path", "max_depth": 2, "passes": 4}
    before = caustica.render(scene, **settings).numpy()
    scene["box.reflectance"] = 2 * np.asarray(scene["box.reflectance"]) / 3
    after = caustica.render(scene, **settings).numpy()
    corner = before[4, 6]
    assert np.all(corner > 0)
    # 2⁻²² is the rounding of two floats and of the product.
    assert np.allclose(after[4, 6], corner * 2 / 3, rtol=2**-22)


def test_a_picture_takes_the_place_of_a_colour(room: Path) -> None:
    scene = caustica.load(room)
    constant = caustica.render(scene, passes=2).numpy()
    scene["box.reflectance"] = np.broadcast_to([0.2, 0.4, 0.6], (3, 5, 3))
    # 0.2 is another number in single precision: 6·10⁻⁸ apart, and once more for each bounce.
    assert np.allclose(caustica.render(scene, passes=2).numpy(), constant, rtol=1e-5, atol=1e-7)
    left = np.zeros((1, 2, 3))
    left[0, 0] = 0.8
    scene["box.reflectance"] = left
    picture = caustica.render(scene, passes=2, integrator="path", max_depth=2).numpy()
    assert np.all(picture[2, 5] > 0) and np.all(picture[2, 19] == 0)
    assert np.allclose(scene["box.reflectance"], left)


def test_a_picture_of_one_number_is_a_roughness(room: Path, tmp_path: Path) -> None:
    text = room.read_text().replace('type="plastic"', 'type="roughplastic"')
    rough = tmp_path / "rough.xml"
    rough.write_text(text)
    scene = caustica.load(rough)
    assert scene["ball.bsdf.alpha_u"] == 0.1
    scene["ball.bsdf.alpha_u"] = scene["ball.bsdf.alpha_v"] = np.full((2, 2), 0.3)
    assert np.allclose(scene["ball.bsdf.alpha_u"], 0.3)
    # Where a value is looked up, other random numbers are used: the means agree within noise. 512 samples of some
    # hundred pixels that vary as much as their mean err by 0.5 %.
    settings: dict[str, int | str] = {"integrator": "path", "passes": 512}
    textured = caustica.render(scene, **settings).numpy().mean()
    scene["ball.bsdf.alpha_u"] = scene["ball.bsdf.alpha_v"] = float(np.float32(0.3))
    assert caustica.render(scene, **settings).numpy().mean() == pytest.approx(textured, rel=0.02)


def test_vertices_move_the_mesh(room: Path) -> None:
    scene = caustica.load(room)
    settings: dict[str, int | str] = {"integrator": "path", "passes": 1, "layers": "depth"}
    depth = caustica.render(scene, **settings)["depth"]  # type: ignore[arg-type]
    positions = np.array(scene["quad.vertex_positions"])
    scene["quad.vertex_positions"] = positions + [0, 0, -2]
    farther = caustica.render(scene, **settings)["depth"]  # type: ignore[arg-type]
    # From 5 to 7 along the axis. Within this pixel, distances differ by 0.5 %.
    assert farther[4, 10] == pytest.approx(depth[4, 10] * 7 / 5, rel=0.005)
    assert np.array_equal(scene["quad.vertex_positions"], (positions + [0, 0, -2]).astype(np.float32))


def test_a_changed_scene_is_another_scene(room: Path, tmp_path: Path) -> None:
    scene = caustica.load(room)
    checkpoint = tmp_path / "a.ckpt"
    first = caustica.render(scene, passes=2, checkpoint=checkpoint)
    scene["ball.radius"] = 0.5
    second = caustica.render(scene, passes=2)
    assert first.metadata["sceneHash"] != second.metadata["sceneHash"]
    with pytest.raises(caustica.Error, match="cannot resume"):
        caustica.render(scene, passes=4, checkpoint=checkpoint, resume=True)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda s: pickle.loads(pickle.dumps(s))])
def test_copies_and_pickles_render_the_same(room: Path, copied: object) -> None:
    scene = caustica.load(room, width=30)
    scene["box.reflectance"] = np.full((2, 2, 3), 0.3)
    assert callable(copied)
    other = copied(scene)
    assert other.width == 30
    assert caustica.render(other, passes=1).png() == caustica.render(scene, passes=1).png()
    other["box.reflectance"] = 0.7
    assert np.asarray(scene["box.reflectance"]).shape == (2, 2, 3)


def test_pbrt_scenes_have_names_too(root: Path) -> None:
    scene = caustica.load(root / "scenes/cornell-glass.pbrt", size=(16, 16))
    assert "white.reflectance" in scene
    scene["white.reflectance"] = 0.1
    assert np.array_equal(scene["white.reflectance"], [0.1, 0.1, 0.1])
    caustica.render(scene, passes=1)
    # A model that is seen on both sides is called as the whole.
    assert "shape_7.bsdf.reflectance" in scene and "shape_6.bsdf.int_ior" in scene


def test_mistakes_name_the_value_and_what_it_takes(room: Path) -> None:
    scene = caustica.load(room)
    with pytest.raises(KeyError) as unknown:
        scene["box.reflectence"]
    assert isinstance(unknown.value, caustica.UnknownNameError)
    assert unknown.value.suggestion == "box.reflectance"
    assert str(unknown.value) == "the scene has no value `box.reflectence`; did you mean `box.reflectance`?"
    for key, value, what in [
        ("ball.radius", [1, 2], r"`ball.radius` takes one number, not an array of shape \[2\]"),
        ("ball.center", 1, r"takes an array of shape \(3,\)"),
        ("box.reflectance", np.zeros((2, 2, 2)), r"takes a picture of shape \(h, w\) or \(h, w, 3\)"),
        ("quad.vertex_positions", np.zeros((5, 3)), r"takes an array of shape \(4, 3\)"),
        ("quad.faces", [[0, 1, 9]], "a corner is no whole number below 4"),
        ("ball.radius", np.nan, "NaN is not a finite number"),
        ("ball.radius", -1, "`ball.radius`: -1 is not a positive radius"),
        ("ball.radius", 0, "0 is not a positive radius"),
        ("ball.bsdf.int_ior", -1, "-1 is not a positive index of refraction"),
        ("box.reflectance", [2, 0, 0], r"`box.reflectance`: RGB reflectance \(2, 0, 0\) must lie in the range \[0, 1\]"),
        ("box.reflectance", "red", "`box.reflectance`: expected numbers, not 'red'"),
    ]:
        with pytest.raises(caustica.ArrayError, match=what):
            scene[key] = value
    assert caustica.render(scene, passes=1).png() == caustica.render(caustica.load(room), passes=1).png()
    matrix = np.array(scene["quad.to_world"])
    matrix[0, 0] = np.finfo(np.float64).max
    scene["quad.to_world"] = matrix
    # The line of the file has another value.
    with pytest.raises(caustica.SceneError, match=r"changed since the file was read: `quad.to_world`") as refused:
        caustica.render(scene, passes=1)
    assert refused.value.suggestion is None
