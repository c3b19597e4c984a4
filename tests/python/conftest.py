"""What the tests of the Python package share."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import kappaflow

SOURCE = Path(__file__).resolve().parents[2]
SCENE = SOURCE / "scenes/staircase-small.toml"
METHODS = ["total", "curvature", "regional"]


@pytest.fixture(scope="session")
def program():
    """The program, which what the package does is held against."""
    path = Path(os.environ.get("KAPPAFLOW_PROGRAM", SOURCE / "build/release/tools/kappaflow"))
    if not path.exists():
        pytest.skip(f"{path} is not built; KAPPAFLOW_PROGRAM says where the program is")
    return path


@pytest.fixture(scope="session")
def staircase(program, tmp_path_factory):
    """A run of the small staircase by the program."""
    folder = tmp_path_factory.mktemp("program") / "staircase"
    subprocess.run([program, "run", SCENE, "--track", ",".join(METHODS), "--out", folder, "--quiet"], check=True)
    return folder


@pytest.fixture(params=[1, 2])
def threads(request):
    """The test runs with one thread, and with two."""
    kappaflow.set_threads(request.param)
    yield request.param
    kappaflow.set_threads(None)


def ball(spacing=0.1, radius=0.42):
    """Particles on a lattice in a ball about the origin."""
    axis = spacing * np.arange(-10, 11)
    lattice = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    return lattice[np.linalg.norm(lattice, axis=1) < radius]


def same_bits(a, b):
    """Whether two arrays are of one shape and type, and bit for bit equal."""
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
