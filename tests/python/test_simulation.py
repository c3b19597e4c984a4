"""simulate() against the program's run, bit for bit."""

import subprocess

import numpy as np
import pytest
from conftest import METHODS, SCENE, same_bits
from test_tracker import assert_same_mesh

import kappaflow

SHORT = SCENE.read_text().replace("duration = 0.4 ", "duration = 0.05 ")


def test_every_frame_is_what_the_program_writes(staircase, threads):
    run = kappaflow.read_run(staircase)
    simulation = kappaflow.simulate(SCENE, methods=METHODS)
    assert (simulation.sigma, simulation.threshold) == (run.record["sigma"], run.record["threshold"])
    assert simulation.methods == METHODS and simulation.title == run.record["scene"]["title"]
    for frame in simulation.frames():
        assert simulation.time == pytest.approx(run.times[frame], abs=1e-12)
        particles, written = simulation.particles(), run.particles[frame]
        assert same_bits(particles.positions, written.positions)
        for name in ("id", "velocity", "density", "pressure", "source"):
            assert same_bits(particles[name].astype(written[name].dtype), written[name]), name
        for method in METHODS:
            assert_same_mesh(simulation.mesh(method), run.meshes(method)[frame])
    assert simulation.done and simulation.frame == simulation.last_frame == len(run) - 1


def test_step_by_step_is_the_same_as_frame_by_frame():
    by_frames, by_steps = kappaflow.simulate(SHORT), kappaflow.simulate(SHORT)
    by_frames.advance()
    steps = []
    while by_steps.frame == 0:
        before = by_steps.time
        steps.append(by_steps.step())
        assert by_steps.time == pytest.approx(before + steps[-1].time_step)
    assert len(steps) > 1 and by_steps.time == by_frames.time
    assert same_bits(by_steps.mesh().positions, by_frames.mesh().positions)
    assert same_bits(by_steps.particles()["velocity"], by_frames.particles()["velocity"])
    assert max(step.viscosity_error for step in steps) <= 1 and max(step.fastest for step in steps) > 1
    assert [by_frames.last_frame, *by_frames.frames()] == [2, 1, 2]
    assert by_frames.time == pytest.approx(0.05)


def test_a_pair_of_rest_positions_is_what_the_program_writes(program, tmp_path):
    scene = tmp_path / "pair.toml"
    scene.write_text(SHORT.replace("duration = 0.05 ", "duration = 0.2 ").replace("[output]", "[output]\nrest_interval = 2"))
    subprocess.run([program, "run", scene, "--track", "total,regional", "--out", tmp_path / "run", "--quiet"], check=True)
    meshes = kappaflow.read_run(tmp_path / "run").meshes("regional")
    simulation = kappaflow.simulate(scene, methods=["total", "regional"])
    for frame in simulation.frames():
        mesh = simulation.mesh("regional")
        for name in ("rest_1", "rest_2", "rest_2_weight"):
            assert same_bits(mesh[name], meshes[frame][name]), (frame, name)
        if frame % 4 == 0:  # the first surface, when rest_1 was reset
            first = simulation.mesh().positions
        texture = kappaflow.texture_coordinates(mesh["rest_1"], first)
        assert same_bits(texture.astype(np.float32), meshes[frame]["texture_1"])
    assert simulation.frame == 5 and 0 < mesh["rest_2_weight"].max() < 1
    assert "rest_1" not in kappaflow.simulate(SHORT).mesh().arrays


def test_methods_and_walls():
    simulation = kappaflow.simulate(SHORT, methods="regional", duration=0.04)
    assert simulation.methods == ["regional"] and simulation.last_frame == 1
    (vertices, triangles), = simulation.walls()
    assert vertices.shape[1] == 3 and triangles.max() == len(vertices) - 1
    assert np.ptp(vertices[:, 2]) == pytest.approx(1.6)  # the staircase's width


def test_what_is_wrong_with_a_scene_is_said_as_the_program_says_it(tmp_path):
    with pytest.raises(kappaflow.InvalidInput, match=r"^scene.toml:\d+:\d+: .*viscosity"):
        kappaflow.simulate(SHORT.replace("kinematic_viscosity", "kinematic_viscositi"))
    with pytest.raises(kappaflow.InvalidInput, match="unknown method 'wind'; methods are normal, total"):
        kappaflow.simulate(SHORT, methods=["wind"])
    with pytest.raises(kappaflow.InvalidInput, match="no velocity method to track with"):
        kappaflow.simulate(SHORT, methods=[])
    with pytest.raises(kappaflow.Error, match="nowhere.toml"):
        kappaflow.simulate(tmp_path / "nowhere.toml")
    simulation = kappaflow.simulate(SHORT, duration=0.01)
    with pytest.raises(kappaflow.InvalidInput, match="no surface moves by 'regional'; there are total, curvature"):
        simulation.mesh("regional")
    simulation.advance()
    for go_on in (simulation.advance, simulation.step):
        with pytest.raises(kappaflow.InvalidInput, match="scene.toml: the scene is at its end, t = 0.01 s"):
            go_on()


def test_particles_of_a_failure_can_be_looked_at():
    simulation = kappaflow.simulate(SHORT + "\n[solver]\nmax_viscosity_iterations = 1\n")
    with pytest.raises(kappaflow.SolverFailure, match="raise max_viscosity_iterations"):
        simulation.advance()
    assert np.isfinite(simulation.particles().positions).all()
    with pytest.raises(kappaflow.InvalidInput, match="Simulation: it failed before, and can go no further"):
        simulation.step()
