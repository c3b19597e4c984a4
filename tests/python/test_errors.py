"""What is wrong is said in the words of the program, by exceptions that Python knows."""

import subprocess

import numpy as np
import pytest
from conftest import ball

import kappaflow


def moving():
    return ball(), np.zeros_like(ball())


def test_the_family_of_errors():
    for error, builtin, code in ((kappaflow.InvalidInput, ValueError, 2), (kappaflow.SolverFailure, ArithmeticError, 3),
                                 (kappaflow.TopologyError, RuntimeError, 4), (kappaflow.IoError, OSError, 5)):
        assert issubclass(error, kappaflow.Error) and issubclass(error, builtin) and error.exit_code == code
        assert str(error("one line")) == "one line"


@pytest.mark.parametrize(("call", "words"), [
    (lambda: kappaflow.Field(np.zeros((4, 2))), r"positions: an array of shape \(4, 2\); \(n, 3\) is needed"),
    (lambda: kappaflow.Field([[1, 2], [3]]), r"positions: no array of float64; one of shape \(n, 3\) is needed"),
    (lambda: kappaflow.Field([["a", "b", "c"]]), r"positions: no array of float64; one of shape \(n, 3\) is needed"),
    (lambda: kappaflow.Field(ball(), np.zeros((4, 3))), r"velocities: an array of shape \(4, 3\); \(\d+, 3\) is needed"),
    (lambda: kappaflow.Field(ball()).values([1, 2, 3]), r"points: an array of shape \(3,\); \(n, 3\) is needed"),
    (lambda: kappaflow.Tracker(ball(), np.zeros_like(ball()), anchor="ids"), "anchor: 'ids'; allowed are none, particles"),
    (lambda: kappaflow.Tracker(ball(), anchor="particles"), "the particles: textures from particles take particles with ids"),
    (lambda: kappaflow.Field(ball(), weights="heavy"), "weights: 'heavy'; allowed are uniform, normalised"),
    (lambda: kappaflow.Field(ball(), kernels="square"), "kernels: 'square'; allowed are round, anisotropic"),
    (lambda: kappaflow.Field(ball(), sigma=-1), "sigma"),
    (lambda: kappaflow.Field([[0, 0, 0], [0, 0, 0]]), "half of the particles"),
    (lambda: kappaflow.Field(ball() * np.nan, sigma=1, threshold=1), "not finite"),
    (lambda: kappaflow.Field(ball()).velocities([[0, 0, 0]], "wind"), "unknown velocity method 'wind'; methods are normal, total"),
    (lambda: kappaflow.Field(ball()).velocities([[0, 0, 0]], 7), "7 is no velocity method; it takes a name or a function"),
    (lambda: kappaflow.Field(ball()).velocities([[0, 0, 0]], "total", triangles=[[0, 0, 4]]),
     "triangles: vertices 0 to 4; 0 to 0 are there"),
    (lambda: kappaflow.Tracker(*moving(), threshold=1e6), "the surface is empty: the field stays below its threshold"),
    (lambda: kappaflow.Tracker(*moving(), ids=np.zeros(len(ball()), int)), "ids"),
    (lambda: kappaflow.Tracker(*moving(), ids=np.linspace(0, 1, len(ball()))), r"ids: no array of int64; one of shape \(\d+,\)"),
    (lambda: kappaflow.Tracker(*moving(), sources=np.full(len(ball()), 2**31)), "sources: a number does not fit into int32"),
    (lambda: kappaflow.Field(ball(), sigma=1, threshold=1, scales=np.zeros(len(ball()))), "particle 0: its scale is 0; it must be positive"),
    (lambda: kappaflow.Tracker(ball(), ids=np.arange(len(ball()))), "ids: they need velocities"),
    (lambda: kappaflow.Tracker(*moving()).advance(*moving(), time=0), "a motion from 0 s to 0 s; its end must be later"),
    (lambda: kappaflow.Tracker(*moving()).advance(ball(), time=1), "velocities: they are given at some instants and not at others"),
    (lambda: kappaflow.Tracker(*moving()).mesh(1), "surface 1: there are 1, from 0"),
    (lambda: kappaflow.Tracker(*moving()).mesh()["colour"], "no array 'colour'; there are Normals, velocity"),
    (lambda: kappaflow.Tracker(*moving()).add_array("a", "x"), "array 'a': 'x'; a number or 3 numbers are needed"),
    (lambda: kappaflow.Tracker(*moving()).add_array("a", 1, "throw"), "carry: 'throw'; allowed are interpolate, nearest, recompute"),
    (lambda: kappaflow.Tracker(*moving()).add_array("id", 1), "id"),
    (lambda: kappaflow.Tracker(*moving()).set_array("a", [1.0]), "'a'"),
    (lambda: kappaflow.set_threads(0), "threads: 0; at least 1 is needed"),
])
def test_what_is_wrong_with_input_is_said(call, words):
    with pytest.raises(kappaflow.InvalidInput, match=words) as raised:
        call()
    assert "\n" not in str(raised.value)


def test_a_scenes_mistake_has_the_programs_words(program, tmp_path):
    scene = tmp_path / "broken.toml"
    scene.write_text('title = "x"\nduration = -1\n')
    said = subprocess.run([program, "check", scene], capture_output=True, text=True, check=False)
    with pytest.raises(kappaflow.InvalidInput) as raised:
        kappaflow.simulate(scene)
    assert said.stderr == f"kappaflow: error: {raised.value}\n"
    assert said.returncode == raised.value.exit_code


def test_a_missing_scene_has_the_programs_words(program, tmp_path):
    said = subprocess.run([program, "check", tmp_path / "none.toml"], capture_output=True, text=True, check=False)
    with pytest.raises(kappaflow.Error) as raised:
        kappaflow.simulate(tmp_path / "none.toml")
    assert said.stderr == f"kappaflow: error: {raised.value}\n" and said.returncode == raised.value.exit_code
