"""Tracker against motions that are known, and against `kappaflow track`, bit for bit."""

import subprocess

import numpy as np
import pytest
from conftest import METHODS, ball, same_bits

import kappaflow

DRIFT = np.array([0.5, -0.2, 0.1])
IN_FILES = {"Normals": "f4", "velocity": "f4", "confidence": "f4", "mean_curvature": "f4", "gaussian_curvature": "f4",
            "rest_position": "f8", "id": "i8", "source": "i4", "material_slip": "f4", "unprojected": "u1"}


def drifting(time):
    position = ball()
    return position + time * DRIFT, np.tile(DRIFT, (len(position), 1))


def assert_same_mesh(mesh, file):
    """A mesh in memory has the bits of the program's file, rounded as files are."""
    assert same_bits(mesh.positions, file.positions)
    assert np.array_equal(mesh.triangles, file.triangles)
    for name, dtype in IN_FILES.items():
        assert same_bits(mesh[name].astype(dtype), file[name].reshape(mesh[name].shape)), name


@pytest.mark.parametrize("method", ["material", "regional"])
def test_a_drifting_ball_takes_its_surface_along(method):
    tracker = kappaflow.Tracker(*drifting(0), methods=method)
    first = tracker.mesh()
    for frame in range(1, 4):
        tracker.advance(*drifting(0.1 * frame), time=0.1 * frame)
    last = tracker.mesh()
    assert last.time == tracker.time == pytest.approx(0.3) and first.time == 0
    np.testing.assert_allclose(last.positions, last["rest_position"] + 0.3 * DRIFT, atol=1e-3)
    np.testing.assert_allclose(last["velocity"], np.tile(DRIFT, (len(last), 1)), atol=1e-6)
    np.testing.assert_allclose(last["material_velocity"], last["velocity"], atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(last["Normals"], axis=1), 1)
    assert last["material_slip"].max() < 1e-6 and not last["unprojected"].any() and last["confidence"].max() <= 1


def test_anisotropic_kernels_make_a_ball_rounder():
    def roughness(kernels):
        tracker = kappaflow.Tracker(*drifting(0), kernels=kernels)
        tracker.advance(*drifting(0.1), time=0.1)
        return np.linalg.norm(tracker.mesh().positions - 0.1 * DRIFT, axis=1).std()

    assert roughness("anisotropic") < 0.5 * roughness("round")


