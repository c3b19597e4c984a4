"""Velocity methods that are functions of Python's."""

import gc
import subprocess
import sys
import weakref

import numpy as np
import pytest
from conftest import ball, same_bits

import kappaflow


def turning(time):
    position = ball() + [0.3, 0, 0]
    angle = 0.5 * time
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    position = position @ turn.T
    return position, np.cross([0, 0, 0.5], position)


def tracked(methods, **options):
    tracker = kappaflow.Tracker(*turning(0), methods=methods, **options)
    for frame in (1, 2):
        tracker.advance(*turning(0.1 * frame), time=0.1 * frame)
    return tracker


@pytest.mark.parametrize("name", ["total", "regional"])
def test_a_function_that_calls_a_built_in_method_gives_its_bits(name, threads):
    def mine(field, points, options):
        return field.velocities(points, name, damping=options.damping, speed_limit=options.speed_limit)

    tracker = tracked([name, mine])
    theirs, ours = tracker.mesh(0), tracker.mesh(1)
    assert same_bits(theirs.positions, ours.positions) and same_bits(theirs.triangles, ours.triangles)
    assert all(same_bits(theirs[array], ours[array]) for array in theirs.arrays)


def test_eq_4_in_numpy_is_the_method_normal():
    def eq4(field, points, _options):
        jets = field.jets(points.positions)
        square = (jets.g**2).sum(1)
        return -(jets.f_t / square)[:, None] * jets.g, np.zeros(len(square))

    tracker = tracked(["normal", eq4], speed_limit=100)  # which the numpy function leaves out
    np.testing.assert_allclose(tracker.mesh(1).positions, tracker.mesh(0).positions, atol=1e-9)


def test_what_a_method_is_given():
    seen = {}

    def look(field, points, options):
        seen.update(field=field, points=points, options=options, values=field.values(points.positions), time=field.time)
        return field.velocities(points, "material")

    tracker = kappaflow.Tracker(*turning(0), methods=look, damping=0.3, speed_limit=2)
    tracker.advance(*turning(0.1), time=0.1)
    mesh = tracker.mesh()
    points = seen["points"]
    assert same_bits(np.array(points.positions), mesh.positions) and np.abs(seen["values"]).max() < 1e-2
    assert (seen["options"].damping, seen["options"].speed_limit, seen["time"]) == (0.3, 2, 0.1)
    np.testing.assert_allclose(points.areas, mesh["area"])
    neighbours = points.neighbours[points.ring_starts[5]:points.ring_starts[6]]
    around = mesh.triangles[(mesh.triangles == 5).any(1)]
    assert set(neighbours) == set(around.ravel()) - {5}
    with pytest.raises(ValueError, match="read-only"):
        points.positions[0] = 0
    with pytest.raises(kappaflow.InvalidInput, match="there for the time of its call only"):
        seen["field"].values([[0, 0, 0]])


def test_what_a_method_raises_comes_out_and_ends_the_tracker():
    def bad(_field, points, _options):
        raise KeyError(len(points.positions))

    tracker = kappaflow.Tracker(*turning(0), methods=bad)
    with pytest.raises(KeyError, match=r"^\d+$"):
        tracker.advance(*turning(0.1), time=0.1)
    with pytest.raises(kappaflow.InvalidInput, match="Tracker: it failed before, and can go no further"):
        tracker.mesh()


@pytest.mark.parametrize(("answer", "words"), [
    (lambda n: np.zeros((n, 3)), "the velocity method <lambda> returned ndarray; velocity, confidence is needed"),
    (lambda n: (np.zeros((n, 2)), np.zeros(n)), r"velocity: an array of shape \(\d+, 2\); \(\d+, 3\) is needed"),
    (lambda n: (np.zeros((n, 3)), np.zeros(1)), r"confidence: an array of shape \(1,\); \(\d+,\) is needed"),
])
def test_what_is_wrong_with_an_answer_is_said(answer, words):
    tracker = kappaflow.Tracker(*turning(0), methods=lambda _field, points, _options: answer(len(points.positions)))
    with pytest.raises(kappaflow.InvalidInput, match=words):
        tracker.advance(*turning(0.1), time=0.1)


def test_a_method_may_not_use_the_tracker_that_calls_it():
    def reenter(_field, _points, _options):
        return tracker.mesh()

    tracker = kappaflow.Tracker(*turning(0), methods=reenter)
    with pytest.raises(kappaflow.InvalidInput, match="Tracker: it is at work, in another thread or for the velocity method"):
        tracker.advance(*turning(0.1), time=0.1)


def test_a_tracker_and_a_method_that_keeps_it_are_collected():
    class Method:
        tracker = None

        def __call__(self, field, points, _options):
            return field.velocities(points, "total")

    method = Method()
    method.tracker = kappaflow.Tracker(*turning(0), methods=method)
    method.tracker.advance(*turning(0.1), time=0.1)
    gone = weakref.ref(method)
    del method
    gc.collect()
    assert gone() is None


def test_nothing_is_leaked_when_python_ends():
    program = """
import numpy as np, kappaflow
x = np.random.default_rng(1).uniform(size=(200, 3))
tracker = kappaflow.Tracker(x, np.zeros_like(x), methods=lambda field, points, options: field.velocities(points, "total"))
tracker.advance(x, np.zeros_like(x), time=1)
mesh, field = tracker.mesh(), kappaflow.Field(x)
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert ended.stderr == ""  # nanobind would say what is left
