"""read_run() of what the program wrote. That arrays are what was computed, test_simulation.py and test_tracker.py say."""

import builtins
import csv
import shutil

import numpy as np
import pytest
from conftest import METHODS

import kappaflow


def rows(staircase):
    with open(staircase / "metrics.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_run_and_its_frames(staircase):
    run = kappaflow.read_run(staircase)
    assert len(run) == 11 and run.methods == METHODS and run.folder == staircase
    np.testing.assert_allclose(run.times, np.arange(11) / 25)
    mesh = run.meshes("regional")[10]
    assert mesh.time == pytest.approx(0.4) and mesh.positions.dtype == np.float64
    assert mesh.arrays.keys() >= {"TCoords", "checker", "Normals", "velocity", "rest_position", "id", "source"}
    assert mesh["TCoords"].shape == (len(mesh), 2) and mesh["checker"].dtype == np.uint8
    last = [row for row in rows(staircase) if row["method"] == "regional"][-1]
    assert int(last["vertices"]) == len(mesh) and int(last["triangles"]) == len(mesh.triangles)
    assert int(last["particles"]) == len(run.particles[-1]) and run.particles[-1].time == mesh.time
    a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(float(last["volume"]), rel=1e-9)
    assert len(run.meshes()[2:5]) == 3 and run.meshes()[2:5][0].time == run.times[2]
    walls = run.walls[3]
    assert walls.triangles.shape[1] == 3 and np.ptp(walls.positions[:, 2]) == pytest.approx(1.6, rel=1e-6)


def test_particles_may_lie_in_pieces(staircase, tmp_path):
    """As ranks write them: here one frame as two pieces that are the same file."""
    folder = tmp_path / "copy"
    shutil.copytree(staircase, folder)
    whole = kappaflow.read_run(folder).particles[3]
    collection = folder / "particles.pvd"
    collection.write_text(collection.read_text().replace("particles_0003.vtp", "particles_0003.pvtp"))
    listed = folder / "particles/particles_0003.pvtp"
    listed.write_text('<VTKFile type="PPolyData"><PPolyData><Piece Source="particles_0003.vtp"/>'
                      '<Piece Source="particles_0003.vtp"/></PPolyData></VTKFile>')
    particles = kappaflow.read_run(folder).particles[3]
    assert particles.time == whole.time
    np.testing.assert_array_equal(particles.positions, np.concatenate([whole.positions] * 2))
    np.testing.assert_array_equal(particles["id"], np.concatenate([whole["id"]] * 2))
    listed.write_text('<VTKFile type="PPolyData"><PPolyData/></VTKFile>')
    with pytest.raises(kappaflow.IoError, match="lists no pieces"):
        kappaflow.read_run(folder).particles[3]


def test_frames_are_read_when_they_are_asked_for(staircase, tmp_path):
    folder = tmp_path / "copy"
    shutil.copytree(staircase, folder)
    (folder / "surface-total/surface_0003.vtp").write_bytes(b"<VTKFile")
    (folder / "surface-total/surface_0004.vtp").unlink()
    meshes = kappaflow.read_run(folder).meshes("total")
    assert len(meshes) == 11 and meshes[2].time == pytest.approx(0.08)
    with pytest.raises(kappaflow.IoError, match="surface_0003.vtp: is damaged, or no .vtp file of kappaflow's"):
        meshes[3]
    with pytest.raises(kappaflow.IoError, match="surface_0004.vtp: No such file or directory"):
        meshes[4]
    with pytest.raises(IndexError):
        meshes[11]


def test_metrics_are_a_table(staircase):
    pandas = pytest.importorskip("pandas")
    metrics = kappaflow.read_run(staircase).metrics
    assert isinstance(metrics, pandas.DataFrame) and len(metrics) == 33
    expected = [float(row["slip"] or "nan") for row in rows(staircase)]
    np.testing.assert_array_equal(metrics["slip"], expected)
    assert metrics.groupby("method")["frame"].max().to_dict() == dict.fromkeys(METHODS, 10)


def test_without_pandas_metrics_are_arrays(staircase, monkeypatch):
    real = builtins.__import__

    def without_pandas(name, *args, **kwargs):
        if name == "pandas":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.setattr(builtins, "__import__", without_pandas)
    run = kappaflow.read_run(staircase)
    metrics = run.metrics
    assert metrics["frame"].dtype == np.int64 and metrics["method"][:3].tolist() == METHODS
    np.testing.assert_array_equal(metrics["slip"], [float(row["slip"] or "nan") for row in rows(staircase)])
    assert set(run.pieces) == {"frame", "time", "method", "piece", "vertices", "rotation_captured"} and "solver_ms" in run.timings


def test_what_is_no_run_is_said(staircase, tmp_path):
    with pytest.raises(kappaflow.IoError, match="run.json: No such file or directory"):
        kappaflow.read_run(tmp_path)
    (tmp_path / "run.json").write_text("[]")
    with pytest.raises(kappaflow.IoError, match="run.json: is not the record of a run"):
        kappaflow.read_run(tmp_path)
    (tmp_path / "run.json").write_text('{"methods": ["total"]}')
    assert len(kappaflow.read_run(tmp_path)) == 0
    with pytest.raises(kappaflow.InvalidInput, match='has no surface tracked with "wind"'):
        kappaflow.read_run(staircase).meshes("wind")
