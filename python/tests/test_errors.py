"""Exceptions carry what is wrong, and where."""

import pickle
from pathlib import Path

import pytest
from conftest import Program

import caustica

BAD = """<scene version="3.0.0">
    <sensor type="perspective"/>
    <shape type="sphere">
        <float name="raduis" value="2"/>
    </shape>
    <shape type="spher"/>
</scene>
"""


def test_every_problem_has_its_place_and_a_suggestion(tmp_path: Path, program: Program) -> None:
    scene = tmp_path / "bad.xml"
    scene.write_text(BAD)
    with pytest.raises(caustica.SceneError) as raised:
        caustica.load(scene)
    error = raised.value
    errors = {d.line: d for d in error.diagnostics if d.severity == "error"}
    assert set(errors) == {4, 6}
    first = errors[4]
    assert first.file == str(scene) and first.column is not None
    assert "raduis" in first.text and first.source == '        <float name="raduis" value="2"/>'
    assert first.suggestion == error.suggestion == "did you mean `radius`?"
    assert str(first) == f"{scene}:4:{first.column}: error: {first.text}"
    # The message is what the command line prints, but for the words of its options.
    printed = program.run("render", scene, status=1).stderr
    assert "--lenient" in printed
    assert printed.replace("--lenient", "lenient=True") == f"{error}\n"


def test_errors_can_be_pickled(tmp_path: Path) -> None:
    (tmp_path / "bad.xml").write_text(BAD)
    with pytest.raises(caustica.SceneError) as raised:
        caustica.load(tmp_path / "bad.xml")
    other = pickle.loads(pickle.dumps(raised.value))
    assert str(other) == str(raised.value) and other.diagnostics == raised.value.diagnostics


def test_a_missing_file_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(caustica.Error, match="none.xml"):
        caustica.load(tmp_path / "none.xml")
    with pytest.raises(caustica.Error, match="the extension decides"):
        caustica.load(tmp_path / "scene.obj")


def test_what_is_not_rendered_as_written_is_a_warning(tmp_path: Path) -> None:
    scene = tmp_path / "s.xml"
    scene.write_text(
        '<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>\n'
        '<integrator type="bdpt"/></scene>'
    )
    with pytest.warns(caustica.SceneWarning, match="s.xml:2:.*bdpt"):
        loaded = caustica.load(scene)
    assert [d.severity for d in loaded.diagnostics] == ["warning"]
    with pytest.raises(caustica.SceneWarning):
        # Tests of the package turn these warnings into errors.
        caustica.load(scene)
