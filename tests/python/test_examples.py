"""The notebooks run from end to end: in Jupyter's kernel where nbclient is installed, else cell by cell in this Python."""

import importlib.util
import json
import shutil
import subprocess
import sys

import numpy as np
import pytest
from conftest import SOURCE

NOTEBOOKS = sorted((SOURCE / "examples/python").glob("*.ipynb"))


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(notebook, tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    monkeypatch.setenv("MPLBACKEND", "agg")
    shutil.copytree(SOURCE / "scenes", tmp_path / "scenes")
    if all(importlib.util.find_spec(module) for module in ("nbclient", "nbformat", "ipykernel")):
        run_in_jupyter(notebook, tmp_path)
    else:
        monkeypatch.chdir(tmp_path)
        run_here(notebook)


def run_in_jupyter(notebook, folder):
    import nbclient
    import nbformat

    nbclient.NotebookClient(nbformat.read(notebook, 4), timeout=600, resources={"metadata": {"path": str(folder)}}).execute()


def run_here(notebook):
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    names = {}
    for cell in cells:
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), notebook.name, "exec"), names)


def test_the_level_set_stays_a_distance(tmp_path):
    """Two drops in a vortex on a coarse grid: their volume and the distance's slope at the surface after a quarter turn."""
    script = [sys.executable, SOURCE / "examples/level_set.py", "--out", tmp_path, "--cells", "24", "--frames", "9", "--velocity"]
    subprocess.run(script, check=True, capture_output=True)
    images = sorted(tmp_path.glob("phi_*.vti"))
    assert len(images) == 9
    spacing, volume = 1.8 / 24, []
    for image in (images[0], images[2]):
        head, data = image.read_bytes().split(b'encoding="raw">_')
        assert b'WholeExtent="0 24 0 24 0 18"' in head and b'Name="velocity" NumberOfComponents="3"' in head
        phi = np.frombuffer(data, "<f4", 25 * 25 * 19, 8).reshape(19, 25, 25)
        inside = np.clip(0.5 - phi / spacing, 0, 1)
        volume.append(inside.sum() * spacing**3)
    assert volume[0] == pytest.approx(2 * 4 / 3 * np.pi * 0.3**3, rel=0.05)
    assert volume[1] == pytest.approx(volume[0], rel=0.05)
    slope = np.linalg.norm(np.gradient(phi, spacing), axis=0)[np.abs(phi) < 0.5 * spacing]
    assert np.median(slope) == pytest.approx(1, abs=0.1)


def test_notebooks_are_there_and_hold_no_output():
    assert [path.stem for path in NOTEBOOKS] == ["compare_methods", "track_particles"]
    for path in NOTEBOOKS:
        assert all(not cell.get("outputs") for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]), path.name


def test_the_code_of_the_page_is_python():
    page = (SOURCE / "docs/python.md").read_text(encoding="utf-8")
    blocks = [block.split("\n```")[0] for block in page.split("```python\n")[1:]]
    assert len(blocks) == 4
    for block in blocks:
        compile(block, "docs/python.md", "exec")
