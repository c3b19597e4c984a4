"""Other Python threads run while the libraries work, and may use them as well."""

import threading
import time

import numpy as np
import pytest
from conftest import SCENE, ball, same_bits

import kappaflow

TEXT = SCENE.read_text()


def counted_during(work):
    """How often another Python thread gets to run while `work` does, and the result."""
    going, count = True, 0

    def tick():
        nonlocal count
        while going:
            count += 1
            time.sleep(1e-4)

    other = threading.Thread(target=tick)
    other.start()
    start = count
    result = work()
    during = count - start
    going = False
    other.join()
    return during, result


def test_other_threads_run_while_a_field_is_evaluated():
    field = kappaflow.Field(ball())
    points = np.random.default_rng(2).uniform(-0.4, 0.4, (40000, 3))
    assert counted_during(lambda: field.jets(points))[0] > 3


def test_other_threads_run_while_a_scene_does():
    simulation = kappaflow.simulate(TEXT)
    assert counted_during(simulation.advance)[0] > 3


def test_a_tracker_at_work_refuses_a_second_thread():
    inside, go_on = threading.Event(), threading.Event()

    def wait(field, points, _options):
        inside.set()
        go_on.wait(60)
        return field.velocities(points, "material")

    position = ball()
    tracker = kappaflow.Tracker(position, np.zeros_like(position), methods=wait)
    worker = threading.Thread(target=lambda: tracker.advance(position, np.zeros_like(position), time=0.1))
    worker.start()
    assert inside.wait(60)
    with pytest.raises(kappaflow.InvalidInput, match="Tracker: it is at work, in another thread"):
        tracker.mesh()
    go_on.set()
    worker.join()
    assert tracker.time == 0.1 and len(tracker.mesh()) > 100  # and it has gone on


def test_trackers_in_two_threads_have_the_bits_of_one():
    position, velocity = ball(), np.tile([0.3, 0.1, 0], (len(ball()), 1))
    meshes = {}

    def work(key):
        tracker = kappaflow.Tracker(position, velocity, methods="regional")
        tracker.advance(position + 0.1 * velocity, velocity, time=0.1)
        meshes[key] = tracker.mesh()

    work("alone")
    threads = [threading.Thread(target=work, args=(key,)) for key in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(same_bits(meshes[key].positions, meshes["alone"].positions) for key in range(2))
