"""The examples of the documents and the notebook run as they stand."""

import json
import re
from pathlib import Path

import pytest


def examples(page: Path) -> list[str]:
    """The blocks of Python of a page."""
    return re.findall(r"^```python\n(.*?)^```$", page.read_text(), flags=re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", ["README.md", "docs/python.md"])
def test_examples_run(page: str, root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # What they write stays here, and what they read is there.
    for name in ["scenes", "reference"]:
        (tmp_path / name).symlink_to(root / name)
    monkeypatch.chdir(tmp_path)
    blocks = examples(root / page)
    assert blocks
    # One after another, as a reader would try them.
    names: dict[str, object] = {"__name__": "__main__"}
    for block in blocks:
        exec(compile(block, page, "exec"), names)


def test_the_notebook_runs(root: Path) -> None:
    nbformat = pytest.importorskip("nbformat")
    client = pytest.importorskip("nbclient")
    file = root / "docs/photon-study.ipynb"
    notebook = nbformat.read(file, as_version=4)
    client.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": root / "docs"}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    pictures = [o for o in outputs if "image/png" in o.get("data", {})]
    assert len(pictures) >= 3, "pictures and plots are shown"
    # The stored notebook shows them as well, to those who only read it.
    stored = json.loads(file.read_text())
    kinds = [key for c in stored["cells"] for o in c.get("outputs", []) for key in o.get("data", {})]
    assert kinds.count("image/png") >= 3