def test_a_mesh_is_closed_and_its_areas_add_up():
    mesh = kappaflow.Tracker(*drifting(0)).mesh()
    edges = np.sort(np.concatenate([mesh.triangles[:, [0, 1]], mesh.triangles[:, [1, 2]], mesh.triangles[:, [2, 0]]]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
    assert mesh["area"].sum() == pytest.approx(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)
    assert len(mesh) == len(mesh.positions) and mesh["id"].tolist() == list(range(len(mesh)))


def test_a_mesh_stays_as_it_is_when_the_tracker_goes_on():
    tracker = kappaflow.Tracker(*drifting(0))
    mesh = tracker.mesh()
    before = {name: values.copy() for name, values in mesh.arrays.items()}
    positions = mesh.positions.copy()
    tracker.advance(*drifting(0.1), time=0.1)
    del tracker
    assert same_bits(mesh.positions, positions) and all(same_bits(mesh[name], values) for name, values in before.items())


def test_ids_pair_particles_whatever_their_order():
    def advanced(order_of):
        tracker = kappaflow.Tracker(*drifting(0), np.arange(len(ball())))
        position, velocity = drifting(0.1)
        order = order_of(len(position))
        tracker.advance(position[order], velocity[order], order, time=0.1)
        return tracker.mesh().positions

    assert same_bits(advanced(np.arange), advanced(lambda n: np.arange(n)[::-1]))


def test_sources_are_those_of_the_nearest_particles():
    position, velocity = drifting(0)
    source = np.arange(len(position))[::-1] + 3
    mesh = kappaflow.Tracker(position, velocity, sources=source).mesh()
    distance = np.linalg.norm(mesh.positions[:, None] - position, axis=2)
    unique = np.partition(distance, 1, axis=1)
    unique = unique[:, 1] - unique[:, 0] > 1e-9
    assert unique.sum() > 100 and (mesh["source"][unique] == source[distance.argmin(1)][unique]).all()
    assert "source" not in kappaflow.Tracker(*drifting(0)).mesh().arrays


def test_larger_particles_have_larger_surfaces():
    x = np.array([[0.0, 0, 0], [10, 0, 0]])
    mesh = kappaflow.Tracker(x, np.zeros_like(x), sigma=1, threshold=0.3, scales=[1, 2]).mesh()
    radius = np.sqrt(1 - 0.3 ** (1 / 3))  # of a lone particle's surface, in its sigma
    near = mesh.positions[:, 0] < 5
    np.testing.assert_allclose(np.linalg.norm(mesh.positions[near], axis=1), radius, atol=2e-4)
    np.testing.assert_allclose(np.linalg.norm(mesh.positions[~near] - [10, 0, 0], axis=1), 2 * radius, atol=2e-4)


def test_an_anchor_takes_the_drift_away():
    """Of `normal` on a ball that turns about its own axis, which sees nothing of the motion."""
    def turning(time):
        spin, position = np.array([0, 0, 2.0]), ball()
        turn = np.array([[np.cos(2 * time), -np.sin(2 * time), 0], [np.sin(2 * time), np.cos(2 * time), 0], [0, 0, 1]])
        return position @ turn.T, np.cross(spin, position @ turn.T), turn

    def rest_error(anchor):
        tracker = kappaflow.Tracker(*turning(0)[:2], methods="normal", anchor=anchor)
        for frame in range(1, 6):
            tracker.advance(*turning(0.1 * frame)[:2], time=0.1 * frame)
        mesh = tracker.mesh()
        return np.linalg.norm(mesh.positions @ turning(0.5)[2] - mesh["rest_position"], axis=1).mean() / tracker.sigma

    assert rest_error("none") > 0.5 and rest_error("particles") < 1e-3


def test_arrays_of_ones_own_are_carried_along():
    tracker = kappaflow.Tracker(*drifting(0), methods=["material", "total"])
    tracker.add_array("temperature", 20.0)
    tracker.add_array("patch", 1, "nearest")
    tracker.add_array("wind", [1.0, 2.0, 3.0])
    assert (tracker.mesh(1)["temperature"] == 20).all() and (tracker.mesh()["wind"] == [1, 2, 3]).all()
    height = tracker.mesh()["rest_position"][:, 1]
    tracker.set_array("temperature", height)
    tracker.set_array("patch", np.where(height > 0, 5, 6))
    tracker.advance(*drifting(0.1), time=0.1)
    mesh = tracker.mesh()
    np.testing.assert_allclose(mesh["temperature"], mesh["rest_position"][:, 1], atol=1e-12)  # both are interpolated alike
    assert mesh["patch"].dtype == np.int32 and set(mesh["patch"]) <= {5, 6}


def test_a_point_cloud_needs_neither_velocities_nor_ids():
    tracker = kappaflow.Tracker(drifting(0)[0], next={"positions": drifting(0.02)[0], "time": 0.02})
    mesh = tracker.mesh()
    normal_speed = (mesh["velocity"] * mesh["Normals"]).sum(1)
    np.testing.assert_allclose(normal_speed, mesh["Normals"] @ DRIFT, atol=0.15)  # the rates are differences of fields
    tracker.advance(drifting(0.02)[0], time=0.02)
    assert "material_slip" not in tracker.mesh().arrays
    with pytest.raises(kappaflow.InvalidInput, match=r"^the particles: the surface moves 1\.\d+ sigma since the frame before; without ids"):
        tracker.advance(drifting(0.5)[0], time=0.5)


def test_what_happened_is_counted_once():
    tracker = kappaflow.Tracker(*drifting(0), methods=METHODS)
    assert len(tracker) == 3
    tracker.advance(*drifting(0.1), time=0.1)
    report = tracker.take_report()
    assert len(report) == 3 and 0 < report[0]["residual_max"] <= 1e-4 and report[0]["unprojected"] == 0
    assert tracker.take_report()[0]["residual_max"] == 0


@pytest.mark.parametrize("kernels", ["round", "anisotropic"])
def test_tracking_a_runs_particles_is_what_the_program_does(program, staircase, tmp_path, threads, kernels):
    folder = tmp_path / "tracked"
    subprocess.run([program, "track", staircase / "particles/particles_*.vtp", "--velocity", ",".join(METHODS), "--kernels", kernels,
                    "--out", folder, "--quiet"], check=True)
    expected = kappaflow.read_run(folder)
    frames = [{"positions": p.positions, "velocities": p["velocity"], "ids": p["id"], "time": p.time, "sources": p["source"]}
              for p in kappaflow.read_run(staircase).particles]
    tracker = kappaflow.Tracker(**frames[0], methods=METHODS, next=frames[1], kernels=kernels, edge_length=0.25)  # as the program
    assert (tracker.sigma, tracker.threshold) == (expected.record["sigma"], expected.record["threshold"])
    for number, frame in enumerate(frames):
        if number > 0:
            tracker.advance(**frame)
        for surface, method in enumerate(METHODS):
            assert_same_mesh(tracker.mesh(surface), expected.meshes(method)[number])
